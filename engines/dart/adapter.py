"""DART's variants: its boxed LCP decides contact and impact, in double precision.

Measured in free rocking, gamma .1 to .45, 3 starts and 3 impacts each; rms error of e, on rigid ground and with m_b =
212 kg, CPU seconds a second:

    impact-aware, accuracy 1e-3, 1e-4      6e-4; 9e-4, 6e-5; 1e-4
    impact-aware, accuracy 1e-5            6e-6; 7e-6
    impact-aware, accuracy 1e-6            6e-7 (9e-7 at worst); 4e-6 (1.7e-5)        .017; .028 (800 and 950 steps)
    expert, steps of 1 ms                  2.7e-3; 5e-3                               .05; .06
    expert, .2 ms                          5e-4; 1.1e-3                               .2; .3
    first-script, 5 ms, 1 ms, .2 ms        .024; .031, 4e-3; 8e-3, 7e-4; 1.2e-3       .02; .01, .04; .06, .2; .3

Error and step are in proportion. Of the expert's settings the step alone decides: at the same one split impulses bring
next to nothing. What DART needs for a slender block that stands on two corners is said in `scene`. All with dartpy
6.20.0.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import dartpy

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..leapfrog import raw_trace_of, trace_of
from ..planar import EqualSteps, ImpactAware, equal_steps_run, impact_aware_run
from . import script
from .scene import build
from .stepping import DartBodies

if TYPE_CHECKING:
    from analytic import Scene

SOLVER_DECIDES = (
    "DART's contact solver decides when a corner lands, sticks or lifts and what an impact does to the tilt rate and "
    "the base velocity; no restitution is given to it. The adapter gives it the bearings' force and the ground's "
    "acceleration"
)
DECIDES = (
    f"{SOLVER_DECIDES}, chooses steps and iterations, and a friction of 5 where the scene gives none. Joints of DART "
    "hold the block in its plane and the base on its line. Between two kicks the adapter moves a pivoting block along "
    "its arc, as DART would move it along the tangent, gives back the spin that the tangent costs, raises a corner "
    "that landed below the ground, and puts a block on both corners level."
)
SCRIPT_DECIDES = (
    f"{SOLVER_DECIDES}, in equal steps. The block is a free box in space; a prismatic joint of DART guides the base."
)


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(accuracy=1e-6, largest_step=1.5e-3),
        tier="tuned",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "expert": Variant(
        EqualSteps(2e-4),
        tier="tuned",
        ladder=(1e-3, 2e-4, 5e-5),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "first-script": Variant(
        EqualSteps(1e-3),  # DART's own default
        tier="defaults",
        ladder=(5e-3, 1e-3, 2e-4),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
}

# Tilt below which the block counts as in flat contact in the scripts: a corner is met in the step after it has sunk,
# what a block passes in a step or two, so often of gamma a second.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"dartpy": dartpy.__version__}


def run(scene: Scene, variant: str, settings: ImpactAware | EqualSteps) -> Run:
    """The `Run` of a scene."""
    tuned = variant == "expert"
    try:
        if isinstance(settings, ImpactAware):
            assembly = build(scene)
            return impact_aware_run(scene, settings, lambda largest: DartBodies(assembly, scene, largest))
        parts = script.build(scene, tuned)
    except Mismatch as error:
        return Run(None, 0, math.nan, Failure("DART does not hold the scene", str(error)))
    step, read = settings.step, trace_of if tuned else raw_trace_of
    edge = PASSING * step * scene.block.slenderness
    return equal_steps_run(scene, step, lambda: script.run(parts, scene, step), lambda rows: read(rows, scene, edge))
