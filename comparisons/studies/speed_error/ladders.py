"""Every solver and the ladder of its accuracy knob: what is run on which scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from engines import get_engine

from ...measuring import models
from ...running.cases import Case
from .scenes import Trial

if TYPE_CHECKING:
    from analytic import Scene

TRANSPARENT = ("free-rigid", "near-overturning")  # scenes without base or record
SAMPLED = ("isolated-standing", "isolated-rocking")

NEEDED = "as needed"
HEAVY_BASE, SPRINGS, FREE_3D = "rigid ground as a heavy base", "rigid ground as stiff springs", "free block in 3-D"


@dataclass(frozen=True, eq=False)
class Entry:
    """One solver at one setting on one trial.

    family: how tables call the solver. solver, variant, settings: what is run. knob, value: the accuracy knob.
    model: `NEEDED`, or what is modelled beyond what the scene needs. scene_of: Trial -> scene simulated.
    """

    trial: Trial
    family: str
    solver: str
    knob: str
    value: float
    variant: str | None = None
    settings: dict = field(default_factory=dict)
    law: str | None = None
    model: str = NEEDED
    scene_of: Callable[[Scene], Scene] | None = None

    @property
    def scene(self) -> Scene:
        return self.trial.scene if self.scene_of is None else self.scene_of(self.trial.scene)

    def case(self, turn: int) -> Case:
        """The measurement of one round as a `Case`."""
        boundary = self.trial.boundary
        return Case(
            self.scene,
            self.solver,
            self.variant,
            {**self.settings, self.knob: self.value, "history": False},
            {"boundary": boundary and [boundary.amplitude, boundary.slope], "round": turn},
        )


def powers(*exponents: float) -> tuple[float, ...]:
    return tuple(10.0**exponent for exponent in exponents)


FREE_3D_STEPS = ((1 / 240, 1e-3, 3e-4, 1e-4), (1 / 240, 1e-3))  # s
KERNEL = (powers(-3, -4, -6, -8, -10, -12, -14, -16), powers(-4, -8, -12))
STEPPING = (powers(-2, -2.5, -3, -3.5, -4, -4.5, -5, -6), powers(-2, -3, -4))
# a restart at every sample makes a scipy run under a record cost seconds
TWIN = {
    "DOP853": (powers(-3, -5, -7, -9, -11, -12), powers(-5, -9)),
    "RK45": (powers(-3, -5, -7, -9, -11), powers(-5, -9)),
    "LSODA": (powers(-3, -5, -7, -9, -11), powers(-7)),
    "Radau": (powers(-3, -5, -7), powers(-5)),
}
TWIN_SAMPLED = {
    "DOP853": (powers(-3, -6, -9), ()),
    "RK45": (powers(-3, -6, -9), ()),
    "LSODA": (powers(-6), ()),
    "Radau": (powers(-3), ()),
}
TWIN_SETTINGS = {"energy": False}


def refined(ladder: Sequence[float]) -> list[float]:
    """A ladder with the geometric means of its neighbours."""
    means = (math.sqrt(a * b) for a, b in zip(ladder, ladder[1:], strict=False))
    return sorted({*ladder, *means}, reverse=ladder[0] > ladder[-1])


def entries(trials: Sequence[Trial], engines: Sequence[str], quick: bool) -> list[Entry]:
    """All entries, ordered so that solvers alternate."""
    pick = 1 if quick else 0
    groups = []
    for trial in trials:
        here = _analytic(trial, pick) + _engines(trial, engines, pick)
        if trial.name in SAMPLED:
            here += _bouc_wen(trial, pick)
        groups.append(here + _extras(trial, engines, pick))
    return [entry for group in groups for entry in _alternating(group)]


def _analytic(trial, pick):
    entries = [Entry(trial, "kernel", "analytic", "tolerance", value) for value in KERNEL[pick]]
    entries += [Entry(trial, "time-stepping", "time-stepping", "step", value) for value in STEPPING[pick]]
    ladders = TWIN_SAMPLED if trial.name in SAMPLED else TWIN
    return entries + [
        Entry(trial, f"scipy {method}", "twin", "rtol", value, settings={**TWIN_SETTINGS, "method": method})
        for method, ladder in ladders.items()
        for value in ladder[pick]
    ]


def _engines(trial, engines, pick):
    ladder = []
    for name in engines:
        for variant, kind in get_engine(name).variants.items():
            knob = kind.knob
            values = dict.fromkeys((kind.ladder[0], kind.default)) if pick else refined(kind.ladder)
            ladder += [Entry(trial, f"{name}, {variant}", name, knob, value, variant=variant) for value in values]
    return ladder


def applied_impacts(engines: Sequence[str]) -> dict[str, str]:
    """{family whose impacts are the adapter's: family of the same engine's default variant}."""
    return {
        f"{name}, {variant}": f"{name}, {get_engine(name).default_variant}"
        for name in engines
        for variant, kind in get_engine(name).variants.items()
        if kind.takes_restitution
    }


def _bouc_wen(trial, pick):
    law = trial.with_law("bouc-wen")
    ladder = [Entry(law, "kernel, Bouc-Wen", "analytic", "tolerance", value, law="bouc-wen") for value in KERNEL[pick]]
    ladder += [
        Entry(law, "time-stepping, Bouc-Wen", "time-stepping", "step", value, law="bouc-wen")
        for value in STEPPING[pick]
    ]
    return ladder + [
        Entry(
            law,
            "scipy DOP853, Bouc-Wen",
            "twin",
            "rtol",
            value,
            law="bouc-wen",
            settings={**TWIN_SETTINGS, "method": "DOP853"},
        )
        for value in TWIN_SAMPLED["DOP853"][pick]
    ]


def _extras(trial, engines, pick):
    """The same scene with more than it needs."""
    ladder = []
    if trial.name in TRANSPARENT:
        ways = [(SPRINGS, models.on_stiff_springs)]
        if trial.scene.motion is None:  # a free base does not feel the ground's motion
            ways.append((HEAVY_BASE, models.on_heavy_base))
        ladder += [
            Entry(trial, "kernel", "analytic", "tolerance", value, model=model, scene_of=change)
            for model, change in ways
            for value in powers(-8, -12)[pick:]
        ]
    for name in engines if trial.scene.bearings is None else ():
        ladder += [
            Entry(trial, f"{name}, {variant}", kind.free_block, "step", value, model=FREE_3D)
            for variant, kind in get_engine(name).variants.items()
            if kind.free_block
            for value in FREE_3D_STEPS[pick]
        ]
    return ladder


def _alternating(group):
    """The first setting of every solver, then the second of every solver, and so on."""
    rank, ordered = {}, []
    for entry in group:
        key = entry.family, entry.law, entry.model
        rank[key] = rank.get(key, -1) + 1
        ordered.append((rank[key], entry))
    return [entry for _, entry in sorted(ordered, key=lambda pair: pair[0])]
