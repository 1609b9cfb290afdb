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
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pymunk

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


@dataclass(frozen=True)
class ImpactAware:
    """Large steps in flight and at rest, small ones on the way to an impact.

    accuracy is the one knob: the share of its speed at the impact that the block may gain in one step there; the error
    of e is about as large. largest_step [s] is that of flight and rest for the Caryatid's R, and goes with sqrt(R/g).
    """

    accuracy: float = 1e-6
    largest_step: float = 1e-3


@dataclass(frozen=True)
class Expert:
    """A free box with an hour's settings: `step` [s] is the one knob."""

    step: float = 1e-4


@dataclass(frozen=True)
class FirstScript:
    """The same box with the defaults of pymunk: `step` [s] hardly matters."""

    step: float = 1 / 240  # four a frame: pymunk leaves the step to its user


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
        ladder=(1e-3, 1e-4, 2e-5),
        decides=SCRIPT_DECIDES,
        verified=Range(
            slenderness=(0.05, 0.45),
            inertia=(1.3, 1.4),
            base_mass=(0.05, 0.1),
            radius=(1.0, 1.2),
            damping=(0.0, 0.1),
            tilt=(0.3, math.inf),
        ),
    ),
    "first-script": Variant(
        FirstScript(),
        rung="first script",
        ladder=(1 / 60, 1 / 240, 1e-3),
        decides=SCRIPT_DECIDES,
        verified=None,
        caveats=(
            "pymunk first-script is verified in no range: Chipmunk's default slop of .1 m lets corners sink, and its "
            "default iterations leave the base's guide loose, whatever the step",
        ),
    ),
}

UNSURE = (
    "Chipmunk's iterations for impacts of this block settle at some coefficients of friction only, if at all; unless "
    "the scene gives it, the one taken is that at which they end at eq. (7)"
)
# Tilt below which the block counts as in flat contact, as a share of gamma. Impacts of swings below FLAT are stepped
# over, and come out as swings of up to 3 FLAT. The scripts' corners sink, at rest up to 3e-3 where the slop is the
# default.
CONTACT, SCRIPT_CONTACT, FIRST_CONTACT = 3 * FLAT, 1e-3, 1e-2


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"pymunk": pymunk.version, "chipmunk": pymunk.chipmunk_version}


def run(scene: Scene, variant: str, settings: ImpactAware | Expert | FirstScript) -> Run:
    """The `Run` of a scene."""
    if isinstance(settings, ImpactAware):
        return _impact_aware(scene, settings)
    parts = script.build(scene, tuned=isinstance(settings, Expert))
    clock = time.process_time()
    rows, ended = script.run(parts, scene, settings.step)
    cpu, slenderness = time.process_time() - clock, scene.block.slenderness
    if isinstance(settings, Expert):
        trace = trace_of(rows, scene, SCRIPT_CONTACT * slenderness)
    else:
        trace = raw_trace_of(rows, scene, FIRST_CONTACT * slenderness)
    return run_of(scene, rows, ended, cpu, trace, settings.step)


def _impact_aware(scene, settings):
    largest = longest_step(scene, settings.largest_step * size_scale(scene))
    try:
        assembly = build(scene)
    except Mismatch as error:
        return Run(None, 0, math.nan, Failure("Chipmunk does not hold the scene", str(error)))
    clock = time.process_time()
    rows, ended = stepping.run(assembly, scene, largest, settings.accuracy)
    cpu = time.process_time() - clock
    trace = trace_of(rows, scene, CONTACT * scene.block.slenderness, smeared=3)
    return run_of(scene, rows, ended, cpu, trace, largest, () if assembly.sure else (UNSURE,))
