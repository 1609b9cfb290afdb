"""How CPU time and memory of a run grow with its duration and with the sample rate of its record."""

import dataclasses
import math
import tracemalloc
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import psutil

from analytic import Response, SampledMotion, Scene
from engines import get_engine

from ...running.cases import Case

TICK = 4e-3  # s of CPU: shorter measurements are repeated until they took as long, and the mean counts
WARM_SECONDS = 0.02  # s simulated before the memory is measured: code and caches are loaded
# of a full and of a quick run
DURATIONS = ((100, 200, 400, 800, 1600, 3200), (50, 100, 200, 400))  # s, of the kernel
ENGINE_DURATIONS = ((5, 10, 20), (1, 2, 4))  # s
RATES = ((100, 200, 400, 800, 1600, 3200), (200, 400, 800))  # 1/s


def growth_cases(scene: Scene, engines: Sequence[str], quick: bool) -> list[Case]:
    """All measurements, of a scene under a sampled motion that is repeated.

    Each is its own run cut short, which loads code and caches; the tag says the duration [s] of the run that `grown`
    measures, the variant, and the value of what the cost grows against.
    """

    def case(engine, variant, against, value, whole):
        warm = whole.with_(duration=min(whole.duration, WARM_SECONDS))
        tag = {"variant": variant, "against": against, "value": value, "duration": whole.duration}
        return Case(warm, engine, None, {"history": False}, tag)

    lengths: dict[tuple[str, str], tuple[int, ...]] = {("analytic", "kernel"): DURATIONS[quick]}
    lengths |= {(engine, get_engine(engine).default_variant): ENGINE_DURATIONS[quick] for engine in engines}
    return [
        *(
            case(*pair, "duration", value, lasting(scene, value))
            for pair, values in lengths.items()
            for value in values
        ),
        *(case("analytic", "kernel", "samples", value, sampled(scene, value)) for value in RATES[quick]),
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
