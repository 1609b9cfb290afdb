"""MuJoCo's variants: its soft constraint solver decides contact and impact.

A MuJoCo contact is a spring and damper per unit of mass (solref: k, b), scaled by an impedance d < 1 (solimp): each
step it gives a corner the acceleration (1 - d) a0 - d (b v + k r), at its sink r, speed v and free acceleration a0. It
knows no restitution. With b = 1/step a corner stops in the step after it has sunk, whatever its speed, and the impact
is that of eq. (7): the old corner is free to lift in the same solve. k must only undo the sink, gently. Measured in
free rocking on rigid ground, gamma .2 (e = .9408) and .45 (.7162), steps of 1 ms, rms error of e:

    b = 1/step, Euler or implicitfast      1.9e-3, 4e-3    in proportion to the step (d = .999; below .9999)
    b = .9/step and 1.1/step               8e-3, 4e-2      whatever the step
    b = 1/step, k = .2/step^2              7e-3, 3e-2      whatever the step: the sink is thrown out
    b = 1/step, RK4; discrete              3e-2, 2e-1; 4e-2, 2e-1
    MuJoCo's defaults                      4e-3, 3e-3      gamma .1: 2e-2, m_b = 212 kg: 3e-2 to 2e-1; whatever the step

Without the flag diagexact a base of 1e-4 m moves 2 % too little (gamma .05). Small steps at impacts alone
(impact-aware), and a block kept on the arc about its corner (`stepping`), give over 2 starts and 3 impacts each:

    gamma                        .05      .1       .2       .3       .45
    e, rigid ground              1.6e-5   4e-6     3e-6     5e-6     1.5e-5
    e, m_b = 212 kg              1.5e-5   6e-6     4e-6     1.0e-5   1.8e-5

At the tangent instead, at steps of 2e-4 s and as much CPU time: rms over gamma and bases 2.4e-5, now 1.0e-5; base
velocity jump (relative) 2.3e-3, now 8e-4.

All with mujoco 4.0.0; diagexact needs 3.9.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import mujoco
import numpy as np

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..leapfrog import failure_of, raw_trace_of, trace_of
from . import stepping
from .scene import build

if TYPE_CHECKING:
    from analytic import Scene

SOLVER_DECIDES = (
    "MuJoCo's contact solver decides when a corner lands, sticks or lifts and what an impact does to the tilt rate and "
    "the base velocity; no restitution is given to it. The adapter gives it the bearings' force and the ground's "
    "acceleration"
)
DECIDES = (
    f"{SOLVER_DECIDES}, chooses the length of the steps, and puts the centre of a pivoting block back on its "
    "arc after each step, as MuJoCo moves it along the tangent."
)


@dataclass(frozen=True)
class ImpactAware:
    """Large steps in flight and at rest, small ones on the way to an impact.

    accuracy is the one knob: the share of its speed at the impact that the block may gain in one step there.
    largest_step [s] is that of flight and rest.
    """

    # Table above. At a largest step of 4e-4 s: e within 1.3e-4 at 2e-5, 2.7e-4 at 5e-5; 2e-6 changes little.
    accuracy: float = 5e-6
    # For the Caryatid's R; times of flight and rest go with sqrt(R/g), and so do the steps. On the Caryatid's bearings
    # under a sine (gamma .15, 2.2 m/s2) the tilt is off by up to 1.2e-2 of gamma on its way to overturning, by 1e-3 at
    # .28 and 5 m/s2.
    largest_step: float = 2.4e-4

    recovery: ClassVar = 75.0  # 1/s, for the Caryatid's R; see MOST_RECOVERY


@dataclass(frozen=True)
class FixedStep:
    """The same model at one step: `step` [s], for the Caryatid's R, is the one knob."""

    # e within 2e-4 (gamma .1 to .3, rigid ground) to 2.4e-3 (.45, m_b = 212 kg), .034 to .040 CPU s per s.
    step: float = 1e-4

    accuracy: ClassVar = None
    recovery: ClassVar = 30.0
    largest_step = property(lambda self: self.step)


@dataclass(frozen=True)
class FirstScript:
    """A box with all defaults of MuJoCo, loads and states taken as they come: `step` [s] hardly matters."""

    step: float = 2e-3  # MuJoCo's own default

    accuracy: ClassVar = None
    recovery: ClassVar = None
    largest_step = property(lambda self: self.step)


# verified: what random scenes over a wide box showed (rocking bench engines), and blocks let go (fixed-step).
VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        tier="tuned",
        ladder=(1e-3, 1e-4, 5e-6),
        finer=({"largest_step": 1e-4}, {"largest_step": 1e-4, "accuracy": 1e-6}),
        varied={"largest_step": (1.2e-4, 2.4e-4, 4.8e-4, 9.6e-4)},
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "fixed-step": Variant(
        FixedStep(),
        tier="tuned",
        ladder=(4e-3, 1e-3, 1e-4),
        finer=({"step": 2e-5},),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "first-script": Variant(
        FirstScript(),
        tier="defaults",
        ladder=(1 / 120, 2e-3, 5e-4),
        finer=({"step": 2e-4},),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
}

# Relative error of the time between two impacts of small swings, whose pivot sinks, times their size over the
# slenderness: of .0006 slendernesses, gamma .039, m_b/m .035: e is off by .004 to .013.
SINK = 6e-6
# Of the default contact, which sinks by .02 of gamma; see _contact_tilt.
FIRST_CONTACT_TILT = 0.05
# Small swings under a motion err as the step, by what they miss of the ground's push while contact changes: peaks of
# .001 slendernesses by 4 %, of .01 by 1.5 %. Below SMALL they are done again in steps a FINER-th as long, and how far
# that moved the peak is said above UNSURE: what is left is a third of it to all. Below STANDS a peak is the contact's.
SMALL, FINER, UNSURE, STANDS = 0.02, 4.0, 0.015, 1e-4
FIRST_SETTLE = 0.1  # s, 5 time constants of the default contact; 0.2 reads the same e to 2e-3


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"mujoco": mujoco.__version__, "mujoco-library": mujoco.mj_versionString()}


def run(scene: Scene, variant: str, settings: ImpactAware | FixedStep | FirstScript) -> Run:
    """The `Run` of a scene; small swings under a motion are stepped again, see `SMALL`."""
    first, size = _run(scene, settings)
    if not isinstance(settings, ImpactAware) or scene.motion is None or not STANDS < size < SMALL:
        return first
    finer = replace(settings, largest_step=settings.largest_step / FINER)
    if first.failure:
        return first
    again, finer_size = _run(scene, finer)
    moved = abs(size / finer_size - 1) if finer_size > STANDS else math.inf
    hangs = (
        f"the peak tilt, {finer_size:.2g} slendernesses, hangs on the steps' length: {FINER:g} times as long ones "
        f"moved it by {moved:.2g} of itself: the ground hardly lifts the block; give a shorter largest_step"
    )
    return replace(
        again,
        steps=first.steps + again.steps,
        cpu_seconds=first.cpu_seconds + again.cpu_seconds,
        warnings=(hangs,) if moved > UNSURE else (),
    )


def _run(scene: Scene, settings: ImpactAware | FixedStep | FirstScript) -> tuple[Run, float]:
    """(`Run` of a scene stepped once, its peak tilt over the slenderness; NaN without any)."""
    said: list[str]
    said, handler = [], mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(said.append)  # else MuJoCo writes a log file into the working directory
    try:
        model, data = build(scene, settings)
        clock = time.process_time()
        rows, ended = stepping.run(model, data, scene, settings)
        cpu = time.process_time() - clock
    except (Mismatch, mujoco.FatalError) as error:
        return Run(None, 0, math.nan, Failure("MuJoCo does not run the scene", str(error))), math.nan
    finally:
        mujoco.set_mju_user_warning(handler)
    slenderness, peak = scene.block.slenderness, float(np.nanmax(np.abs(rows[:, 2])))
    if isinstance(settings, FirstScript):
        trace = replace(raw_trace_of(rows, scene, FIRST_CONTACT_TILT * slenderness), settle=FIRST_SETTLE)
    else:
        trace = trace_of(rows, scene, _contact_tilt(settings, peak, slenderness))
    failure = _failure(scene, rows, ended, "; ".join(line.strip() for line in said))
    ran = Run(trace, len(rows) - 1, cpu, failure, ended if ended == "overturned" else None)
    return ran, peak / slenderness


def _contact_tilt(chosen: ImpactAware | FixedStep | FirstScript, peak: float, slenderness: float) -> float:
    """Tilt [rad] below which the block counts as in flat contact, in a run with this peak tilt.

    At rest it tilts by up to 1e-6 of gamma. Impact-aware lands up to 5e-6 of gamma beyond level; the smaller this tilt,
    the less is gone of a strongly damped base's jump when e is read: m_b/m .067, n_d c/M 1e4 1/s, e is off by .09 at
    1e-4 of gamma, by 4e-3 at 1e-5. At fixed steps the pivot has sunk, as far as swings go.
    """
    if isinstance(chosen, ImpactAware):
        return slenderness * max(1e-5, 0.04 * chosen.largest_step)
    return max(1e-4, 0.25 * chosen.step) * min(max(peak, 0.1 * slenderness), slenderness)


def _failure(
    scene: Scene, rows: Sequence[Sequence[float]] | np.ndarray, ended: str | None, warned: str
) -> Failure | None:
    """What went wrong in a finished run, or None."""
    failure = failure_of(scene, rows, ended)
    if ended == "not finite":
        return replace(failure, message=f"{failure.message}. {warned}")
    if warned:  # of a bad state, which MuJoCo would reset to the start if it were not told to leave it
        return Failure("MuJoCo warned", warned)
    return failure
