"""exudyn, variant compliant-corners: a stiff contact at each bottom corner.

The contact law is the adapter's own, of the Hunt-Crossley type; exudyn integrates it by the two methods of `phases`.
The contact is plastic (`rebound`), without slip (`friction`) and planar, as Housner assumes. Agreement with his formula
verifies the law and the integration; it is not independent evidence.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import exudyn as exu

from ..couple import Couple
from .model import Anchor, Twist
from .phases import Phases, Rule
from .scene import build
from .sizing import CompliantCorners, scaled
from .stepping import solver_settings, step_through

if TYPE_CHECKING:
    from analytic import Scene

    from ..contract import Run
    from .model import Model

Real = exu.symbolic.Real

# Relaxation time of the corners after an impact, over sqrt(m/k); for a third of it the landing corner is pushed out at
# the rebound speed. At most MOST_RELAX sqrt(R/g), which soft corners would exceed.
RELAX, MOST_RELAX = 75.0, 0.06
# Change of the anchor that is not passed to exudyn, over the stretch of the sticking spring under the block's weight.
SLOP = 1e-3
# Time before a landing in which a couple acts, over the relaxation time: it presses the corners in, and they return at
# the rebound speed. With .1, .2 and .3 e is 3e-3, 1.3e-3 and 7e-4 too large for a restitution .8 times that of (7); on
# a light base, whose pull on the block changes meanwhile, it is .65, 1 and 1.7 times as far off.
ACTS = 0.21
LEAST_STEP = 1e-13  # s; exudyn stops where it would need a shorter one


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
            2 * settings.damping * math.sqrt(sticking * min(reduced, turning)),
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


def assemble(scene: Scene, settings: CompliantCorners, couple: Couple | None = None) -> tuple[Model, float]:
    """(model, contact tilt [rad]) of a scene with compliant corners."""
    corner = Corner.of(scene, settings)
    sink = scene.block.mass * scene.gravity / (2 * corner.stiffness)
    model = build(scene, sink)
    for side, name in ((-1, "left"), (1, "right")):
        model.connect(name, model.corner_markers(side), corner.force)
    if couple:
        model.add_twist(Twist(couple, 2 * sink / scene.block.half_width))
    model.anchor = Anchor(
        scene.block,
        (model.connectors["left"], model.connectors["right"]),
        stiffness=corner.stiffness,
        hardening=corner.hardening,
        stretch=corner.friction / corner.sticking,
        slop=SLOP * scene.block.mass * scene.gravity / corner.sticking,
    )
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
    explicit = solver_settings(
        scene,
        solverType=exu.DynamicSolverType.DOPRI5,
        automaticStepSize=True,
        minimumStepSize=LEAST_STEP,
        relativeTolerance=1e-14,  # round-off: with 0 the steps never end after a shock that overflows
        absoluteTolerance=settings.tolerance,
    )
    sink = contact_tilt * scene.block.half_width
    rule = Rule(explicit, settings.longest_step, settings.pivoting_step, sink, settle, early)
    ran = step_through(
        model, lambda model, steps, record: Phases(model, rule, steps, record).run(), 2 * contact_tilt, settle
    )
    return replace(ran, trace=replace(ran.trace, early=early)) if couple and ran.trace else ran
