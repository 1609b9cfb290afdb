"""Warnings on a scene: missing friction, a start beyond balance, and displacements beyond the bearings' x_max."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .response import Caution

if TYPE_CHECKING:
    from .scene import Scene


def scene_warnings(scene: Scene) -> tuple[Caution, ...]:
    """Warnings that precede any outcome of a scene: a base without bearings or friction, a start beyond balance."""
    found, tilt, gamma = [], scene.start.tilt, scene.block.slenderness
    if scene.base is not None and scene.bearings is None:
        words = (
            "No friction is modelled under the base, and it has no bearings: such a base exists in thought experiments "
            "only. Leave it out if the pedestal is fixed to the ground."
        )
        found.append(Caution("model", words))
    if abs(tilt) >= gamma:
        words = (
            f"The block starts at a tilt of {tilt:.4g} rad, past its balance at {gamma:.4g} rad: it falls unless "
            "something brings it back."
        )
        found.append(Caution("limit", words, "start.tilt", tilt, gamma))
    return tuple(found)


def limit_warnings(scene: Scene, peak_base_displacement: float) -> tuple[Caution, ...]:
    """A warning if the peak base displacement [m] exceeds the bearings' x_max."""
    limit = None if scene.bearings is None else scene.bearings.x_max
    if limit is None or not peak_base_displacement > limit:
        return ()
    words = (
        f"the base moves by {peak_base_displacement:.3g} m, beyond the x_max = {limit:.3g} m of its bearings: they may "
        "tear or hit a stop, and the outcome is outside the model"
    )
    return (Caution("limit", words, "peak_base_displacement", peak_base_displacement, limit),)
