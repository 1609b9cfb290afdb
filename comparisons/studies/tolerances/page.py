"""What is shown of the tolerances study."""

from ...running.provenance import Result
from ...showing.parts import NAME, Column, Page, table, where


def page(result: Result) -> Page:
    broken = len(where(result.rows, holds=False))
    return Page(
        f"Agreement tolerances: {f'{broken} of {len(result.rows)} do not hold' if broken else 'all hold'}",
        (
            f"{len(result.rows)} tolerances, each the assertion of a test. A bound is at most twice the worst error "
            "measured when it was set, but for round-off.",
            *(
                f"{engine} states no tolerances, so none is measured."
                for engine in result.settings["engines"]
                if not where(result.rows, engine=engine)
            ),
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
                Column("holds", lambda row: "yes" if row["holds"] else "no"),
                Column("where the error comes from", "source"),
            ),
        ),
    )
