"""What is shown of the tolerances, a result of no study: ``rocking verify --output DIR`` measures and writes it."""

from ..running.provenance import Result
from ..showing.parts import NAME, Column, Page, table, where


def page(result: Result) -> Page:
    broken, bounded = where(result.rows, holds=False), where(result.rows, holds={True, False})
    return Page(
        f"Agreement tolerances: {f'{len(broken)} of {len(bounded)} do not hold' if broken else 'all hold'}",
        (
            f"{len(bounded)} tolerances, each the assertion of a test. A bound is at most twice the worst error "
            "measured when it was set, but for round-off.",
        ),
        more=(
            table(
                "Tolerances and what is measured",
                result.rows,
                NAME,
                Column("quantity", "quantity"),
                Column("scenes", lambda row: row["scenes"].replace("omega_r", "ωᵣ")),
                Column("tolerance", "bound"),
                Column("measured when set", "measured", digits=3),
                Column("measured now", lambda row: row["failure"] or row["found"], digits=3),
                Column("unit", "unit"),
                Column("holds", lambda row: {True: "yes", False: "no"}.get(row["holds"], "no bound stated")),
                Column("where the error comes from", "source"),
            ),
        ),
    )
