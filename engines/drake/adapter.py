"""Drake's variant: its contact solver decides contact and impact, in double precision. All with drake 1.51.1.

A plant has one time step, so that steps cannot be small at impacts alone: there is a first script only.
"""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import FirstScript, run_of
from .scene import DrakeBodies

if TYPE_CHECKING:
    from analytic import Scene

VARIANTS = {
    "first-script": Variant(
        FirstScript(1e-3),  # Drake's own default
        kind="defaults",
        levels=(5e-3, 2e-3, 1e-3),
        computes="motion, contact, impact and rest",
        imposes="nothing",
    )
}

# Tilt below which the block counts as in flat contact: a corner is met in the step after it has sunk, what a block
# passes in a step or two, so often of gamma a second.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"pydrake": metadata.version("drake")}


def run(scene: Scene, variant: str, settings: FirstScript) -> Run:
    """The `Run` of a scene."""
    edge = PASSING * settings.step * scene.block.slenderness
    return run_of(scene, settings, lambda step: DrakeBodies(scene, step), lambda rows: raw_trace_of(rows, scene, edge))
