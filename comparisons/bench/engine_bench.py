"""``rocking bench engines``: an engine's default variant against the analytic model on random scenes of a wide box.

    rows = bench_engines("exudyn", "bench-engines", scenes=2000, seed=1, workers=2)

A row a scene: its class (`engine_verdicts.CLASSES`), what was found, the warnings, and where in the box it lies. All
runs are kept in the folder (reference.jsonl: analytic model, ENGINE.jsonl: engine): what is there and whose code has
not changed is not run again, so that a broken-off bench goes on, and a mended engine costs the engine's runs alone.
`examine` runs one scene again.
"""

import math
from pathlib import Path

from analytic.errors import SettingError
from engines import get_engine

from ..provenance import write_result
from ..sweep import Case, Row, Store, run_sweep
from .engine_verdicts import (
    boundary_twins,
    findings,
    judge,
    keep,
    near_twins,
    peak_errors,
    restitution_error,
    rule,
)
from .random_scenes import describe
from .wide_box import place, wide_scene

KERNEL_SECONDS = 30.0  # beyond, there is nothing to compare with: bases that shake 1e6 times a run


def bench_engines(engine, output, *, scenes=2000, seed=1, workers=None, time_limit=60.0, progress=True):
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
    KeyError, EngineNotInstalled
        As `get_engine`.
    SettingError
        The folder cannot be made.
    """
    get_engine(engine)
    output = Path(output)
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SettingError(f"--output {output.name}: no folder can be made there ({error.strerror})") from error
    ensemble = [wide_scene(seed, index) for index in range(scenes)]
    with Store(output / "reference.jsonl") as reference, Store(output / f"{engine}.jsonl") as store:
        options = dict(workers=workers, reduce=keep, progress=progress)

        def model_runs(cases, label):
            return run_sweep(cases, store=reference, time_limit=KERNEL_SECONDS, label=label, **options)

        models = model_runs([Case(scene) for scene in ensemble], "analytic model")
        runs = run_sweep([Case(scene, engine) for scene in ensemble], store=store, time_limit=time_limit,
                         label=engine, **options)
        rows = judged(ensemble, models, runs, model_runs)
    for index, (row, scene) in enumerate(zip(rows, ensemble, strict=True)):
        row["index"] = index
        if row["class"] == "off and silent":
            row["scene"] = describe(scene)
    settings = {"engine": engine, "versions": get_engine(engine).versions(), "scenes": scenes, "time_limit": time_limit,
                "variant": get_engine(engine).DEFAULT_VARIANT}
    write_result(output / f"bench-engines-{engine}.json", "bench engines", settings, rows,
                 modules=("comparisons.bench.engine_bench", "analytic.kernel", get_engine(engine).__name__), seed=seed)
    return rows


def judged(ensemble, models, runs, model_runs):
    """Rows of all scenes; `model_runs(cases, label)` runs twins of those that need them."""
    rows, spans = [None] * len(ensemble), [math.inf] * len(ensemble)
    cut = []  # overturning ones that may be left out: is the model sound up to the unstable point?
    for k, (scene, model) in enumerate(zip(ensemble, models, strict=True)):
        reason = _unusable(scene, model)
        if reason and not model.failed and model.values["outcome"] == "overturns" and model.values["unstable"]:
            cut.append(k)
        elif reason:
            rows[k] = _row(scene, model, runs[k], "left out", cause=reason)
    upto = model_runs([Case(ensemble[k].with_(duration=models[k].values["unstable"])) for k in cut],
                      "up to the unstable point")
    for k, model in zip(cut, upto, strict=True):
        reason = _unusable(ensemble[k], model)
        if reason:
            rows[k] = _row(ensemble[k], models[k], runs[k], "left out", cause=reason)
        else:
            spans[k] = models[k].values["unstable"]
    doubtful = []
    for k, (scene, model, run) in enumerate(zip(ensemble, models, runs, strict=True)):
        if rows[k] is None and run.failed:
            rows[k] = _row(scene, model, run, "failed and said", cause=run.failure["reason"])
        elif rows[k] is None and findings(scene, model.values, run.values, spans[k]):
            doubtful.append(k)
    twins = [{**near_twins(ensemble[k]), **boundary_twins(ensemble[k])} for k in doubtful]
    found = iter(model_runs([Case(twin) for family in twins for twin in family.values()], "twins of doubtful scenes"))
    twins = {k: {name: next(found) for name in family} for k, family in zip(doubtful, twins, strict=True)}
    for k, (scene, model, run) in enumerate(zip(ensemble, models, runs, strict=True)):
        if rows[k] is None:
            sound = {name: twin.values for name, twin in twins.get(k, {}).items() if not twin.failed}
            small = {name: sound[name] for name in near_twins(scene) if name in sound}
            large = {name: sound[name] for name in sound if name not in small}
            off, notes = judge(scene, model.values, run.values, small, large, spans[k])
            warned = bool(run.values["warnings"])
            word = ("off and warned" if warned else "off and silent") if off else (
                "right but warned" if warned else "right")
            rows[k] = _row(scene, model, run, word, off, notes, span=spans[k])
    return rows


def _unusable(scene, model: Row):
    return model.failure["reason"] if model.failed else rule(scene, model.values)


def _row(scene, model, run, word, off=(), notes=(), cause=None, span=math.inf):
    sound = not (model.failed or run.failed)
    return {"class": word, "cause": cause, "findings": list(off), "notes": list(notes),
            "warnings": list(run.values.get("warnings") or ()), "failure": run.failure and run.failure["reason"],
            "message": (run.failure or {}).get("message", "")[:300], "outcome": run.values["outcome"],
            "expected": model.values["outcome"], "judged_until": None if math.isinf(span) else span,
            "errors": {**peak_errors(scene, model.values, run.values, span),
                       "restitution": restitution_error(scene, run.values, span)} if sound else {},
            "cpu_seconds": run.cost.get("cpu_seconds"), "model_cpu_seconds": model.cost.get("cpu_seconds"),
            "simulated": scene.duration, "place": place(scene)}


def examine(engine, index, *, seed=1, time_limit=60.0):
    """(scene, analytic row, engine row, row of the bench) of one scene, run again; nothing is stored."""
    scene = wide_scene(seed, index)

    def fresh(case, limit):
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            return run_sweep([case], store=Path(folder) / "one.jsonl", workers=1, time_limit=limit, reduce=keep,
                             progress=False)[0]

    model, run = fresh(Case(scene), KERNEL_SECONDS), fresh(Case(scene, engine), time_limit)
    row, = judged([scene], [model], [run], lambda cases, label: [fresh(case, KERNEL_SECONDS) for case in cases])
    return scene, model, run, {"index": index, **row}
