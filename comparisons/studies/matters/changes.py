"""What may be different from what was modelled: each change of a scene with its size, by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from analytic import SampledMotion, synthetic_motion
from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.types import Motion

OTHERS = 100_000  # seeds of the other horizontal, and twice of the vertical component, above those of the first
USUAL_RATIO = 2 / 3  # peak vertical over peak horizontal acceleration, as codes took it for long
ARIAS = 0.95  # of the intensity, after which a tail is cut off


def changes(scene: Scene, seed: int) -> Iterator[tuple[str, Scene]]:
    """(name, changed scene) of all changes that the scene has room for; both signs have one name.

    scene : with a sampled motion, made of the synthetic one of this seed times a factor.
    """
    for name, change in (*MOTIONS.items(), *BLOCKS.items(), *(BEARINGS.items() if scene.bearings else ())):
        for changed in change(scene, seed):
            yield name, changed


def _upright(ratio: float) -> Callable[[Scene, int], list[Scene]]:
    def change(scene, seed):
        return [scene.with_(motion=with_vertical(scene.motion, seed, ratio))]

    return change


def with_vertical(motion: Motion, seed: int, ratio: float, faster: float = 1.0) -> SampledMotion:
    """A sampled motion with a vertical one of another seed: peak `ratio` of its own, in time `faster` times as fast.

    What is faster keeps the time of its peak.
    """
    up = synthetic_motion(seed=seed + 2 * OTHERS)
    times = np.arange(len(motion.samples)) * motion.dt
    samples = up.acceleration(up.peak_time + faster * (times - up.peak_time))
    samples = samples * (ratio * motion.peak / np.abs(samples).max())
    vertical = SampledMotion(motion.dt, samples, f"{up.label}, {faster:g} times as fast")
    return SampledMotion(motion.dt, motion.samples, motion.label, motion.warnings, vertical)


def _turned(scene, seed):
    """The direction in which the block may rock, turned by 30 degrees against the two horizontal components."""
    other = synthetic_motion(seed=seed + OTHERS)
    other = other.scaled(scene.motion.peak / other.peak)
    samples = math.cos(math.pi / 6) * scene.motion.samples + math.sin(math.pi / 6) * other.samples
    return [scene.with_(motion=replace(scene.motion, samples=samples))]


def _scaled(scene, seed):
    return [scene.with_(motion=scene.motion.scaled(factor)) for factor in (0.99, 1.01)]


def _shortened(scene, seed):
    samples = scene.motion.samples
    intensity = np.cumsum(samples**2)
    kept = int(np.searchsorted(intensity, ARIAS * intensity[-1])) + 1
    return [scene.with_(motion=replace(scene.motion, samples=samples[:kept]))]


def _drifting(scene, seed):
    """As a baseline corrected otherwise: the acceleration off by a thousandth of its peak throughout."""
    shift = 1e-3 * scene.motion.peak
    return [scene.with_(motion=replace(scene.motion, samples=scene.motion.samples + sign * shift)) for sign in (-1, 1)]


def _coarser(scene, seed):
    """Every fourth sample, .02 s apart, as many catalogues have it."""
    motion = scene.motion
    return [scene.with_(motion=SampledMotion(4 * motion.dt, motion.samples[::4], motion.label))]


def _block(key: str, share: float) -> Callable[[Scene, int], list[Scene]]:
    def change(scene, seed):
        value = RockingModel.of(scene).restitution if key == "restitution" else getattr(scene.block, key)
        factors = (1 - share, 1 + share)
        most = 1.0 if key == "restitution" else math.inf
        return [scene.with_(block={key: min(value * factor, most)}) for factor in factors]

    return change


def _bearing(key: str) -> Callable[[Scene, int], list[Scene]]:
    def change(scene, seed):
        value = getattr(scene.bearings, key)
        return [scene.with_(bearings={key: factor * value}) for factor in (0.9, 1.1)]

    return change


def _bilinear(scene, seed):
    """The same two stiffnesses and the same characteristic strength."""
    bearings = scene.bearings
    strength = BearingLaw.of(bearings).f0
    yields = strength * bearings.ka / (bearings.ka - bearings.kb)
    return [scene.with_(bearings={"law": "bilinear", "alpha": None, "yield_force": yields})]


def _bouc_wen(scene, seed):
    return [scene.with_(bearings={"law": "bouc-wen"})]


MOTIONS = {
    f"vertical motion, {USUAL_RATIO:.2f} of the horizontal": _upright(USUAL_RATIO),
    f"vertical motion, {2 * USUAL_RATIO:.2f} of the horizontal": _upright(2 * USUAL_RATIO),
    "direction turned by 30°": _turned,
    "scale of the motion ±1 %": _scaled,
    "tail cut off after 95 % of its intensity": _shortened,
    "baseline off by 0.1 % of the peak": _drifting,
    "time step of the record 0.02 s": _coarser,
}
BLOCKS = {
    "slenderness ±1 %": _block("slenderness", 0.01),
    "size ±1 %": _block("radius", 0.01),
    "restitution ±5 %": _block("restitution", 0.05),
    "restitution ±1 %": _block("restitution", 0.01),
    "restitution ±0.01 %": _block("restitution", 1e-4),
}
BEARINGS = {
    "bearing stiffness ka ±10 %": _bearing("ka"),
    "bearing stiffness kb ±10 %": _bearing("kb"),
    "bearing exponent alpha ±10 %": _bearing("alpha"),
    "bilinear bearings": _bilinear,
    "Bouc-Wen bearings": _bouc_wen,
}
