"""Which bearings does a scene need? Period and damping are scanned under all its motions.

Bearings hold where the block does not lift (or its tilt stays below a limit) and the base stays within the stroke.
Their demand is 1 at the limit: the larger of friction demand/tan(gamma), the acceleration at the block's foot over
that of uplift (or of peak tilt over its limit), and of peak base displacement over the stroke.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from .batch import simulate_many
from .design import design_bearings
from .errors import SceneError, SettingError
from .scene import Bearings, Scene

if TYPE_CHECKING:
    from .types import Motion

PERIODS = (0.3, 5.0)  # s, secant at the stroke: those of a statue's bearings
DAMPINGS = (0.02, 0.5)  # share of critical, equivalent, at the stroke: rubber alone to more than lead gives
PERIOD_STEP, DAMPING_STEP = 0.01, 0.005  # relative, absolute: what bearings are never known better than
COARSE = 4  # of these steps, of the first scan; cells that the limit may cross are run at every step


@dataclass(frozen=True, eq=False)
class BearingScan:
    """What bearings of each damping (rows) and period (columns) do under the worst of the motions.

    periods [s], dampings [-] : shapes (p,), (d,). demand : (d, p), 1 at the limit, see above; interpolated where the
    limit is far. stroke [m] : (d, p), peak base displacement; NaN where nothing was run. made : (period, damping) ->
    `Bearings`.
    """

    periods: np.ndarray
    dampings: np.ndarray
    demand: np.ndarray
    stroke: np.ndarray
    made: Callable[[float, float], Bearings]

    def holds(self, period: float, damping: float) -> bool:
        """Whether bearings of this period [s] and damping [-] hold; False outside the range scanned."""
        axes = self.dampings, np.log(self.periods)
        found = RegularGridInterpolator(axes, self.demand, bounds_error=False, fill_value=math.inf)
        return bool(found((damping, math.log(period))) <= 1)

    @property
    def least_stroke(self) -> tuple[float, float] | None:
        """(period, damping) of those run that hold with the least stroke; None where none holds."""
        return self._first(self.stroke)

    @property
    def softest(self) -> tuple[float, float] | None:
        """(period, damping) of the longest period that holds, there of the least stroke; None where none holds."""
        held = ~np.isnan(self.stroke) & (self.demand <= 1)
        longest = self.periods[held.any(axis=0)].max(initial=0.0)
        return self._first(np.where(self.periods == longest, self.stroke, np.nan))

    @property
    def nearest(self) -> tuple[float, float]:
        """(period, damping) of the least demand, whether it holds or not."""
        row, column = np.unravel_index(
            np.nanargmin(np.where(np.isnan(self.stroke), np.nan, self.demand)), self.demand.shape
        )
        return float(self.periods[column]), float(self.dampings[row])

    def _first(self, order):
        order = np.where(self.demand <= 1, order, np.nan)
        if np.isnan(order).all():
            return None
        row, column = np.unravel_index(np.nanargmin(order), order.shape)
        return float(self.periods[column]), float(self.dampings[row])


def scan_bearings(
    scene: Scene,
    motions: Sequence[Motion],
    stroke: float,
    *,
    tilt: float = 0.0,
    count: int = 4,
    stiffness_ratio: float = 10.0,
    definition: str = "equivalent",
    periods: tuple[float, float] = PERIODS,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
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
    count, stiffness_ratio, definition
        Of the bearings, see `design_bearings`.
    periods : (float, float)
        Range scanned [s].
    progress : callable or None
        Is told (runs done, runs known of).

    Raises
    ------
    SceneError
        The scene has no base.
    SettingError
        A number is out of range, there is no motion, or no bearings of any damping can be designed.
    """
    _check(scene, motions, stroke, tilt, periods)
    dampings, unit = _designs(scene.total_mass, stroke, count, stiffness_ratio, definition)
    number = COARSE * math.ceil(math.log(periods[1] / periods[0]) / PERIOD_STEP / COARSE)
    columns = np.geomspace(*periods, number + 1)
    shape = len(dampings), len(columns)
    demand, moved = np.full(shape, np.nan), np.full(shape, np.nan)
    limit, runs = math.tan(scene.block.slenderness), {"done": 0, "known": 0}

    def made(period: float, damping: float) -> Bearings:
        row = int(np.abs(dampings - damping).argmin())
        exact = dampings[row] == damping
        one = unit[row] if exact else _design(scene.total_mass, stroke, damping, count, stiffness_ratio, definition)
        softer = 1 / period**2  # of a design for 1 s: forces at one displacement go with the stiffness
        return one.model_copy(update={"ka": one.ka * softer, "kb": one.given("kb") * softer})

    def run(wanted: np.ndarray) -> None:
        places = np.argwhere(wanted & np.isnan(demand))
        scenes = [scene.with_(bearings=made(columns[k], dampings[i]), duration=None) for i, k in places]
        worst, peak = np.zeros(len(places)), np.zeros(len(places))
        runs["known"] += len(places) * len(motions)
        for motion in motions:
            for part in np.array_split(np.arange(len(places)), max(1, len(places) // 200)):
                found = simulate_many([scenes[j].with_(motion=motion) for j in part], contact=True, workers=workers)
                lift = found.friction_demand / limit if tilt == 0 else found.peak_tilt / scene.block.slenderness / tilt
                lift = np.where(found.failed | (tilt > 0) & found.overturns, math.inf, lift)
                lift = np.where((tilt == 0) & found.lifted, np.maximum(lift, np.nextafter(1.0, 2.0)), lift)
                worst[part] = np.maximum.reduce([worst[part], lift, found.peak_base_displacement / stroke])
                peak[part] = np.maximum(peak[part], found.peak_base_displacement)
                runs["done"] += len(part)
                if progress:
                    progress(runs["done"], runs["known"])
        demand[tuple(places.T)], moved[tuple(places.T)] = worst, peak

    first = np.zeros(shape, dtype=bool)
    first[::COARSE, ::COARSE] = True
    run(first)
    rows = np.arange(0, shape[0], COARSE), np.arange(0, shape[1], COARSE)
    coarse = demand[::COARSE, ::COARSE]
    run(_crossed(coarse, shape))
    finite = np.where(np.isinf(coarse), np.max(coarse, where=np.isfinite(coarse), initial=2.0), coarse)
    between = RegularGridInterpolator(rows, finite)(tuple(np.indices(shape)))
    return BearingScan(columns, dampings, np.where(np.isnan(demand), between, demand), moved, made)


def _crossed(coarse: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """The nodes of cells in which the demand may be 1: it is within the corners' values, widened by their spread."""
    corners = np.stack([coarse[:-1, :-1], coarse[1:, :-1], coarse[:-1, 1:], coarse[1:, 1:]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    with np.errstate(invalid="ignore"):  # infinite at all corners: the limit is not there
        spread = high - low
        crossed = (low - spread <= 1) & (high + spread >= 1)
    wanted = np.zeros(shape, dtype=bool)
    for i, k in np.argwhere(crossed):
        wanted[COARSE * i : COARSE * (i + 1) + 1, COARSE * k : COARSE * (k + 1) + 1] = True
    return wanted


def _designs(mass, stroke, count, ratio, definition):
    """(the dampings of which there are bearings, those for a period of 1 s)."""

    def design(damping):
        return _design(mass, stroke, damping, count, ratio, definition)

    made = []
    for damping in np.arange(DAMPINGS[0], DAMPINGS[1], DAMPING_STEP):
        try:
            design(float(damping))
            made.append(float(damping))
        except SettingError as error:
            problem = error
    if len(made) < 2:
        raise SettingError(f"no bearings of {DAMPINGS[0]:g} to {DAMPINGS[1]:g} of critical damping: {problem}")
    number = COARSE * math.ceil((made[-1] - made[0]) / DAMPING_STEP / COARSE)
    dampings = np.linspace(made[0], made[-1], number + 1)
    return dampings, [design(float(damping)) for damping in dampings]


def _design(mass, stroke, damping, count, ratio, definition):
    return design_bearings(mass, 1.0, damping, stroke, count=count, stiffness_ratio=ratio, definition=definition)


def _check(scene, motions, stroke, tilt, periods):
    if scene.base is None:
        raise SceneError("base", None, "missing; bearings carry a base", "add a table [base] with its mass")
    if not motions:
        raise SettingError("no motion: give the scene one, or a folder of records")
    if not (stroke > 0 and math.isfinite(stroke)):
        raise SettingError(f"stroke = {stroke!r}: give metres above 0")
    if not 0 <= tilt <= 1:
        raise SettingError(f"tilt = {tilt!r}: give a share of the slenderness, 0 (no lift) to 1")
    if not 0 < periods[0] < periods[1] < math.inf:
        raise SettingError(f"periods = {periods!r}: give two periods in s, the shorter one first")
