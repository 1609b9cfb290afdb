"""Whether a run of Bullet was physical: no energy from nowhere, block neither slid, sunk nor thrown."""

import numpy as np

from analytic.response import Failure
from analytic.rocking import RockingModel

# Energy [share of m g R (1 - cos gamma) plus what was ever there] that may appear from nowhere.
ENERGY_TOLERANCE = 0.02
# Sliding and height of the lower corner [share of R] that end a run as failed.
SLIDING_TOLERANCE, HEIGHT_TOLERANCE = 0.03, 2e-3


def check_energy(scene, trace):
    """A `Failure` where the energy exceeds what the start and the ground's work can explain, else None."""
    if len(trace.time) < 3:
        return None
    model = RockingModel.of(scene)
    m, J, R, gamma, g, law = model.m, model.J, model.R, model.gamma, model.g, model.bearing
    tilt, rate, v = trace.tilt, trace.tilt_rate, trace.base_velocity
    angle = np.where(tilt < 0, -gamma, gamma) - tilt
    c = R * np.cos(angle)
    kinetic = 0.5 * model.M * v**2 + m * c * v * rate + 0.5 * J * rate**2 if model.on_base else 0.5 * J * rate**2
    energy = kinetic + m * g * (c - R * np.cos(gamma))
    momentum = (model.M * v if model.on_base else 0.0) + m * c * rate
    work = np.zeros(len(tilt))
    dt = np.diff(trace.time)
    if scene.motion:
        power = -scene.motion.acceleration(trace.time) * momentum
        work[1:] = np.cumsum(0.5 * dt * (power[1:] + power[:-1]))
    if scene.bearings:
        power = -trace.bearing_force * v
        work[1:] += np.cumsum(0.5 * dt * (power[1:] + power[:-1]))
    excess = energy - energy[0] - work
    scale = m * g * R * (1 - np.cos(gamma)) + energy.max() + (law.count * law.f0 * np.abs(trace.base_displacement).max())
    gain = float(excess.max() / scale)
    if gain <= ENERGY_TOLERANCE:
        return None
    i = int(excess.argmax())
    return Failure("unphysical energy gain", f"{gain:.3g} of {scale:.6g} J appeared from nowhere by "
                   f"t = {trace.time[i]:.9g} s; tolerated: {ENERGY_TOLERANCE:g}; a smaller step may cure it")


def check_place(scene, x, z, tilt, base):
    """A `Failure` where the block slid on its base, sank into it or left it, else None.

    x, z : centre of the block [m] from the ground's origin, z from its standing height; base : base displacement [m].
    """
    block, R, gamma = scene.block, scene.block.radius, scene.block.slenderness
    s = -1.0 if tilt < 0 else 1.0
    slid = x - base - (s * block.half_width - R * np.sin(s * gamma - tilt))
    height = z - (R * np.cos(s * gamma - tilt) - block.half_height)
    if abs(slid) > SLIDING_TOLERANCE * R:
        return Failure("the block slid on its base", f"by {slid:.6g} m; tolerated: {SLIDING_TOLERANCE * R:.3g} m")
    if abs(height) > HEIGHT_TOLERANCE * R:
        word = "sank into" if height < 0 else "left"
        return Failure(f"the block {word} its base", f"lower corner at {height:.6g} m; "
                       f"tolerated: {HEIGHT_TOLERANCE * R:.3g} m")
    return None
