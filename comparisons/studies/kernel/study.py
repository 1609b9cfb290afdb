"""What is run, and what is kept of it: error and CPU time of the very same runs, of the kernel and of others."""

from __future__ import annotations

import functools
import math
import statistics
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from analytic import Response
from analytic.problems import problem_a
from analytic.response import State

from ...running.cases import Case
from ...running.study import Batch, Found
from .integrators import METHODS, kernel_run, scipy_run
from .peers import PEERS, installed
from .problems import PROBLEMS
from .throughput import WORK

if TYPE_CHECKING:
    from analytic import Scene

    from ...running.study import Ask, Plan
    from ...running.sweep import Row

SOLVER = f"{__name__}:prepared"
KERNEL = ("analytic", "kernel")
ROUNDS, QUICK_ROUNDS = 5, 3
TICK = 4e-3  # s: shorter runs are repeated until they took as long

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


def plan(ask: Ask) -> Plan:
    """The plan of the study: in each round a fresh process, in which every integrator and every work has its turn."""
    rounds, peers = QUICK_ROUNDS if ask.quick else ROUNDS, installed()
    timed: list[list[Row]] = []
    for turn in range(rounds):
        batch = Batch(_cases(ask.quick, peers, turn), measured, f"round {turn + 1} of {rounds}", alone=True)
        timed.append((yield batch))
    rows = [_row(*timings) for timings in zip(*timed, strict=True)]
    versions = {engine: version for (engine, _), version in peers.items()}
    return Found({"quick": ask.quick, "rounds": rounds, "peers": versions}, rows)


def _cases(quick: bool, peers: dict[tuple[str, str], str], turn: int) -> list[Case]:
    """What is timed in one round; a peer's version is part of what a stored run is known by."""
    cases = [
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
    return cases + [
        Case(problem_a(), SOLVER, KERNEL[1], {"engine": KERNEL[0], "what": what}, {"round": turn}) for what in WORK
    ]


@functools.lru_cache(maxsize=256)
def run_of(variant: str, engine: str, what: str, tolerance: float = math.nan) -> Callable[[], tuple[Any, int]]:
    """A function without arguments: a problem by an integrator, or a work of the kernel."""
    if what in WORK:
        return WORK[what][0]
    return INTEGRATORS[engine, variant](PROBLEMS[what], tolerance)


def prepared(scene: Scene, *, variant: str, **settings: Any) -> Response:
    """The first run, which loads and compiles what the timed ones need; nothing is measured in it."""
    run_of(variant, **settings)()
    known = dict(engine="analytic", variant=variant, outcome="rocks", settings=settings, versions={})
    return Response.unmeasured(**known, end=State(scene.duration, *[math.nan] * 5))


def measured(case: Case, _response: Response) -> dict[str, Any]:
    """Measure: what the runs found, and the mean CPU and elapsed time of these very runs, of about `TICK` in all."""
    what, run = case.settings["what"], run_of(case.variant, **case.settings)
    (answer, count), cost = _timed(run, 1)
    if cost["elapsed_seconds"] < TICK:
        (answer, count), cost = _timed(run, math.ceil(TICK / cost["elapsed_seconds"]))
    if what in WORK:
        return {"overturned": answer, "runs": count, "cost": {name: value / count for name, value in cost.items()}}
    return {"error": PROBLEMS[what].error(answer), "impacts": count, "cost": cost}


def _timed(run, repeats):
    """(what the last run returns, mean cost of one)."""
    cpu, elapsed = time.process_time(), time.perf_counter()
    for _ in range(repeats):
        found = run()
    cpu, elapsed = time.process_time() - cpu, time.perf_counter() - elapsed
    return found, {"cpu_seconds": cpu / repeats, "elapsed_seconds": elapsed / repeats}


def _row(*timings: Row) -> dict[str, Any]:
    """JSON-ready row of the rounds of one case: times per run, medians over the rounds, lowest and highest."""
    first = timings[0]
    settings, what = first.case.settings, first.case.settings["what"]
    row = {
        "part": "throughput" if what in WORK else "work-precision",
        "engine": settings["engine"],
        "variant": first.case.variant,
        "problem": what,
        "tolerance": settings.get("tolerance"),
        "expected_impacts": PROBLEMS[what].impacts if what in PROBLEMS else None,
        "failure": next((timing.failure for timing in timings if timing.failed), None),
        "timings": len(timings),
        "repeatable": all(timing.values == first.values for timing in timings),
    }
    if row["failure"]:
        return row
    for kind in ("cpu", "elapsed"):
        seconds = [timing.cost[f"{kind}_seconds"] for timing in timings]
        figures = statistics.median(seconds), min(seconds), max(seconds)
        row |= zip((f"{kind}_seconds", f"{kind}_low", f"{kind}_high"), figures, strict=True)
    return row | first.values
