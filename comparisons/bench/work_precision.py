"""Error against CPU time: every solver at every tolerance, timed in turns within one process."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from . import peers
from .kernel_solver import kernel_run
from .solvers_scipy import METHODS, block_run, contact_run, twin_run

if TYPE_CHECKING:
    from .problems import Problem

KERNEL = "kernel"
TICK = 2e-3  # s: least CPU time of one timing; fast runs are repeated within it
SLOW, VERY_SLOW = 0.1, 2.0  # s: such runs are timed in the first three rounds, in the first one

TOLERANCES = {
    KERNEL: (1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 1e-16),
    "heyoka": (1e-6, 1e-8, 1e-9, 1e-10, 1e-12, 1e-14, 2.3e-16),
    "CVODE Adams": (1e-6, 1e-8, 1e-10, 1e-12, 1e-13),
    "CyRK DOP853": (1e-6, 1e-8, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14),
    "RK45": (1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12),
    "DOP853": (1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13),
    "LSODA": (1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12),
    "Radau": (1e-6, 1e-8, 1e-9),
}
QUICK = {
    KERNEL: (1e-8, 1e-10, 1e-12, 1e-14, 1e-16),
    "heyoka": (1e-9, 1e-12, 2.3e-16),
    "CVODE Adams": (1e-9, 1e-12),
    "CyRK DOP853": (1e-9, 1e-11, 1e-13),
    "RK45": (1e-8, 1e-10),
    "DOP853": (1e-10, 1e-11, 1e-12),
    "LSODA": (1e-9, 1e-11),
    "Radau": (1e-6,),
}
ON_RECORD = {
    KERNEL: TOLERANCES[KERNEL],
    "RK45": (1e-6, 1e-8, 1e-10),
    "DOP853": (1e-6, 1e-8, 1e-10),
    "LSODA": (1e-6, 1e-8, 1e-10),
    "Radau": (1e-6,),
}
TWIN = {"RK45": (1e-4, 1e-9), "DOP853": (1e-4, 1e-9), "LSODA": (1e-9,), "Radau": (1e-6,)}
TWIN_QUICK = {"DOP853": (1e-6,)}


@dataclass
class Entry:
    """One solver at one tolerance on one problem. seconds: CPU per run, one per round; failure: what it raised."""

    problem: Problem
    solver: str
    tolerance: float
    run: Callable[[], tuple[Any, int]]
    error: float = float("nan")
    impacts: int = -1
    batch: int = 1
    seconds: list = field(default_factory=list)
    failure: str | None = None

    @property
    def counted(self) -> bool:
        """Whether every impact was found; only then do its figures count."""
        return self.impacts == self.problem.impacts

    @property
    def median(self) -> float:
        return statistics.median(self.seconds)

    def row(self) -> dict[str, Any]:
        """JSON-ready."""
        low, median, high = np.percentile(self.seconds, (10, 50, 90)).tolist() if self.seconds else 3 * [None]
        return {
            "problem": self.problem.name,
            "solver": self.solver,
            "tolerance": self.tolerance,
            "error": self.error,
            "impacts": self.impacts,
            "impacts_expected": self.problem.impacts,
            "counted": self.counted,
            "cpu_seconds": median,
            "cpu_seconds_low": low,
            "cpu_seconds_high": high,
            "runs_per_timing": self.batch,
            "timings": len(self.seconds),
            "failure": self.failure,
        }


def block_entries(problem: Problem, quick: bool) -> list[Entry]:
    """All solvers on problem A or B."""
    runs = {KERNEL: kernel_run, **{name: peers.RUNS[name] for name in peers.installed()}}
    runs |= {method: (lambda chosen, rtol, method=method: block_run(chosen, method, rtol)) for method in METHODS}  # type: ignore[misc]  # of a problem and a tolerance
    ladder = QUICK if quick else TOLERANCES
    return [
        Entry(problem, name, tolerance, make(problem, tolerance))
        for name, make in runs.items()
        for tolerance in ladder[name]
    ]


def record_entries(problem: Problem, quick: bool) -> list[Entry]:
    """Kernel and scipy on a problem under a record: the readable twin, and a lean set-up where nothing rocks."""
    entries = [
        Entry(problem, KERNEL, tolerance, kernel_run(problem, tolerance))
        for tolerance in (QUICK if quick else ON_RECORD)[KERNEL]
    ]
    for method, tolerances in (TWIN_QUICK if quick else TWIN).items():
        entries += [
            Entry(problem, f"{method}, stop at samples", tolerance, twin_run(problem, method, tolerance))
            for tolerance in tolerances
        ]
    if problem.impacts == 0:
        for method in METHODS[:2] if quick else METHODS:
            entries += [
                Entry(problem, method, tolerance, contact_run(problem, method, tolerance))
                for tolerance in ON_RECORD[method][: 1 if quick else None]
            ]
    return entries


def measure(entries: Sequence[Entry], rounds: int, advance: Callable[[], Any] = lambda: None) -> None:
    """Error and impacts of each entry, then its CPU time in `rounds` rounds of one timing each, in turns."""
    for entry in entries:
        begin = time.process_time()
        try:
            state, entry.impacts = entry.run()  # also compiles and warms up
        except (ArithmeticError, RuntimeError, ValueError) as error:  # a general solver may give up on its own events
            entry.failure = f"{type(error).__name__}: {error}"
            continue
        entry.error = entry.problem.error(state) if state is not None else float("nan")
        cost = time.process_time() - begin
        if cost < TICK:
            begin = time.process_time()
            entry.run()
            cost = time.process_time() - begin
        entry.batch = max(1, round(TICK / max(cost, 1e-7)))
        entry.seconds = [cost] if cost > VERY_SLOW else []
        advance()
    for turn in range(rounds):
        for entry in entries:
            if entry.failure:
                continue
            expected = entry.median if entry.seconds else 0.0
            if expected > VERY_SLOW or (expected > SLOW and turn >= 3):
                continue
            run, begin = entry.run, time.process_time()
            for _ in range(entry.batch):
                run()
            entry.seconds.append((time.process_time() - begin) / entry.batch)
        advance()


def cheapest(entries: Sequence[Entry], problem: Problem, belongs: Callable[[str], bool], error: float) -> Entry | None:
    """The cheapest sound entry on `problem` of a solver for which `belongs(name)` that reaches `error`, or None."""
    able = [
        entry
        for entry in entries
        if entry.problem is problem and belongs(entry.solver) and entry.counted and entry.error <= error
    ]
    return min(able, key=lambda entry: entry.median, default=None)


def ratio(slow: Entry, fast: Entry) -> float:
    """Median over the rounds of CPU time of `slow` over that of `fast`."""
    return statistics.median(a / b for a, b in zip(slow.seconds, fast.seconds, strict=False))


def is_scipy(name: str) -> bool:
    """Whether a solver's name is that of a scipy method, in any set-up."""
    return name.split(",")[0] in METHODS
