"""PyBullet's variants: Bullet computes contact and impact. Tested with PyBullet 3.2.7."""

from __future__ import annotations

import math
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from analytic.response import Caution, Failure

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import GIVEN, MEAN_LOADS, RULED, SAMPLED, FirstScript, FixedStep, ImpactAware, Settings, run_of
from . import calls
from .constants import CONSTANTS
from .first_script import MOST_VELOCITY, FreeBox
from .imported import pybullet
from .scene import FRICTION, BulletBodies

if TYPE_CHECKING:
    from analytic import Scene


TUNED, FIXED = ImpactAware(1e-3, 1e-3), FixedStep(1e-4)
PLAIN = FirstScript(1 / 240)  # Bullet's own default
# Bullet holds the corner by velocities, with the lever (n, -c) of the centre where a step begins: the corner creeps by
# h^2 n phi'^2/2 in a step h. And a slip that turns back within a step keeps one sign of its friction N mu to the end,
# which leaves a velocity of up to 2 N mu h/m. Among 525 drawn scenes with vertical motion that slip by 1e-4 R or more,
# the largest slip is off by 1e-5 in the median, by 3.4 % at most; by half of that with half the step.
CREEPS = (
    "the corner of a rocking block creeps by some 1e-5 R in a swing, and a slip turns back at the end of a step: first "
    "order in the step; a slip below .002 R is up to 4 % off"
)
VARIANTS = {
    "impact-aware": Variant(
        TUNED,
        kind="tuned",
        levels=(7e-3, 3e-3, 1e-3, 5e-4),
        constants=CONSTANTS,
        takes_restitution=True,
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {RULED}; {GIVEN}",
        calls=calls.impact_aware(TUNED),
        faults=CREEPS,
    ),
    "fixed-step": Variant(
        FIXED,
        kind="tuned",
        levels=(4e-3, 1e-3, 2.5e-4, 1e-4),
        finer=({"step": 2e-5},),
        free_block="engines.pybullet.free_block:simulate",
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {MEAN_LOADS}",
        calls=calls.fixed_step(FIXED),
    ),
    "first-script": Variant(  # default damping: e off by .01 to .5 at every step
        PLAIN,
        kind="defaults",
        levels=(1 / 60, 1 / 240, 1 / 1000),
        finer=({"step": 2e-4},),
        friction=0.5 * 0.5,  # the product of the defaults of both bodies
        flight_damping=0.04,  # the default of a multibody
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
        calls=calls.first_script(PLAIN),
    ),
}

FIRST_CONTACT = 1e-3  # tilt below which a first script's block counts as in flat contact, over the slenderness


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pybullet": version("pybullet"), "bullet-api": str(pybullet.getAPIVersion())}


def run(scene: Scene, variant: str, settings: Settings) -> Run:
    """The `Run` of a scene."""
    plain, edge, friction = isinstance(settings, FirstScript), FIRST_CONTACT * scene.block.slenderness, scene.friction
    client = pybullet.connect(pybullet.DIRECT)
    try:
        ran = run_of(
            scene,
            settings,
            lambda step: FreeBox(client, scene, step) if plain else BulletBodies(client, scene),
            lambda rows: raw_trace_of(rows, scene, edge),
            depth=0.0,  # contacts act before penetration
        )
    except pybullet.error as error:
        return Run(None, 0, math.nan, Failure("Bullet raised an error", str(error)))
    finally:
        pybullet.disconnect(client)
    if plain:
        return _limited(ran)
    if friction is not None and friction > FRICTION:
        words = f"friction = {friction:.4g} is above {FRICTION:g}: Bullet takes it as {FRICTION:g}"
        ran = replace(ran, warnings=(Caution("engine", words, "friction", friction, FRICTION),))
    return ran


def _limited(ran: Run) -> Run:
    """A first script's run, failed where Bullet may have limited a velocity, as it does without a message."""
    if ran.trace is None or ran.failure:
        return ran
    fastest = max(np.abs(ran.trace.tilt_rate).max(), np.abs(ran.trace.base_velocity).max())
    if fastest <= 0.1 * MOST_VELOCITY:
        return ran
    words = f"{fastest:.3g} m/s or rad/s; its limit: {MOST_VELOCITY:g}"
    return replace(ran, failure=Failure("Bullet limits velocities", words))
