"""The overturning study's result in words and tables, from the result alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...showing.parts import Section, Table, figure_of, number, percent
from ...showing.wording import solver_name
from .figures import LIMIT, draw_knobs, draw_maps, draw_shifts, knob_curves

if TYPE_CHECKING:
    from ...running.provenance import Result


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    solvers = result.settings["solvers"]
    text = [
        _asked(result),
        *(_verdict(result, solver) for solver in solvers),
        *(
            f"{solver} does not decide the impact: its adapter applies the analytic model's. Its boundaries tell of "
            "its integration alone, and no other setting of it is tried."
            for solver in solvers
            if solver in result.settings["held"]
        ),
        *_pulled_words(result),
        _band(result),
        *(_knob_words(result, *key, values) for key, values in knob_curves(result).items()),
        *filter(None, (_first_words(result, solver) for solver in result.settings["first_scripts"])),
        _failures(result),
        *_unfinished(result),
    ]
    tables = [_shift_table(result), _boundary_table(result), _confusion_table(result), _knob_table(result)]
    missed = [row for row in _rows(result, "shift") if row["shift"] is None]
    if missed:
        tables.append(_missed_table(result, missed))
    if _rows(result, "held"):
        tables.append(_pulled_table(result))
    surprises = _rows(result, "surprise")
    if surprises:
        tables.append(_surprise_table(surprises))
    found = sum(row["shift"] is not None for row in _rows(result, "shift"))
    figures = [
        figure_of(
            draw_maps(result),
            "Maps of outcomes over pulse frequency and amplitude with the engines' "
            f"boundaries marked; {len(surprises)} disagreements outside the band.",
            "Colours: the analytic model. Symbols: boundaries found with the engines. Crosses: scanned points "
            "where an engine's outcome differs. White above colour is the safe gap between two ways to "
            "overturn.",
        ),
        figure_of(
            draw_shifts(result),
            f"Shift of {found} boundaries in per cent over pulse frequency, beside a "
            f"band of plus and minus {LIMIT:g} per cent.",
            f"Boundary of the engine over that of the analytic model, minus one. Bars: width of the last "
            f"bracket. Grey: {LIMIT:g} %. The axis is linear within ±0.01 %, logarithmic beyond.",
        ),
    ]
    if knob_curves(result):
        figures.append(
            figure_of(
                draw_knobs(result),
                "Largest and median shift of the boundaries over step, accuracy or stiffness.",
                f"One-sine pulses on both grounds. Dotted: {LIMIT:g} %. A shift is "
                f"known to ± {percent(result.settings['tolerance'] / 2, 1)} at default settings, to "
                f"± {percent(result.settings['knob_tolerance'] / 2, 1)} at others.",
            )
        )
    evidence = tuple(
        (
            f"{row['solver']}, {row['ground']}, {row['shape']}, frequency {row['frequency']:g}, amplitude "
            f"{row['amplitude']:.6g}",
            f"{row['reason']}\n{row.get('message') or ''}",
        )
        for row in _rows(result, "failure")[:50]
    )
    verdicts = tuple(_trust(result, solver) for solver in solvers)
    return Section(
        "Overturning under pulses: where the boundaries lie",
        (*verdicts, *text),
        tuple(tables),
        tuple(figures),
        evidence=evidence,
        verdicts=verdicts,
    )


def _asked(result):
    s = result.settings
    edges = _rows(result, "edge")
    grounds = "; ".join(
        f"{name}: slenderness {given['block']['slenderness']:g}"
        + (
            f" on {given['bearings']['count']} bearings and a base of {given['base']['mass']:g} kg"
            if given["base"]
            else ""
        )
        for name, given in s["grounds"].items()
    )
    return (
        "Under a pulse the block overturns above a certain amplitude, may stand again in a safe gap, and "
        f"overturns once more. The analytic model has {len(edges)} such boundaries for the pulses "
        f"{', '.join(s['shapes'])} of {min(s['frequencies']):g} to {max(s['frequencies']):g} times "
        f"ω_r and amplitudes of {s['amplitudes'][0]:g} to {s['amplitudes'][1]:g} g tan(slenderness), on two "
        f"grounds ({grounds}). "
        f"{', '.join(s['solvers'])} were asked for theirs at default settings."
    )


def _trust(result, solver):
    """May I trust it for overturning?"""
    rows = [row for row in _rows(result, "shift", solver=solver) if _least_normal(result, row) >= 0]
    found = [row for row in rows if row["shift"] is not None]
    outside = _rows(result, "confusion", region="outside", solver=solver)
    wrong, size = sum(row["only_a"] + row["only_b"] for row in outside), sum(_size(row) for row in outside)
    yes = _all_within(rows) and not wrong
    largest = f", shifted by {percent(max(abs(row['shift']) for row in found))} at most" if found else ""
    return (
        f"{solver} {'may' if yes else 'is not to'} be trusted for overturning at its default setting, as long as "
        f"the block stays pressed on its base in the analytic model: {len(found)} of {len(rows)} boundaries found"
        f"{largest}; further than {percent(result.settings['band'], 1)} from them {wrong} of {size} outcomes "
        "differ."
    )


def _verdict(result, solver):
    rows = _rows(result, "shift", solver=solver)
    found = [row for row in rows if row["shift"] is not None]
    gaps = sum(not row["rises"] for row in rows)
    seen = sum(not row["rises"] for row in found)
    if not found:
        return f"{solver}: none of {len(rows)} boundaries found."
    return (
        f"{solver}: of all {len(rows)} boundaries {len(found)} found, among them {seen} of {gaps} beginnings of a "
        f"safe gap. {_within(rows)}, the median shift is {percent(_median([abs(row['shift']) for row in found]))}."
    )


def _pulled_words(result):
    """What the boundaries are worth at which the analytic model would have to be held down."""
    edges = [edge for edge in _rows(result, "edge") if edge["min_normal"] < 0]
    if not edges:
        return
    text = (
        f"At {len(edges)} boundaries the normal force of the analytic model becomes negative (down to "
        f"{number(min(edge['min_normal'] for edge in edges), 2)} m g): it holds the corner down, where a block in "
        "contact slides or leaves its base, as it does in the engines. There the analytic model is the one not to "
        "be trusted."
    )
    for solver, label in result.settings["held"].items():
        held = _rows(result, "held", solver=solver)
        found = [abs(row["shift"]) for row in held if row["shift"] is not None]
        if found:
            text += (
                f" With the corner held by the adapter ({label}) the same scenes give {len(found)} of these "
                f"{len(held)} boundaries, shifted by {percent(max(found), 1)} at most"
            )
            text += ": it is the contact that moves them, not the integration." if _all_within(held) else "."
    yield text


def _all_within(rows):
    return all(row["shift"] is not None and abs(row["shift"]) + row["half_width"] <= LIMIT / 100 for row in rows)


def _within(rows):
    """Whether all boundaries were found within the limit, and the largest shift."""
    found = [row for row in rows if row["shift"] is not None]
    worst = max(found, key=lambda row: abs(row["shift"]))
    return (
        f"{'All boundaries lie' if _all_within(rows) else 'Not all boundaries lie'} within {LIMIT:g} % of the "
        f"analytic ones; the largest shift is {percent(worst['shift'])} (± {percent(worst['half_width'], 1)}: "
        f"{worst['shape']}, {worst['ground']}, frequency {worst['frequency']:g}, "
        f"amplitude {number(worst['amplitude'], 4)})"
    )


def _least_normal(result, row):
    (edge,) = _rows(result, "edge", **{key: row[key] for key in ("ground", "shape", "frequency", "amplitude")})
    return edge["min_normal"]


def _band(result):
    rows = _rows(result, "confusion", region="outside")
    size = sum(_size(row) for row in rows)
    wrong = sum(row["only_a"] + row["only_b"] for row in rows)
    near = sum(_size(row) for row in _rows(result, "confusion", region="inside"))
    pulled = _rows(result, "confusion", region="pulled")
    apart = (
        f" Where its normal force becomes negative, {sum(row['only_a'] + row['only_b'] for row in pulled)} of "
        f"{sum(_size(row) for row in pulled)} do."
        if pulled
        else ""
    )
    return (
        f"Further than {percent(result.settings['band'], 1)} from any boundary, {wrong} of {size} runs of the "
        "engines end otherwise than the analytic model, as long as the block stays pressed on its base in that "
        f"model.{apart} Within that band {near} more runs were made in search of the boundaries; disagreement "
        "there is what a shifted boundary means."
    )


def _knob_words(result, solver, knob, values):
    good, bad = [], []
    for value, rows in values.items():
        shifts = [abs(row["shift"]) for row in rows if row["shift"] is not None]
        (good if len(shifts) == len(rows) and max(shifts) <= LIMIT / 100 else bad).append(value)

    def listed(chosen):
        return ", ".join(number(value, 2) for value in sorted(chosen)) or "none"

    return f"{solver}, {knob}: all boundaries within {LIMIT:g} % at {listed(good)}; not at {listed(bad)} (SI units)."


def _first_words(result, solver):
    rows = _rows(result, "knob", solver=solver)
    if not rows:
        return None
    found = [row["shift"] for row in rows if row["shift"] is not None]
    span = f"those found are shifted by {percent(min(found))} to {percent(max(found))}" if found else ""
    reasons = {}
    for row in rows:
        if row["shift"] is None:
            key = row["ground"], row["reason"].split(",")[0]
            reasons[key] = reasons.get(key, 0) + 1
    lost = "; ".join(f"{ground}: {why} ({count})" for (ground, why), count in reasons.items())
    text = (
        f"First script, {solver}: {len(found)} of {len(rows)} boundaries found"
        + (f"; {span}" if span else "")
        + (f". Not found, within 30 % or half-way to the next boundary: {lost}." if lost else ".")
    )
    friction = result.settings["friction"].get(solver, math.inf)
    slides = [name for name, given in result.settings["grounds"].items() if given["tan_slenderness"] > friction]
    if any(ground in slides for ground, _ in reasons):
        text += (
            f" On {' and '.join(slides)} its friction, {friction:g} by its defaults, is below tan(slenderness): the "
            "block slides where it should lift."
        )
    return text


def _failures(result):
    counts = {}
    jumped = 0
    for row in _rows(result, "failure"):
        counts[row["solver"], row["reason"]] = counts.get((row["solver"], row["reason"]), 0) + 1
        jumped += row["kind"] != "undecided" and row["min_normal"] < 0
    if not counts:
        return "No run failed or stayed undecided."
    words = "; ".join(f"{solver}: {reason} ({count})" for (solver, reason), count in counts.items())
    return (
        f"Runs without an outcome, left out of the tables: {words}. In {jumped} of them the normal force of the "
        "analytic model becomes negative."
    )


def _unfinished(result):
    """What a result lacks that was written before the study came to its end."""
    done = {(row["solver"], *row["settings"]) for row in _rows(result, "knob")}
    missing = [
        f"{solver_name(solver, variant)} ({knob})"
        for solver, variant, knob in result.settings["knobs"]
        if (solver_name(solver, variant), knob) not in done
    ]
    if missing and not result.settings["quick"]:
        yield f"The study was stopped before its end; other settings were not tried of: {', '.join(missing)}."


def _shift_table(result):
    s, rows = result.settings, []
    for ground in s["grounds"]:
        for shape in s["shapes"]:
            cells = [f"{ground}, {shape}", str(len(_rows(result, "edge", ground=ground, shape=shape)))]
            for solver in s["solvers"]:
                group = _rows(result, "shift", solver=solver, ground=ground, shape=shape)
                shifts = [abs(row["shift"]) for row in group if row["shift"] is not None]
                cells += [
                    str(len(shifts)),
                    number(100 * _median(shifts), 2) if shifts else "–",
                    number(100 * max(shifts), 2) if shifts else "–",
                ]
            rows.append(cells)
    heads = [
        f"{solver}: {what}"
        for solver in s["solvers"]
        for what in ("found [-]", "median |shift| [%]", "largest |shift| [%]")
    ]
    return Table("Boundaries at default settings", ("ground, pulse", "analytic boundaries [-]", *heads), rows)


def _boundary_table(result):
    s, rows = result.settings, []
    for edge in _rows(result, "edge", shape=s["shapes"][0]):
        cells = []
        for solver in s["solvers"]:
            (row,) = _rows(
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


def _confusion_table(result):
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
        for row in _rows(result, "confusion")
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


def _knob_table(result):
    rows = []
    for (solver, knob), values in knob_curves(result).items():
        for value in sorted(values):
            rows.append(_knob_row(f"{solver}, {knob} {number(value, 3)}", values[value]))
    for solver in result.settings["first_scripts"]:
        group = _rows(result, "knob", solver=solver)
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
        number(100 * _median(shifts), 2) if shifts else "–",
        number(100 * max(shifts), 2) if shifts else "–",
    ]


def _missed_table(result, rows):
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
                number(_least_normal(result, row), 2),
                row["reason"],
            ]
            for row in rows
        ],
    )


def _pulled_table(result):
    s, rows = result.settings, []
    for edge in _rows(result, "edge"):
        if edge["min_normal"] < 0:
            key = {name: edge[name] for name in ("ground", "shape", "frequency", "amplitude")}
            found = [
                *(_rows(result, "shift", solver=solver, **key)[0] for solver in s["solvers"]),
                *(_rows(result, "held", solver=solver, **key)[0] for solver in s["held"]),
            ]
            rows.append(
                [
                    f"{edge['ground']}, {edge['shape']}, {edge['frequency']:g}",
                    number(edge["amplitude"], 6),
                    number(edge["min_normal"], 2),
                    *("not found" if row["shift"] is None else number(100 * row["shift"], 2) for row in found),
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


def _surprise_table(rows):
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


def _size(row):
    return row["both_stand"] + row["both_overturn"] + row["only_a"] + row["only_b"]


def _median(values):
    values = sorted(values)
    middle = len(values) // 2
    return math.nan if not values else 0.5 * (values[middle] + values[-1 - middle])


def _rows(result, part, **wanted):
    return [
        row for row in result.rows if row["part"] == part and all(row[key] == value for key, value in wanted.items())
    ]
