"""The problem sheet and its score, by a solver that knows nothing of this project (`tests/sheet_solver.py`)."""

import math
import re

import numpy as np
import pytest
from sheet_solver import solve

from analytic.errors import SceneError
from comparisons.sheet.pages import markdown, write_sheet
from comparisons.sheet.problems import PROBLEMS
from comparisons.sheet.score import read_answers, score
from comparisons.sheet.variants import own_error, solved

BY_NAME = {problem.name: problem for problem in PROBLEMS}


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheet")
    write_sheet(folder)
    return folder


def answers(sheet, names, told=lambda quantity, value: value, **fault):
    """What the independent solver answers, with a fault, or with its answers told otherwise."""
    record = sheet / "inputs" / "record.csv"
    found = {name: solve(name, BY_NAME[name].times, record=record, **fault) for name in names}
    return {
        name: {one.name: told(one, values[one.name]) for one in BY_NAME[name].quantities if one.name in values}
        for name, values in found.items()
    }


def factor(kinds, by):
    return lambda quantity, value: value * by if quantity.kind in kinds else value


FEW = ("free-rigid", "free-sliding", "isolated-standing", "pulse-below")


@pytest.mark.parametrize("names", [FEW, pytest.param(tuple(BY_NAME), marks=pytest.mark.slow)], ids=["few", "all"])
def test_an_independent_solver_passes_with_the_pages_alone(sheet, names):
    found = score(answers(sheet, names))
    assert found.passed and found.unanswered == [name for name in BY_NAME if name not in names]
    assert max(one.error for one in found.scenes) < 1e-8
    assert not any(one.missing or one.cause for one in found.scenes)


@pytest.mark.parametrize("name", ["free-rigid", "free-sliding", "isolated-standing", "isolated-rocking", "hard"])
def test_exact_answers_are_exact_to_1e_10(name):
    assert own_error(BY_NAME[name]) < 1e-10


SPOILT = [
    ("impact lost", ("free-rigid",), {"lost": 2}),
    ("restitution off by the step", ("free-rigid",), {"late": "held"}),
    ("restitution off by the step", ("free-sliding",), {"late": "smeared"}),
    ("eq. (8) as printed", ("free-sliding", "free-rigid"), {"printed8": True}),
    ("eq. (12) as printed", ("isolated-standing",), {"printed12": True}),
    pytest.param("wrong damping definition", ("record",), {"c": 0.5}, marks=pytest.mark.slow),  # 1600 samples
    ("degrees for radians", ("free-rigid",), {"told": factor(("angle", "rate"), 180 / math.pi)}),
    ("g for m/s2", ("pulse-below", "isolated-standing"), {"A": 1 / 9.81}),
    ("sign of the ground motion", ("isolated-standing",), {"A": -1}),
    ("force per bearing for all", ("isolated-standing",), {"n": 0.25}),
    ("inertia about the centre", ("free-rigid",), {"J": 0.25}),
    (None, ("pulse-below",), {"A": -1}),  # or the sign of the tilt: this page alone cannot tell
]


@pytest.mark.parametrize("cause, names, fault", SPOILT)
def test_a_spoilt_code_is_told_what_is_wrong(sheet, cause, names, fault):
    found = score(answers(sheet, names, **fault))
    assert found.cause == cause and not found.passed
    assert {one.cause for one in found.scenes} == {cause} | {None for one in found.scenes if one.right}


RIGHT = {name: solved(BY_NAME[name]) for name in ("free-rigid", "pulse-below")}
HIT, LIFTED = RIGHT["free-rigid"]["impact_time_1"], RIGHT["pulse-below"]["uplift_time"]
TIMELESS = {("free-rigid", "outcome"): "overturns", ("pulse-below", "peak_tilt"): 0.1}


@pytest.mark.parametrize(
    "changes, scene, quantity, time",
    [
        (
            {("free-rigid", "impact_time_2"): 0.1, ("free-rigid", "rate_after_1"): 0.1},
            "free-rigid",
            "rate_after_1",
            HIT,
        ),
        (
            {("free-rigid", "rate_after_1"): 0.1, ("pulse-below", "uplift_time"): 0.1},
            "pulse-below",
            "uplift_time",
            LIFTED,
        ),
        (TIMELESS, "free-rigid", "outcome", None),  # in the sheet's order, and after what has a time
        ({**TIMELESS, ("free-rigid", "tilt_at_2.5"): 0.1}, "free-rigid", "tilt_at_2.5", 2.5),
        ({("free-rigid", "impact_time_2"): 1e-6}, None, None, None),  # within what counts as right
    ],
)
def test_the_first_wrong_answer_is_that_of_the_earliest_time(changes, scene, quantity, time):
    assert LIFTED < HIT
    given = {name: dict(answers) for name, answers in RIGHT.items()}
    for (name, one), change in changes.items():
        given[name][one] = change if isinstance(change, str) else given[name][one] + change
    found = score(given)
    first = found.first_wrong
    assert found.passed if scene is None else (first.scene, first.quantity, first.time) == (scene, quantity, time)
    assert first is None or first.error == found.scenes[scene == "pulse-below"].errors[quantity]


TOLD = {
    "late by 10 ms": lambda one, value: value + 0.01 if one.kind == "time" else value,
    "gon": factor(("angle", "rate"), 200 / math.pi),
    "kN and mm": lambda one, value: value * {"force": 1e-3, "length": 1e3, "speed": 1e3}.get(one.kind, 1),
    "two digits": lambda one, value: value if one.kind == "outcome" else float(f"{value:.1e}"),
    "tilt doubled": factor(("angle",), 2.0),
}
CHANGED = [
    {"e": 1.01},
    {"e": 0.97},
    {"g": 0.9},
    {"R": 1.02},
    {"mb": 1.5},
    {"mb": 0.01},
    {"gamma": 1.03},
    {"phi0": 0.95},
    {"J": 0.75},
    {"J": 1.1},
    {"A": 0.8},
    {"A": 2.0},
    {"w": 1.05},
    {"kb": 1.2},
    {"ka": 0.5},
    {"alpha": 1.1},
    {"n": 0.75},
    {"printed8": True, "e": 1.02},
    {"late": "held", "J": 1.02},
    {"lost": 1, "R": 0.97},
]


@pytest.mark.slow
def test_other_faults_are_never_given_a_wrong_name(sheet):
    found = [score(answers(sheet, FEW, **fault)) for fault in CHANGED]
    found += [score(answers(sheet, FEW, told=told)) for told in TOLD.values()]
    assert sum(not one.passed for one in found) >= 24  # two digits are too few in any case
    assert {one.cause for one in found} == {None}
    assert {scene.cause for one in found for scene in one.scenes} == {None}


def test_pages_say_nothing_of_our_code(sheet):
    for problem in PROBLEMS:
        text = markdown(problem)
        assert not re.search(
            r"python|kernel|exudyn|analytic|comparisons|rocking (sheet|score|run)", text, re.IGNORECASE
        )
        for one in problem.quantities:
            assert f"| {one.name} |" in text and f">{one.name}<" in (sheet / f"{problem.name}.html").read_text()
        page = (sheet / f"{problem.name}.html").read_text()
        assert not re.search(r"\de[-+]?\d|\b[^\W\d_]_[^\W_]\b", page)  # indices and powers as one writes them
    samples = np.loadtxt(sheet / "inputs" / "record.csv", delimiter=",", skiprows=1)[:, 1]
    assert samples.tolist() == BY_NAME["record"].scene.motion.samples.tolist()


@pytest.mark.parametrize(
    "line, words",
    [
        ("free-rigid,impact_time_1,0,9", "line 2: not three columns"),
        ("free,outcome,rocks", "line 2: no scene of the sheet"),
        ("hard,weight,3", "line 2: not asked of hard"),
        ("hard,rest_time,1.6 s", "line 2: not a finite number"),
        ("hard,outcome,falls", "line 2: no outcome"),
        ("hard,outcome,rocks\nhard,outcome,rocks", "line 3: answered twice"),
        pytest.param("\n" + '"hard,outcome,rocks\n' * 9000, "line 3: no line of CSV", id="a quote not closed"),
        ('hard,"outcome"x,rocks', "line 2: no line of CSV"),
    ],
)
def test_answers_that_cannot_be_read_are_one_message(tmp_path, line, words):
    file = tmp_path / "answers.csv"
    file.write_text(f"scene,quantity,value\n{line}\n")
    with pytest.raises(SceneError, match=words):
        read_answers(file)
