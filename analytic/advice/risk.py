"""Odds of a scene whose values are uncertain, under many motions: how often it lifts, exceeds x_max, overturns.

Slenderness, restitution, friction and the stiffnesses of the bearings are drawn about their values in the scene, anew
for each record, and each drawn scene is run under the motions of that record. Draws are independent: the mean of one
record is an independent sample of the probability, whatever its draws have in common. All bearings of a scene are
alike, as they come from one batch.

The restitution is drawn from a normal distribution, cut at 0 and 1; where the scene does not give it, it is drawn about
that of eq. (7) for the drawn slenderness. All other quantities are lognormal, with the scene's value as the median.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import compress
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import ndtr, ndtri

from ..batch import Outcomes, simulate_many
from ..errors import SceneError, require
from ..scene import Scene, refuse_free
from ..solver import simulate
from .margins import QUANTITIES, check_cost, limit_states, why_it_fails

if TYPE_CHECKING:
    from ..motion import Motion

DRAWS = 40  # for each record: more records narrow the interval more than more draws do
LARGEST_SPREAD = 0.5
MOST_RUNS = 1_000_000
SHARES = (0.5, 0.95, 1.0)  # of runs, for the quantiles of slip and base displacement
SURE = 3.0  # standard errors beyond which an effect is no noise


@dataclass(frozen=True)
class Spread:
    """The uncertainty of a quantity: its coefficient of variation [-], and where that comes from."""

    size: float
    source: str


SPREADS = {
    "slenderness": Spread(0.03, "assumed: the centre of mass and the worn edges of a statue are not known better"),
    "restitution": Spread(
        0.03, "assumed; tests on concrete gave 0.95 to 0.97 of eq. (7) (ElGawady et al., doi:10.1201/9781003060888-45)"
    ),
    "friction": Spread(0.15, "assumed: a coefficient that was estimated, not measured"),
    "ka": Spread(
        0.075,
        "assumed: two standard deviations are a tolerance of 15 %; tests of one type scattered by 0.9 to 5.6 % "
        "(Wu et al. 2022, doi:10.3390/ma15228031)",
    ),
    "kb": Spread(0.075, "as that of ka"),
}
# {one of LIMIT_STATES: whether the runs of a scene reach it}, the gravest first
REACHED: dict[str, Callable[[Outcomes, Scene], np.ndarray]] = {
    "overturns": lambda outcomes, scene: outcomes.overturns,
    "falls off": lambda outcomes, scene: outcomes.fell_off,
    "stroke": lambda outcomes, scene: outcomes.peak_base_displacement > scene.bearings.x_max,  # type: ignore[union-attr]  # only called where there is one
    "lifts": lambda outcomes, scene: outcomes.lifted | outcomes.overturns,
    "slides": lambda outcomes, scene: outcomes.slid,
}


@dataclass(frozen=True, eq=False)
class Risk:
    """Results of the draws of a scene under many records.

    spreads: {quantity drawn: its coefficient of variation}. scores: (records, draws, quantities), the standard normal
    number from which each value was drawn. runs: (records, draws), number of motions under which a draw has an outcome;
    runs that failed count neither way. reached: {limit state: under how many of these it is reached}, (records, draws).
    why: the reason of the first failure, or "". travel: {"slip" of the block, "base": quantiles `SHARES` of the largest
    displacement [m] in runs that stay upright}; without what the scene cannot have.
    """

    spreads: dict[str, float]
    scores: np.ndarray
    runs: np.ndarray
    reached: dict[str, np.ndarray]
    why: str
    travel: dict[str, tuple[float, float, float]]

    def by_record(self, state: str) -> np.ndarray:
        """Return the probability of a limit state under each record, shape (records,); NaN where all runs failed."""
        with np.errstate(invalid="ignore"):
            return self.reached[state].sum(axis=1) / self.runs.sum(axis=1)

    def effects(self, state: str) -> dict[str, tuple[float, float]]:
        """Return {quantity: (change of the probability of a limit state, the noise of that)}.

        The change is that for a value higher by one spread, on average over the draws, which is the covariance of
        outcome and normal score (Stein 1981). A change within the noise, `SURE` standard errors, may be chance.
        """
        known, draws = self.runs > 0, self.runs.shape[1]
        shares = self.reached[state] / np.maximum(self.runs, 1)
        from_mean = (shares - self.by_record(state)[:, None])[known] * draws / (draws - 1)
        products = self.scores[known] * from_mean[:, None]
        noise = SURE * products.std(axis=0) / np.sqrt(len(products))
        return dict(zip(self.spreads, zip(products.mean(axis=0), noise, strict=True), strict=True))


def spreads_of(scene: Scene, given: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return {quantity: coefficient of variation} of what is drawn: of `SPREADS`, or as given; 0 switches one off.

    Raises
    ------
    SettingError
        The scene has no such quantity that is drawn, or a coefficient is out of range.
    """
    sizes = {name: spread.size for name, spread in SPREADS.items() if QUANTITIES[name].value(scene) is not None}
    for name, size in (given or {}).items():
        words = f"spread = {name}={size}"
        require(name in sizes, f"{words}: nothing that is drawn for this scene; choose {', '.join(sizes)}")
        possible = isinstance(size, int | float) and 0 <= size <= LARGEST_SPREAD
        require(possible, f"{words}: give a coefficient of variation from 0 to {LARGEST_SPREAD:g}")
    return {name: float(size) for name, size in {**sizes, **(given or {})}.items() if size}


def risk(
    scene: Scene,
    records: Sequence[Sequence[Motion | None]],
    *,
    draws: int = DRAWS,
    spreads: Mapping[str, float] | None = None,
    seed: int = 0,
    scale: float = 1.0,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Risk:
    """Return the `Risk` of a scene: `draws` scenes for each record, under each motion of that record.

    Equal seeds give equal draws, on any number of threads; a quantity's draws do not depend on the other spreads.

    Parameters
    ----------
    records : sequence of sequences
        The motions of each record, which replace the scene's; [None] is a run without a motion.
    draws : int
        At least 2, with at most `MOST_RUNS` runs in all.
    spreads : mapping or None
        See `spreads_of`.
    seed : int
        From 0 on.
    scale : float
        Factor on all motions.
    progress : callable or None
        Called with (runs done, all runs).

    Raises
    ------
    SettingError
        A number is out of range.
    SceneError
        The scene cannot be run, or is too stiff or too long for so many runs; the message names the part.
    """
    refuse_free(scene, "odds")
    total = draws * sum(map(len, records))
    require(draws >= 2 and total <= MOST_RUNS, f"draws = {draws}: give at least 2, and at most {MOST_RUNS} runs in all")
    require(seed >= 0, f"seed = {seed}: give a whole number from 0 on")
    sizes, scene = spreads_of(scene, spreads), scene.with_(duration=None)
    longest = max((motion for motions in records for motion in motions), key=lambda motion: motion.end if motion else 0)
    check_cost(scene.with_(motion=longest, friction=None), total)  # a friction may be refused for some draws only
    states = [state for state in REACHED if state in limit_states(scene)]
    scores = np.stack([_scores(seed, record, draws, sizes) for record in range(len(records))])
    runs, hits, why = np.zeros(scores.shape[:2], dtype=int), np.zeros((len(states), *scores.shape[:2])), ""
    moved: list[list[np.ndarray]] = [[] for _ in records]

    def run(record):
        motions = records[record]
        drawn, why = _drawn(scene.with_(motion=motions[0]), sizes, scores[record])
        for motion in motions:
            scenes = [each if motion is motions[0] else each.with_(motion=motion) for each in drawn.values()]
            outcomes = simulate_many(
                scenes, scales=np.full(len(scenes), scale), workers=workers if len(records) == 1 else 1
            )
            sound = ~outcomes.failed & outcomes.decided
            places = np.array([*drawn], dtype=int)[sound]
            runs[record, places] += 1
            hits[:, record, places] += [REACHED[state](outcomes, scene)[sound] for state in states]
            upright = sound & ~outcomes.overturns & ~outcomes.fell_off
            moved[record].append(np.stack([outcomes.peak_slip, outcomes.peak_base_displacement])[:, upright])
            why = why or next(map(why_it_fails, compress(scenes, ~sound)), "")
        return why

    # Records in parallel: drawing scenes takes a fifth of the time, for which the threads of a batch would wait.
    with ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        for record, reason in enumerate(pool.map(run, range(len(records)))):
            why = why or reason
            if progress:
                progress(draws * sum(map(len, records[: record + 1])), total)
    if not runs.any():
        simulate(scene.with_(motion=longest), history=False)  # a refusal names the part
        raise SceneError("motion", None, f"every run failed: {why}", "change the scene")
    peaks = np.concatenate([each for parts in moved for each in parts], axis=1)
    return Risk(sizes, scores, runs, dict(zip(states, hits, strict=True)), why, _travel(scene, peaks))


def _travel(scene, peaks):
    """Return the quantiles `SHARES` of the peaks of slip and base displacement, shape (2, runs); see `Risk`."""
    wanted = {"slip": scene.friction is not None, "base": scene.base is not None}
    return {
        name: tuple(np.quantile(values, SHARES).tolist())
        for (name, has), values in zip(wanted.items(), peaks, strict=True)
        if has and len(values)
    }


def _scores(seed, record, draws, names):
    """Return standard normal numbers, shape (draws, names). The raw stream is the same in all versions of numpy."""
    raw = np.random.PCG64([seed, record]).random_raw(draws * len(SPREADS)).reshape(draws, -1)
    columns = [[*SPREADS].index(name) for name in names]
    return ndtri(((raw[:, columns] >> np.uint64(11)) + 0.5) * 2.0**-53)


def _drawn(scene, sizes, scores):
    """Return ({draw: its scene}, why the first of the others is none, or "")."""
    drawn, refusal = {}, ""
    for draw, row in enumerate(scores.tolist()):
        each = scene
        try:
            for (name, size), score in zip(sizes.items(), row, strict=True):
                value = QUANTITIES[name].value(each)
                if value is not None:  # a stocky draw may have no restitution left
                    each = QUANTITIES[name].changed(each, _factor(name, value, size, score))
        except SceneError as error:
            refusal = refusal or str(error)
            continue
        drawn[draw] = each
    return drawn, refusal


def _factor(name, value, size, score):
    """Return the factor on the value of a quantity for a standard normal score."""
    if name != "restitution":
        return float(np.exp(np.sqrt(np.log1p(size**2)) * score))
    low, high = ndtr(-1 / size), ndtr((1 / value - 1) / size)
    return float(min(1 + size * ndtri(low + (high - low) * ndtr(score)), 1 / value))
