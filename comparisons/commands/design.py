"""``rocking design``: bearings from target period, damping and displacement, or bearings for a scene."""

import dataclasses
import math
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from analytic.errors import SceneError, SettingError

from ..cli.output import write_output
from ..running.files import check_writable
from ..running.options import (
    DEFINITION,
    OPTIONS,
    RATIO,
    BothSigns,
    Directions,
    Records,
    Units,
    end_with,
    motions_of,
    named_by_options,
    read_row,
    rows_of,
)
from ..running.progress import bar, compile_kernels
from ..running.solving import in_file, scene_of

LEAST, SOFTEST = "least-stroke", "softest"
WRITTEN = ("ka", "kb", "alpha")  # numbers written with six digits
OF_SCENE = {  # names in errors of the search, and their options
    **{"stroke": "--stroke", "x_max": "--stroke", "tilt": "--tilt"},
    **{name: OPTIONS[name] for name in ("count", "stiffness_ratio", "definition")},
}


def command(
    scene: Annotated[
        str | None, typer.Argument(help="Scene file for which bearings are found. Without one, give four targets.")
    ] = None,
    stroke: Annotated[float | None, typer.Option(help="Scene: largest displacement of the base [m].")] = None,
    base_mass: Annotated[
        float | None, typer.Option(help="Scene of a block on the ground: mass of the base to add [kg].")
    ] = None,
    tilt: Annotated[
        float, typer.Option(help="Scene: largest peak tilt over the slenderness; 0: the block must not lift.")
    ] = 0.0,
    write: Annotated[
        Literal["least-stroke", "softest"] | None, typer.Option(help="Write these bearings into the scene file.")
    ] = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Scene: draw the suitable bearings (.png, .svg or .pdf).")
    ] = None,
    records: Records = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    units: Units = None,
    period: Annotated[float | None, typer.Option(help="Target: secant period at --xmax [s].")] = None,
    damping: Annotated[float | None, typer.Option(help="Target: damping ratio at --xmax, e.g. 0.30.")] = None,
    xmax: Annotated[float | None, typer.Option(help="Target: design displacement [m].")] = None,
    mass: Annotated[float | None, typer.Option(help="Target: mass of block and base together [kg].")] = None,
    count: Annotated[int, typer.Option(help="Number of bearings.")] = 4,
    ratio: Annotated[float, typer.Option(help=RATIO)] = 10.0,
    definition: Annotated[str, typer.Option(help=DEFINITION)] = "equivalent",
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the design; - prints it.")
    ] = None,
) -> None:
    """Design bearings: those with which a scene's block does not lift within a stroke, or constants from targets.

    Where the scene gives a friction, the block must not slide on its base, either.

    For a block on the ground, give the mass of a base, which --write adds to the file, too. Status 1: on the bearings
    found, the model failed under a motion.
    Example: rocking design bust.toml --stroke 0.25 --plot bearings.svg --write least-stroke
    Example: rocking design --period 2 --damping 0.30 --definition paper --xmax 0.30 --mass 3384.05
    """
    targets = {"period": period, "damping": damping, "xmax": xmax, "mass": mass}
    given = [f"--{name}" for name, value in targets.items() if value is not None]
    made: dict[str, Any] = {"count": count, "stiffness_ratio": ratio, "definition": definition}
    if scene is None:
        of_scene = {"--stroke": stroke, "--write": write, "--plot": plot, "--records": records, "--tilt": tilt or None}
        of_scene["--base-mass"] = base_mass
        wrong = [name for name, value in of_scene.items() if value is not None]
        if wrong:
            raise SettingError(f"{wrong[0]}: belongs to a scene; rocking design SCENE --stroke METRES")
        if len(given) < len(targets):
            missing = next(f"--{name}" for name, value in targets.items() if value is None)
            raise SettingError(f"{missing} is missing; give all four targets, or a scene and --stroke")
        return _by_targets(targets, made, json_file)
    if given:
        raise SettingError(f"{given[0]}: a target, which does not go with a scene; give --stroke only")
    if stroke is None:
        raise SettingError("--stroke is missing: give the largest displacement of the base [m]")
    many = {"records": records, "both_signs": both_signs, "directions": directions, "units": units}
    _for_scene(scene, base_mass, stroke, tilt, made, many, write, plot, json_file)


def _by_targets(targets, made, json_file):
    """Constants for four targets."""
    from rich.text import Text

    from analytic.design import design_bearings, properties

    from ..schemas.advice import Constants, Design, Properties
    from ..showing.parts import percent
    from ..showing.terminal import echo

    check_writable([json_file])
    mass, xmax = targets["mass"], targets["xmax"]
    with named_by_options(OPTIONS):
        bearings = design_bearings(mass, targets["period"], targets["damping"], xmax, **made)
    back = properties(bearings, mass, xmax)
    constants, given = Constants(**bearings.model_dump()), Properties(**dataclasses.asdict(back))
    lines = (
        Text.from_markup(
            f"[bold]ka[/bold] = {bearings.ka:.5g} N/m   [bold]kb[/bold] = {bearings.kb:.5g} N/m   "
            f"[bold]alpha[/bold] = {bearings.alpha:.4f}   for each of {bearings.count} bearings"
        ),
        f"back: secant period {back.period:.5g} s at {xmax:g} m ({back.period_kb:.4g} s with kb alone); "
        f"damping {percent(back.damping_paper, 4)} as W_D/(2 pi E_s), "
        f"{percent(back.damping_equivalent, 4)} as W_D/(4 pi E_s); "
        f"loss {back.cycle_loss:.5g} J a cycle and bearing",
    )
    write_output({json_file: Design(bearings=constants, properties=given)}, lambda: echo(*lines))


def _for_scene(place, base_mass, stroke, tilt, made, many, write, plot, json_file):
    """Find suitable bearings by a scan; show, draw and write them."""
    from analytic.bearing_scan import scan_bearings
    from analytic.limits import scene_warnings
    from analytic.scene_file import load_scene, shipped_scenes

    from ..showing.margins import draw_bearings, nothing_holds, print_bearings

    check_writable([json_file], picture=plot, inputs=[place])
    scene = _on_base(load_scene(place), base_mass, place)
    if write and place in shipped_scenes() and not Path(place).exists():
        raise SettingError(f"--write: {place} comes with the package; give a scene file of your own")
    groups, left = motions_of(scene, **many)
    motions = [motion for group in groups.values() for motion in group]
    compile_kernels(any(motion.vertical for motion in motions))
    with bar(f"{scene.name}: bearings") as progress, named_by_options(OF_SCENE), in_file(place):
        scan = scan_bearings(scene, motions, stroke, tilt=tilt, **made, progress=progress)
    points = {LEAST: scan.least_stroke, SOFTEST: scan.softest}  # (period, damping), None without any
    chosen = {name: _chosen(scene, scan, point, groups, left) for name, point in points.items() if point is not None}
    nothing = "" if chosen else nothing_holds(scene, scan, stroke, tilt, motions)
    if write and nothing:
        raise SettingError(f"--write: {nothing}")
    read = [read_row(record, motion) for record, group in groups.items() for motion in group]
    warnings = scene_warnings(scene.with_(bearings=scan.designs[0]))  # it is to have some
    results = {json_file: _form(scene, stroke, tilt, read, left, scan, chosen, warnings)}
    if write:
        results[place] = _written(place, chosen[write]["bearings"], None if base_mass is None else scene.base)
    write_output(
        results,
        lambda: print_bearings(scene, scan, stroke, tilt, read, chosen, warnings, nothing),
        plot,
        lambda: draw_bearings(scene, scan, stroke, tilt),
    )
    if write and json_file != "-":
        print(f"written into {place}: {write}")
    end_with([row for one in chosen.values() for row in one["motions"]])


def _on_base(scene, mass, place):
    """The scene with a base under its block; mass [kg]: of the base of a scene without one."""
    from analytic.scene import Base

    if mass is None and scene.base is None:
        raise SettingError(
            f"--base-mass is missing: in {place} the block stands on the ground; give its base's mass [kg]"
        )
    if mass is not None and scene.base is not None:
        raise SettingError(f"--base-mass {mass:g}: {place} has a base, of {scene.base.mass:g} kg; leave it out")
    with named_by_options(OPTIONS):
        return scene if mass is None else scene.with_(base=Base(mass=float(f"{mass:.6g}")))  # rounded as in the file


def _chosen(scene, scan, point, groups, left=()):
    """The bearings at a point, rounded as in a file, and what each motion does on them, from new runs."""
    from analytic import simulate
    from analytic.scene import Bearings

    from ..showing.margins import LIFTED, headline

    exact = scan.bearings(*point)
    bearings = Bearings(**{**exact.model_dump(), **{name: float(f"{exact.given(name):.6g}") for name in WRITTEN}})
    borne = scene.with_(bearings=bearings, duration=None)
    rows = rows_of(borne, groups, lambda one: simulate(one, history=False), _demand)
    demand, worst = max(row.pop("demand", math.inf) for row in rows), max(rows, key=lambda row: row["stroke"])
    return {
        "period": point[0],
        "damping": point[1],
        "bearings": bearings,
        "stroke": worst["stroke"],
        "lifts": sum(row["outcome"] in LIFTED for row in rows),
        "slides": sum(bool(row["slip"]) for row in rows),
        "friction": scene.friction and demand / scene.friction,
        "uplift": demand / math.tan(scene.block.slenderness),
        "tilt": max(row["tilt"] for row in rows),
        "worst": worst["motion"],
        "motions": rows,
        "headline": headline(rows, left),
    }


def _demand(scene):
    """The friction demand of a block that does not slide, as the search has it."""
    from analytic import simulate_many

    return {"demand": float(simulate_many([scene], contact=True).friction_demand[0])}


def _written(place, bearings, base):
    """The text of the scene file with these bearings, and a base if it has none; an error if the file has its bearings
    in another form."""
    from analytic.new_scene import with_bearings

    text = with_bearings(Path(place).read_text(encoding="utf-8-sig"), bearings, base)
    try:
        found = scene_of(text, place)
        same = found.bearings == bearings and base in (None, found.base)
    except SceneError:
        same = False
    if not same:
        raise SettingError(f"--write: {place} holds its bearings in another form; write them as a table [bearings]")
    return text


def _form(scene, stroke, tilt, motions, left, scan, chosen, warnings):
    """Content of the JSON file."""
    from ..schemas.advice import BearingProposal, BearingSearch, Constants
    from ..schemas.runs import Warned

    return BearingSearch(
        scene=scene.name,
        base_mass=scene.base.mass,
        stroke=stroke,
        tilt=tilt,
        motions=motions,
        left_out=left,
        warnings=[Warned(**dataclasses.asdict(one)) for one in warnings],
        periods=scan.periods.tolist(),
        dampings=scan.dampings.tolist(),
        holds=(scan.demand <= 1).tolist(),
        chosen={
            name: BearingProposal(**{**one, "bearings": Constants(**one["bearings"].model_dump())})
            for name, one in chosen.items()
        },
    )
