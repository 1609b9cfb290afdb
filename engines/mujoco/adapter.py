"""MuJoCo's variants: its soft constraint solver decides contact and impact.

A MuJoCo contact is a spring and damper per unit of mass (solref: k, b), scaled by an impedance d < 1 (solimp): each
step it gives a corner the acceleration (1 - d) a0 - d (b v + k r), at its sink r, speed v and free acceleration a0. It
knows no restitution. With b = 1/step a corner stops in the step after it has sunk, whatever its speed, and the impact
is that of eq. (7): the old corner is free to lift in the same solve. k must only undo the sink, gently.

All with mujoco 4.0.0; diagexact needs 3.9.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import mujoco

from analytic.response import Failure

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import FirstScript, FixedStep, ImpactAware, Settings, run_of
from ..verified import Range
from .scene import build

if TYPE_CHECKING:
    from analytic import Scene

DECIDES = (
    "MuJoCo decides when a corner lands, sticks or lifts, what an impact does and how bodies move. The adapter gives "
    "it the bearings' force, the ground's acceleration, contact stiffness and damping"
)

VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        rung="best",
        ladder=(1e-3, 5e-4, 2e-4, 1e-4),
        decides=f"{DECIDES}, and the steps by a rule on gaps and closing speeds.",
        verified=Range(slenderness=(0.1, 0.5), inertia=(1.2, 2.0), base_mass=(0.05, 100.0), radius=(0.1, 10.0)),
    ),
    "fixed-step": Variant(
        FixedStep(1e-4),
        rung="expert",
        ladder=(4e-3, 1e-3, 1e-4),
        finer=({"step": 2e-5},),
        decides=f"{DECIDES}, in equal steps.",
        verified=Range(slenderness=(0.1, 0.45), inertia=(1.2, 2.0), base_mass=(0.05, 100.0), radius=(0.1, 10.0)),
    ),
    "first-script": Variant(
        FirstScript(2e-3),  # MuJoCo's own default
        rung="first script",
        ladder=(1 / 120, 2e-3, 5e-4),
        finer=({"step": 2e-4},),
        decides="MuJoCo decides all, impacts by its default contact. The adapter gives it the loads, in equal steps.",
        verified=None,
        caveats=(
            "mujoco first-script is verified in no range: MuJoCo's default contact loses too much or too little "
            "of the tilt rate, whatever the step",
        ),
    ),
}

# Tilt below which the block counts as in flat contact, over the slenderness, and time [s] to relax: of the default
# contact, which sinks by .02 of gamma and has a time constant of .02 s.
FIRST_CONTACT, FIRST_SETTLE = 0.05, 0.1


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"mujoco": mujoco.__version__, "mujoco-library": mujoco.mj_versionString()}


def run(scene: Scene, variant: str, settings: Settings) -> Run:
    """The `Run` of a scene."""
    edge = FIRST_CONTACT * scene.block.slenderness
    said: list[str] = []
    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(said.append)  # else MuJoCo writes a log file into the working directory
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
    words = "; ".join(line.strip() for line in said)  # of a bad state, which MuJoCo would else reset to the start
    message = f"{ran.failure.message}. {words}" if ran.failure else words
    return replace(ran, failure=Failure(ran.failure.reason if ran.failure else "MuJoCo warned", message))
