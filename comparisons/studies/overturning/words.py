"""The study's result in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...showing.parts import number, percent
from ...showing.wording import solver_name
from .figures import LIMIT
from .rows import least_normal_of, median, rows_of, size_of

if TYPE_CHECKING:
    from ...running.provenance import Result
    from .rows import Rows


def asked(result: Result) -> str:
    s = result.settings
    edges = rows_of(result, "edge")
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


def trust(result: Result, solver: str) -> str:
    """May I trust it for overturning?"""
    rows = [row for row in rows_of(result, "shift", solver=solver) if least_normal_of(result, row) >= 0]
    shifted = [row for row in rows if row["shift"] is not None]
    outside = rows_of(result, "confusion", region="outside", solver=solver)
    wrong, size = sum(row["only_a"] + row["only_b"] for row in outside), sum(size_of(row) for row in outside)
    yes = _all_within(rows) and not wrong
    largest = f", shifted by {percent(max(abs(row['shift']) for row in shifted))} at most" if shifted else ""
    return (
        f"{solver} {'may' if yes else 'is not to'} be trusted for overturning at its default setting, as long as "
        f"the block stays pressed on its base in the analytic model: {len(shifted)} of {len(rows)} boundaries found"
        f"{largest}; further than {percent(result.settings['band'], 1)} from them {wrong} of {size} outcomes "
        "differ."
    )


def verdict(result: Result, solver: str) -> str:
    rows = rows_of(result, "shift", solver=solver)
    shifted = [row for row in rows if row["shift"] is not None]
    gaps = sum(not row["rises"] for row in rows)
    seen = sum(not row["rises"] for row in shifted)
    if not shifted:
        return f"{solver}: none of {len(rows)} boundaries found."
    return (
        f"{solver}: of all {len(rows)} boundaries {len(shifted)} found, among them {seen} of {gaps} beginnings of a "
        f"safe gap. {_within(rows)}, the median shift is {percent(median([abs(row['shift']) for row in shifted]))}."
    )


def pulled(result: Result) -> Iterator[str]:
    """What the boundaries are worth at which the analytic model would have to be held down."""
    edges = [edge for edge in rows_of(result, "edge") if edge["min_normal"] < 0]
    if not edges:
        return
    text = (
        f"At {len(edges)} boundaries the normal force of the analytic model becomes negative (down to "
        f"{number(min(edge['min_normal'] for edge in edges), 2)} m g): it holds the corner down, where a block in "
        "contact slides or leaves its base, as it does in the engines. There the analytic model is the one not to "
        "be trusted."
    )
    for solver, label in result.settings["held"].items():
        held = rows_of(result, "held", solver=solver)
        shifts = [abs(row["shift"]) for row in held if row["shift"] is not None]
        if shifts:
            text += (
                f" With the corner held by the adapter ({label}) the same scenes give {len(shifts)} of these "
                f"{len(held)} boundaries, shifted by {percent(max(shifts), 1)} at most"
            )
            text += ": it is the contact that moves them, not the integration." if _all_within(held) else "."
    yield text


def _all_within(rows):
    return all(row["shift"] is not None and abs(row["shift"]) + row["half_width"] <= LIMIT / 100 for row in rows)


def _within(rows):
    """Whether all boundaries were found within the limit, and the largest shift."""
    shifted = [row for row in rows if row["shift"] is not None]
    worst = max(shifted, key=lambda row: abs(row["shift"]))
    return (
        f"{'All boundaries lie' if _all_within(rows) else 'Not all boundaries lie'} within {LIMIT:g} % of the "
        f"analytic ones; the largest shift is {percent(worst['shift'])} (± {percent(worst['half_width'], 1)}: "
        f"{worst['shape']}, {worst['ground']}, frequency {worst['frequency']:g}, "
        f"amplitude {number(worst['amplitude'], 4)})"
    )


def band(result: Result) -> str:
    rows = rows_of(result, "confusion", region="outside")
    size = sum(size_of(row) for row in rows)
    wrong = sum(row["only_a"] + row["only_b"] for row in rows)
    near = sum(size_of(row) for row in rows_of(result, "confusion", region="inside"))
    pulled = rows_of(result, "confusion", region="pulled")
    apart = (
        f" Where its normal force becomes negative, {sum(row['only_a'] + row['only_b'] for row in pulled)} of "
        f"{sum(size_of(row) for row in pulled)} do."
        if pulled
        else ""
    )
    return (
        f"Further than {percent(result.settings['band'], 1)} from any boundary, {wrong} of {size} runs of the "
        "engines end otherwise than the analytic model, as long as the block stays pressed on its base in that "
        f"model.{apart} Within that band {near} more runs were made in search of the boundaries; disagreement "
        "there is what a shifted boundary means."
    )


def knob(result: Result, solver: str, knob: str, values: Mapping[float, Rows]) -> str:
    good, bad = [], []
    for value, rows in values.items():
        shifts = [abs(row["shift"]) for row in rows if row["shift"] is not None]
        (good if len(shifts) == len(rows) and max(shifts) <= LIMIT / 100 else bad).append(value)

    def listed(chosen):
        return ", ".join(number(value, 2) for value in sorted(chosen)) or "none"

    return f"{solver}, {knob}: all boundaries within {LIMIT:g} % at {listed(good)}; not at {listed(bad)} (SI units)."


def first_script(result: Result, solver: str) -> str | None:
    rows = rows_of(result, "knob", solver=solver)
    if not rows:
        return None
    shifts = [row["shift"] for row in rows if row["shift"] is not None]
    span = f"those found are shifted by {percent(min(shifts))} to {percent(max(shifts))}" if shifts else ""
    reasons = {}
    for row in rows:
        if row["shift"] is None:
            key = row["ground"], row["reason"].split(",")[0]
            reasons[key] = reasons.get(key, 0) + 1
    lost = "; ".join(f"{ground}: {why} ({count})" for (ground, why), count in reasons.items())
    text = (
        f"First script, {solver}: {len(shifts)} of {len(rows)} boundaries found"
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


def failures(result: Result) -> str:
    counts = {}
    jumped = 0
    for row in rows_of(result, "failure"):
        counts[row["solver"], row["reason"]] = counts.get((row["solver"], row["reason"]), 0) + 1
        jumped += row["kind"] != "undecided" and row["min_normal"] < 0
    if not counts:
        return "No run failed or stayed undecided."
    words = "; ".join(f"{solver}: {reason} ({count})" for (solver, reason), count in counts.items())
    return (
        f"Runs without an outcome, left out of the tables: {words}. In {jumped} of them the normal force of the "
        "analytic model becomes negative."
    )


def unfinished(result: Result) -> Iterator[str]:
    """What a result lacks that was written before the study came to its end."""
    done = {(row["solver"], *row["settings"]) for row in rows_of(result, "knob")}
    missing = [
        f"{solver_name(solver, variant)} ({knob})"
        for solver, variant, knob in result.settings["knobs"]
        if (solver_name(solver, variant), knob) not in done
    ]
    if missing and not result.settings["quick"]:
        yield f"The study was stopped before its end; other settings were not tried of: {', '.join(missing)}."
