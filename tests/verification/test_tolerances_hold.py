"""Every row of the tolerance table: the engine is run and held to it."""

import pickle

import pytest
from engine_cases import ACCURATE

from comparisons.measuring import agreement
from comparisons.measuring.tolerances import TABLE

RUNS, KEPT = {}, {}  # what rows of one variant share; these rows stay on one worker


@pytest.fixture
def shared(monkeypatch):
    """A scene is run once for all rows of a variant."""
    traced = agreement.traced

    def once(engine, variant, scene, history=True):
        asked = engine, variant, pickle.dumps(scene)
        if asked not in KEPT:
            KEPT[asked] = traced(engine, variant, scene)
        return KEPT[asked]

    monkeypatch.setattr(agreement, "traced", once)


def marks(row):
    """Main variants first; the others, and other engines by the hook, in the second command."""
    group = pytest.mark.xdist_group(f"{row.engine} {row.variant}")
    return [group] if ACCURATE.get(row.engine) == row.variant else [group, pytest.mark.slow]


@pytest.mark.parametrize("row", [pytest.param(row, id=row.name, marks=marks(row)) for row in TABLE])
def test_row_of_the_tolerance_table(row, shared):
    value = row.check(RUNS)
    # Much better than when the bound was set: then the bound says nothing any more.
    assert row.round_off or value >= row.measured / 4, f"{row.name}: {value:.3g}; tighten the table"
