"""Loads that an engine is given, and its start: couple, ground velocity, placement, time scale, vibration.

A couple on the block before each landing gives a contact engine the restitution of a scene. The engine itself computes
that of eq. (7), and parameters of its contact do not change it: an impulse at the landing corner has no moment about
that corner. The couple takes a share of the tilt rate before the landing instead. It acts from the time at which the
block, at its rate w0 at tilt phi0, would need less than `acts` to reach the ground:

    M = -J' k phi',   J' = J_O - (m h)^2/M on a base, J_O on the ground,   k = (1 - f) |w0/phi0|

As d(phi')/d(phi) = -k is constant, it takes (1 - f) w0 exactly, whatever the amplitude; f is the given restitution over
that of (7). Meanwhile gravity and base accelerate the block by a. The couple must take the same share of this gain, so
that k is larger by a (T - f T0)/phi0, with T0 = |phi0/w0| the time to the ground without couple and
T = T0 ln(1/f)/(1 - f) with it. The base keeps the momentum of block and base, so the jump of its velocity is that of
(8) for the given restitution.

The ground velocity is exact for records and pulses; its differences are the impulses of an engine's steps. The start of
the block is the same for every engine. Times scale with the size of the block.

Stiff or viscous bearings limit the step of a leapfrog engine, and add mass to the base: the viscous force is implicit.
The known force c v acts on a base heavier by `added_mass`, which is exact if the other forces are constant in the step.
Applied explicitly, it would be unstable where step times c/mass exceeds 2; a tenth of that makes PyBullet's block fall
.25 s late.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Self

import numpy as np

from analytic.errors import SceneError
from analytic.motion import SampledMotion
from analytic.rocking import BearingLaw, RockingModel, momentum_restitution
from analytic.stack.equations import LOWER, Slab, StackModel

if TYPE_CHECKING:
    from analytic import PulseMotion, Scene
    from analytic.motion import Motion

# Of the restitution of (7). A block that is slowed further hardly reaches the ground; one that is sped up is lifted
# where (f - 1) b |phi'| exceeds g `acts`: at f = 1.02 e is off by up to .06, at 1.05 by up to .4.
LEAST, MOST = 0.1, 1.0
FRICTION = 5.0  # coefficient in every tuned variant where the scene gives none, at least: no sliding
ALONE = "or run the analytic model, which takes any up to 1: `rocking run SCENE` without --engine"


def reached(scene: Scene) -> bool:
    """Whether a couple can give the restitution of a scene; true where the scene gives none."""
    given, momentum = scene.block.restitution, momentum_restitution(scene)
    return given is None or momentum > 0 and LEAST * momentum <= given <= MOST * momentum


def share_of(scene: Scene) -> float | None:
    """The share f of a scene that gives the restitution, else None.

    Raises
    ------
    SceneError
        It is not within `LEAST` and `MOST`.
    """
    given, momentum = scene.block.restitution, momentum_restitution(scene)
    if given is None:
        return None
    if not reached(scene):
        raise SceneError(
            "block.restitution",
            given,
            f"{'above' if given > MOST * momentum else 'below'} what a couple before each landing reaches, "
            f"{LEAST:g} to {MOST:g} times the {momentum:.6g} of eq. (7)",
            f"give one between, leave it out, {ALONE}",
        )
    return given / momentum


def holding(scene: Scene) -> Scene:
    """The scene, with more friction where it gives the restitution and the pivot would slip under the couple.

    The strongest couple needs a friction of (1 - mt) h/b, mt the block's share of the moving mass, 0 on the ground.
    With less the pivot slips: on the ground with friction .6, e is up to .3 off.
    """
    if scene.block.restitution is None:
        return scene
    needed = (1 - scene.mass_share) / math.tan(scene.block.slenderness)
    return scene if needed <= (scene.friction or FRICTION) else scene.with_(friction=needed)


def unkept_friction(scene: Scene) -> str:
    """A sentence that says that a script does not keep the friction of a scene; "" where it does.

    It does not where the couple of a given restitution needs more.

    Raises
    ------
    SceneError
        As `share_of`.
    """
    held = holding(scene).friction
    if None in (scene.friction, share_of(scene)) or held == scene.friction or share_of(scene) == MOST:
        return ""
    return (
        f"The scene's friction, {scene.friction:g}, is not kept, and the block does not slide: below {held:.3g} it "
        "slips under the couple that gives the restitution."
    )


@dataclass
class Couple:
    """The couple of a scene.

    kept: f. inertia: J' [kg m2]. acts: time before a landing [s]. gain: k [1/s], 0 while no couple acts. steps: the
    last two. rate: the last one; rates are half a step early, as in `engines.loop`.
    """

    kept: float
    inertia: float
    acts: float
    gain: float = field(default=0.0, init=False)
    rate: float = field(default=0.0, init=False)
    steps: tuple[float, float] = field(default=(0.0, 0.0), init=False)

    @classmethod
    def of(cls, scene: Scene, acts: float) -> Self | None:
        """The couple of a scene that gives the restitution, else None. acts [s].

        Raises
        ------
        SceneError
            As `share_of`.
        """
        share = share_of(scene)
        if share is None:
            return None
        model = RockingModel.of(scene)
        coupled = (model.m * model.R * math.cos(model.gamma)) ** 2 / model.M if model.on_base else 0.0
        return cls(share, model.J - coupled, acts)

    @property
    def longer(self) -> float:
        """T/T0: how much longer the block needs to the ground."""
        return -math.log(self.kept) / (1 - self.kept) if abs(1 - self.kept) > 1e-9 else 1.0

    @property
    def lasts(self) -> float:
        """Time from its begin to the landing [s]."""
        return self.acts * self.longer

    def moment(self, step: float, tilt: float, rate: float) -> float:
        """The couple [N m] in a step [s] from this state, implicit in the rate at its end; asked for at every step."""
        (last, before), change = self.steps, rate - self.rate
        self.steps, self.rate = (step, last), rate
        if tilt * rate >= 0:
            self.gain = 0.0
        elif self.gain == 0 and abs(tilt) < self.acts * abs(rate):
            alone = abs(tilt / rate)
            gathered = math.copysign(change, change * rate) / (0.5 * (last + before)) if before else 0.0
            self.gain = ((1 - self.kept) * abs(rate) + gathered * (self.longer - self.kept) * alone) / abs(tilt)
        if self.gain == 0:
            return 0.0
        travel = min(abs(rate) * step / (1 + self.gain * step), abs(tilt))  # no farther than to the ground
        return -self.inertia * self.gain * math.copysign(travel, rate) / step


def ground_velocity(motion: Motion | None) -> Callable[[float], float] | None:
    """A function of time [s], not negative, giving the integral of the ground acceleration from 0 [m/s].

    The mean acceleration of a step is the difference of two values over the time between them. An engine that samples
    the acceleration instead loses part of a pulse that starts or ends within a step.
    """
    return _integrals(motion)[0] if motion else None


def ground_gain(motion: Motion | None) -> Callable[[float, float], float] | None:
    """A function of two times [s], in order, giving the velocity that the ground gains between them [m/s].

    It is the difference of two values of `ground_velocity`, in one call.
    """
    return _integrals(motion)[1] if motion else None


def ground_velocities(motion: Motion, time: np.ndarray) -> np.ndarray:
    """`ground_velocity` at many times."""
    if isinstance(motion, SampledMotion):
        sums, level, slope = _tables(motion)
        i = np.minimum((time / motion.dt).astype(int), len(sums) - 1)
        u = time - i * motion.dt
        return sums[i] + u * (level[i] + 0.5 * slope[i] * u)
    angle = motion.frequency * np.clip(time - motion.start, 0.0, motion.length)
    return motion.amplitude / motion.frequency * motion.form.integral(np, angle, motion.phase)


def _tables(motion: SampledMotion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity [m/s], acceleration [m/s2] and its slope [m/s3] from each sample on; both are 0 after the last one."""
    dt, a = motion.dt, motion.samples
    sums = np.concatenate(([0.0], np.cumsum(0.5 * dt * (a[1:] + a[:-1]))))
    return sums, np.append(a[:-1], 0.0), np.append(np.diff(a) / dt, 0.0)


def _integrals(motion: Motion) -> tuple[Callable[[float], float], Callable[[float, float], float]]:
    """(`ground_velocity`, `ground_gain`) of a motion."""
    return _sampled(motion) if isinstance(motion, SampledMotion) else _pulse(motion)


def _sampled(motion: SampledMotion) -> tuple[Callable[[float], float], Callable[[float, float], float]]:
    # compact, and read as quickly as a list
    dt, (sums, level, slope) = motion.dt, (array("d", table.tobytes()) for table in _tables(motion))
    last = len(sums) - 1

    def velocity(t):
        i = int(t / dt)
        if i >= last:
            return sums[last]
        u = t - i * dt
        return sums[i] + u * (level[i] + 0.5 * slope[i] * u)

    def gain(begin, end):
        i, j = int(begin / dt), int(end / dt)
        if j >= last:
            return sums[last] - velocity(begin)
        u, w = begin - i * dt, end - j * dt
        before = sums[i] + u * (level[i] + 0.5 * slope[i] * u)
        return sums[j] + w * (level[j] + 0.5 * slope[j] * w) - before

    return velocity, gain


def _pulse(motion: PulseMotion) -> tuple[Callable[[float], float], Callable[[float, float], float]]:
    frequency, start, length = motion.frequency, motion.start, motion.length
    size, phase = motion.amplitude / frequency, motion.phase
    integral = motion.form.integral

    def velocity(t):
        return size * integral(math, frequency * min(max(t - start, 0.0), length), phase)

    return velocity, lambda begin, end: velocity(end) - velocity(begin)


def placement(scene: Scene) -> tuple[float, float, float, float]:
    """Centre of the block and its velocity at the start: (x, z [m], x', z' [m/s]), z from its standing height.

    The block pivots about its lower corner on a base with the start's displacement and velocity.
    """
    start, block = scene.start, scene.block
    s = math.copysign(1.0, start.tilt or start.tilt_rate)
    angle = s * block.slenderness - start.tilt
    c, n = block.radius * math.cos(angle), block.radius * math.sin(angle)
    return (
        start.base_displacement + s * block.half_width - n,
        c - block.half_height,
        start.base_velocity + c * start.tilt_rate,
        n * start.tilt_rate,
    )


def slabs_of(scene: Scene) -> tuple[Slab, ...]:
    """The blocks of a scene from below: the block itself, or a free pedestal and the block on it."""
    block = scene.block
    if scene.is_stack:
        return StackModel.of(scene).slabs
    return (Slab(block.mass, block.centre_inertia, block.half_width, block.half_height),)


def moving_mass(scene: Scene) -> float:
    """Mass of the base, with a pedestal that is fixed to it [kg]; 0 on rigid ground."""
    return scene.base.mass if scene.base and scene.is_stack else scene.base_mass


Places = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]


def placements(scene: Scene, pedestal_tilt: float = 0.0) -> list[Places]:
    """Start of each of `slabs_of`: (x, x'), (z, z') as in `placement`, (tilt, its rate), all absolute.

    A stack starts without a velocity, the pedestal on its lower corner, and the block on its own, tilted by the scene's
    start from the pedestal.
    """
    start = scene.start
    if not scene.is_stack:
        x, z, vx, vz = placement(scene)
        return [((x, vx), (z, vz), (start.tilt, start.tilt_rate))]
    tilts = pedestal_tilt, pedestal_tilt + start.tilt
    return [
        ((start.base_displacement + centre.real, 0.0), (centre.imag, 0.0), (tilt, 0.0))
        for centre, tilt in zip(centres(StackModel.of(scene), tilts), tilts, strict=True)
    ]


def centres(model: StackModel, tilts: Sequence[float]) -> tuple[complex, complex]:
    """Centres x + 1j z [m] of pedestal and block at these absolute tilts [rad], from where they stand on the base."""
    (one, two), (first, second) = model.slabs, tilts
    sides = [int(np.sign(first)), int(np.sign(second - first))]
    R1, Rd, R2, *_ = model.geometry(sides, tilts)
    pivot = sides[LOWER] * one.b
    return pivot + R1 - 1j * one.h, pivot + Rd + R2 - 1j * (2 * one.h + two.h)


UNIT_RADIUS = 1.0884  # m, of the Caryatid, for which the variants' times are given


def size_scale(scene: Scene) -> float:
    """Factor on times that are set for a block of `UNIT_RADIUS`: rocking scales with sqrt(R/g)."""
    return math.sqrt(scene.block.radius / UNIT_RADIUS)


# Largest step over the time in which the bearings' vibration advances by 1 rad; stable below 2.
VIBRATION = 0.2
# The frequency of a leapfrog is too high by (h omega)^2/24. An added mass of this share of the stiffness times h^2
# corrects it: without damping, the phase at the next impact determines the base displacement. On bearings 100 times as
# stiff as the Caryatid's its peak is off by 2e-3, without the mass by 5e-2. Not needed below STIFF = h omega.
LEAPFROG, STIFF = 1 / 12, 0.02


def longest_step(scene: Scene, largest: float) -> float:
    """The longest step [s], at most `largest`, that resolves the base's vibration on its bearings."""
    if scene.bearings is None:
        return largest
    model = RockingModel.of(scene)
    law = model.bearing
    k, c = law.count * (law.kb + law.dk) * VIBRATION**-2, law.count * law.damping
    # h^2 k = mass + h c: an overdamped base creeps with the time constant c/k
    return min(largest, (c + math.sqrt(c * c + 4 * k * driven_mass(model))) / (2 * k))


def driven_mass(model: RockingModel) -> float:
    """Effective mass of the base while the block pivots through tilt 0 [kg], least for J_O = m R^2.

    A free pedestal counts as fixed: steps are a tenth of the longest stable one, and what is added for the viscous
    force depends on this mass in the second order only.
    """
    return model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J


def leapfrog_stiffness(law: BearingLaw, largest: float, mass: float) -> float:
    """Stiffness [N/m] whose product with the step squared is added to the base's `mass` [kg]; 0 for short steps.

    Small vibrations of a hysteretic bearing have about half its initial excess stiffness ka - kb.
    """
    elastic = law.count * (law.kb + 0.5 * law.dk)
    return LEAPFROG * elastic if largest * math.sqrt(elastic / mass) > STIFF else 0.0


def added_mass(damping: float, interval: float, mass: float) -> float:
    """Mass to add to `mass`, so that a force c v at the velocity before `interval` gives the velocity after it."""
    x = damping * interval / mass
    return mass * (x / -math.expm1(-x) - 1) if x > 1e-8 else 0.5 * damping * interval
