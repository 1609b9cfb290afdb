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
from .criteria import SAFETY, Measure, safety

if TYPE_CHECKING:
    from analytic import Scene

    from ..running.executors import Executor

LevelKey = tuple[str, str, float]  # engine, variant, value of its accuracy parameter


class Runner:
    """Runs levels on some of the family and files the rows."""

    def __init__(
        self, folder: Path, executor: Executor, measure: Measure, family: dict[float, Scene], **options: Any
    ) -> None:
        self.folder, self.executor, self.measure, self.family = folder, executor, measure, family
        self.options = options  # time_limit and progress of a sweep
        self.rows: dict[LevelKey, dict[float, Row]] = {}

    def __call__(self, levels: Sequence[LevelKey], factors: Sequence[float], label: str) -> None:
        wanted = [(level, factor) for factor in factors for level in levels]
        cases = [case_of(self.family[factor], level) for level, factor in wanted]
        if not cases:
            return
        found = self._sweep(cases, self.measure, label)
        for (level, factor), row in zip(wanted, found, strict=True):
            self.rows.setdefault(level, {})[factor] = row

    def whole(self, scene: Scene, level: LevelKey) -> float | None:
        """CPU seconds of the whole scene, None where it fails."""
        (row,) = self._sweep([case_of(scene, level)], Measure("outcome"), "the whole scene")
        return None if row.failed else row.cost["cpu_seconds"]

    def _sweep(self, cases, measure, label):
        store = self.folder / f"{measure.criterion}.jsonl"
        return run_sweep(cases, store=store, measure=measure, executor=self.executor, label=label, **self.options)


def case_of(scene: Scene, level: LevelKey) -> Case:
    """The run of a level on a scene."""
    engine, variant, value = level
    kind = get_engine(engine).variants[variant]
    return Case(scene, engine, variant, {} if value == kind.default else {kind.knob: value})


def problem(rows: Mapping[float, Row], limit: float, criterion: str) -> tuple[float | None, str | None]:
    """(error over these runs, why they do not pass or None)."""
    for factor, row in rows.items():
        if row.failed:
            return None, f"failed at {factor:g} of the scene: {row.failure['reason']}"  # type: ignore[index]  # it has one
        if row.values["error"] is None or not math.isfinite(row.values["error"]):
            return None, f"shows no {criterion} at {factor:g} of the scene"
    errors = [row.values["error"] for row in rows.values()]
    found = float(np.mean(errors) if criterion == "outcome" else np.max(errors))
    if found * safety(criterion) > limit:
        return found, f"error {found:.1e}" + ("" if found > limit else f", less than {SAFETY:g} times below")
    return found, None


class Search:
    """Looks for the cheapest level that passes: the neighbours are run of hopeful ones only, the cheapest first."""

    def __init__(self, go: Runner, error: float, criterion: str, whole: Callable[[LevelKey], float | None]) -> None:
        self.go, self.error, self.criterion, self.whole = go, error, criterion, whole

    def cheapest(self, levels: Sequence[LevelKey]) -> tuple[LevelKey | None, float | None]:
        """(the level, CPU seconds of the whole scene with it), None where none passes."""
        for level in sorted(filter(self._hopeful, levels), key=self._cost):
            suffix = self._suffix(level)
            missing = [factor for factor in self.go.family if any(factor not in self.go.rows[one] for one in suffix)]
            if self._hopeful(level):  # what was run meanwhile may tell
                self.go(suffix, missing, f"{level[0]}, {level[1]}: neighbours")
            if all(problem(self.go.rows[one], self.error, self.criterion)[1] is None for one in suffix):
                spent = self.whole(level)
                if spent is not None:
                    return level, spent
                failed = {"reason": "the whole scene failed"}
                self.go.rows[level][1.0] = replace(self.go.rows[level][1.0], failure=failed)
        return None, None

    def _suffix(self, level):
        ladder = get_engine(level[0]).variants[level[1]].ladder
        return [(*level[:2], value) for value in ladder[ladder.index(level[2]) :]]

    def _hopeful(self, level):
        """Whether a level and all finer ones of its variant pass on what they have run."""
        rows = [row for one in self._suffix(level) for row in self.go.rows[one].values()]
        if self.criterion == "outcome":  # one run that differs does not tell a share
            return not any(row.failed for row in rows)
        return all(problem(self.go.rows[one], self.error, self.criterion)[1] is None for one in self._suffix(level))

    def _cost(self, level):
        row = self.go.rows[level][1.0]
        return row.cost["cpu_seconds"] / row.values["simulated"]
