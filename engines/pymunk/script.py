"""The scene as a user of pymunk would write it: a free box on the ground, or on a slab that a groove joint guides.

`tuned`: what an hour with Chipmunk's manual brings. Its docs give `iterations` ("increase for accuracy"), and
`collision_slop` ("the amount of overlap between shapes that is allowed") in the units of the scene, made for pixels:
the default of .1 is .1 m here. Without it all is left as pymunk has it; only a friction must be given, as the default
of 0 lets every block slide.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np
import pymunk

from analytic.bearing import BearingLaw
from analytic.motion import vertical_acceleration

from ..leapfrog import row_limit
from ..placement import placement

if TYPE_CHECKING:
    from analytic import Scene

FRICTION = 1.0  # of each shape; Chipmunk multiplies them
SLOP = 1e-6  # m
ITERATIONS = 100


def build(scene: Scene, tuned: bool) -> tuple[pymunk.Space, pymunk.Body, pymunk.Body | None]:
    """(space, block, slab) of a scene; the slab is None on rigid ground."""
    block, R = scene.block, scene.block.radius
    b, h = block.half_width, block.half_height
    space = pymunk.Space()
    if tuned:
        space.iterations, space.collision_slop = ITERATIONS, SLOP
    x, z, vx, vz = placement(scene)
    body = pymunk.Body(block.mass, block.centre_inertia)
    body.position, body.angle = (x, z + h), -scene.start.tilt
    body.velocity, body.angular_velocity = (vx, vz), -scene.start.tilt_rate
    box = pymunk.Poly(body, [(-b, -h), (b, -h), (b, h), (-b, h)])
    ground, slab = space.static_body, None
    if scene.base is not None:
        ground = slab = pymunk.Body(scene.base.mass, math.inf)
        slab.position = (scene.start.base_displacement, 0.0)
        slab.velocity = (scene.start.base_velocity, 0.0)
        space.add(slab, pymunk.GrooveJoint(space.static_body, slab, (-1e3 * R, 0.0), (1e3 * R, 0.0), (0.0, 0.0)))
    top = pymunk.Poly(ground, [(-20 * R, -R), (20 * R, -R), (20 * R, 0.0), (-20 * R, 0.0)])
    box.friction = top.friction = FRICTION if scene.friction is None else math.sqrt(scene.friction)
    space.add(body, box, top)
    return space, body, slab


def run(
    parts: tuple[pymunk.Space, pymunk.Body, pymunk.Body | None], scene: Scene, step: float
) -> tuple[np.ndarray, str]:
    """(rows, ended) as `stepping.run`: rates are those with which Chipmunk made the step, loads as at its beginning."""
    space, body, slab = parts
    law, g, height = BearingLaw.of(scene.bearings), scene.gravity, scene.block.half_height
    acceleration = scene.motion.acceleration if scene.motion else None
    start, limit = scene.start, 0.5 * math.pi
    x, v = start.base_displacement, start.base_velocity
    z = law.start(x)
    force = law.force(x, z)
    across, up, vx, vz = placement(scene)
    tilt, rate = start.tilt, start.tilt_rate
    rows = array("d", (0.0, 0.0, tilt, rate, x, v, z, force, across, up, vx, vz))
    width = len(rows)
    space.gravity = 0.0, -g
    for k in range(1, min(round(scene.duration / step), row_limit(scene.duration, step)) + 1):
        if acceleration:
            t = (k - 1) * step
            space.gravity = -float(acceleration(t)), -g - float(vertical_acceleration(scene.motion, t))
        if slab:
            v = slab.velocity.x
            slab.force = -law.force(x, z, v), 0.0
        space.step(step)
        tilt, (across, up) = -body.angle, body.position
        if slab:
            before, x = x, slab.position.x
            z = law.hysteretic(z, x - before)
            force = law.force(x, z)
        rows.extend((k * step, step, tilt, rate, x, v, z, force, across, up - height, vx, vz))
        rate, (vx, vz) = -body.angular_velocity, body.velocity
        if not math.isfinite(tilt + rate + vx + vz):
            return np.frombuffer(rows).reshape(-1, width), "not finite"
        if not -limit < tilt < limit:
            return np.frombuffer(rows).reshape(-1, width), "overturned"
    return np.frombuffer(rows).reshape(-1, width), "done"
