"""The runs of a choice, and the search among them: neighbours are run of hopeful settings only, the cheapest first."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from engines import get_engine

from ..running.cases import Case
from ..running.sweep import Row, run_sweep
from .aims import SPARE, Measure

if TYPE_CHECKING:
    from analytic import Scene

    from ..running.executors import Executor

Rung = tuple[str, str, float]  # engine, variant, value of its knob


class Runner:
    """Runs rungs on some of the family and files the rows."""

    def __init__(
        self, folder: Path, executor: Executor, measure: Measure, family: dict[float, Scene], **options: Any
    ) -> None:
        self.folder, self.executor, self.measure, self.family = folder, executor, measure, family
        self.options = options  # time_limit and progress of a sweep
        self.rows: dict[Rung, dict[float, Row]] = {}

    def __call__(self, rungs: Sequence[Rung], factors: Sequence[float], label: str) -> None:
        wanted = [(rung, factor) for factor in factors for rung in rungs]
        cases = [case_of(self.family[factor], rung) for rung, factor in wanted]
        if not cases:
            return
        found = self._sweep(cases, self.measure, label)
        for (rung, factor), row in zip(wanted, found, strict=True):
            self.rows.setdefault(rung, {})[factor] = row

    def whole(self, scene: Scene, rung: Rung) -> float | None:
        """CPU seconds of the whole scene, None where it fails."""
        (row,) = self._sweep([case_of(scene, rung)], Measure("outcome"), "the whole scene")
        return None if row.failed else row.cost["cpu_seconds"]

    def _sweep(self, cases, measure, label):
        store = self.folder / f"{measure.aim}.jsonl"
        return run_sweep(cases, store=store, measure=measure, executor=self.executor, label=label, **self.options)


def case_of(scene: Scene, rung: Rung) -> Case:
    """The run of a rung on a scene."""
    engine, variant, value = rung
    kind = get_engine(engine).variants[variant]
    return Case(scene, engine, variant, {} if value == kind.default else {kind.knob: value})


def spare(aim: str) -> float:
    """Error asked for over the worst that passes."""
    return 1.0 if aim == "outcome" else SPARE


def problem(rows: Mapping[float, Row], limit: float, aim: str) -> tuple[float | None, str | None]:
    """(error over these runs, why they do not pass or None)."""
    for factor, row in rows.items():
        if row.failed:
            return None, f"failed at {factor:g} of the scene: {row.failure['reason']}"  # type: ignore[index]  # it has one
        if row.values["error"] is None or not math.isfinite(row.values["error"]):
            return None, f"shows no {aim} at {factor:g} of the scene"
    errors = [row.values["error"] for row in rows.values()]
    found = float(np.mean(errors) if aim == "outcome" else np.max(errors))
    if found * spare(aim) > limit:
        return found, f"error {found:.1e}" + ("" if found > limit else f", less than {SPARE:g} times below")
    return found, None


class Search:
    """Looks for the cheapest rung that passes: the neighbours are run of hopeful ones only, the cheapest first."""

    def __init__(self, go: Runner, error: float, aim: str, whole: Callable[[Rung], float | None]) -> None:
        self.go, self.error, self.aim, self.whole = go, error, aim, whole

    def cheapest(self, rungs: Sequence[Rung]) -> tuple[Rung | None, float | None]:
        """(the rung, CPU seconds of the whole scene with it), None where none passes."""
        for rung in sorted(filter(self._hopeful, rungs), key=self._cost):
            suffix = self._suffix(rung)
            missing = [factor for factor in self.go.family if any(factor not in self.go.rows[one] for one in suffix)]
            if self._hopeful(rung):  # what was run meanwhile may tell
                self.go(suffix, missing, f"{rung[0]}, {rung[1]}: neighbours")
            if all(problem(self.go.rows[one], self.error, self.aim)[1] is None for one in suffix):
                spent = self.whole(rung)
                if spent is not None:
                    return rung, spent
                failed = {"reason": "the whole scene failed"}
                self.go.rows[rung][1.0] = replace(self.go.rows[rung][1.0], failure=failed)
        return None, None

    def _suffix(self, rung):
        ladder = get_engine(rung[0]).variants[rung[1]].ladder
        return [(*rung[:2], value) for value in ladder[ladder.index(rung[2]) :]]

    def _hopeful(self, rung):
        """Whether a rung and all finer ones of its variant pass on what they have run."""
        rows = [row for one in self._suffix(rung) for row in self.go.rows[one].values()]
        if self.aim == "outcome":  # one run that differs does not tell a share
            return not any(row.failed for row in rows)
        return all(problem(self.go.rows[one], self.error, self.aim)[1] is None for one in self._suffix(rung))

    def _cost(self, rung):
        row = self.go.rows[rung][1.0]
        return row.cost["cpu_seconds"] / row.values["simulated"]
