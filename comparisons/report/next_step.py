"""The next step for a statue: a command that runs on its file, and the necessary width of a plate under it."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analytic import Block, Scene, SceneError, simulate_many
from analytic.bearing_scan import first_stroke
from analytic.margins import check_cost
from analytic.motion import Motion

from ..showing.parts import number

BROAD = 10.0  # width over height of a block that no motion lifts
STEP = 0.01  # relative, of the widths tried


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
    slips = {width: _slip(scene, motions, width) for width in (stands, upright) if width}
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


def _slip(scene, motions, width):
    """The largest slip [m] of the block on a plate so wide [m]."""
    return max(float(found.peak_slip[0]) for found in _runs([scene.with_(block=on_plate(scene.block, width))], motions))


def _upright(scene, motions, widest):
    """The width [m] from which on the block overturns under none; None where it is as it is, or it takes too long."""
    least = 2 * scene.block.half_width
    widths = np.geomspace(least, widest, 1 + math.ceil(math.log(widest / least) / STEP))
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
