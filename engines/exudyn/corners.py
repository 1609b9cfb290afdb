"""exudyn, variant compliant-corners: a stiff contact at each bottom corner.

The contact law is the adapter's own, of the Hunt-Crossley type; exudyn integrates it by the two methods of `Phases`.
The contact is plastic (`rebound`), without slip (`friction`) and planar, as Housner assumes. Agreement with his formula
verifies the law and the integration; it is not independent evidence.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import exudyn as exu

from analytic.motion import vertical_acceleration

from ..loads import Couple
from .scene import Anchor, CompliantCorners, Twist, build, scaled, standing_until
from .stepping import Phases, step_through

if TYPE_CHECKING:
    from analytic import Scene

    from ..contract import Run
    from .scene import Model

Real = exu.symbolic.Real

# Relaxation time of the corners after an impact, over sqrt(m/k); for a third of it the landing corner is pushed out at
# the rebound speed. At most MOST_RELAX sqrt(R/g), which soft corners would exceed.
RELAX, MOST_RELAX = 75.0, 0.06
# Time before a landing in which a couple acts, over the relaxation time: it presses the corners in, and they return at
# the rebound speed. With .1, .2 and .3 e is 3e-3, 1.3e-3 and 7e-4 too large for a restitution .8 times that of (7); on
# a light base, whose pull on the block changes meanwhile, it is .65, 1 and 1.7 times as far off.
ACTS = 0.21


@dataclass(frozen=True)
class Corner:
    """Constants of one corner's contact force. Units: N/m, s/m, N/m, N s/m, s/m, -."""

    stiffness: float
    hardening: float
    sticking: float
    damping: float
    grip: float
    friction: float

    @classmethod
    def of(cls, scene: Scene, settings: CompliantCorners) -> Self:
        """The constants from settings that are scaled to the scene."""
        block, stiffness = scene.block, settings.stiffness
        # on a light base the reduced mass is small; a sticking spring proportional to it keeps the step length
        reduced = block.mass * (1 - scene.mass_share if scene.base else 1.0)
        sticking = settings.sticking * stiffness * reduced / block.mass
        # a corner of a block of small centre inertia has a small effective mass
        turning = 4 / (1 / reduced + block.half_height**2 / block.centre_inertia)
        return cls(
            stiffness,
            1 / settings.rebound,
            sticking,
            2 * settings.damping * math.sqrt(sticking * turning),
            reduced / block.mass / settings.slip,
            settings.friction,
        )

    def force(self, displacement: Any, velocity: Any, offset: Any) -> list[Any]:
        """Symbolic force of a Cartesian connector [N]: Hunt-Crossley, clipped at zero, and friction.

        Friction is a spring and damper to an anchor, up to Coulomb's limit; exudyn has subtracted the anchor (the
        offset) from the displacement. It is switched by the normal force; a switch by the gap would let micro-bounces
        add energy. exudyn evaluates a term at every occurrence; in this form a step takes 25 % less time.
        """
        across, up = displacement[0], displacement[1]
        loading = (self.hardening * self.stiffness) * velocity[1] - self.stiffness
        touches, normal = up < 0.0, exu.symbolic.max(Real(0.0), up * loading)
        stick = self.sticking * across + (self.damping + self.grip * normal) * velocity[0]
        limited = exu.symbolic.IfThenElse(
            stick > 0.0,
            exu.symbolic.min(self.friction * normal, stick),
            exu.symbolic.max(-self.friction * normal, stick),
        )
        return [
            exu.symbolic.IfThenElse(touches, limited, Real(0.0)),
            exu.symbolic.IfThenElse(touches, exu.symbolic.min(Real(0.0), -up * loading), Real(0.0)),
            Real(0.0),
        ]


def deflected(scene: Scene, corner: Corner) -> tuple[float, float, float]:
    """Displacement [m, m] and rotation of a standing block on its corners at the time `standing_until`.

    Where the ground's acceleration lifts the block at once, as a jump can, they carry it as it pivots. From rest under
    its weight the corner that lifts would push it while it comes out: an impulse, and an error, as stiffness^-1/2.
    """
    block, motion, begin = scene.block, scene.motion, standing_until(scene)
    m, b, h = block.mass, block.half_width, block.half_height
    pull = scene.gravity + float(vertical_acceleration(motion, begin))
    a = float(motion.acceleration(begin)) if motion and not scene.base else 0.0  # a base slides away under the block
    turning = max(m * (abs(a) * h - pull * b) / block.inertia, 0.0)
    normal, side = m * (pull + b * turning), -math.copysign(1.0, a)
    lean = side * min(m * abs(a) * h / b, normal) / (2 * b * corner.stiffness)
    across = m * (a + side * h * turning) / (corner.sticking * (1 if turning else 2))
    return h * lean - across, -normal / (2 * corner.stiffness), -lean


def assemble(scene: Scene, settings: CompliantCorners, couple: Couple | None = None) -> tuple[Model, float]:
    """Build a scene with compliant corners: (model, contact tilt [rad])."""
    corner = Corner.of(scene, settings)
    sink = scene.block.mass * scene.gravity / (2 * corner.stiffness)
    model = build(scene, deflected(scene, corner))
    for side, name in ((-1, "left"), (1, "right")):
        model.connect(name, model.corner_markers(side), corner.force)
    if couple:
        model.add_twist(Twist(couple, 2 * sink / scene.block.half_width))
    usual = scaled(scene, CompliantCorners())
    if settings.friction < usual.friction or settings.rebound > usual.rebound:  # else the block neither slides nor hops
        both = model.connectors["left"], model.connectors["right"]
        model.anchor = Anchor(both, corner.friction, corner.sticking)
    return model, sink / scene.block.half_width


def run(scene: Scene, settings: CompliantCorners) -> Run:
    """Step a scene with compliant corners."""
    settings = scaled(scene, settings)
    settle = min(
        RELAX * math.sqrt(scene.block.mass / settings.stiffness),
        MOST_RELAX * math.sqrt(scene.block.radius / scene.gravity),
    )
    couple = Couple.of(scene, ACTS * settle)
    early = couple.lasts if couple else 0.0
    model, contact_tilt = assemble(scene, settings, couple)
    sink = contact_tilt * scene.block.half_width

    def drive(model, steps):
        return Phases(model, settings, steps, sink=sink, settle=settle, early=early).run()

    result = step_through(model, drive, 2 * contact_tilt, settle)
    return replace(result, trace=replace(result.trace, early=early)) if couple and result.trace else result
