"""``rocking bench engines``: an engine's default variant against the analytic model on random scenes of a wide box.

    rows = bench_engines("exudyn", "bench-engines", scenes=2000, seed=1, workers=2)

A row a scene: its class (`measuring.verdicts.CLASSES`), what was found, the warnings, and where in the box it lies. All
runs are kept in the folder (reference.jsonl: analytic model, ENGINE.jsonl: engine): what is there and whose code has
not changed is not run again, so that a broken-off bench goes on, and a mended engine costs the engine's runs alone.
`examine` runs one scene again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from engines import get_engine

from ...measuring.kept import keep
from ...measuring.verdicts import (
    boundary_copies,
    findings,
    judge,
    near_copies,
    peak_errors,
    range_warnings,
    restitution_error,
    rule,
    span,
)
from ...running.files import TemporaryFolder, make_folder
from ...running.provenance import write_result
from ...running.sweep import Case, Processes, Store, run_sweep
from ..random_scenes import describe
from .wide_box import place, wide_scene

if TYPE_CHECKING:
    from analytic import Scene

    from ...running.sweep import Row

KERNEL_SECONDS = 30.0  # beyond, there is nothing to compare with: bases that shake 1e6 times a run


def bench_engines(
    engine: str,
    output: str | PathLike[str],
    *,
    scenes: int = 2000,
    seed: int = 1,
    workers: int | None = None,
    time_limit: float = 60.0,
    progress: bool = True,
) -> list[dict[str, Any]]:
    """Run scenes 0 .. scenes-1 of the ensemble `seed`; write bench-engines-ENGINE.json and return its rows.

    Parameters
    ----------
    engine : str
    output : path
        Folder for the result and the runs.
    scenes, seed : int
    workers : int or None
        Worker processes; None takes one per core.
    time_limit : float
        Of an engine's run [s]; beyond, it has failed.
    progress : bool

    Raises
    ------
    KeyError, EngineNotInstalled, SettingError
        As `get_engine` and `make_folder`.
    """
    get_engine(engine)
    output = make_folder(output)
    ensemble = [wide_scene(seed, index) for index in range(scenes)]
    with (
        Store(output / "reference.jsonl") as reference,
        Store(output / f"{engine}.jsonl") as store,
        Processes(workers, ("analytic", engine)) as executor,
    ):
        options: dict[str, Any] = dict(executor=executor, measure=keep, progress=progress)

        def model_runs(cases, label):
            return run_sweep(cases, store=reference, time_limit=KERNEL_SECONDS, label=label, **options)

        def engine_runs(cases):
            return run_sweep(cases, store=store, time_limit=time_limit, label=engine, **options)

        rows = judged(ensemble, engine, model_runs, engine_runs)
    for index, (row, scene) in enumerate(zip(rows, ensemble, strict=True)):
        row["index"] = index
        if row["class"] == "off and silent":
            row["scene"] = describe(scene)
    _write(output, rows, engine, seed, {"scenes": scenes, "time_limit": time_limit})
    return rows


def _write(output, rows, engine, seed, asked):
    known = get_engine(engine)
    write_result(
        output / f"bench-engines-{engine}.json",
        "bench engines",
        {"engine": engine, "versions": known.versions(), **asked, "variant": known.default_variant},
        rows,
        modules=("comparisons.bench.engines.run", "analytic.kernel", known.adapter),
        seed=seed,
    )


def judged(
    ensemble: Sequence[Scene],
    engine: str,
    model_runs: Callable[[list[Case], str], list[Row]],
    engine_runs: Callable[[list[Case]], list[Row]],
) -> list[dict[str, Any]]:
    """Rows of all scenes; `model_runs(cases, label)` and `engine_runs(cases)` run them, the engine only what counts."""
    models = model_runs([Case(scene) for scene in ensemble], "analytic model")
    reasons = [_unusable(scene, model) for scene, model in zip(ensemble, models, strict=True)]
    spans = [
        math.inf if reason else span(scene, model.values)
        for scene, model, reason in zip(ensemble, models, reasons, strict=True)
    ]
    counted = [k for k, reason in enumerate(reasons) if reason is None]
    runs = dict(zip(counted, engine_runs([Case(ensemble[k], engine) for k in counted]), strict=True))
    doubtful = [
        k for k, run in runs.items() if not run.failed and findings(ensemble[k], models[k].values, run.values, spans[k])
    ]
    families = [{**near_copies(ensemble[k]), **boundary_copies(ensemble[k])} for k in doubtful]
    again = iter(
        model_runs([Case(copy) for family in families for copy in family.values()], "copies of doubtful scenes")
    )
    copies = {k: {name: next(again) for name in family} for k, family in zip(doubtful, families, strict=True)}
    rows = []
    for k, (scene, model) in enumerate(zip(ensemble, models, strict=True)):
        run, off, notes, cause = runs.get(k), [], [], reasons[k]
        if cause:
            word = "left out"
        elif run.failed:
            word, cause = "failed and said", run.failure["reason"]
        else:
            sound = {name: copy.values for name, copy in copies.get(k, {}).items() if not copy.failed}
            small = {name: sound.pop(name) for name in near_copies(scene) if name in sound}
            off, notes = judge(scene, model.values, run.values, small, sound, spans[k])
            word = _WORDS[bool(off), bool(range_warnings(model.values, run.values))]
        rows.append(_row(scene, model, run, word, cause, off, notes, spans[k]))
    return rows


_WORDS = {
    (False, False): "right",
    (False, True): "right but warned",
    (True, False): "off and silent",
    (True, True): "off and warned",
}


def _unusable(scene, model):
    return model.failure["reason"] if model.failed else rule(scene, model.values)


def _row(scene, model, run, word, cause, off, notes, until):
    values = run.values if run else {}
    failure = (run.failure if run else None) or {}
    errors, warnings = {}, []
    if run and not run.failed:
        errors = {
            **peak_errors(scene, model.values, values, until),
            "restitution": restitution_error(scene, values, until),
        }
        warnings = range_warnings(model.values, values)
    return {
        "class": word,
        "cause": cause,
        "findings": off,
        "notes": notes,
        "errors": errors,
        "warnings": warnings,
        "message": failure.get("message", "")[:300],
        "outcome": values.get("outcome"),
        "expected": model.values["outcome"],
        "judged_until": None if math.isinf(until) else until,
        "cpu_seconds": run.cost.get("cpu_seconds") if run else None,
        "model_cpu_seconds": model.cost.get("cpu_seconds"),
        "simulated": scene.duration,
        "place": place(scene),
    }


def examine(
    engine: str, index: int, *, seed: int = 1, time_limit: float = 60.0
) -> tuple[Scene, dict[str, Any], dict[str, Any], dict[str, Any]]:
    """(scene, kept analytic values, kept engine values, row of the bench) of one scene, run again; nothing stored."""
    scene, seen = wide_scene(seed, index), {}
    with (
        TemporaryFolder("bench-") as folder,
        Store(Path(folder) / "runs.jsonl") as store,
        Processes(1, ("analytic", engine)) as executor,
    ):
        options: dict[str, Any] = dict(store=store, executor=executor, measure=keep, progress=False)

        def model_runs(cases, label):
            rows = run_sweep(cases, time_limit=KERNEL_SECONDS, **options) if cases else []
            seen.setdefault("analytic", rows and rows[0].values)
            return rows

        def engine_runs(cases):
            rows = run_sweep(cases or [Case(scene, engine)], time_limit=time_limit, **options)
            seen[engine] = rows[0].values
            return rows[: len(cases)]

        (row,) = judged([scene], engine, model_runs, engine_runs)
    return scene, seen["analytic"], seen[engine], {"index": index, **row}
