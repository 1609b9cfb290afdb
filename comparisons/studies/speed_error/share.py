"""How much of a run's CPU time is spent inside its engine's compiled functions."""

from __future__ import annotations

import cProfile
import dataclasses
import statistics
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from engines import ENGINES

from .growth import WARM_SECONDS

if TYPE_CHECKING:
    from analytic import Response

    from ...running.cases import Case

RUNS = 3  # of each kind: medians count


def own_share(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the share, over the CPU time of a run without a profiler; the run before has loaded code and caches.

    A run cut short is taken off: it has built the scene, which is no part of the CPU time of a run.
    """
    package = ENGINES[case.solver].package
    cut = dataclasses.replace(case, scene=case.scene.with_(duration=WARM_SECONDS))
    turns = [
        (seconds_inside(package, case.run), seconds_inside(package, cut.run), case.run().cpu_seconds)
        for _ in range(RUNS)
    ]
    whole, built, plain = map(statistics.median, zip(*turns, strict=True))
    return {"outcome": response.outcome, "cost": {"cpu_seconds": plain, "share": (whole - built) / plain}}


def seconds_inside(package: str, run: Callable[[], Any]) -> float:
    """CPU time [s] of a run inside the compiled functions of a package, less what they call back.

    The profiler tells a compiled function by its module, stops its clock where it calls Python, and adds little to the
    function itself: nearly all of its own time counts to the caller, in Python. Its clock is that of the wall, for one
    of CPU time costs as much as a short call; the run's own CPU time over its elapsed one makes up for a busy machine.
    Checked by timing every call from outside, on a busy machine: .57 of a run for .57, exudyn's solver alone (its
    functions that read and set states, which the adapter calls back, add .15 to .2); .80 for .75 to .77, PyBullet.
    """
    profile = cProfile.Profile()
    wall, cpu = time.perf_counter(), time.process_time()
    profile.runcall(run)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    inside = sum(
        entry.inlinetime
        for entry in profile.getstats()
        if isinstance(entry.code, str) and entry.code.startswith(f"<built-in method {package}.")
    )
    return inside * cpu / wall
