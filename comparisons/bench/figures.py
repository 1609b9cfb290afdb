"""The figures the project promises of its analytic model, measured; each beside what was asked for."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analytic import simulate
from analytic.twin import simulate_twin

from . import throughput
from .work_precision import KERNEL, cheapest, is_scipy, ratio

if TYPE_CHECKING:
    from analytic.types import Motion

    from .problems import Problem
    from .work_precision import Entry

TWIN_TOLERANCE = 1e-13  # of the independent solution the reference is held against


@dataclass(frozen=True)
class Figure:
    """One figure: what, its value, unit, the limit asked for ("at least" or "at most", if any), how it came about."""

    name: str
    value: float | None
    unit: str
    sense: str | None
    limit: float | None
    how: str

    @property
    def met(self) -> bool | None:
        """Whether it is as asked for, None where nothing is; a figure that could not be measured is not."""
        if self.limit is None:
            return None
        if self.value is None:
            return False
        return self.value >= self.limit if self.sense == "at least" else self.value <= self.limit

    def row(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "figure": self.name,
            "value": self.value,
            "unit": self.unit,
            "sense": self.sense,
            "limit": self.limit,
            "met": self.met,
            "how": self.how,
        }


def ratios(entries: Sequence[Entry], blocks: Sequence[Problem], records: Sequence[Problem]) -> list[Figure]:
    """Figures of the work-precision study: CPU time of others over the kernel's at equal error."""
    return [
        *(_ratio(entries, problem, is_scipy, "best scipy", 1e-9, "at least", 300) for problem in blocks),
        *(_ratio(entries, problem, _is_heyoka, "heyoka", 1e-12, "at least", 1) for problem in blocks),
        *(_ratio(entries, problem, _is_dop853, "scipy DOP853", 1e-8, "at least", 300) for problem in records),
    ]


def _is_heyoka(solver):
    return solver == "heyoka"


def _is_dop853(solver):
    return solver.startswith("DOP853")


def _ratio(entries, problem, belongs, name, error, sense, limit):
    fast = cheapest(entries, problem, lambda solver: solver == KERNEL, error)
    slow = cheapest(entries, problem, belongs, error)
    title = f"{problem.name}: CPU of {name} over that of the kernel, both at error {error:g}"
    if fast is None or slow is None:
        lost = "the kernel" if fast is None else name
        return Figure(title, None, "", sense, limit, f"no setting of {lost} reaches it here")
    how = (
        f"{slow.solver} at {slow.tolerance:g}: {slow.median * 1e3:.4g} ms, error {slow.error:.1e}; kernel at "
        f"{fast.tolerance:g}: {fast.median * 1e6:.4g} us, error {fast.error:.1e}"
    )
    return Figure(title, ratio(slow, fast), "", sense, limit, how)


def independent_difference(problem: Problem) -> tuple[float, int]:
    """Error, in the problem's own measure, of scipy's DOP853 at its tightest against the reference."""
    response = simulate_twin(
        problem.scene, rtol=TWIN_TOLERANCE, history=False, energy=False, rest_rate=problem.rest_rate
    )
    end = response.end
    return (problem.error([end.tilt, end.tilt_rate, end.base_displacement, end.base_velocity]), response.impact_count)


def agreement(problem: Problem) -> Figure:
    """The kernel at its default tolerance against the independent solution."""
    end = simulate(problem.scene, history=False).end
    kernel_error = problem.error([end.tilt, end.tilt_rate, end.base_displacement, end.base_velocity])
    difference, impacts = independent_difference(problem)
    counted = "all" if impacts == problem.impacts else f"{impacts} instead of"
    return Figure(
        f"{problem.name} to {problem.horizon:g} s: error of the state at the default tolerance",
        kernel_error + difference,
        "",
        "at most",
        1e-9,
        f"{kernel_error:.1e} from the kernel at 1e-17, which is {difference:.1e} from scipy DOP853 at "
        f"{TWIN_TOLERANCE:g}, {counted} {problem.impacts} impacts",
    )


def costs(blocks: Sequence[Problem], records: Sequence[Problem], motion: Motion, rounds: int) -> list[Figure]:
    """Figures of throughput and start-up."""
    return [
        *(_loop_cost(problem, rounds) for problem in blocks),
        _sample_cost(records[0], rounds),
        _map_cost(max(2, rounds // 3)),
        _spectrum_cost(motion, max(2, rounds // 3)),
        _start_up(max(3, rounds // 3)),
    ]


def _loop_cost(problem, rounds):
    title = f"{problem.name}: CPU of the kernel per run in a compiled loop, tolerance 1e-14"
    seconds = statistics.median(throughput.batch_cost(problem, rounds, 1e-14))
    return Figure(title, seconds * 1e6, "us", None, None, "no Python between the runs")


def _sample_cost(standing, rounds):
    title = "isolated Caryatid without rocking: CPU per record sample, default tolerance"
    seconds = statistics.median(throughput.sample_cost(standing, rounds))
    return Figure(title, seconds * 1e9, "ns", "at most", 250, standing.scene.motion.label)


def _map_cost(rounds):
    title = "one-sine overturning map 100 x 100: CPU per run and core"
    seconds, share = throughput.map_cost(rounds)
    return Figure(title, statistics.median(seconds) * 1e6, "us", "at most", 10, f"{share:.0%} overturn")


def _spectrum_cost(motion, rounds):
    title = "rocking spectrum of 500 periods on 2 cores: elapsed time"
    seconds, share = throughput.spectrum_cost(motion, rounds)
    how = f"{motion.label}, slenderness 0.28, {share:.0%} overturn"
    return Figure(title, statistics.median(seconds), "s", "at most", 1, how)


def _start_up(rounds):
    title = "a process that runs one scene with the cached kernel: least elapsed time"
    seconds, parts, cpu = throughput.start_up(rounds)
    shares = ", ".join(f"{name} {value:.2f}" for name, value in parts.items())
    return Figure(title, min(seconds), "s", "at most", 1.5, f"CPU {cpu:.2f} s; medians: {shares}")
