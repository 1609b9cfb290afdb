"""Mistakes end in one message and status 2: odd numbers, wrong, exchanged and missing options, pipes, random words."""

import os
import random
import re

import pytest
import typer
from made_up_records import VALUES as SAMPLES
from made_up_records import csmip

from comparisons.commands import app
from engines import ENGINES, get_engine

VALUES = ("-1", "0", "nan", "1e308", "1e-320", "100000000000000000000", "")
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
    "risk": (("risk", "rigid.toml"),),
    "record": (("record", "own.csv"), ("record", "plain.txt", "--units", "g")),
    "report": (("report", "rigid.toml"), ("report", "--record", "own.csv")),
    "verify": (("verify", "--engine", "exudyn"),),
    "study statues": (("study", "statues", "--quick", "--engine", "exudyn"),),
    "study restitution": (("study", "restitution", "--quick"),),
}
BUST_ON = "new NEW --anyway --height 1.9 --width 0.55 --mass 500 --base-mass 400"
MARBLE = "new NEW --height 1.9 --width 0.55 --material marble"
CONSTANTS = f"{BUST_ON} --ka 1e5 --kb 1e4 --alpha 44"
RIGID = "run free-rocking-rigid"
# command line: what its message names
MISTAKES = {
    "run": "Usage",
    f"{RIGID} --nonsense": "Usage",
    "nonsense": "Usage",
    "run no-such-scene": "no-such-scene: scene: cannot be read",
    "compare no-such-scene": "caryatid-isolated",
    f"{RIGID} --engine exudyn --variant fastest": "fastest",
    f"{RIGID} --engine exudyn --set nonsense=1": "nonsense",
    **{
        f"{RIGID} --engine exudyn --set {name}=1": f"exudyn compliant-corners has no setting '{name}': its settings are"
        for name in ("self", "scene", "variant", "history", "compare")
    },
    f"{RIGID} --engine ode": "unknown engine 'ode': choose one of exudyn, pybullet",
    f"{RIGID} --variant fast": "the analytic model has no variant 'fast': leave --variant out, or give kernel",
    f"{RIGID} --set tolerance": "write name=value",
    f"{RIGID} --set tolerance=tight": "give a number",
    f"{RIGID} --set tolerance=true": "give a number",
    f"{RIGID} --set tolerance=-1": "give a value from",
    f"{RIGID} --set speed=1": "its settings are tolerance",
    f"{RIGID} --set history=1": "no setting 'history'",
    f"{RIGID} --plot picture.foo": "end the name in .png, .svg, .pdf",
    f"{RIGID} --csv no-folder/x.csv": "there is no folder no-folder",
    f"{RIGID} --json no-folder/x.json": "there is no folder no-folder",
    f"{RIGID} --csv - --json -": "",
    f"{RIGID} --time-limit 1e400": "--time-limit",
    f"{RIGID} --time-limit inf": "--time-limit",
    f"{RIGID} --time-limit nan": "--time-limit",
    f"{RIGID} --time-limit 0": "--time-limit",
    f"{RIGID} --directions 3": "--records",
    "margin caryatid-rigid --directions 3": "--records",
    **{
        f"{command} caryatid-rigid --records records --directions {number}": f"--directions = {number}: {words}"
        for command in ("run", "margin", "report")
        for number, words in ((10**9, "a run of each takes more than 1e+08 steps in all"), (0, "give 1 or more"))
    },
    **{
        f"{command} --units g": "--units g: give the folder of the records with --records"
        for command in (RIGID, "margin caryatid-rigid", "design caryatid-isolated --stroke 0.3")
    },
    "margin free-rocking-rigid --span 901": "--span 901: give per cent, from 0.1 to 900",
    "margin free-rocking-rigid --tilt 0": "--tilt 0: give a share of the slenderness",
    "margin free-rocking-rigid --tilt 1.01": "--tilt 1.01",
    "margin free-rocking-rigid --tilt nan": "--tilt nan",
    "verify --engine nope": "unknown engine",
    "verify --engine exudyn --variant none": "choose among compliant-corners",
    "verify --variant compliant-corners": "name it with --engine",
    "lessons open tipping --to own.csv": "--to own.csv: is a file; give a folder",
    "lessons open tipping-over": "choose one of tipping",
    "report --units g": "--units g: belongs to a record",
    "report --channel Up": "belongs to a record; give --record FILE",
    "report --record no-such-record.AT2": "motion.record = 'no-such-record.AT2': cannot be read",
    "report --studies none": "rocking study all",
    "report rigid.toml --engine nope": "unknown engine",
    "record channels.v2 --to x.txt": "--channel, one of 1 (90 Deg), 2 (Up), 3 (H1)",
    "study restitution --check 3 --quick": "--check: takes a result as it is",
    "study restitution --check 3 --engine exudyn": "--check: takes a result as it is",
    "study restitution --check 3 --replot FILE": "--check: takes a result as it is",
    "study mistakes --check 3 --output none": "no such result; run the study",
    "design caryatid-isolated": "--stroke",
    "design caryatid-isolated --stroke 0.2 --period 2": "--period",
    "design caryatid-isolated --stroke 0.2 --write softest": "own",
    "design caryatid-isolated --stroke 0.2 --directions 3": "--records",
    "design caryatid-rigid --stroke 0.2": "--base-mass is missing: in caryatid-rigid the block stands on the ground",
    "design caryatid-rigid --stroke 0.2 --base-mass -1": "--base-mass = -1.0: out of range",
    "risk caryatid-rigid --directions 3": "--records",
    "risk caryatid-rigid --both-signs": "--both-signs: give the folder of the records with --records",
    "risk caryatid-rigid --motions 3 --records records": "--motions 3: does not go with --records; leave one out",
    "risk caryatid-rigid --motions -1": "--motions -1: give a whole number from 0 to 5000",
    "risk caryatid-rigid --seed -1": "--seed -1: give a whole number from 0 to 9223372036854775807",
    "risk caryatid-rigid --draws 1": "--draws = 1: give at least 2",
    "risk caryatid-rigid --spread slenderness": "--spread slenderness: write name=value",
    "risk caryatid-rigid --spread mass=0.1": "--spread = mass=0.1: nothing that is drawn for this scene; choose",
    "risk caryatid-rigid --spread ka=0.1": "--spread = ka=0.1: nothing that is drawn for this scene; choose",
    "risk caryatid-rigid --spread slenderness=3": "give a coefficient of variation from 0 to 0.5",
    "risk caryatid-rigid --pga 0": "--pga 0: give a peak above 0, in g",
    "risk caryatid-rigid --pga 0.3 --pgv 0.5": "--pgv 0.5: does not go with --pga; leave one out",
    "risk free-rocking-rigid --pga 0.3": "--pga 0.3: there is no motion to scale; give --motions or --records",
    "design caryatid-rigid --stroke 0.2 --base-mass nan": "--base-mass",
    "design caryatid-isolated --stroke 0.2 --base-mass 400": "--base-mass 400: caryatid-isolated has a base, of 212 kg",
    "design caryatid-isolated --stroke -1": "--stroke = -1.0: give metres above 0",
    "design caryatid-isolated --stroke 1e300": "--stroke = 1e+300: give a number from 1e-20 to 1e+20",
    "design caryatid-isolated --stroke 1000": "cannot be met at --stroke = 1000 m",
    "design --base-mass 400": "--base-mass: belongs to a scene",
    "design --period 2 --damping 1e308 --xmax 0.3 --mass 3000": "--damping = 1e+308: give a number from 1e-20 to 1e+20",
    "design --stroke 0.2": "--stroke",
    "design --period 2": "--damping",
    "design --period 2 --damping 0.1 --xmax 0.3": "",
    "design --period 2 --damping 0.1 --xmax 0.3 --mass 1 --json none/x.json": "there is no folder",
    "new NEW --height 1.9 --mass 3": "--width is missing",
    "new NEW --height 1.9 --width 0.5": "--mass [kg], --density [kg/m3] or --material",
    "new NEW --height 1.9 --width 0.5 --material cheese": "choose one of marble",
    f"{MARBLE} --period 2.5 --xmax 0.2": "--base-mass",
    f"{MARBLE} --base-mass 100 --period 2.5": "--period and --xmax",
    f"{MARBLE} --record absent.csv": "absent.csv",
    f"{MARBLE} --units g": "--record",
    f"{MARBLE} --depth 55": "--depth 55 is longer than any side of a statue, 20 m",
    f"{MARBLE} --tilt 2": "--tilt = 2.0: out of range; give a number below 1.5708 [rad]",
    f"{MARBLE} --xmax 0.2": "",
    f"{MARBLE} --tilt 0.1 --record own.csv": "",
    f"{MARBLE} --density 2700": "",
    f"{MARBLE} --record channels.v2": "--channel: missing; the file holds channels 1 (90 Deg)",
    "report --record channels.v2": "--channel: missing; the file holds channels 1 (90 Deg)",
    f"{CONSTANTS} --ratio 3": "--ratio belongs to bearings by design",
    f"{CONSTANTS} --damping 0.2": "--damping belongs to bearings by design",
    f"{CONSTANTS} --definition paper": "--definition belongs to bearings by design",
    f"{CONSTANTS} --period 2 --xmax 1": "",
    f"{BUST_ON} --ka 1e4 --kb 1e5 --alpha 44": "",
    f"{BUST_ON} --ka 1e5 --kb 1e4 --alpha 1": "",
    f"{BUST_ON} --ka 1e5 --kb 1e4": "",
    f"{BUST_ON} --period 2 --xmax 0.2 --count 2000000": "",
    f"{BUST_ON} --period 2 --xmax 0.2 --damping 0.9": "",
    f"{BUST_ON} --period 2 --xmax 0.2 --definition mine": "",
}
READERS = (
    *(("run", "FILE"), ("compare", "FILE"), ("choose", "FILE"), ("margin", "FILE"), ("report", "FILE")),
    ("risk", "FILE"),
    *(("record", "FILE"), ("report", "--record", "FILE"), (*BUST, "--record", "FILE")),
    *(("study", "restitution", "--replot", "FILE"), ("study", "fragility", "--replot", "FILE")),
)


def numeric_options(name):
    """The options of a command that take a number."""
    command = typer.main.get_command(app)
    for word in name.split():
        command = command.get_command(None, word)
    kinds = {option.opts[-1]: str(getattr(option, "type_descriptor", None) or option.type) for option in command.params}
    return [name for name, kind in kinds.items() if name[:2] == "--" and re.search("float|int", kind.lower())]


CASES = [
    pytest.param(base, option, marks=pytest.mark.slow) if base is not bases[0] else (base, option)
    for name, bases in BASES.items()
    for option in numeric_options(name)
    for base in bases
]
assert len(CASES) > 55  # else their kinds are called otherwise


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with a scene and records; what would start long work is cut short: the words are under test here."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rigid.toml").write_text("[block]\nmass=1.0\nradius=1.0\nslenderness=0.25\n[start]\ntilt=0.1\n")
    (tmp_path / "records").mkdir()
    for peak, name in enumerate(("records/A000.csv", "records/A090.csv", "own.csv"), 2):
        (tmp_path / name).write_text(f"time [s];acc [m/s2]\n0.00;0.1\n0.01;0.{peak}\n0.02;-0.2\n")
    (tmp_path / "plain.txt").write_text("0.1\n0.4\n-0.2\n")
    (tmp_path / "channels.v2").write_text(csmip(SAMPLES))
    for work in (
        "comparisons.report.runs.make_own_results",
        "comparisons.report.runs.make_results",
        "comparisons.report.write.write_page",
        "comparisons.execution.runner.compute",
        "comparisons.metrics.agreement.measure_all",
        "comparisons.advice.choose.choose",
        "comparisons.metrics.errors.solver_horizon",
        "analytic.advice.margins.margins",
        "analytic.advice.risk.check_cost",
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


def one_message(status, text):
    """Answered, or refused by one message without a traceback; two numbers of a block or bearings take a line each."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith(("Usage:", "Try '"))]
    return status in (0, 1) or status == 2 and len(lines) in (1, 2) and max(map(len, lines)) < 800


@pytest.mark.parametrize("base, option", CASES, ids=lambda case: case if isinstance(case, str) else " ".join(case)[:40])
def test_an_odd_number_is_taken_or_refused_in_one_message(rocking, place, base, option):
    for number, value in enumerate(VALUES):
        arguments = [f"new{number}.toml" if word == "NEW" else word for word in base]
        status, text = ended(rocking, [*arguments, option, value])
        assert "Traceback" not in text and one_message(status, text), (option, value, status, text)


@pytest.mark.parametrize("command, words", MISTAKES.items())
def test_a_mistake_is_one_message_that_names_it(rocking, place, command, words):
    before = sorted(place.iterdir())
    status, out, err = rocking(*command.replace("NEW", "new.toml").split())
    assert (status, out) == (2, "") and one_message(status, err) and "Traceback" not in err
    assert words in " ".join(err.split())
    assert sorted(place.iterdir()) == before


@pytest.mark.parametrize("value", ["1e400", "1e-400", "much", "nan", "1" * 5000, "[" * 50000, "null", '"1"', ""])
@pytest.mark.parametrize("solver", ["analytic", *ENGINES])
def test_absurd_settings_are_refused(rocking, solver, value):
    name = "tolerance"
    if solver != "analytic":
        name = get_engine(solver).variants[get_engine(solver).default_variant].accuracy_parameter
    status, out, err = rocking(*RIGID.split(), "--engine", solver, "--set", f"{name}={value}")
    assert (status, out) == (2, "") and one_message(status, err) and name in err


@pytest.mark.parametrize("kind", ["pipe", "/dev/zero", "folder"])
@pytest.mark.parametrize("arguments", READERS, ids=" ".join)
def test_a_pipe_a_device_and_a_folder_are_refused(rocking, place, arguments, kind):
    os.mkfifo(place / "pipe")
    (place / "folder").mkdir()
    status, text = ended(rocking, [{"FILE": kind, "NEW": "new.toml"}.get(word, word) for word in arguments])
    assert status == 2 and one_message(status, text), text


WORDS = (
    "",
    "-",
    "--",
    "x",
    "run",
    "[/b]",
    "$x$",
    "é",
    "\0",
    "nan",
    "1e400",
    "-1",
    "9" * 5000,
    "a" * 300,
    "a/" * 3000,
    "--json",
    "--csv",
    "--plot",
    "--set",
    "--engine",
    "--time-limit",
    "--output",
    "--record",
    "--units",
    "--variant",
    "step=1e400",
    "tolerance=nan",
    "=",
    "tolerance=1e-3",
    "exudyn",
    "analytic",
    ".",
    "/",
    "/dev/full",
    "/dev/tty",
    "/proc/self/mem",
    "/proc/x.png",
    "x.png",
    "no/x.json",
    "--help",
    "\udcff",
    "--quick",
)
RECORD = (
    "--units",
    "g",
    "furlong",
    "--dt",
    "0.01",
    "-1",
    "nan",
    "--column",
    "2",
    "0",
    "--channel",
    "Up",
    "--to",
    "x.txt",
)
COMMANDS = (
    ["run"],
    ["run", "free-rocking-rigid"],
    ["compare"],
    ["compare", "free-rocking-rigid"],
    ["design"],
    ["design", "--period", "2", "--damping", "0.3", "--xmax", "0.3"],
    ["engines", "x"],
    ["report", "--output"],
    ["report", "--record"],
    ["record", "channels.v2"],
    ["record", "none"],
    ["study"],
    ["study", "fragility", "--workers"],
    ["study", "overturning", "--output"],
    ["study", "kernel", "--output"],
    [],
)
DESIGN = ("--period", "--damping", "--xmax", "--mass", "--count", "--ratio", "--definition")


def test_no_combination_of_bad_words_and_places_ends_in_a_traceback(rocking, place, monkeypatch):
    """Seeded."""
    monkeypatch.setattr("engines.ENGINES", {})  # runs of the analytic model alone
    draw, seen = random.Random(20261121), set()
    for _ in range(200):
        command = draw.choice(COMMANDS)
        words = WORDS + {"design": DESIGN, "record": RECORD}.get(command[0] if command else "", ())
        if command[:2] == ["report", "--output"] or command[:1] == ["study"]:
            arguments = [*command, draw.choice(["/proc/x", "/dev/full", "\0", "a" * 300, "a/" * 3000, ""])]
        else:
            arguments = [*command, *draw.choices(words, k=draw.randrange(1, 4))]
        status, text = ended(rocking, arguments)
        assert status in (0, 1, 2) and "Traceback" not in text, arguments
        assert status != 2 or 0 < len(text) < 3000, arguments
        seen.add(status)
    assert seen >= {0, 2}
