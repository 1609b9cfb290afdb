"""Scenes modelled with more than they need: what the extra costs, and what it does to the error."""

import math
import time

import numpy as np

from analytic import Base, Bearings

HEAVY = 1e6  # mass of a base that stands for rigid ground, over the block's
# contactERP of a box on a slab: penetration decays at this rate per second whatever the step. A fixed share of .08 per
# step leaves the base velocity jump 2 to 5 % off at every step.
CORRECTION_RATE, MOST_CORRECTION = 30.0, 0.1
SUPPORT_FREQUENCY = 2 * math.pi * 50  # rad/s: a support meant to be rigid


def on_heavy_base(scene):
    """Rigid ground as a free base of 10^6 block masses: two degrees of freedom instead of one."""
    return scene.with_(base=Base(mass=HEAVY * scene.block.mass))


def on_stiff_springs(scene):
    """Rigid ground as a heavy base on linear springs of 50 Hz: two degrees of freedom, and a stiff one."""
    base = Base(mass=HEAVY * scene.block.mass)
    springs = Bearings(law="linear", ka=(base.mass + scene.block.mass) * SUPPORT_FREQUENCY**2)
    return scene.with_(base=base, bearings=springs)


def free_block_3d(scene, *, step, history=True):
    """PyBullet with a free block of six degrees of freedom, otherwise set as its planar variants are.

    The planar chain leaves out three of them; this is the model most scripts begin with, without the defaults that
    spoil it (damping, contact softness).

    Parameters
    ----------
    scene : Scene
    step : float
        [s]
    history : bool
        Keep the history.
    """
    import pybullet

    from engines import get_engine
    from engines.leapfrog import trace_of
    from engines.observe import observe
    from engines.pace import FLAT
    from engines.pybullet import first_script as script
    from engines.pybullet.scene import BREAKING_THRESHOLD, FRICTION, iterations

    client = pybullet.connect(pybullet.DIRECT)
    try:
        body, slab = script.build(client, scene, step)
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
            pybullet.changeDynamics(part, link, linearDamping=0.0, angularDamping=0.0, physicsClientId=client)
            pybullet.changeDynamics(
                part,
                link,
                lateralFriction=FRICTION,
                rollingFriction=0.0,
                spinningFriction=0.0,
                restitution=0.0,
                jointDamping=0.0,
                physicsClientId=client,
            )
        if scene.base:
            pybullet.setJointMotorControl2(slab, 0, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
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
        versions=get_engine("pybullet").versions(),
        history=history,
        ended=ended if ended == "overturned" else None,
    )
