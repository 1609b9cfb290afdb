"""The section about the report's own runs: what each solver made of the same scenes, in one figure and one table."""

from analytic.records import G

from ..running.provenance import Result
from ..showing.charts import figure
from ..showing.parts import Section, Table, number
from ..showing.rows import Column, table
from ..showing.wording import outcomes
from .figures import ANALYTIC, pairs
from .sections import failures, warned

CAPTION = (
    "Left: all solvers over each other. Right: how far the engines are from the analytic model, logarithmic. A "
    "block that never lifts in any solver has no tilt to show."
)


def earthquake(result: Result) -> Section:
    """The `Section` of the scenes under their motion."""
    scenes, motion = result.settings["scenes"], result.settings["motion"]
    charts = [chart for name in scenes for pair in pairs(result, name) for chart in pair]
    found = "; ".join(
        f"{scene['name']}: {outcomes([row for row in result.rows if row['scene'] == name])}"
        for name, scene in scenes.items()
    )
    under = f"Under {motion['label']}, peak {number(motion['peak'] / G)} g. " if motion else ""
    warnings = [
        [scenes[name]["name"], ", ".join(who), words] for name in scenes for words, who in warned(result, name).items()
    ]
    told = Table("Warnings, and differences from the analytic model", ("scene", "solver", "warning"), warnings)
    return Section(
        f"{'One earthquake' if motion else 'One scene'}: {found}",
        (
            f"{under}Each solver runs until its outcome is decided. Tilt is compared up to the sensitivity horizon, "
            "the same for all: after it a change of the scene by 10⁻⁴ visibly changes the motion.",
        ),
        (_table(result), told) if warnings else (_table(result),),
        (figure(charts, CAPTION, [row["engine"] for row in result.rows]),) if charts else (),
        evidence=failures(result),
        measured=(
            "Distance of tilt graphs (Hausdorff): how far a point of one can lie from the other, time in units of "
            "2π/ω_r and tilt in units of γ. Friction demand and normal force are taken over the run, but for the fall "
            "of a block that overturns; engines' are computed from their states by the model's equations. All that was "
            "measured of these runs, the bearings' loops among it, is on the page of the runs.",
        ),
    )


def _table(result):
    def agreement(key):
        return lambda row: (row.get("agreement") or {}).get(key) if row["engine"] != ANALYTIC else None

    return table(
        "Outcomes, and distance from the analytic model up to the sensitivity horizon",
        result.rows,
        Column("solver", "engine"),
        Column("scene", lambda row: result.settings["scenes"][row["scene"]]["name"]),
        Column("outcome", "outcome_text"),
        Column("overturns at [s]", lambda row: row.get("overturning_time"), 5),
        Column("peak |φ|/γ [-]", lambda row: row.get("peak_tilt_ratio"), 3),
        Column("peak x [m]", lambda row: row.get("peak_base_displacement"), 4),
        Column("its error", agreement("peak_displacement_error"), percent=True),
        Column("distance of tilt graphs [-]", agreement("graph_distance")),
        Column("horizon [s]", agreement("until"), 3),
        Column("warnings", lambda row: len(row.get("warnings") or ())),
    )
