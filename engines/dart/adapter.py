"""DART's variants: its boxed LCP decides contact and impact, in double precision. All with dartpy 6.20.0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import dartpy

from ..contract import Run, Variant
from ..leapfrog import raw_trace_of
from ..stepping import FirstScript, ImpactAware, run_of
from ..verified import Range
from .scene import DartBodies

if TYPE_CHECKING:
    from analytic import Scene

DECIDES = (
    "DART decides when a corner lands, sticks or lifts, what an impact does and how bodies move; the block is a free "
    "box in space. The adapter gives it the bearings' force and the ground's acceleration"
)

VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        rung="best",
        ladder=(1e-3, 5e-4, 2e-4, 1e-4),
        decides=f"{DECIDES}, split impulses, and the steps by a rule on gaps and closing speeds.",
        verified=Range(slenderness=(0.1, 0.5), inertia=(1.2, 2.0), base_mass=(0.05, 100.0), radius=(0.1, 10.0)),
    ),
    "first-script": Variant(
        FirstScript(1e-3),  # DART's own default
        rung="first script",
        ladder=(5e-3, 1e-3, 2e-4),
        decides=f"{DECIDES}, in equal steps.",
        verified=None,
        caveats=(
            "dart first-script is verified in no range: it meets an impact up to a step late, and its restitution is "
            "off by up to .016 at DART's default of 1 ms",
        ),
    ),
}

# Tilt below which the block counts as in flat contact in a first script: a corner is met in the step after it has sunk,
# what a block passes in a step or two, so often of gamma a second.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
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
