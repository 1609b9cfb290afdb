"""The five scenes of the speed-error study with their references, and what runs on each: solvers and their levels."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from scipy.optimize import brentq

from analytic import Scene, Start, simulate
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.motion import PulseMotion
from analytic.synthetic import synthetic_motion
from engines import ENGINES, get_engine

from ...measuring import models
from ...measuring.horizon import sensitivity_horizon
from ...running.cases import Case
from .boundary import Boundary, at_amplitude, margin

if TYPE_CHECKING:
    from analytic import Response
    from engines.contract import Variant

TIGHTEST = 1e-17  # tolerance of the kernel as a reference
LONGEST = 10.0  # s, of a run under the synthetic motion: the strong shaking and what follows
FREQUENCY_RATIO = 3.0  # pulse frequency over omega_r, near-overturning scene
BRACKET = (1.35, 1.45)  # amplitude / g tan(slenderness) around its boundary

TRANSPARENT = ("free-rigid", "near-overturning")  # scenes without base or record
SAMPLED = ("isolated-standing", "isolated-rocking")
PLAIN = "isolated-rocking"  # the scene in which engines are compared at their defaults

NEEDED = "as needed"
HEAVY_BASE, SPRINGS, FREE_3D = "rigid ground as a heavy base", "rigid ground as stiff springs", "free block in 3-D"


@dataclass(frozen=True, eq=False)
class Trial:
    """One scene of the study.

    measures: names of the errors that mean something here, the principal one first. boundary: None but where the runs
    search for one. reference: the kernel at its tightest.
    """

    name: str
    scene: Scene
    measures: tuple[str, ...]
    boundary: Boundary | None = None

    @cached_property
    def reference(self) -> Response:
        return tight(self.scene)

    def with_law(self, law: str) -> Trial:
        """The same trial with another bearing law, and that law's own reference."""
        return replace(self, scene=self.scene.with_(bearings={"law": law}))


def tight(scene: Scene) -> Response:
    """The reference response of a scene."""
    return simulate(scene, history=False, tolerance=TIGHTEST)


def trials() -> list[Trial]:
    """The five trials, in order of what they ask of a solver."""
    free = caryatid_block(0.2)
    isolated: dict[str, Any] = {"base": BASE, "bearings": BEARINGS, "motion": synthetic_motion()}
    rigid = Scene(name="free rocking on rigid ground", block=free, start=Start(tilt=0.12), duration=5.0)
    sliding = rigid.with_(name="free rocking on a sliding base", base=BASE, duration=4.0)
    stands = Scene(name="isolated, standing", block=caryatid_block(0.28), duration=LONGEST, **isolated)
    rocks = Scene(name="isolated, rocking", block=caryatid_block(0.15), duration=LONGEST, **isolated)
    rocks = rocks.with_(duration=math.floor(100 * sensitivity_horizon(rocks).horizon) / 100)
    events = ("restitution", "impact_time")
    return [
        Trial("free-rigid", rigid, (*events, "end_tilt")),
        Trial("free-sliding", sliding, (*events, "peak_displacement")),
        Trial("isolated-standing", stands, ("peak_displacement",)),
        Trial("isolated-rocking", rocks, ("restitution", "peak_tilt", "impact_time", "peak_displacement")),
        near_overturning(),
    ]


def near_overturning() -> Trial:
    """One sine at the amplitude where the block just overturns after one impact; its boundary is the question."""
    block = caryatid_block(0.25)
    unit = 9.81 * math.tan(block.slenderness)
    pulse = PulseMotion("one-sine", unit, FREQUENCY_RATIO * Scene(block=block, duration=1.0).rocking_frequency)
    scene = Scene(name="one sine at the overturning boundary", block=block, motion=pulse, duration=2.5)

    def at(amplitude):
        return margin(scene, tight(at_amplitude(scene, amplitude)).end)

    amplitude = brentq(at, BRACKET[0] * unit, BRACKET[1] * unit, xtol=1e-15, rtol=1e-15)
    change = 1e-4
    slope = (at(amplitude * (1 + change)) - at(amplitude * (1 - change))) / (2 * change)
    measures = ("boundary_shift", "restitution", "peak_tilt", "impact_time")
    return Trial("near-overturning", at_amplitude(scene, amplitude), measures, Boundary(amplitude, slope))


@dataclass(frozen=True, eq=False)
class Entry:
    """One solver at one level of its accuracy parameter on one trial.

    engine, variant: what rows call it. solver: what is run, if not the engine. model: `NEEDED`, or what is modelled
    beyond what the scene needs; scene_of: the scene so modelled, of the trial's.
    """

    trial: Trial
    engine: str
    variant: str
    parameter: str
    level: float
    solver: str = ""
    settings: dict = field(default_factory=dict)
    model: str = NEEDED
    scene_of: Callable[[Scene], Scene] = lambda scene: scene

    def case(self, turn: int) -> Case:
        """The measurement of one round as a `Case`."""
        solver, boundary = self.solver or self.engine, self.trial.boundary
        return Case(
            self.scene_of(self.trial.scene),
            solver,
            self.variant if solver in ENGINES else None,
            {**self.settings, self.parameter: self.level, "history": False},
            {"boundary": boundary and [boundary.amplitude, boundary.slope], "round": turn},
        )


def powers(*exponents: float) -> tuple[float, ...]:
    return tuple(10.0**exponent for exponent in exponents)


# levels of a full and of a quick run
FREE_3D_STEPS = ((1 / 240, 1e-3, 3e-4, 1e-4), (1 / 240, 1e-3))  # s
KERNEL = (powers(-3, -4, -6, -8, -10, -12, -14, -16), powers(-4, -8, -12))
STEPPING = (powers(-2, -2.5, -3, -3.5, -4, -4.5, -5, -6), powers(-2, -3, -4))
SCIPY = {
    "DOP853": (powers(-3, -5, -7, -9, -11, -12), powers(-5, -9)),
    "RK45": (powers(-3, -5, -7, -9, -11), powers(-5, -9)),
    "LSODA": (powers(-3, -5, -7, -9, -11), powers(-7)),
    "Radau": (powers(-3, -5, -7), powers(-5)),
}
# a restart at every sample makes a scipy run under a record cost seconds
SCIPY_SAMPLED = {
    "DOP853": (powers(-3, -6, -9), ()),
    "RK45": (powers(-3, -6, -9), ()),
    "LSODA": (powers(-6), ()),
    "Radau": (powers(-3), ()),
}


def refined(levels: Sequence[float]) -> list[float]:
    """Levels with the geometric means of their neighbours."""
    means = (math.sqrt(a * b) for a, b in zip(levels, levels[1:], strict=False))
    return sorted({*levels, *means}, reverse=levels[0] > levels[-1])


def levels_of(spec: Variant, quick: bool) -> list[float]:
    """Levels of a variant that are run; few of the kind "defaults", whose error hardly changes."""
    few = (spec.levels[0], spec.default) if quick else spec.levels
    return list(dict.fromkeys(few)) if quick or spec.kind == "defaults" else refined(spec.levels)


def entries(scenes: Sequence[Trial], engines: Sequence[str], quick: bool) -> list[Entry]:
    """All entries, so that solvers alternate: the first level of each, then the second of each."""
    turns = (turn for trial in scenes for turn in zip_longest(*_ladders(trial, engines, quick)))
    return [entry for turn in turns for entry in turn if entry]


def _ladders(trial: Trial, engines: Sequence[str], quick: bool) -> Iterator[list[Entry]]:
    """Each solver's entries on a trial, level after level."""
    yield from _models(trial, SCIPY_SAMPLED if trial.name in SAMPLED else SCIPY, quick)
    for name in engines:
        for variant, kind in get_engine(name).variants.items():
            yield [Entry(trial, name, variant, kind.accuracy_parameter, level) for level in levels_of(kind, quick)]
            if kind.free_block and trial.scene.bearings is None:
                steps = FREE_3D_STEPS[quick]
                yield [Entry(trial, name, variant, "step", step, kind.free_block, model=FREE_3D) for step in steps]
    if trial.name in SAMPLED:
        yield from _models(trial.with_law("bouc-wen"), {"DOP853": SCIPY_SAMPLED["DOP853"]}, quick)
    if trial.name in TRANSPARENT:
        ways = [(SPRINGS, models.on_stiff_springs)]
        if trial.scene.motion is None:  # a free base does not feel the ground's motion
            ways.append((HEAVY_BASE, models.on_heavy_base))
        for model, change in ways:
            yield [_kernel(trial, level, model=model, scene_of=change) for level in powers(-8, -12)[quick:]]


def _models(trial, methods, quick):
    """The kernel, time stepping, and the equations in scipy by these methods."""
    yield [_kernel(trial, level) for level in KERNEL[quick]]
    yield [Entry(trial, "time-stepping", "", "step", step) for step in STEPPING[quick]]
    for method, levels in methods.items():
        settings = {"energy": False, "method": method}
        yield [Entry(trial, "scipy", method, "rtol", level, "twin", settings) for level in levels[quick]]


def _kernel(trial, level, **modelled):
    return Entry(trial, "analytic", "kernel", "tolerance", level, **modelled)
