"""The page of the overturning study: maps of outcomes, and boundaries of the model and of engines."""

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np

from ...execution.results import Result
from ...plotting.charts import Axis, Chart, figure, key_of
from ...plotting.figures import (
    AMPLITUDE,
    DECADES,
    FAIR,
    FOUND,
    FREQUENCY,
    GROUND,
    LARGEST,
    LIMIT,
    MEDIAN,
    NORMAL,
    PULSE,
    RATINGS,
    SHIFT,
    Series,
    beside,
    failures,
    judged,
    largest,
    lines,
    listing,
    missing,
    place,
    pressed,
    rated,
    strip,
    summary,
    under_jumps,
)
from ...plotting.glance import Endings, Glance
from ...plotting.parts import Figure, Head, Judgement, Page, grouped, setting_of, table, where
from ...schemas.columns import NAME, Column, Row, number, percent, short
from .study import COLUMNS


def model_map(result: Result, ground: str, shape: str) -> Chart:
    """Return a map of outcomes of the analytic model with its boundaries."""
    chart = _outcomes(result, ground, shape, f"Outcomes of the analytic model on {ground} under a {shape} pulse.")
    edges = where(result.rows, part="edge", ground=ground, shape=shape)
    tooltips = [f"amplitude {number(edge['amplitude'], 4)}, N/(m g) {number(edge['min_normal'], 2)}" for edge in edges]
    chart.dots([edge["frequency"] for edge in edges], [edge["amplitude"] for edge in edges], says=tooltips)
    return chart


def maps(result: Result, shapes: Iterable[str]) -> Figure | None:
    """Figure of outcomes of the analytic model, with the boundaries of the engines and the outcomes that differ.

    None without shapes or grounds.
    """
    chosen = list(shapes)
    panels = [_map(result, ground, shape) for shape, ground in itertools.product(chosen, result.settings["grounds"])]
    if not panels:
        return None
    differ = where(result.rows, part="disagreement", shape=set(chosen))
    caption = (
        "Analytic model: where shaded, the block overturns; where blank, it stands. Marks: boundaries that the "
        "engines’ main variants found; the table has shifts too small to be seen here."
        + f" Crosses: outcomes that differ more than {percent(result.settings['band'], 1)} away from every boundary."
        * bool(differ)
    )
    keys = {engine: key_of(engine, filled=False, joined=False) for engine in result.settings["engines"]}
    return figure(panels, caption, keys, keys)


def _outcomes(result, ground, shape, says):
    """Map of outcomes of the analytic model, without marks."""
    frequency, amplitude = result.arrays["frequency"], result.arrays["amplitude"]
    chart = Chart(
        Axis(FREQUENCY.head, float(frequency[0]), float(frequency[-1])),
        Axis(AMPLITUDE.head, float(amplitude[0]), float(amplitude[-1]), "log", ((1, "1"), (3, "3"), (10, "10"))),
        says,
        title=f"{ground}, {shape}",
        height=300,
    )
    _shade(chart, frequency, amplitude, result.arrays[f"{ground}/{shape}"] >= 0)
    return chart


def _map(result, ground, shape):
    """Map of outcomes with the engines' boundaries, and their outcomes that differ."""
    says = f"Outcomes on {ground} over frequency and amplitude of a {shape} pulse, with boundaries of the engines."
    chart, map_rows = _outcomes(result, ground, shape, says), where(result.rows, ground=ground, shape=shape)
    for engine in result.settings["engines"]:
        variant = result.settings["default_variants"][engine]
        rows = [
            row for row in where(map_rows, part="shift", engine=engine, variant=variant) if row["shift"] is not None
        ]
        tooltips = [
            f"{engine}: amplitude {number(row['amplitude'], 4)}, shifted by {percent(row['shift'])}" for row in rows
        ]
        amplitudes = [row["amplitude"] * (1 + row["shift"]) for row in rows]
        chart.dots([row["frequency"] for row in rows], amplitudes, engine, filled=False, says=tooltips, beyond=True)
        rows = where(map_rows, part="disagreement", engine=engine)
        tooltips = [f"{engine}: differs at amplitude {AMPLITUDE.text(row)}" for row in rows]
        chart.dots(
            [row["frequency"] for row in rows], [row["amplitude"] for row in rows], engine, says=tooltips, mark="x"
        )
    return chart


def _shade(chart, frequency, amplitude, falls):
    """Shade the amplitudes that overturn: a polygon for each stretch of frequencies with equally many intervals."""
    runs = []
    for column in falls.T:
        ends = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(np.int8), [0]])))
        runs.append([(amplitude[a], amplitude[min(b, len(amplitude)) - 1]) for a, b in ends.reshape(-1, 2)])
    begin = 0
    for _, stretch in itertools.groupby(runs, len):
        columns = list(stretch)
        end = begin + len(columns)
        xs = list(frequency[begin:end])
        if end < len(runs):  # up to the next one, so that no gap shows
            xs.append(1.5 * frequency[end] - 0.5 * frequency[end - 1])
            columns.append(columns[-1])
        for run in zip(*columns, strict=True):
            low, high = zip(*run, strict=True)
            chart.area([*xs, *xs[::-1]], [*low, *high[::-1]], "falls")
        begin = end


def over_frequency(rows: Sequence[Row]) -> Figure | None:
    """Figure of the shifts of boundaries over the frequency of their pulse, for the boundaries that were found."""
    return lines(
        [row for row in rows if row["shift"] is not None],
        FREQUENCY,
        Column(SHIFT.head, lambda row: max(SHIFT.of(row), DECADES[0])),
        "Shift of each boundary in the main variants: boundary of the engine over that of the analytic model, minus 1. "
        f"Shifts below {short(DECADES[0])} % are drawn there. Boundaries that were not found are in the table below.",
        panel="ground",
        series=Series(
            by=lambda row: f"overturning {'begins' if row['rises'] else 'ends'}",
            joined=False,
            says=lambda row: (
                f"{NAME.of(row)}: {percent(row['shift'])} at {row['shape']}, frequency {row['frequency']:g}, amplitude "
                f"{AMPLITUDE.text(row)}"
            ),
        ),
        log="y",
        rules=[("y", 100 * LIMIT, "trusted")],
    )


REGIONS = {
    "scan": "coarse scan",
    "outside": "outside the band, N ≥ 0",
    "held down": "outside the band, N < 0",
    "inside": "within the band",
}


def page(result: Result) -> Page:
    """Return the page of a result."""
    settings = result.settings
    edges, shifts = where(result.rows, part="edge"), where(result.rows, part="shift")
    sound = pressed(result)
    rated_shifts = [row for row in shifts if place(row) in sound]
    main_variants = settings["default_variants"]
    band = percent(settings["band"], 1)
    return Page(
        f"Many pulses: on two grounds, {largest(result)}",
        (
            "A pulse overturns a block above some amplitude. At larger amplitudes there may be a safe gap: the first "
            "impact dissipates so much energy that the block does not overturn. Engines are rated by the shift of "
            "these boundaries, wherever the analytic model keeps the block pressed on its base. An outcome nearer "
            "to a boundary than the engine's shift is uncertain. Only whether the block overturns is compared, not "
            "when it falls. The first table of the report also has the boundaries of randomly drawn statues.",
            *under_jumps(result),
        ),
        first=_summary(result, settings, band),
        more=_details(result, settings, edges, shifts, sound, rated_shifts, main_variants, band),
        how=_how(result),
        evidence=failures(result),
    )


def _summary(result, settings, band):
    """Parts that the report's first page shows too."""
    return (
        _shifts(result),
        table(
            "Boundaries under all pulses on both grounds, and outcomes more than "
            f"{band} away from them. Boundaries at which the model's normal force N becomes negative are shown but do "
            "not count",
            rated(result),
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
            f"Coarse scan: {_scanned(settings)} pulses, without those within {band} of a boundary and those under "
            "which N becomes negative. The 95 % Wilson intervals count pulses of one shape and frequency on one ground "
            "as one",
            where(result.rows, part="scan"),
            NAME,
            COLUMNS["runs"],
            Column("left out [-]", lambda row: _scanned(settings) - row["runs"]),
            COLUMNS["only_a"].called("overturning missed"),
            COLUMNS["only_b"].called("overturning added"),
            COLUMNS["failed"],
            Column("share that differs or fails", _share, percent=True, within="interval"),
        ),
    )


def _details(result, settings, edges, shifts, sound, rated_shifts, main_variants, band):
    """Parts that only the study's own page shows."""
    return (
        maps(result, settings["shapes"]),
        Head("Every boundary"),
        over_frequency([row for row in rated_shifts if main_variants[row["engine"]] == row["variant"]]),
        listing(
            "Boundaries at which the block stays pressed on its base, and the engines' shifts, known to ± "
            f"{percent(settings['tolerance'] / 2, 1)}",
            [edge for edge in edges if place(edge) in sound],
            rated_shifts,
        ),
        missing(result),
        *_sliding(settings),
        Head("Where the analytic model holds the corner down"),
        *_held_down(edges, shifts),
        Head("Outcomes between the boundaries"),
        _confusions(result, band),
        table(
            f"Overturning missed or added more than {band} away from every boundary",
            where(result.rows, part="disagreement"),
            NAME,
            GROUND,
            PULSE,
            FREQUENCY,
            AMPLITUDE,
            COLUMNS["distance"],
            NORMAL,
            Column("analytic model", lambda row: "overturns" if row["analytic_overturns"] else "stands"),
        ),
        table(
            "Runs without an outcome. The tables leave them out",
            [
                {**rows[0], "runs": len(rows), "held_down": sum(row["min_normal"] < 0 for row in rows)}
                for rows in grouped(where(result.rows, part="failure"), "engine", "variant", "reason").values()
            ],
            NAME,
            COLUMNS["reason"],
            COLUMNS["runs"].called("runs"),
            Column("of them with N < 0 in the analytic model [-]", "held_down"),
        ),
        Head("Levels"),
        *_refinement(result),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge boundaries by (engine, variant)."""
    return (judged(result, "boundaries"),)


def glance(result: Result) -> Glance:
    """Return the outcomes of the coarse scan, away from the boundaries."""
    tiers = {NAME.of(variant): variant["tier"] for variant in result.settings["variants"]}
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


def _shifts(result):
    """Figure of all boundaries at their shifts, beside one map of the model that shows what is searched for."""
    settings = result.settings
    model = model_map(result, next(iter(settings["grounds"])), settings["shapes"][0])
    words = "Right: the analytic model under one pulse. Shaded: the block overturns; dots: boundaries."
    return beside(strip(result, "shift of every boundary"), figure([model], words))


def _scanned(settings):
    """Return how many pulses the coarse scan has."""
    return math.prod(len(settings[key]) for key in ("grounds", "shapes", "frequencies", "scan"))


def _share(row):
    """Share of the runs of a scan that differ or fail."""
    return (row["only_a"] + row["only_b"] + row["failed"]) / row["runs"]


def _near_boundaries(result):
    """Count the points of the scan that are left out as near a boundary.

    Other points are left out because the block would jump; they are not counted.
    """
    settings = result.settings
    edges = grouped(where(result.rows, part="edge"), "ground", "shape", "frequency")
    places = itertools.product(settings["grounds"], settings["shapes"], settings["frequencies"])
    return sum(
        any(abs(amplitude / edge["amplitude"] - 1) <= settings["band"] for edge in edges.get(place, ()))
        for place, amplitude in itertools.product(places, settings["scan"])
    )


def _sliding(settings):
    """Yield sentences on the grounds on which a variant's built-in friction is too low for a block to lift."""
    for variant in settings["variants"]:
        mu = variant["friction"]
        for ground, given in settings["grounds"].items() if mu is not None else ():
            if mu < given["tan_slenderness"]:
                yield (
                    f"In {NAME.of(variant)}, the friction coefficient, {mu:g} by default, is below tan γ on {ground}: "
                    "the block slides where it should lift."
                )


def _held_down(edges, shifts):
    """Yield what is shown of boundaries at which the normal force of the model becomes negative."""
    pulled = [edge for edge in edges if edge["min_normal"] < 0]
    if pulled:
        yield (
            "Here the normal force of the analytic model becomes negative. A block in contact would slide or leave its "
            "base, as it does in the engines, so these boundaries say nothing about the engines."
        )
    yield listing("Boundaries at which the analytic model holds the corner down", pulled, shifts)


def _confusions(result, band):
    return table(
        "Outcomes of engine and analytic model. The band reaches "
        f"{band} to either side of every boundary; N is the least normal force in the model",
        where(result.rows, part="confusion"),
        NAME,
        GROUND,
        Column("runs", lambda row: REGIONS[row["region"]]),
        COLUMNS["both_stand"],
        COLUMNS["both_overturn"],
        COLUMNS["only_a"],
        COLUMNS["only_b"],
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
    """Yield the boundaries at one frequency at all levels.

    At the default level they are those that were searched more closely.
    """
    variants = {NAME.of(variant): variant for variant in result.settings["variants"]}
    tried = where(result.rows, part="refinement")
    places, shifts = {place(row) for row in tried}, where(result.rows, part="shift")
    closer = [row for row in shifts if place(row) in places and NAME.of(row) in map(NAME.of, tried)]
    closer_levels = {(NAME.of(row), row["level"]) for row in closer}
    rows = [row for row in tried if (NAME.of(row), row["level"]) not in closer_levels] + closer
    groups, order = grouped(rows, NAME.of, "level"), list(variants)
    levels = [
        {**variants[name], "level": level, **summary(groups[name, level])}
        for name, level in sorted(groups, key=lambda group: (order.index(group[0]), group[1]))
    ]
    yield lines(
        [row for row in levels if row["found"] == row["of"]],
        Column("accuracy parameter over its default [-]", lambda row: row["level"] / row["default"]),
        LARGEST,
        "Largest shift of the levels that find all boundaries, under one-sine pulses on both grounds. A larger "
        "stiffness is finer, and so is a smaller step. Time-stepping: the analytic model's equations by another "
        "method; its steps are drawn over 0.1 ms.",
        log="xy",
        rules=[("y", 100 * LIMIT, "trusted")],
    )
    yield table(
        f"All levels, shifts known to ± {percent(result.settings['level_tolerance'] / 2, 1)}",
        levels,
        NAME,
        COLUMNS["tier"],
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
    settings = result.settings
    grounds = "; ".join(
        f"{name}: γ = {given['block']['slenderness']:g} rad"
        + (f", {given['bearings']['count']} bearings, base of {given['base']['mass']:g} kg" if given["base"] else "")
        for name, given in settings["grounds"].items()
    )
    return (
        f"The analytic model has {len(where(result.rows, part='edge'))} boundaries under the pulses "
        f"{', '.join(settings['shapes'])}, of {min(settings['frequencies']):g} to {max(settings['frequencies']):g} "
        f"times the rocking frequency, with amplitudes of {settings['amplitudes'][0]:g} to "
        f"{settings['amplitudes'][1]:g} g tan γ, on two grounds ({grounds}). Each engine bisects for its own "
        f"boundaries to ± {percent(settings['tolerance'] / 2, 1)} at the default level. Where the normal force of the "
        "analytic model becomes negative, the model is not to be trusted, and the boundary is not rated.",
        f"Trusted: all boundaries are found and shifted by at most {percent(LIMIT, 1)}, and no outcome differs outside "
        f"the band. Usable: all are found and shifted by at most {percent(FAIR, 1)}. Kind “assisted”: the adapter "
        "applies the impact, so the boundaries test only the integration; no other level is tried.",
    )
