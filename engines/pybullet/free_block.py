"""The scene with a free block of six degrees of freedom, otherwise as in the planar variants.

The planar chain has three of them. This is the model of most scripts, but without the default damping and contact
softness.
"""

from typing import Any

from analytic import Response, Scene
from analytic.solver import until_decided

from ..loop import FirstScript, run_of, trace_of
from ..observe import failed_response, observe
from .adapter import FRICTION, FreeBox, correction, iterations, pybullet, versions, without_losses

BREAKING_THRESHOLD = 1e-3  # m; with Bullet's own .02 the rate after the third impact of a box is off by 4e-4 rad/s
LEAST_ITERATIONS = 20  # a box has four corners, and `iterations` counts what two need
CONTACT = 1e-6  # tilt below which the block counts as in flat contact, over the slenderness


def simulate(scene: Scene, *, step: float, history: bool = True) -> Response:
    """The response of a scene with a free block.

    step: [s]. history: whether to keep it. A scene without a duration runs until its outcome is decided.
    """
    if scene.duration is None:
        return until_decided(lambda cut: simulate(cut, step=step, history=history), scene)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        run = run_of(
            scene,
            FirstScript(step),
            lambda step: _without_defaults(FreeBox(client, scene, step), scene, step),
            lambda rows: trace_of(rows, scene, CONTACT * scene.block.slenderness),
        )
    finally:
        pybullet.disconnect(client)
    labels: dict[str, Any] = dict(
        engine="pybullet",
        variant="3-D free block",
        cpu_seconds=run.cpu_seconds,
        steps=run.steps,
        settings={"step": step},
        versions=versions(),
    )
    if run.trace is None:
        return failed_response(scene, run.failure, **labels)
    return observe(scene, run.trace, history=history, failure=run.failure, ended=run.ended, **labels)


def _without_defaults(box, scene, step):
    """Set contact, damping and friction of the box as in the planar variants."""
    client, slab = box.client, box.slab
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=step,
        numSubSteps=0,
        contactSlop=0.0,
        contactERP=correction(step),
        contactBreakingThreshold=BREAKING_THRESHOLD,
        numSolverIterations=max(LEAST_ITERATIONS, iterations(scene, 2)),
        physicsClientId=client,
    )
    without_losses(client, box.body, 0, FRICTION)
    without_losses(client, slab, 1 if scene.base else 0, FRICTION)
    return box
