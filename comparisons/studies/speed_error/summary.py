"""The speed-error study's plan: fresh processes, warm, solvers in turn, repeated; rows with medians and spread."""

import json
import statistics
from collections.abc import Callable, Sequence
from typing import Annotated

import numpy as np
import typer

from analytic.twin import simulate_twin

from ...running.study import Ask, Batch, Found, Plan
from . import growth, timing
from .ladders import Entry, applied_impacts, entries
from .measure import errors
from .scenes import Trial, description, trials

REPEATS, QUICK_REPEATS = 5, 3
SLOW = 0.5  # s of CPU: such measurements are repeated `FEW` times only
FEW = 3
TWIN_TOLERANCE = 1e-13  # of the independent solution each reference is held against
EVIDENCE = 600  # characters of an engine's message that a row keeps

Repeats = Annotated[int | None, typer.Option(min=1, max=1000, help="Fresh processes in turn. Default 5, quick 3.")]


def plan(
    ask: Ask,
    scenes: Sequence[Trial] | None = None,
    keep: Callable[[Entry], bool] = lambda entry: True,
    grow: bool = True,
    *,
    repeats: Repeats = None,
) -> Plan:
    """The plan of the study: in each round, one fresh process, every solver has its turn.

    Parameters
    ----------
    ask : Ask
    scenes : list of Trial or None
        None: all five.
    keep : callable
        Entry -> bool: which of them to run.
    grow : bool
        Whether to measure the growth of cost too.
    repeats : int or None
        Rounds.
    """
    rounds = repeats or (QUICK_REPEATS if ask.quick else REPEATS)
    scenes = scenes or trials()
    chosen = [entry for entry in entries(scenes, ask.engines, ask.quick) if keep(entry)]
    measured = [[] for _ in chosen]
    for turn in range(rounds):
        taking_part = [index for index, rows in enumerate(measured) if turn < FEW or not _slow(rows[0])]
        done = yield Batch(
            [chosen[i].case(turn) for i in taking_part], timing.measure, f"round {turn + 1} of {rounds}", alone=True
        )
        for index, row in zip(taking_part, done, strict=True):
            measured[index].append(row)
    rows = [_row(entry, timings) for entry, timings in zip(chosen, measured, strict=True)]
    seconds = np.full((len(rows), rounds), np.nan)
    for line, timings in zip(seconds, measured, strict=True):
        line[: len(timings)] = [row.cost.get("cpu_seconds", np.nan) for row in timings]
    if grow:
        rows += yield from _growth(scenes, ask, rounds)
    settings = {
        "quick": ask.quick,
        "rounds": rounds,
        "scenes": {
            trial.name: description(trial) | {"reference_difference": reference_difference(trial)} for trial in scenes
        },
        "laws": _laws(scenes),
        "applied_impacts": applied_impacts(ask.engines),
    }
    return Found(settings, rows, {"cpu_seconds": seconds})


def _slow(row):
    return row.cost.get("cpu_seconds", 0.0) > SLOW


def _row(entry, timings):
    """JSON-ready row of an entry from its rounds."""
    first = timings[0]
    values, trial = first.values, entry.trial
    row = {
        "table": "ladder",
        "scene": trial.name,
        "family": entry.family,
        "model": entry.model,
        "law": entry.law or (trial.scene.bearings and trial.scene.bearings.law),
        "solver": entry.solver,
        "variant": entry.variant,
        "knob": entry.knob,
        "value": entry.value,
        "outcome": values.get("outcome"),
        "failure": _evidence(first.failure),
        "timings": len(timings),
        "errors": {},
        "lost_impacts": None,
        "repeatable": len({_bits(timing.values) for timing in timings}) == 1,
    }
    seconds = [timing.cost["cpu_seconds"] for timing in timings if timing.cost.get("cpu_seconds")]
    if first.failure or not seconds:
        return row
    shifts = values["boundary_shifts"]
    row["errors"] = errors(trial, values, shifts)
    row["lost_impacts"] = row["errors"].pop("lost_impacts", None)
    cpu, simulated, steps = statistics.median(seconds), values["end"]["time"], values["steps"]
    row |= {
        "cpu_seconds": cpu,
        "cpu_low": min(seconds),
        "cpu_high": max(seconds),
        "simulated": simulated,
        "steps": steps or None,
        "step": simulated / steps if steps else None,
        "cpu_per_second": cpu / simulated,
        "cpu_per_step": cpu / steps if steps else None,
        "boundary_shifts": shifts,
        "settings": values["settings"],
    }
    return row


def _bits(values):
    """What must not differ from round to round, as text."""
    return json.dumps(values, sort_keys=True)


def _evidence(failure):
    if failure is None:
        return None
    return {key: str(failure[key])[:EVIDENCE] for key in ("kind", "reason", "message") if failure.get(key)}


def _growth(scenes, ask, rounds):
    """Rows of growth: each measurement in a process of its own, so that none finds memory another has left."""
    rows = []
    for place in growth.points(scenes, ask.engines, ask.quick):
        turns = []
        for turn in range(min(FEW, rounds)):
            turns += yield Batch([place.case(turn)], growth.grown, f"growth against {place.against}", alone=True)
        sound = [each for each in turns if not each.failed]
        row = {
            "table": "growth",
            "family": place.family,
            "against": place.against,
            "value": place.value,
            "failure": _evidence(turns[0].failure),
        }
        if sound:
            row["cpu_seconds"] = statistics.median(each.cost["cpu_seconds"] for each in sound)
            for name in ("traced_bytes", "resident_bytes"):
                known = [each.values[name] for each in sound if each.values[name] is not None]
                row[name] = statistics.median(known) if known else None
        rows.append(row)
    return rows


def _laws(scenes):
    """What another bearing law changes in the scenes themselves: peak displacement and tilt, relative."""
    effects = {}
    for trial in scenes:
        if trial.scene.bearings:
            other = trial.with_law("bouc-wen").reference
            effects[trial.name] = {
                "peak_displacement": other.peak_base_displacement / trial.reference.peak_base_displacement - 1,
                "peak_tilt": other.peak_tilt / trial.reference.peak_tilt - 1 if trial.reference.peak_tilt else None,
            }
    return effects


def reference_difference(trial: Trial) -> dict[str, float]:
    """What an independent solution (scipy DOP853 at its tightest) differs by: a dict as `errors` gives it."""

    def run(scene):
        return simulate_twin(scene, rtol=TWIN_TOLERANCE, history=False, energy=False)

    response, shifts = timing.searched(run, trial.scene, trial.boundary)
    return errors(trial, response.to_json(), shifts)
