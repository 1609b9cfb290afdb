"""The study's result in tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.parts import Table, number, percent
from .figures import knob_curves
from .rows import least_normal_of, median, rows_of

if TYPE_CHECKING:
    from ...running.provenance import Result
    from .rows import Rows


def tables(result: Result) -> tuple[Table, ...]:
    """All of them; those of what was missed, pulled or a surprise only where there is any."""
    missed = [row for row in rows_of(result, "shift") if row["shift"] is None]
    surprises = rows_of(result, "surprise")
    return (
        shift_table(result),
        boundary_table(result),
        confusion_table(result),
        knob_table(result),
        *([missed_table(result, missed)] if missed else ()),
        *([pulled_table(result)] if rows_of(result, "held") else ()),
        *([surprise_table(surprises)] if surprises else ()),
    )


def shift_table(result: Result) -> Table:
    s, rows = result.settings, []
    for ground in s["grounds"]:
        for shape in s["shapes"]:
            edges = len(rows_of(result, "edge", ground=ground, shape=shape))
            for solver in s["solvers"]:
                group = rows_of(result, "shift", solver=solver, ground=ground, shape=shape)
                shifts = [abs(row["shift"]) for row in group if row["shift"] is not None]
                rows.append(
                    [
                        f"{ground}, {shape}: {solver}",
                        f"{len(shifts)} of {edges}",
                        number(100 * median(shifts), 2) if shifts else "–",
                        number(100 * max(shifts), 2) if shifts else "–",
                    ]
                )
    return Table(
        "Boundaries at default settings",
        ("ground, pulse: solver", "boundaries found [-]", "median |shift| [%]", "largest |shift| [%]"),
        rows,
    )


def boundary_table(result: Result) -> Table:
    s, rows = result.settings, []
    for edge in rows_of(result, "edge", shape=s["shapes"][0]):
        cells = []
        for solver in s["solvers"]:
            (row,) = rows_of(
                result,
                "shift",
                solver=solver,
                **{key: edge[key] for key in ("ground", "shape", "frequency", "amplitude")},
            )
            cells.append("not found" if row["shift"] is None else number(100 * row["shift"], 2))
        rows.append(
            [
                f"{edge['ground']}, frequency {edge['frequency']:g}",
                f"{edge['amplitude']:.5f}",
                "begins" if edge["rises"] else "ends",
                str(edge["mode"]),
                *cells,
            ]
        )
    return Table(
        f"Boundaries under one pulse ({s['shapes'][0]}), amplitude over g tan(slenderness), and the engines' "
        f"shifts, known to ± {percent(s['tolerance'] / 2, 1)}",
        (
            "ground, frequency over ω_r",
            "analytic amplitude [-]",
            "overturning",
            "after impacts [-]",
            *(f"{solver} [%]" for solver in s["solvers"]),
        ),
        rows,
    )


def confusion_table(result: Result) -> Table:
    band = percent(result.settings["band"], 1)
    names = {
        "scan": "coarse scan of the map",
        "outside": f"all runs further than {band} from a boundary, N ≥ 0",
        "pulled": f"all runs further than {band} from a boundary, N < 0",
        "inside": "all runs nearer",
    }
    rows = [
        [
            f"{row['solver']}, {row['ground']}: {names[row['region']]}",
            str(row["both_stand"]),
            str(row["both_overturn"]),
            str(row["only_a"]),
            str(row["only_b"]),
            "–"
            if row["region"] == "inside" or row["kappa"] is None
            else f"{number(row['kappa'])} ({number(row['kappa_low'])} to {number(row['kappa_high'])})",
        ]
        for row in rows_of(result, "confusion")
    ]
    return Table(
        "Outcomes in the engine and in the analytic model; N: least normal force of that model",
        (
            "engine, ground: runs",
            "both stand [-]",
            "both overturn [-]",
            "only the analytic model overturns [-]",
            "only the engine overturns [-]",
            "Cohen's kappa (95 % interval) [-]",
        ),
        rows,
    )


def knob_table(result: Result) -> Table:
    rows = []
    for (solver, knob), values in knob_curves(result).items():
        for value in sorted(values):
            rows.append(_knob_row(f"{solver}, {knob} {number(value, 3)}", values[value]))
    for solver in result.settings["first_scripts"]:
        group = rows_of(result, "knob", solver=solver)
        if group:
            ((knob, value),) = group[0]["settings"].items()
            rows.append(_knob_row(f"first script: {solver}, {knob} {number(value, 3)}", group))
    return Table(
        "Shift of the boundaries against step, accuracy or stiffness (one-sine pulses, both grounds)",
        ("solver and setting (SI units)", "found [-]", "median |shift| [%]", "largest |shift| [%]"),
        rows,
    )


def _knob_row(name, rows):
    shifts = [abs(row["shift"]) for row in rows if row["shift"] is not None]
    return [
        name,
        f"{len(shifts)} of {len(rows)}",
        number(100 * median(shifts), 2) if shifts else "–",
        number(100 * max(shifts), 2) if shifts else "–",
    ]


def missed_table(result: Result, rows: Rows) -> Table:
    return Table(
        "Boundaries not found at default settings",
        (
            "engine",
            "ground, pulse, frequency",
            "analytic amplitude [-]",
            "half-way to the next boundary [%]",
            "least N/(m g) of the analytic model [-]",
            "why",
        ),
        [
            [
                row["solver"],
                f"{row['ground']}, {row['shape']}, {row['frequency']:g}",
                number(row["amplitude"], 6),
                number(100 * row["room"], 2),
                number(least_normal_of(result, row), 2),
                row["reason"],
            ]
            for row in rows
        ],
    )


def pulled_table(result: Result) -> Table:
    s, rows = result.settings, []
    for edge in rows_of(result, "edge"):
        if edge["min_normal"] < 0:
            key = {name: edge[name] for name in ("ground", "shape", "frequency", "amplitude")}
            shifted = [
                *(rows_of(result, "shift", solver=solver, **key)[0] for solver in s["solvers"]),
                *(rows_of(result, "held", solver=solver, **key)[0] for solver in s["held"]),
            ]
            rows.append(
                [
                    f"{edge['ground']}, {edge['shape']}, {edge['frequency']:g}",
                    number(edge["amplitude"], 6),
                    number(edge["min_normal"], 2),
                    *("not found" if row["shift"] is None else number(100 * row["shift"], 2) for row in shifted),
                ]
            )
    return Table(
        "Boundaries at which the analytic model holds the corner down, and their shifts",
        (
            "ground, pulse, frequency",
            "analytic amplitude [-]",
            "least N/(m g) of the analytic model [-]",
            *(f"{solver} [%]" for solver in s["solvers"]),
            *(f"corner held: {label} [%]" for label in s["held"].values()),
        ),
        rows,
    )


def surprise_table(rows: Rows) -> Table:
    return Table(
        "Disagreements outside the band",
        (
            "engine",
            "ground, pulse, frequency",
            "amplitude [-]",
            "distance from the nearest boundary [%]",
            "least N/(m g) of the analytic model [-]",
            "analytic model",
        ),
        [
            [
                row["solver"],
                f"{row['ground']}, {row['shape']}, {row['frequency']:g}",
                number(row["amplitude"], 6),
                number(100 * row["distance"], 2) if row["distance"] is not None else "–",
                number(row["min_normal"], 2),
                "overturns" if row["analytic_overturns"] else "stands",
            ]
            for row in rows
        ],
    )
