"""Analytic trajectories sampled as an engine would hand them over: traces whose events are known."""

import numpy as np

from analytic import SampledMotion, Scene, Start, simulate
from analytic.scene import BASE, BEARINGS
from analytic.scene import caryatid_block as block
from engines.observe import observe
from engines.swings import Trace

EDGE = 1e-6


def shaking(scale):
    time = 0.01 * np.arange(1500)
    envelope = np.interp(time, [0, 2, 8, 14], [0, 1, 1, 0])
    return SampledMotion(0.01, scale * envelope * (np.sin(5 * time) + 0.4 * np.sin(17 * time)))


SCENES = {
    "rigid ground": Scene(block=block(0.25), start=Start(tilt=0.15), duration=9.0),
    "sliding base": Scene(block=block(0.25), base=BASE, start=Start(tilt=0.15), duration=4.0),
    "isolated": Scene(block=block(0.2), base=BASE, bearings=BEARINGS, start=Start(tilt=0.12), duration=4.0),
    "isolated, shaken": Scene(block=block(0.15), base=BASE, bearings=BEARINGS, motion=shaking(1.8), duration=15.0),
    "rigid ground, shaken": Scene(block=block(0.25), motion=shaking(2.1), duration=15.0),
}


def sampled(scene, mean_step, *, contact_tilt=EDGE, seed=0, side=1, noise=0.0, step=2.5e-4):
    """(trace at random steps of the analytic run, the analytic response)."""
    reference = simulate(scene, output_step=step)
    history, rng = reference.history, np.random.default_rng(seed)
    count = int(history.time[-1] / mean_step)
    kept = np.unique(
        np.concatenate(([0], rng.choice(len(history.time), count, replace=False), [len(history.time) - 1]))
    )
    columns = [getattr(history, name)[kept] * (side if name != "time" else 1) for name in Trace.COLUMNS]
    columns[1] = columns[1] + noise * rng.uniform(-1, 1, len(kept))
    return Trace(*columns, contact_tilt), reference


def seen(scene, trace, **changes):
    given = dict(engine="test", variant="", cpu_seconds=0.0, steps=len(trace.time), settings={}, versions={})
    return observe(scene, trace, **{**given, **changes})


def observed(scene, mean_step, **given):
    """(scene, trace, analytic response, the trace's response) of a scene or the name of one; given: as of `sampled`."""
    scene = SCENES.get(scene, scene) if isinstance(scene, str) else scene
    trace, reference = sampled(scene, mean_step, **given)
    return scene, trace, reference, seen(scene, trace)
