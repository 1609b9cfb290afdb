"""exudyn, variant compliant-corners: a stiff contact spring at each bottom corner; the engine decides the impacts."""

import math
from dataclasses import dataclass

import exudyn as exu

from .exudyn_run import solver_settings, step_through
from .exudyn_scene import build

Real = exu.symbolic.Real

# The block the defaults were measured with: the Caryatid, mass [kg], radius [m], gravity [m/s2].
MEASURED = 3172.05, 1.0884, 9.81

# Time for the corners to relax after an impact, over sqrt(R/g): 20 ms for the Caryatid, of which a
# stocky block spends 15 in the air.
SETTLE = 0.06

# Share of R within which a corner is drawn back to where it stood. The hops after an impact move it by up to 4e-4
# (slenderness .45) or 2e-3 (.6) of R, a friction demand just above `friction` by 7e-3. After a long slide (the model's
# normal force is negative then) it must not be: drawn back 23 of 61 such runs gained energy from nowhere, at 1e-2 9 do.
REACH = 1e-2


@dataclass(frozen=True)
class CompliantCorners:
    """Settings of compliant-corners. `stiffness` is the accuracy knob: the error of restitution goes as its inverse.

    stiffness [N/m] per corner and rebound [m/s], the speed a corner may keep after an impact, are those of a block
    of the Caryatid's weight and size; other blocks get the equivalent (penetration over radius and rebound over
    sqrt(g R) stay the same).
    """

    # Measured in free rocking from 8 starts, 0.3 to 0.8 gamma, gamma 0.1 to 0.45, rigid ground and m_b = 212 kg, every
    # impact at least a tenth as fast as the run's fastest; worst rms error of restitution and CPU s per simulated s:
    # 1e11: 1.3e-4, .02-.05; 1.5e11: 6e-5, .02-.055; 2e11: 3e-5, .02-.055; 3e11: 7e-6, .03-.065. Slow impacts err
    # more, as the inverse square of their rate.
    stiffness: float = 2e11
    # Hunt-Crossley damping of 1000 s/m: the corner is thrown back at 1 mm/s at most.
    rebound: float = 1e-3
    # No slip in any impact; the model's friction demand is far below it.
    friction: float = 5.0
    # Tangential over normal stiffness, less on a light base. 1: .03-.09 CPU s; 0.3: .02-.05, error up to 4e-5;
    # 0.1: .02-.045, up to 1e-4.
    sticking: float = 0.3
    # Tangential, over the critical one of block and base sliding on the contact. 0.3 throws the stocky block about
    # after its impacts, 1 costs up to twice the steps.
    damping: float = 0.5
    # Local error per step [m, rad, m/s, rad/s]. Stability of the stiff contact, not this, sets the step:
    # 1e-6 costs as much within 10 %.
    tolerance: float = 1e-7
    # [s]; reached by no step in contact.
    longest_step: float = 5e-3


@dataclass(frozen=True)
class Corner:
    """Constants of one corner's contact force. Units: N/m, s/m, N/m, N s/m, -, m."""

    stiffness: float
    hardening: float
    sticking: float
    damping: float
    friction: float
    reach: float

    @classmethod
    def of(cls, scene, settings):
        block = scene.block
        mass, radius, gravity = MEASURED
        stiffness = settings.stiffness * (block.mass * scene.gravity / block.radius) / (mass * gravity / radius)
        speed = math.sqrt(scene.gravity * block.radius / (gravity * radius))
        # on a light base the reduced mass is small: a sticking spring in proportion keeps the step
        reduced = block.mass * (1 - scene.mass_share if scene.base else 1.0)
        sticking = settings.sticking * stiffness * reduced / block.mass
        return cls(stiffness, 1 / (settings.rebound * speed), sticking,
                   2 * settings.damping * math.sqrt(sticking * reduced), settings.friction, REACH * block.radius)

    def force(self, displacement, velocity, offset):
        """Symbolic force of a Cartesian connector [N]: Hunt-Crossley, clipped at zero, and a stick spring.

        The tangential force is gated by the normal one: a gate by the gap would let micro-bounces inject energy. A
        corner that has slid, or was thrown, by more than `reach` sticks no longer to where it stood.
        """
        depth, rate = -displacement[1], -velocity[1]
        normal = exu.symbolic.IfThenElse(
            depth > 0.0, exu.symbolic.max(Real(0.0), self.stiffness * depth * (1.0 + self.hardening * rate)), Real(0.0))
        limit = self.friction * normal
        across = displacement[0]
        spring = exu.symbolic.IfThenElse(across * across < self.reach**2, self.sticking * across, Real(0.0))
        stick = spring + self.damping * velocity[0]
        return [exu.symbolic.max(-limit, exu.symbolic.min(limit, stick)), -normal, Real(0.0)]


def assemble(scene, settings):
    """(model, contact tilt [rad]) of a scene with compliant corners."""
    corner = Corner.of(scene, settings)
    sink = scene.block.mass * scene.gravity / (2 * corner.stiffness)
    model = build(scene, sink)
    for side, name in ((-1, "left"), (1, "right")):
        model.connect(name, model.corner_markers(side), corner.force)
    return model, sink / scene.block.half_width


def run(scene, settings):
    """Step a scene with compliant corners."""
    model, contact_tilt = assemble(scene, settings)
    steps = max(1, math.ceil(scene.duration / settings.longest_step))
    solver = solver_settings(
        scene, numberOfSteps=steps, automaticStepSize=True, initialStepSize=1e-5, minimumStepSize=1e-13,
        relativeTolerance=1e-14, absoluteTolerance=settings.tolerance)
    return step_through(model, solver, exu.DynamicSolverType.DOPRI5, 2 * contact_tilt, settings.longest_step,
                        settle=SETTLE * math.sqrt(scene.block.radius / scene.gravity))
