"""Columns and page of the tolerance table, which ``rocking verify --output DIR`` measures and no study does."""

from ..execution.results import Result
from ..plotting.parts import Page, table, where
from ..schemas.columns import NAME, Column, declared, flag_of, number_of, word_of
from .rows import SHARED

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("quantity", "quantity", "whose error is bounded"),
    word_of("scenes", "scenes", "scenes on which it is measured"),
    number_of("bound", "tolerance", "largest error allowed; null: none is stated", "see unit"),
    word_of("unit", "unit", "unit of error and bound"),
    number_of("measured", "measured when set", "error when the bound was set", "see unit", digits=3),
    number_of("found", "found", "error now", "see unit"),
    flag_of("holds", "holds", "whether the error now is within the bound; null: no bound is stated"),
    word_of("source", "where the error comes from", "where the error comes from"),
    word_of("failure", "failure", "why nothing was found; null where something was"),
)
PARTS = {"tolerance": "quantity engine variant scenes bound? unit measured? source found? holds? failure?"}


def page(result: Result) -> Page:
    """Return the page of a result."""
    broken, bounded = where(result.rows, holds=False), where(result.rows, holds={True, False})
    return Page(
        f"Agreement tolerances: {f'{len(broken)} of {len(bounded)} do not hold' if broken else 'all hold'}",
        (
            f"Each of the {len(bounded)} tolerances is the assertion of a test. Except for errors of round-off, a "
            "tolerance is at most twice the worst error measured when it was set.",
        ),
        more=(
            table(
                "Tolerances and what is measured",
                result.rows,
                NAME,
                COLUMNS["quantity"],
                Column("scenes", lambda row: row["scenes"].replace("omega_r", "ωᵣ")),
                COLUMNS["bound"],
                COLUMNS["measured"],
                Column("measured now", lambda row: row["failure"] or row["found"], digits=3),
                COLUMNS["unit"],
                Column("holds", lambda row: {True: "yes", False: "no"}.get(row["holds"], "no bound stated")),
                COLUMNS["source"],
            ),
        ),
    )
