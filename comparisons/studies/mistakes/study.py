"""The mistakes study: scripts of a few scenes, each with one mistake, beside the analytic model."""

import math
from typing import Any

import numpy as np

from analytic import PulseMotion, Response, Scene, load_scene, simulate
from analytic.rocking import restitution
from analytic.scene import caryatid_block
from engines import get_engine
from engines.contract import NO_MATTER, Engine, Mistake
from engines.swings import Trace

from ...execution.cases import Case
from ...execution.plan import Batch, Computed, Plan, Request
from ...metrics.errors import impact_errors, rate_restitution, rms
from ...metrics.scripts import NAME, SECONDS, ScriptFailed, as_written, run_script, version_of, with_mistake
from ...schemas.columns import declared, number_of, word_of
from ..rows import SHARED

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("mistake", "mistake", "name of the mistake; null: the script as it is"),
    word_of("done", "done", "what was done, in words"),
    word_of("group", "group", 'what it concerns: body, contact, steps, forces or motion; or "no matter"'),
    word_of("expected", "expected", "outcome of the analytic model"),
    word_of(
        "outcome",
        "outcome",
        'outcome of the script\'s run: stands, rocks, overturns; "failed": no end, or one that is not physical',
    ),
    word_of("reason", "reason", "why the run failed; null: it did not"),
    number_of("error", "error", "error of restitution by the states at strong impacts: root mean square"),
    number_of(
        "energy",
        "by energy",
        "error of restitution by the rates of successive impacts, free rocking on rigid ground: root mean square",
    ),
    number_of(
        "graph",
        "tilt",
        "largest difference of the tilt from the model's at one time, until either block is beyond its unstable point",
        "slenderness",
    ),
    number_of(
        "displacement",
        "error of the base displacement, over its peak",
        "largest difference of the base displacement from the model's, over the model's peak, until either block is "
        "beyond its unstable point",
    ),
)
PARTS = {
    "run": """engine variant scene mistake? done? group? expected outcome reason? error? energy? graph?
            displacement? steps?"""
}

QUICK = ("inertia + 1 %", "default damping", "10 × softer")
NOTHING = dict.fromkeys(("error", "energy", "graph", "displacement", "steps"))


def scenes(quick: bool = False) -> dict[str, Scene]:
    """Return {name: scene} of the scripts.

    quick: only a block released on rigid ground.
    """
    released = load_scene("free-rocking-rigid").with_(duration=5.0)
    if quick:
        return {"released": released}
    stocky = Scene(block=caryatid_block(0.3))
    amplitude = 1.3 * stocky.gravity * math.tan(stocky.block.slenderness)
    return {
        "released": released,
        "released, bearings": load_scene("free-rocking-isolated").with_(duration=3.0),
        "pulse": stocky.with_(motion=PulseMotion("one-sine", amplitude, 2.2 * stocky.rocking_frequency)),
        "record, bearings": load_scene("caryatid-isolated").with_(block={"slenderness": 0.15}, duration=9.0),
    }


def changes(engine: Engine, quick: bool = False) -> list[Mistake | None]:
    """Return the mistakes in an engine's scripts, after None for the script as it is.

    quick: only a few.
    """
    mistakes = engine.known_mistakes().values()
    return [None, *(mistake for mistake in mistakes if not quick or mistake.key in QUICK)] if mistakes else []


def plan(request: Request) -> Plan:
    """Plan the study; an engine without mistakes has no rows.

    A quick study has few mistakes, on one scene.
    """
    cases = []
    for name in request.engines:
        engine = get_engine(name)
        for mistake in changes(engine, request.quick):
            for place, scene in scenes(request.quick).items():
                if mistake is None or mistake.fits(scene):
                    script = version_of(engine, scene, mistake)
                    tag = {"scene": place, "mistake": mistake.key if mistake else None, "script": script}
                    cases.append(Case(scene, name, engine.default_variant, {"history": False}, tag))
    runs = yield Batch(cases, cost, "mistakes", time_limit=2 * SECONDS)
    model = {place: simulate(scene, history=False).outcome for place, scene in scenes(request.quick).items()}
    rows = [
        {
            "part": "run",
            "engine": run.case.solver,
            "variant": run.case.variant,
            **{name: run.case.tag[name] for name in ("scene", "mistake")},
            **_described(get_engine(run.case.solver), run.case.tag["mistake"]),
            "expected": model[run.case.tag["scene"]],
            **(_failed(run.failure["reason"]) if run.failed else run.values),
        }
        for run in runs
    ]
    settings = {
        "quick": request.quick,
        "no_matter": NO_MATTER,
        "on_bearings": [place for place, scene in scenes(request.quick).items() if scene.bearings],
    }
    return Computed(settings, rows)


def _described(engine: Engine, key: str | None) -> dict[str, str | None]:
    """Describe the mistake called `key`: what was done, and what it concerns; None: the script as it is."""
    mistake = engine.known_mistakes()[key] if key else None
    return {"done": mistake.done if mistake else None, "group": mistake.group if mistake else None}


def _failed(reason: str) -> dict[str, Any]:
    return {"outcome": "failed", "reason": reason, **NOTHING}


def cost(case: Case, response: Response) -> dict[str, Any]:
    """Measure what is wrong in a run of the script with the mistake in the tag; the adapter's own run is not used."""
    engine = get_engine(case.solver)
    mistake = engine.known_mistakes().get(case.tag["mistake"])
    try:
        trace, _ = run_script(with_mistake(engine, case.scene, mistake), SECONDS)
    except ScriptFailed as failed:
        return _failed(str(failed))
    scene = case.scene if case.scene.duration else case.scene.with_(duration=float(trace.time[-1]))
    about: dict[str, Any] = dict(engine=case.solver, variant=NAME, cpu_seconds=0.0, settings={}, versions={})
    seen = as_written(scene, trace, history=False, **about)
    if seen.failure:
        return _failed(seen.failure.reason)
    return {"outcome": seen.outcome, "reason": None, **errors(scene, seen, trace), "steps": seen.steps}


def errors(scene: Scene, seen: Response, trace: Trace) -> dict[str, float | None]:
    """Return errors of a sound run against the model; None where there is nothing to measure.

    error: of restitution at strong impacts, rms. energy: the same from the rates of successive impacts of a block
    released on rigid ground. graph: largest difference of the tilt at one time, over the slenderness, until either
    block is beyond its unstable point. displacement: the same of the base, over the model's peak.
    """
    model, free = simulate(scene), scene.base is None and scene.motion is None
    at_impact, swings = impact_errors(scene, seen)["state"], rate_restitution(seen) if free else np.empty(0)
    time = model.history.time[model.history.time <= trace.time[-1]]
    tilts = np.interp(time, trace.time, trace.tilt), model.history.tilt[: len(time)]
    beyond = np.flatnonzero(np.abs(tilts).max(axis=0) > scene.block.slenderness)
    upright = slice(0, int(beyond[0]) if len(beyond) else len(time))

    def apart(run, other):
        return float(np.abs(run - other)[upright].max())

    base = np.interp(time, trace.time, trace.base_displacement), model.history.base_displacement[: len(time)]
    return {
        "error": rms(at_impact) if len(at_impact) else None,
        "energy": rms(swings - restitution(scene)) if len(swings) else None,
        "graph": apart(*tilts) / scene.block.slenderness,
        "displacement": apart(*base) / model.peak_base_displacement if scene.base else None,
    }
