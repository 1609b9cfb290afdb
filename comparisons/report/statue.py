"""The card of a statue: results of the analytic model for a scene, on one page.

The next step for a statue: a command that runs on its file, and the necessary width of a plate under it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from analytic import Block, Scene, SceneError, simulate, simulate_many
from analytic.bearing_scan import first_stroke
from analytic.margins import SHARE, SPAN, STEP, TILT, check_cost, cliffs, limit_states, margins, nearby
from analytic.motion import Motion
from analytic.records.folder import reversed_sign, same_reversed
from analytic.response import JUDGED, about_record, scene_warnings

from ..execution.provenance import Result
from ..execution.solving import row_of, with_near, with_own
from ..plotting.margins import LIFTED, counted, doubts, headline, motion_warnings, unit_of
from ..plotting.parts import across, grouped, table
from ..plotting.wording import listed
from ..schemas.columns import Column, number, signed
from .sections import different

BROAD = 10.0  # width over height of a block that no motion lifts
PLATE_STEP = 0.01  # relative, of the widths tried


def needed_by(scene: Scene, motions: Sequence[Motion]) -> dict[str, float | None]:
    """What keeps the block of a scene from lifting under all these motions; None where nothing does.

    stroke : first one to try in a search for bearings [m]: their x_max, or `first_stroke`. stands, upright : width of
    a plate fixed to the block [m] with which it does not lift, or, where it overturns on a narrower one, does not, nor
    slips beyond the plate's half width. slip : how far it slips [m] on the plate on which it does not lift or, where
    that is farther, on the other. friction : what it needs not to slide on a plate so wide, where the scene's is less.
    """
    if scene.start.tilt or scene.start.tilt_rate or not motions:  # it lifts however it stands
        return dict.fromkeys(("stroke", "stands", "upright", "slip", "friction"))
    stroke, height = first_stroke(scene, motions), 2 * scene.block.half_height
    broad = scene.with_(block=on_plate(scene.block, BROAD * height), friction=None)
    demand = max(found.friction_demand[0] for found in _runs([broad], motions))  # tan(gamma) at which it just lifts
    lifts = min(demand, scene.friction or math.inf)  # with tan(gamma) above its friction a block at rest slides
    stands = _up(height * lifts) if math.tan(scene.block.slenderness) < lifts < BROAD else None
    upright = stands and _upright(scene, motions, stands)
    slips = {width: _slip_on_plate(scene, motions, width) for width in (stands, upright) if width}
    if upright and (upright >= stands or slips[upright] > upright / 2):
        upright = None
    return {
        "stroke": stroke and ((scene.bearings and scene.bearings.x_max) or stroke),
        "stands": stands,
        "upright": upright,
        "slip": max((slips[width] for width in (stands, upright) if width), default=None),
        "friction": _up(demand) if scene.friction is not None and demand > scene.friction else None,
    }


def _up(value):
    """To three digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.ceil(value / digit) * digit


def on_plate(block: Block, width: float) -> Block:
    """The block on a plate without weight that is fixed to it and so wide [m]."""
    radius = math.hypot(block.half_height, width / 2)
    return Block(
        mass=block.mass,
        radius=radius,
        slenderness=math.atan2(width / 2, block.half_height),
        corner_inertia=block.centre_inertia + block.mass * radius**2,
        restitution=block.restitution,
    )


def _runs(scenes, motions):
    """`Outcomes` of the scenes under each of the motions."""
    for motion in motions:
        yield simulate_many([one.with_(motion=motion, duration=None) for one in scenes], contact=True)


def _slip_on_plate(scene, motions, width):
    """The largest slip [m] of the block on a plate so wide [m]."""
    return max(float(found.peak_slip[0]) for found in _runs([scene.with_(block=on_plate(scene.block, width))], motions))


def _upright(scene, motions, widest):
    """The width [m] from which on the block overturns under none; None where it is as it is, or it takes too long."""
    least = 2 * scene.block.half_width
    widths = np.geomspace(least, widest, 1 + math.ceil(math.log(widest / least) / PLATE_STEP))
    try:
        check_cost(scene.with_(duration=None), len(widths) * len(motions))
    except SceneError:
        return None
    scenes = [scene.with_(block=on_plate(scene.block, width)) for width in widths]
    falls = np.any([found.overturns | found.failed for found in _runs(scenes, motions)], axis=0)
    last = np.flatnonzero(falls[:-1])
    return _up(widths[last[-1] + 1]) if len(last) else None


def next_step(scene: Mapping[str, Any], needed: Mapping[str, float | None] | None, call: str) -> tuple[str, str]:
    """(a command, in words what it is for) for a scene as the settings of a result have it.

    needed : as of `needed_by`, None where the block does not lift. call : on a command line the scene's file, and the
    options for its motions.
    """
    margin = f"rocking margin {call}"
    if needed is None:
        held = scene["base"] is None or scene["bearings"]
        ends = "It does not lift: there is nothing to do." if held else "On a base that nothing holds it does not lift."
        return margin, f"says how much it has to spare. {ends}"
    sizes, rubs = _sizes(scene, needed), scene.get("friction")
    if needed["stroke"] is None:
        does, cure = ("lifting", "widen, fix or lower it") if rubs is None else ("lifting or sliding", "fix it")
        return margin, f"says what changes the outcome. No bearings are likely to keep it from {does}; {sizes or cure}."
    base, given = "", "The stroke [m] is an example: give the room that the base has."
    if scene["base"] is None:
        mass = float(f"{scene['block']['mass']:.3g}")
        base = f" --base-mass {mass:g}"
        given = "Both numbers are examples: give the mass of the base it would stand on [kg], and its room to move [m]."
    elif scene["bearings"] and scene["bearings"]["x_max"]:
        given = "The stroke is the x_max of its bearings."
    aim = "does not lift" if rubs is None else "neither lifts nor slides"
    words = f"looks for bearings on which it {aim}. {given}{f' Or {sizes}.' if sizes else ''}"
    return f"rocking design {call}{base} --stroke {needed['stroke']:g}", words


def _sizes(scene, needed):
    """On how wide a plate it does not overturn, and does not lift; and with what friction it does not slide."""
    held = ""
    if needed.get("friction"):
        limit, mu = number(needed["friction"], 3), number(scene["friction"], 3)
        held = f"; it needs a friction of {limit} (now {mu}) not to slide"
    if needed["stands"] is None:
        return held.removeprefix("; ")
    now, stands = number(2 * scene["half_width"], 3), number(needed["stands"], 3)
    slip = needed.get("slip") or 0.0
    if slip > needed["stands"] / 2:
        return (
            f"fix it, as a plate does not do: on one {stands} m wide (now {now} m) it slides by {number(slip, 3)} m, "
            f"beyond half of that{held}"
        )
    words = "widen, fix or lower it: fixed to a plate"
    held = f", but slides by up to {number(slip, 3)} m{held}" if slip else held
    if needed["upright"] is None:
        return f"{words} {stands} m wide (now {now} m) it does not lift{held}"
    upright = number(needed["upright"], 3)
    return f"{words} {upright} m wide (now {now} m) it does not overturn, to one of {stands} m it does not lift{held}"


WORST = ("stands", "slides", "rocks", "failed", "overturns")  # of a record's motions, from the best to the worst
WORDS = {
    "stands": "does not lift",
    "slides": "slides and does not lift",
    "rocks": "rocks and stays upright",
    "overturns": "overturns",
    "failed": "leaves the model",
}
BEYOND = ("limit", "model")  # kinds of warnings that belong into the title
STATES = {"slides": "Sliding", "tilt": f"Tilt above {TILT:g} γ", "stroke": "Base beyond x_max"}  # beside the outcome


@dataclass(frozen=True)
class Card:
    """title: name and worst outcome. loud: sentences as important as that. next: a command, and what it is for. scene:
    as the result's settings have it.

    margin: of the quantity whose outcome changes nearest, None where none does. sentences: (heading, sentence) pairs.
    tables: page parts.
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
    """Results of the model for a scene, ready for a result file.

    motions : {record: its motions}. The scene's own is one more where it is not among them. left : what was left out.
    """
    found: dict[str, Any] = {"own": _figures(scene), "cautions": [], "near": [], "margins": []}
    found["cautions"] += map(str, scene_warnings(scene))
    if scene.base is not None and scene.bearings is not None:
        start = {"base_displacement": 0.0, "base_velocity": 0.0}
        found["free"] = _copy(scene.with_(base=None, bearings=None, start=start))
    try:
        if scene.motion is not None:
            changes, outcomes = nearby(scene)
            found["cautions"] += map(str, cliffs(scene, changes, outcomes))
            found["near"] = _near(scene, changes, outcomes)
        found["margins"] = [
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
        found["cautions"].append(f"The distance to another outcome was not searched: {error.remedy}.")
    if scene.motion is not None and not same_reversed(scene):  # else it is the mirrored run
        found["reversed"] = _copy(scene.with_(motion=reversed_sign(scene.motion)))
    records = with_own(scene.motion, motions)
    rows = [row_of(scene, record, motion, _decided) for record, group in records.items() for motion in group]
    found |= {"motions": rows if motions else [], "left_out": [*left]}
    found["needed"] = None
    if _lifts_or_goes_too_far(scene, found, rows):
        found["needed"] = needed_by(scene, [motion for group in records.values() for motion in group])
    return found


def _lifts_or_goes_too_far(scene, found, rows):
    """Whether the block lifts, or the base goes beyond x_max, under one of its motions or within SHARE of its own."""
    rows = [found["own"], *found["near"], *rows]
    x_max = math.inf if scene.bearings is None else scene.bearings.x_max or math.inf
    return any(row["outcome"] != "stands" or (row["stroke"] or 0.0) > x_max for row in rows)


def _decided(scene):
    return with_near(scene, simulate(scene.with_(duration=None), history=False))


def _copy(scene):
    """The figures of a copy of the scene, or why the model refuses it."""
    try:
        return _figures(scene)
    except SceneError as error:
        return {"refused": f"{error.key}: {error.problem}"}


def _figures(scene):
    response = simulate(scene, history=False)
    warnings = dict.fromkeys((*about_record(scene.motion), *response.warnings))
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


def _near(scene, changes, found):
    """[{change, outcome, tilt, stroke}] at -SHARE, 0, SHARE; and what is largest between them."""
    rows = [
        {
            "change": float(changes[at]),
            "outcome": str(found.names[at]),
            "tilt": float(found.peak_tilt[at]) / scene.block.slenderness,
            "stroke": float(found.peak_base_displacement[at]),
            "slip": float(found.peak_slip[at]),
        }
        for at in (0, len(changes) // 2, len(changes) - 1)
    ]
    worst = {
        "change": None,
        "outcome": ", ".join(dict.fromkeys(found.names.tolist())),
        "tilt": float(found.peak_tilt.max()) / scene.block.slenderness,
        "stroke": float(found.peak_base_displacement.max()),
        "slip": float(found.peak_slip.max()),
    }
    return [*rows, worst]


def card_of(result: Result, name: str, call: str = "FILE", first: str = "") -> Card:
    """The `Card` of one of the scenes of a result.

    call : on a command line its file, and the options for its motions. first : what is to be done to the file before.
    """
    scene, found = result.settings["scenes"][name], result.settings["statues"][name]
    own = found["own"]
    sentences = [*_sentences(found), *(("Warning", one["text"]) for one in own["warnings"])]
    sentences += [(_heading(found), words) for words in _failures(found["motions"]) + motion_warnings(found["motions"])]
    sentences.append(("Engines", _engines([row for row in result.rows if row["scene"] == name])))
    tables = [_main(found)]
    if found["near"]:
        tables.append(_near_table(found["near"], scene))
    if found["motions"]:
        tables.append(_motion_table(_by_record(found["motions"]), unit_of(found["motions"]), scene))
    if found["left_out"]:
        tables.append(table("Left out of the folder", found["left_out"], Column("file or channel, and why", str)))
    nearest = next((margin for margin in found["margins"][:1] if margin["nearest"] is not None), None)
    title = f"{scene['name']}: the block {'; '.join([_worst(found, scene), *_beyond(found)])}"
    command, words = next_step(scene, found["needed"], call)
    step = command, f"{words} {first}".rstrip()
    return Card(title, found["cautions"], step, scene, nearest, sentences, tables)


def _beyond(found):
    """What of the base or the block is beyond a limit, and under how many of the records."""
    if rows := found["motions"]:
        return [f"{clause} under {records}" for clause, records in doubts(rows, BEYOND).items()]
    return list(doubts([{"record": "", **found["own"]}], BEYOND))


def _failures(rows):
    """Why motions have no outcome."""
    return [f"{row['motion']}: {row['failure']}" for row in rows if row["failure"]]


def _by_record(rows):
    """A row for each record, that of the worst of its motions; the worst record first."""
    found = [
        {
            "record": record,
            "motions": len(group),
            "pga": max(row["peak"] for row in group),
            "outcome": max((row["outcome"] for row in group), key=WORST.index),
            "lifts": sum(row["outcome"] in LIFTED for row in group),
            "overturns": sum(row["outcome"] == "overturns" for row in group),
            **{name: _largest(group, name) for name in ("tilt", "stroke", "slip")},
            "doubts": ", ".join(doubts(group)),
        }
        for (record,), group in grouped(rows, "record").items()
    ]
    return sorted(found, key=lambda one: (-WORST.index(one["outcome"]), not one["doubts"], -(one["tilt"] or 0.0)))


def _largest(rows, name):
    """The largest number of a name; None where no run has one."""
    known = (row[name] for row in rows if row[name] is not None)
    return max(known, default=None)


def _worst(found, scene):
    """The worst outcome of all motions, and under how many of the records; and that of the scene's own."""
    own = found["own"]
    rows = [
        max((row["outcome"] for row in group), key=WORST.index)
        for group in grouped(found["motions"], "record").values()
    ]
    words = WORDS[own["outcome"]] + ("" if own["decided"] else " (not decided when the run ended)")
    worst = max(rows, key=WORST.index, default=None)
    known = scene["motion"] and own["decided"] and own["outcome"] == worst
    if not rows or (known and len(rows) == 1):
        return words
    count = "any" if worst == "stands" else rows.count(worst)
    under = f"{WORDS[worst]} under {count} of {counted(found['motions'], len(rows))}"
    if known:
        return f"{under}, its own among them"
    return f"{under}; {'under its own motion' if scene['motion'] else 'without a motion'} it {words}"


def _sentences(found):
    """(heading, sentence) of what the model says beyond the scene's own run."""
    sentences = _slid(found["own"])
    if "free" in found:
        sentences.append(("Without isolation", f"Free-standing, the block {_does(found['free'])}."))
    sentences += _nearest(found["margins"])
    if "reversed" in found:
        sentences.append(("Motion reversed", f"The block {_does(found['reversed'])}."))
    elif found["near"]:
        sentences.append(("Motion reversed", "The same, mirrored: block and start are symmetric."))
    if rows := found["motions"]:
        sentences.append((_heading(found), headline(rows, found["left_out"])))
    return sentences


def _heading(found):
    return f"{unit_of(found['motions']).capitalize()}s"


def _does(copy):
    """What the block does in a copy of the scene, or why that is not known."""
    return f"is outside the model ({copy['refused']})" if "refused" in copy else WORDS[copy["outcome"]]


def _slid(own):
    """How far the block slides on its support, if it does."""
    if not own.get("slip"):
        return []
    far, end = number(own["slip"], 3), number(abs(own["slip_end"]), 3)
    if own["outcome"] == "overturns":
        return [("Slip", f"It slides by up to {far} m before it lies, the last of it as it falls.")]
    return [("Slip", f"It slides by up to {far} m, and ends {end} m from where it stood.")]


def _slip_column(rows, head):
    """The column of the slip [m], none where no block of these rows slides."""
    return [Column(head, "slip", 3)] if any(row.get("slip") for row in rows) else []


def _nearest(found):
    """What the smallest change of one quantity changes: the outcome, and the limit states beside it."""
    if not found:
        return []
    first, span = found[0], f"{100 * SPAN:g} %"
    if first["nearest"] is None:
        sentences = [("Nearest change", f"No change of one quantity by up to {span} changes the outcome.")]
    else:
        text = f"{first['quantity']} {signed(first['nearest'])}: the block then {WORDS[first['then']]}."
        if first["interleaved"]:
            text += " Outcomes alternate there: do not rest a decision on this distance."
        sentences = [("Nearest change", text)]
    for state, label in STATES.items():
        known = [(one["quantity"], *one["states"][state]) for one in found if state in one["states"]]
        changing = [one for one in known if one[2] is not None]
        if changing:
            quantity, reached, change = min(changing, key=lambda one: abs(one[2]))
            sentences.append((label, f"{'No longer from' if reached else 'From'} {quantity} {signed(change)} on."))
    ends = [f"{one['quantity']} at {signed(at)} ({why})" for one in found for at, why in one["ends"]]
    return [*sentences, ("Ranges that end", f"{'; '.join(ends)}.")] if ends else sentences


def _engines(rows):
    """Which engines agree with the model, and in what the others differ or why they failed."""
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


def _main(found):
    columns = [{"name": "this scene", **found["own"]}]
    columns += [{"name": "free-standing", **found["free"]}] if "outcome" in found.get("free", ()) else []

    def share(value, limit):
        return number(value) if limit is None else f"{number(value)} of {number(limit)}"

    sway = Column("base displacement, of x_max [m]", lambda one: share(one["stroke"], one["x_max"]))
    return across(
        "The analytic model",
        columns,
        Column("quantity", "name"),
        Column("outcome", "outcome"),
        Column("peak tilt over slenderness [-]", lambda one: _tilt(one["outcome"], one["tilt"])),
        Column("peak ground acceleration [g]", lambda one: one["pga"] and one["pga"] / one["gravity"], 3),
        Column("uplift acceleration g tan γ [g]", lambda one: one["uplift"] / one["gravity"], 3),
        *([sway] if found["own"]["stroke"] is not None else []),
        *_slip_column(columns, "largest slip on the support [m]"),
        Column("friction demand, of the coefficient [-]", lambda one: share(one["demand"], one["friction"])),
        Column("least normal force N/(m g) [-]", "normal", 3),
    )


def _tilt(outcome, value):
    return "overturned" if "overturns" in outcome else number(value)


def _near_table(near, scene):
    return table(
        f"Within {100 * SHARE:g} % of the motion",
        near,
        Column(
            "change of the motion", lambda one: "anywhere between" if one["change"] is None else signed(one["change"])
        ),
        Column("outcome", "outcome"),
        Column("peak tilt over slenderness [-]", lambda one: _tilt(one["outcome"], one["tilt"])),
        *([Column("base displacement [m]", "stroke", 3)] if scene["base"] else []),
        *_slip_column(near, "slip [m]"),
    )


def _motion_table(motions, unit, scene):
    return table(
        f"By {unit}",
        motions,
        Column(unit, "record"),
        Column("runs", "motions"),
        Column("largest peak [g]", lambda one: one["pga"] / scene["gravity"], 3),
        Column("lifts", "lifts"),
        Column("overturns", "overturns"),
        Column("largest tilt over slenderness [-]", lambda one: _tilt(one["outcome"], one["tilt"])),
        *([Column("largest base displacement [m]", "stroke", 3)] if scene["base"] else []),
        *_slip_column(motions, "largest slip [m]"),
        *([Column("warnings", "doubts")] if any(one["doubts"] for one in motions) else []),
    )
