"""Speed against error: fresh processes, warm, solvers in turn, repeated; error and CPU time from the very same runs."""

import dataclasses
import json
import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import psutil
import typer

from analytic import Impact, Response, SettingError
from analytic.rocking import restitution
from analytic.twin import simulate_twin
from engines import get_engine

from ...measuring.errors import (
    lost_impacts,
    rate_restitution,
    rms,
    state_restitution,
    strong_impacts,
    strong_time_errors,
)
from ...running.cases import Case, variant_settings
from ...running.plan import Batch, Computed, Plan, Request
from .cases import RUNS, Boundary, Entry, Trial, entries, levels_of, problem_trials, searched, trials
from .integrators import PROBLEMS, SOLVER, timed

# Why one engine's rows cannot be computed anew by themselves, see `Study.whole`.
WHOLE = "its CPU times are compared with each other, so they have to be measured together"

REPEATS, QUICK_REPEATS = 5, 3
TICK = 4e-3  # s of CPU: shorter measurements are repeated until they took as long, and the mean counts
SLOW = 0.5  # s of CPU: next to it what is loaded in a first run is nothing; such a measurement needs no warm-up
SECONDS = 1.0  # over which the load of the machine is measured
MOST_REPEATS = 200
TWIN_TOLERANCE = 1e-13  # of the independent solution each reference is compared with
EVIDENCE = 600  # characters of an engine's message that a row keeps
# A boundary search that still moves this far has found none. Where steps are fixed, the boundary depends on where in a
# step the impact falls, which differs from run to run: the root mean square of the last positions stands for it.
STRAY, LAST = 0.025, 3

Repeats = Annotated[int | None, typer.Option(min=1, max=1000, help="Fresh processes in turn. Default 5, quick 3.")]
Only = Annotated[str | None, typer.Option("--scene", metavar="NAME", help='One scene alone, as "problem A".')]


def load(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the share of the machine's CPU time that other processes take meanwhile, as nothing of ours runs [-]."""
    return {"cost": {"load": psutil.cpu_percent(SECONDS) / 100}}


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of one measurement, and its CPU time: the mean over runs of at least `TICK` in all.

    The run that made `response` has loaded code and caches; where it was long enough it is the measurement itself. A
    case whose tag holds a boundary, (amplitude, slope) of a `Boundary`, is a search for it.
    """
    if case.solver == SOLVER:
        return timed(case, TICK)
    goal = Boundary(*case.tag["boundary"]) if case.tag["boundary"] else None

    def run(scene):
        return dataclasses.replace(case, scene=scene).run()

    shifts, cpu, repeats = None, response.cpu_seconds, 1
    if goal or cpu < SLOW:
        response, shifts, cpu = searched(run, case.scene, goal)
        if 0 < cpu < TICK and response.outcome != "failed":
            repeats = min(MOST_REPEATS, math.ceil(TICK / cpu))
            cpu = sum(searched(run, case.scene, goal)[2] for _ in range(repeats)) / repeats
    cost = {"cpu_seconds": cpu / (RUNS if goal else 1), "repeats": repeats}
    values = response.to_json()
    del values["sliding"]  # no scene gives a friction
    return {**values, "boundary_shifts": shifts, "cost": cost}


def errors(trial: Trial, values: Mapping[str, Any], shifts: Sequence[float] | None = None) -> dict[str, float]:
    """Absolute errors by measure, as far as the trial has them and the run shows them; and "lost", its missed impacts.

    Parameters
    ----------
    trial : Trial
    values : dict
        `Response.to_json()` of the run, or of the first run of a boundary search.
    shifts : list of float or None
        Relative position of the boundary against the reference's, one per run of the search. A solver without a
        boundary nearby has no error "boundary_shift".
    """
    run: Any = SimpleNamespace(impacts=[Impact(**impact) for impact in values["impacts"]])
    reference, end, gamma = trial.reference, values["end"], trial.scene.block.slenderness
    times = strong_time_errors(run, reference)
    found = {"impact_time": times[np.isfinite(times)], "restitution": _restitution_errors(trial.scene, run)}
    if values["peak_tilt"] is not None:
        found["peak_tilt"] = [abs(values["peak_tilt"] - reference.peak_tilt) / gamma]
    if values["peak_base_displacement"] is not None and "peak_displacement" in trial.measures:
        found["peak_displacement"] = [abs(values["peak_base_displacement"] / reference.peak_base_displacement - 1)]
    if abs(end["time"] - trial.scene.duration) < 1e-9:
        found["end_tilt"] = [abs(abs(end["tilt"]) - abs(reference.end.tilt)) / gamma]
    if shifts and abs(shifts[-1] - shifts[-2]) < STRAY:
        found["boundary_shift"] = shifts[-LAST:]
    known = {name: rms(found[name]) for name in trial.measures if len(found.get(name, ()))}
    return {"lost": lost_impacts(run, reference), **known}


def _restitution_errors(scene, run):
    """e - eq. (7) of the impacts fast enough; under a motion e is that of the states."""
    if scene.motion is None and scene.bearings is None:
        return rate_restitution(run) - restitution(scene)
    strong: Any = SimpleNamespace(impacts=strong_impacts(run))
    return state_restitution(strong) - restitution(scene)


def plan(
    request: Request,
    scenes: Sequence[Trial] | None = None,
    keep: Callable[[Entry], bool] = lambda entry: True,
    *,
    repeats: Repeats = None,
    scene: Only = None,
) -> Plan:
    """The plan of the study: in each round, one fresh process, every solver has its turn.

    Parameters
    ----------
    request : Request
    scenes : list of Trial or None
        None: all.
    keep : callable
        Entry -> bool: which of them to run.
    repeats : int or None
        Rounds.
    scene : str or None
        Name of the one scene that is run; None: all.
    """
    rounds = repeats or (QUICK_REPEATS if request.quick else REPEATS)
    known = scenes or [*trials(), *problem_trials()]
    scenes = [trial for trial in known if scene in (None, trial.name)]
    if not scenes:
        raise SettingError(f"--scene {scene}: no such scene; give one of {', '.join(trial.name for trial in known)}")
    measured = [(entry, []) for entry in entries(scenes, request.engines, request.quick) if keep(entry)]
    loads = []
    for turn in range(rounds):
        loads += yield Batch([Case(scenes[0].scene, tag={"round": turn})], load, "load", alone=True)
        cases = [entry.case(turn) for entry, _ in measured]
        done = yield Batch(cases, measure, f"round {turn + 1} of {rounds}", alone=True)
        for (_, rows), row in zip(measured, done, strict=True):
            rows.append(row)
    settings = {
        "quick": request.quick,
        "rounds": rounds,
        "load": [one.cost["load"] for one in loads],
        "scenes": {trial.name: description(trial) for trial in scenes},
        "variants": [
            variant_settings(engine, variant, levels_of(kind, request.quick))
            for engine in request.engines
            for variant, kind in get_engine(engine).variants.items()
        ],
    }
    return Computed(settings, [_row(entry, timings) for entry, timings in measured])


def _row(entry, timings):
    """JSON-ready row of an entry from its rounds: medians of the CPU time, lowest and highest."""
    first, trial = timings[0], entry.trial
    values = first.values
    row = {
        "part": "work-precision",
        "scene": trial.name,
        "engine": entry.engine,
        "variant": entry.variant,
        "model": entry.model,
        "law": trial.scene.bearings and trial.scene.bearings.law,
        "parameter": entry.parameter,
        "level": entry.level,
        "outcome": values.get("outcome"),
        "failure": _evidence(first.failure),
        "timings": len(timings),
        "errors": {},
        "lost": None,
        "repeatable": len({json.dumps(timing.values, sort_keys=True) for timing in timings}) == 1,
    }
    seconds = [timing.cost["cpu_seconds"] for timing in timings if timing.cost.get("cpu_seconds")]
    if first.failure or not seconds:
        return row
    found = dict(values["errors"]) if "errors" in values else errors(trial, values, values["boundary_shifts"])
    cpu, simulated, steps = statistics.median(seconds), values["end"]["time"], values["steps"]
    return row | {
        "lost": found.pop("lost"),
        "errors": found,
        "cpu_seconds": cpu,
        "cpu_low": min(seconds),
        "cpu_high": max(seconds),
        "simulated": simulated,
        "steps": steps or None,
        "step": simulated / steps if steps else None,
        "cpu_per_second": cpu / simulated,
        "cpu_per_step": cpu / steps if steps else None,
        "boundary_shifts": values["boundary_shifts"],
        "settings": values["settings"],
    }


def _evidence(failure):
    if failure is None:
        return None
    return {key: str(failure[key])[:EVIDENCE] for key in ("kind", "reason", "message") if failure.get(key)}


def description(trial: Trial) -> dict[str, Any]:
    """A trial for the result file; of a problem its title and measures.

    reference_difference: errors of an independent solution, scipy DOP853 at its tightest. bouc_wen: what that law
    changes in the scene itself, relative; None without bearings.
    """

    if trial.name in PROBLEMS:
        title = f"{trial.name}, {PROBLEMS[trial.name].impacts} impacts"
        return {"title": title, "measures": list(trial.measures), "reference_difference": {}}

    def run(scene):
        return simulate_twin(scene, rtol=TWIN_TOLERANCE, history=False, energy=False)

    reference, changes = trial.reference, None
    if trial.scene.bearings:
        other = trial.with_law("bouc-wen").reference
        changes = {
            "peak_displacement": other.peak_base_displacement / reference.peak_base_displacement - 1,
            "peak_tilt": other.peak_tilt / reference.peak_tilt - 1 if reference.peak_tilt else None,
        }
    response, shifts, _ = searched(run, trial.scene, trial.boundary)
    return {
        "title": trial.scene.name,
        "duration": trial.scene.duration,
        "runs": RUNS if trial.boundary else 1,
        "measures": list(trial.measures),
        "outcome": reference.outcome,
        "impacts": len(reference.impacts),
        "slenderness": trial.scene.block.slenderness,
        "peak_tilt_ratio": reference.peak_tilt_ratio,
        "peak_base_displacement": reference.peak_base_displacement,
        "digest": trial.scene.digest(),
        "boundary_amplitude": trial.boundary and trial.boundary.amplitude,
        "reference_difference": errors(trial, response.to_json(), shifts),
        "bouc_wen": changes,
    }
