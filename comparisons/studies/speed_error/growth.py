"""How CPU time and memory of a run grow with duration, sample rate and number of runs."""

from __future__ import annotations

import dataclasses
import math
import time
import tracemalloc
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import psutil

from analytic import simulate
from analytic.batch import simulate_many
from analytic.motion import SampledMotion

from ...running.cases import Case
from .scenes import at_amplitude
from .timing import TICK

if TYPE_CHECKING:
    import numpy.typing as npt

    from analytic import Response, Scene

    from .scenes import Trial

AGAINST = {"duration": "duration [s]", "samples": "record samples per second [1/s]", "runs": "runs in a batch [-]"}
WARM_SECONDS = 0.02  # s simulated before the memory is measured: code and caches are loaded
SPREAD_OF_BATCH = 0.2  # amplitudes of a batch lie within this share of the boundary
SPAN: dict[str, Any] = {
    "duration": {
        "analytic": ((100, 200, 400, 800, 1600, 3200), (50, 100, 200, 400)),
        "engine": ((5, 10, 20, 40), (1, 2, 4)),
    },
    "samples": ((100, 200, 400, 800, 1600, 3200), (200, 400, 800)),
    "runs": ((250, 500, 1000, 2000, 4000, 8000), (100, 200, 400)),
}


@dataclass(frozen=True, eq=False)
class Point:
    """One measurement of growth: `value` of `against`, in `scene` by `solver` (count: runs in a batch)."""

    against: str
    value: float
    family: str
    scene: Scene
    solver: str
    count: int = 0

    def case(self, turn: int) -> Case:
        """The measurement of one round as a `Case`: its own run, cut short, loads code and caches for `grown`."""
        warm = self.scene.with_(duration=min(self.scene.duration, WARM_SECONDS))
        tag = {"duration": self.scene.duration, "count": self.count, "round": turn}
        return Case(warm, self.solver, None, {"history": False}, tag)


def points(trials: Sequence[Trial], engines: Sequence[str], quick: bool) -> list[Point]:
    """All measurements: the isolated Caryatid under a repeated motion, and batches near the overturning boundary."""
    pick = 1 if quick else 0
    by_name = {trial.name: trial.scene for trial in trials}
    stands, boundary = by_name["isolated-standing"], by_name["near-overturning"]
    asked = [
        Point("duration", value, "kernel", lasting(stands, value), "analytic")
        for value in SPAN["duration"]["analytic"][pick]
    ]
    for engine in engines:
        asked += [
            Point("duration", value, f"{engine}, default", lasting(stands, value), engine)
            for value in SPAN["duration"]["engine"][pick]
        ]
    asked += [Point("samples", value, "kernel", sampled(stands, value), "analytic") for value in SPAN["samples"][pick]]
    return asked + [
        Point("runs", value, "kernel, batch", boundary, "analytic", count=value) for value in SPAN["runs"][pick]
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
    scene, count = case.scene.with_(duration=case.tag["duration"]), case.tag["count"]
    run = _batch(scene, count) if count else dataclasses.replace(case, scene=scene).run
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


def _batch(scene, count):
    """A function that runs `count` scenes around the boundary on one core; its response has the batch's CPU time."""
    low, high = (scene.motion.amplitude * (1 + sign * SPREAD_OF_BATCH) for sign in (-1, 1))
    scenes = [at_amplitude(scene, amplitude) for amplitude in np.linspace(low, high, count)]
    one = simulate(scene, history=False)

    def run():
        begin = time.process_time()
        simulate_many(scenes, workers=1)
        return dataclasses.replace(one, cpu_seconds=time.process_time() - begin)

    return run


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
    u, v = np.log(x), np.log(y)
    slope, offset = np.polyfit(u, v, 1)
    left = v - slope * u - offset
    return float(slope), float(math.sqrt((left @ left) / (len(u) - 2) / ((u - u.mean()) ** 2).sum()))
