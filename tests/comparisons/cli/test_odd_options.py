"""Slips of the hand end in one message: odd numbers in every numeric option, exchanged and missing ones, pipes."""

import os

import pytest
import typer

from comparisons.cli.application import app

VALUES = ("-1", "0", "nan", "inf", "1e308", "1e-320", "1e20", "100000000000000000000", "")
BUST = ("new", "NEW", "--anyway", "--height", "1.9", "--width", "0.55", "--mass", "500")
ISOLATED = (*BUST, "--base-mass", "400")
BASES = {
    "new": (
        BUST,
        (*ISOLATED, "--period", "2.5", "--xmax", "0.2"),
        (*ISOLATED, "--ka", "1e5", "--kb", "1e4", "--alpha", "44"),
        (*BUST, "--record", "own.csv"),
    ),
    "design": (("design", "--period", "2", "--damping", "0.1", "--xmax", "0.3", "--mass", "3000"),),
    "run": (("run", "rigid.toml"), ("run", "rigid.toml", "--engine", "exudyn")),
    "compare": (("compare", "rigid.toml", "--engine", "exudyn"),),
    "choose": (("choose", "rigid.toml", "--engine", "exudyn"),),
    "margin": (("margin", "rigid.toml"),),
    "record": (("record", "own.csv"), ("record", "plain.txt", "--units", "g")),
    "report": (("report", "rigid.toml"), ("report", "--record", "own.csv")),
    "verify": (("verify", "--engine", "exudyn"),),
    "study random-scenes": (("study", "random-scenes", "--quick", "--engine", "exudyn"),),
    "study restitution": (("study", "restitution", "--quick"),),
}
EXCHANGED = {
    "stiffnesses": (*ISOLATED, "--ka", "1e4", "--kb", "1e5", "--alpha", "44"),
    "an exponent of 1": (*ISOLATED, "--ka", "1e5", "--kb", "1e4", "--alpha", "1"),
    "no exponent": (*ISOLATED, "--ka", "1e5", "--kb", "1e4"),
    "design and constants": (*ISOLATED, "--period", "2", "--xmax", "1", "--ka", "1e5", "--kb", "1e4", "--alpha", "9"),
    "bearings without a base": (*BUST, "--xmax", "0.2"),
    "too many bearings": (*ISOLATED, "--period", "2", "--xmax", "0.2", "--count", "2000000"),
    "too much damping": (*ISOLATED, "--period", "2", "--xmax", "0.2", "--damping", "0.9"),
    "an unknown definition": (*ISOLATED, "--period", "2", "--xmax", "0.2", "--definition", "mine"),
    "a tilt and a record": (*BUST, "--tilt", "0.1", "--record", "own.csv"),
    "mass and density": (*BUST, "--density", "2700"),
    "an unknown engine": ("verify", "--engine", "nope"),
    "an unknown engine of a report": ("report", "rigid.toml", "--engine", "nope"),
    "two results on standard output": ("run", "rigid.toml", "--csv", "-", "--json", "-"),
    "design without a mass": ("design", "--period", "2", "--damping", "0.1", "--xmax", "0.3"),
}
READERS = (
    *(("run", "FILE"), ("compare", "FILE"), ("choose", "FILE"), ("margin", "FILE"), ("report", "FILE")),
    *(("record", "FILE"), ("report", "--record", "FILE"), (*BUST, "--record", "FILE"), ("score", "FILE")),
    *(("study", "restitution", "--replot", "FILE"), ("study", "fragility", "--replot", "FILE")),
)


def numeric_options(name):
    """The options of a command that take a number."""
    command = typer.main.get_command(app)
    for word in name.split():
        command = command.get_command(None, word)
    for option in command.params:
        kind = str(getattr(option, "type_descriptor", None) or option.type).lower()
        if option.opts[0].startswith("--") and ("float" in kind or "int" in kind):
            yield option.opts[-1]


CASES = [(base, option) for name, bases in BASES.items() for option in numeric_options(name) for base in bases]


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with a scene and records; what would start long work is cut short: the words are under test here."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rigid.toml").write_text("[block]\nmass=1.0\nradius=1.0\nslenderness=0.25\n[start]\ntilt=0.1\n")
    (tmp_path / "own.csv").write_text("time [s];acc [m/s2]\n0.00;0.1\n0.01;0.4\n0.02;-0.2\n")
    (tmp_path / "plain.txt").write_text("0.1\n0.4\n-0.2\n")
    for work in (
        "comparisons.report.study.make_own_results",
        "comparisons.report.study.make_results",
        "comparisons.report.write.write_page",
        "comparisons.running.study.compute",
        "comparisons.measuring.tolerances.measure_all",
        "comparisons.advice.choose",
        "comparisons.measuring.horizon.solver_horizon",
        "analytic.margins.margins",
    ):
        monkeypatch.setattr(work, _cut_short)
    return tmp_path


class CutShort(Exception):
    """All that was typed was taken, and the work would begin."""


def _cut_short(*_, **__):
    raise CutShort


def ended(rocking, arguments):
    """(status, what was printed) of a command line; (0, "") where its work would begin."""
    try:
        status, out, err = rocking(*arguments)
    except CutShort:
        return 0, ""
    return status, out + err


def told(status, text):
    """Answered, or refused by one message without a traceback; two numbers of a block or bearings take a line each."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith(("Usage:", "Try '"))]
    return status in (0, 1) or status == 2 and len(lines) in (1, 2) and max(map(len, lines)) < 800


def test_there_are_options_enough():
    assert len(CASES) * len(VALUES) > 500


@pytest.mark.parametrize("base, option", CASES, ids=[f"{' '.join(base)[:40]} {option}" for base, option in CASES])
def test_an_odd_number_is_taken_or_refused_in_one_message(rocking, place, base, option):
    for number, value in enumerate(VALUES):
        arguments = [f"new{number}.toml" if word == "NEW" else word for word in base]
        status, text = ended(rocking, [*arguments, option, value])
        assert "Traceback" not in text and told(status, text), (option, value, status, text)


@pytest.mark.parametrize("arguments", EXCHANGED.values(), ids=EXCHANGED)
def test_what_cannot_be_is_one_message(rocking, place, arguments):
    status, text = ended(rocking, ["new.toml" if word == "NEW" else word for word in arguments])
    assert status == 2 and told(status, text), text
    assert not (place / "new.toml").exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this system")
@pytest.mark.parametrize("kind", ["pipe", "/dev/zero", "folder"])
@pytest.mark.parametrize("arguments", READERS, ids=" ".join)
def test_a_pipe_a_device_and_a_folder_are_refused(rocking, place, arguments, kind):
    file = kind
    if kind == "pipe":
        os.mkfifo(place / "pipe")
    elif kind == "folder":
        (place / "folder").mkdir()
    words = {"FILE": file, "NEW": "new.toml"}
    status, text = ended(rocking, [words.get(word, word) for word in arguments])
    assert status == 2 and told(status, text), text


def test_studies_that_are_pipes_are_refused(rocking, place):
    os.mkfifo(place / "restitution.json")
    status, text = ended(rocking, ["report", "rigid.toml", "--studies", place])
    assert status in (0, 2) and "Traceback" not in text


def test_the_history_goes_to_standard_output(rocking, place):
    """Review A8: a file called "-" was written."""
    status, out, _ = rocking("run", "rigid.toml", "--csv", "-")
    assert status == 0 and out.startswith("time,tilt,tilt_rate") and not (place / "-").exists()
