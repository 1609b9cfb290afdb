"""The overturning study's result as a section of the report, from the result alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.parts import Section, figure_of, percent
from . import words
from .figures import LIMIT, draw_knobs, draw_maps, draw_shifts, knob_curves
from .rows import rows_of
from .tables import tables

if TYPE_CHECKING:
    from ...running.provenance import Result


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    solvers = result.settings["solvers"]
    text = [
        words.asked(result),
        *(words.verdict(result, solver) for solver in solvers),
        *(
            f"{solver} does not decide the impact: its adapter applies the analytic model's. Its boundaries tell of "
            "its integration alone, and no other setting of it is tried."
            for solver in solvers
            if solver in result.settings["held"]
        ),
        *words.pulled(result),
        words.band(result),
        *(words.knob(result, *key, values) for key, values in knob_curves(result).items()),
        *filter(None, (words.first_script(result, solver) for solver in result.settings["first_scripts"])),
        words.failures(result),
        *words.unfinished(result),
    ]
    evidence = tuple(
        (
            f"{row['solver']}, {row['ground']}, {row['shape']}, frequency {row['frequency']:g}, amplitude "
            f"{row['amplitude']:.6g}",
            f"{row['reason']}\n{row.get('message') or ''}",
        )
        for row in rows_of(result, "failure")[:50]
    )
    return Section(
        "Overturning under pulses: where the boundaries lie",
        (*(words.trust(result, solver) for solver in solvers), *text),
        tables(result),
        tuple(_figures(result)),
        evidence=evidence,
    )


def _figures(result):
    """Maps, shifts and knobs with what they show."""
    shifted = sum(row["shift"] is not None for row in rows_of(result, "shift"))
    surprises = len(rows_of(result, "surprise"))
    figures = [
        figure_of(
            draw_maps(result),
            "Maps of outcomes over pulse frequency and amplitude with the engines' "
            f"boundaries marked; {surprises} disagreements outside the band.",
            "Colours: the analytic model. Symbols: boundaries found with the engines. Crosses: scanned points "
            "where an engine's outcome differs. White above colour is the safe gap between two ways to "
            "overturn.",
        ),
        figure_of(
            draw_shifts(result),
            f"Shift of {shifted} boundaries in per cent over pulse frequency, beside a "
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
    return figures
