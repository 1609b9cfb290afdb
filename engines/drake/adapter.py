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
import time
from dataclasses import dataclass, replace
from importlib import metadata
from typing import TYPE_CHECKING

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..leapfrog import raw_trace_of, trace_of
from ..pace import FLAT
from ..planar import run_of, size_scale
from ..verified import Range
from ..vibration import longest_step
from . import script, stepping
from .scene import build

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


@dataclass(frozen=True)
class ImpactAware:
    """Large steps in flight and at rest, small ones on the way to an impact.

    accuracy is the one knob: the share of its speed at the impact that the block may gain in one step there; the error
    of e is about as large. largest_step [s] is that of flight and rest for the Caryatid's R, and goes with sqrt(R/g).
    """

    accuracy: float = 1e-6
    largest_step: float = 1.5e-3


@dataclass(frozen=True)
class Expert:
    """A free 3-D block with an hour's settings: `step` [s] is the one knob."""

    step: float = 2e-4


@dataclass(frozen=True)
class FirstScript:
    """A free 3-D box with all defaults of Drake: `step` [s] is the one knob."""

    step: float = 1e-3  # Drake's own default


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        rung="best",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        decides=DECIDES,
        verified=Range(
            slenderness=(0.03, 1.2), inertia=(1.05, 3.0), base_mass=(1e-5, 100.0), radius=(1e-3, 30.0), decay=(0.0, 1e3)
        ),
    ),
    "expert": Variant(
        Expert(),
        rung="expert",
        ladder=(4e-3, 1e-3, 2e-4),
        decides=SCRIPT_DECIDES,
        verified=Range(
            slenderness=(0.1, 0.45),
            inertia=(1.3, 1.4),
            base_mass=(0.05, 0.1),
            radius=(1.0, 1.2),
            stiffness=(0.0, 0.05),
            damping=(0.0, 0.1),
            tilt=(0.3, math.inf),
        ),
    ),
    "first-script": Variant(
        FirstScript(),
        rung="first script",
        ladder=(5e-3, 2e-3, 1e-3),
        decides=SCRIPT_DECIDES,
        verified=None,
        caveats=(
            "drake first-script is verified in no range: two boxes touch in one point, however they lie, corners sink "
            "by Drake's default allowance of 1 mm, and impacts come out accordingly",
        ),
    ),
}

# Tilt below which the block counts as in flat contact, as a share of gamma. Impacts of swings below FLAT are stepped
# over. In the scripts a corner is met in the step after it has sunk: what a block passes in a step or two, so often of
# gamma a second.
CONTACT, PASSING = 3 * FLAT, 10.0
ENDS = ("done", "overturned", "not finite", "too many steps")


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"pydrake": metadata.version("drake")}


def run(scene: Scene, variant: str, settings: ImpactAware | Expert | FirstScript) -> Run:
    """The `Run` of a scene."""
    try:
        if isinstance(settings, ImpactAware):
            return _impact_aware(scene, settings)
        parts = script.build(scene, settings.step, tuned=isinstance(settings, Expert))
    except Mismatch as error:
        return Run(None, 0, math.nan, Failure("Drake does not hold the scene", str(error)))
    clock = time.process_time()
    rows, ended = script.run(parts, scene, settings.step)
    cpu, edge = time.process_time() - clock, PASSING * settings.step * scene.block.slenderness
    trace = trace_of(rows, scene, edge) if isinstance(settings, Expert) else raw_trace_of(rows, scene, edge)
    return _run(scene, rows, ended, cpu, trace, settings.step)


def _impact_aware(scene, settings):
    largest, assembly = longest_step(scene, settings.largest_step * size_scale(scene)), build(scene)
    clock = time.process_time()
    rows, ended = stepping.run(assembly, scene, largest, settings.accuracy)
    cpu = time.process_time() - clock
    trace = trace_of(rows, scene, CONTACT * scene.block.slenderness, smeared=3)
    return _run(scene, rows, ended, cpu, trace, largest)


def _run(scene, rows, ended, cpu, trace, step):
    run = run_of(scene, rows, ended, cpu, trace, step)
    if ended in ENDS:
        return run
    said = f"at step {len(rows) - 1}, t = {rows[-1][0]:.9g} s: {ended.partition(' at simulation time')[0]}"
    return replace(run, failure=Failure("Drake found no solution of a step", said))
