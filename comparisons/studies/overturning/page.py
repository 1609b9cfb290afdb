"""What is shown of the overturning study."""

import itertools
import math
import statistics
from functools import partial

from ...running.provenance import Result
from ...showing.figures import lines
from ...showing.glance import Endings, Glance
from ...showing.parts import (
    NAME,
    Column,
    Head,
    Judgement,
    Mark,
    Page,
    grouped,
    number,
    percent,
    setting_of,
    table,
    where,
)
from ...showing.wording import listed
from .drawn import AMPLITUDE, FAIR, FREQUENCY, GROUND, LIMIT, PULSE, maps, over_frequency, place, pressed
from .drawn import shifts as drawn_shifts
from .edges import APART, JUMPS
from .edges import FREQUENCY as FREQUENCIES

RATINGS = {"good": "trusted", "fair": "usable", "bad": "not to be trusted"}
EVIDENCE = 50  # failed runs shown, at most
REGIONS = {
    "scan": "coarse scan",
    "outside": "beyond the band, N ≥ 0",
    "held down": "beyond the band, N < 0",
    "inside": "within the band",
}

NORMAL = Column("least N/(m g) of the analytic model [-]", "min_normal")
FOUND = Column("found [-]", "{found} of {of}")
MEDIAN = Column("median shift [%]", lambda row: row["median"] and 100 * row["median"])
LARGEST = Column("largest shift [%]", lambda row: row["largest"] and 100 * row["largest"])


def page(result: Result) -> Page:
    s = result.settings
    edges, shifts, drawn = (where(result.rows, part=part) for part in ("edge", "shift", "drawn edge"))
    sound = pressed(result)
    known = [row for row in shifts if place(row) in sound]
    rated = list(_rated(result))
    own = s["default_variants"]
    tuned = {(one["engine"], one["variant"]) for one in s["variants"] if one["tier"] == "tuned"}
    band = percent(s["band"], 1)
    return Page(
        _title([row for row in rated if own[row["engine"]] == row["variant"]], tuned),
        (
            "A pulse overturns a block above some amplitude. At larger amplitudes there may be a safe gap: the first "
            "impact dissipates so much energy that the block does not overturn. Engines are rated by the shift of "
            "these boundaries, as long as the analytic model keeps the block pressed on its base. An outcome nearer "
            "to a boundary than the engine's shift is uncertain. Only whether the block overturns is compared, not "
            "when it falls.",
            *_under_jumps(result),
        ),
        first=(
            drawn_shifts(result),
            table(
                f"Boundaries under all pulses on both grounds, and of {len(drawn)} blocks drawn in the promised range, "
                f"with the block pressed on its base; outcomes further than {band} from those on both grounds. "
                "Boundaries where the normal force N would be negative are shown but do not count",
                rated,
                NAME,
                Column("rating", lambda row: RATINGS[row["rating"]]),
                FOUND,
                Column("safe gaps found [-]", "gaps"),
                MEDIAN,
                LARGEST,
                Column("where N < 0: found [-]", "{beyond_found} of {beyond}"),
                Column("largest there [%]", lambda row: row["beyond_largest"] and 100 * row["beyond_largest"]),
                Column(
                    "overturning missed or added, of outcomes [-]",
                    lambda row: f"{row['wrong']} of {row['outcomes']}" if row["outcomes"] else "none compared",
                ),
            ),
            table(
                f"Coarse scan: of {_scanned(s)} pulses those further than {band} from every boundary, with the block "
                "pressed on its base; the others are left out. 95 % Wilson intervals, pulses of one shape and "
                "frequency on one ground as one",
                where(result.rows, part="scan"),
                NAME,
                Column("runs judged [-]", "runs"),
                Column("left out [-]", lambda row: _scanned(s) - row["runs"]),
                Column("overturning missed [-]", "only_a"),
                Column("overturning added [-]", "only_b"),
                Column("failed [-]", "failed"),
                Column("share that differs or fails", _share, percent=True, within="interval"),
            ),
        ),
        more=(
            maps(result, s["shapes"]),
            Head("Every boundary"),
            over_frequency([row for row in known if own[row["engine"]] == row["variant"]]),
            _boundaries(
                "Boundaries, and the engines' shifts, known to ± "
                f"{percent(s['tolerance'] / 2, 1)}: block pressed on its base",
                [edge for edge in edges if place(edge) in sound],
                known,
            ),
            _drawn(drawn, where(result.rows, part="drawn shift")),
            table(
                "Boundaries not found, within 30 % or half-way to the next one",
                where(result.rows, part={"shift", "drawn shift"}, shift=None),
                NAME,
                GROUND,
                PULSE,
                FREQUENCY,
                AMPLITUDE,
                Column("half-way to the next boundary", "room", percent=True),
                Column("why", lambda row: row["reason"].replace("-", "−")),
            ),
            *_sliding(s),
            Head("Where the analytic model holds the corner down"),
            *_held_down(edges, shifts),
            Head("Outcomes between the boundaries"),
            _confusions(result, band),
            table(
                f"Overturning missed or added further than {band} from every boundary",
                where(result.rows, part="disagreement"),
                NAME,
                GROUND,
                PULSE,
                FREQUENCY,
                AMPLITUDE,
                Column("distance from the nearest boundary", "distance", percent=True),
                NORMAL,
                Column("analytic model", lambda row: "overturns" if row["analytic_overturns"] else "stands"),
            ),
            table(
                "Runs without an outcome, left out of the tables",
                [
                    {**rows[0], "runs": len(rows), "held_down": sum(row["min_normal"] < 0 for row in rows)}
                    for rows in grouped(where(result.rows, part="failure"), "engine", "variant", "reason").values()
                ],
                NAME,
                Column("reason", "reason"),
                Column("runs [-]", "runs"),
                Column("of them with N < 0 in the analytic model [-]", "held_down"),
            ),
            Head("Levels"),
            *_refinement(result),
        ),
        how=_how(result),
        evidence=tuple(
            (
                f"{NAME.text(row)}, {row['ground']}, {row['shape']}, frequency {row['frequency']:g}, amplitude "
                f"{row['amplitude']:.6g}",
                f"{row['reason']}\n{row.get('message') or ''}",
            )
            for row in where(result.rows, part="failure")[:EVIDENCE]
        ),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    marks = {}
    for row in _rated(result):
        every = row["of"] + row["beyond"]
        words = f"{percent(row['largest'])} ({row['found']} of {every} boundaries)"
        note = f"median {percent(row['median'])}; {row['of'] - row['found']} not found"
        if row["beyond"]:
            note += f"; {row['beyond']} with N < 0 do not count, found {row['beyond_found']}"
            note += f", {percent(row['beyond_largest'])}" if row["beyond_found"] else ""
        if row["largest"] is None:
            words = "none found"
        marks[row["engine"], row["variant"]] = Mark(words, row["rating"], note, row["largest"])
    return (Judgement("overturning boundary under pulses: shift, worst", marks),)


def glance(result: Result) -> Glance:
    """Of the coarse scan, away from the boundaries."""
    tiers = {NAME.of(one): one["tier"] for one in result.settings["variants"]}
    near = _near_boundaries(result)
    return Glance(
        endings=tuple(
            Endings(
                "pulses", row["engine"], row["variant"], tiers[NAME.of(row)], row["runs"], row["failed"], row["only_a"],
                row["only_b"], 0, tuple(row["interval"]), left_out=near
            )
            for row in where(result.rows, part="scan")
        )
    )  # fmt: skip


def _scanned(settings):
    """How many pulses the coarse scan has."""
    return math.prod(len(settings[key]) for key in ("grounds", "shapes", "frequencies", "scan"))


def _share(row):
    return (row["only_a"] + row["only_b"] + row["failed"]) / row["runs"]


def _near_boundaries(result):
    """How many points of the scan are left out as near a boundary, not counting others where the block would jump."""
    settings = result.settings
    edges = grouped(where(result.rows, part="edge"), "ground", "shape", "frequency")
    places = itertools.product(settings["grounds"], settings["shapes"], settings["frequencies"])
    return sum(
        any(abs(amplitude / edge["amplitude"] - 1) <= settings["band"] for edge in edges.get(place, ()))
        for place, amplitude in itertools.product(places, settings["scan"])
    )


def _rated(result):
    """A summary and a rating of each variant that is run at its default, where the block stays pressed on its base;
    beyond: the boundaries where it does not."""
    sound = pressed(result)
    for (name,), every in grouped(where(result.rows, part={"shift", "drawn shift"}), NAME.of).items():
        members, others = ([row for row in every if (place(row) in sound) == inside] for inside in (True, False))
        beyond = _summary(others) if others else {"of": 0, "found": 0, "largest": None}
        counts = [row for row in where(result.rows, part="confusion", region="outside") if NAME.of(row) == name]
        found, wrong = _summary(members), sum(row["only_a"] + row["only_b"] for row in counts)
        complete = found["found"] == found["of"]
        good = complete and found["largest"] <= LIMIT and not wrong
        rating = "good" if good else "fair" if complete and found["largest"] <= FAIR else "bad"
        outcomes = wrong + sum(row["both_stand"] + row["both_overturn"] for row in counts)
        yield {
            **found,
            "rating": rating,
            "wrong": wrong,
            "outcomes": outcomes,
            "beyond": beyond["of"],
            "beyond_found": beyond["found"],
            "beyond_largest": beyond["largest"],
        }


def _summary(rows):
    """How many of these boundaries of a variant were found, and how far off they lie."""
    found = [row for row in rows if row["shift"] is not None]
    shifts = [abs(row["shift"]) for row in found]
    return {
        "engine": rows[0]["engine"],
        "variant": rows[0]["variant"],
        "of": len(rows),
        "found": len(found),
        "gaps": f"{sum(not row['rises'] for row in found)} of {sum(not row['rises'] for row in rows)}",
        "median": statistics.median(shifts) if shifts else None,
        "largest": max(shifts, default=None),
    }


def _title(best, tuned):
    """The title: over the engines' main variants that are tuned; over all main variants if none is tuned."""
    rated = [row for row in best if (row["engine"], row["variant"]) in tuned]
    how, rated = ("tuned engines", rated) if rated else ("engines not tuned", best)
    largest = max((row["largest"] for row in rated if row["largest"] is not None), default=None)
    lost = [f"{row['found']} of {row['of']} found ({row['engine']})" for row in rated if row["found"] < row["of"]]
    words = f"Many pulses: {how} shift the overturning boundary by {percent(largest)} at most"
    return "; ".join(filter(None, [words, listed(lost)]))


def _boundaries(caption, edges, shifts, *columns):
    """A table of boundaries, with more columns, and the shifts of each setting in a column of its own."""
    found = {(NAME.of(row), *place(row)): row["shift"] for row in shifts}

    def shift(name, edge):
        value = found.get((name, *place(edge)))
        return "not found" if value is None else number(100 * value, 2)

    return table(
        caption,
        edges,
        GROUND,
        *columns,
        PULSE,
        FREQUENCY,
        AMPLITUDE,
        Column("overturning", lambda row: "begins" if row["rises"] else "ends"),
        Column("after impacts [-]", "mode"),
        NORMAL,
        *(Column(f"{name} [%]", partial(shift, name)) for name in dict.fromkeys(NAME.of(row) for row in shifts)),
    )


def _sliding(settings):
    """On which grounds a built-in friction is too low for a block to lift."""
    for variant in settings["variants"]:
        mu = variant["friction"]
        for ground, given in settings["grounds"].items() if mu is not None else ():
            if mu < given["tan_slenderness"]:
                yield (
                    f"{NAME.of(variant)}: its friction, {mu:g} by default, is below tan γ on {ground}. The block "
                    "slides where it should lift."
                )


def _held_down(edges, shifts):
    pulled = [edge for edge in edges if edge["min_normal"] < 0]
    if pulled:
        yield (
            "Here the normal force of the analytic model becomes negative. A block in contact would slide or leave its "
            "base, as it does in the engines, so these boundaries say nothing about the engines."
        )
    yield _boundaries("Boundaries at which the analytic model holds the corner down", pulled, shifts)


def _drawn(edges, shifts):
    return _boundaries(
        "Blocks drawn at random in the promised range, each under one pulse: shift of its lowest boundary",
        edges,
        shifts,
        Column("slenderness γ [rad]", "slenderness", 3),
        Column("R [m]", "radius", 3),
        Column("base mass over block mass [-]", lambda row: "rigid" if row["base_mass"] is None else row["base_mass"]),
        Column("bearings", lambda row: row["law"] or "–"),
        Column("period [s]", "period", 3),
    )


def _under_jumps(result):
    """A sentence on the tuned engines whose largest shift is under a pulse that begins with a jump; none without."""
    own = result.settings["default_variants"]
    rows = where(result.rows, part={"shift", "drawn shift"})
    sound, found = pressed(result), []
    for engine in result.settings["engines"]:
        mine = [row for row in where(rows, engine=engine, variant=own[engine]) if row["shift"] and place(row) in sound]
        worst = max(mine, key=lambda row: abs(row["shift"]), default=None)
        if worst and worst["shape"] in JUMPS:
            found.append(f"{percent(worst['shift'])} under a {worst['shape']} pulse ({engine})")
    if found:
        yield f"The shift is largest where the acceleration of the ground jumps at the start: {listed(found)}."


def _confusions(result, band):
    return table(
        f"Outcomes of engine and analytic model; band: {band} about every boundary, N: least normal force of the model",
        where(result.rows, part="confusion"),
        NAME,
        GROUND,
        Column("runs", lambda row: REGIONS[row["region"]]),
        Column("both stand [-]", "both_stand"),
        Column("both overturn [-]", "both_overturn"),
        Column("only the analytic model overturns [-]", "only_a"),
        Column("only the engine overturns [-]", "only_b"),
        Column(
            "Cohen's kappa (95 % interval) [-]",
            lambda row: (
                "–"
                if row["region"] == "inside" or row["kappa"] is None
                else f"{number(row['kappa'])} ({number(row['kappa_low'])} to {number(row['kappa_high'])})"
            ),
        ),
    )


def _refinement(result):
    """The boundaries at one frequency at all levels; at the default those that were searched more closely."""
    variants = {NAME.of(variant): variant for variant in result.settings["variants"]}
    tried = where(result.rows, part="refinement")
    places, shifts = {place(row) for row in tried}, where(result.rows, part="shift")
    closer = [row for row in shifts if place(row) in places and NAME.of(row) in map(NAME.of, tried)]
    known = {(NAME.of(row), row["level"]) for row in closer}
    rows = [row for row in tried if (NAME.of(row), row["level"]) not in known] + closer
    groups, order = grouped(rows, NAME.of, "level"), list(variants)
    levels = [
        {**variants[name], "level": level, **_summary(groups[name, level])}
        for name, level in sorted(groups, key=lambda group: (order.index(group[0]), group[1]))
    ]
    yield lines(
        [row for row in levels if row["found"] == row["of"]],
        Column("accuracy parameter over its default [-]", lambda row: row["level"] / row["default"]),
        LARGEST,
        "Largest shift where all boundaries are found, one-sine pulses on both grounds; a stiffness refines upward, a "
        "step downward. Time-stepping: the analytic model's equations by another method, its steps over 0.1 ms.",
        log="xy",
        rules=[("y", 100 * LIMIT, "trusted")],
    )
    yield table(
        f"All levels, shifts known to ± {percent(result.settings['level_tolerance'] / 2, 1)}",
        levels,
        NAME,
        Column("kind", "tier"),
        Column("setting", setting_of),
        FOUND,
        MEDIAN,
        LARGEST,
    )
    missing = [
        name for name, variant in variants.items() if variant["levels"] and (name,) not in grouped(tried, NAME.of)
    ]
    if missing and not result.settings["quick"]:
        yield f"The study was stopped before its end; no other level was run for: {'; '.join(missing)}."


def _how(result):
    s = result.settings
    grounds = "; ".join(
        f"{name}: γ = {given['block']['slenderness']:g} rad"
        + (f", {given['bearings']['count']} bearings, base of {given['base']['mass']:g} kg" if given["base"] else "")
        for name, given in s["grounds"].items()
    )
    return (
        f"{len(where(result.rows, part='edge'))} boundaries of the analytic model: pulses {', '.join(s['shapes'])} of "
        f"{min(s['frequencies']):g} to {max(s['frequencies']):g} times the rocking frequency, amplitudes of "
        f"{s['amplitudes'][0]:g} to {s['amplitudes'][1]:g} g tan γ, on two grounds ({grounds}). Each engine bisects "
        f"for its own to ± {percent(s['tolerance'] / 2, 1)} at the default level. Where the normal force of the "
        "analytic model becomes negative, that model is the one not to be trusted, and the boundary is not rated. The "
        "drawn blocks are those of the random scenes, at rest; shapes of pulses take turns, frequencies are drawn from "
        f"{FREQUENCIES[0]:g} to {FREQUENCIES[1]:g} times the rocking frequency; of each the lowest boundary that no "
        f"other one is nearer to than {percent(APART, 1)}.",
        f"Trusted: all boundaries found, shifted by at most {percent(LIMIT, 1)}, no outcome that differs beyond the "
        f"band; usable: all found, at most {percent(FAIR, 1)}. Kind “assisted”: the adapter applies the impact, so "
        "that the boundaries test the integration alone; no other level is tried.",
    )
