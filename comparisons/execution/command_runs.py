"""Runs as the commands make them: options by name, one run, a scene under many motions, plausibility of a scene.

Options that several commands share stand here. Error messages name the option, not the parameter or key behind it.
`doubts` finds implausible numbers in a new scene: centimetres for metres, an impossible density, a tilt past the
balance, bearings that do not yield.
"""

from __future__ import annotations

import contextlib
import dataclasses
import inspect
import json
import math
import re
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from os import PathLike
from pathlib import Path
from typing import Annotated, Any

import typer

import analytic
from analytic import Response, SampledMotion, synthetic_motion
from analytic.advice.margins import SHARE, cliffs, nearby
from analytic.advice.pedestal import check_pedestal
from analytic.errors import SceneError, SettingError
from analytic.motion import Motion
from analytic.records import read_record
from analytic.records.folder import folder_motions, reversed_sign, same_reversed
from analytic.response import Caution, Failure, about_record
from analytic.scene import Scene
from analytic.scene_file import MATERIALS, UPLIFT, YIELD, derived, load_scene
from engines import BROKEN, ENGINES, get_engine, guard
from engines.comparison import changed_copies
from engines.observe import failed_response
from engines.simulating import RANGE, choose

from .cases import versions
from .progress import bar, compile_kernels, say, spinner
from .writing import readable

ANALYTIC, KERNEL = "analytic", "kernel"  # the model, and the name of its variant
TIME_LIMIT = 300.0  # s, of one run
TIME_LIMIT_HELP = "End a run that takes longer; it counts as failed."


def parse_settings(pairs: Iterable[str], option: str = "--set") -> dict[str, Any]:
    """Parse ``["step=1e-4"]`` into ``{"step": 0.0001}``. Values are JSON; anything else is text.

    Raises
    ------
    SettingError
        A pair has no "=", or a number is not finite.
    """
    settings = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not (equals and name):
            raise SettingError(f"{option} {pair}: write name=value")
        name = name.strip()
        try:
            settings[name] = json.loads(text)
        except (ValueError, RecursionError):  # no JSON, or nested too deep for a setting
            settings[name] = text
        if isinstance(settings[name], int | float):
            _check_size(name, settings[name])
    return settings


def ground_motion(record: str | PathLike[str] | None = None, **stated: Any) -> SampledMotion:
    """Return the motion in the file `record`, or without it the shipped synthetic one.

    stated: units, dt, column and channel, if the file does not state them (see `analytic.records.read_record`).

    Raises
    ------
    SettingError
        An option of a record is given without a record.
    SceneError
        The record cannot be read.
    """
    if record is not None:
        return read_record(record, **stated)
    for name, value in stated.items():
        if value is not None:
            raise SettingError(f"--{name} {value}: belongs to a record; give --record FILE")
    return synthetic_motion()


def scene_of(text: str, file: str) -> Scene:
    """Return the scene that `text` gives as the content of `file`, before that is written.

    Raises
    ------
    SceneError
        The text is no scene; the message names `file`.
    """
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=Path(file).resolve().parent, encoding="utf-8") as part:
        part.write(text)
        part.flush()
        try:
            return load_scene(part.name)
        except SceneError as error:
            raise error.in_file(file) from None


@contextlib.contextmanager
def in_file(place: str) -> Iterator[None]:
    """Let a `SceneError` raised inside name the scene file `place`."""
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
    """Run a scene with a solver in a separate process and return the `Response`. `words` are shown meanwhile.

    compare: compare an engine's run with the analytic model (`engines.comparison`); for the model itself, test whether
    a change as small as its own errors gives another outcome.

    Warnings on the record are added to those of the run. A run that crashes, or takes more than `time_limit` [s], gives
    a response with the outcome "failed" and the evidence.

    Raises
    ------
    SettingError
        The solver, variant or setting is unknown, or a setting has the wrong type.
    EngineNotInstalled
        The engine cannot be imported here; the message says how to install it.
    """
    settings = settings or {}
    check_solver(solver)
    compile_kernels(scene.motion is not None and scene.motion.vertical is not None)
    response, failure = guard.run_apart(
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
    if failure and failure.reason == guard.RAISED and solver == ANALYTIC:
        raise RuntimeError(f"the analytic model raised {failure.message}")  # a mistake of this project, not a result
    if failure:
        if failure.reason == guard.OUT_OF_TIME:
            first, end, rest = failure.message.partition("\n")
            failure = dataclasses.replace(failure, message=f"{first}; --time-limit allows more{end}{rest}")
        response = failed_response(
            scene, failure, engine=solver, variant=variant or "", settings=dict(settings), versions=versions(solver)
        )
    odd = dict.fromkeys((*about_record(scene.motion), *response.warnings))
    return dataclasses.replace(response, warnings=tuple(odd))


# {field of `schemas.runs.Pedestal`: value} or None; warnings; the sentence that the pedestal stays, if it does
PedestalChecked = tuple[dict[str, Any] | None, tuple[Caution, ...], list[str]]


def pedestal_check(scene: Scene) -> PedestalChecked:
    """Return ({field of `schemas.runs.Pedestal`: value} or None, its warnings, or the sentence that it stays)."""
    if (check := check_pedestal(scene)) is None:
        return None, (), []
    return asdict(check) | {"text": check.text}, check.cautions, [] if check.cautions else [check.text]


def near_motion(scene: Scene) -> tuple[Caution, ...]:
    """Return the warnings of `near` and show a line meanwhile; none without a motion."""
    if scene.motion is None:
        return ()
    if scene.is_stack:  # which is not tested
        return near(scene)
    with spinner(f"{scene.name}: within {SHARE:.0%} of the motion"):
        return near(scene)


def near(scene: Scene) -> tuple[Caution, ...]:
    """Return the warnings of `margins.cliffs` for a scene with a motion, or that these were not determined."""
    try:
        return cliffs(scene, *nearby(scene))
    except SceneError as error:
        remedy = "see rocking margin" if scene.is_stack else error.remedy
        return (Caution("motion", f"How the outcome depends on {SHARE:.0%} of the motion was not tested: {remedy}."),)


def with_near(scene: Scene, response: Response) -> Response:
    """Return the response of a scene with the warnings of `near` and of `pedestal_check` added."""
    return dataclasses.replace(response, warnings=(*response.warnings, *near(scene), *pedestal_check(scene)[1]))


def check_solver(name: str) -> None:
    """Raise `SettingError` if no solver is called `name`."""
    if name in BROKEN:
        raise BROKEN[name]
    if name != ANALYTIC and name not in ENGINES:
        raise SettingError(f"unknown engine {name!r}: choose one of {', '.join(ENGINES)}, or {ANALYTIC}")


def named_engines(names: Iterable[str]) -> tuple[str, ...]:
    """Return these names of engines, each once.

    Raises
    ------
    SettingError
        No engine has such a name; the message lists the known ones.
    EngineNotInstalled
        As for `engines.get_engine`.
    """
    names = tuple(dict.fromkeys(names))
    for name in names:
        try:
            get_engine(name)
        except KeyError as error:
            raise SettingError(error.args[0]) from None
    return names


def check_time_limit(seconds: float) -> None:
    """Raise `SettingError` if `seconds` is no valid time limit of a run."""
    try:
        guard.check_time_limit(seconds)
    except ValueError as error:
        raise SettingError(f"--{error}".replace("time_limit", "time-limit", 1)) from None


def _simulate(scene, solver, variant, settings, history, compare):
    if solver != ANALYTIC:
        engine = get_engine(solver)
        if settings:  # a setting could have the name of an argument of `simulate`
            choose(engine, variant, settings)
            if "friction" in settings and scene.friction is not None:
                words = f"{solver}: friction = {settings['friction']!r}"
                raise SettingError(f"{words}: the scene's, {scene.friction:g}, is used in its place; leave it out")
        return engine.simulate(scene, variant=variant, history=history, compare=compare, **settings)
    response = _analytic(scene, variant, settings, history)
    if compare and response.decided:
        doubt = unsure_outcome(scene, response.outcome)
        return dataclasses.replace(response, warnings=(*response.warnings, *filter(None, [doubt])))
    return response


def unsure_outcome(scene: Scene, outcome: str, perturbation: float = 1e-6) -> Caution | None:
    """Return a warning if one of the `changed_copies` has another outcome than the model's `outcome`, or None."""
    for name, copy in changed_copies(scene, perturbation).items():
        try:
            other = analytic.simulate(copy, history=False).outcome
        except SceneError as error:  # the copy is refused, not the scene
            other = f"cannot be run ({error.problem})"
        if other != outcome:
            words = (
                f"with {name} by {perturbation:.0e} the block {other}, without it {outcome}: the scene is near an "
                "outcome boundary; see rocking margin"
            )
            return Caution("model", words, "outcome", perturbation)
    return None


def _analytic(scene, variant, settings, history):
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
    """Raise `SettingError` unless the number is finite as a double."""
    try:
        finite = math.isfinite(value)
    except OverflowError:  # a whole number beyond the doubles, with hundreds of digits
        raise SettingError(f"{name}: not a finite number; give one below 1e308") from None
    if not finite:
        raise SettingError(f"{name} = {value!r}: not a finite number; give one")


def print_failures(responses: Iterable[Response]) -> None:
    """Name each failed response on standard error, with the first line of the evidence."""
    for response in responses:
        if response.failure:
            evidence = readable(response.failure.message.partition("\n")[0])
            say(f"{response.engine} failed: {response.failure.reason}. {evidence}".rstrip(". ") + ".")


SceneFile = Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")]
EngineNames = Annotated[
    list[str] | None, typer.Option("--engine", help="Engine; may be repeated. Default: all that are installed.")
]
JsonFile = Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - prints it.")]
# What a user states about a record if its file does not.
Units = Annotated[
    str | None,
    typer.Option(help="Unit of the accelerations, if the file states none: m/s2, cm/s2, gal, mm/s2, g or %g."),
]
Step = Annotated[
    float | None,
    typer.Option(metavar="SECONDS", help="Sampling interval, if the file states none (as in a line dt = 0.01 s)."),
]
Column = Annotated[
    str | None,
    typer.Option(help="Column of the accelerations, if there are several: its number (from 1) or its title."),
]
Channel = Annotated[
    str | None, typer.Option(help="Channel to read, if there are several: its number or direction, such as 3 or Up.")
]
# Help texts that `rocking new` and `rocking design` share.
DEFINITION = (
    "Definition of the damping ratio. equivalent, the usual one: W_D/(4 pi E_s). paper, twice as much: W_D/(2 pi E_s)."
)
RATIO = "Bearings by design: stiffness ratio ka/kb; the paper's Table 1(b) has 10."
RECORD_OPTIONS = {f"motion.{name}": f"--{name}" for name in ("units", "dt", "column", "channel")}
_SAME = ("height", "width", "depth", "density", "mass", "period", "damping", "definition", "count", "friction")
OPTIONS = {
    **{name: f"--{name}" for name in _SAME},
    **{f"bearings.{name}": f"--{name}" for name in ("count", "ka", "kb", "alpha")},
    **RECORD_OPTIONS,
    **{"x_max": "--xmax", "bearings.x_max": "--xmax", "stiffness_ratio": "--ratio", "start.tilt": "--tilt"},
    **{"block.mass": "--mass", "base.mass": "--base-mass"},
    **{f"pedestal.{name}": f"--pedestal-{name}" for name in ("width", "mass", "height")},
}
PENDULUM = {"radius": "--pendulum-radius", "friction": "--pendulum-friction"}


@contextlib.contextmanager
def named_by_options(options: Mapping[str, str]) -> Iterator[None]:
    """Let errors raised inside name options. options: {parameter of a function, or key of a scene: option}."""
    try:
        yield
    except SettingError as error:
        words = str(error)
        for name, option in options.items():
            end = r"\b" if "_" in name else "(?= = )"  # a plain word of the sentence is not replaced
            words = re.sub(rf"(?<![\w.-]){re.escape(name)}{end}", option, words)
        raise SettingError(words) from None
    except SceneError as error:
        raise _by_options(error, options) from None


def _by_options(error: SceneError, options: Mapping[str, str]) -> SceneError:
    """The same error, and the others it carries, with the names of options."""
    key = options.get(error.key, error.key)
    names_file = key == error.key or error.key in RECORD_OPTIONS
    file = error.file if names_file else None  # other options name no file
    others = tuple(_by_options(other, options) for other in error.others)
    return SceneError(key, error.value, error.problem, error.remedy, file, others)


Records = Annotated[
    str | None, typer.Option(metavar="FOLDER", help="Repeat under every record in this folder, unscaled.")
]
BothSigns = Annotated[
    bool, typer.Option("--both-signs", help="Repeat with the motion reversed (skipped for symmetric cases).")
]
Directions = Annotated[
    int | None,
    typer.Option(
        metavar="NUMBER",
        help="Rotate the two horizontal components of each record to this many directions over 180 degrees.",
    ),
]


OWN = "the scene's own motion"  # record of a scene's own motion that is not in the folder


def motions_of(
    scene: Scene, records: str | None, both_signs: bool, directions: int | None, units: str | None = None
) -> tuple[dict[str, list[Motion]], list[str]]:
    """Return ({record: its motions}, lines on what was left out and why). The lines are also printed.

    The motions include the scene's own, see `with_own`.

    Raises
    ------
    SettingError
        There is no such folder, or no motion in it; or directions or units are given without a folder.
    """
    for name, value in (("directions", directions), ("units", units)):
        if value is not None and records is None:
            raise SettingError(f"--{name} {value}: give the folder of the records with --records")
    groups: dict[str, list[Motion]] = {}
    left: list[str] = []
    if records is not None:
        with named_by_options({"directions": "--directions"}):
            others, left = folder_motions(records, directions=directions, scene_motion=scene.motion, units=units)
        groups = {name: [*motions] for name, motions in others.items()}
        for line in left:
            say(line)
    groups = with_own(scene.motion, groups)
    if both_signs and same_reversed(scene):
        say("--both-signs: mirrored the same, as block and start are symmetric; each motion is run once")
    elif both_signs:
        groups = {name: [*motions, *map(reversed_sign, motions)] for name, motions in groups.items()}
    return groups, left


def with_own(motion: Motion | None, groups: Mapping[str, Sequence[Motion]]) -> dict[str, list[Motion]]:
    """Return {record: its motions} with a scene's own motion, if it is not among them.

    It is then the first motion of the record of its name or, if there is none, of the record `OWN`.
    """
    merged = {record: [*motions] for record, motions in groups.items()}
    if motion is None or any(each.digest() == motion.digest() for motions in merged.values() for each in motions):
        return merged
    return {motion.label if motion.label in merged else OWN: [motion, *merged.pop(motion.label, [])], **merged}


def other_motions(
    scene: Scene, records: str | None, both_signs: bool, directions: int | None, units: str | None = None
) -> tuple[dict[str, list[Motion]], list[str]]:
    """Return `motions_of` if one of the options is given; otherwise no motions."""
    given = both_signs or any(value is not None for value in (records, directions, units))
    return motions_of(scene, records, both_signs, directions, units) if given else ({}, [])


def read_row(record: str, motion: Motion, warnings: Sequence[Caution] = ()) -> dict[str, Any]:
    """Return a motion as it was read, with the fields of `schemas.runs.MotionRead`.

    warnings: further ones, added to those on the record.
    """
    cautions = dict.fromkeys((*about_record(motion), *warnings))
    return {"record": record, "motion": motion.label, "peak": motion.peak, "warnings": list(map(asdict, cautions))}


def rows_of(
    scene: Scene,
    groups: Mapping[str, Sequence[Motion]],
    simulate: Callable[[Scene], Response],
    more: Callable[[Scene], Mapping[str, Any]] = lambda scene: {},
) -> list[dict[str, Any]]:
    """Return `row_of` each motion, in the order of the groups, and show a bar meanwhile."""
    pairs = [(record, motion) for record, motions in groups.items() for motion in motions]
    if not pairs:
        return []
    rows = []
    with bar(f"{scene.name}: {len(pairs)} motions") as progress:
        for record, motion in pairs:
            rows.append(row_of(scene, record, motion, simulate, more))
            progress(len(rows), len(pairs))
    return rows


def row_of(
    scene: Scene,
    record: str,
    motion: Motion,
    simulate: Callable[[Scene], Response],
    more: Callable[[Scene], Mapping[str, Any]] = lambda scene: {},
) -> dict[str, Any]:
    """Run a scene under one of many motions and return the fields of `schemas.runs.MotionRun`.

    simulate: returns the response of the scene under the motion. If the scene is refused, the row is that of a failed
    run. more: returns further fields of the row.
    """
    try:
        under = scene.with_(motion=motion)
        response, added = simulate(under), more(under)
    except SceneError as error:
        response, added = refused(scene.with_(motion=None), error), {}
    return {**read_row(record, motion, response.warnings), **_measures(scene, response), **added}


def end_with(rows: Sequence[Mapping[str, Any]], *responses: Response) -> None:
    """End the command with status 1 if the run of a motion, or one of the responses, failed."""
    if any(row["failure"] for row in rows) or any(response.failure for response in responses):
        raise typer.Exit(1)


def refused(scene: Scene, error: SceneError, **known: Any) -> Response:
    """Return the failed response of a scene that a solver refuses. known: engine, variant, ...; else the model's."""
    name = known.get("engine", ANALYTIC)
    solver = {"engine": name, "variant": "", "settings": {}, "versions": versions(name)}
    return failed_response(scene, Failure("it cannot run this scene", str(error)), **{**solver, **known})


def _measures(scene: Scene, response: Response) -> dict[str, Any]:
    """Outcome, failure and peaks of a run, as fields of a row."""
    failure = response.failure
    return {
        "outcome": response.outcome,
        "failure": failure and f"{failure.reason}: {failure.message.partition(chr(10))[0]}".removesuffix(": "),
        "tilt": response.peak_tilt_ratio,
        "stroke": response.peak_base_displacement if scene.base else None,
        "slip": response.sliding and response.sliding.peak,
    }


# Least density over that of the lightest material: walls of a tenth of the width fill a third of a hollow piece, and a
# figure fills half of its box.
HOLLOW = 1 / 6


# Long because each doubt names options, values, range and remedy.
def doubts(
    scene: Scene, height: float, width: float, depth: float | None = None, *, weighed: bool, designed: bool
) -> list[str]:
    """Return a sentence on each implausible value: the options, their value, the plausible range and the remedy.

    Parameters
    ----------
    scene : Scene
        The scene made from the options.
    height, width, depth : float
        Dimensions of the block [m]; the depth is the width if it is not given.
    weighed : bool
        The mass of the block was given, not its density.
    designed : bool
        The bearings were given by their period, not by their constants.
    """
    block, sentences = scene.block, []
    sizes = f"--height {height:g} and --width {width:g}"
    least, most, _ = RANGE["radius"]  # the range in which the engines are tested
    if not least <= block.radius <= most:  # whatever follows from these lengths is wrong, too
        return [
            f"{sizes} give a radius R of {block.radius:.3g} m, a statue has {least:g} to {most:g} m; "
            f"give them in m{_meant(height, width)}"
        ]
    least, most, _ = RANGE["slenderness"]  # stockier blocks slide or stand, more slender ones fall at once
    if not least <= block.slenderness <= most:
        sentences.append(
            f"{sizes} give a slenderness of {block.slenderness:.3g} rad, a statue has {least:g} to {most:g} rad: "
            f"a width of {math.tan(least):.2g} to {math.tan(most):.2g} of the height; "
            + ("exchange them" if least <= math.pi / 2 - block.slenderness <= most else "correct one")
        )
    if depth is not None and depth > 2 * RANGE["radius"][1]:  # a side of the largest statue is 2 R at most
        sentences.append(
            f"--depth {depth:g} is longer than any side of a statue, {2 * RANGE['radius'][1]:g} m; give it in m"
        )
    tilt = scene.start.tilt
    if scene.motion is None and not 0 < abs(tilt) < block.slenderness:
        what = "releases the block where it stands: nothing moves" if tilt == 0 else "is beyond its balance: it falls"
        sentences.append(
            f"--tilt {tilt:g} {what}; give a size between 0 and the slenderness, {block.slenderness:.4g} rad"
        )
    density = block.mass / (height * width * (depth or width))
    least, most = HOLLOW * min(MATERIALS.values()), max(MATERIALS.values())  # the densest one, solid
    if not least <= density <= most:
        given = f"--mass {block.mass:g} makes a block of" if weighed else "--density is"
        remedy = "give the mass in kg, or the block's --depth in m" if weighed else "give it in kg/m3"
        sentences.append(
            f"{given} {density:.3g} kg/m3, a statue has {least:g} (hollow wood) to {most:g} (bronze); {remedy}"
        )
    values = {name: value for name, value, _ in derived(scene)}
    if values.get(YIELD, 0.0) >= values[UPLIFT]:  # before they yield they are stiff, and the block lifts
        given, remedy = "--ka, --kb and --alpha", "give a lower --ka or a higher --alpha"
        if designed:
            given = "--period, --damping and --xmax"
            remedy = "give a longer --period, a lower --damping or a smaller --xmax"
        elif scene.bearings is not None and scene.bearings.law == "bilinear":  # by no other option
            given, remedy = " and ".join(PENDULUM.values()), f"give a lower {PENDULUM['friction']}"
        sentences.append(
            f"{given} give bearings that yield at {values[YIELD]:.3g} m/s2, and so do not isolate before the block "
            f"lifts at {values[UPLIFT]:.3g} m/s2: they should yield below that; {remedy}"
        )
    return sentences


def _meant(height: float, width: float) -> str:
    """Ask whether one or both of the lengths were given in cm or mm; "" if that gives no statue either."""
    guesses = []
    for unit, scale in (("cm", 100), ("mm", 1000)):
        for high, wide in ((height / scale, width / scale), (height / scale, width), (height, width / scale)):
            sizes = {"radius": math.hypot(high, wide) / 2, "slenderness": math.atan2(wide, high)}
            if all(RANGE[name][0] <= size <= RANGE[name][1] for name, size in sizes.items()):
                guesses.append(f"--height {high:g} --width {wide:g} (from {unit})")
    return f"; did you mean {' or '.join(guesses)}?" if guesses else ""


def confirm(sentences: Sequence[str]) -> None:
    """Return if there are no doubts, or if the user confirms the values in a terminal.

    Raises
    ------
    SettingError
        There are doubts, and there is no terminal or the answer is no.
    """
    if not sentences:
        return
    words = "; ".join(sentences)
    if not sys.stdin.isatty():
        raise SettingError(f"{words} (--anyway writes the file as it is)")
    if not typer.confirm(f"{words}\nWrite it anyway?", err=True):
        raise SettingError("nothing was written; correct the options named")
