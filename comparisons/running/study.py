"""Execution of a study, the same for all: runs are stored and resumed, answers are written when they are complete."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterable
from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from engines import ENGINES, installed_engines

from .cases import name_of, root_of
from .cluster import Cluster
from .executors import Processes, number_of
from .files import check_folder
from .merge import merged, opened, the_one
from .plan import Batch, Computed, Request, Study
from .progress import log, spinner, stdout_to_stderr
from .provenance import made_here, save
from .run_sample import sample_of
from .solving import named_engines
from .sources import digests_of_all, package_of, source_digests
from .sweep import Row, Store, run_sweep

if TYPE_CHECKING:
    from .provenance import Result

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
    into: str | PathLike[str] | None = None,
    **options: Any,
) -> list[Path]:
    """Run a study's plan; returns the paths of its result files in `folder`, mostly one.

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
    into : path or None
        A result file of the study, whose rows of the `engines` are replaced (`merge`), in place of files in `folder`.
    **options
        Of the study's plan; with `into` those that differ from their defaults there.

    Raises
    ------
    SettingError
        `folder` is a file, the number of workers is out of range, no scheduler answers, or an engine has no such name.
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
    if into is not None:
        old, quick, options = opened(study, into, quick, options)
    workers, folder = number_of(workers), Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        stack.enter_context(stdout_to_stderr())  # engines print on import
        store = stack.enter_context(Store(folder / RUNS))
        stack.callback(_leave_nothing_empty, folder)
        _stored = store.path
        with spinner(f"{study.name}: engines and code") if progress else contextlib.nullcontext():
            # loads engines: after what is wrong with the place was found
            asked = installed_engines() if engines is None else named_engines(engines)
            roots = (name_of(study.plan), *(engine.adapter for engine in ENGINES.values()))
            code = digests_of_all(map(package_of, roots))
        solvers = ("analytic", *asked)
        pool = Processes(workers, solvers) if scheduler is None else Cluster(scheduler, solvers)
        plan = study.plan(Request(asked, quick), **options)
        keep = save if into is None else _keep
        found, runs = _carry_out(study, plan, folder, solvers, code, store, stack.enter_context(pool), progress, keep)
    if into is None:
        return list(found)
    return [save(into, merged(study, old, the_one(found, Path(into)), asked, runs))]


def kept() -> str:
    """What is said when a study is ended early: how many runs are kept; "" where none are."""
    if _stored is None or not _stored.exists():  # a report that has its runs removes them
        return ""
    with open(_stored, "rb") as file:
        count = sum(line.endswith(b"\n") for line in file)
    runs = f"{count} run{'s are' if count > 1 else ' is'} kept in {_stored}"
    return f"{runs}; the same command goes on from there." if count else ""


def _keep(path, result):
    """What is to be merged is not written by itself."""


def _carry_out(study, plan, folder, always, code, store, pool, progress, keep):
    """Run what the plan asks for, and keep what it finds; ({path: result}, how many runs of each solver)."""
    done: list[tuple[Batch, Row]] = []
    found: dict[Path, Result] = {}
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
            modules = [name_of(study.plan), *dict.fromkeys(map(root_of, solvers))]
            path = folder / f"{step.name or study.name}.json"
            edited = [name for name, digest in source_digests(modules).items() if digest not in code]
            settings = {**step.settings, "changed_while_running": edited}  # its numbers are of the code before
            origin: dict[str, Any] = dict(modules=modules, seed=step.seed, runs=sample_of(done), run_count=len(done))
            found[path] = made_here(study.name, settings, step.rows, step.arrays, **origin)
            keep(path, found[path])
            continue
        answer = _run(step, store, pool, progress)
        solvers.update(dict.fromkeys(case.solver for case in step.cases))
        done += [(step, row) for row in answer]
    if progress:
        reused = sum(row.reused for _, row in done)
        log(f"{len(done) - reused} runs done, {reused} found in {folder.name}/{RUNS}")
    return found, Counter(row.case.solver for _, row in done)


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
