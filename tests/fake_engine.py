"""A crude engine as another package would offer it: the rocking equations in equal Euler steps, the impact's law given.

Tests install a copy of this file, called crude_engine, with the entry point of `installed_package`.
"""

import math
import time
from dataclasses import dataclass

import numpy as np

from analytic.motion import vertical_acceleration
from analytic.response import Failure
from analytic.rocking import RockingModel
from engines.contract import Engine, Run, Variant
from engines.swings import Trace

ENGINE = Engine(
    name="crude",
    package="crude_engine",
    install="pip install crude-engine",
    colour="#D55E00",
    marker="v",
    adapter="crude_engine",
)


@dataclass(frozen=True)
class Euler:
    """Equal steps: `step` [s] is the accuracy parameter."""

    step: float = 5e-4


VARIANTS = {
    "euler": Variant(
        Euler(),
        kind="assisted",
        levels=(2e-3, 5e-4),
        takes_restitution=True,
        computes="motion and uplift",
        imposes="the impact it is given",
    )
}


def versions():
    return {"crude-engine": "0.1"}


def run(scene, variant, settings):
    clock, model, start, step = time.process_time(), RockingModel.of(scene), scene.start, settings.step
    ground = scene.motion.acceleration if scene.motion else lambda t: 0.0
    tilt, rate, x, v = start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    z, side = model.bearing.start(x), int(np.sign(tilt or rate))
    rows, failure = [(0.0, tilt, rate, x, v, model.bearing.force(x, z, v))], None
    for k in range(1, math.ceil(scene.duration / step - 1e-9) + 1):
        a, force = float(ground((k - 1) * step)), rows[-1][-1]
        level = model.contact_acceleration(force) if model.on_base else a
        up = float(vertical_acceleration(scene.motion, (k - 1) * step))
        if side == 0 and abs(level) > model.uplift_limit(up):
            side = -int(np.sign(level))
        spin, push = model.accelerations(side, tilt, rate, a, force, up) if side else (0.0, (level - a) * model.on_base)
        rate, v = rate + step * spin, v + step * push
        tilt, x = tilt + step * rate, x + step * v
        z = model.bearing.hysteretic(z, step * v)
        if side * tilt < 0 and side * rate < 0:
            after, jump = model.impact(rate)
            side, rate, v = -side, after, v + jump * model.on_base
            if abs(rate) < 2 * step * abs(spin):
                side, tilt, rate = 0, 0.0, 0.0
        rows.append((k * step, tilt, rate, x, v, model.bearing.force(x, z, v)))
        if not abs(tilt) < math.pi / 2:
            break
    if not np.isfinite(rows).all():
        failure = Failure("the fake blew up", f"at {rows[-1][0]:.6g} s")
    trace = Trace(*np.array(rows).T, contact_tilt=1e-3 * scene.block.slenderness) if len(rows) > 1 else None
    ended = "overturned" if abs(tilt) >= math.pi / 2 else None
    return Run(trace, len(rows) - 1, time.process_time() - clock, failure, ended, ("crude is a fake",))
