"""Bullet's rows as a `Trace`: velocities brought to the time of the displacements."""

import numpy as np

from analytic.rocking import RockingModel

from .swings import Trace

# A gain of speed this many times the largest smooth one is part of an impact.
JUMP = 30.0


def trace_of(rows, scene, contact_tilt):
    """The `Trace` of rows (time, step, tilt, tilt rate, x, v, z, force); rates are half a step early.

    A velocity at t_n is the mean of its neighbours, weighted by their distance. In an impact that mean would mix
    before and after: there the side of the tilt decides which of both is extrapolated.
    """
    table = np.array(rows)
    t, h, tilt, rate, x, v, _, force = table.T
    if len(rows) < 3:
        return Trace(t, tilt, rate, x, v, force, contact_tilt)
    model = RockingModel.of(scene)
    peak = scene.motion.peak if scene.motion else 0.0
    pull = abs(model.accelerations(1.0, 0.0, 0.0, peak + model.g * model.gamma, 0.0)[0])
    kick = np.diff(rate) / (0.5 * (h[1:] + h[:-1]))  # tilt'' at t_0 .. t_(n-2)
    jump = np.abs(kick) > JUMP * pull
    side = np.sign(tilt)
    landed = np.zeros(len(t), dtype=bool)  # rows on the new side of an impact in progress
    landed[1:] = side[1:] != side[:-1]
    landed[2:] |= landed[1:-1] & jump[1:][: len(t) - 2] if len(t) > 2 else False
    rate, v = (_synchronised(value, h, jump, landed) for value in (rate, v))
    force = force + model.bearing.count * model.bearing.damping * v
    return Trace(t, tilt, rate, x, v, force, contact_tilt)


def _synchronised(value, h, jump, landed):
    """`value`, known half a step early, at the steps' ends."""
    n = len(h)
    slope = np.diff(value) / (0.5 * (h[1:] + h[:-1]))
    mean = (value[1:-1] * h[2:] + value[2:] * h[1:-1]) / (h[1:-1] + h[2:])  # rows 1 .. n-2
    result = value.copy()
    result[1:-1] = mean
    result[-1] = value[-1] + 0.5 * h[-1] * (0.0 if jump[-1] else slope[-1])
    for i in np.flatnonzero(jump):
        if 1 <= i < n - 1:
            before = value[i] + 0.5 * h[i] * (0.0 if jump[i - 1] else slope[i - 1])
            after = value[i + 1] - 0.5 * h[i + 1] * (slope[i + 1] if i + 1 < n - 1 and not jump[i + 1] else 0.0)
            result[i] = after if landed[i] else before
    return result


def raw_trace_of(rows, scene, contact_tilt):
    """The `Trace` of rows taken as they are, as a first script takes them."""
    t, _, tilt, rate, x, v, _, force = np.array(rows).T
    law = RockingModel.of(scene).bearing
    return Trace(t, tilt, rate, x, v, force + law.count * law.damping * v, contact_tilt)
