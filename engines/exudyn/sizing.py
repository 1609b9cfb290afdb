"""Settings of compliant-corners, and their scaling with a scene's weight, size and gravity."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analytic import Scene

# The block for which the default values were determined: the Caryatid, mass [kg], radius [m], gravity [m/s2].
MEASURED = 3172.05, 1.0884, 9.81


@dataclass(frozen=True)
class CompliantCorners:
    """Settings of compliant-corners, for the Caryatid's weight and size. `stiffness` is the accuracy parameter.

    Errors are proportional to its inverse, at nearly the same cost: 2e9, 2e10 and 2e11 give e off by 1.2e-2, 1.0e-3 and
    2.6e-5 on the isolated Caryatid (slenderness .15), peak tilts by 1.9e-2, 3.7e-3 and 1.3e-4 of the slenderness, in
    .21, .23 and .24 s of CPU time. No other setting trades error for time: pivoting steps of 1 to 4 ms
    change neither; a tolerance of 1e-5 makes the error five times as large and saves 5 % of the time. stiffness [N/m]
    is that of a corner. Blocks of other mass, size and gravity get the dimensional equivalent: the same penetration
    over radius, the same speeds over sqrt(g R), the same steps over sqrt(R/g).

    Where a jump of the ground's acceleration lifts a block that was released and has come to rest before, on rigid
    ground, errors go as the root of that inverse: the peak tilt is off by .01 and more. See `corners.deflected`.
    """

    # The error of smaller swings is larger, by the inverse square of their speed.
    stiffness: float = 2e11
    # Largest rebound speed of a corner [m/s]: Hunt-Crossley damping of 1000 s/m.
    rebound: float = 1e-3
    # No slip in any impact, as the model's friction demand is far below it. The scene's coefficient replaces it.
    friction: float = 5.0
    # Tangential over normal stiffness. 0.1: three times the error; 1: twice the steps.
    sticking: float = 0.3
    # Tangential damping, over the critical one of block and base on the contact; 0.3 to 1 give the same error.
    damping: float = 0.5
    # Sliding speed [m/s] at which the viscous part of friction, proportional to the normal force, equals that force. A
    # corner must stick as soon as it lands; otherwise the other corner is pressed down and takes part in the impact.
    # Where an impact slips, e is off in proportion: 1.6e-2, 2e-3 and 5e-4 with .1, .01 and .003. Where none does,
    # .001 to .1 give the same e; .003 and .001 take 10 and 50 % more steps.
    slip: float = 0.01
    # Local error per step [m, rad, m/s, rad/s]. The step is limited by stability of the stiff contact, not by this.
    tolerance: float = 1e-7
    # [s]; of explicit steps, not reached in contact.
    longest_step: float = 5e-3
    # [s]; of implicit steps, while the block pivots or stands.
    pivoting_step: float = 2e-3


def scaled(scene: Scene, settings: CompliantCorners) -> CompliantCorners:
    """The settings scaled to a scene's weight, size and gravity."""
    block, (mass, radius, gravity) = scene.block, MEASURED
    speed = math.sqrt(scene.gravity * block.radius / (gravity * radius))
    time = math.sqrt(block.radius / scene.gravity / (radius / gravity))
    weight = block.mass * scene.gravity / block.radius / (mass * gravity / radius)
    return replace(
        settings,
        stiffness=settings.stiffness * weight,
        rebound=settings.rebound * speed,
        slip=settings.slip * speed,
        tolerance=settings.tolerance * min(speed, 1 / speed, 1.0),  # one tolerance for four units: the smallest scale
        longest_step=settings.longest_step * time,
        pivoting_step=settings.pivoting_step * time,
    )
