"""MuJoCo's variants: its soft constraint solver computes contact and impact.

A MuJoCo contact is a spring and damper per unit of mass (solref: k, b), scaled by an impedance d < 1 (solimp). In each
step it gives a corner the acceleration (1 - d) a0 - d (b v + k r), with penetration r, velocity v and free acceleration
a0. There is no coefficient of restitution. With b = 1/step a corner stops in the step after it has penetrated, whatever
its velocity. The impact is then that of eq. (7), as the other corner may lift in the same solve. k only has to remove
the penetration slowly.

Tested with mujoco 4.0.0; diagexact needs 3.9.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import mujoco

from analytic.response import Failure

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import GIVEN, MEAN_LOADS, RULED, SAMPLED, FirstScript, FixedStep, ImpactAware, Settings, run_of
from .scene import build

if TYPE_CHECKING:
    from analytic import Scene


# tests/engines/test_physics.py shows it: friction and contact are one convex problem, in which a sliding contact opens.
SLIPPING = (
    "a corner that slides rises, the faster the higher, by some millimetres at 1 m/s: a block whose friction is below "
    "tan γ, which can only slide, rocks and may overturn; an impact in which the corner slides has a restitution near 1"
)

VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        kind="tuned",
        levels=(2e-3, 6e-4, 2e-4, 1e-4),
        takes_restitution=True,
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {RULED}; {GIVEN}",
        faults=SLIPPING,
    ),
    "fixed-step": Variant(
        FixedStep(1e-4),
        kind="tuned",
        levels=(4e-3, 1e-3, 1e-4),
        finer=({"step": 2e-5},),
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {MEAN_LOADS}",
        faults=SLIPPING,
    ),
    "first-script": Variant(
        FirstScript(2e-3),  # MuJoCo's own default
        kind="defaults",
        levels=(1 / 120, 2e-3, 5e-4),
        finer=({"step": 2e-4},),
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {SAMPLED}",
    ),
}

# Tilt below which the block counts as in flat contact, over the slenderness, and relaxation time [s], both of the
# default contact, which penetrates by .02 of gamma and has a time constant of .02 s.
FIRST_CONTACT, FIRST_SETTLE = 0.05, 0.1


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"mujoco": mujoco.__version__, "mujoco-library": mujoco.mj_versionString()}


def run(scene: Scene, variant: str, settings: Settings) -> Run:
    """The `Run` of a scene."""
    edge = FIRST_CONTACT * scene.block.slenderness
    said: list[str] = []
    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(said.append)  # otherwise MuJoCo writes a log file into the working directory
    try:
        ran = run_of(
            scene,
            settings,
            lambda step: build(scene, step, isinstance(settings, FirstScript)),
            lambda rows: replace(raw_trace_of(rows, scene, edge), settle=FIRST_SETTLE),
        )
    except mujoco.FatalError as error:
        return Run(None, 0, 0.0, Failure("MuJoCo does not run the scene", str(error)))
    finally:
        mujoco.set_mju_user_warning(handler)
    if not said:
        return ran
    words = "; ".join(line.strip() for line in said)  # of a bad state, at which MuJoCo would reset to the start
    message = f"{ran.failure.message}. {words}" if ran.failure else words
    return replace(ran, failure=Failure(ran.failure.reason if ran.failure else "MuJoCo warned", message))
