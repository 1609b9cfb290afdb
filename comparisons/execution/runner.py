"""Execution of a study, the sample of runs stored with its result, and the check that repeats them.

Every study is executed in the same way: runs are stored and resumed, results are written when they are complete. A
random sample of the runs is stored with the result, so that they can be repeated with the present code and without the
plan.
"""

from __future__ import annotations

import contextlib
import inspect
import random
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import numpy as np

from analytic import PulseMotion, SampledMotion, Scene, synthetic_motion
from analytic.errors import EngineNotInstalled, SceneError
from analytic.records.synthetic import STYLES
from engines import ENGINES, installed_engines

from .by_solver import (
    EDITED,
    MODEL,
    check_none_goes,
    check_parent,
    check_same,
    differences,
    opened,
    read,
    save_parts,
    short,
)
from .cases import Case, name_of, root_of, solver
from .cluster import Cluster
from .code_digests import digests_of_all, package_of, source_digests, today
from .command_runs import named_engines
from .plan import Batch, Computed, Request, Study
from .progress import log, spinner, stdout_to_stderr
from .results import ResultError, checkout, json_ready, made_here, record_check, save
from .sweep import Processes, Row, Store, number_of, run_sweep
from .writing import TemporaryFolder, check_folder

SIZE = 60  # runs stored with a result
SEED = 0  # of the random choice
LONGEST, MOTIONS = 5000, 4  # most samples of a motion that is stored, and most such motions
SYNTHETIC = re.compile(rf"synthetic ({'|'.join(STYLES)}) motion, seed (\d+)\b")
NAMELESS = "sampled motion"  # label of a motion that a study makes by a formula; a record is labelled by its file


def sample_of(runs: Iterable[tuple[Batch, Row]]) -> list[dict[str, Any]]:
    """Return at most `SIZE` of the runs, chosen at random, as JSON values.

    Runs under recorded motions are left out, because their values may not be passed on. So are runs under long motions
    made by a formula, and runs whose measure is no function.
    """
    known = [(batch, row) for batch, row in runs if inspect.isfunction(batch.measure)]
    sample: list[dict[str, Any]] = []
    stored: set[str] = set()  # digests of motions stored sample by sample
    for batch, row in random.Random(SEED).sample(known, len(known)):
        motion = _motion_table(row.case.scene.motion)
        if motion is None or len(stored | _long(motion)) > MOTIONS:
            continue
        stored |= _long(motion)
        sample.append(_run_table(batch, row, motion))
        if len(sample) == SIZE:
            break
    return sample


def case_of(run: Mapping[str, Any]) -> Case:
    """Return the case of a stored run.

    Raises
    ------
    SceneError
        The stored scene is no longer valid.
    """
    scene = Scene(**{**run["scene"], "motion": _motion(run["scene"]["motion"])})
    return Case(scene, run["engine"], run["variant"], run["settings"], run["tag"])


def outcome_of(row: Row) -> dict[str, Any]:
    """Return what a check compares of a run: its values or, if it failed, the kind of failure and the reason."""
    if row.failure:
        return {"values": None, "failure": {name: row.failure[name] for name in ("kind", "reason")}}
    return {"values": row.values, "failure": None}


def _run_table(batch, row, motion):
    case = row.case
    scene = {**case.scene.model_dump(exclude={"motion"}), "motion": motion}
    return {
        "engine": case.solver,
        **{name: getattr(case, name) for name in ("variant", "settings", "tag")},
        "measure": name_of(batch.measure),
        "time_limit": batch.time_limit,
        **outcome_of(row),
        "digest": case.scene.digest(),
        "scene": json_ready(scene),
    }


def _motion_table(motion):
    """A motion as JSON values: {} without a motion, None if the motion may not be stored."""
    if motion is None:
        return {}
    if isinstance(motion, PulseMotion):
        return asdict(motion)
    synthetic = SYNTHETIC.match(motion.label)
    if not synthetic and motion.label != NAMELESS:
        return None
    vertical = _motion_table(motion.vertical)
    table = {"dt": motion.dt, "label": motion.label, "warnings": list(motion.warnings), "vertical": vertical}
    if synthetic and (factor := _factor(motion, synthetic_motion(synthetic[1], int(synthetic[2])))):
        return (
            None if vertical is None else table | {"style": synthetic[1], "seed": int(synthetic[2]), "factor": factor}
        )
    if vertical is None or len(motion.samples) > LONGEST:
        return None
    return table | {"samples": motion.samples.tolist(), "digest": motion.digest()}


def _factor(motion, base):
    """The factor that turns the samples of `base` exactly into those of `motion`, or None."""
    if len(motion.samples) != len(base.samples):
        return None
    peak = np.abs(base.samples).argmax()
    near = float(motion.samples[peak] / base.samples[peak])
    tried = (near, float(np.nextafter(near, np.inf)), float(np.nextafter(near, -np.inf)))
    return next((factor for factor in tried if np.array_equal(base.samples * factor, motion.samples)), None)


def _long(motion):
    """Digests of the motions that a table holds sample by sample."""
    digests = {motion["digest"]} if "samples" in motion else set()
    return digests | (_long(motion["vertical"]) if motion.get("vertical") else set())


def _motion(table):
    if not table:
        return None
    table = {**table, "vertical": _motion(table["vertical"])}
    if "shape" in table:
        return PulseMotion(**table)
    if "style" in table:
        samples = synthetic_motion(table["style"], table["seed"]).samples * table["factor"]
    else:
        samples = np.array(table["samples"])
    return SampledMotion(table["dt"], samples, table["label"], tuple(table["warnings"]), table["vertical"])


RUNS = "runs.jsonl"  # rows of single runs, beside the result
_stored: Path | None = None  # the store of the present or last study
SHOWN = 30  # least runs of a batch that shows its progress: a bisection has many small batches


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
    """Run a study's plan and return the paths of its results in `folder`, mostly one: a folder of files by solver.

    If `engines` are named and `folder` has a result of the study, these engines are computed alone, with the options of
    that result, and their files are written beside the others (`by_solver`).

    folder: is made if it does not exist; runs found there are not repeated. engines: names; None: all that are
    installed. quick: a small version. workers: number of processes; None: one per core. scheduler: address of a Dask
    scheduler that distributes the runs, or "local:N"; timed runs are made here. progress: show it on standard error.
    options: those of the study's plan.

    Raises
    ------
    SettingError
        `folder` is a file or itself a result, the number of workers is out of range, no scheduler answers, an engine
        has no such name, or files of engines that are not named would go (`check_none_goes`).
    EngineNotInstalled
        As for `engines.get_engine`.
    ClusterError
        As for `comparisons.execution.cluster`.
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
            names = installed_engines() if engines is None else tuple(engines)  # loads engines
            roots = (name_of(study.plan), *(engine.adapter for engine in ENGINES.values()))
            code = digests_of_all(map(package_of, roots))
        solvers = ("analytic", *names)
        pool = Processes(workers, solvers) if scheduler is None else Cluster(scheduler, solvers)
        plan = study.plan(Request(names, quick), **options)
        return _carry_out(study, plan, folder, solvers, code, store, stack.enter_context(pool), progress, old)


def kept() -> str:
    """Return the sentence on the runs that an interrupted study has stored; "" if there are none."""
    if _stored is None or not _stored.exists():  # a report removes its runs when it is complete
        return ""
    with open(_stored, "rb") as file:
        count = sum(line.endswith(b"\n") for line in file)
    runs = f"{count} run{'s are' if count > 1 else ' is'} kept in {_stored}"
    return f"{runs}; the same command goes on from there." if count else ""


def _carry_out(study, plan, folder, always, code, store, pool, progress, old):
    """Run the batches of a plan, write its results and return their paths. old: `opened`, if engines run alone."""
    done: list[tuple[Batch, Row]] = []
    paths: list[Path] = []
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
                paths.append(_written(study, folder, step, list(solvers), always[1:], code, done, old))
            continue
        answer = _run(step, store, pool, progress)
        solvers.update(dict.fromkeys(case.solver for case in step.cases))
        done += [(step, row) for row in answer]
    if progress:
        reused = sum(row.reused for _, row in done)
        log(f"{len(done) - reused} runs done, {reused} found in {folder.name}/{RUNS}")
    return list(dict.fromkeys(paths))


def _written(study, folder, answer, solvers, engines, code, done, old):
    """Write an answer as a result and return its path."""
    plan, path = name_of(study.plan), folder / (answer.name or study.name)
    roots = [plan, *dict.fromkeys(map(root_of, solvers))]
    edited = [name for name, digest in source_digests(roots).items() if digest not in code]
    settings = {**answer.settings, EDITED: edited}  # the numbers are those of the code at the start
    origin: dict[str, Any] = dict(modules=roots, seed=answer.seed, runs=sample_of(done), run_count=len(done))
    result = made_here(study.name, settings, answer.rows, answer.arrays, **origin)
    if not study.by_solver:
        return save(path.with_suffix(".json"), result)
    if old is not None:
        check_same(study, old, result, engines)
    counts = dict.fromkeys(solvers, 0) | Counter(row.case.solver for _, row in done)
    return save_parts(path, result, plan, engines, counts, only=old is not None)


def _leave_nothing_empty(folder):
    """Remove an empty store that an error left, and the folder if nothing else is in it."""
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


DIFFERENCES_SHOWN = 3  # differences of a run that a sentence names


@dataclass(frozen=True)
class Check:
    """The outcome of a check of a result.

    runs: number of runs repeated, of the `stored` ones, of `total` runs of the study. differences: a sentence for each
    run that differs. missing: engines that are not installed here, whose stored runs were not drawn.
    """

    result: str
    seed: int
    runs: int
    stored: int
    total: int
    differences: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    @property
    def held(self) -> int:
        return self.runs - len(self.differences)

    def words(self) -> str:
        """Return the outcome in a sentence."""
        without = f"; not installed: {', '.join(self.missing)}" if self.missing else ""
        if not self.runs:
            return f"{self.result}: nothing to check, none of its {self.total} runs can be stored{without}"
        drawn = f"drawn with seed {self.seed} from {self.stored} stored of {self.total}{without}"
        return f"{self.result}: {self.held} of {self.runs} runs hold ({drawn})"


def check_all(name: str, folder: str | PathLike[str], number: int, seed: int, **options: Any) -> list[Check]:
    """Return the `check` of each result of the study `name` in `folder`.

    Raises
    ------
    SettingError
        `folder` is itself a result.
    ResultError
        As for `check`; or there is no such result, or no result has a stored run.
    """
    check_parent(folder)
    path = Path(folder) / name
    parts = [path] if path.exists() else sorted(Path(folder).glob(f"{name}-*"))  # a study may have several
    checks = [check(part, number, seed, **options) for part in parts or [path]]
    if not any(done.runs for done in checks):
        raise ResultError(f"{checks[0].words()}; run rocking study {name}, which computes all of it again")
    return checks


def check(
    path: Path, number: int, seed: int, *, record: bool = False, workers: int | None = None, progress: bool = True
) -> Check:
    """Repeat `number` runs of the result at `path`, drawn with `seed` from the stored ones.

    A run holds if all that was measured is as before, numbers to a relative 1e-9. CPU times are not compared, and what
    the study derives from its runs is not checked. record: write the outcome into the result's provenance.

    Raises
    ------
    ResultError
        The result cannot be read or was written before runs were stored, or the outcome cannot be written into it.
    """
    result = read(path)
    if result.run_count is None:
        raise ResultError(f"{path.name}: was written before runs were stored; run rocking study {result.kind}")
    missing = [name for name in dict.fromkeys(run["engine"] for run in result.runs) if not _installed(name)]
    able = [run for run in result.runs if run["engine"] not in missing]
    drawn = random.Random(seed).sample(able, min(number, len(able)))
    again = _again(drawn, workers, progress) if drawn else []
    wrong = [_differ(run, now) for run, now in zip(drawn, again, strict=True)]
    done = Check(path.name, seed, len(drawn), len(able), result.run_count, tuple(filter(None, wrong)), tuple(missing))
    if record:
        when = {"date": datetime.now(UTC).date().isoformat(), **checkout(), "seed": seed}
        places = [run["engine"] if (path / f"{run['engine']}.json").exists() else MODEL for run in drawn]
        for file in path.glob("*.json"):  # a file of which no run was drawn loses its earlier check
            in_file = [differs for differs, place in zip(wrong, places, strict=True) if place == file.stem]
            record_check(file, {**when, "runs": len(in_file), "held": in_file.count(None)} if in_file else None)
    return done


def _installed(name):
    """Whether a solver can be used here. True for an unknown one: its run then gives the error."""
    try:
        solver(name)
    except EngineNotInstalled:
        return False
    except (KeyError, ImportError, AttributeError):
        pass
    return True


def _again(runs, workers, progress):
    """`outcome_of` each stored run today, with the scene's digest, or a sentence why it cannot be run."""
    results: list[Any] = [None] * len(runs)
    groups: dict[Any, list[tuple[int, Any]]] = {}
    for place, run in enumerate(runs):
        try:
            case, measure = case_of(run), resolve_name(today(run["measure"]))
            solver(case.solver)
        except (KeyError, ImportError, AttributeError, SceneError) as error:
            results[place] = f"it cannot be run any more ({error.args[0] if isinstance(error, KeyError) else error})"
        else:
            groups.setdefault((measure, run["time_limit"]), []).append((place, case))
    names = sorted({case.solver for members in groups.values() for _, case in members})
    with TemporaryFolder("check-") as folder, Processes(workers, names) as pool:
        for (measure, limit), members in groups.items():
            options: dict[str, Any] = dict(executor=pool, time_limit=limit, progress=progress, label="runs again")
            store = Path(folder) / "runs.jsonl"
            rows = run_sweep([case for _, case in members], store=store, measure=measure, **options)
            for (place, case), row in zip(members, rows, strict=True):
                results[place] = {**outcome_of(row), "digest": case.scene.digest()}
    return results


def _differ(run: Mapping[str, Any], now: Any) -> str | None:
    """In a sentence how a stored run differs from today's, or None."""
    if isinstance(now, str):
        return f"{_named(run)}: {now}"
    if run["failure"] != now["failure"]:
        return f"{_named(run)}: {_state(run['failure'])} when stored, now {_state(now['failure'])}"
    changes = [each for part in ("digest", "values") for each in differences(part, run[part], now[part])]
    shown = "; ".join(
        f"{where}: stored {short(then)}, now {short(here)}" for where, then, here in changes[:DIFFERENCES_SHOWN]
    )
    more = f"; and {len(changes) - DIFFERENCES_SHOWN} more" if len(changes) > DIFFERENCES_SHOWN else ""
    return f"{_named(run)}: {shown}{more}" if changes else None


def _state(failure):
    return f"{failure['kind']}: {failure['reason']}" if failure else "sound"


def _named(run):
    details = ", ".join(f"{name} = {value}" for name, value in {**run["settings"], **run["tag"]}.items())
    return ", ".join(filter(None, (run["engine"], run["variant"], run["scene"]["name"], details)))
