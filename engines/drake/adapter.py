"""Drake's variants: its contact solvers TAMSI and SAP decide contact and impact, in double precision.

Measured in free rocking, gamma .1 to .45, 3 starts and 3 impacts each; rms error of e, on rigid ground and with m_b =
212 kg, CPU seconds a second on a busy machine:

    impact-aware, accuracy 1e-3, 1e-4      5e-4; 1.1e-3, 9e-5; 1.3e-4
    impact-aware, accuracy 1e-5            3e-5; 4e-5, as an impact takes two steps
    impact-aware, accuracy 1e-6            1e-6 (1.9e-6 at worst); 4e-6 (1.7e-5)      .05; .06 (800 and 990 steps)
    expert, steps of 1 ms                  2.9e-3; 9e-3                               .09; .1
    expert, .2 ms                          5e-4; 1.1e-3                               .37; .43
    first-script, 1 ms, from the swings    4e-3; .008 to .02; from its states at the impact up to .1; .3    .2; .3
    first-script, .2 ms, from the swings   4e-3; .009 to .02                                                1.1; 1.3

Error and step are in proportion but in first-script: there it is the soft contact's. For an expert SAP and the other
approximations take three times TAMSI's time and are no better; a box in place of the four spheres is off by 3 to 30
times as much. All with drake 1.51.1.
"""

from __future__ import annotations

import math
from importlib import metadata
from typing import TYPE_CHECKING

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..leapfrog import raw_trace_of, trace_of
from ..planar import EqualSteps, ImpactAware, equal_steps_run, impact_aware_run
from . import script
from .scene import build
from .stepping import DrakeBodies

if TYPE_CHECKING:
    from analytic import Scene

SOLVER_DECIDES = (
    "Drake's contact solver decides when a corner lands, sticks or lifts and what an impact does to the tilt rate and "
    "the base velocity; no restitution is given to it. The adapter gives it the bearings' force and the ground's "
    "acceleration"
)
DECIDES = (
    f"{SOLVER_DECIDES}, chooses steps, stiffness, the tolerance of stiction, and a friction of 5 where the scene gives "
    "none. Joints of Drake hold the block in its plane and the base on its line. Drake's plant has one long time step "
    "of its own and is asked for the velocities after an impulse alone: the adapter says how long that took and moves "
    "the bodies, a pivoting block along its arc. TAMSI solves with the friction at which it is sure to find a "
    "solution, if that is less; where a corner then slips, or there is none, the adapter asks SAP with all friction. "
    "It gives back the spin that the way along an arc costs, raises a corner that landed below the ground, and puts a "
    "block on both corners level."
)
SCRIPT_DECIDES = (
    f"{SOLVER_DECIDES}, in equal steps. The block is free in space; a prismatic joint of Drake guides the base."
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
        ladder=(4e-3, 1e-3, 2e-4),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "first-script": Variant(
        EqualSteps(1e-3),  # Drake's own default
        tier="defaults",
        ladder=(5e-3, 2e-3, 1e-3),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
}

# Tilt below which the block counts as in flat contact in the scripts: a corner is met in the step after it has sunk,
# what a block passes in a step or two, so often of gamma a second.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"pydrake": metadata.version("drake")}


def run(scene: Scene, variant: str, settings: ImpactAware | EqualSteps) -> Run:
    """The `Run` of a scene."""
    tuned = variant == "expert"
    try:
        if isinstance(settings, ImpactAware):
            assembly = build(scene)
            return impact_aware_run(scene, settings, lambda largest: DrakeBodies(assembly, scene, largest))
        parts = script.build(scene, settings.step, tuned)
    except Mismatch as error:
        return Run(None, 0, math.nan, Failure("Drake does not hold the scene", str(error)))
    step, read = settings.step, trace_of if tuned else raw_trace_of
    edge = PASSING * step * scene.block.slenderness
    return equal_steps_run(scene, step, lambda: script.run(parts, scene, step), lambda rows: read(rows, scene, edge))
