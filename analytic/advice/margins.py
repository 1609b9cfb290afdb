"""Margins: the change of a quantity at which the outcome of a scene, or a limit state, changes.

A limit state is reached if the block slides (where the scene gives a friction), if it lifts, if its peak tilt exceeds a
share of the slenderness, if the base exceeds the x_max of its bearings, or if the block falls off its pedestal or
overturns.

The outcome may change more than once. Resonances cause narrow bands of another outcome far from the first boundary, and
safe gaps beyond it. Each quantity is therefore scanned, one at a time, at equidistant relative changes, and every
boundary between two changes is bisected. A band narrower than the `step` of the scan may be missed; a band of twice the
step is always found. Where narrow bands of outcomes alternate, the boundary is interleaved (fractal). The safe gap
about the scene is then scanned again in steps `FINER` times smaller, and the margin says so, as the gap may contain
still narrower bands.

With a free pedestal only motion or start is changed, in steps of `STACK_STEP` at least and without the second scan, as
a run takes a thousand times as long.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Self

import numpy as np

from ..batch import Outcomes, simulate_many
from ..errors import SceneError, require
from ..laws import LAWS, NUMBERS
from ..motion import SampledMotion
from ..response import FALLS, Caution
from ..rocking import restitution
from ..scene import KEYS, SCENE_UNITS, Scene
from ..solver import STEPS_PER_SAMPLE, simulate, too_long

if TYPE_CHECKING:
    from ..response import Response

LIMIT_STATES = ("slides", "lifts", "tilt", "stroke", *FALLS)
TILT = 0.5  # share of the slenderness
SPAN, STEP = 0.2, 5e-4
LARGEST_SPAN = 9.0  # ten times the motion: a record of 0.1 g then has 1 g
MOST_STEPS = 2e9  # of all runs, some twenty minutes on two cores
BISECTIONS = 14  # boundaries are located to 6e-5 of a step
STACK_QUANTITIES = ("motion", "start")
STACK_STEP, STACK_BISECTIONS = 0.01, 7  # of a scene with a free pedestal: boundaries to 1e-4 of the motion
_outcome = attrgetter("outcome")
FINER = 20  # factor between the steps of the two scans of an interleaved margin
# Limits of `nearby`: the motion is one of many that are possible, and its scale is known to a few per cent at best.
SHARE = 0.05  # largest change of the motion, up and down
FOLD = 5.0  # a peak tilt is sensitive if it changes by this factor within SHARE ...
SEEN = 0.01  # ... and exceeds this share of the slenderness, below which engines are not tested either
NEARBY_STEPS = 1e8  # of all its runs: a minute on two cores


@dataclass(frozen=True)
class Band:
    """A range of relative changes, from `low` to `high`, that reach the same of LIMIT_STATES.

    holds: whether the model is valid: N > 0, or a friction is given, with which a block that flies is modelled.
    """

    low: float
    high: float
    reached: tuple[str, ...]
    holds: bool

    @property
    def outcome(self) -> str:
        """Return the outcome, as `Response.outcome`."""
        if falls := [state for state in FALLS if state in self.reached]:
            return falls[-1]
        if "lifts" in self.reached:
            return "rocks"
        return "slides" if "slides" in self.reached else "stands"


@dataclass(frozen=True)
class Margin:
    """Effects of relative changes of one quantity.

    value: the quantity in the scene. bands: from low to high. step: of the scan. ends_down, ends_up: why no scene or no
    run lies beyond the first and beyond the last band; "" where the whole span was scanned.
    """

    quantity: str
    value: float
    unit: str
    bands: tuple[Band, ...]
    step: float = STEP
    ends_down: str = ""
    ends_up: str = ""

    @property
    def outcome(self) -> str:
        """Return the outcome of the unchanged scene."""
        return self._own.outcome

    @property
    def down(self) -> float | None:
        """Return the nearest change below 0 with another outcome; None if there is none in the range scanned."""
        return self._edges(_outcome)[0]

    @property
    def up(self) -> float | None:
        """Return the nearest change above 0 with another outcome; None if there is none in the range scanned."""
        return self._edges(_outcome)[1]

    @property
    def nearest(self) -> float | None:
        """Return the nearer of `down` and `up`."""
        return _nearer(self._edges(_outcome))

    def reached(self, state: str) -> bool:
        """Return whether the unchanged scene reaches one of LIMIT_STATES."""
        return state in self._own.reached

    def change(self, state: str) -> float | None:
        """Return the smallest change at which one of LIMIT_STATES is reached or left; None as in `down`."""
        return _nearer(self._edges(lambda band: state in band.reached))

    @property
    def leaves_model(self) -> float | None:
        """Return the smallest change at which the model is not valid (N <= 0); 0 if it is not for the scene itself."""
        return _nearer(self._edges(lambda band: band.holds)) if self._own.holds else 0.0

    @property
    def outcomes(self) -> list[tuple[float, float, str]]:
        """Return [(low, high, outcome)]: the bands, adjacent ones of the same outcome joined."""
        grouped = [(outcome, list(group)) for outcome, group in itertools.groupby(self.bands, _outcome)]
        return [(group[0].low, group[-1].high, outcome) for outcome, group in grouped]

    @property
    def interleaved(self) -> bool:
        """Return whether the outcome changes and changes back within two steps.

        It may then change closer than `nearest`. A short band of rocking between standing and overturning is no change.
        """
        bands = self.outcomes
        return any(
            high - low < 2 * self.step and not (outcome == "rocks" and before != after)
            for (_, _, before), (low, high, outcome), (_, _, after) in zip(bands, bands[1:], bands[2:], strict=False)
        )

    def beyond(self, change: float) -> str:
        """Return the outcome on the far side of a boundary."""
        edge = next(b for b in self.bands if b.outcome != self.outcome and change == (b.low if change > 0 else b.high))
        return edge.outcome

    @property
    def _own(self):
        return next(band for band in self.bands if band.low <= 0 <= band.high)

    def _edges(self, kind):
        """Return the nearest changes below and above 0 at which `kind` of a band changes, or None."""
        different = [band for band in self.bands if kind(band) != kind(self._own)]
        return (
            max((band.high for band in different if band.high <= 0), default=None),
            min((band.low for band in different if band.low >= 0), default=None),
        )


def _nearer(edges):
    return min((change for change in edges if change is not None), key=abs, default=None)


@dataclass(frozen=True)
class Quantity:
    """A quantity of a scene: its unit, its value (None if the scene has none) and the changed scene."""

    unit: str
    value: Callable[[Scene], float | None]
    changed: Callable[[Scene, float], Scene]


def _bearing(name):
    def value(scene):
        used = scene.bearings and name in ("ka", *LAWS[NUMBERS[scene.bearings.law]].needs)
        return getattr(scene.bearings, name) if used else None

    unit = SCENE_UNITS.get(f"bearings.{name}", "-")
    return Quantity(unit, value, lambda scene, factor: scene.with_(bearings={name: factor * value(scene)}))


def _slenderness(scene, factor):
    """Return the scene with another slenderness at the same R, mass and J_O: half width and half height change."""
    return _reshaped(scene, slenderness=factor * scene.block.slenderness)


def _size(scene, factor):
    """Return the scene with another R at the same mass and shape."""
    inertia = scene.block.corner_inertia
    return _reshaped(
        scene, radius=factor * scene.block.radius, corner_inertia=None if inertia is None else factor**2 * inertia
    )


def _reshaped(scene, **changes):
    """Return the scene with a changed block; its pedestal is as wide as the block at least."""
    shape = scene.block.model_copy(update=changes)
    return scene.with_(
        block=changes, pedestal=scene.pedestal and {"width": max(scene.pedestal.width, 2 * shape.half_width)}
    )


def _restitution(scene):
    if scene.friction is not None and scene.block.restitution is None:
        return None  # one that is given does not slip
    return restitution(scene) or None


def _started(scene):
    start = scene.start
    return next((value for value in (start.tilt, start.tilt_rate) if value), None) if scene.motion is None else None


QUANTITIES = {
    "slenderness": Quantity("rad", lambda scene: scene.block.slenderness, _slenderness),
    "restitution": Quantity(
        "-", _restitution, lambda scene, factor: scene.with_(block={"restitution": factor * _restitution(scene)})
    ),
    "size": Quantity("m", lambda scene: scene.block.radius, _size),
    "friction": Quantity(
        "-",
        lambda scene: scene.friction,
        lambda scene, factor: scene.with_(friction=factor * scene.friction),  # type: ignore[operator]  # only called where there is one
    ),
    # the batch scales the motion without a copy of its samples
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
        lambda scene, factor: scene.with_(base={"mass": factor * scene.base.mass}),  # type: ignore[union-attr]  # only called where there is one
    ),
    "pedestal width": Quantity(
        "m",
        lambda scene: scene.pedestal.width if scene.pedestal and scene.friction else None,
        lambda scene, factor: scene.with_(pedestal={"width": factor * scene.pedestal.width}),  # type: ignore[union-attr]  # likewise
    ),
    # not delta_k, which defines the limit force and is negligible beside the stiffnesses
    **{name.replace("_", " "): _bearing(name) for name in ("ka", *KEYS) if name != "delta_k"},
}


def limit_states(scene: Scene) -> tuple[str, ...]:
    """Return the LIMIT_STATES that a scene can reach: "stroke" needs bearings with an x_max, "slides" a friction.

    "falls off" needs a friction and a pedestal, "pedestal overturns" one that is free.
    """
    needs = {
        "stroke": scene.bearings is not None and scene.bearings.x_max is not None,
        "slides": scene.friction is not None,
        "falls off": scene.pedestal is not None and scene.friction is not None,
        "pedestal overturns": scene.is_stack,
    }
    return tuple(state for state in LIMIT_STATES if needs.get(state, True))


def margins(
    scene: Scene,
    *,
    tilt: float = TILT,
    span: float = SPAN,
    step: float = STEP,
    only: Collection[str] = (),
    workers: int | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Margin]:
    """Return the `Margin` of each quantity for relative changes up to `span`, the smallest change of outcome first.

    Every run continues until its outcome is decided. The range ends where a change gives no valid scene (e above 1, ka
    below kb), or one that the model refuses or fails on, and the margin says why; downwards it ends above -1.

    Parameters
    ----------
    tilt : float
        Limit of the peak tilt over the slenderness in the limit state "tilt"; above 0, up to 1.
    span, step : float
        Largest relative change, up to 9, and the distance of the changes scanned.
    only : collection of str
        Some of QUANTITIES; by default all that the scene has.
    workers, progress : int, callable
        Threads, by default one per core; called with the name of each quantity before its scan, and with a free
        pedestal before each run, as these take seconds.

    Raises
    ------
    SettingError
        tilt, span or step is out of range.
    SceneError
        The scene cannot be run, or is too stiff or too long for so many runs; the message names the part.
    """
    require(0 < tilt <= 1, f"tilt = {tilt!r}: give a share of the slenderness, above 0 and up to 1")
    require(
        0 < span <= LARGEST_SPAN,
        f"span = {span!r}: give the largest relative change, above 0 and up to {LARGEST_SPAN:g}",
    )
    require(
        1e-6 <= step <= span,
        f"step = {step!r}: give the relative distance of two changes, from 1e-6 to the span {span:g}",
    )
    scene = scene.with_(duration=None)
    step, only = (max(step, min(STACK_STEP, span)), STACK_QUANTITIES) if scene.is_stack else (step, only)
    count = math.floor(span / step * (1 + 1e-12))
    changes = step * np.arange(-count, count + 1)
    changes = changes[1 + changes > 0.5 * step]  # closer to -1 the quantity almost vanishes
    values = {name: value for name, each in QUANTITIES.items() if (value := each.value(scene)) is not None}
    values = {name: value for name, value in values.items() if not only or name in only}
    check_cost(scene, len(values) * len(changes))
    results = []
    for name, value in values.items():
        if progress:
            progress(name)
        states = partial(_states, scene, name, tilt, workers, progress)
        bands, ends = _bands(scene, name, changes, states)
        margin = Margin(name, float(value), QUANTITIES[name].unit, bands, step, **ends)
        if margin.interleaved and not scene.is_stack:
            bands, ends = _bands(scene, name, _finer(margin, changes), states)
            margin = replace(margin, bands=bands, **ends)
        results.append(margin)
    return sorted(results, key=lambda margin: math.inf if margin.nearest is None else abs(margin.nearest))


def check_cost(scene: Scene, runs: int, most: float = MOST_STEPS) -> None:
    """Raise `SceneError` if so many runs take more than `most` steps, apart from the steps for its record."""
    steps = simulate(scene, history=False).steps
    samples = len(scene.motion.samples) if isinstance(scene.motion, SampledMotion) else 0
    if steps > STEPS_PER_SAMPLE * samples + most / runs:
        raise too_long(scene, f"{runs} runs of {steps:.3g} steps are too many")


@dataclass(frozen=True)
class Contact:
    """Reserves of the contact: min N/(m g), friction demand |H|/N, the scene's coefficient, whether it slides."""

    least_normal: float
    friction_demand: float
    friction: float | None
    slides: bool = False

    @classmethod
    def of(cls, scene: Scene, response: Response) -> Self:
        """Return the reserves in a run of the scene."""
        slides = response.sliding is not None and response.sliding.path > 0
        return cls(response.min_normal_ratio, response.friction_demand, scene.friction, slides)


def _finer(margin, changes):
    """Return the changes, with steps `FINER` times smaller between the nearest changes of the outcome."""
    low = changes[0] if margin.down is None else margin.down
    high = changes[-1] if margin.up is None else margin.up
    counts = np.arange(math.ceil(FINER * low / margin.step), FINER * high / margin.step)
    return np.union1d(changes, margin.step / FINER * counts[counts % FINER != 0])


def _bands(scene, name, changes, states_of):
    """Return (tuple of `Band` over the changes, why they end). states_of: `_states` of changes.

    Boundaries are bisected for each state, as two may lie within one step.
    """
    changes, states, ends = _scanned(scene, name, changes, states_of)
    edges, columns = np.nonzero(states[1:] != states[:-1])
    low, high, before = changes[edges], changes[edges + 1], states[edges, columns]
    for _ in range((STACK_BISECTIONS if scene.is_stack else BISECTIONS) if len(edges) else 0):
        middle = 0.5 * (low + high)
        points, where = np.unique(middle, return_inverse=True)
        middle_states, failed = states_of(points)
        same = (middle_states[where, columns] == before) & ~failed[where]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    boundaries = 0.5 * (low + high)
    bands, state = [], states[0]
    for a, b in itertools.pairwise([changes[0], *np.unique(boundaries), changes[-1]]):
        state = state ^ np.isin(np.arange(len(state)), columns[boundaries == a])
        reached = tuple(itertools.compress(LIMIT_STATES, state))
        bands.append(Band(float(a), float(b), reached, bool(state[-1])))
    return tuple(bands), ends


def _scanned(scene, name, changes, states_of):
    """Return (the changes about 0 up to the first that cannot be run, their states, why there).

    The last is a dict of "ends_down" and "ends_up".
    """
    changes, scenes, ends = _scenes(scene, name, changes)
    states, failed = states_of(changes, scenes)
    if failed[changes == 0].any():
        raise SceneError(
            name, None, f"the analytic model fails on the scene as it is: {why_it_fails(scene)}", "change the scene"
        )
    beyond = np.flatnonzero(failed)
    first = max(beyond[changes[beyond] < 0], default=-1)
    last = min(beyond[changes[beyond] > 0], default=len(changes))
    ends |= {"ends_down": why_it_fails(scenes[first])} if first >= 0 else {}
    ends |= {"ends_up": why_it_fails(scenes[last])} if last < len(changes) else {}
    return changes[first + 1 : last], states[first + 1 : last], ends


def why_it_fails(scene: Scene) -> str:
    """Return why a scene cannot be run."""
    try:
        response = simulate(scene, history=False)
    except SceneError as error:
        return _refusal(error)
    return response.failure.reason if response.failure else "the analytic model fails"


def _refusal(error):
    value = f" = {error.value:.5g}" if isinstance(error.value, float) else ""
    return f"{error.key}{value}: {error.problem}"


def _scenes(scene, name, changes):
    """Return (the changes about 0 that give a valid scene, their scenes, why none lies beyond), as `_scanned`."""
    changed = QUANTITIES[name].changed
    valid, ends = {0.0: scene}, {}
    for key, direction in (("ends_up", changes[changes > 0]), ("ends_down", changes[changes < 0][::-1])):
        for change in direction:
            try:
                valid[change] = changed(scene, 1 + change)
            except SceneError as error:
                ends[key] = _refusal(error)
                break
    ordered = sorted(valid)
    return np.array(ordered), [valid[change] for change in ordered], ends


def _states(scene, name, tilt, workers, progress, changes, scenes=None):
    """Return (states, which runs failed).

    states : array (changes, LIMIT_STATES and one more): those reached, and whether the model is valid.
    """
    if scene.is_stack:
        return _stack_states(scene, name, tilt, progress, changes)
    if scenes is None:
        scenes = [QUANTITIES[name].changed(scene, 1 + change) for change in changes]
    scales = 1 + changes if name == "motion" else None
    outcomes = simulate_many(scenes, scales=scales, contact=True, workers=workers)
    slenderness = np.array([each.block.slenderness for each in scenes])
    farthest = scene.bearings.x_max if "stroke" in limit_states(scene) else math.inf
    reached = np.column_stack(
        [
            outcomes.slid,
            outcomes.lifted | outcomes.overturns,
            (outcomes.peak_tilt > tilt * slenderness) | outcomes.overturns,  # the peak tilt of a fall is not final
            outcomes.peak_base_displacement > farthest,
            outcomes.fell_off,
            outcomes.overturns,
            np.zeros_like(outcomes.overturns),  # a pedestal that is fixed
            (outcomes.min_normal_ratio > 0) | (scene.friction is not None),
        ]
    )
    return reached, outcomes.failed


def _stack_states(scene, name, tilt, progress, changes):
    """Return what `_states` does, of a scene with a free pedestal."""
    farthest = scene.bearings.x_max if "stroke" in limit_states(scene) else math.inf
    rows = []
    for k, factor in enumerate((1 + changes).tolist(), 1):
        if progress:
            progress(f"{name}, run {k} of {len(changes)}")
        changed = QUANTITIES[name].changed(scene, factor)
        run = simulate(
            changed.with_(motion=scene.motion.scaled(factor)) if name == "motion" else changed, history=False
        )
        reached = {
            "lifts": run.stack is not None and bool(run.stack.rocked),
            "tilt": run.peak_tilt_ratio > tilt or run.outcome == FALLS[1],
            "stroke": run.peak_base_displacement > farthest,
            **{fall: run.outcome == fall for fall in FALLS},
        }
        rows.append([*(reached.get(state, False) for state in LIMIT_STATES), not run.failure])
    return np.array(rows), np.zeros(len(rows), dtype=bool)


def nearby(scene: Scene, *, workers: int | None = None) -> tuple[np.ndarray, Outcomes]:
    """Return (relative changes of the motion from -SHARE to SHARE, shape (n,), 0 in the middle; their `Outcomes`).

    Raises
    ------
    SceneError
        The scene takes too many steps for so many runs.
    """
    count = round(SHARE / STEP)
    changes = STEP * np.arange(-count, count + 1)
    check_cost(scene, len(changes), NEARBY_STEPS)
    return changes, simulate_many([scene] * len(changes), scales=1 + changes, workers=workers)


def cliffs(scene: Scene, changes: np.ndarray, outcomes: Outcomes) -> tuple[Caution, ...]:
    """Warn if a change of the motion below `SHARE` changes the outcome, or the peak tilt by a factor of `FOLD`.

    changes, outcomes : results of `nearby`. The value of a `Caution` is the smallest such change.
    """
    centre = len(changes) // 2
    names, ratios = outcomes.names, outcomes.peak_tilt / scene.block.slenderness
    cautions = []
    changed = _nearest(changes, names != names[centre])
    if changed is not None:
        instead = "the analytic model fails" if names[changed] == "failed" else f"it {names[changed]}"
        text = (
            f"The outcome is sensitive to changes of the motion below {SHARE:.0%}: the block {names[centre]}, but at "
            f"{changes[changed]:+.2%} {instead}."
        )
        cautions.append(Caution("motion", text, "outcome", float(changes[changed]), SHARE))
    upright = ~np.isin(names, (*FALLS, "failed"))
    low, high = np.minimum(ratios, ratios[centre]), np.maximum(ratios, ratios[centre])
    apart = _nearest(changes, upright & upright[centre] & (high >= np.maximum(FOLD * low, SEEN)))
    if apart is not None:
        text = (
            f"The peak tilt is sensitive to changes of the motion below {SHARE:.0%}: {ratios[centre]:.3g} of the "
            f"slenderness, but {ratios[apart]:.3g} at {changes[apart]:+.2%}."
        )
        cautions.append(Caution("motion", text, "peak tilt", float(changes[apart]), SHARE))
    return tuple(cautions)


def _nearest(changes: np.ndarray, selected: np.ndarray) -> int | None:
    """Return the index of the smallest of the selected changes, None without any. selected : bool, shape of changes."""
    return min(np.flatnonzero(selected).tolist(), key=lambda index: (abs(changes[index]), changes[index]), default=None)
