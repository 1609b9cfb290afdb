"""PyBullet's variants: Bullet computes contact and impact. Tested with PyBullet 3.2.7."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from analytic.response import Caution, Failure

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import Bodies, FirstScript, FixedStep, ImpactAware, Settings, run_of
from . import first_script
from .constants import CONSTANTS
from .imported import pybullet
from .scene import MOST_FRICTION, MOST_VELOCITY, BulletBodies

if TYPE_CHECKING:
    from analytic import Scene


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(1e-3, 1e-3),
        kind="tuned",
        levels=(7e-3, 3e-3, 1e-3, 5e-4),
        constants=CONSTANTS,
        takes_restitution=True,
        computes="motion, contact, impact and rest",
        imposes="a plane, by joints; the steps, by gaps and closing speeds; restitution given: a couple before each "
        "landing",
    ),
    "fixed-step": Variant(
        FixedStep(1e-4),
        kind="tuned",
        levels=(4e-3, 1e-3, 2.5e-4, 1e-4),
        finer=({"step": 2e-5},),
        free_block="engines.pybullet.free_block:simulate",
        computes="motion, contact, impact and rest",
        imposes="a plane, by joints",
    ),
    "first-script": Variant(  # default damping: e off by .01 to .5 at every step
        FirstScript(1 / 240),  # Bullet's own default
        kind="defaults",
        levels=(1 / 60, 1 / 240, 1 / 1000),
        finer=({"step": 2e-4},),
        friction=0.5 * 0.5,  # the product of the defaults of both bodies
        flight_damping=0.04,  # the default of a multibody
        computes="motion, contact, impact and rest",
        imposes="nothing",
    ),
}

FIRST_CONTACT = 1e-3  # tilt below which a first script's block counts as in flat contact, over the slenderness


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pybullet": version("pybullet"), "bullet-api": str(pybullet.getAPIVersion())}


def run(scene: Scene, variant: str, settings: Settings) -> Run:
    """The `Run` of a scene."""
    plain, edge, friction = isinstance(settings, FirstScript), FIRST_CONTACT * scene.block.slenderness, scene.friction
    kind: Callable[..., Bodies] = first_script.FreeBox if plain else BulletBodies
    client = pybullet.connect(pybullet.DIRECT)
    try:
        ran = run_of(
            scene,
            settings,
            lambda step: kind(client, scene, step),
            lambda rows: raw_trace_of(rows, scene, edge),
            depth=0.0,  # contacts act before penetration
        )
    except pybullet.error as error:
        return Run(None, 0, math.nan, Failure("Bullet raised an error", str(error)))
    finally:
        pybullet.disconnect(client)
    if friction is not None and friction > MOST_FRICTION and not plain:
        words = f"friction = {friction:.4g} is above {MOST_FRICTION:g}: Bullet takes it as {MOST_FRICTION:g}"
        ran = replace(ran, warnings=(Caution("engine", words, "friction", friction, MOST_FRICTION),))
    if ran.trace is None or ran.failure:
        return ran
    fastest = max(np.abs(ran.trace.tilt_rate).max(), np.abs(ran.trace.base_velocity).max())
    limit = first_script.MOST_VELOCITY if plain else MOST_VELOCITY
    if fastest > 0.1 * limit:
        words = f"{fastest:.3g} m/s or rad/s; its limit: {limit:g}"
        return replace(ran, failure=Failure("Bullet limits velocities", words))
    return ran
