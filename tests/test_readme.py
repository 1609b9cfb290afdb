"""What README.md tells a user to type is run as it stands there, but for making environments and installing."""

import re
import shlex
import textwrap
from pathlib import Path

import pytest

from analytic import load_scene, scene_file

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
SLOW = dict.fromkeys(("report", "choose", "design", "margin"), pytest.mark.slow) | {"lessons": pytest.mark.long}


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


LINES = [line.replace(".venv/bin/", "") for block in blocks("sh") for line in block.replace("\\\n", " ").splitlines()]
PARTS = [shlex.split(part) for line in LINES for part in line.split("&&")]
COMMANDS = [words[1:] for words in PARTS if words[:1] == ["rocking"] and "open" not in words]  # that opens a browser
TABLE = re.findall(r"^\| `rocking (\w+)", README, re.MULTILINE)
INLINE = [shlex.split(text) for text in re.findall(r"`rocking ([^`\n]+ --[^`\n]+)`", README)]


def test_quick_commands_work_in_their_order_and_the_scene_file_is_the_one_they_write(rocking, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    quick = [words for words in COMMANDS if words[0] not in SLOW]
    for words in quick:
        status, _, err = rocking(*words)
        assert status == 0 and "Traceback" not in err, (words, err)
    (new,) = (words for words in quick if words[0] == "new")
    assert Path(new[1]).read_text(encoding="utf-8") in blocks("toml")
    assert {words[0] for words in COMMANDS} >= {"new", *SLOW}


@pytest.mark.timeout(1400)
@pytest.mark.parametrize(
    "words",
    [
        # a report without a scene is test_report.py's
        pytest.param(words, marks=pytest.mark.long if words == ["report"] else SLOW[words[0]], id=" ".join(words))
        for words in COMMANDS
        if words[0] in SLOW
    ],
)
def test_a_command_that_takes_long_works_after_the_first(rocking, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    assert rocking(*next(other for other in COMMANDS if other[0] == "new"))[0] == 0
    status, _, err = rocking(*words)
    assert status == 0 and "Traceback" not in err, err


def test_commands_of_the_table_and_options_in_the_text_are_there(rocking):
    assert len(TABLE) > 10 and len(INLINE) > 2
    for words in ([name] for name in TABLE):
        status, out, _ = rocking(*words, "--help")
        assert status == 0 and "Example: rocking" in out, words
    for words in (*INLINE, *COMMANDS):
        names = words[:2] if words[0] in ("lessons", "study") else words[:1]
        out = rocking(*(name for name in names if name.islower()), "--help")[1]
        for option in (word for word in words if word.startswith("--") and word != "--help"):
            assert re.search(rf"(?<![\w-]){option}(?![\w-])", out), (words, option)


@pytest.mark.parametrize("source", blocks("python"))
def test_its_python_runs(source, capsys):
    exec(source, {})
    first, second = map(float, capsys.readouterr().out.splitlines()[-1].split())
    assert first == pytest.approx(second, rel=1e-3)  # the two solvers' displacement


@pytest.mark.parametrize("place", ["README", "analytic.scene_file"])
def test_its_scene_file_reads(tmp_path, place):
    """The short one, and the one with every key in the reference."""
    (short,) = (block for block in blocks("toml") if "[block]" in block)
    (whole,) = re.findall(r"::\n\n((?:    .*\n|\n)+)", scene_file.__doc__)
    (tmp_path / "scene.toml").write_text(short if place == "README" else textwrap.dedent(whole))
    scene = load_scene(tmp_path / "scene.toml")
    assert scene.base is not None and scene.bearings is not None and scene.motion is not None
