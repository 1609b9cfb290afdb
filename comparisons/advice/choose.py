"""Which setting of which engine meets an error on this very scene, and on its neighbours, at the least cost?

Each variant's knob is run along its ladder on the scene; where that passes from some setting on to the finest, those
settings are run on the neighbours, the cheapest first, until one passes. A setting passes if it and all finer ones do,
everywhere, with `aims.SPARE` to spare: none passes by luck.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import Scene, simulate
from analytic.errors import SettingError
from analytic.solver import TOLERANCE
from engines import available_engines, get_engine

from ..running.executors import Processes
from ..running.files import TemporaryFolder
from ..running.solving import ANALYTIC, named_engines
from .aims import AIMS, Measure, fitting, lifts, neighbours, until
from .found import Choice, Ladder, Setting
from .search import Runner, Search, problem, spare
from .spared import cpu_seconds, spared

if TYPE_CHECKING:
    from engines.contract import Variant

TIME_LIMIT = 60.0  # s, of one run


def choose(
    scene: Scene,
    *,
    error: float = 1e-3,
    aim: str | None = None,
    engines: Iterable[str] | None = None,
    time_limit: float = TIME_LIMIT,
    progress: bool = False,
    source: str = "scene.toml",
) -> Choice:
    """The `Choice` for a scene.

    Its runs are made in processes of their own: a script calls it under ``if __name__ == "__main__":``.

    Parameters
    ----------
    scene : Scene
    error : float
        Largest error asked for: of restitution (rms) [-]; of the tilt over the slenderness, or of the displacement over
        its peak, at any time up to the sensitivity horizon; of outcomes the share of neighbours that differ.
    aim : str or None
        One of `aims.AIMS`; None: what the scene shows, see `aims.fitting`.
    engines : iterable of str or None
        Those to try; None: all that are installed; none of them is run where, without an aim, the block never lifts:
        then the analytic model is the answer.
    time_limit : float
        Of one run [s].
    progress : bool
    source : str
        Name of the scene's file, for the command and the snippet.

    Raises
    ------
    SettingError
        The error or the aim is out of range, or the scene does not show what is asked for.
    EngineNotInstalled

    Examples
    --------
    >>> from analytic import load_scene
    >>> found = choose(load_scene("free-rocking-rigid"), error=0.02, engines=["exudyn"])
    >>> found.chosen.passes, found.chosen.error < 0.01
    (True, True)
    """
    names, missing = _asked(error, aim, engines)
    whatever = aim is None and engines is None
    aim = aim or fitting(scene)
    family, span = _family(scene, aim)
    if whatever and not any(lifts(one) for one in family.values()):
        answer, whole = _analytic(family)
        best, ladders = None, []
    else:
        options: dict[str, Any] = {"time_limit": time_limit, "progress": progress}
        answer, best, whole, ladders = _searched(scene, family, names, error, aim, **options)
    asked: dict[str, Any] = {"aim": aim, "error": error, "spare": spare(aim), "neighbours": list(family), "until": span}
    return Choice(
        **asked,
        scene=scene.name,
        chosen=answer,
        best=best,
        cpu_seconds=whole,
        analytic_cpu_seconds=(own := cpu_seconds(scene)),
        **_instructions(answer, source),
        ladders=ladders,
        spared=spared(scene, family, error, answer if ladders else best, names, own),
        missing=missing,
    )


def _family(scene, aim):
    """(scene and neighbours by their factor, as long as they are looked at; that time of the scene itself [s])."""
    family = neighbours(scene, aim)
    span = until(family[1.0], aim)

    def cut(factor, one):
        try:
            return one.with_(duration=span if factor == 1.0 else until(one, aim))
        except SettingError:  # a neighbour that does not lift: as long as the scene itself
            return one.with_(duration=span)

    if aim != "outcome":
        family = {factor: cut(factor, one) for factor, one in family.items()}
    return family, span


def _analytic(family):
    """(the analytic model as the `Setting`, CPU seconds of the scene)."""
    scene = family[1.0]
    spent = cpu_seconds(scene)
    how: dict[str, Any] = {"engine": ANALYTIC, "variant": "kernel", "knob": "tolerance", "value": TOLERANCE}
    how |= {"default": True, "runs": len(family), "error": 0.0, "passes": True, "why": None}
    return Setting(**how, cpu_per_second=spent / simulate(scene, history=False).end.time), spent


def _searched(scene, family, names, error, aim, **options):
    """(setting chosen or None, the best of none, CPU seconds of the whole scene, ladders); options: of the sweeps."""
    rungs, kinds = _rungs(names, scene), _kinds(names, scene)
    with TemporaryFolder("choose-") as folder, Processes(None, ("analytic", *names)) as executor:
        go = Runner(Path(folder), executor, Measure(aim), family, **options)
        go(rungs, [1.0], "the scene")
        search = Search(go, error, aim, lambda rung: go.whole(scene, rung))
        chosen, whole = search.cheapest(rungs)
        if chosen and aim == "restitution" and get_engine(chosen[0]).variants[chosen[1]].takes_restitution:
            search.cheapest([rung for rung in rungs if not get_engine(rung[0]).variants[rung[1]].takes_restitution])
        ladders = [_ladder(*kind, go.rows, error, aim, len(family)) for kind in kinds]
    return *_answer(chosen, ladders), whole, ladders


def _asked(error, aim, engines):
    """(names of the engines to try, those missing); what cannot be asked for is an error."""
    if aim not in (None, *AIMS):
        raise SettingError(f"--for {aim}: choose one of {', '.join(AIMS)}")
    if not 0 < error < 1:
        raise SettingError(f"--error {error!r}: give a number above 0 and below 1")
    if engines is None:
        names, missing = available_engines()
        return list(names), missing
    return list(named_engines(engines)), {}


def _kinds(names: Sequence[str], scene: Scene) -> list[tuple[str, str, Variant]]:
    """(engine, variant, its record) of those that may be chosen: not default settings, and able to run the scene."""
    return [
        (name, variant, kind)
        for name in names
        for variant, kind in get_engine(name).variants.items()
        if kind.tier != "defaults" and (scene.block.restitution is None or kind.takes_restitution)
    ]


def _rungs(names, scene):
    return [(name, variant, value) for name, variant, kind in _kinds(names, scene) for value in kind.ladder]


def _ladder(name, variant, kind, runs, error, aim, size):
    """The `Ladder` of a variant from what was run."""
    settings = []
    for value in kind.ladder:
        rows = runs[name, variant, value]
        found, why = problem(rows, error, aim)
        if why is None and len(rows) < size:
            why = "passes the scene; neighbours not run"
        sound = [row for row in rows.values() if not row.failed]
        spent = (
            sum(row.cost["cpu_seconds"] for row in sound) / sum(row.values["simulated"] for row in sound)
            if sound
            else None
        )
        settings.append(
            Setting(
                engine=name,
                variant=variant,
                knob=kind.knob,
                value=value,
                default=value == kind.default,
                runs=len(rows),
                error=found,
                cpu_per_second=spent,
                passes=why is None,
                why=why,
            )
        )
    for k in range(len(settings) - 2, -1, -1):
        if settings[k].passes and not settings[k + 1].passes:
            settings[k] = settings[k].model_copy(update={"passes": False, "why": "a finer setting does not pass"})
    return Ladder(
        engine=name,
        variant=variant,
        tier=kind.tier,
        applies_impact=kind.takes_restitution,
        order=_order(settings) if aim != "outcome" else None,
        settings=settings,
    )


def _order(settings):
    """Slope of log error over log knob; None where fewer than three settings show one."""
    shown = [(one.value, one.error) for one in settings if one.error]
    if len(shown) < 3:
        return None
    knob, errors = np.log(np.array(shown)).T
    return float(np.polyfit(knob, errors, 1)[0])


def _answer(chosen, ladders):
    """(the setting of the rung that was chosen or None, without one the best that was reached)."""
    settings = {(one.engine, one.variant, one.value): one for ladder in ladders for one in ladder.settings}
    return (settings[chosen], None) if chosen else (None, _best(ladders))


def _best(ladders):
    """The setting of least error, None without any."""
    known = [one for ladder in ladders for one in ladder.settings if one.error is not None]
    return min(known, key=lambda one: one.error, default=None)


def _set(one):
    return "" if one.default else f" --set {one.knob}={one.value:g}"


def _instructions(answer, source):
    """The command and the Python lines that use the answer; None without one."""
    return {"command": answer and _command(answer, source), "snippet": answer and _snippet(answer, source)}


def _command(one, source):
    if one.engine == ANALYTIC:
        return f"rocking run {source}"
    return f"rocking run {source} --engine {one.engine} --variant {one.variant}{_set(one)}"


def _snippet(one, source):
    value = "" if one.default else f", {one.knob}={one.value:g}"
    head = "from analytic import load_scene\nfrom engines import get_engine\n\n"
    call = f'get_engine("{one.engine}").simulate(load_scene("{source}"), variant="{one.variant}"{value})'
    if one.engine == ANALYTIC:
        head, call = "from analytic import load_scene, simulate\n\n", f'simulate(load_scene("{source}"))'
    return (
        f"{head}response = {call}\nprint(response.verdict, response.peak_tilt_ratio, response.peak_base_displacement)\n"
    )
