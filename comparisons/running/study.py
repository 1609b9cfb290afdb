"""Execution of a study, the same for all: runs are stored and resumed, answers are written when they are complete."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterable
from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Any

from engines import ENGINES, installed_engines

from .by_solver import EDITED, MODEL, check_none_goes, check_parent, check_same, opened, save_parts
from .cases import name_of, root_of
from .cluster import Cluster
from .executors import Processes, number_of
from .files import check_folder
from .plan import Batch, Computed, Request, Study
from .progress import log, spinner, stdout_to_stderr
from .provenance import made_here, save
from .run_sample import sample_of
from .solving import named_engines
from .sources import digests_of_all, package_of, source_digests
from .sweep import Row, Store, run_sweep

RUNS = "runs.jsonl"  # rows of single runs, beside the result
_stored: Path | None = None  # where the runs are of the study under way, or of the last one
SHOWN = 30  # runs from which on a batch shows its progress; a bisection has many small ones, what is timed takes long


def compute(
    study: Study,
    folder: str | PathLike[str],
    *,
    engines: Iterable[str] | None = None,
    quick: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: bool = True,
    **options: Any,
) -> list[Path]:
    """Run a study's plan; returns the paths of its results in `folder`, mostly one: a folder of files by solver.

    Where `engines` are named and there is a result of the study, they are computed alone, with the options that it was
    computed with, and their files are written beside those of the others (`by_solver`).

    Parameters
    ----------
    study : Study
    folder : path
        Made if it does not exist. Runs already found there are not repeated.
    engines : iterable of str or None
        Those to compare; None: all that are installed.
    quick : bool
        A first look.
    workers : int or None
        Worker processes; None: one per core.
    scheduler : str or None
        Address of a Dask scheduler whose workers do the runs, or "local:N". What is timed is done here all the same.
    progress : bool
        Show it on standard error.
    **options
        Of the study's plan.

    Raises
    ------
    SettingError
        `folder` is a file or itself a result, the number of workers is out of range, no scheduler answers, an engine
        has no such name, or files of engines that are not named would go (`check_none_goes`).
    EngineNotInstalled
        As `engines.get_engine`.
    ClusterError
        As `comparisons.running.cluster`.
    StoreError
        Another study is writing there.
    ResultError
        The answer cannot be written as a result file.
    """
    global _stored
    check_folder(folder)
    check_parent(folder)
    workers, folder = number_of(workers), Path(folder)
    place, old = folder / study.name, None
    if engines:
        with stdout_to_stderr():  # engines print on import
            engines = named_engines(engines)
        check_none_goes(study, folder, engines)
    folder.mkdir(parents=True, exist_ok=True)
    if engines and not study.whole and (place / f"{MODEL}.json").exists():
        old, quick, options = opened(study, place, quick, options)
    with ExitStack() as stack:
        stack.enter_context(stdout_to_stderr())  # engines print on import
        store = stack.enter_context(Store(folder / RUNS))
        stack.callback(_leave_nothing_empty, folder)
        _stored = store.path
        with spinner(f"{study.name}: engines and code") if progress else contextlib.nullcontext():
            # loads engines: after what is wrong with the place was found
            asked = installed_engines() if engines is None else tuple(engines)
            roots = (name_of(study.plan), *(engine.adapter for engine in ENGINES.values()))
            code = digests_of_all(map(package_of, roots))
        solvers = ("analytic", *asked)
        pool = Processes(workers, solvers) if scheduler is None else Cluster(scheduler, solvers)
        plan = study.plan(Request(asked, quick), **options)
        return _carry_out(study, plan, folder, solvers, code, store, stack.enter_context(pool), progress, old)


def kept() -> str:
    """What is said when a study is ended early: how many runs are kept; "" where none are."""
    if _stored is None or not _stored.exists():  # a report that has its runs removes them
        return ""
    with open(_stored, "rb") as file:
        count = sum(line.endswith(b"\n") for line in file)
    runs = f"{count} run{'s are' if count > 1 else ' is'} kept in {_stored}"
    return f"{runs}; the same command goes on from there." if count else ""


def _carry_out(study, plan, folder, always, code, store, pool, progress, old):
    """Run what the plan asks for, and write what it finds; the paths. old: see `opened`, where engines run alone."""
    done: list[tuple[Batch, Row]] = []
    found: list[Path] = []
    answer, ended = None, False
    solvers = dict.fromkeys(always)
    while not ended:
        try:
            step = plan.send(answer)
        except StopIteration as stop:
            step, ended = stop.value, True
        if isinstance(step, Computed):
            answer = None
            solvers.update(dict.fromkeys(step.solvers))
            if ended or old is None:
                found.append(_written(study, folder, step, list(solvers), always[1:], code, done, old))
            continue
        answer = _run(step, store, pool, progress)
        solvers.update(dict.fromkeys(case.solver for case in step.cases))
        done += [(step, row) for row in answer]
    if progress:
        reused = sum(row.reused for _, row in done)
        log(f"{len(done) - reused} runs done, {reused} found in {folder.name}/{RUNS}")
    return list(dict.fromkeys(found))


def _written(study, folder, answer, solvers, engines, code, done, old):
    """The path at which an answer was written."""
    plan, path = name_of(study.plan), folder / (answer.name or study.name)
    roots = [plan, *dict.fromkeys(map(root_of, solvers))]
    edited = [name for name, digest in source_digests(roots).items() if digest not in code]
    settings = {**answer.settings, EDITED: edited}  # its numbers are of the code before
    origin: dict[str, Any] = dict(modules=roots, seed=answer.seed, runs=sample_of(done), run_count=len(done))
    result = made_here(study.name, settings, answer.rows, answer.arrays, **origin)
    if not study.by_solver:
        return save(path.with_suffix(".json"), result)
    if old is not None:
        check_same(study, old, result, engines)
    counts = dict.fromkeys(solvers, 0) | Counter(row.case.solver for _, row in done)
    return save_parts(path, result, plan, engines, counts, only=old is not None)


def _leave_nothing_empty(folder):
    """Remove what a mistake left: an empty store, and the folder if nothing else is there."""
    with contextlib.suppress(OSError):
        if (folder / RUNS).stat().st_size == 0:
            (folder / RUNS).unlink()
            folder.rmdir()


def _run(batch, store, pool, progress):
    shown = progress and (batch.long or len(batch.cases) >= (2 if batch.alone else SHOWN))
    options = dict(store=store, measure=batch.measure, time_limit=batch.time_limit, progress=shown, label=batch.label)
    if not batch.alone:
        return run_sweep(batch.cases, executor=pool, **options)
    with Processes(1, sorted({case.solver for case in batch.cases})) as executor:
        return run_sweep(batch.cases, executor=executor, **options)
