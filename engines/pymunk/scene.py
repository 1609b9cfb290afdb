"""The scene as bodies of Chipmunk, in its plane: x to the right, y up, angles counter-clockwise, angle = -tilt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pymunk

from ..pivoting import depth
from ..placement import placement
from ..readback import require
from .impulses import iterations, settled

if TYPE_CHECKING:
    from analytic import Scene

CORNER_RADIUS = 1e-6  # share of R: the block touches by a disc at each bottom corner
# The base, in shares of R: a wheel about a fixed centre this far below the block. Its rim moves on a straight line, but
# for 1e-9 of its way, and meets a push with the base's mass, an upward one with none that counts. It always stands at
# angle 0 where contacts are looked for: only its speed matters, as the rim is the same everywhere. A body on Chipmunk's
# groove joint needs iterations in proportion to the ratio of the masses for the same.
WHEEL = 2.0**30
HEAVY = 1e30  # kg, of what must not move: Chipmunk takes no infinite mass
WIDTH, THICKNESS = 1e3, 1.0  # half the length of the ground and half its thickness, shares of R


@dataclass(frozen=True)
class Assembly:
    """Chipmunk's space with the block, and the wheel that is the base (None: rigid ground), `radius` [m].

    sweeps: iterations in flight, at an impact and at rest; sure: whether those of an impact lead where they should.
    """

    space: pymunk.Space
    block: pymunk.Body
    wheel: pymunk.Body | None
    radius: float
    sweeps: tuple[int, int, int]
    sure: bool


def build(scene: Scene) -> Assembly:
    """The `Assembly` of a scene at its start: a block on two corners over the ground, or over the wheel of its base.

    Gravity and all loads are given as forces: the space has none.

    Raises
    ------
    Mismatch
        Chipmunk reports other values than it was given.
    """
    block, R = scene.block, scene.block.radius
    friction, landing, sure = settled(scene)
    space = pymunk.Space()
    space.iterations = resting = max(iterations(scene, 2), landing)
    space.damping = 1.0
    space.collision_slop = 0.0
    space.collision_bias = 1.0  # the share of a sink left after a second: corners stay where they landed
    x, z, vx, vz = placement(scene)
    body = pymunk.Body(block.mass, block.centre_inertia)
    body.position, body.angle = (x, z + block.half_height - depth(scene)), -scene.start.tilt
    body.velocity, body.angular_velocity = (vx, vz), -scene.start.tilt_rate
    r = CORNER_RADIUS * R
    shapes: list[pymunk.Shape] = [
        pymunk.Circle(body, r, (side * block.half_width, r - block.half_height)) for side in (-1, 1)
    ]
    radius, thickness, wheel = WHEEL * R, THICKNESS * R, None
    if scene.base is None:
        ground, height = space.static_body, -thickness
    else:
        ground, height = pymunk.Body(HEAVY, scene.base.mass * radius**2), radius - thickness
        thickness = radius - height  # as rounded: the rim is at 0
        ground.position, ground.angular_velocity = (0.0, -radius), -scene.start.base_velocity / radius
        wheel = ground
        space.add(ground)
    shapes.append(pymunk.Segment(ground, (-WIDTH * R, height), (WIDTH * R, height), thickness))
    for shape in shapes:
        shape.friction = math.sqrt(friction)
        shape.elasticity = 0.0
    space.add(body, *shapes)
    assembly = Assembly(space, body, wheel, radius, (iterations(scene, 1), landing, resting), sure)
    check_readback(assembly, scene, friction)
    return assembly


def check_readback(assembly: Assembly, scene: Scene, friction: float) -> None:
    """Compare what Chipmunk reports with what the scene needs; raises `Mismatch` naming what differs."""
    space, block = assembly.space, assembly.block
    x, z, vx, vz = placement(scene)
    expected = [
        ("iterations", space.iterations, assembly.sweeps[-1]),
        ("gravity", tuple(space.gravity), 0.0),
        ("damping", space.damping, 1.0),
        ("collision slop", space.collision_slop, 0.0),
        ("collision bias", space.collision_bias, 1.0),
        ("bodies may sleep", math.isfinite(space.sleep_time_threshold), False),
        ("bodies", len(space.bodies), 1 if scene.base is None else 2),
        ("joints", len(space.constraints), 0),
        ("block: mass", block.mass, scene.block.mass),
        ("block: inertia", block.moment, scene.block.centre_inertia),
        ("block: position", tuple(block.position), (x, z + scene.block.half_height - depth(scene))),
        ("block: velocity", tuple(block.velocity), (vx, vz)),
        (
            "block: angle and its rate",
            (block.angle, block.angular_velocity),
            (-scene.start.tilt, -scene.start.tilt_rate),
        ),
    ]
    for shape in space.shapes:
        expected += [
            ("friction of two shapes", shape.friction**2, friction),
            ("elasticity", shape.elasticity, 0.0),
            ("surface velocity", tuple(shape.surface_velocity), 0.0),
        ]
    if assembly.wheel is not None:
        speed = -assembly.wheel.angular_velocity * assembly.radius
        expected += [
            ("base: mass", assembly.wheel.moment / assembly.radius**2, scene.base.mass),
            ("base: velocity", speed, scene.start.base_velocity),
        ]
    require(expected)
