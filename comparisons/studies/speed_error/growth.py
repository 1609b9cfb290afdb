"""How CPU time and memory of a run grow with its duration and with the sample rate of its record."""

from __future__ import annotations

import dataclasses
import math
import tracemalloc
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import psutil

from analytic.motion import SampledMotion
from engines import get_engine

from ...running.cases import Case

if TYPE_CHECKING:
    import numpy.typing as npt

    from analytic import Response, Scene

TICK = 4e-3  # s of CPU: shorter measurements are repeated until they took as long, and the mean counts
WARM_SECONDS = 0.02  # s simulated before the memory is measured: code and caches are loaded
# of a full and of a quick run
DURATIONS = ((100, 200, 400, 800, 1600, 3200), (50, 100, 200, 400))  # s, of the kernel
ENGINE_DURATIONS = ((5, 10, 20, 40), (1, 2, 4))  # s
RATES = ((100, 200, 400, 800, 1600, 3200), (200, 400, 800))  # 1/s


@dataclass(frozen=True, eq=False)
class Point:
    """One measurement of growth: `value` of `against` ("duration" [s] or "samples" per second), in `scene`."""

    against: str
    value: float
    engine: str
    variant: str
    scene: Scene

    def case(self, turn: int) -> Case:
        """The measurement of one round as a `Case`: its own run, cut short, loads code and caches for `grown`."""
        warm = self.scene.with_(duration=min(self.scene.duration, WARM_SECONDS))
        return Case(warm, self.engine, None, {"history": False}, {"duration": self.scene.duration, "round": turn})


def points(scene: Scene, engines: Sequence[str], quick: bool) -> list[Point]:
    """All measurements, of a scene under a sampled motion that is repeated."""
    variants = {engine: get_engine(engine).default_variant for engine in engines}
    lengths = [("analytic", "kernel", value) for value in DURATIONS[quick]]
    lengths += [(*pair, value) for pair in variants.items() for value in ENGINE_DURATIONS[quick]]
    return [
        *(Point("duration", value, engine, variant, lasting(scene, value)) for engine, variant, value in lengths),
        *(Point("samples", value, "analytic", "kernel", sampled(scene, value)) for value in RATES[quick]),
    ]


def lasting(scene: Scene, duration: float) -> Scene:
    """The scene for `duration` seconds, its motion repeated."""
    samples = scene.motion.samples[: math.floor(scene.duration / scene.motion.dt)]
    times = math.ceil(duration / (len(samples) * scene.motion.dt)) + 1
    motion = SampledMotion(scene.motion.dt, np.tile(samples, times), f"{scene.motion.label}, repeated")
    return scene.with_(motion=motion, duration=float(duration))


def sampled(scene: Scene, rate: float) -> Scene:
    """The scene with its motion sampled `rate` times a second; above its own rate, the very same motion."""
    motion = scene.motion
    times = np.arange(round(scene.duration * rate) + 1) / rate
    return scene.with_(motion=SampledMotion(1.0 / rate, motion.acceleration(times), motion.label))


def grown(case: Case, response: Response) -> dict[str, Any]:
    """Measure: CPU time and memory [bytes] of the run that the case's tag names, in a process of its own.

    traced_bytes: peak of what Python and numpy allocate during the run (tracemalloc). resident_bytes: how far the
    process's resident memory rises above its size before the run, at its peak; it counts compiled code's memory too.
    """
    run = dataclasses.replace(case, scene=case.scene.with_(duration=case.tag["duration"])).run
    resident = _resident_growth(run)
    response = run()
    if response.failure:
        raise RuntimeError(f"{case.solver}: {response.failure.reason}")
    cpu = response.cpu_seconds
    if cpu < TICK:
        repeats = math.ceil(TICK / cpu)
        cpu = sum(run().cpu_seconds for _ in range(repeats)) / repeats
    tracemalloc.start()
    run()
    traced = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return {
        "end": response.end.time,
        "steps": response.steps,
        "traced_bytes": traced,
        "resident_bytes": resident,
        "cost": {"cpu_seconds": cpu},
    }


def _resident_growth(run):
    """Bytes by which the peak resident memory during `run` exceeds that before it; None where the system hides it."""
    status, reset = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    before = psutil.Process().memory_info().rss
    try:
        reset.write_text("5")  # forget the peak so far
    except OSError:
        return None
    run()
    peak = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
    return max(0, int(peak.split()[1]) * 1024 - before)


def fit(x: npt.ArrayLike, y: npt.ArrayLike) -> tuple[float, float]:
    """(exponent, its standard error) of y ~ x^exponent by least squares of the logarithms; three points or more."""
    (slope, _), covariance = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    return float(slope), math.sqrt(covariance[0, 0])
