"""The runs of the restitution study: blocks released from rest, in every engine, variant and refinement level.

Two parts: the grid (slenderness x base x level), and experiments that change one suspected cause of error at a time.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from analytic import simulate
from analytic.caryatid import BASE, MASS, RADIUS
from analytic.scene import Base, Block, Scene, Start
from engines import get_engine
from engines.contract import Variant

from ...running.cases import Case

CARYATID_BASE = BASE.mass / MASS  # its m_b/m
IMPACTS = 3  # used of each run; on rigid ground the slowest is about as fast as the first from a third of the tilt


@dataclass(frozen=True)
class Grid:
    """What the study covers: slendernesses [rad], m_b/m (None: rigid ground), starts (tilt over slenderness).

    ladder: (slenderness, m_b/m) where the accuracy parameters run through their levels.
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

EXPERIMENT_SLENDERNESS = 0.2
EXPERIMENT_RATIOS = (None, CARYATID_BASE)
PHASE_STEPS = (4e-3, 1e-3, 2.5e-4)  # s
SCALES = (0.25, 1.0, 4.0)  # of the block, to tell (8) from (8) as printed


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


def variants_of(engines: Sequence[str]) -> list[tuple[str, str, Variant]]:
    """(engine, name, record) of every variant."""
    return [(engine, name, kind) for engine in engines for name, kind in get_engine(engine).variants.items()]


def grid_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """The grid as cases, tagged with part, ratio, slenderness, start and level."""
    for ratio in grid.ratios:
        for slenderness in grid.slendernesses:
            scenes = {start: free_scene(slenderness, ratio, start) for start in grid.starts}
            for engine, variant, kind in variants_of(engines):
                for level in sorted(kind.ladder) if (slenderness, ratio) in grid.ladder else (kind.default,):
                    settings = {} if level == kind.default else {kind.knob: level}
                    for start, scene in scenes.items():
                        tag = {"ratio": ratio, "slenderness": slenderness, "start": start, "level": level}
                        yield Case(scene, engine, variant, settings, {"part": "grid", **tag})


def experiments_of(engines: Sequence[str]) -> list[tuple[str, str, str, str, tuple[float, ...]]]:
    """(name, engine, variant, setting, values) of what the engines say is worth changing alone."""
    return [
        (setting.replace("_", " "), engine, variant, setting, values)
        for engine, variant, kind in variants_of(engines)
        for setting, values in kind.varied.items()
    ]


def experiment_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """One suspected cause at a time; tagged with part, experiment, ratio, slenderness, start and value."""

    def case(name, ratio, start, value, engine, variant, settings, scale=1.0):
        tag = {"ratio": ratio, "slenderness": EXPERIMENT_SLENDERNESS, "start": start, "value": value}
        scene = free_scene(EXPERIMENT_SLENDERNESS, ratio, start, scale)
        return Case(scene, engine, variant, settings, {"part": "experiment", "experiment": name, **tag})

    for name, engine, variant, setting, values in experiments_of(engines):
        for ratio in EXPERIMENT_RATIOS:
            for start in grid.starts[::2]:
                for value in values:
                    yield case(name, ratio, start, value, engine, variant, {setting: value})
    # where the impact is decided with care at one step: starts so close that impacts lie within the longest step
    for engine, variant, kind in variants_of(engines):
        if kind.tier == "tuned" and kind.knob == "step":
            for start in map(float, np.linspace(0.600, 0.604, grid.phase_starts)):
                for step in PHASE_STEPS:
                    yield case("phase", None, start, step, engine, variant, {"step": step})
    for engine in engines:
        for scale in SCALES:
            yield case("size", CARYATID_BASE, 0.6, scale, engine, get_engine(engine).default_variant, {}, scale)
