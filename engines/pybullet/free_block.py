"""The scene with a free block of six degrees of freedom, otherwise set as the planar variants are.

The planar chain leaves out three of them; this is the model most scripts begin with, without the defaults that spoil it
(damping, contact softness).
"""

import time

import numpy as np
import pybullet

from analytic import Response, Scene
from analytic.ending import until_decided

from ..leapfrog import trace_of
from ..observe import observe
from ..pace import FLAT
from . import first_script as script
from .adapter import versions
from .links import without_losses
from .scene import BREAKING_THRESHOLD, FRICTION, iterations

# contactERP of a box on a slab: penetration decays at this rate per second whatever the step. A fixed share of .08 per
# step leaves the base velocity jump 2 to 5 % off at every step.
CORRECTION_RATE, MOST_CORRECTION = 30.0, 0.1


def simulate(scene: Scene, *, step: float, history: bool = True) -> Response:
    """The response; step [s]; history: keep it in the response. Without a duration it runs until it is decided."""
    if scene.duration is None:
        return until_decided(lambda cut: simulate(cut, step=step, history=history), scene)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body, slab = script.build(client, scene, step)
        _undo_defaults(client, scene, body, slab, step)
        begin = time.process_time()
        rows, ended = script.run((body, slab), client, scene, step)
        cpu = time.process_time() - begin
    finally:
        pybullet.disconnect(client)
    trace = trace_of([tuple(map(float, row)) for row in np.array(rows)], scene, FLAT * scene.block.slenderness)
    return observe(
        scene,
        trace,
        engine="pybullet",
        variant="3-D free block",
        cpu_seconds=cpu,
        steps=len(rows) - 1,
        settings={"step": step},
        versions=versions(),
        history=history,
        ended=ended if ended == "overturned" else None,
    )


def _undo_defaults(client, scene, body, slab, step):
    """Contact, damping and friction as the planar variants have them."""
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=step,
        numSubSteps=0,
        contactSlop=0.0,
        contactERP=min(MOST_CORRECTION, CORRECTION_RATE * step),
        contactBreakingThreshold=BREAKING_THRESHOLD,
        numSolverIterations=iterations(scene, 2),
        physicsClientId=client,
    )
    for part, link in ((body, -1), (slab, -1), *(((slab, 0),) if scene.base else ())):
        without_losses(client, part, link, FRICTION)
