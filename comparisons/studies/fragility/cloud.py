"""A cloud of runs: random blocks under random motions, each with its intensity in every measure.

No two runs share a motion, a block or an intensity, so that runs are independent. Accelerations are evenly spread over
the logarithm, far below and far above what matters: then no intensity sees another choice of motions than the next.
"""

import math
from dataclasses import dataclass

import numpy as np

from analytic import SampledMotion, Scene, load_scene, synthetic_motion
from analytic.caryatid import BASE, BEARINGS, MASS
from analytic.design import properties
from analytic.linear_oscillator import displacement_spectrum
from analytic.motion import Motion

X_MAX = 0.30  # m, what the bearings are built for: Table 1(a) of the paper
PERIOD = properties(BEARINGS, MASS + BASE.mass, X_MAX).period  # s, of isolation, secant at X_MAX
DAMPING = 0.05  # of the spectrum, as catalogues have it
STRETCH = (0.5, 2.0)  # of a motion's time: all synthetic ones have nearly one spectrum
RADII = (0.6, 2.0)  # m
PEAKS = (0.08, 3.0)  # g
# name: (shipped scene, least and greatest slenderness [rad])
SCENES = {"free-standing": ("caryatid-rigid", (0.12, 0.32)), "isolated": ("caryatid-isolated", (0.1, 0.25))}
DRAWN = ("stretch", "radius", "slenderness", "peak")

# PGA and Sa in g, PGV in m/s; g tan(slenderness) is the uplift acceleration, omega_r the rocking frequency
MEASURES = ("PGA", "PGV", "Sa", "PGA/(g tan γ)", "ω_r PGV/(g tan γ)", "Sa/(g tan γ)")
UPLIFT = "PGA/(g tan γ)"


@dataclass(frozen=True, eq=False)
class Cloud:
    """scenes: of n runs. drawn: {what was drawn: (n,)}. measures: {name of `MEASURES`: (n,)}."""

    scenes: tuple[Scene, ...]
    drawn: dict[str, np.ndarray]
    measures: dict[str, np.ndarray]

    def near(self, least: float, most: float) -> np.ndarray:
        """Indices of the runs whose PGA/(g tan γ) lies between the two, in their order."""
        ratio = self.measures[UPLIFT]
        return np.flatnonzero((ratio >= least) & (ratio <= most))


def cloud(shipped: str, slendernesses: tuple[float, float], count: int) -> Cloud:
    """`count` runs of a shipped scene; run k is under the synthetic motion of seed k. Equal counts begin alike."""
    usual = load_scene(shipped).with_(motion=None, duration=None)
    if usual.bearings is not None:
        usual = usual.with_(bearings={"x_max": X_MAX})
    ranges = dict(zip(DRAWN, (STRETCH, RADII, slendernesses, PEAKS), strict=True))
    uniform = np.random.Generator(np.random.PCG64(1)).random((count, len(DRAWN))).T
    drawn = {name: low * (high / low) ** u for (name, (low, high)), u in zip(ranges.items(), uniform, strict=True)}
    scenes = []
    for seed in range(count):
        stretch, radius, slenderness, peak = (float(drawn[name][seed]) for name in DRAWN)
        motion = synthetic_motion(seed=seed)
        samples = motion.samples * (peak * usual.gravity / motion.peak)
        shaking = SampledMotion(motion.dt * stretch, samples, f"{motion.label}, {stretch:.3g} times as slow")
        scenes.append(usual.with_(block={"radius": radius, "slenderness": slenderness}, motion=shaking))
    return Cloud(tuple(scenes), drawn, measures(scenes))


def measures(scenes: list[Scene]) -> dict[str, np.ndarray]:
    """{name of `MEASURES`: (n,)} of scenes with sampled motions."""
    gravity = np.array([scene.gravity for scene in scenes])
    steepness = np.tan([scene.block.slenderness for scene in scenes])
    peak = np.array([scene.motion.peak for scene in scenes]) / gravity
    speed = np.array([peak_velocity(scene.motion) for scene in scenes])
    displacement = np.array([displacement_spectrum(scene.motion, [PERIOD], [DAMPING])[0, 0] for scene in scenes])
    spectral = displacement * (2 * math.pi / PERIOD) ** 2 / gravity
    rocking = np.array([scene.rocking_frequency for scene in scenes])
    values = (peak, speed, spectral, peak / steepness, rocking * speed / (gravity * steepness), spectral / steepness)
    return dict(zip(MEASURES, values, strict=True))


def peak_velocity(motion: Motion) -> float:
    """Peak ground velocity [m/s] of a sampled motion that starts at rest; exact at the samples."""
    steps = 0.5 * motion.dt * (motion.samples[1:] + motion.samples[:-1])
    return float(np.abs(np.cumsum(steps)).max())
