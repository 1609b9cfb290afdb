"""exudyn's variants, and checks of a run that exudyn's solver does not make."""

from __future__ import annotations

import platform
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from analytic.bearing import BearingLaw
from analytic.response import Failure, State

from ..checks import replay_bearing
from ..contract import Variant
from . import calls, corners, native
from .constants import CONSTANTS

if TYPE_CHECKING:
    from analytic import Scene

    from ..contract import Run
    from .native import NativeContact
    from .sizing import CompliantCorners

# Replayed bearing force, over f0: round-off stays below 1e-12.
REPLAY_LIMIT = 1e-9

LOADS = "ground: its acceleration at the step's end"
CHORD = "bearings: within a step a spring along the law's chord"
_MODULES = {"compliant-corners": corners, "native-contact": native}
TUNED, NATIVE = corners.CompliantCorners(), native.NativeContact()
# Such an impact lasts, and the block slides meanwhile; stiffer corners or shorter steps change nothing, a tenth of
# `rebound` or `slip` leaves .3 to .9 of the error. Among 264 drawn scenes with vertical motion that slip by 1e-4 R or
# more, the largest slip is off by 3e-5 in the median, by more than 2 % (and 1e-4 R) in 4.
SLIDES_INTO_IMPACTS = (
    "an impact into which the block slides is up to .02 off in e, and the slip after it by up to 6e-4 R"
)
VARIANTS = {
    "compliant-corners": Variant(
        TUNED,
        kind="tuned",
        calls=calls.compliant_corners(TUNED),
        levels=(1e9, 1e10, 2e11, 1e12),
        finer=(
            {"stiffness": 1e12, "pivoting_step": 2e-4},
            {"stiffness": 1e12, "pivoting_step": 2e-4, "tolerance": 1e-9},
        ),
        varied={
            "stiffness": (1e8, 1e9, 1e10, 1e11, 1e12),
            "rebound": (1e-4, 1e-3, 1e-2, 1e-1),
            "sticking": (0.03, 0.1, 0.3, 1.0),
            "damping": (0.1, 0.5, 1.0),
            "friction": (0.05, 0.1, 0.15, 0.2, 0.3, 0.6, 5.0),
        },
        constants=CONSTANTS,
        takes_restitution=True,
        computes="motion, contact, impact and rest, by integration",
        imposes="contact law: ours (Hunt-Crossley, Coulomb, viscous at low speed, plastic as Housner assumes: "
        "agreement verifies law and integration); a plane; steps: explicit through impacts, implicit between; start: "
        f"with the motion, on corners deflected by what they carry; {LOADS}, of explicit steps its mean; {CHORD}; "
        "restitution given: a couple before each landing",
        faults=SLIDES_INTO_IMPACTS,
    ),
    "native-contact": Variant(
        NATIVE,
        kind="defaults",
        calls=calls.native_contact(NATIVE),
        levels=(1e-3, 3e-4, 1e-4),
        finer=({"step": 5e-5},),
        computes="motion, contact, impact and rest",
        imposes=f"a plane; {LOADS}; {CHORD}",
        faults="the solver may give up some seconds after the motion, with the block at rest",
    ),
}


def versions() -> dict[str, str]:
    """Versions that determine the result."""
    return {"exudyn": version("exudyn"), "python": platform.python_version()}


def run(scene: Scene, variant: str, settings: CompliantCorners | NativeContact) -> Run:
    """The `Run` of a scene.

    Raises
    ------
    Mismatch
        exudyn holds other values than the scene asks for; nothing was run.
    """
    ran = _MODULES[variant].run(scene, settings)
    if ran.trace is None:
        failure = replace(ran.failure or Failure("the run ended before its first step"), last_state=_start(scene))
        return replace(ran, failure=failure, steps=max(ran.steps, 0))
    return replace(ran, failure=ran.failure or _fault(scene, ran))


def _fault(scene: Scene, run: Run) -> Failure | None:
    """The failure of a run that exudyn reported as successful, or None."""
    if not all(np.isfinite(getattr(run.trace, name)).all() for name in run.trace.COLUMNS):
        return None  # observe reports it, with the last finite state
    difference = replay_bearing(scene, run.trace)
    if difference > REPLAY_LIMIT:
        return Failure("the bearing force is not the law's", f"it differs by {difference:.3g} f0 when replayed")
    return None


def _start(scene: Scene) -> State:
    law, start = BearingLaw.of(scene.bearings), scene.start
    x, v = start.base_displacement, start.base_velocity
    return State(0.0, start.tilt, start.tilt_rate, x, v, float(law.force(x, law.start(x), v)))
