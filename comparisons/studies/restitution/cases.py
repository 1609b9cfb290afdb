"""The runs of the restitution study: blocks released from rest, in every engine, variant and accuracy setting.

Two parts: the grid (slenderness x base x accuracy knob), and experiments that change one suspected cause of error
at a time.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic import simulate
from analytic.caryatid import BASE, MASS, RADIUS
from analytic.scene import Base, Block, Scene, Start
from engines import get_engine

from ...running.cases import Case

CARYATID_BASE = BASE.mass / MASS  # its m_b/m
IMPACTS = 3  # used of each run; on rigid ground the slowest is about as fast as the first from a third of the tilt


@dataclass(frozen=True)
class Grid:
    """What the study covers: slendernesses [rad], m_b/m (None: rigid ground), starts (tilt over slenderness).

    ladder: (slenderness, m_b/m) where the accuracy knobs run through their ladders.
    """

    slendernesses: tuple
    ratios: tuple
    starts: tuple
    ladder: tuple
    phase_starts: int  # of the experiment on the phase of the steps


STARTS = tuple(round(float(start), 4) for start in np.linspace(0.3, 0.8, 4))
FULL = Grid(
    (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45),
    (None, 10.0, 1.0, 0.3, CARYATID_BASE, 0.01),
    STARTS,
    tuple((gamma, ratio) for gamma in (0.1, 0.2, 0.3, 0.45) for ratio in (None, 1.0, CARYATID_BASE)),
    48,
)
QUICK = Grid((0.1, 0.2, 0.3, 0.45), (None, 10.0, 1.0, CARYATID_BASE), STARTS, ((0.2, None), (0.2, CARYATID_BASE)), 16)


def free_scene(slenderness: float, ratio: float | None, start: float, scale: float = 1.0) -> Scene:
    """A block on rigid ground (ratio None) or on a freely sliding base of ratio times its mass, tilted and let go.

    It ends past the peak of the swing after the third impact of the model, or a little after coming to rest.
    scale: size of the block over the Caryatid's.
    """
    scene = Scene(
        block=Block(mass=MASS, radius=RADIUS * scale, slenderness=slenderness),
        base=Base(mass=ratio * MASS) if ratio else None,
        start=Start(tilt=start * slenderness),
        duration=12.0 * math.sqrt(scale),
    )
    times = [impact.time for impact in simulate(scene, history=False).impacts[: IMPACTS + 1]]
    if len(times) > IMPACTS:
        return scene.with_(duration=times[-2] + 0.75 * (times[-1] - times[-2]))
    return scene.with_(duration=times[-1] + 0.2 * math.sqrt(scale))


def knob_of(engine: str, variant: str) -> tuple[str, float, tuple[float, ...]]:
    """(name, default, values) of a variant's accuracy knob."""
    kind = get_engine(engine).variants[variant]
    return kind.knob, kind.default, tuple(sorted(kind.ladder))


def variants_of(engines: Sequence[str]) -> list[tuple[str, str]]:
    """(engine, variant) pairs."""
    return [(engine, variant) for engine in engines for variant in get_engine(engine).variants]


def grid_cases(grid: Grid, engines: Sequence[str]) -> list[Case]:
    """The grid as cases, tagged with part, ratio, slenderness, start and knob value."""
    cases = []
    for ratio in grid.ratios:
        for slenderness in grid.slendernesses:
            scenes = [(start, free_scene(slenderness, ratio, start)) for start in grid.starts]
            climbs = (slenderness, ratio) in grid.ladder
            for engine, variant in variants_of(engines):
                name, default, values = knob_of(engine, variant)
                for value in values if climbs else (default,):
                    settings = {} if value == default else {name: value}
                    cases += [
                        Case(
                            scene,
                            engine,
                            variant,
                            settings,
                            {"part": "grid", "ratio": ratio, "slenderness": slenderness, "start": start, "knob": value},
                        )
                        for start, scene in scenes
                    ]
    return cases


EXPERIMENT_SLENDERNESS = 0.2
EXPERIMENT_RATIOS = (None, CARYATID_BASE)
PHASE_STEPS = (4e-3, 1e-3, 2.5e-4)  # s
SCALES = (0.25, 1.0, 4.0)  # of the block, to tell (8) from (8) as printed


def experiments_of(engines: Sequence[str]) -> list[tuple[str, str, str, str, tuple[float, ...]]]:
    """(name, engine, variant, setting, values) of what the engines say is worth changing alone."""
    return [
        (setting.replace("_", " "), engine, variant, setting, values)
        for engine, variant in variants_of(engines)
        for setting, values in get_engine(engine).variants[variant].varied.items()
    ]


def fixed_steps_of(engines: Sequence[str]) -> list[tuple[str, str]]:
    """(engine, variant) of those that decide the impact, with care, at one step."""
    fixed = []
    for engine, variant in variants_of(engines):
        kind = get_engine(engine).variants[variant]
        if kind.tier == "tuned" and kind.knob == "step":
            fixed.append((engine, variant))
    return fixed


def experiment_cases(grid: Grid, engines: Sequence[str]) -> list[Case]:
    """One suspected cause at a time; tagged with part, experiment, ratio, slenderness, start and value."""
    return [*_setting_cases(grid, engines), *_phase_cases(grid, engines), *_size_cases(engines)]


def _experiment(name, ratio, start, value, engine, variant, settings, scale=1.0):
    """The `Case` of an experiment: a block on a base of ratio, released at start, one value of what it changes."""
    gamma = EXPERIMENT_SLENDERNESS
    tag = {"experiment": name, "ratio": ratio, "slenderness": gamma, "start": start, "value": value}
    scene = free_scene(gamma, ratio, start, scale)
    return Case(scene, engine, variant, settings, {"part": "experiment", **tag})


def _setting_cases(grid, engines):
    """One setting at a time."""
    for name, engine, variant, setting, values in experiments_of(engines):
        for ratio in EXPERIMENT_RATIOS:
            for start in grid.starts[::2]:
                for value in values:
                    yield _experiment(name, ratio, start, value, engine, variant, {setting: value})


def _phase_cases(grid, engines):
    """Starts so close together that the first impacts lie within one of the longest steps."""
    for engine, variant in fixed_steps_of(engines):
        for start in map(float, np.linspace(0.600, 0.604, grid.phase_starts)):
            for step in PHASE_STEPS:
                yield _experiment("phase", None, start, step, engine, variant, {"step": step})


def _size_cases(engines):
    """Blocks of other sizes at default settings."""
    for engine in engines:
        for scale in SCALES:
            variant = get_engine(engine).default_variant
            yield _experiment("size", CARYATID_BASE, 0.6, scale, engine, variant, {}, scale)
