"""What a terminal says: whose outcomes differ, whom a warning concerns, what was chosen, and no more."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sliding_scenes import SAVED

from analytic import Caution, Failure, load_scene, simulate
from analytic.advice.bearing_scan import BearingScan
from analytic.advice.margins import Contact
from analytic.response import COMPARED, Difference
from analytic.rocking import design_bearings
from comparisons.commands.advice import _chosen
from comparisons.execution.command_runs import read_row
from comparisons.metrics.errors import Horizon
from comparisons.plotting.choices import print_choice
from comparisons.plotting.margins import _friction_words, _normal_words, print_bearings
from comparisons.plotting.terminal import comparison, mode_words, show, summary
from comparisons.schemas.advice import Choice, Level, VariantLevels

SCENE = load_scene("free-rocking-rigid")


@cache
def model():
    return simulate(SCENE, history=False)


FELL = Difference("outcome", "overturns", "rocks", None)
SLIDES = "the friction demand {:.3g} is above the scene's friction 0.1"


def slides(value):
    return Caution("model", SLIDES.format(value), "friction_demand", value, 0.1)


def solved(name, **changes):
    return replace(model(), engine=name, variant="one", comparable=COMPARED, **changes)


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
    first, *_ = printed(capsys, [model(), fell, solved("pybullet")])
    assert first == (
        "Outcomes differ: in analytic and pybullet it rocks and stays upright, in exudyn it overturns; "
        "exudyn differs from the analytic model."
    )
    first, *_ = printed(capsys, [model(), solved("exudyn")])
    assert first == "In both solvers it rocks and stays upright."
    failed = solved("exudyn", outcome="failed", failure=Failure("it gave up"))
    first, *_ = printed(capsys, [model(), failed])  # no outcome
    assert first == "In analytic it rocks and stays upright, in exudyn it failed."
    assert printed(capsys, [model()])[0].split() == [SCENE.name.split()[0], *SCENE.name.split()[1:]]


def test_a_warning_is_said_once_with_all_whom_it_concerns(capsys):
    odd, ours = Caution("record", "the peak is above 3 g."), Caution("engine", "steps are too long")
    responses = [
        replace(model(), warnings=(odd, slides(0.258))),
        solved("exudyn", warnings=(odd, slides(0.159))),
        solved("pybullet", warnings=(odd, ours)),
    ]
    printed_words = [line for line in printed(capsys, responses) if line.startswith("Warning")]
    assert printed_words == [
        "Warning, all solvers: the peak is above 3 g.",
        f"Warning, analytic and exudyn: {SLIDES.format(0.258)} (0.159 to 0.258)",
        "Warning, pybullet: steps are too long",
    ]
    (printed_words,) = [line for line in printed(capsys, responses[:1]) if "3 g" in line]
    assert printed_words.startswith("Warning, analytic: ")


def test_why_engines_cannot_be_compared_is_said_once(capsys):
    responses = [model(), *(replace(solved(name), comparable="N falls to 0") for name in ("exudyn", "pybullet"))]
    (printed_words,) = [line for line in printed(capsys, responses) if "N falls" in line]
    assert printed_words == "each of exudyn and pybullet cannot be compared with the analytic model: N falls to 0"


@pytest.mark.parametrize(
    "parted, words", [(True, "exudyn 2.5 s (1e-05)"), (False, "solvers' errors, 1e-05 at most, do not grow")]
)
def test_how_long_histories_are_compared_contradicts_no_dependence_on_the_motion(capsys, parted, words):
    cliff = Caution("motion", "The outcome depends on less than 5% of the motion.", "outcome", 0.01, 0.05)
    lines = printed(capsys, [replace(model(), warnings=(cliff,)), solved("exudyn")], {"exudyn": horizon(parted)})
    out = " ".join(" ".join(lines).split())
    assert lines[-1] == str(cliff) and words in out and "ot sensitive" not in out
    assert ("to the end, a difference between histories is a solver's error" in out) == (not parted)


def test_slip_of_a_block_that_slides_stands_in_both_tables(capsys):
    model = simulate(SAVED, history=False)
    off = replace(model, engine="exudyn", sliding=replace(model.sliding, peak=1.01 * model.sliding.peak))
    show(comparison(SAVED, [model, off, replace(model, engine="pymunk", sliding=None)], {}), [model])
    rows = [row.split() for row in capsys.readouterr().out.splitlines()]
    place = next(row for row in rows if row[:1] == ["solver"]).index("[s]") + 3
    slip = [row[place : place + 2] for row in rows if row[:1] in (["exudyn"], ["pymunk"])]
    assert slip == [[f"{1.01 * model.sliding.peak:.4g}", "+1e+00"], ["-", "0.0000"]]
    show(summary(SAVED, model), [model])
    printed_words = " ".join(capsys.readouterr().out.split())
    assert f"work of friction [J] {model.sliding.work:.4g}" in printed_words
    assert "contact stick, from 0.06138 s rock, from 0.09021 s slide-rock, from 0.5422 s rock" in printed_words
    show(summary(SAVED, replace(model, sliding=replace(model.sliding, peak=0.0))), [model])
    assert "slip" not in capsys.readouterr().out


def test_more_changes_of_contact_than_are_told_are_counted():
    modes = [(0.0, "stick"), *((float(k), ("rock", "slide-rock")[k % 2]) for k in range(1, 5)), (5.0, "slide-rock")]
    assert (
        mode_words(modes, 4)
        == "stick, from 1 s slide-rock, from 2 s rock, from 3 s slide-rock, 2 more changes (--json)"
    )
    assert mode_words([(0.0, "rock"), (1.0, "rock")]) == "rock"


def level(variant, value, *, cpu=1.0, error=1e-4, passes=False, untried=False, why=None):
    fields = dict(engine="exudyn", variant=variant, parameter="step", value=value, default=value == 0.1, runs=5)
    return Level(**fields, error=error, cpu_per_second=cpu, passes=passes, untried=untried, why=why)


def variant(name, *levels, imposed=False):
    return VariantLevels(
        engine="exudyn", variant=name, tier="tuned", applies_impact=imposed, order=None, levels=list(levels)
    )


CHOSEN = level("first", 0.2, passes=True)
VARIANTS = [
    variant("first", level("first", 0.4, why="error 2.0e-02"), CHOSEN, level("first", 0.1, cpu=2.0, passes=True)),
    variant("second", level("second", 0.3, cpu=4.0, untried=True), level("second", 0.1, cpu=5.0, untried=True)),
    variant("third", level("third", 0.3, why="error 3.0e-02"), level("third", 0.1, error=None, why="failed")),
]


def choice(**changed):
    fields = dict(scene="a scene", criterion="tilt", error=1e-3, safety_factor=2.0, neighbours=[1.0, 0.95], until=3.0)
    fields |= dict(chosen=CHOSEN, best=None, cpu_seconds=3.0, analytic_cpu_seconds=1e-3, variants=VARIANTS, parts=[])
    fields |= dict(
        command="rocking run s.toml --engine exudyn", snippet="response = 1\n", missing={}, left_out={}, warnings=[]
    )
    return Choice(**fields | changed)


def chosen(capsys, **options):
    print_choice(choice(**options.pop("changed", {})), **options)
    return capsys.readouterr().out


def test_the_answer_comes_first_then_its_use_then_a_line_per_variant(capsys):
    out = chosen(capsys)
    first, *rest = out.splitlines()
    assert first.startswith("exudyn, first, step = 0.2: error 1.0e-04 of tilt, asked for 0.001; 1 s of CPU time")
    assert out.index("rocking run s.toml") < out.index("response = 1") < out.index("exudyn, second")
    assert [" ".join(line.split()) for line in rest if "step = " in line] == [
        "exudyn, first step = 0.2 1.0e-04 1 CHOSEN",
        "exudyn, second step = 0.3 1.0e-04 4 not tried",
        "exudyn, third step = 0.1 - 1 failed",
    ]


def test_where_none_passes_the_best_is_named(capsys):
    out = chosen(capsys, changed={"chosen": None, "best": CHOSEN, "command": None, "snippet": None})
    words = "No level passes 0.001 for tilt with a factor of 2 to spare. The least error: 1.0e-04 by exudyn, first"
    assert out.startswith(f"{words}, step = 0.2.")


def test_an_imposed_impact_names_the_cheapest_that_computes_it(capsys):
    variants = [variant("first", CHOSEN, imposed=True), variant("second", level("second", 0.3, cpu=4.0, passes=True))]
    out = chosen(capsys, changed={"criterion": "restitution", "variants": variants})
    assert "computes the impact: exudyn, second, step = 0.3, at 4 s/s." in out
    out = chosen(capsys, changed={"criterion": "restitution", "variants": variants[:1] + VARIANTS[1:]})
    assert "computes the impact: none." in out


@pytest.mark.parametrize("place, index", [(0, 1), (1, 0), (2, 1)])
def test_the_cheapest_that_passes_else_untried_else_the_finest_stands_for_a_variant(place, index):
    assert VARIANTS[place].cheapest() == VARIANTS[place].levels[index]


ISOLATED = load_scene("caryatid-isolated")


@pytest.mark.parametrize("held, words", [(2, "0.10 %"), (700, "35 %"), (1999, "99.95 %"), (2000, "100 %")])
def test_the_share_that_holds_is_0_and_100_per_cent_only_where_none_and_all_do(capsys, held, words):
    periods, dampings = np.geomspace(0.3, 5.0, 200), np.linspace(0.02, 0.2, 10)
    demand = np.where(np.arange(2000) < held, 0.9, 1.1).reshape(10, 200)
    designs = [design_bearings(ISOLATED.total_mass, 1.0, float(damping), 0.25) for damping in dampings]
    scan = BearingScan(periods, dampings, demand, np.full((10, 200), 0.2), designs)
    chosen = {"least-stroke": _chosen(ISOLATED, scan, scan.least_stroke, {"own": [ISOLATED.motion]})}
    print_bearings(ISOLATED, scan, 0.25, 0.0, [read_row("own", ISOLATED.motion)], chosen)
    assert f", {words} meet this aim." in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    "least, friction, demand, words",
    [
        (-0.1, None, 0.2, "The normal force falls to -0.1 m g: the outcome is outside the model."),
        (0.0, 0.3, 0.2, "The normal force falls to 0: the block flies."),
        (0.25, None, 0.2, "The normal force falls to 0.25 m g; at 0 the block would jump."),
        (1.0, None, 0.2, "The friction demand is 0.2; the scene gives no coefficient to hold it against."),
        (1.0, 0.3, 0.4, "The friction demand is 0.4, the scene's coefficient 0.3, and the block slides."),
        (1.0, 0.5, 0.4, "The friction demand is 0.4, the scene's coefficient 0.5."),
    ],
)
def test_what_a_margin_says_of_contact(least, friction, demand, words):
    """A block flies in the model only where it may slide: without friction its outcome is outside."""
    contact = Contact(least, demand, friction, slides=demand > (friction or 1.0))
    assert " ".join(filter(None, (_normal_words(contact), _friction_words(contact)))).startswith(words)
