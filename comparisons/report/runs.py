"""The report's own runs, as a study: scenes in every solver, and the restitution of blocks that rock.

Their results are files in the report's folder.
"""

import math
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from analytic import Base, Block, Scene, Start, load_scene
from analytic.errors import SceneError
from analytic.motion import Motion
from analytic.response import LEVEL, Response
from analytic.rocking import restitution
from analytic.scene import RADIUS, refuse_free
from engines import available_engines, get_engine

from ..execution.cases import Case
from ..execution.plan import Batch, Computed, Plan, Request, Study
from ..execution.progress import spinner
from ..execution.results import copy_result
from ..execution.runner import compute
from ..execution.sweep import Row
from ..metrics.errors import compare, impact_errors, lost_impacts, rms, sensitivity_horizon, solver_horizon, worst
from ..plotting.parts import grouped
from .figures import ToFile, differences, response_of, thinned
from .statue import statue_of

SCENES, RESTITUTION = "scenes.json", "restitution.json"  # result files
CARYATID = ("caryatid-rigid", "caryatid-isolated")  # the scenes of a report on no scenes of the user
STARTS = (0.3, 0.45, 0.6, 0.75)  # released tilt over slenderness
SECONDS = 3.0  # of a block of the Caryatid's size
# Time limit of a run [s], and what each second and each sample of the motion adds to it. The longest run under a usual
# record takes a few seconds. A run that hangs becomes a failed row.
TIME_LIMIT, LIMIT_PER_SECOND, LIMIT_PER_SAMPLE = 60.0, 1.0, 1e-3


def load_scenes(places: Sequence[str], motion: Motion | None = None) -> dict[str, Scene]:
    """Return {unique name: scene} of scene files or shipped scenes; a `motion` replaces theirs.

    Raises
    ------
    SceneError
        A file is no scene.
    """
    scenes: dict[str, Scene] = {}
    for place in places:
        scene, name = load_scene(place), Path(place).stem
        try:
            refuse_free(scene, "a page of your own scenes")
        except SceneError as error:
            raise error.in_file(place) from None
        key = name if name not in scenes else f"{name}-{len(scenes) + 1}"
        scenes[key] = scene if motion is None else scene.with_(motion=motion)
    return scenes


def plan(
    request: Request,
    scenes: Mapping[str, Scene],
    histories: str | PathLike[str],
    variants: Mapping[str, str | None],
    motions: Mapping[str, Mapping[str, Sequence[Motion]]],
    left: Mapping[str, Sequence[str]],
    own_scenes: bool,
) -> Plan:
    """Plan a report's runs: the scenes in every solver; for a user's scenes their cards and their blocks' restitution.

    histories: folder that keeps the runs' histories meanwhile. variants: {engine: variant} in place of main variants.
    motions: {scene: {record: its motions}}, besides the scene's own. left: {scene: what was left out of them}.
    own_scenes: whether the scenes are the user's.
    """
    cases = [
        Case(
            scene,
            solver,
            variants.get(solver),
            settings={"compare": True} if solver in request.engines else {},
            tag={"scene": name},
        )
        for solver in ("analytic", *request.engines)
        for name, scene in scenes.items()
    ]
    longest = max((scene.motion.end for scene in scenes.values() if scene.motion), default=0.0)
    samples = max((len(getattr(scene.motion, "samples", ())) for scene in scenes.values()), default=0)
    limit = TIME_LIMIT + LIMIT_PER_SECOND * longest + LIMIT_PER_SAMPLE * samples
    rows = yield Batch(cases, ToFile(str(Path(histories).resolve())), "runs", limit, rates=False, long=True)
    further: dict[str, Any] = {"variants": described_variants(request.engines), "own": own_scenes}
    if own_scenes:
        further["statues"] = {}
        for name, scene in scenes.items():
            with spinner(f"{scene.name}: the analytic model") as tell:
                further["statues"][name] = statue_of(
                    scene, motions.get(name, {}), left.get(name, ()), partial(_tell, tell, scene.name)
                )
    computed = scenes_computed(Path(histories), rows, scenes, **further)
    rocking = [row.case.scene for row in rows if row.case.solver == "analytic" and row.values["outcome"] not in LEVEL]
    if not (own_scenes and rocking):
        return computed
    yield computed
    rows = yield Batch(restitution_cases(request.engines, rocking), impacts_only, "restitution", limit, long=True)
    return restitution_computed(rows)


def _tell(tell, name, quantity):
    tell(f"{name}: margin of {quantity}")


def restitution_cases(engines: Sequence[str], scenes: Sequence[Scene]) -> list[Case]:
    """Return cases of the first scene's block, released on each scene's ground, in all solvers and variants."""
    block = Block(**{**scenes[0].block.model_dump(), "restitution": None})  # engines decide it
    bases = {scene.base and scene.base.mass for scene in scenes}
    solvers = [("analytic", None), *((name, variant) for name in engines for variant in get_engine(name).variants)]
    return [
        Case(
            Scene(
                name="free rocking",
                block=block,
                base=Base(mass=mass) if mass else None,
                start=Start(tilt=start * block.slenderness),
                duration=SECONDS * math.sqrt(block.radius / RADIUS),
            ),
            solver,
            variant,
        )
        for solver, variant in solvers
        for mass in sorted(bases, key=lambda mass: mass or 0.0)
        for start in STARTS
    ]


def impacts_only(case: Case, response: Response) -> dict[str, Any]:
    """Measure a whole response but its history."""
    return response.to_json()


def restitution_computed(rows: Sequence[Row]) -> Computed:
    """Return the result of a released block: a row for each solver and variant, over all grounds and starts."""
    groups = grouped(rows, lambda row: row.case.solver, lambda row: row.case.variant)
    models = {row.case.scene.digest(): Response.from_json(row.values) for row in rows if row.case.solver == "analytic"}
    bases = dict.fromkeys(row.case.scene.base and row.case.scene.base.mass for row in rows)
    settings = {"starts": STARTS, "seconds": rows[0].case.scene.duration, "bases": list(bases)}
    return Computed(
        settings,
        [_restitution_row(engine, variant, members, models) for (engine, variant), members in groups.items()],
        name=Path(RESTITUTION).stem,
    )


def _restitution_row(engine, variant, members, models):
    """Return the errors of one solver and variant. models : {digest of a scene: the analytic model's run}."""
    sound = [(row, Response.from_json(row.values)) for row in members if not row.failed]
    errors = [impact_errors(row.case.scene, response) for row, response in sound]
    of_states = np.concatenate([error["state"] for error in errors]) if errors else np.empty(0)
    jumps = [value for error in errors for value in error.get("jump", ())]
    simulated = sum(response.end.time for _, response in sound)
    spec = get_engine(engine).variants[variant] if variant else None
    return {
        "engine": engine,
        "variant": variant,
        "tier": spec and spec.kind,
        "applies_impact": bool(spec and spec.applies_impact),
        "runs": len(members),
        "failed": len(members) - len(sound),
        "failures": [row.failure for row in members if row.failed],
        "impacts": len(of_states),
        "lost": sum(lost_impacts(response, models[row.case.scene.digest()]) for row, response in sound),
        "rms": rms(of_states) if len(of_states) else None,
        "worst": worst(of_states) if len(of_states) else None,
        "jump_rms": rms(jumps) if jumps else None,
        "warnings": list(dict.fromkeys(warning["text"] for row, _ in sound for warning in row.values["warnings"])),
        "settings": sound[0][0].values["settings"] if sound else None,
        "cpu_per_second": sum(row.cost["cpu_seconds"] for row, _ in sound) / simulated if sound else None,
    }


def described_variants(engines: Sequence[str]) -> dict[str, dict[str, dict[str, Any]]]:
    """Return {engine: {variant: kind, what the engine computes, what the adapter imposes, including the impact}}."""
    return {
        name: {
            variant: {
                "tier": spec.kind,
                "best": variant == get_engine(name).default_variant,
                "computes": spec.computes,
                "imposes": spec.imposes,
                "applies_impact": spec.applies_impact,
            }
            for variant, spec in get_engine(name).variants.items()
        }
        for name in engines
    }


def scenes_computed(folder: Path, rows: Sequence[Row], scenes: Mapping[str, Scene], **more: Any) -> Computed:
    """Return the result of the scenes' runs; memory holds two histories at a time, one of them the analytic model's.

    The motion described is that of the first scene that has one. more: further settings.
    """
    motion = next((scene.motion for scene in scenes.values() if scene.motion is not None), None)
    arrays = _motion_arrays(motion)
    described: dict[str, Any] = {}
    entries: list[dict[str, Any]] = []
    for name, scene in scenes.items():
        ours = [row for row in rows if row.case.tag["scene"] == name]
        reference = next(
            (response_of(row.values, folder) for row in ours if row.case.solver == "analytic" and not row.failed), None
        )
        horizon = sensitivity_horizon(scene).horizon if reference and len(ours) > 1 else None
        for row in ours:
            entry, drawn = _scene_entry(scene, row, reference, horizon, folder)
            entries.append({**entry, "scene": name})
            arrays.update({f"{name}/{row.case.solver}/{column}": values for column, values in drawn.items()})
        described[name] = {
            "name": scene.name,
            "duration": scene.duration,
            "motion": scene.motion and scene.motion.label,
            "gravity": scene.gravity,
            "block": scene.block.model_dump(),
            "base": scene.base and scene.base.model_dump(),
            "bearings": scene.bearings and scene.bearings.model_dump(),
            "pedestal": scene.pedestal and scene.pedestal.model_dump(),
            "friction": scene.friction,
            "half_width": scene.block.half_width,
            "half_height": scene.block.half_height,
            "rocking_frequency": scene.rocking_frequency,
            "restitution": restitution(scene),
            "horizon": horizon,
        }
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
    return Computed(settings, entries, arrays, name=Path(SCENES).stem)


def _motion_arrays(motion):
    """Return arrays of a motion to draw: a record's samples, thinned, or a pulse's from its formula."""
    if motion is None:
        return {}
    if not hasattr(motion, "samples"):
        time = np.linspace(0.0, 1.2 * motion.end, 1001)
        return {"motion/time": time, "motion/acceleration": motion.acceleration(time)}
    shown = thinned(motion.samples)
    return {"motion/time": motion.dt * shown, "motion/acceleration": motion.samples[shown]}


def _scene_entry(scene, row, reference, horizon, folder):
    """Return (row of one run, arrays to draw). The row comes from all samples, the arrays from `thinned` ones.

    An engine's run is compared up to the common horizon ("agreement") and up to its own ("own_agreement").
    """
    values = {key: value for key, value in row.values.items() if key != "history"}
    entry = {**values, "engine": row.case.solver, "failure": row.failure, **row.cost}
    if row.failed:
        return {**entry, "outcome_text": "failed"}, {}
    response = response_of(row.values, folder)
    history = response.history
    entry.update(
        outcome_text=response.outcome_text,
        cpu_per_second=row.cost["cpu_seconds"] / response.end.time,
        bearing_work=float(trapezoid(history.bearing_force, history.base_displacement)),
    )
    slip = () if history.slip is None else (history.slip,)
    shown = thinned(history.tilt, history.base_displacement, history.bearing_force, *slip)
    drawn = {column: getattr(history, column)[shown] for column in history.columns}
    if reference is not None:
        if row.case.solver != "analytic":
            own_horizon = solver_horizon(scene, response, reference)
            entry["perturbation"] = own_horizon.perturbation
            for key, until in (("agreement", horizon), ("own_agreement", own_horizon.horizon)):
                entry[key] = asdict(compare(scene, response, reference, until=until))
        drawn.update(differences(history, reference.history))
    return entry, drawn


# Under a longer record one engine runs at a time, as each needs some 100 bytes a step several times over.
SHORT_RECORD = 200_000  # samples
UNFINISHED = "unfinished"  # folder from which an interrupted report continues

STUDY = Study("report", "Scenes in every solver.", plan, by_solver=False)


def make_own_results(
    folder: str | PathLike[str],
    scenes: Mapping[str, Scene],
    *,
    engines: Sequence[str] | None = None,
    variants: Mapping[str, str | None] | None = None,
    motions: Mapping[str, Mapping[str, Sequence[Motion]]] | None = None,
    left: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Simulate the user's scenes, {name: scene}, for a report, and write its result files into `folder`.

    engines: those to compare; None: all that are installed. variants: {engine: variant} in place of main variants.
    motions: {scene: {record: its motions}}, besides the scene's own. left: {scene: what was left out of them, and why}.

    >>> from tempfile import mkdtemp
    >>> from analytic import load_scene
    >>> from comparisons.report.write import write_page
    >>> folder = mkdtemp()
    >>> make_own_results(folder, {"block": load_scene("free-rocking-rigid")}, engines=[])
    >>> write_page(folder).name
    'report.html'
    """
    others = {"motions": dict(motions or {}), "left": dict(left or {})}
    _compute_into(folder, engines, scenes=scenes, variants=dict(variants or {}), **others, own_scenes=True)


def make_results(
    folder: str | PathLike[str], motion: Motion, *, duration: float | None = None, engines: Sequence[str] | None = None
) -> None:
    """Simulate the Caryatid of the paper, free-standing and isolated, and write the result files of the page.

    Parameters
    ----------
    folder : path
        Made if it does not exist. An interrupted report continues from the files here.
    motion : SampledMotion
    duration : float or None
        Duration of the runs [s]; None: until their outcome is decided.
    engines : sequence of str or None
        Engines to compare; None: all that are installed.
    """
    scenes = {name: scene.with_(duration=duration) for name, scene in load_scenes(CARYATID, motion).items()}
    _compute_into(folder, engines, scenes=scenes, variants={}, motions={}, left={}, own_scenes=False)


def _compute_into(folder, engines, *, scenes, **options):
    """Compute the runs into `folder`, and remove the results of an earlier report there."""
    unfinished = Path(folder) / UNFINISHED
    samples = max((len(getattr(scene.motion, "samples", ())) for scene in scenes.values()), default=0)
    workers = None if samples <= SHORT_RECORD else 1
    options |= {"scenes": scenes, "histories": unfinished}
    paths = compute(STUDY, unfinished, engines=engines, workers=workers, **options)
    for path in paths:
        copy_result(path, Path(folder))
    for name in {SCENES, RESTITUTION} - {path.name for path in paths}:  # of an earlier report
        for file in (Path(folder) / name, (Path(folder) / name).with_suffix(".npz")):
            file.unlink(missing_ok=True)
    shutil.rmtree(unfinished)  # complete: the next report measures its times afresh
