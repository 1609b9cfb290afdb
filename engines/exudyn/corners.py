"""exudyn, variant compliant-corners: a stiff contact at each bottom corner.

The contact's law is this adapter's own, in the tradition of Hunt and Crossley, and exudyn integrates it, by the two
methods of `phases`: plastic (`rebound`), non-slipping (`friction`) and planar, which is what Housner assumes. That an
impact then turns out as his formula says verifies law and integration, it is no independent physics.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import exudyn as exu
import numpy as np
from numba import njit

from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel

from .phases import JUST, Phases, Rule
from .scene import build
from .sizing import LATE, MEASURED_START, CompliantCorners, drift, scaled, start_share, unresolved
from .stepping import solver_settings, step_through

if TYPE_CHECKING:
    from analytic import Scene

    from ..contract import Run
    from .scene import Model

Real = exu.symbolic.Real

# Under a motion the swings are not known beforehand: a run whose own peak is below SMALL slendernesses is done again
# for swings of that size, as for the equivalent start (else peaks of .04 and .02 slendernesses are off by 2 %), but
# for none smaller than LEAST_SHARE of those measured. Where a jump of the ground, within JUMPS times what lifts the
# block, finds it standing, what the corners had taken up throws it, and the peak is off as 1/sqrt(stiffness): small
# ones by 8 to 65 %, others by up to 7 %. So two runs tell the error of the stiffer one: above UNSURE it is done again
# for swings a HARDER-th of the size, twice at most; what is left is said, as where that would take more than
# MOST_AGAIN steps.
SMALL, LEAST_SHARE, UNSURE, HARDER, MOST_AGAIN = 0.1, 4e-3, 0.01, 10.0, 200_000
JUMPS = 0.3, 3.0  # vibrating bases add to less; of higher ones no peak was off
TOLD = 0.7  # square root of the stiffnesses' ratio, above which two runs tell nothing
STANDS = 1e-4  # slendernesses, below which a peak is the corners' own

# Time for the corners to relax after an impact, over sqrt(m/k): the landing corner is pushed out at the rebound speed
# for a third of it, 3 ms for the Caryatid. At most this over sqrt(R/g), which is 20 ms for it.
# And it is thrown up at that speed, over g: until it is down again the block does not pivot. On the stiffest corners
# that takes longer (e off by .076 in the 91st impact of a block that keeps its speed).
RELAX, MOST_RELAX, HOP = 75.0, 0.06, 4.0

# Least sticking stiffness over what the bearings ask of it, so that a light base moves with the block: at 200 the first
# impact of a block on a base of 9e-4 of its mass came 5e-4 of its time early, and three were lost of the last ones; at
# 1000 one; at 5000 a sixth of the light bases of the wide box ended as too many steps, at 200 a ninth.
STICKS = 2000.0

# Change of the anchor that is not worth telling exudyn, over the sticking spring's stretch under the block's weight.
SLOP = 1e-3


@njit("f8(f8, f8[::1], f8[::1], f8, f8, f8, f8, f8)", cache=True)  # compiled when it is imported
def _anchor(
    anchor: float, q: np.ndarray, v: np.ndarray, b: float, h: float, stiffness: float, hardening: float, stretch: float
) -> float:
    """Where the block sticks to its base [m], after a step: moved along as far as every corner that bears has slid.

    stretch: of the sticking spring over the normal force when it slides [m/N]. A block in the air has no anchor: the
    place of its lower corner.
    """
    low, high, lowest, place = math.inf, -math.inf, -math.inf, anchor
    sin, cos = math.sin(q[2]), math.cos(q[2])
    x, rate = (q[3], v[3]) if len(q) > 3 else (0.0, 0.0)
    for side in (-1.0, 1.0):
        across = q[0] - x + side * b * (cos - 1) + h * sin
        depth = h * (cos - 1) - q[1] - side * b * sin
        normal = 0.0
        if depth > 0:
            normal = stiffness * depth * (1 - hardening * (v[1] + v[2] * (side * b * cos + h * sin)))
        if normal > 0:
            low, high = min(low, across - stretch * normal), max(high, across + stretch * normal)
        if depth > lowest:
            lowest, place = depth, across
    if low > high:
        return place
    return min(max(anchor, low), high)


@dataclass(frozen=True)
class Corner:
    """Constants of one corner's contact force. Units: N/m, s/m, N/m, N s/m, s/m, -."""

    stiffness: float
    hardening: float
    sticking: float
    damping: float
    grip: float
    friction: float

    @classmethod
    def of(cls, scene: Scene, settings: CompliantCorners) -> Self:
        """Of settings that are scaled to the scene."""
        block, stiffness = scene.block, settings.stiffness
        # on a light base the reduced mass is small: a sticking spring in proportion keeps the step
        reduced = block.mass * (1 - scene.mass_share if scene.base else 1.0)
        law = BearingLaw.of(scene.bearings)
        sticking = max(
            settings.sticking * stiffness * reduced / block.mass,
            STICKS * scene.mass_share * law.count * (law.kb + law.dk) if scene.bearings else 0.0,
        )
        # the corner of a block of small inertia about its centre gives way easily
        turning = 4 / (1 / reduced + block.half_height**2 / block.centre_inertia)
        return cls(
            stiffness,
            1 / settings.rebound,
            sticking,
            2 * settings.damping * math.sqrt(sticking * min(reduced, turning)),
            reduced / block.mass / settings.slip,
            settings.friction,
        )

    def force(self, displacement: Any, velocity: Any, offset: Any) -> list[Any]:
        """Symbolic force of a Cartesian connector [N]: Hunt-Crossley, clipped at zero, and friction.

        Friction sticks to an anchor by spring and damper up to Coulomb's limit; exudyn has subtracted the anchor (the
        offset) from the displacement. It is gated by the normal force: a gate by the gap would let micro-bounces
        inject energy. exudyn evaluates a term at every place where it stands: in this form a step costs 25 % less.
        """
        across, up = displacement[0], displacement[1]
        loading = (self.hardening * self.stiffness) * velocity[1] - self.stiffness
        touches, normal = up < 0.0, exu.symbolic.max(Real(0.0), up * loading)
        stick = self.sticking * across + (self.damping + self.grip * normal) * velocity[0]
        limited = exu.symbolic.IfThenElse(
            stick > 0.0,
            exu.symbolic.min(self.friction * normal, stick),
            exu.symbolic.max(-self.friction * normal, stick),
        )
        return [
            exu.symbolic.IfThenElse(touches, limited, Real(0.0)),
            exu.symbolic.IfThenElse(touches, exu.symbolic.min(Real(0.0), -up * loading), Real(0.0)),
            Real(0.0),
        ]


class Anchor:
    """Coulomb's memory: where the block sticks to its base, committed once per accepted step."""

    def __init__(self, model: Model, corner: Corner) -> None:
        block = model.scene.block
        self.at = 0.0
        self.connectors = model.connectors["left"], model.connectors["right"]
        self.shape = (
            block.half_width,
            block.half_height,
            corner.stiffness,
            corner.hardening,
            corner.friction / corner.sticking,
        )
        self.slop = SLOP * block.mass * model.scene.gravity / corner.sticking

    def commit(self, mbs: exu.MainSystem, q: np.ndarray, v: np.ndarray) -> None:
        """Move the anchor after a step to coordinates q and velocities v."""
        at = _anchor(self.at, q, v, *self.shape)
        if abs(at - self.at) > self.slop:
            self.at = at
            for connector in self.connectors:
                mbs.SetObjectParameter(connector, "offset", [at, 0.0, 0.0])


def assemble(scene: Scene, settings: CompliantCorners) -> tuple[Model, float]:
    """(model, contact tilt [rad]) of a scene with compliant corners."""
    corner = Corner.of(scene, settings)
    sink = scene.block.mass * scene.gravity / (2 * corner.stiffness)
    model = build(scene, sink)
    for side, name in ((-1, "left"), (1, "right")):
        model.connect(name, model.corner_markers(side), corner.force)
    model.anchor = Anchor(model, corner)
    return model, sink / scene.block.half_width


def run(scene: Scene, settings: CompliantCorners) -> Run:
    """Step a scene with compliant corners; small swings under a motion are stepped again, see `SMALL`."""
    share = start_share(scene)
    used = [scaled(scene, settings, share)]
    runs = [_run(scene, used[0], math.sqrt(1 / share))]
    size = _size(scene, runs[0])
    if share < 1 or math.isnan(size) or not (size < SMALL or _thrown(scene, runs[0])):
        return _ended(runs, runs[0])
    tries = [(share, HARDER), (share, HARDER**2)]
    if size < SMALL:
        least = max(LEAST_SHARE, size / MEASURED_START)
        tries = [(least, 1.0), (least, HARDER), (least, HARDER**2)]
    for share, harder in tries:
        taken = runs[-1]
        if len(runs) > 1 and taken.steps * math.sqrt(HARDER) > MOST_AGAIN:
            break
        used.append(scaled(scene, settings, share, harder))
        runs.append(_run(scene, used[-1], math.sqrt(harder / share)))
        error, ratio = math.inf, math.sqrt(used[-2].stiffness / used[-1].stiffness)
        if runs[-1].failure is not None:
            break
        if ratio < TOLD:  # a base may have asked for the same stiffness in both
            error = _difference(scene, taken, runs[-1]) * ratio / (1 - ratio)
        taken = runs[-1]
        if not (error > UNSURE and _size(scene, taken) > STANDS):  # nor where one did not lift
            return _ended(runs, taken)
    by = f"{error:.2g} of itself" if math.isfinite(error) else "what no second run tells"
    hangs = (
        f"the peak tilt, {_size(scene, taken):.2g} slendernesses, hangs on the corners' stiffness, by {by}: the ground "
        "hardly lifts the block; give a larger stiffness"
    )
    return _ended(runs, taken, hangs)


def _ended(runs: list[Run], taken: Run, *said: str) -> Run:
    """The run taken, which costs as much as all of them."""
    cost, steps = sum(ran.cpu_seconds for ran in runs), sum(ran.steps for ran in runs)
    return replace(taken, cpu_seconds=cost, steps=steps, warnings=(*taken.warnings, *said))


def _size(scene: Scene, ran: Run) -> float:
    """Peak tilt over slenderness; NaN of a block that never lifts, or of a failed run."""
    if ran.trace is None or ran.failure is not None:
        return math.nan
    peak = float(np.nanmax(np.abs(ran.trace.tilt)))
    return peak / scene.block.slenderness if peak > ran.trace.contact_tilt else math.nan


def _thrown(scene: Scene, ran: Run) -> bool:
    """Whether a jump of the ground finds the block of a sound run standing."""
    if scene.motion is None:
        return False
    lifts = RockingModel.of(scene).uplift_acceleration
    for t in {scene.motion.start, *scene.motion.jumps}:
        before, after = scene.motion.acceleration(np.array([t - JUST, t + JUST]))
        stands = abs(np.interp(t, ran.trace.time, ran.trace.tilt)) < ran.trace.contact_tilt
        if stands and JUMPS[0] < abs(after - before) / lifts < JUMPS[1]:
            return True
    return False


def _difference(scene: Scene, before: Run, after: Run) -> float:
    """Relative change of the peak tilt from one run to the next, of a block that falls up to where the next one does.

    NaN where one of them failed or did not lift.
    """
    if math.isnan(_size(scene, before)) or math.isnan(_size(scene, after)):
        return math.nan
    tilt = np.abs(after.trace.tilt)
    fallen = np.flatnonzero(tilt > scene.block.slenderness)
    until = after.trace.time[fallen[0]] if len(fallen) else math.inf
    peaks = [np.abs(ran.trace.tilt[ran.trace.time <= until]).max() for ran in (before, after)]
    return abs(peaks[0] / peaks[1] - 1)


def _run(scene: Scene, settings: CompliantCorners, standing: float) -> Run:
    """Step a scene once, with settings that are `scaled` to it; standing: steps of a block that stands, over others."""
    model, contact_tilt = assemble(scene, settings)
    explicit = solver_settings(
        scene,
        solverType=exu.DynamicSolverType.DOPRI5,
        automaticStepSize=True,
        minimumStepSize=1e-13,
        relativeTolerance=1e-14,
        absoluteTolerance=settings.tolerance,
    )
    settle = min(
        max(RELAX * math.sqrt(scene.block.mass / settings.stiffness), HOP * settings.rebound / scene.gravity),
        MOST_RELAX * math.sqrt(scene.block.radius / scene.gravity),
    )
    sink = contact_tilt * scene.block.half_width
    rule = Rule(
        explicit, settings.longest_step, settings.pivoting_step, settings.pivoting_step * standing, sink, settle
    )
    ran = step_through(
        model, lambda model, steps, record: Phases(model, rule, steps, record).run(), 2 * contact_tilt, settle
    )
    return replace(
        ran,
        drift=drift(scene, settings),
        late=LATE * math.sqrt(scene.block.mass / settings.stiffness),
        warnings=(*ran.warnings, *unresolved(scene, settings)),
    )
