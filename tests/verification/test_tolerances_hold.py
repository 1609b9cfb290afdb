"""Every row of the tolerance table: the engine is run and held to it."""

import pytest

from comparisons.measuring.tolerances import TABLE


@pytest.fixture(scope="module")
def runs():
    """Runs that rows of one engine and variant share; these rows stay on one worker."""
    return {}


@pytest.mark.parametrize(
    "row",
    [pytest.param(row, id=row.name, marks=pytest.mark.xdist_group(f"{row.engine} {row.variant}")) for row in TABLE],
)
def test_row_of_the_tolerance_table(row, runs):
    value = row.check(runs)
    # Much better than when the bound was set: then the bound says nothing any more.
    assert row.round_off or value >= row.measured / 4, f"{row.name}: {value:.3g}; tighten the table"
