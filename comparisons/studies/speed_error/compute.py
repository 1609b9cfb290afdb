"""The speed-error study's runs: fresh processes, warm, solvers in turn, repeated; rows with medians and spread."""

import json
import statistics
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from engines import installed_engines

from ...bench.analytic_bench import peer_versions
from ...running.executors import Processes
from ...running.provenance import write_result
from ...running.sources import source_digests
from ...running.store import Store
from ...running.sweep import Case, run_sweep
from . import growth
from .ladders import RUNNER, entries, modules
from .measure import errors
from .scenes import description, trials

KIND = "speed-error"
REPEATS, QUICK_REPEATS = 5, 3
SLOW = 0.5  # s of CPU: such measurements are repeated `FEW` times only
FEW = 3
TIME_LIMIT = 300.0
EVIDENCE = 600  # characters of an engine's message that a row keeps
OWN = ("comparisons.studies.speed_error.compute", "comparisons.studies.speed_error.timing", "analytic")


def run_study(output, *, quick=False, repeats=None, progress=True, scenes=None, keep=lambda entry: True, grow=True):
    """Run what is not yet in the store and write ``speed-error.json`` (and ``.npz``) into `output`; returns its path.

    Parameters
    ----------
    output : path
        Folder; runs done are kept in its ``.sweep`` and not run again.
    quick : bool
        Short ladders, under two minutes.
    repeats : int or None
        Rounds; each is one fresh process in which every solver has its turn.
    progress : bool
        Bars with the remaining time on standard error.
    scenes : list of Trial or None
        None: all five.
    keep : callable
        Entry -> bool: which of them to run.
    grow : bool
        Whether to measure the growth of cost too.
    """
    output = Path(output)
    rounds = repeats or (QUICK_REPEATS if quick else REPEATS)
    scenes = scenes or trials()
    chosen = [entry for entry in entries(scenes, quick) if keep(entry)]
    code = [*OWN, *modules(chosen)]
    before = source_digests(code)
    with Store(output / ".sweep" / f"{KIND}.jsonl") as store:
        measured = _rounds(chosen, rounds, store, progress)
        grown = _growth(scenes, quick, rounds, store, progress) if grow else []
    rows = [_row(entry, found) for entry, found in zip(chosen, measured, strict=True)]
    seconds = np.full((len(rows), rounds), np.nan)
    for line, found in zip(seconds, measured, strict=True):
        line[:len(found)] = [one.cost.get("cpu_seconds", np.nan) for one in found]
    settings = {"quick": quick, "rounds": rounds, "scenes": {trial.name: description(trial) for trial in scenes},
                "laws": _laws(scenes), "peers": peer_versions(),
                "changed_while_running": _changed(before, source_digests(code))}
    return write_result(output / f"{KIND}.json", KIND, settings, rows + grown, {"cpu_seconds": seconds},
                        modules=code)


def _changed(before, after):
    """Names of modules whose code was edited while the study ran: their numbers are those of the code before."""
    return sorted(name for name in {*before, *after} if before.get(name) != after.get(name))


def _rounds(chosen, rounds, store, progress):
    """For each entry its sweep rows, one per round it took part in."""
    names = [RUNNER, *installed_engines()]
    found = [[] for _ in chosen]
    for turn in range(rounds):
        taking_part = [index for index, rows in enumerate(found) if turn < FEW or not _slow(rows[0])]
        cases = [Case(chosen[i].scene, RUNNER, None, chosen[i].arguments(turn)) for i in taking_part]
        with Processes(1, names) as executor:
            done = run_sweep(cases, store=store, executor=executor, time_limit=TIME_LIMIT, progress=progress,
                             label=f"round {turn + 1} of {rounds}")
        for index, row in zip(taking_part, done, strict=True):
            found[index].append(row)
    return found


def _slow(row):
    return row.cost.get("cpu_seconds", 0.0) > SLOW


def _row(entry, found):
    """JSON-ready row of an entry from its rounds."""
    first = found[0]
    values, trial = first.values, entry.trial
    row = {"table": "ladder", "scene": trial.name, "family": entry.family, "model": entry.model,
           "law": entry.law or (trial.scene.bearings and trial.scene.bearings.law), "solver": entry.solver,
           "variant": entry.variant, "knob": entry.knob, "value": entry.value, "outcome": values.get("outcome"),
           "failure": _evidence(first.failure), "timings": len(found), "errors": {}, "lost_impacts": None,
           "repeatable": len({_bits(one.values) for one in found}) == 1}
    seconds = [one.cost["cpu_seconds"] for one in found if one.cost.get("cpu_seconds")]
    if first.failure or not seconds:
        return row
    chosen = dict(values["settings"])
    shifts, _, _ = (chosen.pop(name, None) for name in ("boundary_shifts", "repeats", "knows_impacts"))
    row["errors"] = errors(trial, values, shifts)
    row["lost_impacts"] = row["errors"].pop("lost_impacts", None)
    cpu, simulated, steps = statistics.median(seconds), values["end"]["time"], values["steps"]
    row |= {"cpu_seconds": cpu, "cpu_low": min(seconds), "cpu_high": max(seconds), "simulated": simulated,
            "steps": steps or None, "step": simulated / steps if steps else None,
            "cpu_per_second": cpu / simulated, "cpu_per_step": cpu / steps if steps else None,
            "boundary_shifts": shifts, "settings": chosen}
    return row


def _bits(values):
    """What must not differ from round to round, as text."""
    settings = {key: value for key, value in values.get("settings", {}).items() if key != "repeats"}
    return json.dumps({**values, "settings": settings}, sort_keys=True)


def _evidence(failure):
    if failure is None:
        return None
    return {key: str(failure[key])[:EVIDENCE] for key in ("kind", "reason", "message") if failure.get(key)}


def _growth(scenes, quick, rounds, store, progress):
    """Rows of growth: each measurement in a process of its own, so that none finds memory another has left."""
    places = growth.points(scenes, quick, installed_engines())
    rows = []
    for place in track(places, "growth of cost", console=Console(stderr=True), disable=not progress):
        found = []
        for turn in range(min(FEW, rounds)):
            case = Case(place.scene, growth.RUNNER, None, place.arguments(turn))
            with Processes(1, [growth.RUNNER, place.solver]) as executor:
                found += run_sweep([case], store=store, executor=executor, time_limit=TIME_LIMIT, progress=False)
        sound = [one for one in found if not one.failed]
        row = {"table": "growth", "family": place.family, "against": place.against, "value": place.value,
               "failure": _evidence(found[0].failure)}
        if sound:
            row["cpu_seconds"] = statistics.median(one.cost["cpu_seconds"] for one in sound)
            for name in ("traced_bytes", "resident_bytes"):
                known = [one.values["settings"][name] for one in sound if one.values["settings"][name] is not None]
                row[name] = statistics.median(known) if known else None
        rows.append(row)
    return rows


def _laws(scenes):
    """What another bearing law changes in the scenes themselves: peak displacement and tilt, relative."""
    found = {}
    for trial in scenes:
        if trial.scene.bearings:
            other = trial.with_law("bouc-wen").reference
            found[trial.name] = {
                "peak_displacement": other.peak_base_displacement / trial.reference.peak_base_displacement - 1,
                "peak_tilt": other.peak_tilt / trial.reference.peak_tilt - 1 if trial.reference.peak_tilt else None}
    return found
