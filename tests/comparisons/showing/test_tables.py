"""What stands above and below a table of responses: whose outcomes differ, whom a warning concerns, and no more."""

from dataclasses import replace

import numpy as np
import pytest
from sliding_scenes import SAVED

from analytic import Caution, Failure, load_scene, simulate
from analytic.response import COMPARED, Difference
from comparisons.measuring.horizon import Horizon
from comparisons.showing.terminal import comparison, mode_words, show, summary

SCENE = load_scene("free-rocking-rigid")
MODEL = simulate(SCENE, history=False)
FELL = Difference("outcome", "overturns", "rocks", None)
SLIDES = "the friction demand {:.3g} is above the scene's friction 0.1"


def slides(value):
    return Caution("model", SLIDES.format(value), "friction_demand", value, 0.1)


def solved(name, **changes):
    return replace(MODEL, engine=name, variant="one", comparable=COMPARED, **changes)


def horizon(parted):
    return Horizon(2.5, 1e-5, np.zeros(1), np.zeros(1), {"motion up": 2.5 if parted else None})


def printed(capsys, responses, horizons=None):
    """Lines; those that a terminal would break are whole."""
    show(comparison(SCENE, responses, horizons or {}), responses)
    return capsys.readouterr().out.splitlines()


@pytest.fixture(autouse=True)
def wide(monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")


def test_outcomes_that_differ_stand_in_the_first_line_with_who_has_them(capsys):
    fell = solved("exudyn", outcome="overturns", differences=(FELL,))
    first, *_ = printed(capsys, [MODEL, fell, solved("pybullet")])
    assert first == (
        "Outcomes differ: in analytic and pybullet it rocks and stays upright, in exudyn it overturns; "
        "exudyn differs from the analytic model."
    )
    first, *_ = printed(capsys, [MODEL, solved("exudyn")])
    assert first == "In both solvers it rocks and stays upright."
    failed = solved("exudyn", outcome="failed", failure=Failure("it gave up"))
    first, *_ = printed(capsys, [MODEL, failed])  # no outcome
    assert first == "In analytic it rocks and stays upright, in exudyn it failed."
    assert printed(capsys, [MODEL])[0].split() == [SCENE.name.split()[0], *SCENE.name.split()[1:]]


def test_a_warning_is_said_once_with_all_whom_it_concerns(capsys):
    odd, ours = Caution("record", "the peak is above 3 g."), Caution("engine", "steps are too long")
    responses = [
        replace(MODEL, warnings=(odd, slides(0.258))),
        solved("exudyn", warnings=(odd, slides(0.159))),
        solved("pybullet", warnings=(odd, ours)),
    ]
    said = [line for line in printed(capsys, responses) if line.startswith("Warning")]
    assert said == [
        "Warning, all solvers: the peak is above 3 g.",
        f"Warning, analytic and exudyn: {SLIDES.format(0.258)} (0.159 to 0.258)",
        "Warning, pybullet: steps are too long",
    ]
    (said,) = [line for line in printed(capsys, responses[:1]) if "3 g" in line]
    assert said.startswith("Warning, analytic: ")


def test_why_engines_cannot_be_compared_is_said_once(capsys):
    responses = [MODEL, *(replace(solved(name), comparable="N falls to 0") for name in ("exudyn", "pybullet"))]
    (said,) = [line for line in printed(capsys, responses) if "N falls" in line]
    assert said == "each of exudyn and pybullet cannot be compared with the analytic model: N falls to 0"


@pytest.mark.parametrize(
    "parted, words", [(True, "exudyn 2.5 s (1e-05)"), (False, "solvers' own size of error, 1e-05 at most, grows")]
)
def test_how_long_histories_are_compared_contradicts_no_dependence_on_the_motion(capsys, parted, words):
    cliff = Caution("motion", "The outcome depends on less than 5% of the motion.", "outcome", 0.01, 0.05)
    lines = printed(capsys, [replace(MODEL, warnings=(cliff,)), solved("exudyn")], {"exudyn": horizon(parted)})
    out = " ".join(" ".join(lines).split())
    assert lines[-1] == str(cliff) and words in out and "ot sensitive" not in out
    assert ("a difference between histories is a solver's error, to the end" in out) == (not parted)


def test_slip_of_a_block_that_slides_stands_in_both_tables(capsys):
    model = simulate(SAVED, history=False)
    off = replace(model, engine="exudyn", sliding=replace(model.sliding, peak=1.01 * model.sliding.peak))
    unread = replace(model, engine="pymunk", sliding=None)
    show(comparison(SAVED, [model, off, unread], {}), [model])
    rows = capsys.readouterr().out.splitlines()
    heads = next(line.split() for line in rows if line.strip().startswith("solver"))
    slip = [row.split()[heads.index("[s]") + 2 :] for row in rows if row.split()[:1] in (["exudyn"], ["pymunk"])]
    assert [row[1:3] for row in slip] == [[f"{1.01 * model.sliding.peak:.4g}", "+1e+00"], ["-", "0.0000"]]
    show(summary(SAVED, model), [model])
    said = {line.split("  ")[1]: line for line in capsys.readouterr().out.splitlines() if line.startswith("  ")}
    assert f"{model.sliding.work:.4g}" in said["work of friction [J]"]
    assert "stick, from 0.06138 s rock, from 0.09021 s slide-rock, from 0.5422 s rock" in said["contact"]
    show(summary(SAVED, replace(model, sliding=replace(model.sliding, peak=0.0))), [model])
    assert "slip" not in capsys.readouterr().out


def test_more_changes_of_contact_than_are_told_are_counted():
    modes = [(0.0, "stick"), *((float(k), ("rock", "slide-rock")[k % 2]) for k in range(1, 5)), (5.0, "slide-rock")]
    assert (
        mode_words(modes, 4)
        == "stick, from 1 s slide-rock, from 2 s rock, from 3 s slide-rock, 2 more changes (--json)"
    )
    assert mode_words([(0.0, "rock"), (1.0, "rock")]) == "rock"
