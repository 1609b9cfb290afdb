"""pymunk's variants: Chipmunk's iterative contact solver computes contact and impact, in 2-D and double precision.

The scene is built as a user of pymunk would write it: a free box on the ground, or on a slab that a groove joint
guides. In Chipmunk's plane x points to the right, y up, and angles are counter-clockwise: angle = -tilt.

A first script keeps pymunk's defaults, except that a friction is given, as the default of 0 lets every block slide. The
tuned variant sets three parameters of Chipmunk's manual: `iterations` ("increase for accuracy"), `collision_slop` ("the
amount of overlap between shapes that is allowed", .1 m by default, for pixels), and `collision_bias`, the rate at which
overlap is removed. Tested with pymunk 7.3.1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pymunk

from ..contract import Run, Variant
from ..loads import placement
from ..loop import RULED, SAMPLED, FirstScript, ImpactAware, State, raw_trace_of, require, run_of, step_limits

if TYPE_CHECKING:
    from analytic import Scene

# Prevents sliding where the scene gives none. At 5 Chipmunk's iterations do not converge when a corner slides, and a
# block that overturns sinks.
FRICTION = 1.0
# Iterations, and the further ones per block mass over the base's mass: the groove constraint of a light base converges
# slowly. On 212 kg e is off by 5e-4 with 10 iterations in all, by 6e-5 with 170 and with 500. Bases below .005 block
# masses get the largest number.
ITERATIONS, LIGHT, MOST = 20, 10, 2000
WIDTH = 1e3  # of the groove, over R


def iterations(scene: Scene) -> int:
    """Iterations of Chipmunk's solver for a scene."""
    light = LIGHT * scene.block.mass / scene.base_mass if scene.base else 0.0
    return min(ITERATIONS + math.ceil(light), MOST)


class ChipmunkBodies:
    """Chipmunk's space with the block and, for a base, the slab.

    A call of Chipmunk first moves all bodies at their velocities, then finds contacts, then applies impulses. The
    impulse thus lies between this step and the next one, whose length must be known before the call. The state that is
    read is therefore the predicted one, one step ahead at the present velocities; no overlap is removed (bias 1). The
    first call begins one step before the start. In a first script all steps are equal, and the present state is read.

    Raises
    ------
    Mismatch
        Chipmunk reports other values than it was given.
    """

    def __init__(self, scene: Scene, first: float, plain: bool) -> None:
        """first: length of the first step [s]."""
        block, R, start = scene.block, scene.block.radius, scene.start
        b, h = block.half_width, block.half_height
        self.ahead, self.half_height, self.mass = not plain, h, scene.base_mass
        self.space = space = pymunk.Space()
        if not plain:
            space.iterations, space.collision_slop, space.collision_bias = iterations(scene), 0.0, 1.0
        back = 0.0 if plain else first
        x, z, vx, vz = placement(scene)
        self.block = pymunk.Body(block.mass, block.centre_inertia)
        self.block.position, self.block.angle = (x - vx * back, z + h - vz * back), start.tilt_rate * back - start.tilt
        self.block.velocity, self.block.angular_velocity = (vx, vz), -start.tilt_rate
        box = pymunk.Poly(self.block, [(-b, -h), (b, -h), (b, h), (-b, h)])
        ground, self.slab = space.static_body, None
        if scene.base is not None:
            ground = self.slab = pymunk.Body(self.mass, math.inf)
            self.slab.position = (start.base_displacement - start.base_velocity * back, 0.0)
            self.slab.velocity = (start.base_velocity, 0.0)
            ends = (-WIDTH * R, 0.0), (WIDTH * R, 0.0)
            space.add(self.slab, pymunk.GrooveJoint(space.static_body, self.slab, *ends, (0.0, 0.0)))
        top = pymunk.Poly(ground, [(-20 * R, -R), (20 * R, -R), (20 * R, 0.0), (-20 * R, 0.0)])
        friction = FRICTION if scene.friction is None else scene.friction
        box.friction = top.friction = math.sqrt(friction)  # Chipmunk multiplies them
        space.add(self.block, box, top)
        self._check(scene, friction, back)

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.loop.Bodies`."""
        block, slab, ahead = self.block, self.slab, 0.0
        call = step
        if self.ahead:
            call, ahead = before or step, step
        self.space.gravity = across / call, up / call
        if slab:
            slab.force = impulse / call, 0.0
        self.space.step(call)
        (x, y), (vx, vy), spin = block.position, block.velocity, block.angular_velocity
        base = v = 0.0
        if slab:
            v = slab.velocity.x
            base = slab.position.x + v * ahead
        tilt = -block.angle - spin * ahead
        return tilt, -spin, x + vx * ahead, y + vy * ahead - self.half_height, vx, vy, base, v

    def weigh(self, added: float) -> None:
        """See `engines.loop.Bodies`."""
        self.slab.mass = self.mass + added

    def _check(self, scene: Scene, friction: float, back: float) -> None:
        """Compare what Chipmunk reports with what the scene needs; raises `Mismatch` naming what differs."""
        space, block, start = self.space, self.block, scene.start
        x, z, vx, vz = placement(scene)
        place = x - vx * back, z + self.half_height - vz * back
        expected = [
            ("damping", space.damping, 1.0),
            ("bodies may sleep", math.isfinite(space.sleep_time_threshold), False),
            ("block: mass", block.mass, scene.block.mass),
            ("block: inertia", block.moment, scene.block.centre_inertia),
            ("block: position", tuple(block.position), place),
            ("block: velocity", tuple(block.velocity), (vx, vz)),
            (
                "block: tilt",
                [-block.angle, -block.angular_velocity],
                [start.tilt - start.tilt_rate * back, start.tilt_rate],
            ),
        ]
        if self.ahead:
            expected += [
                ("iterations", space.iterations, iterations(scene)),
                ("collision slop", space.collision_slop, 0.0),
                ("collision bias", space.collision_bias, 1.0),
            ]
        for shape in space.shapes:
            expected += [("friction", shape.friction**2, friction), ("restitution", shape.elasticity, 0.0)]
        if self.slab:
            expected += [
                ("base: mass", self.slab.mass, self.mass),
                ("base: velocity", tuple(self.slab.velocity), (start.base_velocity, 0.0)),
            ]
        require(expected)


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        kind="tuned",
        levels=(2e-3, 6e-4, 2e-4, 1e-4),
        computes="motion, contact, impact and rest",
        imposes=RULED,
    ),
    "first-script": Variant(
        FirstScript(1 / 240),  # four steps per frame; pymunk has no default step
        kind="defaults",
        levels=(1 / 60, 1 / 240, 1e-3),
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
    ),
}

# Tilt below which the block counts as in flat contact in a first script, over the slenderness: with the default slop
# corners penetrate, at rest by up to 3e-3.
FIRST_CONTACT = 1e-2


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pymunk": pymunk.version, "chipmunk": pymunk.chipmunk_version}


def run(scene: Scene, variant: str, settings: ImpactAware | FirstScript) -> Run:
    """The `Run` of a scene."""
    edge = FIRST_CONTACT * scene.block.slenderness
    first, plain = step_limits(scene, settings)[1], isinstance(settings, FirstScript)
    return run_of(
        scene,
        settings,
        lambda largest: ChipmunkBodies(scene, first, plain),
        lambda rows: raw_trace_of(rows, scene, edge),
    )
