"""The runs of a choice and their search: neighbours are run only at levels that can still pass, the cheapest first."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from engines import get_engine

from ..running.cases import Case
from ..running.sweep import Row, run_sweep
from .criteria import SAFETY, Measure, safety

if TYPE_CHECKING:
    from pathlib import Path

    from analytic import Scene

LevelKey = tuple[str, str, float]  # engine, variant, value of its accuracy parameter


def problem(rows: Mapping[float, Row], limit: float, criterion: str) -> tuple[float | None, str | None]:
    """(error over these runs, why they do not pass or None)."""
    for factor, row in rows.items():
        if row.failed:
            return None, f"failed at {factor:g} of the scene: {row.failure['reason']}"  # type: ignore[index]  # a failed run has one
        if row.values["error"] is None or not math.isfinite(row.values["error"]):
            return None, f"shows no {criterion} at {factor:g} of the scene"
    errors = [row.values["error"] for row in rows.values()]
    found = float(np.mean(errors) if criterion == "outcome" else np.max(errors))
    if found * safety(criterion) > limit:
        return found, f"error {found:.1e}" + ("" if found > limit else f", less than {SAFETY:g} times below")
    return found, None


class Search:
    """Runs levels on a scene and its neighbours, stores the rows, and finds the cheapest level that passes.

    family: {factor: scene or neighbour}, with the duration that is compared. error: the one asked for, in the sense of
    `criterion`. options: for the sweeps, whose stores are in `folder`. rows: {level: {factor: `Row`}} of all runs.
    """

    def __init__(
        self, scene: Scene, family: dict[float, Scene], error: float, criterion: str, folder: Path, **options: Any
    ) -> None:
        self.scene, self.family, self.error, self.criterion = scene, family, error, criterion
        self.folder, self.options = folder, options
        self.rows: dict[LevelKey, dict[float, Row]] = {}

    def run(self, levels: Sequence[LevelKey], factors: Sequence[float], label: str) -> None:
        """Run levels on the scene or neighbours of these factors."""
        wanted = [(level, factor) for factor in factors for level in levels]
        found = self._sweep([(level, self.family[factor]) for level, factor in wanted], self.criterion, label)
        for (level, factor), row in zip(wanted, found, strict=True):
            self.rows.setdefault(level, {})[factor] = row

    def whole(self, level: LevelKey) -> float | None:
        """CPU seconds of the whole scene, None if the run fails."""
        (row,) = self._sweep([(level, self.scene)], "outcome", "the whole scene")
        return None if row.failed else row.cost["cpu_seconds"]

    def _sweep(self, runs, criterion, label):
        cases = []
        for (engine, variant, value), scene in runs:
            kind = get_engine(engine).variants[variant]
            cases.append(
                Case(scene, engine, variant, {} if value == kind.default else {kind.accuracy_parameter: value})
            )
        store = self.folder / f"{criterion}.jsonl"
        return run_sweep(cases, store=store, measure=Measure(criterion), label=label, **self.options)

    def cheapest(self, levels: Sequence[LevelKey]) -> tuple[LevelKey | None, float | None]:
        """(the cheapest level that passes, its CPU seconds for the whole scene), None if none passes.

        Neighbours are run only at levels that can still pass, the cheapest first.
        """
        for level in sorted(filter(self._hopeful, levels), key=self._cost):
            suffix = self._suffix(level)
            missing = [factor for factor in self.family if any(factor not in self.rows[one] for one in suffix)]
            if self._hopeful(level):  # may have changed by runs made meanwhile
                self.run(suffix, missing, f"{level[0]}, {level[1]}: neighbours")
            if self._pass(suffix):
                spent = self.whole(level)
                if spent is not None:
                    return level, spent
                failed = {"reason": "the whole scene failed"}
                self.rows[level][1.0] = replace(self.rows[level][1.0], failure=failed)
        return None, None

    def _suffix(self, level):
        levels = get_engine(level[0]).variants[level[1]].levels
        return [(*level[:2], value) for value in levels[levels.index(level[2]) :]]

    def _pass(self, levels):
        return all(problem(self.rows[one], self.error, self.criterion)[1] is None for one in levels)

    def _hopeful(self, level):
        """Whether a level and all finer ones of its variant pass in all scenes run so far."""
        suffix = self._suffix(level)
        if self.criterion == "outcome":  # one run with another outcome does not determine a share
            return not any(row.failed for one in suffix for row in self.rows[one].values())
        return self._pass(suffix)

    def _cost(self, level):
        row = self.rows[level][1.0]
        return row.cost["cpu_seconds"] / row.values["simulated"]
