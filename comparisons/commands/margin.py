"""``rocking margin``: the margins of a scene against other limit states and another outcome."""

import dataclasses
from typing import Annotated, Any

import typer

from ..cli.output import write_output
from ..running.options import BothSigns, Directions, Records, Units, end_with, other_motions, rows_of
from ..running.progress import compile_kernels, spinner
from ..running.solving import in_file

LEAST_SPAN = 0.1  # per cent
STEPS = 400  # of a scan, from no change to the largest


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    span: Annotated[
        float, typer.Option(metavar="PERCENT", help="Largest change of a quantity; up to 900, ten times its value.")
    ] = 20.0,
    tilt: Annotated[
        float, typer.Option(metavar="SHARE", help="Limit of the peak tilt, as a share of the slenderness.")
    ] = 0.5,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the outcomes over the changes (.png, .svg or .pdf).")
    ] = None,
    records: Records = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    units: Units = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the margins; - prints them.")
    ] = None,
) -> None:
    """Find the changes of slenderness, restitution, motion, bearings ... at which the block lifts or overturns.

    Two further limit states are a peak tilt above --tilt, and a base displacement beyond the x_max of the bearings.
    One quantity is changed at a time, in steps of a four-hundredth of the span, in the analytic model. Changes that
    give no valid scene (a restitution above 1, ka below kb) or leave the model's validity end the range. The vertical
    stiffness of bearings is taken as infinite. Status 1: the model failed on the scene, or under one of its motions.

    Example: rocking margin caryatid-isolated --plot margins.svg
    """
    from analytic.errors import SettingError
    from analytic.limits import scene_warnings
    from analytic.margins import LARGEST_SPAN, Contact, margins
    from analytic.scene_file import load_scene

    from ..running.files import check_writable
    from ..showing.margins import draw_margins, named, print_margins, print_motions

    if not LEAST_SPAN <= span <= 100 * LARGEST_SPAN:
        raise SettingError(f"--span {span:g}: give per cent, from {LEAST_SPAN:g} to {100 * LARGEST_SPAN:g}")
    if not 0 < tilt <= 1:
        raise SettingError(f"--tilt {tilt:g}: give a share of the slenderness, above 0 and up to 1")
    check_writable([json_file], picture=plot, inputs=[scene])
    what = load_scene(scene)
    groups, left = other_motions(what, records, both_signs, directions, units)
    compile_kernels()
    scan: dict[str, Any] = {"tilt": tilt, "span": span / 100, "step": span / 100 / STEPS}
    with spinner(f"{what.name}: margins") as tell, in_file(scene):
        nearest = margins(what, **scan, progress=lambda name: tell(f"{what.name}: {name}"))
        response = _decided(what)
    contact, warnings = Contact.of(what, response), (*scene_warnings(what), *response.warnings)
    rows = rows_of(what, groups, _decided, lambda scene: _changes(scene, scan))

    def show():
        print_margins(what, nearest, contact, span, tilt, warnings)
        print_motions(what, [{**row, "changes": named(row, tilt)} for row in rows], left)

    form = _form(what, nearest, contact, warnings, rows, left, span, tilt)
    write_output({json_file: form}, show, plot, lambda: draw_margins(what, nearest, tilt))
    end_with(rows, response)


def _decided(scene):
    """The model's run until the outcome is decided."""
    from analytic import simulate

    return simulate(scene.with_(duration=None), history=False)


def _form(scene, nearest, contact, warnings, rows, left, span, tilt):
    """Content of the JSON file."""
    from analytic.margins import limit_states

    from ..schemas.advice import Contact, Margin, Margins, MotionMargin
    from ..schemas.runs import Warned
    from ..showing.margins import headline

    return Margins(
        scene=scene.name,
        outcome=nearest[0].outcome,
        tilt=tilt,
        span=span / 100,
        reached=_reached(nearest[0]),
        margins=[Margin.of(margin, limit_states(scene)) for margin in nearest],
        contact=Contact(**dataclasses.asdict(contact)),
        warnings=[Warned(**dataclasses.asdict(one)) for one in warnings],
        motions=[MotionMargin(**row) for row in rows],
        left_out=left,
        headline=headline(rows, left),
    )


def _reached(margin):
    """The limit states that the unchanged scene reaches."""
    from analytic.margins import LIMIT_STATES

    return [state for state in LIMIT_STATES if margin.reached(state)]


def _changes(scene, scan):
    """The limit states that a scene reaches, and the change of its motion that reaches each."""
    from analytic.margins import limit_states, margins

    (found,) = margins(scene, **scan, only=("motion",))
    changes = {state: found.change(state) for state in limit_states(scene)}
    return {"reached": _reached(found), "changes": changes, "interleaved": found.interleaved}
