"""Scan of period and damping of the bearings of a scene under all its motions.

Bearings are suitable if the block does not lift (or its tilt stays below a limit), if it does not slide where the scene
gives a friction, and if the base stays within the stroke. Their demand is 1 at the limit. It is the largest of these
ratios:

- without a tilt limit the friction demand over tan(gamma), that is, base acceleration over uplift acceleration; with
  one the peak tilt over it;
- friction demand over the friction, where one is given;
- peak base displacement over the stroke.

The friction demand is that of a block that does not slide.

A first stroke is estimated by the displacement spectrum of the linear oscillator x'' + 2 zeta omega x' + omega^2 x
= -a_g.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from numba import njit

from ..batch import Outcomes, simulate_many
from ..errors import SceneError, SettingError, require
from ..kernel.compiled import inlined, inner
from ..motion import SampledMotion
from ..rocking import design_bearings
from ..scene import Bearings, Scene, refuse_free

if TYPE_CHECKING:
    import numpy.typing as npt

    from ..motion import Motion

PULSE_INTERVALS = 4000  # of a pulse; its interpolation error is then below 1e-6 of the amplitude


def displacement_spectrum(
    motion: Motion, periods: npt.ArrayLike, damping_ratios: npt.ArrayLike, *, scale: float = 1.0
) -> np.ndarray:
    """Return the largest |x| [m] of linear oscillators that start at rest, with the free vibration after the motion.

    Exact for acceleration that is linear between samples (N. C. Nigam and P. C. Jennings 1969, Bull. Seismol. Soc.
    Am. 59(2), 909-922); maxima between samples are located. A pulse is sampled at `PULSE_INTERVALS` intervals.

    Parameters
    ----------
    motion : SampledMotion or PulseMotion
    periods : array, shape (n,)
        Undamped natural periods [s], above 0.
    damping_ratios : array, shape (k,)
        Damping over critical damping, in [0, 1).
    scale : float
        Factor on the acceleration.

    Returns
    -------
    array, shape (k, n)
        [m].

    Raises
    ------
    SettingError
        A period or a damping ratio is out of range.
    """
    periods = np.atleast_1d(np.asarray(periods, dtype=float))
    ratios = np.atleast_1d(np.asarray(damping_ratios, dtype=float))
    require(np.isfinite(periods).all() and (periods > 0).all(), "periods must be finite and above 0 s")
    require(
        ((ratios >= 0) & (ratios < 1)).all(),
        "damping ratios must be in [0, 1): only oscillators that oscillate are covered",
    )
    if isinstance(motion, SampledMotion):
        dt, samples = motion.dt, motion.samples
    else:
        dt = motion.length / PULSE_INTERVALS
        inside = np.clip(motion.start + dt * np.arange(PULSE_INTERVALS + 1), motion.start, motion.end)
        samples = motion.acceleration(inside)
    return _spectrum(dt, samples * scale, 2 * math.pi / periods, ratios)


@inlined
def _advance(state, load, oscillator, over):
    """Return the state (x, v) after h under the acceleration a + slope tau.

    over : exp(-zeta w h), cos and sin of wd h, h.
    """
    (x, v), (a, slope), (w, zeta, wd), (decay, c, s, h) = state, load, oscillator, over
    drift = -slope / (w * w)  # particular solution: offset + drift tau
    offset = -a / (w * w) + 2 * zeta * slope / (w * w * w)
    x, v = x - offset, v - drift
    return (
        decay * (x * c + (v + zeta * w * x) / wd * s) + offset + drift * h,
        decay * (v * c - (zeta * w * v + w * w * x) / wd * s) + drift,
    )


@inner
def _largest_inside(state, load, oscillator, h):
    """Return |x| where the velocity changes sign between 0 and h, by bisection of the exact solution."""
    w, zeta, wd = oscillator
    low, high, displacement = 0.0, h, state[0]
    for _ in range(50):
        middle = 0.5 * (low + high)
        over = math.exp(-zeta * w * middle), math.cos(wd * middle), math.sin(wd * middle), middle
        displacement, speed = _advance(state, load, oscillator, over)
        if speed * state[1] > 0:
            low = middle
        else:
            high = middle
    return abs(displacement)


@inner
def _peak(dt, samples, w, zeta):
    wd = w * math.sqrt(1 - zeta * zeta)
    oscillator, over = (w, zeta, wd), (math.exp(-zeta * w * dt), math.cos(wd * dt), math.sin(wd * dt), dt)
    x, v, peak = 0.0, 0.0, 0.0
    for i in range(len(samples) - 1):
        load = samples[i], (samples[i + 1] - samples[i]) / dt
        x1, v1 = _advance((x, v), load, oscillator, over)
        if v * v1 < 0 and max(abs(x), abs(x1)) + dt * max(abs(v), abs(v1)) > peak:
            peak = max(peak, _largest_inside((x, v), load, oscillator, dt))
        x, v = x1, v1
        peak = max(peak, abs(x))
    if v != 0:  # free vibration: its first extreme, within half a damped period, is the largest
        peak = max(peak, _largest_inside((x, v), (0.0, 0.0), oscillator, math.pi / wd))
    return peak


@njit(cache=True, parallel=True)
def _spectrum(dt: float, samples: np.ndarray, frequencies: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    n = len(frequencies)
    peaks = np.empty((len(ratios), n))
    for k in numba.prange(len(ratios) * n):
        peaks[k // n, k % n] = _peak(dt, samples, frequencies[k % n], ratios[k // n])
    return peaks


PERIODS = (0.3, 5.0)  # s, secant at the stroke: the range for statues
DAMPINGS = (0.02, 0.5)  # equivalent damping at the stroke, over critical: rubber only, to more than lead provides
PERIOD_STEP, DAMPING_STEP = 0.01, 0.005  # relative, absolute: properties of bearings are not known better
CHUNK = 200  # runs between two reports of progress
LINEAR_DAMPING = 0.15  # of the bearings in `first_stroke`, as in `rocking new`
ROOM = 1.5  # factor on their displacement: yielding bearings need .9 to 1.2 of it (20 scenes)
LIMITS = ("model", "stroke", "slip", "tilt", "uplift")  # model: none is left, it jumps off its base or overturns
COARSE = 4  # step of the first scan, in these steps; cells that the limit may cross are run at every step


@dataclass(frozen=True, eq=False)
class BearingScan:
    """Results for bearings of each damping (rows) and period (columns) under the worst motion.

    periods [s], dampings [-] : shapes (p,), (d,). demand : (d, p), 1 at the limit, see the module; interpolated far
    from the limit. stroke [m] : (d, p), peak base displacement; NaN where nothing was run. designs : the bearings of
    each damping, for a period of 1 s.
    """

    periods: np.ndarray
    dampings: np.ndarray
    demand: np.ndarray
    stroke: np.ndarray
    designs: list[Bearings]

    def holds(self, period: float, damping: float) -> bool:
        """Return whether bearings of this period [s] and damping [-] are suitable; False outside the range scanned."""
        axes = self.dampings, np.log(self.periods)
        return bool(_on_grid(axes, self.demand, (damping, math.log(period)), outside=math.inf) <= 1)

    def bearings(self, period: float, damping: float) -> Bearings:
        """Return the bearings of a period [s] and one of the dampings scanned [-]."""
        return softened(self.designs[int(np.abs(self.dampings - damping).argmin())], period)

    def among(self, allowed: Callable[[Bearings], bool]) -> BearingScan:
        """Return the scan in which only bearings that are allowed are suitable; the same if none of these is."""
        nodes = np.array([[allowed(softened(design, period)) for period in self.periods] for design in self.designs])
        keeps = nodes | ~np.any(nodes & (self.demand <= 1) & ~np.isnan(self.stroke))
        return replace(self, demand=np.where(keeps, self.demand, np.inf))

    @property
    def least_stroke(self) -> tuple[float, float] | None:
        """Return (period, damping) of the suitable bearings with the least stroke; None without any."""
        return self._least(np.where(self.demand <= 1, self.stroke, np.nan))

    @property
    def softest(self) -> tuple[float, float] | None:
        """Return (period, damping) of the suitable bearings with the longest period; of several those of least stroke.

        None without any.
        """
        held = np.where(self.demand <= 1, self.stroke, np.nan)
        longest = self.periods[~np.isnan(held).all(axis=0)].max(initial=0.0)
        return self._least(np.where(self.periods == longest, held, np.nan))

    @property
    def nearest(self) -> tuple[float, float]:
        """Return (period, damping) of the bearings with the least demand, suitable or not."""
        point = self._least(np.where(np.isnan(self.stroke), np.nan, self.demand))
        assert point is not None  # the first scan ran some
        return point

    def _least(self, values):
        if np.isnan(values).all():
            return None
        row, column = np.unravel_index(np.nanargmin(values), values.shape)
        return float(self.periods[column]), float(self.dampings[row])


def first_stroke(scene: Scene, motions: Sequence[Motion]) -> float | None:
    """Return the first stroke [m] of a search, to two digits; None if suitable bearings are unlikely at any stroke.

    It is `ROOM` times the least displacement of linear bearings on which the block neither lifts nor, with a friction,
    slides under any motion.
    """
    periods = np.geomspace(*PERIODS, round(math.log(PERIODS[1] / PERIODS[0]) / PERIOD_STEP / COARSE))
    moved = np.max([displacement_spectrum(motion, periods, [LINEAR_DAMPING])[0] for motion in motions], axis=0)
    limit = min(math.tan(scene.block.slenderness), scene.friction or math.inf)
    held = moved[(2 * np.pi / periods) ** 2 * moved <= scene.gravity * limit]
    return float(f"{ROOM * held.min():.2g}") if len(held) else None


def softened(design: Bearings, period: float) -> Bearings:
    """Return bearings designed for 1 s, scaled to another period [s].

    At a given displacement forces scale with stiffness.
    """
    scaled = [name for name in ("ka", "kb", "yield_force") if getattr(design, name) is not None]
    return design.model_copy(update={name: design.given(name) / period**2 for name in scaled})


def scan_bearings(
    scene: Scene,
    motions: Sequence[Motion],
    stroke: float,
    *,
    tilt: float = 0.0,
    periods: tuple[float, float] = PERIODS,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    designer: Callable[..., Bearings] = design_bearings,
    **design: Any,
) -> BearingScan:
    """Run the scene on bearings of each period and damping under each of the motions.

    Parameters
    ----------
    scene : Scene
        With a base; its bearings, motion and duration are replaced.
    motions : sequence
        At least one.
    stroke : float
        Largest displacement of the base [m]; period and damping are those at this displacement.
    tilt : float
        Largest peak tilt over the slenderness; 0: the block must not lift.
    periods : (float, float)
        Range scanned [s].
    progress : callable or None
        Called with (runs done, all runs) in each of two scans.
    designer : callable
        Returns bearings for (mass, period, damping, x_max); their forces scale with 1/period^2.
    design : count, stiffness_ratio, definition
        Further arguments of the designer, see `design_bearings`.

    Raises
    ------
    SceneError
        The scene has no base.
    SettingError
        A number is out of range, there is no motion, or no bearings of any damping can be designed.
    """
    refuse_free(scene, "a search for bearings")
    _check(scene, motions, stroke, tilt, periods)
    dampings, designs = _designs(functools.partial(designer, scene.total_mass, x_max=stroke, **design))
    number = COARSE * math.ceil(math.log(periods[1] / periods[0]) / PERIOD_STEP / COARSE)
    columns = np.geomspace(*periods, number + 1)
    shape = len(dampings), len(columns)
    scan = BearingScan(columns, dampings, np.full(shape, np.nan), np.full(shape, np.nan), designs)

    def run(nodes):
        at = [scene.with_(bearings=softened(designs[i], columns[k]), duration=None) for i, k in np.argwhere(nodes)]
        scan.demand[nodes], scan.stroke[nodes] = _worst(scene, at, motions, stroke, tilt, workers, progress)

    coarse = np.zeros(shape, dtype=bool)
    coarse[::COARSE, ::COARSE] = True
    run(coarse)
    run(_crossed(scan.demand[::COARSE, ::COARSE], shape) & ~coarse)
    return replace(scan, demand=np.where(np.isnan(scan.stroke), _between(scan.demand), scan.demand))


def hardest(
    scene: Scene, bearings: Bearings, motions: Sequence[Motion], stroke: float, tilt: float
) -> tuple[str, Motion, float]:
    """Return (limit of LIMITS, motion, demand) of the largest demand on these bearings; see `scan_bearings`."""
    demands = []
    for motion in motions:
        run = simulate_many([scene.with_(bearings=bearings, motion=motion, duration=None)], contact=True)
        demand_by_limit = _demands(run, scene, stroke, tilt)
        demands += [(limit, motion, float(demand[0])) for limit, demand in demand_by_limit.items()]
    return max(demands, key=lambda row: row[2])


def _worst(scene, scenes, motions, stroke, tilt, workers, progress):
    """Return (demand, peak base displacement [m]) of each of the scenes, copies of `scene`, under its worst motion."""
    demand, moved, done = np.zeros(len(scenes)), np.zeros(len(scenes)), 0
    for motion in motions:
        for part in np.array_split(np.arange(len(scenes)), 1 + len(scenes) // CHUNK):
            outcomes = simulate_many([scenes[j].with_(motion=motion) for j in part], contact=True, workers=workers)
            moved[part] = np.maximum(moved[part], outcomes.peak_base_displacement)
            demand[part] = np.maximum.reduce([demand[part], *_demands(outcomes, scene, stroke, tilt).values()])
            done += len(part)
            if progress:
                progress(done, len(scenes) * len(motions))
    return demand, moved


def _demands(outcomes: Outcomes, scene: Scene, stroke: float, tilt: float) -> dict[str, np.ndarray]:
    """Return {name of LIMITS: demand of each run}; above 1 for "uplift" or "slip" where the block lifts or slides."""
    beyond = np.nextafter(1.0, 2.0)
    lost = outcomes.failed | outcomes.overturns | outcomes.fell_off if tilt else outcomes.failed
    demands = {"model": np.where(lost, math.inf, 0.0), "stroke": outcomes.peak_base_displacement / stroke}
    if scene.friction is not None:
        rubs = outcomes.friction_demand / scene.friction
        demands["slip"] = np.maximum(rubs, np.where(outcomes.slid, beyond, 0.0))
    if tilt:
        return {**demands, "tilt": outcomes.peak_tilt / scene.block.slenderness / tilt}
    uplift = outcomes.friction_demand / math.tan(scene.block.slenderness)
    return {**demands, "uplift": np.maximum(uplift, np.where(outcomes.lifted, beyond, 0.0))}


def _crossed(coarse: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return the nodes of the cells in which the demand may be 1.

    That is within the range of the demands at the corners, widened by its width on both sides.
    """
    corners = np.stack([coarse[:-1, :-1], coarse[1:, :-1], coarse[:-1, 1:], coarse[1:, 1:]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    with np.errstate(invalid="ignore"):  # infinite at all corners: no limit in the cell
        spread = high - low
        crossed = (low - spread <= 1) & (high + spread >= 1)
    nodes = np.zeros(shape, dtype=bool)
    for i, k in np.argwhere(crossed):
        nodes[COARSE * i : COARSE * (i + 1) + 1, COARSE * k : COARSE * (k + 1) + 1] = True
    return nodes


def _between(demand: np.ndarray) -> np.ndarray:
    """Return the demand interpolated to every node from the first scan.

    An infinite one counts as the largest finite one.
    """
    coarse = demand[::COARSE, ::COARSE]
    finite = np.where(np.isinf(coarse), np.max(coarse, where=np.isfinite(coarse), initial=2.0), coarse)
    axes = tuple(np.arange(0, length, COARSE) for length in demand.shape)
    return _on_grid(axes, finite, tuple(np.indices(demand.shape)))


def _on_grid(
    axes: tuple[np.ndarray, ...], values: np.ndarray, place: tuple[Any, ...], outside: float | None = None
) -> np.ndarray:
    """Return values on a grid of these axes interpolated linearly to places; None: no place is outside."""
    from scipy.interpolate import RegularGridInterpolator  # slow to load: not with `analytic`

    return RegularGridInterpolator(axes, values, bounds_error=outside is None, fill_value=outside)(place)


def _designs(designer: Callable[..., Bearings]) -> tuple[np.ndarray, list[Bearings]]:
    """Return (evenly spaced dampings for which bearings exist, their designs for 1 s)."""

    def designed(damping):
        return designer(period=1.0, damping=float(damping))

    possible = []
    for damping in np.arange(DAMPINGS[0], DAMPINGS[1], DAMPING_STEP):
        try:
            designed(damping)
            possible.append(damping)
        except SettingError as error:
            problem = error
    if len(possible) < 2:
        raise SettingError(f"no bearings of {DAMPINGS[0]:g} to {DAMPINGS[1]:g} of critical damping: {problem}")
    number = COARSE * math.ceil((possible[-1] - possible[0]) / DAMPING_STEP / COARSE)
    dampings = np.linspace(possible[0], possible[-1], number + 1)
    return dampings, [designed(damping) for damping in dampings]


def _check(scene, motions, stroke, tilt, periods):
    if scene.base is None:
        raise SceneError("base", None, "missing; bearings need a base", "add a table [base] with its mass")
    require(motions, "no motion: give the scene one, or a folder of records")
    require(stroke > 0 and math.isfinite(stroke), f"stroke = {stroke!r}: give metres above 0")
    require(0 <= tilt <= 1, f"tilt = {tilt!r}: give a share of the slenderness, 0 (no lift) to 1")
    require(
        0 < periods[0] < periods[1] < math.inf, f"periods = {periods!r}: give two periods in s, the shorter one first"
    )
