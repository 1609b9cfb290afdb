"""Search for the cheapest variant and level that meet an error on a scene and on its neighbours.

Each variant is run on the scene at all its levels. A level counts as passed only if all finer ones pass, too, with a
margin of `criteria.safety`, so that none passes by chance. Those that pass on the scene are tried on the neighbours,
cheapest first. The search ends at the first that passes there.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from analytic import Scene, SettingError, simulate
from analytic.response import Caution, scene_warnings
from analytic.scene import refuse_free
from analytic.solver import TOLERANCE
from engines import available_engines, get_engine
from engines.contract import Variant
from engines.loads import unkept_friction
from engines.simulating import outside

from ..execution.cases import Case
from ..execution.command_runs import ANALYTIC, named_engines
from ..execution.progress import spinner
from ..execution.sweep import Processes, Row, run_sweep
from ..execution.writing import TemporaryFolder
from ..schemas.advice import Choice, Level, VariantLevels
from ..schemas.runs import Warned
from .criteria import CRITERIA, SAFETY, Measure, cpu_seconds, fitting, model_parts, neighbours, safety, until

LevelKey = tuple[str, str, float]  # engine, variant, value of its accuracy parameter


def problem(rows: Mapping[float, Row], limit: float, criterion: str) -> tuple[float | None, str | None]:
    """Return (the error over these runs, the reason why they do not pass or None)."""
    for factor, row in rows.items():
        if row.failed:
            return None, f"failed at {factor:g} of the scene: {row.failure['reason']}"  # type: ignore[index]  # a failed run has one
        if row.values["error"] is None or not math.isfinite(row.values["error"]):
            return None, f"shows no {criterion} at {factor:g} of the scene"
        if row.values["too_coarse"]:
            return row.values["error"], f"warns that it is too coarse at {factor:g} of the scene"
    errors = [row.values["error"] for row in rows.values()]
    worst = float(np.mean(errors) if criterion == "outcome" else np.max(errors))
    if worst * safety(criterion) > limit:
        return worst, f"error {worst:.1e}" + ("" if worst > limit else f", less than {SAFETY:g} times below")
    return worst, None


class Search:
    """Runs levels on a scene and its neighbours, stores the rows, and finds the cheapest level that passes.

    family: {factor: scene or neighbour}, with the duration that is compared. error: the largest permissible error, as
    `criterion` defines it. options: for the sweeps, whose stores are in `folder`. rows: {level: {factor: `Row`}} of all
    runs.
    """

    def __init__(
        self, scene: Scene, family: dict[float, Scene], error: float, criterion: str, folder: Path, **options: Any
    ) -> None:
        self.scene, self.family, self.error, self.criterion = scene, family, error, criterion
        self.folder, self.options = folder, options
        self.rows: dict[LevelKey, dict[float, Row]] = {}

    def run(self, levels: Sequence[LevelKey], factors: Sequence[float], label: str) -> None:
        """Run levels on the scenes of these factors."""
        runs = [(level, factor) for factor in factors for level in levels]
        rows = self._sweep([(level, self.family[factor]) for level, factor in runs], self.criterion, label)
        for (level, factor), row in zip(runs, rows, strict=True):
            self.rows.setdefault(level, {})[factor] = row

    def whole(self, level: LevelKey) -> float | None:
        """Run a level on the whole scene and return its CPU seconds; None if the run fails."""
        (row,) = self._sweep([(level, self.scene)], "outcome", "the whole scene")
        return None if row.failed else row.cost["cpu_seconds"]

    def _sweep(self, runs, criterion, label):
        cases = [
            Case(scene, engine, variant, {} if value == kind.default else {kind.accuracy_parameter: value})
            for (engine, variant, value), scene in runs
            for kind in (get_engine(engine).variants[variant],)
        ]
        store = self.folder / f"{criterion}.jsonl"
        return run_sweep(cases, store=store, measure=Measure(criterion), label=label, **self.options)

    def cheapest(self, levels: Sequence[LevelKey]) -> tuple[LevelKey | None, float | None]:
        """Return (the cheapest level that passes, its CPU seconds for the whole scene); None, None if none passes.

        Neighbours are run only at levels that can still pass, the cheapest first.
        """
        for level in sorted(filter(self._hopeful, levels), key=self._cost):
            suffix = self._suffix(level)
            missing = [factor for factor in self.family if any(factor not in self.rows[finer] for finer in suffix)]
            if self._hopeful(level):  # runs made meanwhile may have changed this
                self.run(suffix, missing, f"{level[0]}, {level[1]}: neighbours")
            if self._pass(suffix):
                spent = self.whole(level)
                if spent is not None:
                    return level, spent
                failed = {"reason": "the whole scene failed"}
                self.rows[level][1.0] = replace(self.rows[level][1.0], failure=failed)
        return None, None

    def _suffix(self, level):
        levels = get_engine(level[0]).variants[level[1]].levels
        return [(*level[:2], value) for value in levels[levels.index(level[2]) :]]

    def _pass(self, levels):
        return all(problem(self.rows[level], self.error, self.criterion)[1] is None for level in levels)

    def _hopeful(self, level):
        """Whether a level and all finer ones of its variant pass in all scenes run so far."""
        suffix = self._suffix(level)
        if self.criterion == "outcome":  # one run with another outcome does not determine a share
            return not any(row.failed for finer in suffix for row in self.rows[finer].values())
        return self._pass(suffix)

    def _cost(self, level):
        row = self.rows[level][1.0]
        return row.cost["cpu_seconds"] / row.values["simulated"]


TIME_LIMIT = 60.0  # s, of one run


# Long because a `Choice` has many fields.
def choose(
    scene: Scene,
    *,
    error: float = 1e-3,
    criterion: str | None = None,
    engines: Iterable[str] | None = None,
    time_limit: float = TIME_LIMIT,
    progress: bool = False,
    source: str = "scene.toml",
) -> Choice:
    """Return the `Choice` for a scene.

    The runs are made in separate processes, so a script must call this under ``if __name__ == "__main__":``.

    error: largest permissible error: of the restitution (rms) [-]; of the tilt over the slenderness, or of the
    displacement over its peak, at any time up to the sensitivity horizon; or the share of neighbours whose outcomes
    differ. criterion: one of `criteria.CRITERIA`; None: `criteria.fitting`. engines: engines to try; None: all that are
    installed. If neither is given and the block never lifts, no engine is run, and the analytic model is the answer.
    time_limit: of one run [s]. source: name of the scene file, for the command and the snippet.

    Raises
    ------
    SettingError
        The error or the criterion is out of range, or the criterion does not apply to the scene.
    EngineNotInstalled

    Examples
    --------
    >>> from analytic import load_scene
    >>> choice = choose(load_scene("free-rocking-rigid"), error=0.02, engines=["exudyn"])
    >>> choice.chosen.passes, choice.chosen.error < 0.01
    (True, True)
    """
    if criterion not in (None, *CRITERIA):
        raise SettingError(f"--for {criterion}: choose one of {', '.join(CRITERIA)}")
    if not 0 < error < 1:
        raise SettingError(f"--error {error!r}: give a number above 0 and below 1")
    refuse_free(scene, "the choice of an engine")
    names, missing = available_engines() if engines is None else (named_engines(engines), {})
    is_default = criterion is None and engines is None
    with _shown(progress, f"{scene.name}: the analytic model"):
        criterion = criterion or fitting(scene)
        family, left, span = _family(scene, criterion)
        model_cpu = cpu_seconds(scene)
    if is_default and all(map(_stands, family.values())):
        chosen, best, whole, variants = _analytic(family), None, cpu_seconds(family[1.0]), []
    else:
        limits = {"time_limit": time_limit, "progress": progress}
        chosen, best, whole, variants = _searched(scene, family, names, error, criterion, **limits)
    engine_level = (chosen if variants else None) or best
    with _shown(progress, f"{scene.name}: what need not be modelled"):
        parts = model_parts(scene, family, error, engine_level, names, model_cpu)
    return Choice(
        scene=scene.name,
        criterion=criterion,
        error=error,
        safety_factor=safety(criterion),
        neighbours=list(family),
        left_out={f"{factor:g}": why for factor, why in left.items()},
        until=span,
        chosen=chosen,
        best=best,
        cpu_seconds=whole,
        analytic_cpu_seconds=model_cpu,
        command=_command(chosen, source) if chosen else None,
        snippet=_snippet(chosen, source) if chosen else None,
        variants=variants,
        parts=parts,
        missing=missing,
        warnings=[Warned(**asdict(caution)) for caution in _warnings(scene)],
    )


def _warnings(scene):
    """The warnings on a scene, on its run in the model, and on what lies outside the range of tests of engines."""
    response = simulate(scene, history=False)
    friction = [Caution("engine", words)] if (words := unkept_friction(scene)) else []
    return (*scene_warnings(scene), *response.warnings, *outside(scene, response), *friction)


def _shown(progress, words):
    return spinner(words) if progress else nullcontext()


def _family(scene, criterion):
    """`neighbours` of a scene, cut to the duration that is compared, and that duration of the scene itself [s].

    Returns ({factor: scene or neighbour}, {factor: why it is left out}, duration).
    """
    family, left = neighbours(scene, criterion)
    span = until(family[1.0], criterion)

    def cut(factor, member):
        try:
            return member.with_(duration=span if factor == 1.0 else until(member, criterion))
        except SettingError:  # a neighbour without uplift gets the duration of the scene
            return member.with_(duration=span)

    if criterion != "outcome":
        family = {factor: cut(factor, member) for factor, member in family.items()}
    return family, left, span


def _stands(scene):
    """Whether the block never leaves full contact."""
    return simulate(scene.with_(duration=None), history=False).outcome == "stands"


def _analytic(family: Mapping[float, Scene]) -> Level:
    """The analytic model as a level without error."""
    return Level(
        engine=ANALYTIC,
        variant="kernel",
        parameter="tolerance",
        value=TOLERANCE,
        default=True,
        runs=len(family),
        error=0.0,
        cpu_per_second=cpu_seconds(family[1.0]) / simulate(family[1.0], history=False).end.time,
        passes=True,
        untried=False,
        why=None,
    )


def _searched(scene, family, names, error, criterion, **options):
    """Search for the cheapest level that passes. options: for the sweeps.

    Returns (the level chosen or None, otherwise the level with the least error or None, CPU seconds of the whole scene
    or None, the `VariantLevels` of all variants).
    """
    kinds = _kinds(names, scene)
    levels = [(name, variant, value) for name, variant, kind in kinds for value in kind.levels]
    with TemporaryFolder("choose-") as folder, Processes(None, ("analytic", *names)) as executor:
        search = Search(scene, family, error, criterion, Path(folder), executor=executor, **options)
        search.run(levels, [1.0], "the scene")
        key, whole = search.cheapest(levels)
        if key and criterion == "restitution" and get_engine(key[0]).variants[key[1]].applies_impact:
            search.cheapest([key for key in levels if not get_engine(key[0]).variants[key[1]].applies_impact])
        variants = [_variant(*kind, search) for kind in kinds]
    run = [level for variant in variants for level in variant.levels]
    chosen = next((level for level in run if (level.engine, level.variant, level.value) == key), None)
    with_error = [level for level in run if level.error is not None and not chosen]
    return chosen, min(with_error, key=lambda level: level.error, default=None), whole, variants


def _kinds(names: Iterable[str], scene: Scene) -> list[tuple[str, str, Variant]]:
    """(engine, name, `Variant`) of the variants that can run the scene and are not of the kind "defaults"."""
    return [
        (name, variant, spec)
        for name in names
        for variant, spec in get_engine(name).variants.items()
        if spec.kind != "defaults" and (scene.block.restitution is None or spec.takes_restitution)
    ]


def _variant(name, variant, spec, search):
    """The `VariantLevels` of a variant, from its runs."""
    levels: list[Level] = []
    finer = True
    for value in reversed(spec.levels):
        rows = search.rows[name, variant, value]
        worst, why = problem(rows, search.error, search.criterion)
        if why is None and not finer:
            why = "a finer level does not pass"
        finer, untried = why is None, why is None and len(rows) < len(search.family)
        sound = [row for row in rows.values() if not row.failed]
        spent = sum(row.cost["cpu_seconds"] for row in sound)
        simulated = sum(row.values["simulated"] for row in sound)
        levels.insert(
            0,
            Level(
                engine=name,
                variant=variant,
                parameter=spec.accuracy_parameter,
                value=value,
                default=value == spec.default,
                runs=len(rows),
                error=worst,
                cpu_per_second=spent / simulated if sound else None,
                passes=why is None and not untried,
                untried=untried,
                why="passes the scene; neighbours not run" if untried else why,
            ),
        )
    return VariantLevels(
        engine=name,
        variant=variant,
        tier=spec.kind,
        applies_impact=spec.applies_impact,
        order=_order(levels) if search.criterion != "outcome" else None,
        levels=levels,
    )


def _order(levels):
    """The slope of log error over log parameter; None with fewer than three levels that have an error."""
    points = [(level.value, level.error) for level in levels if level.error]
    if len(points) < 3:
        return None
    parameter, errors = np.log(np.array(points)).T
    return float(np.polyfit(parameter, errors, 1)[0])


def _command(level, source):
    value = "" if level.default else f" --set {level.parameter}={level.value:g}"
    engine = f" --engine {level.engine} --variant {level.variant}{value}"
    return f"rocking run {source}" + (engine if level.engine != ANALYTIC else "")


def _snippet(level, source):
    value = "" if level.default else f", {level.parameter}={level.value:g}"
    head = "from analytic import load_scene\nfrom engines import get_engine\n\n"
    call = f'get_engine("{level.engine}").simulate(load_scene("{source}"), variant="{level.variant}"{value})'
    if level.engine == ANALYTIC:
        head, call = "from analytic import load_scene, simulate\n\n", f'simulate(load_scene("{source}"))'
    shown = "response.outcome_text, response.peak_tilt_ratio, response.peak_base_displacement"
    return f"{head}response = {call}\nprint({shown})\n"
