"""Random valid scenes, extremes included; `comparisons.ensembles` draws others within the range of a statue."""

import math

import numpy as np
from bearing_laws import to_law

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start
from analytic.motion import PULSES
from analytic.rocking import BearingLaw

LAWS = ("algebraic", "linear", "bouc-wen")


def random_scene(seed, index, laws=LAWS):
    """Scene number `index` of the ensemble `seed`, its bearings of one of the laws.

    Parameters cover what a scene may hold, extremes included.
    """
    rng = np.random.default_rng([seed, index])
    block = _block(rng)
    omega = math.sqrt(block.mass * 9.81 * block.radius / block.inertia)
    base = Base(mass=float(block.mass * _log(rng, 1e-4, 1e3))) if rng.random() < 0.7 else None
    bearings = _bearings(rng, block.mass + base.mass, laws) if base and rng.random() < 0.85 else None
    motion = _motion(rng, omega, 9.81 * math.tan(block.slenderness))
    duration = min(rng.uniform(0.5, 15) * 2 * math.pi / omega, 40.0)
    return Scene(
        block=block,
        base=base,
        bearings=bearings,
        motion=motion,
        duration=float(duration),
        start=_start(rng, block, omega, base),
        name=f"random scene {seed}/{index}",
    )


def _log(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _block(rng):
    mass, radius = _log(rng, 1.0, 1e5), _log(rng, 0.05, 20.0)
    inertia, restitution = None, None
    if rng.random() < 0.3:
        inertia = float(mass * radius**2 * (1 + _log(rng, 1e-3, 3.0)))
    if rng.random() < 0.3:
        restitution = float(rng.choice([0.0, 1.0, rng.uniform(), 1 - _log(rng, 1e-8, 1e-1)]))
    return Block(
        mass=mass,
        radius=radius,
        slenderness=float(rng.uniform(0.02, 1.5)),
        corner_inertia=inertia,
        restitution=restitution,
    )


def _bearings(rng, carried, laws):
    law, count = str(rng.choice(laws)), int(rng.integers(1, 9))
    frequency = _log(rng, 0.3, 60.0)
    ka = carried * frequency**2 / count
    dk = ka * _log(rng, 1e-9, 0.999)
    viscous = 0.0 if rng.random() < 0.5 else 2 * rng.uniform(0, 0.5) * frequency * carried / count
    if law == "linear":
        return Bearings(law=law, count=count, ka=ka, damping=viscous)
    delta = 1e-20 if rng.random() < 0.5 else (ka - (ka - dk)) * _log(rng, 1e-20, 1e-2)
    kb = 0.0 if rng.random() < 0.05 else ka - dk
    made = Bearings(count=count, ka=ka, kb=kb, alpha=1 + _log(rng, 0.05, 199.0), delta_k=delta, damping=viscous)
    if law == "bilinear":
        delta = 1e-20
    changes = {**to_law(law, ka, kb, BearingLaw.of(made).f0), "delta_k": delta}
    return Bearings(**made.model_dump() | changes)


def _motion(rng, omega, unit):
    kind, amplitude = rng.random(), float(unit * _log(rng, 0.1, 10.0) * rng.choice([-1.0, 1.0]))
    if kind < 0.1:
        return None
    if rng.random() < 0.05:  # touches the uplift threshold to the last bit
        amplitude = math.copysign(unit, amplitude)
    if kind < 0.55:
        return PulseMotion(
            str(rng.choice(list(PULSES))),
            amplitude,
            omega * _log(rng, 0.3, 10.0),
            float(rng.choice([0.0, rng.uniform(0, 2)])),
        )
    samples = rng.standard_normal(int(rng.integers(2, 400)))
    if rng.random() < 0.5:  # smoother: each sample near the last one
        samples = np.cumsum(samples)
        samples -= samples.mean()
    if rng.random() < 0.3:  # quiet stretches and plateaus
        samples[: len(samples) // 3] = 0.0
        samples = np.round(samples, 1)
    peak = np.abs(samples).max()
    return SampledMotion(_log(rng, 1e-3, 0.1), amplitude * samples / peak if peak > 0 else samples)


def _start(rng, block, omega, base):
    if rng.random() < 0.4:
        return Start()
    values = {}
    if rng.random() < 0.6:
        tilt = block.slenderness * rng.choice([-1.0, 1.0]) * _log(rng, 1e-3, 1.3)
        values["tilt"] = float(np.clip(tilt, -1.57, 1.57))
    if rng.random() < 0.4:
        values["tilt_rate"] = float(block.slenderness * omega * rng.standard_normal())
    if base and rng.random() < 0.5:
        values["base_displacement"] = float(0.2 * rng.standard_normal())
    if base and rng.random() < 0.5:
        values["base_velocity"] = float(rng.standard_normal())
    return Start(**values)
