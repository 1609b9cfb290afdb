"""The order in which a choice is told: the answer, how it is used, a line per variant."""

import pytest

from comparisons.advice.criteria import Choice, Level, VariantLevels
from comparisons.showing.choices import print_choice


def level(variant, value, *, cpu=1.0, error=1e-4, passes=False, untried=False, why=None):
    own = dict(engine="exudyn", variant=variant, parameter="step", value=value, default=value == 0.1, runs=5)
    return Level(**own, error=error, cpu_per_second=cpu, passes=passes, untried=untried, why=why)


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
    own = dict(scene="a scene", criterion="tilt", error=1e-3, safety_factor=2.0, neighbours=[1.0, 0.95], until=3.0)
    own |= dict(chosen=CHOSEN, best=None, cpu_seconds=3.0, analytic_cpu_seconds=1e-3, variants=VARIANTS, parts=[])
    own |= dict(
        command="rocking run s.toml --engine exudyn", snippet="response = 1\n", missing={}, left_out={}, warnings=[]
    )
    return Choice(**own | changed)


def printed(capsys, **options):
    print_choice(choice(**options.pop("changed", {})), **options)
    return capsys.readouterr().out


def test_the_answer_comes_first_then_its_use_then_a_line_per_variant(capsys):
    out = printed(capsys)
    first, *rest = out.splitlines()
    assert first.startswith("exudyn, first, step = 0.2: error 1.0e-04 of tilt, asked for 0.001; 1 s of CPU time")
    assert out.index("rocking run s.toml") < out.index("response = 1") < out.index("exudyn, second")
    assert [" ".join(line.split()) for line in rest if "step = " in line] == [
        "exudyn, first step = 0.2 1.0e-04 1 CHOSEN",
        "exudyn, second step = 0.3 1.0e-04 4 not tried",
        "exudyn, third step = 0.1 - 1 failed",
    ]


def test_all_shows_every_level(capsys):
    out = printed(capsys, every_level=True)
    assert out.count("step = ") == 1 + sum(len(each.levels) for each in VARIANTS) and "error 2.0e-02" in out


def test_where_none_passes_the_best_is_named(capsys):
    out = printed(capsys, changed={"chosen": None, "best": CHOSEN, "command": None, "snippet": None})
    words = "No level passes 0.001 for tilt with a factor of 2 to spare. The least error: 1.0e-04 by exudyn, first"
    assert out.startswith(f"{words}, step = 0.2.")


def test_an_imposed_impact_names_the_cheapest_that_computes_it(capsys):
    variants = [variant("first", CHOSEN, imposed=True), variant("second", level("second", 0.3, cpu=4.0, passes=True))]
    out = printed(capsys, changed={"criterion": "restitution", "variants": variants})
    assert "computes the impact: exudyn, second, step = 0.3, at 4 s/s." in out
    out = printed(capsys, changed={"criterion": "restitution", "variants": variants[:1] + VARIANTS[1:]})
    assert "computes the impact: none." in out


@pytest.mark.parametrize("place, index", [(0, 1), (1, 0), (2, 1)])
def test_the_cheapest_that_passes_else_untried_else_the_finest_stands_for_a_variant(place, index):
    assert VARIANTS[place].cheapest() == VARIANTS[place].levels[index]
