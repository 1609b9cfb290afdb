"""The runs behind the report: the Caryatid in every solver, and free rocking in every variant; as result files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import trapezoid

from analytic import Base, Block, Scene, Start, load_scene
from analytic.closed_form import free_rocking
from analytic.response import History, Response
from analytic.rocking import base_jump_length, restitution
from engines import available_engines, get_engine
from engines.statue_range import in_words

from ..measuring.errors import SLOWEST_IMPACT, compare, impact_errors, rms
from ..measuring.horizon import solver_horizon
from ..running.cases import Case
from ..running.study import Batch, Found, say
from .histories import ToFile, differences, response_of, thinned

if TYPE_CHECKING:
    from analytic.types import Motion

    from ..running.study import Ask, Plan
    from ..running.sweep import Row

CARYATID, FREE_ROCKING = "caryatid.json", "free-rocking.json"
SCENES = ("caryatid-rigid", "caryatid-isolated")

SLENDERNESSES = (0.1, 0.2, 0.3, 0.45)  # rad
STARTS = (0.3, 0.45, 0.6, 0.75)  # released tilt over slenderness
VARIANT_STARTS = (0.6,)  # of the variants that are not an engine's default
BASES = {"rigid ground": None, "sliding base": {"mass": 212.0}}  # kg
FREE_SECONDS = 3.0
# Outer limit of a run [s], and what a second and a sample of the motion add to it; the longest under a usual record
# takes a few seconds. A hang becomes a failed row.
TIME_LIMIT, LIMIT_PER_SECOND, LIMIT_PER_SAMPLE = 60.0, 1.0, 1e-3


def plan(
    ask: Ask,
    motion: Motion,
    histories: str | PathLike[str],
    duration: float | None = None,
    slendernesses: Sequence[float] = SLENDERNESSES,
) -> Plan:
    """The plan of the report's own runs; histories: folder in which those of the Caryatid's are kept meanwhile."""
    scenes = caryatid_scenes(motion, duration)
    caryatid = [
        Case(scene, solver, settings={"compare": True} if solver in ask.engines else {}, tag={"scene": name})
        for solver in ("analytic", *ask.engines)
        for name, scene in scenes.items()
    ]
    limit = TIME_LIMIT + LIMIT_PER_SECOND * motion.end + LIMIT_PER_SAMPLE * len(motion.samples)
    say(f"the Caryatid in {', '.join(('the analytic model', *ask.engines))} (the first run on a machine compiles it)")
    rows = yield Batch(caryatid, ToFile(str(Path(histories).resolve())), "Caryatid", limit)
    yield scenes_found(Path(histories), rows, scenes, CARYATID)
    rows = yield Batch(free_rocking_cases(ask.engines, slendernesses), impacts_only, "free rocking", limit)
    return free_rocking_found(rows, ask.engines)


def caryatid_scenes(motion: Motion, duration: float | None = None) -> dict[str, Scene]:
    """The free-standing and the isolated Caryatid (Table 1 of the paper) under `motion`, by name."""
    return {name: load_scene(name).with_(motion=motion, duration=duration) for name in SCENES}


def free_rocking_cases(
    engines: Sequence[str],
    slendernesses: Sequence[float],
    block: Block | None = None,
    bases: Mapping[str, Mapping[str, float] | None] = BASES,
    seconds: float = FREE_SECONDS,
) -> list[Case]:
    """Blocks of the Caryatid's mass and radius, or as `block`, released from rest, in every solver and variant."""
    block = block or load_scene(SCENES[0]).block
    solvers: list[tuple[str, str | None, tuple[float, ...]]] = [("analytic", None, STARTS)]
    for name in engines:
        engine = get_engine(name)
        solvers += [
            (name, variant, STARTS if variant == engine.default_variant else VARIANT_STARTS)
            for variant in engine.variants
        ]
    cases = []
    for solver, variant, starts in solvers:
        for ground, base in bases.items():
            for slenderness in slendernesses:
                for start in starts:
                    scene = Scene(
                        name="free rocking",
                        block=Block(**{**block.model_dump(), "slenderness": slenderness}),
                        base=Base(**base) if base else None,
                        start=Start(tilt=start * slenderness),
                        duration=seconds,
                    )
                    tag = {"ground": ground, "slenderness": slenderness, "start": start}
                    cases.append(Case(scene, solver, variant, tag=tag))
    return cases


def impacts_only(case: Case, response: Response) -> dict[str, Any]:
    """Measure: everything but the history."""
    return response.to_json()


def scenes_found(folder: Path, rows: Sequence[Row], scenes: Mapping[str, Scene], file: str, **more: Any) -> Found:
    """The answer of the scenes' runs; memory holds two histories at a time, one the analytic model's.

    The motion described is the first scene's that has one; more: further settings.
    """
    motion = next((scene.motion for scene in scenes.values() if scene.motion is not None), None)
    arrays = _drawn_motion(motion)
    described: dict[str, Any] = {}
    entries: list[dict[str, Any]] = []
    for name, scene in scenes.items():
        ours = [row for row in rows if row.case.tag["scene"] == name]
        reference = next(
            (response_of(row.values, folder) for row in ours if row.case.solver == "analytic" and not row.failed), None
        )
        horizons = []
        for row in ours:
            entry, drawn = _scene_entry(scene, row, reference, folder)
            entries.append({**entry, "scene": name})
            horizons += [entry["agreement"]["until"]] if "agreement" in entry else []
            arrays.update({f"{name}/{row.case.solver}/{column}": values for column, values in drawn.items()})
        described[name] = {
            "name": scene.name,
            "duration": scene.duration,
            "motion": scene.motion and scene.motion.label,
            "gravity": scene.gravity,
            "block": scene.block.model_dump(),
            "base": scene.base and scene.base.model_dump(),
            "bearings": scene.bearings and scene.bearings.model_dump(),
            "half_width": scene.block.half_width,
            "half_height": scene.block.half_height,
            "rocking_frequency": scene.rocking_frequency,
            "restitution": restitution(scene),
            "horizon": min(horizons, default=None),
        }  # the earliest of a solver
    settings = {
        "motion": motion
        and {
            "label": motion.label,
            "peak": motion.peak,
            "peak_time": motion.peak_time,
            "dt": getattr(motion, "dt", None),
            "end": motion.end,
        },
        "scenes": described,
        "missing": available_engines()[1],
        **more,
    }
    return Found(settings, entries, arrays, name=Path(file).stem)


def _drawn_motion(motion):
    """Arrays of a motion to draw: a record's samples, thinned, or a pulse's from its formula."""
    if motion is None:
        return {}
    if not hasattr(motion, "samples"):
        time = np.linspace(0.0, 1.2 * motion.end, 1001)
        return {"motion/time": time, "motion/acceleration": motion.acceleration(time)}
    shown = thinned(motion.samples)
    return {"motion/time": motion.dt * shown, "motion/acceleration": motion.samples[shown]}


def _scene_entry(scene, row, reference, folder):
    """(what is told of one run, what is drawn of it); measured from all samples, drawn from `thinned` ones."""
    values = {key: value for key, value in row.values.items() if key != "history"}
    entry = {**values, "solver": row.case.solver, "failure": row.failure, **row.cost}
    if row.failed:
        return {**entry, "verdict": "failed"}, {}
    response = response_of(row.values, folder)
    history = response.history
    entry.update(
        verdict=response.verdict,
        cpu_per_second=row.cost["cpu_seconds"] / response.end.time,
        bearing_work=float(trapezoid(history.bearing_force, history.base_displacement)),
    )
    shown = thinned(history.tilt, history.base_displacement, history.bearing_force)
    drawn = {column: getattr(history, column)[shown] for column in History.COLUMNS}
    if reference is not None:
        until = reference.end.time
        if row.case.solver != "analytic":
            own = solver_horizon(scene, response, reference)
            until, entry["perturbation"] = own.horizon, own.perturbation
        entry["agreement"] = asdict(compare(scene, response, reference, until=until))
        drawn.update(differences(history, reference.history))
    return entry, drawn


def free_rocking_found(
    rows: Sequence[Row], engines: Sequence[str], bases: Mapping[str, Any] = BASES, seconds: float = FREE_SECONDS
) -> Found:
    """The answer of the blocks let go."""
    groups = {}
    for row in rows:
        key = (row.case.solver, row.case.variant, row.case.tag["ground"], row.case.tag["slenderness"])
        groups.setdefault(key, []).append(row)
    entries = [_restitution_entry(*[*key, members]) for key, members in groups.items()]
    arrays = {"curve/slenderness": np.linspace(0.05, 0.5, 91)}
    for ground in bases:
        scene = next(row.case.scene for row in rows if row.case.tag["ground"] == ground)
        arrays[f"curve/{ground}"] = np.array(
            [
                restitution(scene.with_(block={"slenderness": float(slenderness)}))
                for slenderness in arrays["curve/slenderness"]
            ]
        )
    settings = {
        "starts": STARTS,
        "variant_starts": VARIANT_STARTS,
        "seconds": seconds,
        "slowest_impact": SLOWEST_IMPACT,
        "bases": bases,
        "variants": described_variants(engines),
        "range": in_words(),
    }
    return Found(settings, entries, arrays, name=Path(FREE_ROCKING).stem)


def described_variants(engines: Sequence[str]) -> dict[str, dict[str, dict[str, Any]]]:
    """{engine: {variant: its tier, what the engine computes and the adapter imposes, whether that is the impact}}."""
    return {
        name: {
            variant: {
                "tier": kind.tier,
                "best": variant == get_engine(name).default_variant,
                "computes": kind.computes,
                "imposes": kind.imposes,
                "applies_impact": kind.takes_restitution,
            }
            for variant, kind in get_engine(name).variants.items()
        }
        for name in engines
    }


def _restitution_entry(solver, variant, ground, slenderness, members):
    """Errors of one solver and variant on one ground, over all starts; rates and times of every impact used."""
    scene = members[0].case.scene
    formula = restitution(scene)
    impacts, jumps, time_errors, sound = [], [], [], [row for row in members if not row.failed]
    for row in sound:
        scene, response = row.case.scene, Response.from_json(row.values)
        errors = impact_errors(scene, response)
        jumps += errors.get("jump", np.empty(0)).tolist()
        times = errors["time"]
        if scene.base is None:
            exact = free_rocking(scene.rocking_frequency, slenderness, formula, scene.start.tilt, len(times))
            time_errors += (times / exact.times - 1).tolist()
        impacts += [
            {"start": row.case.tag["start"], "time": float(time), "restitution": float(error) + formula}
            for time, error in zip(times, errors["state"], strict=True)
        ]
    missed = np.array([impact["restitution"] for impact in impacts]) - formula
    simulated = sum(row.values["end"]["time"] for row in sound)
    return {
        "solver": solver,
        "variant": sound[0].values["variant"] if sound else variant,
        "default": len(members) > 1,
        "ground": ground,
        "slenderness": slenderness,
        "restitution": formula,
        "base_jump_length": base_jump_length(scene),
        "runs": len(members),
        "failures": [row.failure for row in members if row.failed],
        "impacts": impacts,
        "warnings": list(dict.fromkeys(warning["text"] for row in sound for warning in row.values["warnings"])),
        "bias": _of(missed, np.mean),
        "rms": _of(missed, rms),
        "worst": _of(np.abs(missed), np.max),
        "jump_rms": _of(jumps, rms) if scene.base else None,
        "time_rms": _of(time_errors, rms),
        "settings": sound[0].values["settings"] if sound else None,
        "cpu_per_second": sum(row.cost["cpu_seconds"] for row in sound) / simulated if sound else None,
        "simulated": simulated,
    }


def _of(values, number):
    return float(number(values)) if len(values) else None
