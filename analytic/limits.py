"""Warnings on a scene: missing friction, a start beyond balance, a base beyond x_max, a block that slips off."""

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


def limit_warnings(scene: Scene, peak_base_displacement: float, peak_slip: float = 0.0) -> tuple[Caution, ...]:
    """Warnings if the peak base displacement [m] exceeds the bearings' x_max, or the peak slip [m] the half width.

    peak_slip : 0 of a block that overturns, whose slip goes on in its fall.
    """
    found = []
    limit = None if scene.bearings is None else scene.bearings.x_max
    if limit is not None and peak_base_displacement > limit:
        words = (
            f"the base moves by {peak_base_displacement:.3g} m, beyond the x_max = {limit:.3g} m of its bearings: they "
            "may tear or hit a stop, and the outcome is outside the model"
        )
        found.append(Caution("limit", words, "peak_base_displacement", peak_base_displacement, limit))
    if peak_slip > scene.block.half_width:
        words = (
            f"the block slips by {peak_slip:.3g} m, beyond its half width of {scene.block.half_width:.3g} m: the "
            "model's support has no edge, and from one as wide as the block it would fall"
        )
        found.append(Caution("limit", words, "peak_slip", peak_slip, scene.block.half_width))
    return tuple(found)
