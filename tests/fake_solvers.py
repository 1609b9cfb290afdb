"""For the tests of the sweep layer: cheap solvers, some sound, some that crash, hang or raise; and sweeps of them."""

import math
import os
import time
from pathlib import Path

from analytic import Block, Failure, Response, Scene, Start, State
from comparisons.execution.cases import Case
from comparisons.execution.sweep import Processes, run_sweep

# Of new processes that import this and the project.
ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join(map(str, (Path(__file__).parent, Path(__file__).parents[1]))),
}


def response(scene, *, peak=0.0, outcome="stands", failure=None, settings=None, cpu_seconds=None):
    return Response(
        "fake",
        "",
        outcome,
        None,
        None,
        peak,
        peak / scene.block.slenderness,
        0.0,
        0.0,
        (),
        (),
        (),
        0.0,
        1.0,
        State(scene.duration, 0.0, 0.0, 0.0, 0.0, 0.0),
        time.process_time() if cpu_seconds is None else cpu_seconds,
        1,
        settings or {},
        {},
        failure=failure,
    )


def sound(scene, *, work=0, sleep=0.0):
    """`work` square roots, then `sleep` seconds; the tilt depends on the scene alone."""
    total = sum(math.sqrt(i) for i in range(work))
    time.sleep(sleep)
    return response(scene, peak=scene.start.tilt**2 + 0.0 * total, settings={"work": work})


def counted(scene, *, log, sleep=0.0):
    """Leaves a mark for every run."""
    with open(log, "a") as file:
        file.write(f"{scene.start.tilt:.6f}\n")
    return sound(scene, sleep=sleep)


def exits(scene, *, code=3):
    """Ends its process without a word where the tilt is 0.05."""
    if scene.start.tilt == 0.05:
        os.write(2, b"engine: assertion failed in contact\n")
        os._exit(code)
    return sound(scene)


def segfaults(scene):
    import ctypes

    if scene.start.tilt == 0.05:
        ctypes.string_at(0)
    return sound(scene)


def killed(scene, *, number):
    """Killed from outside, as by the system when memory runs out, or a terminal that is closed, at a tilt of 0.05."""
    if scene.start.tilt == 0.05:
        os.kill(os.getpid(), number)
    return sound(scene)


def hangs(scene, *, seconds=60.0):
    """Does not come back within `seconds` where the tilt is 0.05."""
    if scene.start.tilt == 0.05:
        time.sleep(seconds)
    return sound(scene)


def raises(scene):
    if scene.start.tilt == 0.05:
        raise ValueError("Newton did not converge")
    return sound(scene)


def fails(scene):
    last = State(0.5, 0.1, 0.0, 0.0, 0.0, 0.0)
    return response(scene, outcome="failed", failure=Failure("energy gain", "12 J at 0.5 s", last))


def never_steps(scene):
    """Fails before its first step: it has no time to report."""
    return response(scene, outcome="failed", failure=Failure("too many steps", "1e8 of 2 s"), cpu_seconds=math.nan)


def tilt(case, response):
    """Measure."""
    return {"outcome": response.outcome, "peak": response.peak_tilt, "cpu_seconds": response.cpu_seconds}


def place(case, response):
    return {"pid": os.getpid()}


def broken(case, response):
    return {"peak": {1, 2}}


def scene(tilt):
    return Scene(block=Block(mass=1.0, radius=1.0, slenderness=0.3), start=Start(tilt=tilt), duration=1.0)


def cases(solver="sound", count=10, **settings):
    return [
        Case(scene(round(0.01 * i, 6)), f"fake_solvers:{solver}", settings=settings, tag={"i": i}) for i in range(count)
    ]


def slow(log, count):
    """Cases of 0.05 s each that leave marks in `log`."""
    settings = {"log": str(log), "sleep": 0.05}
    return [Case(scene(1e-3 * i), "fake_solvers:counted", settings=settings) for i in range(count)]


def sweep(which, store, executor=None, workers=None, measure=tilt, **options):
    """Rows of cases, by an executor or by so many workers started for them."""
    options |= {"store": store, "measure": measure, "progress": False}
    if executor is not None:
        return run_sweep(which, executor=executor, **options)
    with Processes(workers) as pool:
        return run_sweep(which, executor=pool, **options)


def results(rows):
    """Everything that must not depend on place, order, workers or interruption."""
    return [(row.case.tag, row.values, row.failure) for row in rows]
