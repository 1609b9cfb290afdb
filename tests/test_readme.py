"""What README.md tells a user to type is run as it stands there, but for making environments and installing."""

import itertools
import re
import shlex
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
# Seconds that `rocking ...` of these words may take; what is not here is quick.
LONG = {"report": 600, "choose": 600, "lessons export": 1200}
OUTPUTS = ("--output", "--plot", "--to")  # options of what is written
NOT_RUN = ("venv", "pip", "pytest", "pdoc", "open")  # made, installed or tested elsewhere, or opens a browser


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


def commands():
    """[words of a command line] of the shell blocks, parts joined by && on their own, without .venv/bin/."""
    found = []
    for block in blocks("sh"):
        for line in block.replace("\\\n", " ").splitlines():
            for part in line.split("&&"):
                words = [Path(word).name if word.startswith(".venv/") else word for word in shlex.split(part)]
                if words and not set(NOT_RUN) & set(words):
                    found.append(words)
    return found


def cases():
    for words in commands():
        name = " ".join(words[1:3]) if words[1] == "lessons" else words[1]
        marks = [pytest.mark.long, pytest.mark.timeout(1400)] if name in LONG else []
        yield pytest.param(words, LONG.get(name, 60), marks=marks, id=" ".join(words[1:]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the user is: nothing lies there but what the commands themselves write."""
    return tmp_path_factory.mktemp("readme")


def test_there_are_commands_to_run():
    names = {words[1] for words in commands()}
    assert {"new", "report", "choose", "lessons"} <= names
    assert all(words[0] == "rocking" for words in commands())


def test_a_command_reads_no_file_that_none_before_it_writes():
    written = set()
    for words in commands():
        files = {word for word in words if re.search(r"\.[A-Za-z]\w*$", word)}
        made = {word for before, word in itertools.pairwise(words) if before in (*OUTPUTS, "new")}
        assert files - made <= written, words
        written |= made
    assert "bust.toml" in written


def spans():
    """The words of every command of ours: in the blocks, those that are not run here too, and within the text."""
    lines = [line for block in blocks("sh") for line in block.replace("\\\n", " ").splitlines()]
    inline = re.findall(r"`(rocking [^`]+)`", re.sub(r"^```.*?^```", "", README, flags=re.DOTALL | re.MULTILINE))
    parts = [part.replace(".venv/bin/", "") for line in lines for part in line.split("&&")]
    return [shlex.split(one) for one in (*parts, *inline) if one.strip().startswith("rocking ")]


@pytest.mark.parametrize(
    "words", [words for words in spans() if any(word.startswith("--") for word in words)], ids=" ".join
)
def test_an_option_that_it_names_is_one_of_the_command(words):
    names = words[1:3] if words[1] in ("lessons", "study") else words[1:2]
    done = rocking(Path.cwd(), ["rocking", *(name for name in names if name.islower()), "--help"], 60)
    assert done.returncode == 0, done.stderr
    for option in (word for word in words if word.startswith("--") and word != "--help"):
        assert re.search(rf"(?<![\w-]){option}(?![\w-])", done.stdout), option


@pytest.mark.parametrize("words, seconds", list(cases()))
def test_a_command_of_the_readme_works_as_it_stands(folder, words, seconds):
    if any(word == "bust.toml" for word in words) and words[1] != "new" and not (folder / "bust.toml").exists():
        new = next(other for other in commands() if other[1] == "new")
        assert rocking(folder, new, 60).returncode == 0
    if words[1] == "new":
        (folder / "bust.toml").unlink(missing_ok=True)
    done = rocking(folder, words, seconds)
    assert done.returncode == 0, done.stderr[-2000:]
    assert "Traceback" not in done.stderr


def rocking(folder, words, seconds):
    return subprocess.run(
        [sys.executable, "-m", "comparisons", *words[1:]], cwd=folder, capture_output=True, text=True, timeout=seconds
    )


@pytest.mark.parametrize("source", blocks("python"))
def test_its_python_runs(source):
    done = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    first, second = map(float, done.stdout.splitlines()[-1].split())
    assert first == pytest.approx(second, rel=1e-3)  # the two solvers' displacement


def test_its_scene_file_is_the_one_that_its_first_command_writes(tmp_path):
    new = next(words for words in commands() if words[1] == "new")
    assert rocking(tmp_path, new, 60).returncode == 0
    assert (tmp_path / new[2]).read_text(encoding="utf-8") in blocks("toml")


@pytest.mark.parametrize("place", ["README", "analytic.scene_file"])
def test_its_scene_file_reads(tmp_path, place):
    """The short one, and the one with every key in the reference."""
    from analytic import load_scene, scene_file

    (short,) = (block for block in blocks("toml") if "[block]" in block)
    (whole,) = re.findall(r"::\n\n((?:    .*\n|\n)+)", scene_file.__doc__)
    (tmp_path / "scene.toml").write_text(short if place == "README" else textwrap.dedent(whole))
    scene = load_scene(tmp_path / "scene.toml")
    assert scene.base is not None and scene.bearings is not None and scene.motion is not None


@pytest.mark.parametrize("name", re.findall(r"^\| `rocking (\w+)", README, re.MULTILINE))
def test_every_command_of_its_table_is_there(name):
    done = rocking(Path.cwd(), ["rocking", name, "--help"], 60)
    assert done.returncode == 0 and "Example: rocking" in done.stdout
