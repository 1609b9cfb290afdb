"""The five scenes of the speed-error study, what is measured on each, and the references errors are taken from."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import brentq

from analytic import Scene, Start, simulate
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.motion import PulseMotion
from analytic.response import Response
from analytic.synthetic import synthetic_motion

from ...measuring.horizon import sensitivity_horizon

if TYPE_CHECKING:
    from analytic import State

TIGHTEST = 1e-17  # tolerance of the kernel as a reference
LONGEST = 10.0  # s, of a run under the synthetic motion: the strong shaking and what follows
FREQUENCY_RATIO = 3.0  # pulse frequency over omega_r, near-overturning scene
BOUNDARY_RUNS = 6  # a first run at the reference's boundary, then at the corrected ones
BRACKET = (1.35, 1.45)  # amplitude / g tan(slenderness) around its boundary


@dataclass(frozen=True, eq=False)
class Boundary:
    """An overturning boundary: pulse amplitude [m/s2] at which the block just overturns, and how the margin grows.

    slope: d margin / d (amplitude / boundary), see `margin`.
    """

    amplitude: float
    slope: float


@dataclass(frozen=True, eq=False)
class Trial:
    """One scene of the study.

    measures: names of the errors that mean something here, the principal one first. reference: the kernel at its
    tightest. boundary: None but where the runs search for one.
    """

    name: str
    title: str
    scene: Scene
    measures: tuple[str, ...]
    reference: Response
    boundary: Boundary | None = None

    @property
    def runs(self) -> int:
        """Simulations that make one measurement."""
        return 1 if self.boundary is None else BOUNDARY_RUNS

    def with_law(self, law: str) -> Trial:
        """The same trial with another bearing law, and that law's own reference."""
        scene = self.scene.with_(bearings={"law": law})
        return replace(self, scene=scene, reference=tight(scene))


def tight(scene: Scene) -> Response:
    """The reference response of a scene."""
    return simulate(scene, history=False, tolerance=TIGHTEST)


def margin(scene: Scene, end: State | Mapping[str, Any]) -> float:
    """Energy beyond what tipping over needs, over m g R (1 - cos gamma), after the motion's end; conserved in flight.

    end : State, or a dict of its fields. Negative: the block falls back; positive: it overturns. With u = gamma -
    |phi|: (w^2/2 - p^2 (1 - cos u))/(p^2 (1 - cos gamma)).
    """
    tilt, rate = (end["tilt"], end["tilt_rate"]) if isinstance(end, dict) else (end.tilt, end.tilt_rate)
    gamma, p2 = scene.block.slenderness, scene.rocking_frequency**2
    u = gamma - abs(tilt)
    return (0.5 * rate**2 - 2 * p2 * math.sin(0.5 * u) ** 2) / (2 * p2 * math.sin(0.5 * gamma) ** 2)


def at_amplitude(scene: Scene, amplitude: float) -> Scene:
    """The scene with its pulse at another amplitude [m/s2]."""
    assert isinstance(scene.motion, PulseMotion)
    return scene.with_(motion=replace(scene.motion, amplitude=float(amplitude)))


def trials() -> list[Trial]:
    """The five trials, in order of what they ask of a solver."""
    motion = synthetic_motion()
    free = caryatid_block(0.2)
    isolated: dict[str, Any] = {"base": BASE, "bearings": BEARINGS, "motion": motion}
    rigid = Scene(name="free rocking on rigid ground", block=free, start=Start(tilt=0.12), duration=5.0)
    sliding = rigid.with_(name="free rocking on a sliding base", base=BASE, duration=4.0)
    stands = Scene(name="isolated, standing", block=caryatid_block(0.28), duration=LONGEST, **isolated)
    rocks = Scene(name="isolated, rocking", block=caryatid_block(0.15), duration=LONGEST, **isolated)
    rocks = rocks.with_(duration=math.floor(100 * sensitivity_horizon(rocks).horizon) / 100)
    events = ("impact_time", "restitution")
    return [
        _trial("free-rigid", rigid, (*events, "end_tilt")),
        _trial("free-sliding", sliding, (*events, "peak_displacement")),
        _trial("isolated-standing", stands, ("peak_displacement",)),
        _trial("isolated-rocking", rocks, (*events, "peak_tilt", "peak_displacement")),
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
    scene = at_amplitude(scene, amplitude)
    return Trial(
        "near-overturning",
        scene.name,
        scene,
        ("boundary_shift", "impact_time", "restitution", "peak_tilt"),
        tight(scene),
        Boundary(amplitude, slope),
    )


def _trial(name, scene, measures):
    return Trial(name, scene.name, scene, measures, tight(scene))


def description(trial: Trial) -> dict[str, Any]:
    """JSON-ready description of a trial for the result file."""
    reference = trial.reference
    impacts = np.array([impact.time for impact in reference.impacts])
    return {
        "title": trial.title,
        "duration": trial.scene.duration,
        "runs": trial.runs,
        "measures": list(trial.measures),
        "outcome": reference.outcome,
        "impacts": len(impacts),
        "slenderness": trial.scene.block.slenderness,
        "peak_tilt_ratio": reference.peak_tilt_ratio,
        "peak_base_displacement": reference.peak_base_displacement,
        "digest": trial.scene.digest(),
        "boundary_amplitude": trial.boundary and trial.boundary.amplitude,
    }
