"""Drake's variant: its contact solver computes contact and impact, in double precision. Tested with drake 1.51.1.

A plant has one fixed time step, so that steps cannot be shortened at impacts: there is only a first script.
"""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import SAMPLED, FirstScript, run_of
from .scene import DrakeBodies

if TYPE_CHECKING:
    from analytic import Scene

VARIANTS = {
    "first-script": Variant(
        FirstScript(1e-3),  # Drake's own default
        kind="defaults",
        levels=(5e-3, 2e-3, 1e-3),
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
    )
}

# Tilt rate, in gamma per second, whose tilt in one step counts as flat contact: contact acts in the step after a corner
# has penetrated, which is passed in one or two steps.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pydrake": metadata.version("drake")}


def run(scene: Scene, variant: str, settings: FirstScript) -> Run:
    """The `Run` of a scene."""
    edge = PASSING * settings.step * scene.block.slenderness
    return run_of(scene, settings, lambda step: DrakeBodies(scene, step), lambda rows: raw_trace_of(rows, scene, edge))
