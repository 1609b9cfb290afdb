"""What README.md tells a user to type is run as it stands there, but for making environments and installing."""

import re
import shlex
import textwrap
from pathlib import Path

import pytest

from analytic import load_scene, scene_file

README, CONTRIBUTING = (
    (Path(__file__).parents[1] / f"{name}.md").read_text("utf-8") for name in ("README", "CONTRIBUTING")
)
SLOW = dict.fromkeys(("report", "choose", "design", "margin"), pytest.mark.slow) | {"lessons": pytest.mark.long}


def blocks(language, text=README):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


LINES = [line.replace(".venv/bin/", "") for block in blocks("sh") for line in block.replace("\\\n", " ").splitlines()]
PARTS = [shlex.split(part) for line in LINES for part in line.split("&&")]
COMMANDS = [words[1:] for words in PARTS if words[:1] == ["rocking"] and "open" not in words]  # that opens a browser
INLINE = [shlex.split(text) for text in re.findall(r"`rocking ([^`\n]+ --[^`\n]+)`", README)]
SHOWN = [words.split() for words in re.findall(r"\| rocking (run \S+ --engine [^|]+)", README)]


def test_quick_commands_work_in_their_order(rocking, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    quick = [words for words in COMMANDS if words[0] not in SLOW]
    for words in quick:
        status, _, err = rocking(*words)
        assert status == 0 and "Traceback" not in err, (words, err)
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


def test_it_has_at_most_150_lines():
    assert len(README.splitlines()) <= 150


def test_options_in_the_text_are_there(rocking):
    assert len(INLINE) > 2 and len(SHOWN) == README.count("| rocking run ") > 1
    for words in (*INLINE, *COMMANDS, *SHOWN):
        names = words[:2] if words[0] in ("lessons", "study") else words[:1]
        out = rocking(*(name for name in names if name.islower()), "--help")[1]
        for option in (word for word in words if word.startswith("--") and word != "--help"):
            assert re.search(rf"(?<![\w-]){option}(?![\w-])", out), (words, option)


def test_the_scene_file_of_the_reference_reads(tmp_path):
    """The one with every key."""
    (whole,) = re.findall(r"::\n\n((?:    .*\n|\n)+)", scene_file.__doc__)
    (tmp_path / "scene.toml").write_text(textwrap.dedent(whole))
    scene = load_scene(tmp_path / "scene.toml")
    assert scene.base is not None and scene.bearings is not None and scene.motion is not None
