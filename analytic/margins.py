"""How far is a verdict from its nearest flip, in each quantity that is only known so well?

A verdict need not flip once: resonances leave narrow bands of another outcome far from the first boundary, and safe
gaps beyond it. So each quantity is scanned, one at a time, at even relative changes, and every boundary between two
changes is bisected. A band narrower than the scan's `step` may be missed; one of twice the step never is. Where such
narrow bands show, the boundary is frayed (as a fractal is): the safe gap about the scene is then scanned again in steps
`FINER` times smaller, and the margin says so, as still narrower bands may lie in it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .batch import simulate_many
from .budget import STEPS_PER_SAMPLE, too_long
from .errors import SceneError, SettingError
from .laws import LAWS, NUMBERS
from .motion import SampledMotion
from .rocking import RockingModel
from .scene import Scene
from .solver import simulate

SPAN, STEP = 0.2, 5e-4
MOST_STEPS = 2e9  # of all runs, some twenty minutes on two cores
BISECTIONS = 14  # of a step: boundaries are known to 6e-5 of it
FINER = 20


@dataclass(frozen=True)
class Band:
    """Changes from `low` to `high` [relative] of a quantity with one outcome; `holds`: N > 0, and no sliding."""

    low: float
    high: float
    outcome: str
    holds: bool


@dataclass(frozen=True)
class Margin:
    """What relative changes of one quantity do to the outcome; `value` is the scene's own, `bands` from low to high.

    step: of the scan.
    """

    quantity: str
    value: float
    unit: str
    bands: tuple[Band, ...]
    step: float = STEP

    @property
    def outcome(self) -> str:
        """That of the scene as it is."""
        return self._own.outcome

    @property
    def down(self) -> float | None:
        """The nearest change below 0 with another outcome, None if there is none in the range scanned."""
        return max((band.high for band in self._others if band.high <= 0), default=None)

    @property
    def up(self) -> float | None:
        """The nearest change above 0 with another outcome, None if there is none in the range scanned."""
        return min((band.low for band in self._others if band.low >= 0), default=None)

    @property
    def nearest(self) -> float | None:
        """The nearer of `down` and `up`."""
        return min((change for change in (self.down, self.up) if change is not None), key=abs, default=None)

    @property
    def leaves_model(self) -> float | None:
        """The nearest change at which the model no longer holds (N <= 0, or sliding); 0 where it does not hold now."""
        outside = [band for band in self.bands if not band.holds]
        changes = (0.0 if band.low <= 0 <= band.high else band.low if band.low > 0 else band.high for band in outside)
        return min(changes, key=abs, default=None)

    @property
    def frayed(self) -> bool:
        """Whether the outcome changes and changes back within two steps: a flip may lie nearer than `nearest` says."""
        grouped = [list(group) for _, group in itertools.groupby(self.bands, lambda band: band.outcome)]
        return any(group[-1].high - group[0].low < 2 * self.step for group in grouped[1:-1])

    def beyond(self, change: float) -> str:
        """The outcome on the far side of a boundary."""
        edge = next(b for b in self._others if change in (b.low, b.high) and change * (b.low + b.high) > 0)
        return edge.outcome

    @property
    def _own(self):
        return next(band for band in self.bands if band.low <= 0 <= band.high)

    @property
    def _others(self):
        return [band for band in self.bands if band.outcome != self.outcome]


@dataclass(frozen=True)
class Quantity:
    """A quantity of a scene: its unit, its value (None where the scene has none) and the scene with it changed."""

    unit: str
    value: Callable[[Scene], float | None]
    changed: Callable[[Scene, float], Scene]


def _bearing(name, unit):
    def value(scene):
        used = scene.bearings and name in ("ka", *LAWS[NUMBERS[scene.bearings.law]].needs)
        return getattr(scene.bearings, name) if used else None

    return Quantity(unit, value, lambda scene, factor: scene.with_(bearings={name: factor * value(scene)}))


def _slenderness(scene, factor):
    """Another slenderness at the same R, mass and J_O: half width and half height change."""
    return scene.with_(block={"slenderness": factor * scene.block.slenderness})


def _size(scene, factor):
    """Another R at the same mass and shape."""
    inertia = scene.block.corner_inertia
    return scene.with_(
        block={
            "radius": factor * scene.block.radius,
            "corner_inertia": None if inertia is None else factor**2 * inertia,
        }
    )


def _restitution(scene):
    return max(RockingModel.of(scene).restitution, 0.0) or None


def _started(scene):
    start = scene.start
    return next((value for value in (start.tilt, start.tilt_rate) if value), None) if scene.motion is None else None


QUANTITIES = {
    "slenderness": Quantity("rad", lambda scene: scene.block.slenderness, _slenderness),
    "restitution": Quantity(
        "-", _restitution, lambda scene, factor: scene.with_(block={"restitution": factor * _restitution(scene)})
    ),
    "size": Quantity("m", lambda scene: scene.block.radius, _size),
    # the motion is scaled by the batch, which then need not copy its samples
    "motion": Quantity("m/s2", lambda scene: scene.motion and scene.motion.peak, lambda scene, factor: scene),  # type: ignore[arg-type, return-value]  # a motion or None is the number or None
    "start": Quantity(
        "rad, rad/s",
        _started,
        lambda scene, factor: scene.with_(
            start={name: factor * value for name, value in scene.start.model_dump().items()}
        ),
    ),
    "base mass": Quantity(
        "kg",
        lambda scene: scene.base and scene.base.mass,  # type: ignore[arg-type, return-value]  # a base or None, likewise
        lambda scene, factor: scene.with_(base={"mass": factor * scene.base.mass}),  # type: ignore[union-attr]  # asked where there is one
    ),
    "ka": _bearing("ka", "N/m"),
    "kb": _bearing("kb", "N/m"),
    "alpha": _bearing("alpha", "-"),
    "yield force": _bearing("yield_force", "N"),
}


def margins(
    scene: Scene,
    *,
    span: float = SPAN,
    step: float = STEP,
    workers: int | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Margin]:
    """How each quantity's relative changes of up to `span` change the outcome; a `Margin` each, the nearest first.

    Every run goes on until its outcome is decided. Changes that are no scene (e above 1, ka below kb) end the range.

    Parameters
    ----------
    span, step : float
        Largest relative change, and how far the scanned ones lie apart.
    workers : int or None
        Threads; without it one per core. The result does not depend on it.
    progress : callable or None
        Is told the name of each quantity before it is scanned.

    Raises
    ------
    SettingError
        span or step is out of range.
    SceneError
        The scene is too stiff or too long for so many runs; names the part.
    """
    if not 0 < span < 1:
        raise SettingError(f"span = {span!r}: give the largest relative change, above 0 and below 1")
    if not 1e-6 <= step <= span:
        raise SettingError(
            f"step = {step!r}: give the relative distance of two changes, from 1e-6 to the span {span:g}"
        )
    scene = scene.with_(duration=None)
    count = math.floor(span / step * (1 + 1e-12))
    changes = step * np.arange(-count, count + 1)
    values = {name: value for name, each in QUANTITIES.items() if (value := each.value(scene)) is not None}
    _check_cost(scene, len(values) * len(changes))
    found = []
    for name, value in values.items():
        quantity = QUANTITIES[name]
        if progress:
            progress(name)
        margin = Margin(name, float(value), quantity.unit, _bands(scene, name, changes, workers), step)
        if margin.frayed:
            margin = replace(margin, bands=_bands(scene, name, _finer(margin, changes), workers))
        found.append(margin)
    return sorted(found, key=lambda margin: math.inf if margin.nearest is None else abs(margin.nearest))


def _check_cost(scene, runs):
    """Refuse a scene that costs too much as often as it is to be run."""
    steps = simulate(scene, history=False).steps
    samples = len(scene.motion.samples) if isinstance(scene.motion, SampledMotion) else 0
    if steps > STEPS_PER_SAMPLE * samples + MOST_STEPS / runs:
        raise too_long(scene, f"{runs} runs of {steps:.3g} steps are too many")


@dataclass(frozen=True)
class Contact:
    """What the contact has to spare: min N/(m g), the friction demand |H|/N, the scene's coefficient or None."""

    least_normal: float
    friction_demand: float
    friction: float | None


def contact_margins(scene: Scene) -> Contact:
    """The `Contact` of a scene as it is, run until its outcome is decided."""
    response = simulate(scene.with_(duration=None), history=False)
    return Contact(response.min_normal_ratio, response.friction_demand, scene.friction)


def _finer(margin, changes):
    """The changes, and between the nearest flips steps `FINER` times smaller."""
    low, high = (end if flip is None else flip for end, flip in ((changes[0], margin.down), (changes[-1], margin.up)))
    counts = np.arange(math.ceil(FINER * low / margin.step), FINER * high / margin.step)
    return np.union1d(changes, margin.step / FINER * counts[counts % FINER != 0])


def _bands(scene, name, changes, workers):
    """Tuple of `Band` over the changes, their boundaries bisected."""
    changes, scenes = _scenes(scene, name, changes)
    states = _states(scene, name, changes, scenes, workers)
    edges = np.flatnonzero([one != other for one, other in zip(states[:-1], states[1:], strict=True)])
    low, high = changes[edges], changes[edges + 1]
    before = [states[edge] for edge in edges]
    for _ in range(BISECTIONS if len(edges) else 0):
        middle = 0.5 * (low + high)
        same = np.array([a == b for a, b in zip(_states(scene, name, middle, None, workers), before, strict=True)])
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    limits = [changes[0], *(0.5 * (low + high)), changes[-1]]
    kinds = [states[0], *(states[edge + 1] for edge in edges)]
    return tuple(Band(float(a), float(b), *kind) for a, b, kind in zip(limits[:-1], limits[1:], kinds, strict=True))


def _scenes(scene, name, changes):
    """(the changes about 0 that give a scene, their scenes)."""
    changed = QUANTITIES[name].changed
    kept = {}
    for direction in (changes[changes >= 0], changes[changes < 0][::-1]):
        for change in direction:
            try:
                kept[change] = changed(scene, 1 + change)
            except (SceneError, ValueError):
                break
    ordered = sorted(kept)
    return np.array(ordered), [kept[change] for change in ordered]


def _states(scene, name, changes, scenes, workers):
    """[(outcome, whether the model holds)] at each change."""
    if scenes is None:
        scenes = [QUANTITIES[name].changed(scene, 1 + change) for change in changes]
    scales = 1 + changes if name == "motion" else None
    outcomes = simulate_many(scenes, scales=scales, contact=True, workers=workers)
    for index in np.flatnonzero(outcomes.failed):
        simulate(scenes[index], history=False)  # raises what is wrong
        raise SceneError(name, None, f"changed by {changes[index]:.2%} the analytic model cannot go on", "take less")
    limit = math.inf if scene.friction is None else scene.friction
    holds = (outcomes.min_normal_ratio > 0) & ~(outcomes.friction_demand > limit)
    return list(zip(outcomes.names.tolist(), holds.tolist(), strict=True))
