"""Rules by which the outcome of a run is decided, and by which its peaks are final.

After the ground motion no energy is added. The energy that can still reach the block is

    E = kinetic + m g R (cos(s gamma - phi) - cos(gamma)) + n_d (kb x^2/2 + S(z)),

less P^2/(2 M) on a base without bearings, whose momentum P is conserved. S(z) is the recoverable energy of the
hysteresis of a bearing (`recoverable_energy`). E never rises: impacts and viscous forces dissipate energy, and S is a
storage function of the bearing, z dx >= dS, as unloading is never softer than loading. To overturn, the block must pass
|phi| = gamma, where its potential energy is B = m g R (1 - cos gamma). The outcome is therefore decided if

(a) the block has lifted before and E < B: it rocks and will not overturn; or
(b) the block is in full contact and the largest force that E allows gives less than the uplift acceleration
    g tan(gamma): it will not lift again. This rule decides for an undamped base, on which E > B for ever; or
(c) on rigid ground, by the energy integral of free rocking (`events.settle`): a block beyond the barrier that moves
    outward overturns.

A decided run is not yet finished: a run without a duration continues until neither peak can grow by more than
`PEAK_TOLERANCE`, and for some periods of the block and of the base, so that the history shows the swings.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..laws import Constants, law_function
from ..response import Caution, about_record, limit_warnings
from ..rocking import BearingLaw
from .compiled import entry, inner

if TYPE_CHECKING:
    from ..scene import Scene
    from .layout import Base, Body, Parameters

# Relative growth of a reported peak that is still possible when a run without a duration ends.
PEAK_TOLERANCE = 1e-4
# Periods after the motion (the longer of block and base): shown at least, and waited for a decision at most.
TAIL_PERIODS, CAP_PERIODS = 3.0, 100.0
# Largest isolation period, in rocking periods, that lengthens the time after the motion.
SLOWEST_BASE = 10.0

RIGID_BEARINGS = (
    "the vertical motion passes through the bearings as if they were rigid: real ones sway vertically at some 10 to 20 "
    "Hz, within the band of vertical shaking"
)


_recoverable = law_function("recoverable")


@inner
def recoverable_energy(law: float, c: Constants, z: float) -> float:
    """Return S(z) [J] of one bearing: the integral of |z| dx while unloading to z = 0; at least z^2/(2 (ka - kb))."""
    z = abs(z)
    if z == 0:
        return 0.0
    return max(0.5 * z * z / c.dk, _recoverable(law, z, c))


@inner
def remaining_energy(par: Parameters, body: Body, base: Base) -> float:
    """Return E [J] that can still reach the block, see the module's docstring."""
    (s, tilt, rate), (x, v, z) = body, base
    kinetic, gravity, momentum = 0.5 * par.M * v * v, 0.0, par.M * v
    if not par.on_base:
        kinetic = 0.0
    if s != 0:
        c = par.R * math.cos(s * par.gamma - tilt)
        kinetic += 0.5 * par.J * rate * rate
        if par.on_base:
            kinetic += par.m * c * v * rate
            momentum += par.m * c * rate
        gravity = 2 * par.m * par.g * par.R * math.sin(par.gamma - 0.5 * abs(tilt)) * math.sin(0.5 * abs(tilt))
    if not par.on_base:
        return kinetic + gravity
    if par.count == 0:
        return max(kinetic - 0.5 * momentum * momentum / par.M, 0.0) + gravity
    back = recoverable_energy(par.law, par.constants, z)
    return kinetic + gravity + par.count * (0.5 * par.kb * x * x + back)


@inner
def largest_force(par: Parameters, energy: float) -> float:
    """Return the largest force of all bearings [N] that `energy` allows in full contact.

    By the Cauchy-Schwarz inequality for kinetic, elastic and recoverable energy, the last at least z^2/(2 (ka - kb));
    or with the hysteretic part at its limit f0.
    """
    n, c = par.count, par.constants
    viscous = n * n * par.damping * par.damping / par.M
    return min(
        math.sqrt(2 * energy * (n * (par.kb + c.dk) + viscous)),
        n * c.f0 + math.sqrt(2 * energy * (n * par.kb + viscous)),
    )


@entry
def will_not_overturn(par: Parameters, body: Body, base: Base, lifted: bool) -> bool:
    """Return whether, after the motion, "stands" or "rocks" is certain, by rules (a) and (b).

    lifted : whether the block has lifted, before or now.
    """
    rocking = body.s != 0
    if not (rocking or par.on_base):
        return True
    energy = remaining_energy(par, body, base)
    if lifted and energy < par.m * par.g * par.R * (1 - math.cos(par.gamma)) and abs(body.tilt) < par.gamma:
        return True  # (a)
    return not rocking and largest_force(par, energy) < par.M * par.g * par.slope  # (b)


@entry
def peaks_are_final(par: Parameters, body: Body, base: Base, peaks: tuple[float, float, float]) -> bool:
    """Return whether, after a decision, no reported peak can grow by more than `PEAK_TOLERANCE`.

    peaks : of tilt, base displacement and absolute base acceleration; a negative one is ignored. A base without
    bearings slides for ever, so that its displacement has no peak.
    """
    (peak_tilt, peak_x, peak_acceleration), (x, v, z), rocking = peaks, base, body.s != 0
    energy, slack = remaining_energy(par, body, base), 1 + PEAK_TOLERANCE
    if not par.on_base:
        highest = math.cos(par.gamma) + energy / (par.m * par.g * par.R)
        return not rocking or highest <= 1 and par.gamma - math.acos(highest) <= peak_tilt * slack
    if rocking or largest_force(par, energy) >= par.M * par.g * par.slope:
        return False
    if par.count == 0:
        return True
    stiffness, force = par.count * par.kb, par.count * (par.kb * x + z)
    if peak_acceleration >= 0 and largest_force(par, energy) > peak_acceleration * par.M * slack:
        return False
    if stiffness == 0:  # the remaining energy is dissipated by the limit force
        return energy <= PEAK_TOLERANCE * par.count * par.constants.f0 * peak_x
    # from the origin; or about the position of rest, as no branch of a law is softer than kb
    near = abs(x) + abs(force) / stiffness + math.sqrt(par.M / stiffness * v * v + (force / stiffness) ** 2)
    return min(math.sqrt(2 * energy / stiffness), near) <= peak_x * slack


def period(scene: Scene) -> float:
    """Return the longer of rocking and isolation period [s]: 2 pi/omega_r and 2 pi sqrt((m + m_b)/(n_d k))."""
    rocking = 2 * math.pi / scene.rocking_frequency
    if scene.bearings is None:
        return rocking
    law = BearingLaw.of(scene.bearings)
    stiffness = law.count * (law.kb or law.dk)
    return max(rocking, min(2 * math.pi * math.sqrt(scene.total_mass / stiffness), SLOWEST_BASE * rocking))


def motion_end(scene: Scene) -> float:
    """Return the end of the ground motion [s], 0 without one."""
    return 0.0 if scene.motion is None else scene.motion.end


def shortest_duration(scene: Scene) -> float:
    """Return the shortest run without a duration [s]: the motion and `TAIL_PERIODS` after it."""
    return motion_end(scene) + TAIL_PERIODS * period(scene)


def longest_duration(scene: Scene) -> float:
    """Return the longest run without a duration, decided or not [s]: `CAP_PERIODS` after the motion."""
    return motion_end(scene) + CAP_PERIODS * period(scene)


def model_warnings(
    scene: Scene, friction_demand: float, min_normal_ratio: float, slides: bool = False
) -> tuple[Caution, ...]:
    """Return warnings where a run violates the model's assumptions.

    These are compressive contact, no sliding, and bearings that are rigid under a vertical motion. slides : whether the
    solver models a block that slides and flies with a friction, so that these are no violations.
    """
    warnings = []
    if scene.bearings is not None and scene.motion is not None and scene.motion.vertical is not None:
        warnings.append(Caution("model", RIGID_BEARINGS))
    if slides and scene.friction is not None:
        return tuple(warnings)
    if min_normal_ratio <= 0:
        words = (
            f"the least normal force at the contact is {min_normal_ratio:.3g} m g: the block would jump, and the "
            "outcome is outside the model" + ("" if scene.friction else "; with a friction in the scene it flies")
        )
        warnings.append(Caution("model", words, "min_normal_ratio", min_normal_ratio, 0.0))
    if scene.friction is not None and friction_demand > scene.friction:
        words = (
            f"the friction demand {friction_demand:.3g} is above the scene's friction {scene.friction:.3g}: the block "
            "would slide, and the outcome is outside the model"
        )
        warnings.append(Caution("model", words, "friction_demand", friction_demand, scene.friction))
    return tuple(warnings)


def run_warnings(
    scene: Scene,
    friction_demand: float,
    min_normal_ratio: float,
    peak_base_displacement: float,
    base_velocity: float,
    slides: bool = False,
    peak_slip: float = 0.0,
) -> tuple[Caution, ...]:
    """Return all warnings of a run of the analytic model.

    They are of the record, `model_warnings`, `limit_warnings`, and of a base that slides on. base_velocity : at the end
    [m/s]. slides : as in `model_warnings`. peak_slip : as in `limit_warnings` [m].
    """
    warnings = [*about_record(scene.motion), *model_warnings(scene, friction_demand, min_normal_ratio, slides)]
    warnings += limit_warnings(scene, peak_base_displacement, peak_slip)
    drift = abs(base_velocity) * CAP_PERIODS * period(scene)  # rounding errors are no motion
    if scene.base is not None and scene.bearings is None and drift > PEAK_TOLERANCE * peak_base_displacement:
        words = (
            f"the base slides on at {base_velocity:.3g} m/s with no bearing to stop it: its displacement has no peak, "
            "the one given is that at the end of the run"
        )
        warnings.append(Caution("model", words, "base_velocity", base_velocity, 0.0))
    return tuple(warnings)
