"""What the parts of a scene are built for, and whether a run went beyond it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .response import Caution

if TYPE_CHECKING:
    from .scene import Scene


def limit_warnings(scene: Scene, peak_base_displacement: float) -> tuple[Caution, ...]:
    """A warning where the base moves further [m] than the bearings' x_max."""
    limit = None if scene.bearings is None else scene.bearings.x_max
    if limit is None or not peak_base_displacement > limit:
        return ()
    words = (
        f"the base moves by {peak_base_displacement:.3g} m, beyond the x_max = {limit:.3g} m of its bearings: they may "
        "tear or hit a stop, and the outcome is outside the model"
    )
    return (Caution("limit", words, "peak_base_displacement", peak_base_displacement, limit),)
