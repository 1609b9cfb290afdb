"""What is run, and what is kept of it: error and CPU time of the very same runs, of the kernel and of others."""

import functools
import itertools
import math
import statistics
import time
from collections.abc import Callable
from typing import Any

from analytic import Response, Scene
from analytic.response import State

from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request
from ...running.sweep import Row
from .integrators import METHODS, kernel_run, scipy_run
from .peers import PEERS, installed
from .problems import PROBLEMS

SOLVER = f"{__name__}:prepared"
KERNEL = ("analytic", "kernel")
ROUNDS, QUICK_ROUNDS = 5, 3
TICK = 4e-3  # s: shorter runs are made once, twice, four times ... until they took as long

# (engine, variant): relative tolerances, of a full and of a quick run
TOLERANCES = {
    KERNEL: ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 1e-16), (1e-8, 1e-10, 1e-12, 1e-14, 1e-16)),
    ("scipy", "RK45"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12), (1e-8, 1e-10)),
    ("scipy", "DOP853"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13), (1e-10, 1e-11, 1e-12)),
    ("scipy", "LSODA"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12), (1e-9, 1e-11)),
    ("scipy", "Radau"): ((1e-6, 1e-8, 1e-9), (1e-6,)),
    ("heyoka", "Taylor"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-12, 1e-14, 2.3e-16), (1e-9, 1e-12, 2.3e-16)),
}
INTEGRATORS: dict[tuple[str, str], Callable[..., Any]] = {
    KERNEL: kernel_run,
    **{("scipy", method): functools.partial(scipy_run, method=method) for method in METHODS},
    **PEERS,
}


def plan(request: Request) -> Plan:
    """The plan of the study: in each round a fresh process, in which every integrator has its turn."""
    rounds, peers = QUICK_ROUNDS if request.quick else ROUNDS, installed()
    timed: list[list[Row]] = []
    for turn in range(rounds):
        batch = Batch(_cases(request.quick, peers, turn), measured, f"round {turn + 1} of {rounds}", alone=True)
        timed.append((yield batch))
    rows = [_row(*timings) for timings in zip(*timed, strict=True)]
    versions = {engine: version for (engine, _), version in peers.items()}
    return Computed({"quick": request.quick, "rounds": rounds, "peers": versions}, rows)


def _cases(quick: bool, peers: dict[tuple[str, str], str], turn: int) -> list[Case]:
    """What is timed in one round; a peer's version is part of what a stored run is known by."""
    return [
        Case(
            problem.scene,
            SOLVER,
            name[1],
            {"engine": name[0], "what": what, "tolerance": tolerance},
            {"version": peers.get(name), "round": turn},
        )
        for name, ladders in TOLERANCES.items()
        if name in peers or name not in PEERS
        for what, problem in PROBLEMS.items()
        for tolerance in ladders[quick]
    ]


@functools.lru_cache(maxsize=256)
def run_of(variant: str, engine: str, what: str, tolerance: float) -> Callable[[], tuple[float, int]]:
    """A function without arguments: a problem by an integrator."""
    return INTEGRATORS[engine, variant](PROBLEMS[what], tolerance)


def prepared(scene: Scene, *, variant: str, **settings: Any) -> Response:
    """The first run, which loads and compiles what the timed ones need; nothing is measured in it."""
    run_of(variant, **settings)()
    known = dict(engine="analytic", variant=variant, outcome="rocks", settings=settings, versions={})
    return Response.unmeasured(**known, end=State(scene.duration, *[math.nan] * 5))


def measured(case: Case, _response: Response) -> dict[str, Any]:
    """Measure: what the runs found, and the mean CPU time of the last so many of them: of `TICK` or more in all."""
    run = run_of(case.variant, **case.settings)
    for repeats in (2**doubled for doubled in itertools.count()):
        begin = time.process_time()
        for _ in range(repeats):
            tilt, impacts = run()
        if (spent := time.process_time() - begin) >= TICK:
            break
    error = PROBLEMS[case.settings["what"]].error(tilt)
    return {"error": error, "impacts": impacts, "cost": {"cpu_seconds": spent / repeats}}


def _row(*timings: Row) -> dict[str, Any]:
    """JSON-ready row of the rounds of one case: times per run, medians over the rounds, lowest and highest."""
    first = timings[0]
    settings, what = first.case.settings, first.case.settings["what"]
    row = {
        "part": "work-precision",
        "engine": settings["engine"],
        "variant": first.case.variant,
        "problem": what,
        "tolerance": settings["tolerance"],
        "expected_impacts": PROBLEMS[what].impacts,
        "failure": next((timing.failure for timing in timings if timing.failed), None),
        "timings": len(timings),
        "repeatable": all(timing.values == first.values for timing in timings),
    }
    if row["failure"]:
        return row
    seconds = [timing.cost["cpu_seconds"] for timing in timings]
    times = {"cpu_seconds": statistics.median(seconds), "cpu_low": min(seconds), "cpu_high": max(seconds)}
    return row | times | first.values
