"""How much of a run's CPU time is spent inside its engine's compiled functions."""

import cProfile
import statistics
import time
from collections.abc import Callable
from typing import Any

from analytic import Response, Scene
from engines import get_engine
from engines.contract import Run
from engines.settings import choose

from ...running.cases import Case
from .growth import WARM_SECONDS

RUNS = 3  # of each kind: medians count


def own_share(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the share, over the CPU time of a run without a profiler; the run before has loaded code and caches.

    All are bare runs, which build the scene once: `simulate` repeats a run whose end cuts an impact short. A run cut
    short is subtracted: it has built the scene, which is no part of the CPU time of a run.
    """
    engine = get_engine(case.solver)
    variant, settings = choose(engine, case.variant, {k: v for k, v in case.settings.items() if k != "history"})

    def run(scene: Scene) -> Callable[[], Run]:
        return lambda: engine.run(scene, variant, settings)

    whole, cut = run(case.scene), run(case.scene.with_(duration=WARM_SECONDS))
    turns = [
        (seconds_inside(engine.package, whole), seconds_inside(engine.package, cut), whole().cpu_seconds)
        for _ in range(RUNS)
    ]
    total, built, plain = map(statistics.median, zip(*turns, strict=True))
    return {"outcome": response.outcome, "cost": {"cpu_seconds": plain, "share": (total - built) / plain}}


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
