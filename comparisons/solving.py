"""One run as a user asks for it: ground motion, solver and settings by name, checked; progress on standard error."""

import contextlib
import dataclasses
import inspect
import json
import os
import sys

from analytic.errors import SettingError

ANALYTIC = "analytic"


def parse_settings(pairs):
    """``["step=1e-4"]`` -> ``{"step": 0.0001}``; values are JSON, anything else is text.

    Raises
    ------
    SettingError
        A pair without "=".
    """
    settings = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not (equals and name):
            raise SettingError(f"--set {pair}: write name=value")
        try:
            settings[name.strip()] = json.loads(text)
        except ValueError:
            settings[name.strip()] = text
    return settings


def ground_motion(record=None, units=None):
    """The motion in the file `record`, or the shipped synthetic one without it; `units` of a record in two columns.

    Raises
    ------
    SettingError
        Units without a record.
    SceneError
        The record cannot be read.
    """
    from analytic import synthetic_motion
    from analytic.records import read_record

    if units and not record:
        raise SettingError(f"--units {units}: belongs to a record; give --record FILE")
    return read_record(record, units) if record else synthetic_motion()


def simulate(scene, solver=ANALYTIC, variant=None, settings=None, history=True):
    """The `Response` of the solver called `solver`.

    Raises
    ------
    SettingError
        Unknown solver, variant or setting, or a setting of the wrong type.
    EngineNotInstalled
        The engine cannot be imported here; says how to install it.
    """
    settings = settings or {}
    with stdout_to_stderr():  # engines print greetings to standard output, from C as well
        if solver == ANALYTIC:
            return _analytic(scene, variant, settings, history)
        from engines import get_engine

        try:
            engine = get_engine(solver)
        except KeyError as error:
            raise SettingError(f"{error.args[0]}, or {ANALYTIC}") from None
        _check_types(engine, variant, settings)
        return engine.simulate(scene, variant=variant, history=history, **settings)


def _analytic(scene, variant, settings, history):
    import analytic

    if variant is not None:
        raise SettingError(f"the analytic model has no variant {variant!r}: leave --variant out")
    parameters = inspect.signature(analytic.simulate).parameters
    known = [name for name in parameters if name not in ("scene", "history")]
    for name, value in settings.items():
        if name not in known:
            raise SettingError(f"the analytic model has no setting {name!r}: its settings are {', '.join(known)}")
        _check_number(name, value)
    return analytic.simulate(scene, history=history, **settings)


def _check_types(engine, variant, settings):
    """Unknown names are the engine's to refuse; a text where a number belongs is refused here."""
    defaults = engine.VARIANTS.get(variant or engine.DEFAULT_VARIANT)
    if defaults is None:
        return
    for field in dataclasses.fields(defaults):
        default = getattr(defaults, field.name)
        if field.name not in settings or default is None:
            continue
        value = settings[field.name]
        if isinstance(default, bool) or isinstance(default, str):
            if type(value) is not type(default):
                raise SettingError(f"{field.name} = {value!r}: give a value such as {json.dumps(default)}")
        elif isinstance(default, int | float):
            _check_number(field.name, value, whole=isinstance(default, int))


def _check_number(name, value, whole=False):
    if isinstance(value, bool) or not isinstance(value, int if whole else int | float):
        raise SettingError(f"{name} = {value!r}: give a {'whole ' if whole else ''}number")


def say(text):
    """A line of progress on standard error."""
    print(text, file=sys.stderr, flush=True)


@contextlib.contextmanager
def spinner(text):
    """A line on standard error with the time elapsed, while something runs; nothing where that is no terminal."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    with Progress(SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn(), transient=True,
                  console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task(text)
        yield lambda words: progress.update(task, description=words)


@contextlib.contextmanager
def stdout_to_stderr():
    """What this process prints to standard output, compiled code included, goes to standard error."""
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
