"""The card of a statue: results of the analytic model for a scene, and the next step for it.

The next step is a command that runs on the scene's file. Beside it stands the width of a plate under the statue that
keeps it from lifting or overturning.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analytic import Block, Scene, SceneError, simulate, simulate_many
from analytic.advice.bearing_scan import first_stroke
from analytic.advice.margins import SHARE, SPAN, STEP, TILT, check_cost, cliffs, limit_states, margins, nearby
from analytic.motion import Motion
from analytic.records.folder import reversed_sign, same_reversed
from analytic.response import FALLS, JUDGED, about_record, scene_warnings

from ..execution.command_runs import pedestal_check, row_of, with_near, with_own
from ..execution.results import Result
from ..plotting.margins import LIFTED, counted, doubts, falls_word, headline, motion_warnings, unit_of
from ..plotting.parts import across, grouped, table
from ..plotting.wording import listed
from ..schemas.columns import Column, number, signed
from ..schemas.runs import Sizes
from .sections import different

BROAD = 10.0  # width over height of a block that no motion lifts
PLATE_STEP = 0.01  # relative, of the widths tried


def needed_by(scene: Scene, motions: Sequence[Motion]) -> dict[str, float | None]:
    """Return what keeps the block of a scene from lifting under all these motions; None: nothing of that kind.

    stroke : stroke for a first search for bearings [m]: the bearings' x_max, or `first_stroke`. stands : width of a
    plate fixed to the block [m] on which it does not lift. upright : width of a narrower plate [m] on which it does not
    overturn, nor slip by more than the plate's half width; None if it overturns on none. slip : the largest slip [m] on
    these plates. friction : coefficient at which it does not slide on a plate, if the scene's is less.
    """
    # plates may be wider than the pedestal
    scene = scene.with_(pedestal=scene.pedestal and {"width": 4 * BROAD * scene.block.radius})
    if scene.start.tilt or scene.start.tilt_rate or not motions:  # it lifts however it stands
        return dict.fromkeys(("stroke", "stands", "upright", "slip", "friction"))
    stroke, height = first_stroke(scene, motions), 2 * scene.block.half_height
    broad = scene.with_(block=on_plate(scene.block, BROAD * height), friction=None)
    demand = max(
        outcomes.friction_demand[0] for outcomes in _outcomes_by_motion([broad], motions)
    )  # tan(gamma) at which it just lifts
    lifts = min(demand, scene.friction or math.inf)  # with tan(gamma) above its friction a block at rest slides
    stands = _rounded_up(height * lifts) if math.tan(scene.block.slenderness) < lifts < BROAD else None
    upright = stands and _upright(scene, motions, stands)
    slips = {width: _slip_on_plate(scene, motions, width) for width in (stands, upright) if width}
    if upright and (upright >= stands or slips[upright] > upright / 2):
        upright = None
    return {
        "stroke": stroke and ((scene.bearings and scene.bearings.x_max) or stroke),
        "stands": stands,
        "upright": upright,
        "slip": max((slips[width] for width in (stands, upright) if width), default=None),
        "friction": _rounded_up(demand) if scene.friction is not None and demand > scene.friction else None,
    }


def _rounded_up(value):
    """Round up to three digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.ceil(value / digit) * digit


def on_plate(block: Block, width: float) -> Block:
    """Return the block with a weightless plate of this width [m] fixed under it."""
    radius = math.hypot(block.half_height, width / 2)
    return Block(
        mass=block.mass,
        radius=radius,
        slenderness=math.atan2(width / 2, block.half_height),
        corner_inertia=block.centre_inertia + block.mass * radius**2,
        restitution=block.restitution,
    )


def _outcomes_by_motion(scenes, motions):
    """Yield the `Outcomes` of the scenes under each motion."""
    for motion in motions:
        yield simulate_many([scene.with_(motion=motion, duration=None) for scene in scenes], contact=True)


def _slip_on_plate(scene, motions, width):
    """Return the largest slip [m] of the block on a plate of this width [m]."""
    return max(
        float(outcomes.peak_slip[0])
        for outcomes in _outcomes_by_motion([scene.with_(block=on_plate(scene.block, width))], motions)
    )


def _upright(scene, motions, widest):
    """Return the width [m] from which on the block never overturns; None: it never does, or the search is too long."""
    least = 2 * scene.block.half_width
    widths = np.geomspace(least, widest, 1 + math.ceil(math.log(widest / least) / PLATE_STEP))
    try:
        check_cost(scene.with_(duration=None), len(widths) * len(motions))
    except SceneError:
        return None
    scenes = [scene.with_(block=on_plate(scene.block, width)) for width in widths]
    falls = np.any([outcomes.overturns | outcomes.failed for outcomes in _outcomes_by_motion(scenes, motions)], axis=0)
    last = np.flatnonzero(falls[:-1])
    return _rounded_up(widths[last[-1] + 1]) if len(last) else None


def next_step(scene: Mapping[str, Any], needed: Mapping[str, float | None] | None, call: str) -> tuple[str, str]:
    """Return (a command, its purpose in words) for a scene as in a result's settings.

    needed : of `needed_by`; None: the block does not lift. call : the scene's file, and options for its motions, as on
    a command line.
    """
    margin = f"rocking margin {call}"
    if needed is None:
        restrained = scene["base"] is None or scene["bearings"]
        ends = (
            "The block does not lift: there is nothing to do."
            if restrained
            else "On a base that nothing holds, the block does not lift."
        )
        return margin, f"tells how much the block has to spare. {ends}"
    sizes, rubs = _plate_words(scene, needed), scene.get("friction")
    if needed["stroke"] is None:
        does, cure = ("lifting", "widen, fix or lower it") if rubs is None else ("lifting or sliding", "fix it")
        words = f"No bearings are likely to keep the block from {does}; {sizes or cure}."
        return margin, f"tells what changes the outcome. {words}"
    base, given = "", "The stroke [m] is an example: give the room that the base has."
    if scene["base"] is None:
        mass = float(f"{scene['block']['mass']:.3g}")
        base = f" --base-mass {mass:g}"
        given = (
            "Both numbers are examples: give the mass of the base that the block would stand on [kg], and the room "
            "that this base has to move [m]."
        )
    elif scene["bearings"] and scene["bearings"]["x_max"]:
        given = "The stroke is the x_max of its bearings."
    aim = "does not lift" if rubs is None else "neither lifts nor slides"
    words = f"looks for bearings on which the block {aim}. {given}{f' Or {sizes}.' if sizes else ''}"
    return f"rocking design {call}{base} --stroke {needed['stroke']:g}", words


def _plate_words(scene, needed):
    """Return a clause: the plates on which the block does not overturn or lift, the friction that keeps it in place."""
    held = ""
    if needed.get("friction"):
        limit, mu = number(needed["friction"], 3), number(scene["friction"], 3)
        held = f"; it needs a friction coefficient of {limit} (now {mu}) to stay in place"
    if needed["stands"] is None:
        return held.removeprefix("; ")
    now, stands = number(2 * scene["half_width"], 3), number(needed["stands"], 3)
    slip = needed.get("slip") or 0.0
    if slip > needed["stands"] / 2:
        return (
            f"fix it, as a plate does not suffice: on one {stands} m wide (now {now} m) it slides by "
            f"{number(slip, 3)} m, more than half that width{held}"
        )
    words = "widen, fix or lower it: fixed to a plate"
    held = f", but slides by up to {number(slip, 3)} m{held}" if slip else held
    if needed["upright"] is None:
        return f"{words} {stands} m wide (now {now} m) it does not lift{held}"
    upright = number(needed["upright"], 3)
    return (
        f"{words} {upright} m wide (now {now} m) it does not overturn; fixed to one {stands} m wide it does not "
        f"lift{held}"
    )


WORST = ("stands", "slides", "rocks", "failed", *FALLS)  # outcomes from the best to the worst
WORDS = {
    "stands": "does not lift",
    "slides": "slides and does not lift",
    "rocks": "rocks and stays upright",
    "falls off": "slides off its pedestal",
    "overturns": "overturns",
    "pedestal overturns": "stands on a pedestal that overturns",
    "failed": "leaves the model",
}
BEYOND = ("limit", "model")  # kinds of warnings that stand in the title
STATES = {
    "slides": "Sliding",
    "falls off": "Falling off",
    "tilt": f"Tilt above {TILT:g} γ",
    "stroke": "Base beyond x_max",
}  # other limit states


@dataclass(frozen=True)
class Card:
    """The card of a scene.

    title: name and worst outcome. loud: sentences as important as that. next: a command, and its purpose. scene: as in
    the result's settings. margin: the margin of the quantity whose change changes the outcome first, None: none does.
    sentences: (heading, sentence) pairs. tables: parts of the page.
    """

    title: str
    loud: list
    next: tuple[str, str]
    scene: Mapping[str, Any]
    margin: Mapping[str, Any] | None
    sentences: list
    tables: list


def statue_of(
    scene: Scene, motions: Mapping[str, Sequence[Motion]], left: Sequence[str] = (), progress: Any = None
) -> dict[str, Any]:
    """Return results of the model for a scene, ready for a result file.

    motions : {record: its motions}; the scene's own motion is added if it is not among them. left : what was left out.
    progress : called with the name of each quantity whose margin is searched.
    """
    statue: dict[str, Any] = {"own": _numbers(scene), "cautions": [], "near": [], "margins": []}
    statue["cautions"] += map(str, scene_warnings(scene))
    statue["pedestal"], _, statue["stays"] = pedestal_check(scene)
    if scene.base is not None and scene.bearings is not None:
        start = {"base_displacement": 0.0, "base_velocity": 0.0}
        statue["free"] = _numbers_of_copy(scene.with_(base=None, bearings=None, start=start))
    try:
        if scene.motion is not None:
            changes, outcomes = nearby(scene)
            statue["cautions"] += map(str, cliffs(scene, changes, outcomes))
            statue["near"] = _near_rows(scene, changes, outcomes)
        statue["margins"] = [
            {
                "quantity": margin.quantity,
                "nearest": margin.nearest,
                "then": None if margin.nearest is None else margin.beyond(margin.nearest),
                "bands": margin.outcomes,
                "interleaved": margin.interleaved,
                "states": {state: [margin.reached(state), margin.change(state)] for state in limit_states(scene)},
                "ends": [
                    [at, why]
                    for at, why in ((margin.bands[0].low, margin.ends_down), (margin.bands[-1].high, margin.ends_up))
                    if why
                ],
            }
            for margin in margins(scene, step=STEP, progress=progress)
        ]
    except SceneError as error:  # too long to be run so often
        statue["cautions"].append(f"The distance to another outcome was not searched: {error.remedy}.")
    if scene.motion is not None and not same_reversed(scene):  # else it is the mirrored run
        statue["reversed"] = _numbers_of_copy(scene.with_(motion=reversed_sign(scene.motion)))
    records = with_own(scene.motion, motions)
    rows = [
        row_of(scene, record, motion, _run_until_decided)
        for record, of_record in records.items()
        for motion in of_record
    ]
    statue |= {"motions": rows if motions else [], "left_out": [*left]}
    sizes = Sizes.of(scene.bearings, scene.total_mass, scene.gravity)
    statue |= {"needed": None, "sizes": sizes and sizes.model_dump()}
    if _lifts_or_goes_too_far(scene, statue, rows):
        statue["needed"] = needed_by(scene, [motion for of_record in records.values() for motion in of_record])
    return statue


def _lifts_or_goes_too_far(scene, statue, rows):
    """Return whether the block lifts, or the base exceeds x_max, under one motion or within SHARE of its own."""
    rows = [statue["own"], *statue["near"], *rows]
    x_max = math.inf if scene.bearings is None else scene.bearings.x_max or math.inf
    return any(row["outcome"] != "stands" or (row["stroke"] or 0.0) > x_max for row in rows)


def _run_until_decided(scene):
    return with_near(scene, simulate(scene.with_(duration=None), history=False))


def _numbers_of_copy(scene):
    """Return the numbers of a copy of the scene, or why the model refuses it."""
    try:
        return _numbers(scene)
    except SceneError as error:
        return {"refused": f"{error.key}: {error.problem}"}


def _numbers(scene):
    response = simulate(scene, history=False)
    warnings = dict.fromkeys((*about_record(scene.motion), *response.warnings, *pedestal_check(scene)[1]))
    slid = response.sliding if response.sliding and response.sliding.peak else None
    return {
        "outcome": response.outcome,
        "decided": response.decided,
        "pga": scene.motion and scene.motion.peak,
        "uplift": scene.gravity * math.tan(scene.block.slenderness),
        "gravity": scene.gravity,
        "tilt": response.peak_tilt_ratio,
        "stroke": response.peak_base_displacement if scene.base else None,
        "x_max": scene.bearings and scene.bearings.x_max,
        "demand": response.friction_demand,
        "friction": scene.friction,
        "normal": response.min_normal_ratio,
        "slip": slid and slid.peak,
        "slip_end": slid and slid.end,
        "warnings": list(map(asdict, warnings)),
    }


def _near_rows(scene, changes, outcomes):
    """Return [{change, outcome, tilt, stroke, slip}] at -SHARE, 0, SHARE; last, the largest between them."""
    rows = [
        {
            "change": float(changes[at]),
            "outcome": str(outcomes.names[at]),
            "tilt": float(outcomes.peak_tilt[at]) / scene.block.slenderness,
            "stroke": float(outcomes.peak_base_displacement[at]),
            "slip": float(outcomes.peak_slip[at]),
        }
        for at in (0, len(changes) // 2, len(changes) - 1)
    ]
    worst = {
        "change": None,
        "outcome": ", ".join(dict.fromkeys(outcomes.names.tolist())),
        "tilt": float(outcomes.peak_tilt.max()) / scene.block.slenderness,
        "stroke": float(outcomes.peak_base_displacement.max()),
        "slip": float(outcomes.peak_slip.max()),
    }
    return [*rows, worst]


def card_of(result: Result, name: str, call: str = "FILE", first: str = "") -> Card:
    """Return the `Card` of a scene of a result.

    call : the scene's file, and options for its motions, as on a command line. first : what must be done to the file
    first, a sentence.
    """
    scene, statue = result.settings["scenes"][name], result.settings["statues"][name]
    run = statue["own"]
    sentences = [*_sentences(statue), *(("Warning", warning["text"]) for warning in run["warnings"])]
    failed = [f"{row['motion']}: {row['failure']}" for row in statue["motions"] if row["failure"]]
    sentences += [(_heading(statue), words) for words in failed + motion_warnings(statue["motions"])]
    sentences.append(("Engines", _engine_sentences([row for row in result.rows if row["scene"] == name])))
    tables = [_main_table(statue)]
    if statue["near"]:
        tables.append(_near_table(statue["near"], scene))
    if statue["motions"]:
        tables.append(_motion_table(_by_record(statue["motions"]), unit_of(statue["motions"]), scene))
    if statue["left_out"]:
        tables.append(table("Left out of the folder", statue["left_out"], Column("file or channel, and why", str)))
    nearest = next((margin for margin in statue["margins"][:1] if margin["nearest"] is not None), None)
    title = f"{scene['name']}: the block {'; '.join([_worst_words(statue, scene), *_exceeded(statue)])}"
    command, words = next_step(scene, statue["needed"], call)
    step = command, f"{words} {first}".rstrip()
    return Card(title, statue["cautions"], step, scene, nearest, sentences, tables)


def _exceeded(statue):
    """Return clauses on limits that base or block exceed, and under how many records."""
    if rows := statue["motions"]:
        return [f"{clause} under {records}" for clause, records in doubts(rows, BEYOND).items()]
    return list(doubts([{"record": "", **statue["own"]}], BEYOND))


def _by_record(rows):
    """Return a row for each record, of the worst of its motions; the worst record first."""
    records = [
        {
            "record": record,
            "motions": len(group),
            "pga": max(row["peak"] for row in group),
            "outcome": max((row["outcome"] for row in group), key=WORST.index),
            "lifts": sum(row["outcome"] in LIFTED for row in group),
            "falls": sum(row["outcome"] in FALLS for row in group),
            **{name: _largest(group, name) for name in ("tilt", "stroke", "slip")},
            "doubts": ", ".join(doubts(group)),
        }
        for (record,), group in grouped(rows, "record").items()
    ]
    return sorted(
        records,
        key=lambda record_row: (
            -WORST.index(record_row["outcome"]),
            not record_row["doubts"],
            -(record_row["tilt"] or 0.0),
        ),
    )


def _largest(rows, name):
    """Return the largest number of this name; None if no run has one."""
    return max((row[name] for row in rows if row[name] is not None), default=None)


def _worst_words(statue, scene):
    """Return the worst outcome, under how many records, and the outcome under the scene's own motion."""
    run = statue["own"]
    rows = [
        max((row["outcome"] for row in group), key=WORST.index)
        for group in grouped(statue["motions"], "record").values()
    ]
    words = WORDS[run["outcome"]] + ("" if run["decided"] else " (not decided when the run ended)")
    worst = max(rows, key=WORST.index, default=None)
    known = scene["motion"] and run["decided"] and run["outcome"] == worst
    if not rows or (known and len(rows) == 1):
        return words
    count = "any" if worst == "stands" else rows.count(worst)
    under = f"{WORDS[worst]} under {count} of {counted(statue['motions'], len(rows))}"
    if known:
        return f"{under}, its own among them"
    return f"{under}; {'under its own motion' if scene['motion'] else 'without a motion'} it {words}"


def _sentences(statue):
    """Return (heading, sentence) pairs on results of the model beyond the scene's own run."""
    sentences = [("Pedestal", words) for words in statue.get("stays", ())] + _slip_sentences(statue["own"])
    if "free" in statue:
        sentences.append(("Without isolation", f"Free-standing, the block {_copy_words(statue['free'])}."))
    sentences += _nearest_changes(statue["margins"])
    if "reversed" in statue:
        sentences.append(("Motion reversed", f"The block {_copy_words(statue['reversed'])}."))
    elif statue["near"]:
        sentences.append(("Motion reversed", "The same, mirrored: block and start are symmetric."))
    if sizes := statue.get("sizes"):
        sentences.append(("Bearings", " ".join([*sizes["sentences"], sizes["assumed"]])))
    if rows := statue["motions"]:
        sentences.append((_heading(statue), headline(rows, statue["left_out"])))
    return sentences


def _heading(statue):
    return f"{unit_of(statue['motions']).capitalize()}s"


def _copy_words(copy):
    """Return what the block does in a copy of the scene, or why that is not known."""
    return f"is outside the model ({copy['refused']})" if "refused" in copy else WORDS[copy["outcome"]]


def _slip_sentences(run):
    """Return how far the block slides on its support, if it does."""
    if not run.get("slip"):
        return []
    far, end = number(run["slip"], 3), number(abs(run["slip_end"]), 3)
    falls = {"falls off": " until it falls off", "overturns": " before it lies, the last of it as it falls"}
    rest = falls.get(run["outcome"], f", and ends {end} m from where it stood")
    return [("Slip", f"It slides by up to {far} m{rest}.")]


def _slip_column(rows, head):
    """Return the column of the slip [m] in a list; no column if no block of these rows slides."""
    return [Column(head, "slip", 3)] if any(row.get("slip") for row in rows) else []


def _nearest_changes(margins_found):
    """Return (heading, sentence) pairs on the smallest changes that change the outcome and other limit states."""
    if not margins_found:
        return []
    first, span = margins_found[0], f"{100 * SPAN:g} %"
    if first["nearest"] is None:
        sentences = [("Nearest change", f"No change of one quantity by up to {span} changes the outcome.")]
    else:
        text = f"{first['quantity']} {signed(first['nearest'])}: the block then {WORDS[first['then']]}."
        if first["interleaved"]:
            text += " Outcomes alternate there: do not rest a decision on this distance."
        sentences = [("Nearest change", text)]
    for state, label in STATES.items():
        known = [
            (margin["quantity"], *margin["states"][state]) for margin in margins_found if state in margin["states"]
        ]
        changing = [margin for margin in known if margin[2] is not None]
        if changing:
            quantity, reached, change = min(changing, key=lambda margin: abs(margin[2]))
            sentences.append((label, f"{'Ends' if reached else 'Begins'} at {quantity} {signed(change)}."))
    ends = [f"{margin['quantity']} at {signed(at)} ({why})" for margin in margins_found for at, why in margin["ends"]]
    return [*sentences, ("Ranges that end", f"{'; '.join(ends)}.")] if ends else sentences


def _engine_sentences(rows):
    """Return sentences on which engines agree with the model, how the others differ, or why they failed."""
    engines = [row for row in rows if row["engine"] != "analytic"]
    if not engines:
        return "None was run."
    agree = [row["engine"] for row in engines if row.get("comparable") in JUDGED and not row.get("differences")]
    sentences = [f"{listed(agree)} agree{'s' * (len(agree) == 1)} with the analytic model"] if agree else []
    for row in engines:
        if row["engine"] not in agree:
            words = [f"failed: {row['failure']['reason']}"] if row["failure"] else different(row)
            sentences += [f"{row['engine']} {sentence}" for sentence in words or ["was not compared"]]
    return "; ".join(sentences) + "."


def _main_table(statue):
    columns = [{"name": "this scene", **statue["own"]}]
    columns += [{"name": "free-standing", **statue["free"]}] if "outcome" in statue.get("free", ()) else []

    def share(value, limit):
        return number(value) if limit is None else f"{number(value)} of {number(limit)}"

    sway = Column("base displacement, of x_max [m]", lambda run: share(run["stroke"], run["x_max"]))
    return across(
        "The analytic model",
        columns,
        Column("quantity", "name"),
        Column("outcome", "outcome"),
        Column("peak tilt over slenderness [-]", lambda run: _tilt(run["outcome"], run["tilt"])),
        Column("peak ground acceleration [g]", lambda run: run["pga"] and run["pga"] / run["gravity"], 3),
        Column("uplift acceleration g tan γ [g]", lambda run: run["uplift"] / run["gravity"], 3),
        *([sway] if statue["own"]["stroke"] is not None else []),
        *_slip_column(columns, "largest slip on the support [m]"),
        Column("friction demand, of the coefficient [-]", lambda run: share(run["demand"], run["friction"])),
        Column("least normal force N/(m g) [-]", "normal", 3),
    )


def _tilt(outcome, value):
    return "overturned" if "overturns" in outcome else number(value)


def _near_table(near, scene):
    return table(
        f"Within {100 * SHARE:g} % of the motion",
        near,
        Column(
            "change of the motion", lambda run: "anywhere between" if run["change"] is None else signed(run["change"])
        ),
        Column("outcome", "outcome"),
        Column("peak tilt over slenderness [-]", lambda run: _tilt(run["outcome"], run["tilt"])),
        *([Column("base displacement [m]", "stroke", 3)] if scene["base"] else []),
        *_slip_column(near, "slip [m]"),
    )


def _motion_table(motions, unit, scene):
    return table(
        f"By {unit}",
        motions,
        Column(unit, "record"),
        Column("runs", "motions"),
        Column("largest peak [g]", lambda record: record["pga"] / scene["gravity"], 3),
        Column("lifts", "lifts"),
        Column(falls_word(motions), "falls"),
        Column("largest tilt over slenderness [-]", lambda record: _tilt(record["outcome"], record["tilt"])),
        *([Column("largest base displacement [m]", "stroke", 3)] if scene["base"] else []),
        *_slip_column(motions, "largest slip [m]"),
        *([Column("warnings", "doubts")] if any(record["doubts"] for record in motions) else []),
    )
