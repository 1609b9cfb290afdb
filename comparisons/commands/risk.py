"""The command ``rocking risk``: the odds of a scene whose values are uncertain."""

import dataclasses
import math
from typing import Annotated

import numpy as np
import typer

from analytic import SampledMotion, synthetic_motion
from analytic.advice import risk as draws_of
from analytic.advice.margins import QUANTITIES
from analytic.errors import require
from analytic.response import scene_warnings
from analytic.scene_file import load_scene

from ..ensembles import peak_velocity
from ..execution.command_runs import (
    OWN,
    BothSigns,
    Directions,
    JsonFile,
    SceneFile,
    Units,
    end_with,
    in_file,
    motions_of,
    named_by_options,
    parse_settings,
    rows_of,
)
from ..execution.progress import bar, compile_kernels
from ..execution.writing import check_writable
from ..metrics.statistics import wilson_by_group
from ..schemas import advice as forms
from ..schemas.runs import MotionRun, Warned
from .advice import decided
from .output import write_output

MOTIONS, ALONE = 100, 1000  # synthetic motions, more of which narrow the interval most; draws under one motion
MOST_MOTIONS, MOST_SEED = 5000, 2**63 - 1  # the motions take 40 kB each
SCALES = (0.25, 0.5, 0.75, 1.25, 1.5, 1.75, 2.0)  # of the motions, besides 1, in the figure
FEWER = 4  # of the draws, by this factor, at each of these


# Long because of its many options.
def risk(
    scene: SceneFile,
    spread: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=COV",
            help="Coefficient of variation of slenderness, restitution, friction, ka or kb; with 0 the value is not "
            "drawn. May be repeated. The answer shows the defaults.",
        ),
    ] = None,
    draws: Annotated[
        int | None,
        typer.Option(
            metavar="NUMBER",
            help=f"Number of draws of the values for each motion. Default: {draws_of.DRAWS}, or {ALONE} under the "
            "scene's own motion alone.",
        ),
    ] = None,
    motions: Annotated[
        int | None,
        typer.Option(
            metavar="NUMBER",
            help="Number of synthetic motions in place of the scene's; with 0 the scene's own motion alone is used. "
            f"Default: {MOTIONS}; 0 if the scene has a pulse or no motion.",
        ),
    ] = None,
    records: Annotated[
        str | None, typer.Option(metavar="FOLDER", help="Use all records in this folder in place of synthetic motions.")
    ] = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    units: Units = None,
    pga: Annotated[float | None, typer.Option(metavar="G", help="Scale each motion to this peak, in g.")] = None,
    pgv: Annotated[
        float | None, typer.Option(metavar="M/S", help="Scale each motion to this peak velocity, in m/s.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the draws and of the synthetic motions.")] = 0,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the odds over the scale of the motions (.png, .svg, .pdf).")
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Find the odds of overturning if values are uncertain.

    The command draws slenderness, restitution, friction, and ka and kb of the bearings at random about their values in
    the scene, and runs the analytic model under many motions. It gives the probability of each limit state with a 95 %
    interval, and the value on which it depends most. Synthetic motions have a PGA of 0.515 g and a PGV of about
    0.8 m/s, unless --pga or --pgv scales them. Status 1: the model failed on the unchanged scene under a motion.

    Example: rocking risk bust.toml --pga 0.4 --spread slenderness=0.05 --plot odds.svg
    """
    from ..plotting.margins import draw_odds, print_risk, risk_headline

    check_writable([json_file], picture=plot, inputs=[scene])
    loaded, given = load_scene(scene), parse_settings(spread or [], "--spread")
    names, odds = {name: f"--{name}" for name in ("spread", "draws", "seed")}, {}
    with named_by_options(names):
        sizes = draws_of.spreads_of(loaded, given)
    groups, left, under = _many_motions(loaded, motions, records, both_signs, directions, units, seed)
    groups = {record: [_scaled(loaded, each, pga, pgv) for each in members] for record, members in groups.items()}
    alone = [*groups] == [OWN]
    draws = draws if draws is not None else ALONE if alone else draws_of.DRAWS
    compile_kernels(any(each and each.vertical for members in groups.values() for each in members))
    for scale in (1.0, *(SCALES if plot else ())):
        with (
            bar(f"{loaded.name}: draws{f', motions times {scale:g}' if plot else ''}") as progress,
            named_by_options(names),
            in_file(scene),
        ):
            odds[scale] = draws_of.risk(
                loaded,
                [*groups.values()],
                draws=draws if scale == 1 else max(2, draws // FEWER),
                spreads=given,
                seed=seed,
                scale=scale,
                progress=progress,
            )
    with in_file(scene):
        responses = [decided(loaded.with_(motion=groups[OWN][0]))] if alone else []
    rows = [] if alone else rows_of(loaded, groups, decided)
    form = forms.Risk(
        scene=loaded.name,
        draws=draws,
        seed=seed,
        pga=pga,
        pgv=pgv,
        drawn=[_drawn(loaded, name, size, given) for name, size in sizes.items()],
        odds=_odds(odds[1.0]),
        records=_by_record(odds[1.0], groups),
        travel=odds[1.0].travel,
        failed=sum(map(len, groups.values())) * draws - int(odds[1.0].runs.sum()),
        why=odds[1.0].why,
        intensities={scale: _odds(odds[scale]) for scale in sorted(odds)} if plot else {},
        warnings=[
            Warned(**dataclasses.asdict(warning))
            for warning in (*scene_warnings(loaded), *(warning for each in responses for warning in each.warnings))
        ],
        motions=[MotionRun(**row) for row in rows],
        left_out=left,
        headline=risk_headline(_odds(odds[1.0]), under, draws, pga, pgv),
    )
    write_output({json_file: form}, lambda: print_risk(loaded, form, rows), plot, lambda: draw_odds(form))
    end_with(rows, *responses)


def _many_motions(scene, count, records, both_signs, directions, units, seed):
    """Return ({record: its motions}, lines on what was left out, under which motions in a sentence)."""
    require(records is None or count is None, f"--motions {count}: does not go with --records; leave one out")
    require(records is not None or not both_signs, "--both-signs: give the folder of the records with --records")
    if records is not None or directions is not None or units is not None:
        groups, left = motions_of(scene, records, both_signs, directions, units)
        return groups, left, f"under each of {len(groups)} {'motions' if OWN in groups else 'records'}"
    if count is None:
        count = MOTIONS if isinstance(scene.motion, SampledMotion) else 0
    for name, value, most in (("motions", count, MOST_MOTIONS), ("seed", seed, MOST_SEED)):
        require(0 <= value <= most, f"--{name} {value}: give a whole number from 0 to {most}")
    if not count:
        return {OWN: [scene.motion]}, [], f"under {OWN}" if scene.motion else "without a motion"
    family = [synthetic_motion(seed=int(each)) for each in np.random.SeedSequence(seed).generate_state(count)]
    return {motion.label: [motion] for motion in family}, [], f"under each of {count} synthetic motions"


def _scaled(scene, motion, pga, pgv):
    """Return the motion scaled to a peak acceleration [g] or a peak velocity [m/s], if one is given."""
    if pga is None and pgv is None:
        return motion
    name, size = ("--pga", pga) if pgv is None else ("--pgv", pgv)
    require(pga is None or pgv is None, f"--pgv {pgv}: does not go with --pga; leave one out")
    require(0 < size < math.inf, f"{name} {size:g}: give a peak above 0, in {'g' if pgv is None else 'm/s'}")
    require(motion is not None, f"{name} {size:g}: there is no motion to scale; give --motions or --records")
    sampled = isinstance(motion, SampledMotion)
    require(pgv is None or sampled, f"{name} {size:g}: a pulse is scaled by its acceleration; give --pga")
    peak = motion.peak / scene.gravity if pgv is None else peak_velocity(motion)
    require(peak > 0, f"{name} {size:g}: {motion.label} is zero throughout; leave it out")
    return motion.scaled(size / peak)


def _odds(result):
    """Return the `Odds` of each limit state. The interval is over records or, of one record, over draws."""
    rows, alone = [], len(result.runs) == 1
    known = result.runs[0] > 0 if alone else result.runs.sum(axis=1) > 0
    for state, reached in result.reached.items():
        shares = (reached[0, known] / result.runs[0, known]) if alone else result.by_record(state)[known]
        low, high = wilson_by_group(shares, 1 if alone else result.runs.shape[1])
        rows.append(
            forms.Odds(state=state, probability=float(shares.mean()), low=low, high=high, effects=result.effects(state))
        )
    return rows


def _by_record(result, groups):
    """Return {record: {limit state: its probability}}; None where all runs failed."""
    shares = {state: result.by_record(state) for state in result.reached}
    return {
        record: {state: None if math.isnan(each[at]) else float(each[at]) for state, each in shares.items()}
        for at, record in enumerate(groups)
    }


def _drawn(scene, name, size, given):
    """Return the form of a quantity that is drawn."""
    quantity = QUANTITIES[name]
    source = "given" if name in given else draws_of.SPREADS[name].source
    return forms.Drawn(quantity=name, value=quantity.value(scene), unit=quantity.unit, spread=size, source=source)
