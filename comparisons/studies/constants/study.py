"""The constants study: a sample of runs with every constant of a variant in turn halved and doubled."""

import itertools
from collections.abc import Iterator, Sequence
from pkgutil import resolve_name
from typing import Any

import numpy as np

from analytic import Base, Response, Scene, Start, load_scene, simulate
from analytic.caryatid import BASE, MASS, caryatid_block
from engines.contract import Variant
from engines.statue_range import RANGE

from ...measuring.errors import impact_errors, rms
from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request
from ...running.sweep import Row
from ..random_scenes.study import random_scene
from ..restitution.cases import free_scene, variants_of
from ..stability.cases import hard_cases

AS_IT_IS, CHANGES = "as it is", {"halved": 0.5, "doubled": 2.0}
SILENT = {"history": False}
IMPACTS, PEAKS, OUTCOMES = "impacts", "peaks", "outcomes"  # what is judged of a scene
SEED, SCENES = 0, 12  # of the random ones
MOST_IMPACTS = 1000  # a run of so many costs as much as the rest of the sample
STARTS = (0.15, 0.45)  # slendernesses of the blocks that are released


def sample(quick: bool) -> Iterator[tuple[str, Scene]]:
    """(what is judged, scene): impacts of blocks released; peaks of statues that stay upright; outcomes.

    Only statues under a motion have a peak tilt to be judged: one that is released has it at the start.
    """
    for slenderness, ratio in itertools.product(STARTS, (None, BASE.mass / MASS)):
        yield IMPACTS, free_scene(slenderness, ratio, 0.6)
    if not quick:
        isolated = load_scene("free-rocking-isolated")
        yield IMPACTS, isolated.with_(duration=4.0)
        heavy = {"base": Base(mass=MASS), "block": caryatid_block(0.2), "start": Start(tilt=0.12), "duration": 4.0}
        yield IMPACTS, isolated.with_(**heavy)
        yield OUTCOMES, load_scene("caryatid-rigid")  # a sampled motion
    drawn = (random_scene(SEED, index) for index in itertools.count())
    upright = (scene for scene in drawn if scene.motion and _stays(simulate(scene, history=False)))
    for scene in itertools.islice(upright, 1 if quick else SCENES):
        yield PEAKS, scene
    for sign in "-+":
        yield OUTCOMES, hard_cases()[f"critical pulse {sign}0.001"].scene


def _stays(response: Response) -> bool:
    """Whether a block rocks, but never beyond its unstable point: there the least change may be another outcome."""
    return RANGE["tilt"][0] <= response.peak_tilt_ratio < 1 and len(response.impacts) < MOST_IMPACTS


def changed(variant: Variant, name: str, factor: float) -> tuple[Any, dict[str, Any]]:
    """(value as it is, what a `Case` takes to have it times a factor) of a constant; whole numbers remain so."""
    setting = ":" not in name
    value = getattr(variant.settings, name) if setting else resolve_name(name)
    scaled = [type(one)(factor * one) for one in (value if isinstance(value, tuple) else (value,))]
    other = {name: scaled if isinstance(value, tuple) else scaled[0]}
    return value, {"settings": {**SILENT, **other}} if setting else {"settings": SILENT, "constants": other}


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of a run: all in which a constant may show."""
    return {
        "outcome": response.outcome,
        "peak": response.peak_tilt_ratio,
        "steps": response.steps,
        "errors": impact_errors(case.scene, response)["state"].tolist(),
    }


def plan(request: Request) -> Plan:
    """The plan of the study: a row of each variant as it is, then one for each change of a constant."""
    scenes, cases = list(sample(request.quick)), []
    for engine, name, variant in variants_of(request.engines):
        changes: list[tuple[dict[str, Any], dict[str, Any]]] = []
        for (constant, what), change in itertools.product(variant.constants.items(), CHANGES):
            value, given = changed(variant, constant, CHANGES[change])
            changes.append(({"change": change, "constant": constant, "what": what, "value": value}, given))
        if changes:
            changes.insert(0, ({"change": AS_IT_IS}, {"settings": SILENT}))
        for (tag, given), (number, (part, scene)) in itertools.product(changes, enumerate(scenes)):
            cases.append(Case(scene, engine, name, tag={**tag, "sample": part, "scene": number}, **given))
    runs = yield Batch(cases, measure, "constants")
    model = [simulate(scene, history=False) for _, scene in scenes]
    rows, before = [], []
    for begin in range(0, len(runs), len(scenes)):
        group = runs[begin : begin + len(scenes)]
        before = group if group[0].case.tag["change"] == AS_IT_IS else before
        rows.append(_row(group, before, [one.peak_tilt_ratio for one in model]))
    return Computed({"quick": request.quick, "scenes": len(scenes)}, rows, solvers=request.engines)


def _row(runs: Sequence[Row], before: Sequence[Row], peaks: Sequence[float]) -> dict[str, Any]:
    """A row of the runs of a constant's change; before: the same as it is. peaks: of the model."""
    case, sound = runs[0].case, [(one, peak) for one, peak in zip(runs, peaks, strict=True) if not one.failed]
    errors = [error for one, _ in sound if one.case.tag["sample"] == IMPACTS for error in one.values["errors"]]
    off = [
        abs(one.values["peak"] - peak)
        for one, peak in sound
        if one.case.tag["sample"] == PEAKS and max(peak, one.values["peak"]) < 1
    ]
    pairs = list(zip(runs, before, strict=True))
    cpu, first = (sum(one.cost.get("cpu_seconds", 0.0) for one in group) for group in (runs, before))
    return {
        "part": "constant",
        "engine": case.solver,
        "variant": case.variant,
        **{name: case.tag.get(name) for name in ("change", "constant", "what", "value")},
        "runs": len(runs),
        "failed": len(runs) - len(sound),
        "reason": next((one.failure["reason"] for one in runs if one.failed), None),
        "outcomes_changed": sum(one.values["outcome"] != old.values["outcome"] for one, old in pairs),
        "moved": sum(one.values != old.values for one, old in pairs),
        "rms": rms(errors) if errors else None,
        "peak_median": float(np.median(off)) if off else None,
        "peak_worst": max(off, default=None),
        "steps": sum(one.values["steps"] for one, _ in sound),
        "cpu_seconds": cpu,
        "cpu_ratio": cpu / first if first else None,
    }
