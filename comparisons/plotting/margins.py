"""Margins of a scene, its outcomes under many motions, its odds, and bearings for it: tables and pictures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import Caution, Scene
from analytic.advice.bearing_scan import BearingScan, hardest
from analytic.advice.margins import LIMIT_STATES, Contact, Margin, limit_states
from analytic.motion import Motion
from analytic.response import FALLS, KINDS

from ..execution.command_runs import OWN
from ..execution.writing import readable
from ..metrics.statistics import wilson
from ..schemas.columns import number, percent
from .terminal import TITLE_CHARACTERS, Grid, digits, echo, grid, warned
from .wording import listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..schemas.advice import Odds, Risk

# Colours of Okabe and Ito. Hatches, and the lines’ places, tell them apart in print.
COLOURS = {
    "stands": ("#009E73", ""),
    "slides": ("#E69F00", "--"),
    "rocks": ("#F0E442", ".."),
    "falls off": ("#882255", "xx"),
    "overturns": ("#D55E00", "//"),
    "pedestal overturns": ("#CC79A7", "\\\\"),
    "failed": ("0.4", ""),
}

# Lines along a strip: colour, and where they begin.
OUTSIDE, TILT, STROKE = ("#CC79A7", -0.43), ("#0072B2", 0.35), ("#56B4E9", 0.43)


def print_margins(
    scene: Scene,
    margins: Sequence[Margin],
    contact: Contact,
    span: float,
    tilt: float,
    warnings: Sequence[Caution] = (),
    notes: Sequence[str] = (),
) -> None:
    """Print `warnings`, a row for each `Margin` with a change, in order, reserves of the contact, and `notes`.

    span : largest change tried [%]. tilt : limit of the peak tilt, over slenderness.
    """
    nearest = margins[0]
    names = {state: name for state, name in _names(tilt).items() if state in limit_states(scene)}
    now = ", ".join(name for state, name in names.items() if nearest.reached(state))
    parts: list[Grid | str] = [
        *(f"Warning: {readable(str(warning))}" for warning in warnings),
        f"{readable(scene.name, TITLE_CHARACTERS)}: {nearest.outcome}\nnow: {now or 'no limit state'}",
    ]
    rows = {margin: [margin.change(state) for state in names] for margin in margins}
    rows = {margin: changes for margin, changes in rows.items() if any([*changes, margin.leaves_model])}
    if rows:
        parts += [
            _margin_table(
                [f"no longer\n{name}" if nearest.reached(state) else name for state, name in names.items()], rows
            ),
            "Each quantity is changed alone. A column gives the nearest change at which its limit state is reached, or "
            "no longer reached. Slenderness is changed at fixed R, mass and J_O; size at fixed mass and shape."
            + (" Left at: the model does not hold beyond this change." if _any_leaves_model(rows) else ""),
        ]
    if still := ", ".join(margin.quantity for margin in margins if margin not in rows):
        within = (
            " within its range"
            if any(margin.ends_down or margin.ends_up for margin in margins if margin not in rows)
            else ""
        )
        parts.append(
            f"No change of up to {span:g} % of {still}{within} changes any of these: {', '.join(names.values())}."
        )
    parts += [words for margin in margins for words in _range_ends(margin)]
    if nearest.nearest is None:
        parts.append(f"No change of up to {span:g} % of any one quantity changes the outcome.")
    else:
        parts.append(
            f"Nearest change of the outcome: {nearest.quantity} {_percent(nearest.nearest)}, the block then "
            f"{nearest.beyond(nearest.nearest)}."
        )
    if bands := [margin for margin in margins if margin.interleaved]:
        parts.append(
            f"The outcomes are interleaved in {', '.join(margin.quantity for margin in bands)}: bands narrower than "
            f"{200 * bands[0].step:.2g} % alternate there. Narrower ones may lie nearer than the change "
            "given: do not base a decision on this margin."
        )
    parts.append(" ".join(filter(None, [_normal_words(contact), _friction_words(contact)])))
    if scene.bearings is not None:
        parts.append("Assumed: the bearings are stiff vertically (real bearings vibrate vertically at 10 to 20 Hz).")
    echo(*parts, *notes, wrap=True)


def _names(tilt):
    """Return {limit state: its name in tables}."""
    beyond = {"tilt": f"tilt > {tilt:g} γ", "stroke": "base > x_max"}
    return {"slides": "slides", "lifts": "lifts", **beyond, **{fall: fall for fall in FALLS if fall in LIMIT_STATES}}


def _range_ends(margin):
    """Return sentences on where the range of a quantity ends within the span, and why."""
    ends = ((margin.bands[0].low, margin.ends_down), (margin.bands[-1].high, margin.ends_up))
    return [f"The range of {margin.quantity} ends at {100 * at:+.3g} %: {readable(why)}." for at, why in ends if why]


def named(row: Mapping[str, Any], tilt: float) -> dict[str, str]:
    """Return {limit state's name in tables: its change in words} of a row with "changes" and "reached" states."""
    words = {state: _percent(change) for state, change in row.get("changes", {}).items()}
    words |= {state: f"no longer\n{words[state]}" if words[state] else "now" for state in row.get("reached", ())}
    return {_names(tilt)[state]: change for state, change in words.items()}


def _any_leaves_model(margins):
    return any(margin.leaves_model is not None for margin in margins)


def _margin_table(names, rows):
    """Return the table of margins. names: of limit states. rows: {margin: its change to each}."""
    outside = _any_leaves_model(rows)
    heads = ["quantity", "value", *names, *(["left at"] if outside else [])]
    cells = [
        [
            margin.quantity,
            f"{margin.value:.5g} {margin.unit}".removesuffix(" -"),
            *map(_percent, [*changes, *([margin.leaves_model] if outside else [])]),
        ]
        for margin, changes in rows.items()
    ]
    return grid([head.replace(" > ", "\n> ") for head in heads], cells)  # 80 columns hold the widest numbers


def draw_margins(scene: Scene, margins: Sequence[Margin], tilt: float) -> Figure:
    """Draw outcomes over the relative change of each quantity, a strip for each `Margin`: a matplotlib Figure.

    Lines along a strip show where the peak tilt exceeds its limit, where the base exceeds x_max, and where the model
    does not hold.
    """
    from matplotlib.figure import Figure  # slow to load: not with tables
    from matplotlib.patches import Patch

    figure = Figure(figsize=(8, 1.5 + 0.42 * len(margins)), layout="constrained")
    axis = figure.subplots()
    for row, margin in enumerate(margins):
        for band in margin.bands:
            colour, hatch = COLOURS[band.outcome]
            left, width = 100 * band.low, 100 * (band.high - band.low)
            axis.barh(row, width, left=left, height=0.7, color=colour, hatch=hatch, edgecolor="0.25", linewidth=0)
            for colour, place in _strip_lines(band):
                axis.barh(row + place, width, left=left, height=0.08, color=colour, align="edge")
        for change in (margin.down, margin.up):
            if change is not None:
                _write_change(axis, row, change)
    axis.axvline(0, color="black", linewidth=1)
    axis.set_yticks(range(len(margins)), [f"{margin.quantity}" for margin in margins])
    axis.invert_yaxis()
    low, high = min(margin.bands[0].low for margin in margins), max(margin.bands[-1].high for margin in margins)
    axis.set(xlim=(100 * low, 100 * high), xlabel="change of one quantity [%]")
    axis.set_title(f"{readable(scene.name, TITLE_CHARACTERS)}: {margins[0].outcome}", loc="left")
    shown = {band.outcome for margin in margins for band in margin.bands}
    handles = [
        Patch(facecolor=colour, hatch=hatch, edgecolor="0.25", linewidth=0, label=name)
        for name, (colour, hatch) in COLOURS.items()
        if name in shown
    ]
    names = _names(tilt)
    labels = {TILT: names["tilt"], STROKE: names["stroke"], OUTSIDE: "outside the model (N ≤ 0)"}
    drawn = {line for margin in margins for band in margin.bands for line in _strip_lines(band)}
    handles += [Patch(facecolor=line[0], label=label) for line, label in labels.items() if line in drawn]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return figure


def _strip_lines(band):
    """Return the lines of a band: those of OUTSIDE, TILT and STROKE that apply to it."""
    applies = {OUTSIDE: not band.holds, TILT: "tilt" in band.reached, STROKE: "stroke" in band.reached}
    return [line for line, applied in applies.items() if applied]


def _write_change(axis, row, change):
    axis.annotate(
        _percent(change),
        (100 * change, row),
        (-4 if change > 0 else 4, 0),
        textcoords="offset points",
        ha="right" if change > 0 else "left",
        va="center",
        fontsize="small",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1},
    )


def _percent(change):
    if change is None:
        return ""
    return "now" if change == 0 else f"{100 * change:+.3g} %"


def _normal_words(contact):
    if contact.least_normal <= 0 and contact.friction is not None:
        return "The normal force falls to 0: the block flies."
    if contact.least_normal <= 0:
        return f"The normal force falls to {contact.least_normal:.3g} m g: the outcome is outside the model."
    least = f"{contact.least_normal:.3g}"
    return f"The normal force falls to {least} m g; at 0 the block would jump." if float(least) < 1 else ""


def _friction_words(contact):
    demand = f"The friction demand is {contact.friction_demand:.3g}"
    if contact.friction is None:
        return f"{demand}; the scene gives no coefficient to hold it against."
    slides = ", and the block slides" if contact.slides else ""
    return f"{demand}, the scene's coefficient {contact.friction:g}{slides}."


LIFTED = ("rocks", "overturns")  # one that falls off may never have lifted
RECORD = "record"
# {(kind, quantity or None) of a warning: (word in a table, clause in the headline)}, the most important one first.
DOUBTS = {
    ("limit", "peak_base_displacement"): ("x_max", "the base exceeds x_max"),
    ("limit", "peak_slip"): ("slip", "the block slips by more than its half width"),
    ("limit", "overhang"): ("overhang", "the block overhangs its pedestal"),
    ("limit", "pedestal"): ("pedestal", "the pedestal may lift"),
    ("limit", None): ("limit", "a limit is exceeded"),
    ("model", None): ("model", "a run warns that it is outside the model"),
    ("record", None): ("record", "the record is unusual"),
    ("motion", None): ("motion", "the outcome is sensitive to small changes"),
    ("engine", None): ("engine", "the engine or its range warns"),
}


def _warning_words(warning: Mapping[str, Any]) -> tuple[str, str]:
    """Return a warning as a word and as a clause."""
    return DOUBTS.get((warning["kind"], warning["quantity"])) or DOUBTS[warning["kind"], None]


def headline(rows: Sequence[Mapping[str, Any]], left: Sequence[str] = ()) -> str | None:
    """Return the result of a scene under many motions in sentences; None without motions.

    They count records: with failed runs, with warnings, under which the block lifts, and under which it overturns.
    Records are called motions where the scene's own motion is one of them.

    rows : of `execution.command_runs.rows_of`. left : files and channels that were left out.
    """
    if not rows:
        return None
    failed = _record_count(rows, [row for row in rows if row["outcome"] == "failed"])
    sentences = [f"No outcome under {failed}."] if failed else []
    sentences += [f"Warning: {clause} under {records}." for clause, records in doubts(rows).items()]
    sentences.append(f"The block {odds(rows, LIFTED, 'lifts')}, and {odds(rows, FALLS, falls_word(rows))}.")
    if unit_of(rows) != RECORD and len({row["record"] for row in rows}) < len(rows):
        sentences.append("Components, directions and signs count as one motion.")
    noun = "file or channel" if len(left) == 1 else "files or channels"
    return " ".join([*sentences, *([f"Left out of the folder: {len(left)} {noun}."] if left else [])])


def falls_word(rows: Iterable[Mapping[str, Any]]) -> str:
    """Return what a fall is called: "overturns", or both words where a block falls off its pedestal."""
    return "falls off or overturns" if any(row["outcome"] == FALLS[0] for row in rows) else FALLS[1]


def doubts(rows: Sequence[Mapping[str, Any]], kinds: Sequence[str] = KINDS) -> dict[str, str]:
    """Return {clause of warnings of these kinds: under how many records or motions}; rows as in `headline`."""
    clauses = dict.fromkeys(clause for (kind, _), (_, clause) in DOUBTS.items() if kind in kinds)
    warnings = [(row, _warning_words(warning)[1]) for row in rows for warning in row["warnings"]]
    records_of = {
        clause: _record_count(rows, [row for row, words in warnings if words == clause]) for clause in clauses
    }
    return {clause: records for clause, records in records_of.items() if records}


def _record_count(rows: Sequence[Mapping[str, Any]], chosen: Sequence[Mapping[str, Any]]) -> str:
    """Return in words how many records, or motions, have one of the chosen rows; "" for none."""
    holding, records = ({row["record"] for row in members} for members in (chosen, rows))
    return f"{len(holding)} of {counted(rows, len(records))}" if holding else ""


def unit_of(rows: Iterable[Mapping[str, Any]]) -> str:
    """Return what records are called, in the singular: "motion" if the scene's own motion is among them."""
    return "motion" if any(row["record"] == OWN for row in rows) else RECORD


def counted(rows: Iterable[Mapping[str, Any]], number: int) -> str:
    """Return a number of records in words, by the name that `unit_of` gives them."""
    return f"{number} {unit_of(rows)}{'s' * (number != 1)}"


def print_motions(scene: Scene, rows: Sequence[Mapping[str, Any]], left: Sequence[str] = ()) -> None:
    """Print a row for each motion, the warnings of all, and the `headline`; nothing without motions.

    rows : as in `headline`; those with a mapping "changes" have a further column for each of its names.
    """
    if not rows:
        return
    changes = list(dict.fromkeys(name for row in rows for name in row.get("changes", ())))[::-1]  # overturning first
    columns: dict[str, Callable[[Mapping[str, Any]], str]] = {
        "motion": lambda row: readable(row["motion"]),
        "peak\n[g]": lambda row: f"{row['peak'] / scene.gravity:.3g}",
        "outcome": lambda row: row["outcome"],
    }
    if any(row["warnings"] for row in rows):
        columns["warnings"] = lambda row: ", ".join(
            dict.fromkeys(_warning_words(warning)[0] for warning in row["warnings"])
        )
    columns |= {
        "tilt\n[-]": lambda row: digits(row["tilt"], ".3g"),
        **{name.replace(" > ", " >\n"): partial(_change_text, name) for name in changes},
    }
    if scene.base is not None:
        columns["base\n[m]"] = lambda row: digits(row["stroke"], ".3g")
    if any(row["slip"] for row in rows):
        columns["slip\n[m]"] = lambda row: digits(row["slip"], ".3g")
    table = [[cell(row) for cell in columns.values()] for row in rows]
    failed = [f"{readable(row['motion'])}: {readable(row['failure'])}" for row in rows if row["failure"]]
    echo(
        grid([*columns], table, left=["warnings"], wraps=["motion", "warnings"]),
        *failed,
        *motion_warnings(rows),
        *_interleaved(rows),
        headline(rows, left) or "",
        wrap=True,
    )


def _interleaved(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a sentence on the motions under which the change given may not be the nearest, if any."""
    names = listed([readable(row["motion"]) for row in rows if row.get("interleaved")])
    return [f"The outcomes are interleaved under {names}: do not base a decision on these changes."] if names else []


def _change_text(name: str, row: Mapping[str, Any]) -> str:
    return row["changes"].get(name, "")


def motion_warnings(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the warnings of all motions and which motions they concern; those of one quantity are joined."""
    pairs = [(row["motion"], Caution(**warning)) for row in rows for warning in row["warnings"]]
    return [readable(words) for words in warned(pairs, len(rows), "all motions")]


def odds(rows: Sequence[Mapping[str, Any]], outcomes: Sequence[str], word: str) -> str:
    """Return in words under how many records or motions the block has one of these outcomes, `word` being the verb.

    One direction or sign is enough. The interval of the share is Wilson's over records, as motions of one record are no
    sample. A record without such an outcome and with a failed run is left out.
    """
    hits: dict[str, float] = {}
    for row in rows:
        hit = 1.0 if row["outcome"] in outcomes else math.nan if row["outcome"] == "failed" else 0.0
        earlier = hits.get(row["record"], 0.0)
        hits[row["record"]] = 1.0 if 1.0 in (hit, earlier) else earlier + hit
    known = [hit for hit in hits.values() if not math.isnan(hit)]
    if not known:
        return f"{word} under no {unit_of(rows)} that could be run"
    told = f"{word} under {sum(known):.0f} of {counted(rows, len(known))}"
    if len(known) == 1:  # no sample
        return told
    low, high = wilson(int(sum(known)), len(known))
    return f"{told} ({number(100 * low, 2)} to {percent(high)} at 95 %)"


HELD = "#009E73"  # Okabe and Ito


OF_LEAD_RUBBER, OF_PENDULA = (  # {label: format of the constants}
    {"ka of each [N/m]": "{bearings.ka:.6g}", "kb of each [N/m]": "{bearings.kb:.6g}", "alpha": "{bearings.alpha:.6g}"},
    {"radius of curvature [m]": "{sizes.radius:.4g}", "friction of the bearings": "{sizes.friction:.3g}"},
)


def print_bearings(
    scene: Scene,
    scan: BearingScan,
    stroke: float,
    tilt: float,
    motions: Sequence[Mapping[str, Any]],
    chosen: Mapping[str, Mapping[str, Any]],
    warnings: Sequence[Caution] = (),
    nothing: str = "",
) -> None:
    """Print `warnings` and a column for each of the `chosen` bearings; without any, the sentence `nothing`.

    stroke : room of the base [m]. tilt : limit of the peak tilt, over slenderness. motions : rows of
    `execution.command_runs.read_row`.
    """
    assert scene.base is not None  # the search asks for one
    name, aim = readable(scene.name, TITLE_CHARACTERS), _aim(scene, stroke, tilt)
    echo(
        *(f"Warning: {readable(str(warning))}" for warning in warnings),
        f"{name}: {aim}; base: {scene.base.mass:g} kg; motions: {len(motions)}",
        wrap=True,
    )
    if not chosen:
        return echo(*motion_warnings(motions), nothing, wrap=True)
    if len({(design["period"], design["damping"]) for design in chosen.values()}) == 1:
        chosen = {" and ".join(chosen): next(iter(chosen.values()))}
    swings = any(design["sizes"] and design["sizes"].kind == "pendulum" for design in chosen.values())
    unmade = [name for name, design in chosen.items() if design["sizes"] and design["sizes"].reasons]
    held = "meet this aim" if unmade else "meet this aim and are made"
    if unmade:
        echo(f"Warning: no such bearings are made: {' and '.join(unmade)}; the reasons are below the table.", wrap=True)
    rows = {
        "secant period at the stroke [s]": "{period:.3g}",
        "equivalent damping at the stroke": "{damping:.3g}",
        **(OF_PENDULA if swings else OF_LEAD_RUBBER),
        "base displacement, worst motion [m]": "{stroke:.4g}",
        "acceleration over that of uplift": "{uplift:.3g}",
        **({} if scene.friction is None else {"friction demand over the friction": "{friction:.3g}"}),
        "peak tilt / slenderness": "{tilt:.3g}",
    }
    cells = [[label, *(form.format(**design) for design in chosen.values())] for label, form in rows.items()]
    echo(
        grid(["bearings", *chosen], cells, wraps=["bearings", *chosen]),
        f"Of bearings {_scan_words(scan)}, {percent(float(np.mean(scan.demand <= 1)))} {held}.",
        *(words for design in chosen.values() for words in motion_warnings(design["motions"])),
        *(
            f"{'On the ' + name + ' bearings: ' if len(chosen) > 1 else ''}{sentence}"
            for name, design in chosen.items()
            for sentence in (design["headline"], *(design["sizes"].sentences if design["sizes"] else ()))
        ),
        *dict.fromkeys(design["sizes"].assumed for design in chosen.values() if design["sizes"]),
        wrap=True,
    )


EXCEEDED = {  # {limit of `bearing_scan.LIMITS`: clause saying that it is exceeded}
    "stroke": "the stroke is exceeded",
    "slip": "the block slides, the friction exceeded",
    "tilt": "the tilt limit is exceeded",
    "uplift": "the block lifts, the acceleration of uplift exceeded",
}


def nothing_holds(scene: Scene, scan: BearingScan, stroke: float, tilt: float, motions: Sequence[Motion]) -> str:
    """Return sentences: no bearings hold; the nearest ones, the limit they exceed, under which motion; the remedy."""
    period, damping = scan.nearest
    limit, motion, demand = hardest(scene, scan.bearings(period, damping), motions, stroke, tilt)
    row, column = np.abs(scan.dampings - damping).argmin(), np.abs(scan.periods - period).argmin()
    under = f"under {readable(motion.label)}"
    near = (
        f"Nearest: {period:.3g} s with {damping:.3g} of critical damping: {EXCEEDED[limit]} by {percent(demand - 1)} "
        f"{under}. The base moves by up to {scan.stroke[row, column]:.3g} m of {stroke:g}."
        if math.isfinite(demand)
        else f"None comes near: the block jumps off its base or overturns on all of them, {under} on those of "
        f"{period:.3g} s with {damping:.3g}."
    )
    cure = f"Allow more stroke{_or_tilt(scene)}; or widen, fix or lower the block."
    return f"no bearings {_scan_words(scan)} meet this aim. {near} {cure}"


def _or_tilt(scene):
    """Return what else may be allowed or done; allowing tilt does not help a block that slides before it lifts."""
    if scene.friction is None or scene.friction >= math.tan(scene.block.slenderness):
        return ", or --tilt"
    return f", or hold the block against sliding (its friction {scene.friction:g} is below tan γ, at which it lifts)"


def _scan_words(scan):
    low, high = scan.dampings[0], scan.dampings[-1]
    return f"of {scan.periods[0]:g} to {scan.periods[-1]:g} s and {percent(low)} to {percent(high)} of critical damping"


def draw_bearings(scene: Scene, scan: BearingScan, stroke: float, tilt: float) -> Figure:
    """Draw the region of period and damping whose bearings hold, and the points named: a matplotlib Figure."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axis = figure.subplots()
    shown = np.clip(scan.demand, 0, 3)
    axis.contourf(scan.periods, 100 * scan.dampings, shown, [0, 1], colors=[HELD], alpha=0.35)
    axis.contour(scan.periods, 100 * scan.dampings, shown, [1], colors=[HELD], linewidths=1.5)
    lines = axis.contour(scan.periods, 100 * scan.dampings, shown, [1.25, 1.5, 2], colors="0.5", linewidths=0.8)
    axis.clabel(lines, fmt="%g", fontsize="small")
    for name, point, marker in (("least stroke", scan.least_stroke, "o"), ("softest", scan.softest, "D")):
        if point is not None:
            label = f"{name}: {point[0]:.3g} s, {point[1]:.1%}"
            axis.plot(point[0], 100 * point[1], marker, color="black", fillstyle="none", label=label, clip_on=False)
    axis.set_xscale("log")
    ticks = [t for t in (0.3, 0.5, 0.7, 1, 1.5, 2, 3, 4, 5, 7, 10) if scan.periods[0] <= t <= scan.periods[-1] * 1.001]
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks], minor=False)
    axis.minorticks_off()
    axis.set(xlabel=f"secant period at {stroke:g} m [s]", ylabel=f"equivalent damping at {stroke:g} m [%]")
    axis.set_title(
        f"{readable(scene.name, TITLE_CHARACTERS)}: {_aim(scene, stroke, tilt)}", loc="left", fontsize="medium"
    )
    handles = [Patch(facecolor=HELD, alpha=0.35, label="hold"), *axis.get_legend_handles_labels()[0]]
    lines_label = Patch(facecolor="none", edgecolor="0.5", label="times the nearer limit")
    figure.legend(handles=[*handles, lines_label], loc="outside lower center", ncols=4, frameon=False, fontsize="small")
    return figure


def _aim(scene, stroke, tilt):
    limit = "no uplift" if tilt == 0 else f"tilt up to {tilt:g} of the slenderness"
    limit += "" if scene.friction is None else f" and no slip at friction {scene.friction:g}"
    return f"bearings for {limit} within {stroke:g} m"


# {limit state: (its name in tables, its clause in sentences, its colour)}
ODDS = {
    "overturns": ("overturns", "the block overturns", COLOURS["overturns"][0]),
    "falls off": ("falls off", "the block falls off its pedestal", COLOURS["falls off"][0]),
    "stroke": ("base > x_max", "the base exceeds x_max", STROKE[0]),
    "lifts": ("lifts", "the block lifts", OUTSIDE[0]),
    "slides": ("slides", "the block slides", COLOURS["slides"][0]),
}
MOST_RECORDS = 5  # shown


def risk_headline(odds: Sequence[Odds], under: str, draws: int, pga: float | None, pgv: float | None) -> str:
    """Return the odds in sentences, the gravest first; a base beyond x_max before them, as they do not hold then.

    under: which motions. pga [g], pgv [m/s].
    """
    scaled = f", scaled to {pga:g} g" if pga else f", scaled to {pgv:g} m/s" if pgv else ""
    beyond = [each for each in odds if each.state == "stroke" and each.probability > 0]
    shares = [
        f"{ODDS[each.state][1]} in {percent(each.probability)} "
        f"({number(100 * each.low, 2)} to {percent(each.high)} at 95 %)"
        for each in (*beyond, *(each for each in odds if each not in beyond))
    ]
    sentences = [f"{shares[0]} of {draws} draws of its values {under}{scaled}", *shares[1:]]
    if beyond:
        words = (
            "beyond x_max bearings may tear or hit a stop: what happens then is not known, and the odds that follow "
            "leave it out"
        )
        sentences.insert(1, words)
    return " ".join(f"{words[0].upper()}{words[1:]}." for words in sentences)


def print_risk(scene: Scene, risk: Risk, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print the answer, warnings, the spreads with their effects and sources, and the records of the largest odds.

    rows : of `execution.command_runs.rows_of`, the unchanged scene under each motion.
    """
    names = [ODDS[each.state][0] for each in risk.odds]
    quantities = [
        [
            each.quantity,
            f"{each.value:.4g} {each.unit}".removesuffix(" -"),
            percent(each.spread),
            *(
                f"{100 * change:+.2g}" if abs(change) > noise else "."
                for change, noise in (odds.effects[each.quantity] for odds in risk.odds)
            ),
        ]
        for each in risk.drawn
    ]
    worst = sorted(risk.records.items(), key=lambda item: [-(item[1][each.state] or 0) for each in risk.odds])[
        :MOST_RECORDS
    ]
    records = [[readable(name), *map(percent, shares.values())] for name, shares in worst]
    parts: list[Grid | str] = [
        f"{readable(scene.name, TITLE_CHARACTERS)}: {readable(risk.headline)}",
        "The intervals are over draws alone: under other motions odds may be quite different (--motions, --records)."
        if len(risk.records) == 1
        else "The intervals take records, not runs, as independent.",
        "These odds are those under such a motion, not per year.",
        *map(_travel, risk.travel, risk.travel.values()),
        f"Runs that failed, and do not count: {risk.failed}. The first: {readable(risk.why)}." if risk.failed else "",
        *(f"Warning: {readable(warning.text)}" for warning in risk.warnings),
        *motion_warnings(rows),
        grid(["drawn", "value", "spread", *names], quantities) if quantities else "",
        "Columns on the right: change of the odds, in percentage points, if the value is higher by one spread. A dot: "
        "the change is within the noise."
        if quantities
        else "",
        *map(_most_important, risk.odds),
        *(f"Spread of {each.quantity}: {each.source}." for each in risk.drawn),
        grid(["record", *names], records, wraps=["record"]) if len(risk.records) > 1 else "",
        f"Further records, in --json: {len(risk.records) - len(records)}." if len(risk.records) > len(records) else "",
    ]
    echo(*(part for part in parts if part), wrap=True)


def _travel(name, quantiles):
    """Return a sentence on how far the block slips, or the base moves."""
    half, most, largest = (f"{value:.2g}" for value in quantiles)
    what = "the slip of the block" if name == "slip" else "the displacement of the base"
    return (
        f"In runs that stay upright, {what} is at most {half} m in half of them, {most} m in 95 %, {largest} m in all."
    )


def _most_important(odds):
    """Return a sentence on the quantity on which a limit state depends most; "" where its odds are 0 or 1."""
    changes = {name: abs(change) for name, (change, noise) in odds.effects.items() if abs(change) > noise}
    clause = f"Whether {ODDS[odds.state][1]} depends"
    if changes:
        return f"{clause} most on {max(changes, key=changes.__getitem__)}."
    noise = max((noise for _, noise in odds.effects.values()), default=0.0)
    return f"{clause} on no value beyond the noise of {100 * noise:.2g} points." if noise else ""


def draw_odds(risk: Risk) -> Figure:
    """Draw the probability of each limit state, with its interval, over the scale of the motions."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.2), layout="constrained")
    axis = figure.subplots()
    at = [(risk.pga or risk.pgv or 1.0) * scale for scale in risk.intensities]
    for index, first in enumerate(risk.odds):
        name, _, colour = ODDS[first.state]
        rows = [odds[index] for odds in risk.intensities.values()]
        axis.plot(at, [100 * each.probability for each in rows], "o-", color=colour, label=name)
        axis.fill_between(
            at, [100 * each.low for each in rows], [100 * each.high for each in rows], color=colour, alpha=0.2
        )
    axis.set(ylim=(0, 100), ylabel="probability, and its 95 % interval [%]")
    axis.set_xlabel("PGA [g]" if risk.pga else "PGV [m/s]" if risk.pgv else "scale of the motions [-]")
    axis.set_title(readable(risk.scene, TITLE_CHARACTERS), loc="left")
    figure.legend(loc="outside lower center", ncols=len(ODDS), frameon=False)
    return figure
