"""What may be different from what was modelled: each change of a scene with its size, by name."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from analytic import SampledMotion, Scene, synthetic_motion
from analytic.bearing import BearingLaw
from analytic.motion import Motion
from analytic.rocking import RockingModel

OTHERS = 100_000  # seeds of the other horizontal, and twice of the vertical component, above those of the first
USUAL_RATIO = 2 / 3  # peak vertical over peak horizontal acceleration, as codes took it for long
ARIAS = 0.95  # of the intensity, after which a tail is cut off
# name, quantity, relative change
BLOCK = (
    ("slenderness ±1 %", "slenderness", 0.01),
    ("size ±1 %", "radius", 0.01),
    ("restitution ±5 %", "restitution", 0.05),
    ("restitution ±1 %", "restitution", 0.01),
    ("restitution ±0.01 %", "restitution", 1e-4),
)
BEARINGS = (
    ("bearing stiffness ka ±10 %", "ka"),
    ("bearing stiffness kb ±10 %", "kb"),
    ("bearing exponent α ±10 %", "alpha"),
)


def changes(scene: Scene, seed: int) -> Iterator[tuple[str, Scene]]:
    """(name, changed scene) of all changes that the scene has room for; both signs have one name.

    scene : with a sampled motion, made of the synthetic one of this seed times a factor.
    """
    motion = scene.motion
    samples, dt = motion.samples, motion.dt

    def shaken(samples):
        return scene.with_(motion=replace(motion, samples=samples))

    for ratio in (USUAL_RATIO, 2 * USUAL_RATIO):
        yield f"vertical motion, V/H {ratio:.2f}", scene.with_(motion=with_vertical(motion, seed, ratio))
    # the plane in which the block rocks, turned against two horizontal components of one peak
    other = synthetic_motion(seed=seed + OTHERS)
    other = other.scaled(motion.peak / other.peak)
    turned = math.cos(math.pi / 6) * samples + math.sin(math.pi / 6) * other.samples
    yield "direction turned by 30°", shaken(turned)
    for factor in (0.99, 1.01):
        yield "scale of the motion ±1 %", scene.with_(motion=motion.scaled(factor))
    intensity = np.cumsum(samples**2)
    kept = int(np.searchsorted(intensity, ARIAS * intensity[-1])) + 1
    yield "cut off at 95 % intensity", shaken(samples[:kept])
    for shift in (-1e-3 * motion.peak, 1e-3 * motion.peak):  # as a baseline corrected otherwise
        yield "baseline off 0.1 % of peak", shaken(samples + shift)
    # every fourth sample, as many catalogues have it
    yield "record's time step 0.02 s", scene.with_(motion=SampledMotion(4 * dt, samples[::4], motion.label))
    for name, key, share in BLOCK:
        value = RockingModel.of(scene).restitution if key == "restitution" else getattr(scene.block, key)
        most = 1.0 if key == "restitution" else math.inf
        for factor in (1 - share, 1 + share):
            yield name, scene.with_(block={key: min(value * factor, most)})
    if scene.bearings:
        yield from _bearings(scene)


def _bearings(scene):
    """Other values of the bearings, and other laws of the same two stiffnesses and characteristic strength."""
    bearings = scene.bearings
    for name, key in BEARINGS:
        for factor in (0.9, 1.1):
            yield name, scene.with_(bearings={key: factor * getattr(bearings, key)})
    yields = BearingLaw.of(bearings).f0 * bearings.ka / (bearings.ka - bearings.kb)
    yield "bilinear bearings", scene.with_(bearings={"law": "bilinear", "alpha": None, "yield_force": yields})
    yield "Bouc-Wen bearings", scene.with_(bearings={"law": "bouc-wen"})


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
