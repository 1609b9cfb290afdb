"""Random scenes within the range of a statue, `engines.statue_range`."""

import math

import numpy as np

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start
from analytic.pulses import PULSES
from engines.statue_range import RANGE

DENSITY = (200.0, 2e4)  # kg per m3 of R^3: wood to bronze, hollow or solid
HEAVIEST_BASE = 20.0  # block masses
STIFFER = (2.0, 20.0)  # initial stiffness of a bearing over that after yielding
YIELDS = (1e-2, 1.0)  # displacement at which it yields, over R gamma
PULSE = (0.5, 6.0)  # amplitude over the uplift acceleration, and frequency over omega_r
STARTS = 0.95  # most tilt of a released block over its slenderness


def random_scene(seed: int, index: int) -> Scene:
    """Scene number `index` of the ensemble `seed`: a statue released, or under a pulse, until its outcome is decided.

    A quarter stands on rigid ground, a fifth of the others on a free base. Half of the bearings have viscous damping.
    """
    rng = np.random.default_rng([seed, index])
    block = _block(rng)
    base = bearings = None
    if rng.random() < 0.75:
        base = Base(mass=block.mass * _log(rng, RANGE["base_mass"][0], HEAVIEST_BASE))
        bearings = _bearings(rng, block, base) if rng.random() < 0.8 else None
    scene = Scene(block=block, base=base, bearings=bearings, name=f"random scene {seed}/{index}")
    side = float(rng.choice([-1.0, 1.0]))
    if rng.random() < 0.5:
        return scene.with_(start=Start(tilt=side * block.slenderness * _log(rng, RANGE["tilt"][0], STARTS)))
    omega = scene.rocking_frequency
    amplitude = side * scene.gravity * math.tan(block.slenderness) * _log(rng, *PULSE)
    start = float(rng.choice([0.0, rng.uniform(0, 0.5) / omega]))
    return scene.with_(motion=PulseMotion(str(rng.choice(list(PULSES))), amplitude, omega * _log(rng, *PULSE), start))


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _block(rng: np.random.Generator) -> Block:
    low, high, _ = RANGE["inertia"]
    radius = _log(rng, *RANGE["radius"][:2])
    mass = _log(rng, *DENSITY) * radius**3
    inertia = mass * radius**2 * rng.uniform(low, high) if rng.random() < 0.5 else None  # else a cuboid's, 4/3
    slenderness = float(rng.uniform(*RANGE["slenderness"][:2]))
    return Block(mass=mass, radius=radius, slenderness=slenderness, corner_inertia=inertia)


def _bearings(rng: np.random.Generator, block: Block, base: Base) -> Bearings:
    law, count = str(rng.choice(["algebraic", "linear", "bouc-wen"])), int(rng.integers(1, 9))
    carried = block.mass + base.mass
    omega = 2 * math.pi / _log(rng, *RANGE["period"][:2])
    k = carried * omega**2 / count
    share = rng.uniform(*RANGE["damping"][:2]) if rng.random() < 0.5 else 0.0
    damping = share * 2 * omega * carried / count
    if law == "linear":
        return Bearings(law=law, count=count, ka=k, damping=damping)
    # x = 1/(2 (alpha - 1)): where the algebraic law has lost half of its excess of stiffness
    alpha = 1 + 0.5 / (block.radius * block.slenderness * _log(rng, *YIELDS))
    return Bearings(law=law, count=count, ka=k * _log(rng, *STIFFER), kb=k, alpha=alpha, damping=damping)
