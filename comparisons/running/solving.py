"""One run as a user asks for it: ground motion, solver and settings by name, checked."""

from __future__ import annotations

import contextlib
import dataclasses
import inspect
import json
import math
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analytic.errors import SceneError, SettingError

from .progress import compile_kernels, say, spinner
from .readable import readable

if TYPE_CHECKING:
    from analytic import Caution, Response, SampledMotion, Scene

ANALYTIC, KERNEL = "analytic", "kernel"  # and the variant that its runs are told as
TIME_LIMIT = 300.0  # s, of one run
TIME_LIMIT_HELP = "A run that takes longer is ended, and counts as failed."


def parse_settings(pairs: Iterable[str]) -> dict[str, Any]:
    """``["step=1e-4"]`` -> ``{"step": 0.0001}``; values are JSON, anything else is text.

    Raises
    ------
    SettingError
        A pair without "=", or a number that is not finite.
    """
    settings = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not (equals and name):
            raise SettingError(f"--set {pair}: write name=value")
        name = name.strip()
        try:
            settings[name] = json.loads(text)
        except (ValueError, RecursionError):  # no JSON, or nested too deep for a setting
            settings[name] = text
        if isinstance(settings[name], int | float):
            _check_size(name, settings[name])
    return settings


def ground_motion(record: str | PathLike[str] | None = None, **said: Any) -> SampledMotion:
    """The motion in the file `record`, or the shipped synthetic one without it.

    said : units, dt, column, channel
        What the file does not say itself (see `analytic.records.read_record`); None: nothing.

    Raises
    ------
    SettingError
        Something is said of a record, and there is none.
    SceneError
        The record cannot be read.
    """
    from analytic import synthetic_motion
    from analytic.records import read_record

    if record is not None:
        return read_record(record, **said)
    for name, value in said.items():
        if value is not None:
            raise SettingError(f"--{name} {value}: belongs to a record; give --record FILE")
    return synthetic_motion()


def scene_of(text: str, file: str) -> Scene:
    """The scene that a text makes as the file called `file`, before it is one.

    Raises
    ------
    SceneError
        As of that file.
    """
    from analytic.scene_file import load_scene

    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=Path(file).resolve().parent, encoding="utf-8") as part:
        part.write(text)
        part.flush()
        try:
            return load_scene(part.name)
        except SceneError as error:
            raise error.in_file(file) from None


@contextlib.contextmanager
def in_file(place: str) -> Iterator[None]:
    """What a model refuses inside is a mistake in the scene file called `place`."""
    try:
        yield
    except SceneError as error:
        raise error.in_file(place) from None


def simulate(
    scene: Scene,
    solver: str = ANALYTIC,
    variant: str | None = None,
    settings: Mapping[str, Any] | None = None,
    history: bool = True,
    time_limit: float = TIME_LIMIT,
    words: str | None = None,
    compare: bool = False,
) -> Response:
    """The `Response` of the solver called `solver`, run in a process of its own while `words` are shown.

    compare: an engine's run with the analytic model (`engines.comparison`); of the model itself, whether a change as
    small as its own errors is another outcome.

    What is odd about the record stands among its warnings. A run that crashes, or takes more than `time_limit` [s], is
    a response of outcome "failed" with the evidence.

    Raises
    ------
    SettingError
        Unknown solver, variant or setting, or a setting of the wrong type.
    EngineNotInstalled
        The engine cannot be imported here; says how to install it.
    """
    from analytic.response import about_record
    from engines.guard import OUT_OF_TIME, RAISED, run_apart

    settings = settings or {}
    check_solver(solver)
    compile_kernels(scene.motion is not None and scene.motion.vertical is not None)
    response, failure = run_apart(
        _simulate,
        scene,
        solver,
        variant,
        settings,
        history,
        compare,
        time_limit=time_limit,
        meanwhile=spinner(words) if words else None,
    )
    if failure and failure.reason == RAISED and solver == ANALYTIC:
        raise RuntimeError(f"the analytic model raised {failure.message}")  # a mistake of this project, not a result
    if failure:
        from engines.observe import failed_response

        from .cases import versions

        if failure.reason == OUT_OF_TIME:
            first, end, rest = failure.message.partition("\n")
            failure = dataclasses.replace(failure, message=f"{first}; --time-limit allows more{end}{rest}")
        response = failed_response(
            scene, failure, engine=solver, variant=variant or "", settings=dict(settings), versions=versions(solver)
        )
    odd = dict.fromkeys((*about_record(scene.motion), *response.warnings))
    return dataclasses.replace(response, warnings=tuple(odd))


def near_motion(scene: Scene) -> tuple[Caution, ...]:
    """`near` a scene's motion, shown while it is looked for; none without a motion."""
    from analytic.margins import SHARE

    if scene.motion is None:
        return ()
    with spinner(f"{scene.name}: within {SHARE:.0%} of the motion"):
        return near(scene)


def near(scene: Scene) -> tuple[Caution, ...]:
    """`analytic.margins.cliffs` of a scene with a motion, or that it was not looked for."""
    from analytic.margins import SHARE, cliffs, nearby
    from analytic.response import Caution

    try:
        return cliffs(scene, *nearby(scene))
    except SceneError as error:
        text = f"How the outcome depends on {SHARE:.0%} of the motion was not tested: {error.remedy}."
        return (Caution("motion", text),)


def with_near(scene: Scene, response: Response) -> Response:
    """The response of a scene with the warnings that `near` adds to a single run's, too."""
    return dataclasses.replace(response, warnings=(*response.warnings, *near(scene)))


def check_solver(name: str) -> None:
    """Raise `SettingError` if no solver is called `name`."""
    from engines import BROKEN, ENGINES

    if name in BROKEN:
        raise BROKEN[name]
    if name != ANALYTIC and name not in ENGINES:
        raise SettingError(f"unknown engine {name!r}: choose one of {', '.join(ENGINES)}, or {ANALYTIC}")


def named_engines(names: Iterable[str]) -> tuple[str, ...]:
    """The engines of these names, each once.

    Raises
    ------
    SettingError
        An engine has no such name; lists the known ones.
    EngineNotInstalled
        As `engines.get_engine`.
    """
    from engines import get_engine

    names = tuple(dict.fromkeys(names))
    for name in names:
        try:
            get_engine(name)
        except KeyError as error:
            raise SettingError(error.args[0]) from None
    return names


def check_time_limit(seconds: float) -> None:
    """Raise `SettingError` if a run cannot be given so many seconds."""
    from engines.guard import check_time_limit

    try:
        check_time_limit(seconds)
    except ValueError as error:
        raise SettingError(f"--{error}".replace("time_limit", "time-limit", 1)) from None


def _simulate(scene, solver, variant, settings, history, compare):
    if solver != ANALYTIC:
        from engines import get_engine
        from engines.settings import choose

        engine = get_engine(solver)
        if settings:  # else one called as an argument of `simulate` would be taken for that
            choose(engine, variant, settings)
            if "friction" in settings and scene.friction is not None:
                words = f"{solver}: friction = {settings['friction']!r}"
                raise SettingError(f"{words}: the scene's, {scene.friction:g}, is used in its place; leave it out")
        return engine.simulate(scene, variant=variant, history=history, compare=compare, **settings)
    response = _analytic(scene, variant, settings, history)
    if compare and response.decided:
        from ..measuring.horizon import unsure_outcome

        doubt = unsure_outcome(scene, response.outcome)
        return dataclasses.replace(response, warnings=(*response.warnings, *filter(None, [doubt])))
    return response


def _analytic(scene, variant, settings, history):
    import analytic

    if variant not in (None, KERNEL):
        raise SettingError(f"the analytic model has no variant {variant!r}: leave --variant out, or give {KERNEL}")
    parameters = inspect.signature(analytic.simulate).parameters
    known = [name for name in parameters if name not in ("scene", "history")]
    for name, value in settings.items():
        if name not in known:
            raise SettingError(f"the analytic model has no setting {name!r}: its settings are {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise SettingError(f"{name} = {value!r}: give a number")
    return analytic.simulate(scene, history=history, **settings)


def _check_size(name, value):
    """Numbers a solver can take: those that are finite as a double."""
    try:
        finite = math.isfinite(value)
    except OverflowError:  # a whole number beyond the doubles, with hundreds of digits
        raise SettingError(f"{name}: not a finite number; give one below 1e308") from None
    if not finite:
        raise SettingError(f"{name} = {value!r}: not a finite number; give one")


def print_failures(responses: Iterable[Response]) -> None:
    """Name the failed ones of the responses on standard error, with what a terminal can hold of the evidence."""
    for response in responses:
        if response.failure:
            evidence = readable(response.failure.message.partition("\n")[0])
            say(f"{response.engine} failed: {response.failure.reason}. {evidence}".rstrip(". ") + ".")
