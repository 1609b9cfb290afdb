"""Random scenes over a wide box: where may an engine be trusted, and where must it warn?

The box: slenderness .03 to 1.2; J_O/(m R^2) 1.01 to 3, a quarter of them 4/3; R 1 mm to 30 m; block 1 g to 1e6 kg;
rigid ground or a base of 1e-5 to 100 block masses; bearings of all laws from soft (a fifth of omega_r) to 1e9 N/m each,
or none; viscous damping 0 or up to 1e6 N s/m; released at 1e-4 to .99 of the slenderness, or at rest under a pulse
of .3 to 10 times the uplift acceleration at .5 to 10 omega_r. A third of the scenes lies in the core range (`is_core`).
"""

import math
from typing import Any

import numpy as np

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start
from analytic.motion import PULSES

SLENDERNESS, INERTIA, BASE, RADIUS, MASS = (0.03, 1.2), (1.01, 3.0), (1e-5, 100.0), (1e-3, 30.0), (1e-3, 1e6)
# Within these nothing may be warned of; a base weighs at least CORE_BASE blocks, or there is none.
CORE_SLENDERNESS, CORE_INERTIA, CORE_BASE, CORE_SHARE = (0.1, 0.45), (1.2, 2.0), 0.05, 1 / 3
TILT = (1e-4, 0.99)  # over slenderness
MOST_STIFFNESS, MOST_DAMPING = 1e9, 1e6  # of a bearing: N/m, N s/m
DENSITY = (200.0, 2e4)  # kg per m3 of R^3: masses that go with the size
ALPHA = (1.5, 1e5)  # of a bearing; it yields at 1/(2 (alpha - 1)) m


def wide_scene(seed: int, index: int) -> Scene:
    """Scene number `index` of the ensemble `seed`."""
    rng = np.random.default_rng([seed, index])
    core = rng.random() < CORE_SHARE
    block = _block(rng, core)
    omega = math.sqrt(block.mass * 9.81 * block.radius / block.inertia)
    base = bearings = None
    if rng.random() < 0.75:
        base = Base(mass=block.mass * _log(rng, CORE_BASE if core else BASE[0], BASE[1]))
        if rng.random() < 0.8:
            bearings = _bearings(rng, block, base, omega)
    period = 2 * math.pi / omega
    motion, start = None, Start()
    if rng.random() < 0.5:
        tilt = _log(rng, *TILT) if rng.random() < 0.5 else float(rng.uniform(*TILT))
        start = Start(tilt=float(rng.choice([-1.0, 1.0])) * tilt * block.slenderness)
        swing = 4 / omega * math.acosh(1 / (1 - tilt))  # of a slender block, there and back
        duration = min(rng.uniform(1, 3) * period, rng.uniform(4, 12) * swing)
    else:
        amplitude = 9.81 * math.tan(block.slenderness) * _log(rng, 0.3, 10.0)
        motion = PulseMotion(
            str(rng.choice(PULSES)),
            float(rng.choice([-1.0, 1.0])) * amplitude,
            omega * _log(rng, 0.5, 10.0),
            float(rng.choice([0.0, rng.uniform(0, 0.5) / omega])),
        )
        duration = motion.end + rng.uniform(0.5, 2) * period
    return Scene(
        block=block,
        base=base,
        bearings=bearings,
        motion=motion,
        start=start,
        duration=float(duration),
        name=f"wide scene {seed}/{index}",
    )


def is_core(scene: Scene) -> bool:
    """Whether a scene lies in the core range, where nothing may be warned of."""
    block = scene.block
    inertia = block.inertia / (block.mass * block.radius**2)
    return (
        CORE_SLENDERNESS[0] <= block.slenderness <= CORE_SLENDERNESS[1]
        and CORE_INERTIA[0] <= inertia <= CORE_INERTIA[1]
        and (scene.base is None or scene.base.mass >= CORE_BASE * block.mass)
    )


def place(scene: Scene) -> dict[str, Any]:
    """Where in the box a scene lies: {quantity: value}, None where it has none.

    frequency: of the base on its bearings, sqrt(n_d k_a/m_b), and damping: n_d c/m_b, both over omega_r.
    """
    block, base, bearings, omega = scene.block, scene.base, scene.bearings, scene.rocking_frequency
    spot = {
        "slenderness": block.slenderness,
        "inertia": block.inertia / (block.mass * block.radius**2),
        "radius": block.radius,
        "mass": block.mass,
        "base": base and base.mass / block.mass,
        "law": bearings and bearings.law,
        "stiffness": bearings and bearings.ka,
        "frequency": bearings and math.sqrt(bearings.count * bearings.ka / base.mass) / omega,
        "damping": bearings and bearings.count * bearings.damping / base.mass / omega,
        "tilt": abs(scene.start.tilt) / block.slenderness or None,
        "pulse": scene.motion and scene.motion.shape,
        "core": is_core(scene),
    }
    if scene.motion is not None:
        spot["amplitude"] = abs(scene.motion.amplitude) / (scene.gravity * math.tan(block.slenderness))
    return spot


def _log(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _block(rng, core):
    radius = _log(rng, *RADIUS)
    # Half weigh what stone, wood or metal of their size would, half anything.
    mass = _log(rng, *DENSITY) * radius**3 if rng.random() < 0.5 else _log(rng, *MASS)
    mass = min(max(mass, MASS[0]), MASS[1])
    inertia = None
    if rng.random() < 0.75:
        low, high = CORE_INERTIA if core else INERTIA
        # evenly in the log of what exceeds the point mass: near it the engines have it hardest
        inertia = mass * radius**2 * (1 + _log(rng, low - 1, high - 1))
    slenderness = float(rng.uniform(*(CORE_SLENDERNESS if core else SLENDERNESS)))
    return Block(mass=mass, radius=radius, slenderness=slenderness, corner_inertia=inertia)


def _bearings(rng, block, base, omega):
    law, count = str(rng.choice(["algebraic", "linear", "bouc-wen"])), int(rng.integers(1, 9))
    carried = block.mass + base.mass
    ka = _log(rng, min(carried * (0.2 * omega) ** 2 / count, 0.1 * MOST_STIFFNESS), MOST_STIFFNESS)
    damping = 0.0
    if rng.random() < 0.5:
        damping = _log(rng, min(1e-2 * math.sqrt(ka * carried / count), 0.1 * MOST_DAMPING), MOST_DAMPING)
    if law == "linear":
        return Bearings(law=law, count=count, ka=ka, damping=damping)
    length = block.radius * block.slenderness * _log(rng, 1e-3, 10.0)  # at which it yields
    alpha = min(max(1 + 0.5 / length, ALPHA[0]), ALPHA[1])
    return Bearings(law=law, count=count, ka=ka, kb=ka * _log(rng, 0.01, 0.9), alpha=alpha, damping=damping)
