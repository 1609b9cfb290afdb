"""The rule of the steps knows no block: two unlike blocks side by side on one base, built of the adapter's parts."""

import math

import numpy as np
import pytest

pybullet = pytest.importorskip("pybullet")

from analytic import Base, Block, Scene  # noqa: E402
from analytic.rocking import RockingModel, restitution  # noqa: E402
from engines.pybullet.links import chain, without_losses  # noqa: E402
from engines.pybullet.scene import BREAKING_THRESHOLD, FRICTION, MOST_VELOCITY, _shapes  # noqa: E402
from engines.step_size import gap_rule  # noqa: E402

G, BASE = 9.81, 800.0
BLOCKS = (Block(mass=3172.05, radius=1.0884, slenderness=0.28), Block(mass=900.0, radius=0.8, slenderness=0.2))
TILTS = (0.12, -0.11)  # both rock, each lands while the other pivots


def build(client):
    """The base on its joint, and each block on three joints beside it; the rows of its joints' numbers."""
    pybullet.setPhysicsEngineParameter(
        numSubSteps=0,
        contactSlop=0.0,
        contactBreakingThreshold=BREAKING_THRESHOLD,
        numSolverIterations=400,
        physicsClientId=client,
    )
    sliding, turning = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE
    links = [(BASE, _shapes(client, BLOCKS[0])[1], [0, 0, 0], sliding, [1, 0, 0], 0)]
    joints = []
    for k, block in enumerate(BLOCKS):
        first = len(links)
        joints.append((first, first + 1, first + 2))
        links += [
            (0.0, -1, [4.0 * k, 0, block.half_height], sliding, [1, 0, 0], 0),
            (0.0, -1, [0, 0, 0], sliding, [0, 0, 1], first + 1),
            (block.mass, _shapes(client, block)[0], [0, 0, 0], turning, [0, 1, 0], first + 2),
        ]
    body = chain(client, links, flags=pybullet.URDF_USE_SELF_COLLISION)
    for link in range(-1, len(links)):
        without_losses(client, body, link, math.sqrt(FRICTION), maxJointVelocity=MOST_VELOCITY)
    for block, (x, z, turn), tilt in zip(BLOCKS, joints, TILTS, strict=True):
        inertia = [block.centre_inertia] * 3
        pybullet.changeDynamics(body, turn, mass=block.mass, localInertiaDiagonal=inertia, physicsClientId=client)
        b, h, side = block.half_width, block.half_height, math.copysign(1.0, tilt)
        # the centre of a block turned about its lower corner
        across = side * b + h * math.sin(tilt) - side * b * math.cos(tilt)
        up = h * (math.cos(tilt) - 1) + b * abs(math.sin(tilt))
        for joint, value in ((x, across), (z, up), (turn, tilt)):
            pybullet.resetJointState(body, joint, value, 0.0, physicsClientId=client)
    return body, joints


def run(seconds):
    """Rows of time, step, and of each block tilt and its rate; steps by the rule with the corners of both."""
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body, joints = build(client)
        rule, t, before, rows = gap_rule(1e-3, 1e-6, G), 0.0, 0.0, []
        every = [joint for block in joints for joint in block]
        while t < seconds:
            states = pybullet.getJointStates(body, every, client)
            points, row = [], [t, before]
            for k, block in enumerate(BLOCKS):
                (_, _, _, _), (z, vz, _, _), (tilt, rate, _, _) = states[3 * k : 3 * k + 3]
                c, s, b, h = math.cos(tilt), math.sin(tilt), block.half_width, block.half_height
                for side in (1, -1):
                    points.append((z + h * (1 - c) - side * b * s, -vz - h * s * rate + side * b * c * rate))
                row += [tilt, rate]
            rows.append(row)
            step = rule(tuple(points))
            pybullet.setPhysicsEngineParameter(fixedTimeStep=step, physicsClientId=client)
            pybullet.setGravity(0.0, 0.0, -G * (step + before) / (2 * step), client)
            pybullet.stepSimulation(client)
            t, before = t + step, step
        return np.array(rows)
    finally:
        pybullet.disconnect(client)


def impacts(rows, k):
    """(index, rate after over rate before) of the impacts of block k, the rates carried to tilt 0 at constant gain."""
    t, h, tilt, rate = rows[:, 0], rows[:, 1], rows[:, 2 + 2 * k], rows[:, 3 + 2 * k]
    for i in np.flatnonzero((tilt[:-1] * tilt[1:] < 0) & (np.abs(rate[:-1]) > 0.05)):
        carried = []
        for near, far in ((i - 8, i - 40), (i + 12, i + 20)):  # the rates stand half a step before the times
            at = t[[near, far]] - 0.5 * h[[near, far]]
            gain = (rate[near] - rate[far]) / (at[0] - at[1])
            carried.append(rate[near] + gain * (t[i] - at[0]))
        yield i, carried[1] / carried[0]


def test_each_impact_is_as_momentum_asks_with_the_other_block_pivoting():
    """The other block's mass counts as m - (m c)^2/J, c the height of its centre over the corner it turns about.

    That holds where the base is kicked against its lean; kicked along it, the corner would have to be pulled down.
    """
    rows, errors = run(2.5), []
    for k, (block, other) in enumerate((BLOCKS, BLOCKS[::-1])):
        for i, found in impacts(rows, k):
            lean = rows[i, 4 - 2 * k]
            c = other.radius * math.cos(other.slenderness - abs(lean))
            carried = other.mass - (other.mass * c) ** 2 / other.inertia
            model = Scene(block=block, base=Base(mass=BASE + carried))
            if lean * RockingModel.of(model).impact(rows[i - 8, 3 + 2 * k])[1] <= 0:
                errors.append(found - restitution(model))
    assert len(errors) >= 5
    assert np.abs(errors).max() < 1e-4
