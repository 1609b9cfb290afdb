"""``rocking new``: a scene file for one's own block."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..running.record_options import Channel, Column, Step, Units


def command(
    file: Annotated[str, typer.Argument(help="Scene file to write (.toml); must not exist.")],
    height: Annotated[float | None, typer.Option(help="Of the block [m].")] = None,
    width: Annotated[float | None, typer.Option(help="Of the block along the motion [m].")] = None,
    depth: Annotated[float | None, typer.Option(help="Of the block across it [m]; the width, if not given.")] = None,
    mass: Annotated[float | None, typer.Option(help="Of the block [kg]; or give density or material.")] = None,
    density: Annotated[float | None, typer.Option(help="Of the block [kg/m3].")] = None,
    material: Annotated[str | None, typer.Option(help="marble, granite, limestone, bronze, ...: its density.")] = None,
    name: Annotated[str | None, typer.Option(help="Of the scene; that of the file, if not given.")] = None,
    base_mass: Annotated[float | None, typer.Option(help="Isolated: mass of the base under the block [kg].")] = None,
    count: Annotated[int, typer.Option(help="Number of bearings.")] = 4,
    period: Annotated[float | None, typer.Option(help="Bearings by design: secant period at --xmax [s].")] = None,
    damping: Annotated[float, typer.Option(help="By design: W_D/(4 pi E_s) at --xmax.")] = 0.15,
    xmax: Annotated[float | None, typer.Option(help="By design: displacement [m].")] = None,
    ka: Annotated[float | None, typer.Option(help="Bearings by constants: stiffness before yielding [N/m].")] = None,
    kb: Annotated[float | None, typer.Option(help="By constants: stiffness after yielding [N/m].")] = None,
    alpha: Annotated[float | None, typer.Option(help="By constants: exponent of eq. (13).")] = None,
    record: Annotated[
        str | None, typer.Option(metavar="FILE", help="Ground motion; without it the synthetic one.")
    ] = None,
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
    tilt: Annotated[float | None, typer.Option(help="Released from this tilt [rad], without a motion.")] = None,
    friction: Annotated[float | None, typer.Option(help="Coefficient between the block and what it stands on.")] = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write what follows from the scene; - prints it.")
    ] = None,
) -> None:
    """Write a commented scene file, and print what follows from it. What is missing is asked for in a terminal.

    Example: rocking new bust.toml --height 1.9 --width 0.55 --material marble --base-mass 400 --period 2.5 --xmax 0.2
    """
    from analytic.errors import SettingError
    from analytic.new_scene import block_from, scene_text
    from analytic.scene import Base

    from ..running.files import check_writable

    check_writable([file, json_file])
    if Path(file).exists():
        raise SettingError(f"{file}: exists; give another name, or remove it")
    height = _asked(height, "height", "Height of the block [m]")
    width = _asked(width, "width", "Width along the motion [m]")
    if mass is None and density is None and material is None:
        material, mass = _weight()
    block = block_from(height, width, depth=depth, density=_density(density, material), mass=mass)
    bearings = None
    if base_mass is not None:
        bearings = _bearings(block.mass + base_mass, count, (period, damping, xmax), (ka, kb, alpha))
    elif any(value is not None for value in (period, xmax, ka, kb, alpha)):
        raise SettingError("bearings carry a base: give its mass with --base-mass")
    motion = _motion(file, record, tilt, {"units": units, "dt": dt, "column": column, "channel": channel})
    base = None if base_mass is None else Base(mass=base_mass)
    about = f"A block {height:g} m high and {width:g} m wide along the motion; rocking run {Path(file).name}"
    parts = {"base": base, "bearings": bearings, "motion": motion, "tilt": tilt, "friction": friction}
    text = scene_text(name or Path(file).stem, block, **parts, about=(about,))  # type: ignore[arg-type]  # as named
    _write_and_tell(file, text, json_file)


def _asked(value: float | None, option: str, question: str) -> float:
    """The value, or the answer to the question where somebody sits at a terminal."""
    import sys

    from analytic.errors import SettingError

    if value is not None:
        return value
    if not sys.stdin.isatty():
        raise SettingError(f"--{option} is missing: {question[0].lower()}{question[1:]}")
    return float(typer.prompt(question, type=float))


def _weight() -> tuple[str | None, float | None]:
    """(material, mass [kg]) as answered; one of them is None."""
    import sys

    from analytic.errors import SettingError
    from analytic.new_scene import MATERIALS

    if not sys.stdin.isatty():
        raise SettingError("the block's weight is missing: give --mass [kg], --density [kg/m3] or --material")
    answer = typer.prompt(f"Mass [kg], or material ({', '.join(MATERIALS)})").strip()
    try:
        return None, float(answer)
    except ValueError:
        return answer, None


def _density(density: float | None, material: str | None) -> float | None:
    from analytic.errors import SettingError
    from analytic.new_scene import MATERIALS

    if material is None:
        return density
    if density is not None:
        raise SettingError("give --density or --material, not both")
    if material not in MATERIALS:
        raise SettingError(f"--material {material}: choose one of {', '.join(MATERIALS)}, or give --density [kg/m3]")
    return MATERIALS[material]


def _bearings(carried: float, count: int, design: tuple, constants: tuple) -> Any:
    """The `Bearings` of a design (period, damping, x_max) or of constants (ka, kb, alpha)."""
    from analytic.design import design_bearings
    from analytic.errors import SettingError
    from analytic.scene import Bearings

    period, damping, xmax = design
    ka, kb, alpha = constants
    by_design, by_constants = (any(v is not None for v in values) for values in ((period, xmax), constants))
    if by_design == by_constants or None in ((period, xmax) if by_design else constants):
        raise SettingError("give the bearings' --period and --xmax (and --damping), or their --ka, --kb and --alpha")
    if by_constants:
        return Bearings(count=count, ka=ka, kb=kb, alpha=alpha)
    return design_bearings(carried, period, damping, xmax, count=count, definition="equivalent")


def _motion(file: str, record: str | None, tilt: float | None, said: Mapping[str, Any]) -> dict[str, Any] | None:
    """The table [motion]; a record is named as seen from the scene file. `said`: what it does not say itself."""
    from analytic.errors import SettingError
    from analytic.records import read_record

    if record is not None and tilt is not None:
        raise SettingError("give --record or --tilt, not both")
    said = {name: value for name, value in said.items() if value is not None}
    if record is None and said:
        raise SettingError(f"--{min(said)} {said[min(said)]}: belongs to a record; give --record FILE")
    if tilt is not None:
        return None
    if record is None:
        return {"synthetic": "duzce-like"}
    read_record(record, **said)  # one that cannot be read is said by its own name
    place = os.path.relpath(record, Path(file).resolve().parent)
    return {"record": place, **said}


def _write_and_tell(file: str, text: str, json_file: str | None) -> None:
    """Write the file if it makes a scene, and print or write what follows from it."""
    import tempfile

    from rich import box
    from rich.console import Console
    from rich.table import Table

    from analytic.new_scene import derived
    from analytic.scene_file import load_scene

    from ..running.files import write_text
    from ..schemas.inputs import Derived, New

    # read before it is kept: a record that cannot be read, say, leaves no file behind
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=Path(file).resolve().parent, encoding="utf-8") as part:
        part.write(text)
        part.flush()
        scene = load_scene(part.name)
    write_text(file, text)
    rows = derived(scene)
    if json_file:
        found = [Derived(name=label, value=value, unit=unit) for label, value, unit in rows]
        write_text(json_file, New(file=file, scene=scene.name, derived=found).text())
    if json_file == "-":
        return
    table = Table(title=f"{file}: {scene.name}", box=box.SIMPLE, show_header=False)
    for label, value, unit in rows:
        table.add_row(label, f"{value:.5g}" + ("" if unit == "-" else f" {unit}"))
    Console(highlight=False).print(table)
