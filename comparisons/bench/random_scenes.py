"""Random valid scenes through the kernel: no NaN, no hang, no failure, no energy from nothing."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import TimeoutError
from typing import TYPE_CHECKING, Any

import numpy as np
from pebble import ProcessExpired, ProcessPool

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, simulate
from analytic.motion import PULSES

from ..running.provenance import json_ready

if TYPE_CHECKING:
    from analytic import Impact

IMBALANCE_LIMIT = 1e-6  # of the largest energy in the run
LOSS_ROUND_OFF = 1e-12  # an impact may seem to add this share of the energy it meets
# Energies below this share of what it takes to tip the block are rounding (a pulse that just touches the threshold).
ROUND_OFF = 1e-9
CHUNK = 200
CHUNK_SECONDS, SCENE_SECONDS = 60.0, 20.0  # time limits of a chunk, of a scene alone


def random_scene(seed: int, index: int) -> Scene:
    """Scene number `index` of the ensemble `seed`; parameters cover what a scene may hold, extremes included."""
    rng = np.random.default_rng([seed, index])
    block = _block(rng)
    omega = math.sqrt(block.mass * 9.81 * block.radius / block.inertia)
    base = Base(mass=float(block.mass * _log(rng, 1e-4, 1e3))) if rng.random() < 0.7 else None
    bearings = _bearings(rng, block.mass + base.mass) if base and rng.random() < 0.85 else None
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


def _bearings(rng, carried):
    law, count = str(rng.choice(["algebraic", "linear", "bouc-wen"])), int(rng.integers(1, 9))
    frequency = _log(rng, 0.3, 60.0)
    ka = carried * frequency**2 / count
    dk = ka * _log(rng, 1e-9, 0.999)
    viscous = 0.0 if rng.random() < 0.5 else 2 * rng.uniform(0, 0.5) * frequency * carried / count
    if law == "linear":
        return Bearings(law=law, count=count, ka=ka, damping=viscous)
    delta = 1e-20 if rng.random() < 0.5 else (ka - (ka - dk)) * _log(rng, 1e-20, 1e-2)
    kb = 0.0 if rng.random() < 0.05 else ka - dk
    return Bearings(
        law=law, count=count, ka=ka, kb=kb, alpha=1 + _log(rng, 0.05, 199.0), delta_k=delta, damping=viscous
    )


def _motion(rng, omega, unit):
    kind, amplitude = rng.random(), float(unit * _log(rng, 0.1, 10.0) * rng.choice([-1.0, 1.0]))
    if kind < 0.1:
        return None
    if rng.random() < 0.05:  # touches the uplift threshold to the last bit
        amplitude = math.copysign(unit, amplitude)
    if kind < 0.55:
        return PulseMotion(
            str(rng.choice(PULSES)),
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


def faults(scene: Scene) -> dict[str, Any]:
    """What is wrong with the kernel's run of `scene`: a dict of findings, empty for a sound one."""
    response = simulate(scene, history=False)
    wrong: dict[str, Any] = {}
    if response.failure:
        wrong["failure"] = response.failure.reason
    numbers = [
        response.peak_tilt,
        response.peak_base_displacement,
        response.peak_base_acceleration,
        response.end.tilt,
        response.end.tilt_rate,
        response.end.base_displacement,
        response.end.base_velocity,
        response.end.bearing_force,
    ]
    ledger = response.energy
    terms = [ledger.kinetic, ledger.potential, ledger.input, ledger.hysteretic, ledger.viscous, ledger.impact_loss]
    if not np.isfinite(numbers + terms).all():
        wrong["not finite"] = numbers + terms
        return wrong
    scale = max(_energy_scale(scene, response), *map(abs, terms))
    if abs(ledger.imbalance) > IMBALANCE_LIMIT * scale:
        wrong["energy imbalance"] = abs(ledger.imbalance) / scale
    least = least_impact_loss(scene, response.impacts)
    if least < -LOSS_ROUND_OFF:
        wrong["an impact adds energy"] = least
    if response.end.time < scene.duration * (1 - 1e-12) and response.outcome not in ("overturns", "failed"):
        wrong["ended early"] = response.end.time
    return wrong


def _energy_scale(scene, response):
    """Energies that came and went within the run without a trace in the ledger's final sums [J]."""
    block, bearings, start = scene.block, scene.bearings, scene.start
    scale = 0.5 * block.inertia * start.tilt_rate**2 + 0.5 * scene.total_mass * start.base_velocity**2
    if bearings:
        k = bearings.ka if bearings.law == "linear" else bearings.kb
        scale += 0.5 * bearings.count * k * response.peak_base_displacement**2
    weight = block.mass * scene.gravity * block.radius
    reached = min(response.peak_tilt, block.slenderness)
    scale += weight * (math.cos(block.slenderness - reached) - math.cos(block.slenderness))
    scale += ROUND_OFF * weight * (1 - math.cos(block.slenderness))
    if scene.base and scene.motion:  # what a base gains and loses again when the ground stops
        scale += 0.5 * scene.total_mass * _peak_velocity(scene.motion) ** 2
    return scale


def _peak_velocity(motion):
    """Bound on the ground velocity [m/s], by the rectangle rule."""
    times = np.linspace(0.0, motion.end, 2000)
    return float(np.abs(np.cumsum(motion.acceleration(times))).max() * times[1])


def least_impact_loss(scene: Scene, impacts: Sequence[Impact]) -> float:
    """Least share of its tilting energy that an impact takes away; below 0 it would have added some.

    The base velocity drops out: w h J-terms, with j the jump, leave J (w-^2 - w+^2)/2 - m h j w+ - M j^2/2.
    """
    block, least = scene.block, 1.0
    for impact in impacts:
        before, after, jump = impact.rate_before, impact.rate_after, impact.base_velocity_jump
        met = 0.5 * block.inertia * before**2
        loss = met - 0.5 * block.inertia * after**2 - block.mass * block.half_height * jump * after
        if scene.base:
            loss -= 0.5 * scene.total_mass * jump**2
        if met > 0:
            least = min(least, loss / met)
    return least


def _check(seed, indices):
    faulty = []
    for index in indices:
        wrong = faults(random_scene(seed, index))
        if wrong:
            faulty.append({"index": index, "found": wrong})
    return faulty


def check_random_scenes(
    count: int, seed: int = 0, workers: int = 2, advance: Callable[[int], Any] = lambda done: None
) -> list[dict[str, Any]]:
    """Run scenes 0 .. count-1 of the ensemble `seed` in worker processes that may hang or crash.

    Returns
    -------
    list of dict
        One per faulty scene, by index: what was found and the scene itself, JSON-ready.
    """
    _check(seed, range(1))  # the kernel compiled or loaded before workers start
    faulty = []
    with ProcessPool(workers) as pool:
        chunks = [range(k, min(k + CHUNK, count)) for k in range(0, count, CHUNK)]
        futures = [pool.schedule(_check, (seed, chunk), timeout=CHUNK_SECONDS) for chunk in chunks]
        for chunk, future in zip(chunks, futures, strict=True):
            try:
                faulty += future.result()
            except (TimeoutError, ProcessExpired):
                faulty += _one_by_one(pool, seed, chunk)
            advance(len(chunk))
    return [{**row, "scene": describe(random_scene(seed, row["index"]))} for row in faulty]


def _one_by_one(pool, seed, chunk):
    faulty = []
    for index in chunk:
        try:
            faulty += pool.schedule(_check, (seed, [index]), timeout=SCENE_SECONDS).result()
        except TimeoutError:
            faulty.append({"index": index, "found": {"hang": f"no end within {SCENE_SECONDS:g} s"}})
        except ProcessExpired as error:
            faulty.append({"index": index, "found": {"crash": f"exit code {error.exitcode}"}})
    return faulty


def describe(scene: Scene) -> dict[str, Any]:
    """The scene as JSON values, motion included."""
    content = scene.model_dump(exclude={"motion"})
    motion = scene.motion
    if isinstance(motion, SampledMotion):
        content["motion"] = {"dt": motion.dt, "samples": motion.samples}
    elif motion is not None:
        content["motion"] = {
            "pulse": motion.shape,
            "amplitude": motion.amplitude,
            "frequency": motion.frequency,
            "start": motion.start,
        }
    return json_ready(content)
