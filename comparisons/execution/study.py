"""Execution of a study, the same for all: runs are stored and resumed, answers are written when they are complete.

A random sample of a study's runs, stored with its result, so that they can be repeated without the plan.

Repetition of stored runs with the present code, and the number that give the same result.
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
from .files import TemporaryFolder, check_folder
from .plan import Batch, Computed, Request, Study
from .progress import log, spinner, stdout_to_stderr
from .provenance import ResultError, checkout, json_ready, made_here, record_check, save
from .solving import named_engines
from .sources import digests_of_all, package_of, source_digests, today
from .sweep import Processes, Row, Store, number_of, run_sweep

SIZE = 60  # runs stored with a result
SEED = 0  # of their choice
LONGEST, MOTIONS = 5000, 4  # of motions stored sample by sample: their length, and how many different ones
SYNTHETIC = re.compile(rf"synthetic ({'|'.join(STYLES)}) motion, seed (\d+)\b")
NAMELESS = "sampled motion"  # label of a motion that a study makes by a formula; a record has its file's name


def sample_of(runs: Iterable[tuple[Batch, Row]]) -> list[dict[str, Any]]:
    """At most `SIZE` of the runs, chosen at random, as JSON values.

    Left out are runs under recorded motions, whose values may not be passed on; under long motions made by a formula;
    and those whose measure is not a function.
    """
    known = [(batch, row) for batch, row in runs if inspect.isfunction(batch.measure)]
    found: list[dict[str, Any]] = []
    stored: set[str] = set()  # digests of motions stored sample by sample
    for batch, row in random.Random(SEED).sample(known, len(known)):
        motion = _motion_table(row.case.scene.motion)
        if motion is None or len(stored | _long(motion)) > MOTIONS:
            continue
        stored |= _long(motion)
        found.append(_run_table(batch, row, motion))
        if len(found) == SIZE:
            break
    return found


def case_of(run: Mapping[str, Any]) -> Case:
    """The case of a stored run.

    Raises
    ------
    SceneError
        It is no scene today.
    """
    scene = Scene(**{**run["scene"], "motion": _motion(run["scene"]["motion"])})
    return Case(scene, run["engine"], run["variant"], run["settings"], run["tag"])


def outcome_of(row: Row) -> dict[str, Any]:
    """What is compared of a run: its values, or of one that failed the kind of failure and the reason."""
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
    """A motion as JSON values: {} without one, None for one that is not stored."""
    if motion is None:
        return {}
    if isinstance(motion, PulseMotion):
        return asdict(motion)
    own = SYNTHETIC.match(motion.label)
    if not own and motion.label != NAMELESS:
        return None
    vertical = _motion_table(motion.vertical)
    table = {"dt": motion.dt, "label": motion.label, "warnings": list(motion.warnings), "vertical": vertical}
    if own and (factor := _factor(motion, synthetic_motion(own[1], int(own[2])))):
        return None if vertical is None else table | {"style": own[1], "seed": int(own[2]), "factor": factor}
    if vertical is None or len(motion.samples) > LONGEST:
        return None
    return table | {"samples": motion.samples.tolist(), "digest": motion.digest()}


def _factor(motion, base):
    """The number by which `base` is multiplied to give the very samples of `motion`; None if there is none."""
    if len(motion.samples) != len(base.samples):
        return None
    peak = np.abs(base.samples).argmax()
    near = float(motion.samples[peak] / base.samples[peak])
    tried = (near, float(np.nextafter(near, np.inf)), float(np.nextafter(near, -np.inf)))
    return next((factor for factor in tried if np.array_equal(base.samples * factor, motion.samples)), None)


def _long(motion):
    """Digests of what a motion's table holds sample by sample."""
    own = {motion["digest"]} if "samples" in motion else set()
    return own | (_long(motion["vertical"]) if motion.get("vertical") else set())


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
        As `comparisons.execution.cluster`.
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


DIFFERENCES_SHOWN = 3  # differences named of a run


@dataclass(frozen=True)
class Check:
    """Of a result: runs repeated, of so many stored and so many in all; what differs, a sentence a run.

    missing: engines of stored runs that are not installed here; none of their runs is drawn.
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
        """The outcome in a sentence."""
        without = f"; not installed: {', '.join(self.missing)}" if self.missing else ""
        if not self.runs:
            return f"{self.result}: nothing to check, none of its {self.total} runs can be stored{without}"
        drawn = f"drawn with seed {self.seed} from {self.stored} stored of {self.total}{without}"
        return f"{self.result}: {self.held} of {self.runs} runs hold ({drawn})"


def check_all(name: str, folder: str | PathLike[str], number: int, seed: int, **options: Any) -> list[Check]:
    """The `check` of each result of the study `name` in `folder`.

    Raises
    ------
    SettingError
        `folder` is itself a result.
    ResultError
        As `check`; or there is no such result, or none of them keeps a run.
    """
    check_parent(folder)
    own = Path(folder) / name
    parts = [own] if own.exists() else sorted(Path(folder).glob(f"{name}-*"))  # a study may have several
    checks = [check(part, number, seed, **options) for part in parts or [own]]
    if not any(one.runs for one in checks):
        raise ResultError(f"{checks[0].words()}; run rocking study {name}, which computes all of it again")
    return checks


def check(
    path: Path, number: int, seed: int, *, record: bool = False, workers: int | None = None, progress: bool = True
) -> Check:
    """Do `number` runs of the result at `path` again, drawn with `seed` from those stored.

    A run holds if all that was measured is as before, numbers within 1e-9 of themselves; CPU times are not compared.
    What a study makes of its runs is not checked. record: write the outcome into the result's provenance.

    Raises
    ------
    ResultError
        The result cannot be read, is older than this check, or the outcome cannot be recorded there.
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
        for file in path.glob("*.json"):  # those of which no run was drawn lose what an earlier check said
            own = [differs for differs, place in zip(wrong, places, strict=True) if place == file.stem]
            record_check(file, {**when, "runs": len(own), "held": own.count(None)} if own else None)
    return done


def _installed(name):
    """Whether a solver can be used here; one that is unknown is not missing but wrong, which its run will say."""
    try:
        solver(name)
    except EngineNotInstalled:
        return False
    except (KeyError, ImportError, AttributeError):
        pass
    return True


def _again(runs, workers, progress):
    """What each of the stored runs gives today (`outcome_of` and the scene's digest), or why it cannot be done."""
    found: list[Any] = [None] * len(runs)
    groups: dict[Any, list[tuple[int, Any]]] = {}
    for place, run in enumerate(runs):
        try:
            case, measure = case_of(run), resolve_name(today(run["measure"]))
            solver(case.solver)
        except (KeyError, ImportError, AttributeError, SceneError) as error:
            found[place] = f"it cannot be run any more ({error.args[0] if isinstance(error, KeyError) else error})"
        else:
            groups.setdefault((measure, run["time_limit"]), []).append((place, case))
    names = sorted({case.solver for members in groups.values() for _, case in members})
    with TemporaryFolder("check-") as folder, Processes(workers, names) as pool:
        for (measure, limit), members in groups.items():
            options: dict[str, Any] = dict(executor=pool, time_limit=limit, progress=progress, label="runs again")
            store = Path(folder) / "runs.jsonl"
            rows = run_sweep([case for _, case in members], store=store, measure=measure, **options)
            for (place, case), row in zip(members, rows, strict=True):
                found[place] = {**outcome_of(row), "digest": case.scene.digest()}
    return found


def _differ(run: Mapping[str, Any], now: Any) -> str | None:
    """In a sentence what a stored run has otherwise than today's; None where nothing."""
    if isinstance(now, str):
        return f"{_named(run)}: {now}"
    if run["failure"] != now["failure"]:
        return f"{_named(run)}: {_state(run['failure'])} when stored, now {_state(now['failure'])}"
    found = [each for part in ("digest", "values") for each in differences(part, run[part], now[part])]
    shown = "; ".join(
        f"{where}: stored {short(then)}, now {short(here)}" for where, then, here in found[:DIFFERENCES_SHOWN]
    )
    more = f"; and {len(found) - DIFFERENCES_SHOWN} more" if len(found) > DIFFERENCES_SHOWN else ""
    return f"{_named(run)}: {shown}{more}" if found else None


def _state(failure):
    return f"{failure['kind']}: {failure['reason']}" if failure else "sound"


def _named(run):
    own = ", ".join(f"{name} = {value}" for name, value in {**run["settings"], **run["tag"]}.items())
    return ", ".join(filter(None, (run["engine"], run["variant"], run["scene"]["name"], own)))
