"""The commands that advise on a scene: ``rocking choose``, ``margin`` and ``design``."""

import dataclasses
import math
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from analytic import Response, Scene, simulate, simulate_many
from analytic.advice.bearing_scan import scan_bearings
from analytic.advice.bearing_sizes import bearing_sizes, design_pendulum, pendulum_bearings, pendulum_note
from analytic.advice.margins import LARGEST_SPAN, LIMIT_STATES, Contact, limit_states, margins
from analytic.errors import SceneError, SettingError
from analytic.response import scene_warnings
from analytic.rocking import design_bearings, properties
from analytic.scene import Base, Bearings
from analytic.scene_file import load_scene, shipped_scenes, with_bearings

from ..execution.command_runs import (
    DEFINITION,
    OPTIONS,
    PENDULUM,
    RATIO,
    BothSigns,
    Directions,
    EngineNames,
    JsonFile,
    PedestalChecked,
    Records,
    SceneFile,
    Units,
    check_time_limit,
    end_with,
    in_file,
    motions_of,
    named_by_options,
    other_motions,
    pedestal_check,
    read_row,
    rows_of,
    scene_of,
)
from ..execution.progress import bar, compile_kernels, say, spinner, stdout_to_stderr
from ..execution.writing import check_writable
from ..schemas import advice as forms
from ..schemas.columns import percent
from ..schemas.runs import Sizes, Warned
from .output import write_output


def choose(
    scene: SceneFile,
    error: Annotated[
        float, typer.Option(help="Largest permissible error; for outcomes, the share of neighbours that differ.")
    ] = 1e-3,
    criterion: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="What must be accurate: restitution, tilt, displacement, slip or outcome. Default: restitution; for a "
            "block that slides, tilt or slip; for a block without impacts, displacement of the base.",
        ),
    ] = None,
    engine: EngineNames = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw error over CPU time (.png, .svg or .pdf).")
    ] = None,
    every_level: Annotated[bool, typer.Option("--all", help="Show all levels that were run.")] = False,
    json_file: JsonFile = None,
    time_limit: Annotated[
        float, typer.Option(metavar="SECONDS", help="A level whose run takes longer does not pass.")
    ] = 60.0,
) -> None:
    """Find the cheapest engine variant that is accurate enough.

    Each variant is run at its levels on the scene, and on neighbours of it whose start and motion are scaled by up to
    5 %. The runs are compared with the analytic model; tilt and displacement are compared only up to the sensitivity
    horizon. The command also lists what need not be modelled. Status 1: no level passes.

    Example: rocking choose caryatid-isolated --for displacement --error 1e-3
    """
    from ..advice.choose import choose
    from ..advice.criteria import fitting
    from ..plotting.choices import draw_choice, print_choice

    check_time_limit(time_limit)
    check_writable([json_file], picture=plot, inputs=[scene])
    loaded = load_scene(scene)
    compile_kernels()
    with in_file(scene):
        fitted = fitting(loaded) if criterion is None and engine else "restitution"
    if fitted != "restitution":
        say(f"the block of {loaded.name}: {_not_restitution(loaded, fitted)}; the criterion is {fitted}")
    with stdout_to_stderr(), in_file(scene):  # engines print on import
        choice = choose(
            loaded,
            error=error,
            criterion=criterion,
            engines=engine or None,
            time_limit=time_limit,
            progress=True,
            source=scene,
        )
    write_output({json_file: choice}, lambda: print_choice(choice, every_level), plot, lambda: draw_choice(choice))
    if choice.chosen is None:
        raise typer.Exit(1)


def _not_restitution(scene, criterion):
    """Why the default criterion of a scene is not the restitution."""
    if scene.friction is not None and criterion in ("tilt", "slip"):
        return "it slides"
    if scene.block.restitution is not None and criterion == "tilt":
        return "its restitution is given"
    return "it never has an impact: there is no restitution"


LEAST_SPAN = 0.1  # per cent
STEPS = 400  # of a scan, from no change to the largest


def margin(
    scene: SceneFile,
    span: Annotated[
        float,
        typer.Option(
            metavar="PERCENT", help="Largest change of a quantity; at most 900, which is ten times its value."
        ),
    ] = 20.0,
    tilt: Annotated[
        float, typer.Option(metavar="SHARE", help="Limit state of the peak tilt, as a share of the slenderness.")
    ] = 0.5,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the outcomes over the changes (.png, .svg or .pdf).")
    ] = None,
    records: Records = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    units: Units = None,
    json_file: JsonFile = None,
) -> None:
    """Find how far a scene is from uplift and overturning.

    The command changes one quantity at a time (slenderness, restitution, motion, bearings ...) in the analytic model,
    and finds the changes at which the block lifts or overturns. Two further limit states are a peak tilt above --tilt
    and a base displacement beyond the x_max of the bearings.

    The steps are 1/400 of the span. On a free pedestal only motion or start is changed, in steps of at least 1 %. The
    range of a quantity ends where a change gives no valid scene (a restitution above 1, ka below kb), or where the
    model is no longer valid. Bearings are taken as rigid in the vertical direction. Status 1: the model failed on the
    scene or under one of its motions.

    Example: rocking margin caryatid-isolated --plot margins.svg
    """
    from ..plotting.margins import draw_margins, named, print_margins, print_motions

    if not LEAST_SPAN <= span <= 100 * LARGEST_SPAN:
        raise SettingError(f"--span {span:g}: give per cent, from {LEAST_SPAN:g} to {100 * LARGEST_SPAN:g}")
    if not 0 < tilt <= 1:
        raise SettingError(f"--tilt {tilt:g}: give a share of the slenderness, above 0 and up to 1")
    check_writable([json_file], picture=plot, inputs=[scene])
    loaded = load_scene(scene)
    groups, left = other_motions(loaded, records, both_signs, directions, units)
    compile_kernels()
    scan: dict[str, Any] = {"tilt": tilt, "span": span / 100, "step": span / 100 / STEPS}
    with spinner(f"{loaded.name}: margins") as tell, in_file(scene):
        nearest = margins(loaded, **scan, progress=lambda name: tell(f"{loaded.name}: {name}"))
        check = pedestal_check(loaded.with_(duration=None))
        response = decided(loaded, check)
    support, _, stays = check
    contact, warnings = Contact.of(loaded, response), (*scene_warnings(loaded), *response.warnings)
    rows = rows_of(loaded, groups, decided, lambda scene: _changes(scene, scan))

    def show():
        print_margins(loaded, nearest, contact, span, tilt, warnings, stays)
        print_motions(loaded, [{**row, "changes": named(row, tilt)} for row in rows], left)

    form = _margin_form(loaded, nearest, contact, warnings, rows, left, span, tilt, support)
    write_output({json_file: form}, show, plot, lambda: draw_margins(loaded, nearest, tilt))
    end_with(rows, response)


def decided(scene: Scene, check: PedestalChecked | None = None) -> Response:
    """The response of the analytic model, run until the outcome is decided, with the warnings of `pedestal_check`."""
    scene = scene.with_(duration=None)
    response, (_, cautions, _) = simulate(scene, history=False), check or pedestal_check(scene)
    return dataclasses.replace(response, warnings=(*response.warnings, *cautions))


def _margin_form(scene, nearest, contact, warnings, rows, left, span, tilt, support):
    """The content of the JSON file of `margin`."""
    from ..plotting.margins import headline

    return forms.Margins(
        scene=scene.name,
        outcome=nearest[0].outcome,
        tilt=tilt,
        span=span / 100,
        reached=_reached(nearest[0]),
        margins=[forms.Margin.of(margin, limit_states(scene)) for margin in nearest],
        contact=forms.Contact(**dataclasses.asdict(contact)),
        warnings=[Warned(**dataclasses.asdict(warning)) for warning in warnings],
        motions=[forms.MotionMargin(**row) for row in rows],
        left_out=left,
        headline=headline(rows, left),
        pedestal=support,
    )


def _reached(margin):
    """The limit states that the unchanged scene reaches."""
    return [state for state in LIMIT_STATES if margin.reached(state)]


def _changes(scene, scan):
    """The limit states that a scene reaches, and the change of its motion at which each is reached."""
    (margin,) = margins(scene, **scan, only=("motion",))
    changes = {state: margin.change(state) for state in limit_states(scene)}
    return {"reached": _reached(margin), "changes": changes, "interleaved": margin.interleaved}


LEAST, SOFTEST = "least-stroke", "softest"
WRITTEN = ("ka", "kb", "alpha", "yield_force")  # numbers written with six digits
OF_SCENE = {  # names in errors of the search, and their options
    **{"stroke": "--stroke", "x_max": "--stroke", "tilt": "--tilt"},
    **{name: OPTIONS[name] for name in ("count", "stiffness_ratio", "definition")},
}


def design(
    scene: Annotated[
        str | None, typer.Argument(help="Scene file (TOML) to find bearings for. Without it, give the four targets.")
    ] = None,
    stroke: Annotated[
        float | None, typer.Option(help="Scene: largest permissible displacement of the base [m].")
    ] = None,
    base_mass: Annotated[float | None, typer.Option(help="Scene without a base: mass of the base to add [kg].")] = None,
    tilt: Annotated[
        float,
        typer.Option(
            help="Scene: largest permissible peak tilt, as a share of the slenderness; 0: the block must not lift."
        ),
    ] = 0.0,
    write: Annotated[
        Literal["least-stroke", "softest"] | None, typer.Option(help="Scene: write these bearings into the scene file.")
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
    mass: Annotated[float | None, typer.Option(help="Target: total mass of block and base [kg].")] = None,
    count: Annotated[int, typer.Option(help="Number of bearings.")] = 4,
    ratio: Annotated[float, typer.Option(help=RATIO)] = 10.0,
    definition: Annotated[str, typer.Option(help=DEFINITION)] = "equivalent",
    pendulum: Annotated[bool, typer.Option("--pendulum", help="Scene: find pendulum bearings.")] = False,
    pendulum_radius: Annotated[
        float | None, typer.Option(help="Target: radius of curvature of pendulum bearings [m].")
    ] = None,
    pendulum_friction: Annotated[float | None, typer.Option(help="Target: friction of pendulum bearings.")] = None,
    json_file: JsonFile = None,
) -> None:
    """Find suitable bearings, or compute bearing constants.

    With a scene: find bearings on which the block does not lift and the base stays within the stroke. If the scene
    gives a friction coefficient, the block must not slide on its base either. For a block on the ground, also give the
    mass of a base; --write adds it to the file. Status 1: on the bearings found, the model failed under a motion.

    Without a scene: compute the constants of lead-rubber bearings from a target period, damping, displacement and mass,
    or those of pendulum bearings from radius, friction, displacement and mass.

    Example: rocking design bust.toml --stroke 0.25 --plot bearings.svg --write least-stroke

    Example: rocking design --period 2 --damping 0.30 --definition paper --xmax 0.30 --mass 3384.05
    """
    targets = {"period": period, "damping": damping, "xmax": xmax, "mass": mass}
    pendula = {"radius": pendulum_radius, "friction": pendulum_friction}
    given = [f"--{name}" for name, value in targets.items() if value is not None]
    given += [PENDULUM[name] for name, value in pendula.items() if value is not None]
    bearings: dict[str, Any] = {"count": count, "stiffness_ratio": ratio, "definition": definition}
    if pendulum or set(pendula.values()) != {None}:
        _check_pendulum(ratio, definition, period, damping)
        bearings = {"count": count}
    if scene is None:
        of_scene = {"--stroke": stroke, "--write": write, "--plot": plot, "--records": records, "--tilt": tilt or None}
        of_scene |= {"--base-mass": base_mass, "--pendulum": pendulum or None}
        return _by_targets(targets, pendula, bearings, of_scene, json_file)
    if given:
        raise SettingError(f"{given[0]}: a target, which does not go with a scene; give --stroke only")
    if stroke is None:
        raise SettingError("--stroke is missing: give the largest displacement of the base [m]")
    if pendulum:
        bearings["designer"] = design_pendulum
    many = {"records": records, "both_signs": both_signs, "directions": directions, "units": units}
    _for_scene(scene, base_mass, stroke, tilt, bearings, many, write, plot, json_file)


def _check_pendulum(ratio, definition, period, damping):
    """Refuse options of lead-rubber bearings beside those of pendula."""
    of_design = {"--ratio": ratio != 10.0, "--definition": definition != "equivalent", "--period": period is not None}
    if wrong := [option for option, given in {**of_design, "--damping": damping is not None}.items() if given]:
        raise SettingError(f"{wrong[0]}: belongs to lead-rubber bearings; leave it out, or the options of pendula")


def _by_targets(targets, pendula, options, of_scene, json_file):
    """Compute the constants of bearings that meet the four targets, or of pendula; print and write them.

    pendula: radius and friction. of_scene: {option: value} of the options that belong to a scene. None: not given.
    """
    from rich.text import Text

    from ..plotting.terminal import echo

    wrong = [name for name, value in of_scene.items() if value is not None]
    if wrong:
        raise SettingError(f"{wrong[0]}: belongs to a scene; rocking design SCENE --stroke METRES")
    mass, xmax, swings = targets["mass"], targets["xmax"], set(pendula.values()) != {None}
    needed = {
        "pendulum-radius": pendula["radius"],
        "pendulum-friction": pendula["friction"],
        "mass": mass,
        "xmax": xmax,
    }
    missing = [f"--{name}" for name, value in (needed if swings else targets).items() if value is None]
    if missing:
        raise SettingError(f"{missing[0]} is missing; give all targets, or a scene and --stroke")
    check_writable([json_file])
    with named_by_options(OPTIONS | PENDULUM):
        if swings:
            bearings = pendulum_bearings(mass, **pendula, **options, x_max=xmax)
        else:
            bearings = design_bearings(mass, targets["period"], targets["damping"], xmax, **options)
    back, sizes = properties(bearings, mass, xmax), Sizes.of(bearings, mass)
    constants, given = forms.Constants(**bearings.model_dump()), forms.Properties(**dataclasses.asdict(back))
    last = f"yield force[/bold] = {bearings.yield_force:.5g} N" if swings else f"alpha[/bold] = {bearings.alpha:.4f}"
    lines: tuple[Any, ...] = (
        Text.from_markup(
            f"[bold]ka[/bold] = {bearings.ka:.5g} N/m   [bold]kb[/bold] = {bearings.kb:.5g} N/m   "
            f"[bold]{last}   for each of {bearings.count} bearings"
        ),
        f"back: secant period {back.period:.5g} s at {xmax:g} m ({back.period_kb:.4g} s with kb alone); "
        f"damping {percent(back.damping_paper, 4)} as W_D/(2 pi E_s), "
        f"{percent(back.damping_equivalent, 4)} as W_D/(4 pi E_s); "
        f"loss {back.cycle_loss:.5g} J a cycle and bearing",
        *(() if sizes is None else (*sizes.sentences, sizes.assumed)),
    )
    write_output({json_file: forms.Design(bearings=constants, properties=given, sizes=sizes)}, lambda: echo(*lines))


def _for_scene(place, base_mass, stroke, tilt, options, many, write, plot, json_file):
    """Find suitable bearings of a scene by a scan; print, draw and write them."""
    from ..plotting.margins import draw_bearings, nothing_holds, print_bearings

    check_writable([json_file], picture=plot, inputs=[place])
    scene = _on_base(load_scene(place), base_mass, place)
    if write and place in shipped_scenes() and not Path(place).exists():
        raise SettingError(f"--write: {place} comes with the package; give a scene file of your own")
    groups, left = motions_of(scene, **many)
    motions = [motion for group in groups.values() for motion in group]
    compile_kernels(any(motion.vertical for motion in motions))
    options |= {"gravity": scene.gravity} if "designer" in options else {}
    with bar(f"{scene.name}: bearings") as progress, named_by_options(OF_SCENE), in_file(place):
        scan = scan_bearings(scene, motions, stroke, tilt=tilt, **options, progress=progress)
        scan = scan.among(lambda bearings: not bearing_sizes(bearings, scene.total_mass, scene.gravity).reasons)  # type: ignore[union-attr]  # with x_max they have sizes
    points = {LEAST: scan.least_stroke, SOFTEST: scan.softest}  # (period, damping), None without any
    chosen = {name: _chosen(scene, scan, point, groups, left) for name, point in points.items() if point is not None}
    nothing = "" if chosen else nothing_holds(scene, scan, stroke, tilt, motions)
    if write and nothing:
        raise SettingError(f"--write: {nothing}")
    read = [read_row(record, motion) for record, group in groups.items() for motion in group]
    warnings = scene_warnings(scene.with_(bearings=scan.designs[0]))  # it is to have some
    results = {json_file: _design_form(scene, stroke, tilt, read, left, scan, chosen, warnings)}
    if write:
        note = pendulum_note(chosen[write]["bearings"], scene.total_mass, scene.gravity)
        results[place] = _written(place, chosen[write]["bearings"], None if base_mass is None else scene.base, note)
    write_output(
        results,
        lambda: print_bearings(scene, scan, stroke, tilt, read, chosen, warnings, nothing),
        plot,
        lambda: draw_bearings(scene, scan, stroke, tilt),
    )
    if write and json_file != "-":
        print(f"written into {place}: {write}")
    end_with([row for proposal in chosen.values() for row in proposal["motions"]])


def _on_base(scene, mass, place):
    """The scene, with a base of this mass [kg] under its block if it has none."""
    if mass is None and scene.base is None:
        raise SettingError(
            f"--base-mass is missing: in {place} the block stands on the ground; give its base's mass [kg]"
        )
    if mass is not None and scene.base is not None:
        raise SettingError(f"--base-mass {mass:g}: {place} has a base, of {scene.base.mass:g} kg; leave it out")
    with named_by_options(OPTIONS):
        return scene if mass is None else scene.with_(base=Base(mass=float(f"{mass:.6g}")))  # rounded as in the file


def _chosen(scene, scan, point, groups, left=()):
    """The bearings at a point of the scan, rounded as in a file, and the behaviour on them under each motion."""
    from ..plotting.margins import LIFTED, headline

    exact = scan.bearings(*point)
    rounded = {name: float(f"{exact.given(name):.6g}") for name in WRITTEN if getattr(exact, name) is not None}
    bearings = Bearings(**exact.model_dump() | rounded)
    borne = scene.with_(bearings=bearings, duration=None)
    rows = rows_of(borne, groups, lambda moved: simulate(moved, history=False), _demand)
    demand, worst = max(row.pop("demand", math.inf) for row in rows), max(rows, key=lambda row: row["stroke"])
    return {
        "period": point[0],
        "damping": point[1],
        "bearings": bearings,
        "sizes": Sizes.of(bearings, scene.total_mass, scene.gravity),
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
    """The friction demand of a block that does not slide, computed as in the search."""
    return {"demand": float(simulate_many([scene], contact=True).friction_demand[0])}


def _written(place, bearings, base, note):
    """The text of the scene file with these bearings and the note on them, and with this base if it has none.

    Raises
    ------
    SettingError
        The file holds its bearings in another form than a table.
    """
    text = with_bearings(Path(place).read_text(encoding="utf-8-sig"), bearings, base, note)
    try:
        read_back = scene_of(text, place)
        same = read_back.bearings == bearings and base in (None, read_back.base)
    except SceneError:
        same = False
    if not same:
        raise SettingError(f"--write: {place} holds its bearings in another form; write them as a table [bearings]")
    return text


def _design_form(scene, stroke, tilt, motions, left, scan, chosen, warnings):
    """The content of the JSON file of `design` for a scene."""
    return forms.BearingSearch(
        scene=scene.name,
        base_mass=scene.base.mass,
        stroke=stroke,
        tilt=tilt,
        motions=motions,
        left_out=left,
        warnings=[Warned(**dataclasses.asdict(warning)) for warning in warnings],
        periods=scan.periods.tolist(),
        dampings=scan.dampings.tolist(),
        holds=(scan.demand <= 1).tolist(),
        chosen={
            name: forms.BearingProposal(**proposal | {"bearings": forms.Constants(**proposal["bearings"].model_dump())})
            for name, proposal in chosen.items()
        },
    )
