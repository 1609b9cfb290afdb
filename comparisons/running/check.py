"""Repetition of stored runs with the present code, and the number that give the same result."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from analytic.errors import EngineNotInstalled, SceneError

from .by_solver import MODEL, check_parent, differences, read, short
from .cases import solver
from .executors import Processes
from .files import TemporaryFolder
from .provenance import ResultError, checkout, record_check
from .run_sample import case_of, outcome_of
from .sources import today
from .sweep import run_sweep

SHOWN = 3  # differences named of a run


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
    shown = "; ".join(f"{where}: stored {short(then)}, now {short(here)}" for where, then, here in found[:SHOWN])
    more = f"; and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    return f"{_named(run)}: {shown}{more}" if found else None


def _state(failure):
    return f"{failure['kind']}: {failure['reason']}" if failure else "sound"


def _named(run):
    own = ", ".join(f"{name} = {value}" for name, value in {**run["settings"], **run["tag"]}.items())
    return ", ".join(filter(None, (run["engine"], run["variant"], run["scene"]["name"], own)))
