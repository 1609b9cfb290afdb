"""Analysis of one impact, and of the cause of its error, from the positions of the block in an engine's steps.

Newton's laws give the impulses that an engine must have used between two steps, whatever its solver calls them: upward
at each corner, and along the ground at both together. The angular momentum about the landing corner, which neither
friction nor the impulse of that corner changes, then splits the error of e into parts that add up to it. s and r are
the speeds of a corner on the ground, in the direction of the centre's motion and away from the ground; mt = m/M (0 on
rigid ground); J' = J_O - m mt h^2; and w is the rate before the impact:

    J' w de = 2 b (impulse of the old corner, less what bears the block up to the landing)     parts `support`, `pull`
              - m (h (1 - mt) s + b r), of the pivot after, and + of the pivot before          parts `slip`, `rebound`

`pull` is the negative part of the old corner's impulses. The remainder, of second order, comes from bearings and
gravity during the contact. Two more quantities have the same unit. `flight`: the energy gained in the second half of
the swing before, as a share of w. `shape`: the change of e if the strike acts where the weight acted
just before, although the landing corner is still in the air and should carry no load.

`cause_of` infers the cause of the error from these steps alone, without the variant's settings.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic import Scene
from analytic.motion import Motion, vertical_acceleration
from analytic.rocking import restitution
from engines import get_engine
from engines.loads import ground_velocity
from engines.swings import ArrayModel, Trace, find_swings, to_contact
from engines.trace_checks import energy_balance, pivoting_centre

from .agreement import Unmeasurable

PARTS = ("support", "pull", "slip", "rebound")  # of the error of e
BESIDE = 3  # steps in flight shown on each side of the contact
LEAST_STRIKE = 0.1  # least impulse of a strike, over the impulse that turns the centre's fall into a rise


@dataclass(frozen=True)
class Contact:
    """An impact of a trace, with n steps around it. Of two columns the first is the landing corner, then the old one.

    Parameters
    ----------
    placed : bool
        The trace has the position of the block. Otherwise the block is assumed to pivot about its corners.
    landing : float
        Time at which the flight before reaches tilt = 0 [s].
    before, after : float
        Tilt rates extrapolated to tilt = 0 [rad/s].
    error : float
        after/before less the scene's restitution.
    parts : dict
        Parts of the error: support, pull, slip, rebound, see above, or their sum as contact if the block is not
        `placed`. Beside them flight and, if the block is placed, shape.
    late : float
        Error of e caused by a late strike, over the delay [1/s].
    time : array, shape (n,)
        Time from the landing [s].
    tilt, energy : arrays, shape (n,)
        [rad]; less work done and bearings' loss, over the kinetic energy before the impact, 1 at the first step.
    height, sinking, slip : arrays, shape (n, 2)
        Height of the corners above the ground [m], their speed downward and along the base [m/s].
    impulse : array, shape (n - 1, 2)
        Upward impulse between two steps [N s].
    friction : array, shape (n - 1,)
        Impulse of both corners along the ground [N s].
    strike : array, shape (n - 1,)
        The landing corner's impulse without the part that supports the block after the landing, over its sum.
    first, last : int
        Indices of the last step in clean flight before the contact, and of the first one after it.
    """

    placed: bool
    landing: float
    before: float
    after: float
    error: float
    parts: dict[str, float]
    late: float
    time: np.ndarray
    tilt: np.ndarray
    energy: np.ndarray
    height: np.ndarray
    sinking: np.ndarray
    slip: np.ndarray
    impulse: np.ndarray
    friction: np.ndarray
    strike: np.ndarray
    first: int
    last: int

    @property
    def phase(self) -> float:
        """Error of e caused by a strike that is late by one step, the longest while the landing corner is struck."""
        return self.late * float(np.diff(self.time)[self._struck].max())

    @property
    def steps(self) -> int:
        """Number of steps that carry nine tenths of the strike."""
        return int(np.ptp(self._struck)) + 1

    @property
    def deepest(self) -> float:
        """Largest penetration of a corner [m]."""
        return float(max(-self.height.min(), 0.0))

    @property
    def _struck(self):
        total = np.cumsum(self.strike)
        return np.flatnonzero((total > 0.05) & (total - self.strike < 0.95))


def contact_of(scene: Scene, trace: Trace, which: int = 0) -> Contact:
    """Return the `Contact` of the impact number `which` of a trace.

    Raises
    ------
    Unmeasurable
        The trace has no such impact between two swings, or no corner is struck in it.
    """
    placed = trace.centre is not None
    if not placed:
        trace = replace(trace, centre=pivoting_centre(scene, trace))
    swings = find_swings(trace)
    land, before, _ = to_contact(scene, trace, swings, 1)
    _, after, _ = to_contact(scene, trace, swings, -1)
    passed = np.flatnonzero((swings.side[1:] == -swings.side[:-1]) & np.isfinite(before[:-1] + after[1:]))
    if which >= len(passed):
        raise Unmeasurable(f"impact {which}: the trace has {len(passed)} between two swings")
    k = passed[which]
    begin = max(swings.last[k] - BESIDE, 0)
    first, last = int(swings.last[k] - begin), int(swings.clean[k + 1] - begin)
    seen, side = trace.at(slice(begin, begin + last + BESIDE + 1)), swings.side[k]
    corners = corner_motion(scene, seen, side) | corner_impulses(scene, seen, side)
    landing, rates = float(land[k]), (float(before[k]), float(after[k + 1]))
    normals, steps = pivot_forces(scene, seen, side, landing, rates), np.diff(seen.time)
    ahead = np.clip(landing - seen.time[:-1], 0.0, steps)  # part of each step before the landing
    strike = corners["impulse"][:, 0] - normals[1] * (steps - ahead)
    strike[:first], strike[last:] = 0.0, 0.0
    # The centre falls at b w before the impact and rises at e b w after it.
    if not strike.sum() > LEAST_STRIKE * scene.block.mass * scene.block.half_width * abs(sum(rates)):
        raise Unmeasurable(f"no corner is struck while the tilt is below {trace.contact_tilt:.3g}: elsewhere, or none")
    parts = _parts(scene, corners, rates[0], normals[0] * ahead[first:last].sum(), slice(first, last))
    borne = corners["impulse"][:first].sum(axis=0)  # in flight, by each corner
    parts["shape"] = float(borne[0] / borne.sum()) * _moved(scene, strike.sum(), rates[0])
    if not placed:
        parts = {"contact": sum(parts[name] for name in PARTS)}
    return Contact(
        placed,
        landing,
        *rates,
        rates[1] / rates[0] - restitution(scene),
        parts | {"flight": _gained_in_flight(scene, trace, swings.first[k], swings.last[k], rates[0])},
        _moved(scene, normals[0], rates[0]),
        seen.time - landing,
        seen.tilt,
        1.0 + energy_balance(scene, seen)[0] / (0.5 * _inertia(scene) * rates[0] ** 2),
        strike=strike / strike.sum(),
        first=first,
        last=last,
        height=corners["height"],
        sinking=corners["sinking"],
        slip=corners["slip"],
        impulse=corners["impulse"],
        friction=corners["friction"],
    )


def _gained_in_flight(scene: Scene, trace: Trace, first: int, last: int, rate: float) -> float:
    """The energy gained in the second half of a swing, as a share of the rate at its end.

    The first half is left out, because a start may settle on its contact. For a weak impact within a strong motion the
    unit is the largest kinetic energy, because the work of ground and bearings is known to a share of that.
    """
    middle = np.searchsorted(trace.time, 0.5 * (trace.time[first] + trace.time[last]))
    balance, kinetic = energy_balance(scene, trace.at(slice(middle, last + 1)))
    return float(balance[-1] / max(_inertia(scene) * rate**2, 2 * kinetic.max()))


def frames(contact: Contact) -> dict[str, dict[str, list[float]]]:
    """Return the contact in four frames, each of times from the landing [s] and values.

    straddle: the landing corner's height [m] around the step that is struck. energy: over the kinetic energy before the
    impact. If the block is placed, also penetration: that height over the whole contact; and rebound: the landing
    corner's speed away from the ground, over the speed of its fall.
    """
    time, height = contact.time.tolist(), contact.height[:, 0].tolist()
    struck = int(contact.strike.argmax())
    near = slice(max(struck - BESIDE, 0), struck + BESIDE + 2)
    shown = {
        "straddle": {"time": time[near], "landing": height[near]},
        "energy": {"time": time, "energy": contact.energy.tolist()},
    }
    if contact.placed:
        speed = -contact.sinking[:, 0] / contact.sinking[contact.first, 0]
        shown["penetration"] = {"time": time, "landing": height}
        shown["rebound"] = {"time": time, "speed": speed.tolist()}
    return shown


def _moved(scene: Scene, impulse: float, rate: float) -> float:
    """The change of e by an impulse at the old corner [N s]; per second for a force [N]."""
    return float(2 * scene.block.half_width * impulse / (_inertia(scene) * abs(rate)))


def _inertia(scene: Scene) -> float:
    """J' [kg m2], see the module."""
    block = scene.block
    return block.inertia - block.mass * scene.mass_share * block.half_height**2


def _parts(scene: Scene, corners: dict[str, np.ndarray], rate: float, borne: float, window: slice) -> dict[str, float]:
    """The parts of the error of e. borne: impulse [N s] that supports the block up to the landing."""
    block, way = scene.block, math.copysign(1.0, rate)
    old, scale = corners["impulse"][window, 1], _inertia(scene) * abs(rate)
    pulled = float(np.minimum(old, 0.0).sum())
    ends = [(-1.0, window.start, 1), (1.0, window.stop, 0)]  # the pivot before, the pivot after
    slipped = way * sum(sign * corners["slip"][k, corner] for sign, k, corner in ends)
    risen = -sum(sign * corners["sinking"][k, corner] for sign, k, corner in ends)
    return {
        "support": _moved(scene, float(old.sum()) - pulled - borne, rate),
        "pull": _moved(scene, pulled, rate),
        "slip": float(-block.mass * block.half_height * (1 - scene.mass_share) * slipped / scale),
        "rebound": float(-block.mass * block.half_width * risen / scale),
    }


LEAST = 1e-3  # least error of e, or share of the rate before, for which a cause is named
CAUSES = {
    "damping": "the block loses speed in flight: something is damped that was not asked for",
    "shape": "a corner in the air bears weight: the contact is not where the block's corner is",
    "gap": "the corner is struck more than a step before or after it is level with the pivot: a slop, margin or radius",
    "iterations": "the impulse is spread over steps, pulls or slips: the solver stops before it converges",
    "adhesion": "the corner that should lift is pulled at, over many steps: the contact's damper acts outward, too",
    "compliance": "the impulse takes many steps to grow and to fade, while the block turns on: the contact is soft",
    "rebound": "the struck corner leaves the ground at once: a restitution, or a penetration corrected by a velocity",
    "friction": "a corner slides, friction and normal impulse being in one ratio: the friction is too small",
    "unseen": "the contact itself, and more than a step explains; the engine does not report where the block was",
    "step": "no part is larger than what the block gains in one step: the step straddles the impact",
}
# Steps over which a sudden strike extends. Velocity-level solvers strike within one step, which appears in two, as
# velocities are those of the steps' ends; without convergence they take up to eight (one iteration, started from the
# step before). A resolved compliant contact takes a dozen or more.
AT_ONCE, MANY = 2, 10
SATURATED = 5.0  # largest friction over normal impulse of a sliding contact, over that of the strike
STRADDLING = 2.0  # parts up to this multiple of the phase are explained by the step: a strike appears in two steps
HALF = 0.5  # share of the largest part from which a part counts as a cause


def cause_of(contact: Contact) -> str | None:
    """Return one of `CAUSES`, or None if the error is below `LEAST`."""
    parts = {name: abs(value) for name, value in contact.parts.items()}
    flight, shape = parts.pop("flight"), parts.pop("shape", 0.0)
    if max(flight, abs(contact.error)) < LEAST:
        return None
    largest = max(parts.values())
    if flight >= max(LEAST, largest, STRADDLING * contact.phase):
        return "damping"
    if contact.placed and shape >= HALF * max(largest, LEAST):
        return "shape"
    part = max(parts, key=parts.__getitem__)
    pulled = contact.placed and parts["pull"] >= HALF * largest
    if contact.steps >= MANY:
        slides = part == "slip" and _saturated(contact)
        return "friction" if slides else "adhesion" if pulled else "compliance"
    if largest <= STRADDLING * contact.phase:
        return "step"
    return _sudden(contact, part, pulled)


def _sudden(contact, part, pulled):
    """The cause of the error of a sudden strike that one step does not explain, by its largest part."""
    if not contact.placed:
        return "unseen"
    if part == "slip":
        return "friction" if _saturated(contact) else "iterations"
    if pulled or contact.steps > AT_ONCE:
        return "iterations"
    return "gap" if part == "support" else "rebound"


def _saturated(contact):
    """Whether friction over normal impulse is nowhere much larger than at the strike, as in a contact that slides."""
    window = slice(contact.first, contact.last)
    upward, strike = contact.impulse[window].sum(axis=1), contact.strike[window]
    loaded = upward > 1e-3 * upward.max()
    demand = np.abs(contact.friction[window][loaded]) / upward[loaded]
    return bool(demand.max() <= SATURATED * np.average(demand, weights=np.maximum(strike[loaded], 0.0)))


def diagnosis(engine: str, variant: str, scene: Scene, which: int = 0, **settings: Any) -> dict[str, object]:
    """Run a scene and return the analysis of impact number `which`, ready for JSON.

    Returns
    -------
    dict
        engine, variant, "tier" (its kind) and best (it is the engine's main variant). If the impact can be analysed:
        placed, error, cause and words (None below `LEAST`), parts, steps, energy_lost (over the kinetic energy before),
        frames, and deepest [m] if the block is placed; otherwise why_not.
    """
    record = get_engine(engine)
    row: dict[str, object] = {"engine": engine, "variant": variant, "tier": record.variants[variant].kind}
    row["best"] = variant == record.default_variant
    _, trace = record.traced(scene, variant=variant, history=False, **settings)
    try:
        if trace is None:
            raise Unmeasurable("the run has no steps")
        contact = contact_of(scene, trace, which)
    except Unmeasurable as error:
        return row | {"why_not": str(error)}
    cause = cause_of(contact)
    row |= {
        "placed": contact.placed,
        "error": contact.error,
        "cause": cause,
        "words": cause and CAUSES[cause],
        "parts": contact.parts,
        "steps": contact.steps,
        "energy_lost": float(contact.energy[contact.first] - contact.energy[contact.last]),
        "frames": frames(contact),
    }
    return row | ({"deepest": contact.deepest} if contact.placed else {})


def corner_motion(scene: Scene, trace: Trace, side: float) -> dict[str, np.ndarray]:
    """Return the motion of the corners in a trace with a centre. side: that of the old corner, +1 or -1.

    Returns
    -------
    dict
        Arrays of shape (n, 2): height above the ground [m], sinking (speed downward) and slip (speed along the base)
        [m/s].
    """
    lever, drop = _levers(scene, trace.tilt, side)
    _, z, vx, vz = np.asarray(trace.centre).T
    height = z + scene.block.half_height + drop.T
    slip = vx - trace.base_velocity + drop.T * trace.tilt_rate
    return {"height": height.T, "sinking": (lever.T * trace.tilt_rate - vz).T, "slip": slip.T}


def _levers(scene: Scene, tilt: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
    """(x, z) [m] of the landing and the old corner from the block's centre, shapes (n, 2)."""
    b, h = scene.block.half_width, scene.block.half_height
    across, cos, sin = np.array([-side * b, side * b]), np.cos(tilt)[:, None], np.sin(tilt)[:, None]
    return across * cos - h * sin, -across * sin - h * cos


def corner_impulses(scene: Scene, trace: Trace, side: float) -> dict[str, np.ndarray]:
    """Return the impulses on the corners between the n steps of a trace with a centre, from its change of momentum.

    Returns
    -------
    dict
        impulse [N s]: upward at each corner, shape (n - 1, 2). friction [N s]: along the ground at both corners
        together, shape (n - 1,).
    """
    block, time, (_, _, across, up) = scene.block, trace.time, np.asarray(trace.centre).T
    lever, drop = (0.5 * (each[1:] + each[:-1]) for each in _levers(scene, trace.tilt, side))
    ground, upright = (_gained(part, time) for part in (scene.motion, scene.motion and scene.motion.vertical))
    friction = block.mass * (np.diff(across) + ground)
    upward = block.mass * (np.diff(up) + scene.gravity * np.diff(time) + upright)
    spin = block.centre_inertia * np.diff(trace.tilt_rate)
    # Friction acts at the lower corner (at both if level): z H - x_a N_a - x_o N_o = spin, N_a + N_o = N
    landing = (drop.min(axis=1) * friction - lever[:, 1] * upward - spin) / (lever[:, 0] - lever[:, 1])
    return {"impulse": np.column_stack([landing, upward - landing]), "friction": friction}


def _gained(motion: Motion | None, time: np.ndarray) -> np.ndarray | float:
    """The velocity [m/s] that the ground gains in each step."""
    velocity = ground_velocity(motion)
    return np.diff([velocity(t) for t in time.tolist()]) if velocity else 0.0


def pivot_forces(
    scene: Scene, trace: Trace, side: float, landing: float, rates: tuple[float, float]
) -> tuple[float, float]:
    """Return the normal force [N] on a block that pivots at tilt 0, before and after the landing, by eqs (3) to (6).

    landing: its time [s]. rates: tilt rates before and after it [rad/s].
    """
    model, motion = ArrayModel.of(scene), scene.motion
    ground, up = (motion.acceleration(landing), vertical_acceleration(motion, landing)) if motion else (0.0, 0.0)
    force = float(np.interp(landing, trace.time, trace.bearing_force))

    def normal(s, rate):
        tilting, sliding = model.accelerations(s, 0.0, rate, ground, force, up)
        return float(model.contact_forces(s, 0.0, rate, tilting, ground + sliding, up)[1])

    return normal(side, rates[0]), normal(-side, rates[1])
