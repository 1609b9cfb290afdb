"""DART's variants: its boxed LCP solver computes contact and impact, in double precision. Tested with dartpy 6.20.0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import dartpy

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import RULED, SAMPLED, FirstScript, ImpactAware, run_of
from .scene import DartBodies

if TYPE_CHECKING:
    from analytic import Scene


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        kind="tuned",
        levels=(2e-3, 6e-4, 2e-4, 1e-4),
        computes="motion, contact, impact and rest",
        imposes=RULED,
    ),
    "first-script": Variant(
        FirstScript(1e-3),  # DART's own default
        kind="defaults",
        levels=(5e-3, 1e-3, 2e-4),
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
    ),
}

# Tilt rate, in gamma per second, whose tilt in one step is the flat contact of a first script: contact acts in the step
# after a corner has penetrated, which is passed in one or two steps.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"dartpy": dartpy.__version__}


def run(scene: Scene, variant: str, settings: ImpactAware | FirstScript) -> Run:
    """The `Run` of a scene."""
    plain = isinstance(settings, FirstScript)
    return run_of(
        scene,
        settings,
        lambda step: DartBodies(scene, plain),
        lambda rows: raw_trace_of(rows, scene, PASSING * rows[1, 1] * scene.block.slenderness),
    )
