"""The page of a statue on a free pedestal: are engines right, what falls first, and where has the model no answer?"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from analytic.response import COMPARED, JUDGED
from engines.comparison import CHANGE, PEAK

from ...execution.results import Result
from ...plotting.figures import Series, beside, failures, lines, missing, strip
from ...plotting.glance import Glance, counted
from ...plotting.parts import Head, Page, Table, grouped, table, where
from ...plotting.wording import NOT_COMPARED, ends, ends_in_words, tally
from ...schemas.columns import NAME, Column, Row, number, percent, short
from .study import (
    BUST,
    COLUMNS,
    DAMPING,
    ERRORS,
    FALLS,
    FIRST,
    HEIGHT,
    LIMITS,
    PERIOD,
    PLATE,
    PULSES,
    SECONDS,
    SQUARE,
    STEP,
    STRONGER,
    WAYS,
    WIDE,
    WIDTH,
    X_MAX,
)

OF_MODEL = ("index", "ground", "hertz", "peak", "outcome", "demand", "impulse", "closest", "change")
HERTZ = COLUMNS["hertz"].called("frequency of the sine")


def page(result: Result) -> Page:
    """Return the page of a result."""
    settings, counts, mountings = result.settings, tallies(result), where(result.rows, part="mounting")
    ways = [row for row in mountings if row["width"] == WIDTH and row["hertz"] in PULSES]
    free, fixed = (number(where(ways, way=way, hertz=WIDE)[0]["fall"], 2) for way in ("free", "fixed"))
    return Page(
        f"Stacked blocks: {ends_in_words(where(counts, tier='tuned') or counts)}",
        (
            "A statue stands on a pedestal that is not fixed. Both may lift and rock, and neither slides.",
            f"Under one sine of {WIDE:g} Hz a bust on a free pedestal {WIDTH:g} m wide falls from {free} g on. On a "
            f"fixed pedestal it falls from {fixed} g on.",
        ),
        first=(
            beside(
                strip(result, "first fall of the bust: shift"),
                lines(
                    ways,
                    HERTZ,
                    COLUMNS["fall"],
                    "Right: the least peak at which the bust or its pedestal falls in the model, in steps "
                    f"of {settings['step']:g} g.",
                    series=Series(by="way"),
                ),
            ),
            table(
                f"{settings['scenes']} random scenes under one sine, half of them on bearings. A run is right if the "
                "same block falls as in the model, and the peak tilts of blocks that stay upright are within "
                f"{percent(PEAK, 1)}",
                counts,
                NAME,
                COLUMNS["tier"],
                Column("right [-]", lambda row: f"{row['runs'] - row['differing']} of {row['runs']}"),
                *ends(counts),
                Column("share that differs or fails", "share", percent=True, within="interval"),
            ),
            _first_falls("The least peak at which the bust or its pedestal falls [g]", ways, HERTZ),
        ),
        more=_details(result, counts, mountings),
        how=_how(settings),
        evidence=failures(result),
    )


def tallies(result: Result) -> list[dict[str, Any]]:
    """Return a row for each solver and variant: the `tally` of its runs, and (median, worst) of `ERRORS`."""
    rows = []
    for (engine, variant, tier), runs in grouped(_runs(result), "engine", "variant", "tier").items():
        counts = tally(runs, "index", lambda row: row["falls"] != row["model_falls"])
        judged = [row for row in runs if row["class"] in ("right", "differs")]
        known = {name: [row[name] for row in judged if row[name] is not None] for name in ERRORS}
        spans = {name: [float(np.median(values)), max(values)] if values else [] for name, values in known.items()}
        rows.append({"engine": engine, "variant": variant, "tier": tier, **counts, **spans})
    return rows


def glance(result: Result) -> Glance:
    """Return how the engines' runs end; a peak tilt that differs is no other end, and times of falls are not tested."""
    runs = [
        {**row, "class": "right" if row["quantities"] == ["peak_tilt"] and row["class"] == "differs" else row["class"]}
        for row in _runs(result)
        if row["tier"] != "model" and row["comparable"] in JUDGED
    ]
    return Glance(endings=tuple(replace(each, late=None) for each in counted("stacked blocks", runs)))


def _runs(result: Result) -> list[dict[str, Any]]:
    """Return the rows of runs with what `counted` reads."""
    ends_of = {row["index"]: row["outcome"] for row in where(result.rows, part="scene")}
    return [
        {
            "quantities": [],
            **row,
            "falls": None if row["outcome"] == "failed" else row["outcome"] in FALLS,
            "model_falls": ends_of[row["index"]] in FALLS,
            "changed": row["outcome"] != ends_of[row["index"]],
            "group": row["index"],
        }
        for row in where(result.rows, part="run")
    ]


def _first_falls(caption: str, mountings: Sequence[Row], by: Column) -> Table:
    """Return the table of first falls: a row for each mounting, a column for each value of a field."""
    ways = [
        {"way": way, **{by.text(row): row["fall"] for row in rows}}
        for (way,), rows in grouped(mountings, "way").items()
    ]
    return table(
        f"{caption}, by the {by.head}",
        ways,
        COLUMNS["way"],
        *(Column(text, text, digits=None) for (text,) in sorted(grouped(mountings, by.text))),
    )


def _details(result: Result, counts: Sequence[Row], mountings: Sequence[Row]) -> tuple[Any, ...]:
    """Return what only the study's own page shows."""
    scenes, settings = where(result.rows, part="scene"), result.settings
    compared = where(scenes, comparable=COMPARED)
    changes = [row["change"] for row in compared if row["change"] is not None] or [math.nan]
    costs = [row["cpu_per_second"] for row in compared] or [math.nan]
    shifts = where(result.rows, part={"check", "shift"})
    edges = [
        edge | {NAME.of(row): row["shift"] and 100 * row["shift"] for row in where(shifts, frequency=edge["frequency"])}
        for edge in sorted(where(result.rows, part="edge"), key=lambda row: row["frequency"])
    ]
    causes = [
        {"why": NOT_COMPARED.get(why, why), "share": len(rows) / len(scenes), "which": [row["index"] for row in rows]}
        for (why,), rows in grouped(scenes, "comparable").items()
        if why != COMPARED
    ]
    return (
        table("The same runs: median and worst of errors and costs", counts, NAME, *(COLUMNS[name] for name in ERRORS)),
        _first_falls(
            f"The least peak at which a block falls under a sine of {WIDE:g} Hz [g], without isolation",
            where(mountings, hertz=WIDE, way={*WAYS[:3]}),
            COLUMNS["width"],
        ),
        table(
            "The isolated bust at its first fall",
            where(mountings, way={*WAYS[3:]}),
            *(COLUMNS[name] for name in ("way", "hertz", "fall", "displacement", "outside")),
        ),
        table(
            "The first fall of the bust on the free pedestal, and its shift in other solvers",
            edges,
            Column(HERTZ.head, lambda row: row["frequency"] * settings["omega_r"] / (2 * math.pi), None),
            Column("peak [g]", lambda row: row["amplitude"] * settings["unit"], 6),
            *(Column(f"{name} [%]", name) for name in dict.fromkeys(map(NAME.of, shifts))),
        ),
        missing(result),
        Head("Where runs are not compared"),
        table(
            f"{len(scenes) - len(compared)} of {len(scenes)} random scenes are not compared, and why",
            causes,
            Column("why", "why"),
            Column("scenes [-]", lambda row: len(row["which"])),
            Column("share", "share", percent=True),
            Column("which", "which"),
        ),
        f"In {len(changes)} of the compared scenes both blocks stay upright. There, a motion stronger or weaker by "
        f"{percent(CHANGE, 1)} changes a peak tilt by {number(float(np.median(changes)), 2)} of the slenderness in the "
        f"median, and by at most {number(max(changes), 2)}. A run of the model takes "
        f"{number(float(np.median(costs)), 2)} s of CPU time per simulated second.",
        table(
            "Impacts in random states of such blocks: how often the law of impact has no answer, or a second one",
            where(result.rows, part="unique"),
            *(COLUMNS[name] for name in ("closed", "ground")),
            COLUMNS["runs"].called("states"),
            *(COLUMNS[name] for name in ("none", "second")),
        ),
        table(
            "The random scenes in the model",
            [row for row in scenes if not row.get("failure")],
            *(COLUMNS[name] for name in OF_MODEL),
        ),
    )


def _how(settings: dict[str, Any]) -> tuple[str, ...]:
    """Return what was run."""
    spans = {name: f"{low:g} to {high:g}" for name, (low, high) in LIMITS.items()}
    return (
        "The random scenes are drawn by a fixed seed. The pedestal, of 2700 kg/m³, is "
        f"{spans['width']} m wide, as deep, and {spans['height']} m high. The statue, of 1500 kg/m³, is "
        f"{spans['share']} times as wide, with tan γ of {spans['tangent']}. The ground moves by one sine of "
        f"{spans['hertz']} Hz, with {spans['peak']} times the acceleration that lifts the first block. Half of the "
        f"scenes stand on as many of the Caryatid's bearings as carry their weight, under sines {STRONGER:g} times "
        f"stronger. Each run lasts {SECONDS:g} s.",
        f"First impacts are the first {FIRST} of both blocks in the model, without those at the end of a chatter. Each "
        "is compared with the nearest one of the same block in the other run. Errors of tilts are over the "
        "slendernesses, for blocks that stay upright in both runs. For all solvers, scenes are left out in which the "
        "model ends: an impact has no answer that keeps the pivots, or has a second one, or a block would lift off. "
        "Also left out are scenes in which a contact pulls or needs more friction than engines have, and those in "
        f"which a change of the motion by {percent(CHANGE, 1)} changes what falls. Time-stepping is Moreau's method "
        f"for two bodies, in steps of {short(STEP)} s.",
        f"The bust measures {BUST[0]:g} × {BUST[1]:g} m and has a mass of {BUST[2]:g} kg. Its pedestal is {HEIGHT:g} m "
        f"high, as deep as wide, and has {SQUARE * WIDTH**2:g} kg where it is {WIDTH:g} m wide. Fixed: the pedestal "
        "moves with what carries it. Glued: bust and pedestal are one block. Free: neither fixed nor glued. Isolated: "
        f"the pedestal is fixed to a base of {PLATE:g} kg on {settings['bearings']['count']} bearings, with a secant "
        f"period of {PERIOD:g} s and {percent(DAMPING)} equivalent damping at {X_MAX:g} m. In the model the bearing "
        "law continues beyond that displacement.",
    )
