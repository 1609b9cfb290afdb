"""pymunk's variants: Chipmunk's iterative contact solver computes contact and impact, in 2-D and double precision.

Tested with pymunk 7.3.1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pymunk

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import RULED, SAMPLED, FirstScript, ImpactAware, run_of, step_limits
from .scene import ChipmunkBodies

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
        FirstScript(1 / 240),  # four steps per frame; pymunk has no default step
        kind="defaults",
        levels=(1 / 60, 1 / 240, 1e-3),
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
    ),
}

# Tilt below which the block counts as in flat contact in a first script, over the slenderness: with the default slop
# corners penetrate, at rest by up to 3e-3.
FIRST_CONTACT = 1e-2


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pymunk": pymunk.version, "chipmunk": pymunk.chipmunk_version}


def run(scene: Scene, variant: str, settings: ImpactAware | FirstScript) -> Run:
    """The `Run` of a scene."""
    edge = FIRST_CONTACT * scene.block.slenderness
    first, plain = step_limits(scene, settings)[1], isinstance(settings, FirstScript)
    return run_of(
        scene,
        settings,
        lambda largest: ChipmunkBodies(scene, first, plain),
        lambda rows: raw_trace_of(rows, scene, edge),
    )
