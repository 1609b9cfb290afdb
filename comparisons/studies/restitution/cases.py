"""The runs of the restitution study: blocks released from rest, in every engine, variant and level.

Four parts: the grid (slenderness x base x level), blocks on bearings, released or under a pulse (slenderness x base x
isolation period, laws in turn), experiments that change one suspected cause of error at a time, and the first impact of
a block, to be taken apart.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start, simulate
from analytic.caryatid import BASE, BEARINGS, MASS, RADIUS
from engines import get_engine
from engines.contract import Variant

from ...measuring.errors import strong_impacts
from ...running.cases import Case

CARYATID_BASE = BASE.mass / MASS  # its m_b/m
IMPACTS = 3  # used of each run; on rigid ground the slowest is about as fast as the first from a third of the tilt


@dataclass(frozen=True)
class Grid:
    """What the study covers: slendernesses [rad], m_b/m (None: rigid ground), starts (tilt over slenderness).

    refined: (slenderness, m_b/m) where the accuracy parameters run through their levels. bearings: slendernesses [rad],
    m_b/m and isolation periods [s] of blocks on bearings.
    """

    slendernesses: tuple
    ratios: tuple
    starts: tuple
    refined: tuple
    phase_starts: int  # of the experiment on the phase of the steps
    bearings: tuple


STARTS = tuple(round(float(start), 4) for start in np.linspace(0.3, 0.8, 4))
FULL = Grid(
    (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45),
    (None, 10.0, 1.0, 0.3, CARYATID_BASE, 0.01),
    STARTS,
    tuple((gamma, ratio) for gamma in (0.1, 0.2, 0.3, 0.45) for ratio in (None, 1.0, CARYATID_BASE)),
    48,
    ((0.15, 0.25, 0.35), (0.1, 1.0, 10.0), (1.0, 2.0, 4.0)),
)
QUICK = Grid(
    (0.1, 0.2, 0.3, 0.45),
    (None, 10.0, 1.0, CARYATID_BASE),
    STARTS,
    ((0.2, None), (0.2, CARYATID_BASE)),
    16,
    ((0.25,), (0.1, 1.0, 10.0), (2.0,)),
)
LAWS = ("algebraic", "bouc-wen", "linear")
EXCITATIONS = ("let go", "pulse")
LET_GO = 0.5  # tilt over slenderness
PULSE = (0.5, 3.0)

EXPERIMENT_SLENDERNESS = 0.2
EXPERIMENT_RATIOS = (None, CARYATID_BASE)
PHASE_STEPS = (4e-3, 1e-3, 2.5e-4)  # s
SCALES = (0.25, 1.0, 4.0)  # of the block, to tell (8) from (8) as printed

# Of the block whose first impact is taken apart: tilt over slenderness; duration [s], past the swing after that impact.
IMPACT_START, IMPACT_SECONDS = 0.6, 1.6
GROUNDS = {"rigid ground": None, "sliding base": Base(mass=BASE.mass)}


def free_scene(slenderness: float, ratio: float | None, start: float, scale: float = 1.0) -> Scene:
    """A block on rigid ground (ratio None) or on a freely sliding base of ratio times its mass, tilted and released.

    It ends past the peak of the swing after the third impact of the model, or a little after coming to rest.
    scale: size of the block over the Caryatid's.
    """
    scene = Scene(
        block=Block(mass=MASS, radius=RADIUS * scale, slenderness=slenderness),
        base=Base(mass=ratio * MASS) if ratio else None,
        start=Start(tilt=start * slenderness),
        duration=12.0 * math.sqrt(scale),
    )
    return _cut(scene, [impact.time for impact in simulate(scene, history=False).impacts], 0.2 * math.sqrt(scale))


def _cut(scene, times, rest):
    """The scene up to past the peak of the swing after the impact number `IMPACTS`, or `rest` [s] after the last."""
    if len(times) > IMPACTS:
        before, after = times[IMPACTS - 1 : IMPACTS + 1]
        return scene.with_(duration=before + 0.75 * (after - before))
    return scene.with_(duration=times[-1] + rest)


def bearing_scene(slenderness: float, ratio: float, period: float, law: str, excitation: str) -> Scene:
    """The Caryatid's block of a slenderness on bearings of a period [s], at the stiffness after yielding.

    It is released at `LET_GO`, the ground at rest or under a pulse, (amplitude over g tan(slenderness), frequency over
    omega_r) in `PULSE`. It ends as `free_scene` does.
    """
    base = Base(mass=ratio * MASS)
    kb = (MASS + base.mass) * (2 * math.pi / period) ** 2 / BEARINGS.count
    softening = {} if law == "linear" else {"kb": kb, "alpha": BEARINGS.alpha}
    ka = kb if law == "linear" else kb * BEARINGS.ka / BEARINGS.kb
    scene = Scene(
        block=Block(mass=MASS, radius=RADIUS, slenderness=slenderness),
        base=base,
        bearings=Bearings(law=law, count=BEARINGS.count, ka=ka, **softening),
        start=Start(tilt=LET_GO * slenderness),
        duration=12.0,
    )
    if excitation == "pulse":
        amplitude, frequency = PULSE[0] * scene.gravity * math.tan(slenderness), PULSE[1] * scene.rocking_frequency
        scene = scene.with_(motion=PulseMotion("one-sine", amplitude, frequency, 0.0))
    return _cut(scene, [impact.time for impact in strong_impacts(simulate(scene, history=False))], 0.2)


def bearing_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """Blocks on bearings, at default levels; the laws take turns, so that each is combined with all other values."""
    for places in product(*map(enumerate, grid.bearings)):
        ranks, (slenderness, ratio, period) = zip(*places, strict=True)
        law = LAWS[sum(ranks) % len(LAWS)]
        for excitation in EXCITATIONS:
            scene = bearing_scene(slenderness, ratio, period, law, excitation)
            place = {"slenderness": slenderness, "ratio": ratio, "period": period, "law": law}
            for engine, variant, _ in variants_of(engines):
                yield Case(scene, engine, variant, {}, {"part": "bearings", **place, "excitation": excitation})


def impact_scene(ground: str) -> Scene:
    """The block whose first impact is taken apart, released on a ground of `GROUNDS`."""
    scene = free_scene(EXPERIMENT_SLENDERNESS, None, IMPACT_START)
    return scene.with_(name="one impact", base=GROUNDS[ground], duration=IMPACT_SECONDS)


def impact_cases(engines: Sequence[str], grounds: Iterable[str]) -> Iterator[Case]:
    """That block in every variant, tagged with the ground."""
    for (engine, variant, _), ground in product(variants_of(engines), grounds):
        yield Case(impact_scene(ground), engine, variant, tag={"ground": ground})


def variants_of(engines: Sequence[str]) -> list[tuple[str, str, Variant]]:
    """(engine, name, record) of every variant."""
    return [(engine, name, kind) for engine in engines for name, kind in get_engine(engine).variants.items()]


def grid_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """The grid as cases, tagged with part, ratio, slenderness, start and level."""
    for ratio in grid.ratios:
        for slenderness in grid.slendernesses:
            scenes = {start: free_scene(slenderness, ratio, start) for start in grid.starts}
            for engine, variant, kind in variants_of(engines):
                for level in sorted(kind.levels) if (slenderness, ratio) in grid.refined else (kind.default,):
                    settings = {} if level == kind.default else {kind.accuracy_parameter: level}
                    for start, scene in scenes.items():
                        tag = {"ratio": ratio, "slenderness": slenderness, "start": start, "level": level}
                        yield Case(scene, engine, variant, settings, {"part": "grid", **tag})


def experiments_of(engines: Sequence[str]) -> list[tuple[str, str, str, str, tuple[float, ...]]]:
    """(name, engine, variant, setting, values) of the settings that variants name as worth changing one at a time."""
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
    for engine, variant, spec in variants_of(engines):
        if spec.kind == "tuned" and spec.accuracy_parameter == "step":
            for start in map(float, np.linspace(0.600, 0.604, grid.phase_starts)):
                for step in PHASE_STEPS:
                    yield case("phase", None, start, step, engine, variant, {"step": step})
    for engine in engines:
        for scale in SCALES:
            yield case("size", CARYATID_BASE, 0.6, scale, engine, get_engine(engine).default_variant, {}, scale)
