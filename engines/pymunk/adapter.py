"""pymunk's variants: Chipmunk's iterative contact solver decides contact and impact, in its plane, in double precision.

Measured in free rocking, gamma .05 to .45, 4 starts and 3 impacts each; rms error of e, on rigid ground and with m_b =
212 kg, CPU seconds a second:

    impact-aware, accuracy 1e-3, 1e-4, 1e-5      6e-4; 5e-4 to 2e-3, 6e-5; 5e-5 to 2e-4, 7e-6; 4e-6 to 1.6e-5
    impact-aware, accuracy 1e-6                  6e-7 to 9e-7; 6e-7 to 8e-6      .011; .017 (1050 to 1570 steps)
    expert, steps of 1 ms                        2e-3 to 6e-3; 4e-3 to 3e-2
    expert, .1 ms                                1e-4 to 3e-4; 3e-4 to 2e-3      .1; .2
    expert, .02 ms                               3e-5 to 7e-5; 7e-5 to 4e-4      .5; 1
    first-script, 1/240 s, from the swings       .008; .018 (gamma .2); from its states at the impact up to .2; .6

Of the expert's settings the iterations decide, where a groove joint holds the base: at .2 ms and m_b = 212 kg e is off
by .04 to .1 with the default 10, by .015 to .02 with 30, by 7e-4 to 1.7e-3 with 100. collision_bias, a share left per
second, does not: 0 to 1 give 5e-4 to 6e-4 on rigid ground, 8e-4 to 2.4e-3 on that base. All with pymunk 7.3.1.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pymunk

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..leapfrog import raw_trace_of, trace_of
from ..planar import EqualSteps, ImpactAware, equal_steps_run, impact_aware_run
from . import script
from .scene import build
from .stepping import ChipmunkBodies

if TYPE_CHECKING:
    from analytic import Scene

SOLVER_DECIDES = (
    "Chipmunk's contact solver decides when a corner lands, sticks or lifts and what an impact does to the tilt rate "
    "and the base velocity; no restitution is given to it. The adapter gives it the bearings' force and the ground's "
    "acceleration"
)
DECIDES = (
    f"{SOLVER_DECIDES}, and chooses steps, iterations and, where the scene gives none, the friction: of four "
    "coefficients the first at which Chipmunk's iterations, done by hand beforehand, end at eq. (7). Where that is not "
    "the first of them, they have several ends and the formula, not Chipmunk, chose among these; a warning says so. "
    "Between two steps the adapter moves a pivoting block along its arc, as Chipmunk would move it along the tangent, "
    "gives back the spin that the tangent costs, raises a corner that landed below the ground, and puts a block on "
    "both corners level. The base is the rim of a wheel on a fixed axle, so that Chipmunk has no guide to solve for."
)
SCRIPT_DECIDES = f"{SOLVER_DECIDES}, in equal steps; a groove joint of Chipmunk's guides the base."


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(accuracy=1e-6, largest_step=1e-3),
        tier="tuned",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "expert": Variant(
        EqualSteps(1e-4),
        tier="tuned",
        ladder=(1e-3, 1e-4, 2e-5),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "first-script": Variant(
        EqualSteps(1 / 240),  # four a frame: pymunk leaves the step to its user
        tier="defaults",
        ladder=(1 / 60, 1 / 240, 1e-3),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
}

UNSURE = (
    "Chipmunk's iterations for impacts of this block settle at some coefficients of friction only, if at all; unless "
    "the scene gives it, the one taken is that at which they end at eq. (7)"
)
# Tilt below which the block counts as in flat contact, as a share of gamma: the scripts' corners sink, at rest up to
# 3e-3 where the slop is the default.
SCRIPT_CONTACT, FIRST_CONTACT = 1e-3, 1e-2


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"pymunk": pymunk.version, "chipmunk": pymunk.chipmunk_version}


def run(scene: Scene, variant: str, settings: ImpactAware | EqualSteps) -> Run:
    """The `Run` of a scene."""
    if isinstance(settings, ImpactAware):
        try:
            assembly = build(scene)
        except Mismatch as error:
            return Run(None, 0, math.nan, Failure("Chipmunk does not hold the scene", str(error)))
        unsure = () if assembly.sure else (UNSURE,)
        return impact_aware_run(scene, settings, lambda largest: ChipmunkBodies(assembly, scene, largest), unsure)
    tuned, step = variant == "expert", settings.step
    parts = script.build(scene, tuned)
    read, share = (trace_of, SCRIPT_CONTACT) if tuned else (raw_trace_of, FIRST_CONTACT)
    edge = share * scene.block.slenderness
    return equal_steps_run(scene, step, lambda: script.run(parts, scene, step), lambda rows: read(rows, scene, edge))
