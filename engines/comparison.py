"""Is an engine's run right? What it has other than the analytic model of the same scene, as data.

A `Difference` is one beyond its limit:

- outcome: another one, where both are decided.
- peak tilt, peak base displacement: by more than `PEAK` of the model's. A tilt below `LEAST_TILT` of the slenderness is
  compared as one of that size, a displacement below `LEAST_DISPLACEMENT` of R gamma likewise. Of a block that
  overturns, in either, peaks are not compared.
- restitution: an impact's rate after over rate before differs from that of the model's impact that matches it.
- missing or extra impacts: without a match. Two match that lie on one side, nearer to each other than to the next ones
  on that side; up to where a match is `OUT_OF_PHASE`. Impacts count from `COUNTED` of the largest rate of their run
  on, and from swings on of a tenth of `LEAST_TILT`: smaller ones an engine does not tell from the compliance of its
  contact.

A run cannot be compared where the model does not hold (N <= 0, a friction demand that no contact gives), or reaches no
end. Where it differs the model is run again with start, motion, slenderness and restitution changed by `CHANGE`: what
such a copy does, too, is no fault of the engine, and the run is "on an edge".
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from analytic import simulate
from analytic.errors import SceneError
from analytic.response import COMPARED, EDGE, Difference
from analytic.rocking import RockingModel, restitution

if TYPE_CHECKING:
    from analytic import Response, Scene

PEAK, RESTITUTION = 0.02, 0.01
LEAST_TILT, LEAST_DISPLACEMENT = 0.01, 1e-5
COUNTED = 0.1
FRICTION = 5.0  # what a scene without a coefficient has in every tuned variant: no sliding
CHANGE = 1e-4
OUT_OF_PHASE = 0.1  # of a swing: from an impact on that comes so much earlier or later, none is missed
LAST = 0.01  # of a rocking period before the end, in which an impact may come in one run and not in the other


def compare(scene: Scene, response: Response) -> Response:
    """An engine's response with its `differences` from the analytic model, and whether it is `comparable`.

    It costs .2 to 2 ms, some 10 ms where something differs; what has failed is not compared.
    """
    if response.failure:
        return response
    try:
        model = simulate(scene, history=False)
    except SceneError as error:
        return replace(response, comparable=f"the analytic model reaches no end: {error}")
    if why := _outside(scene, model):
        return replace(response, comparable=why)
    found = differences(scene, model, response)
    if not found:
        return replace(response, comparable=COMPARED)
    own = _off_edges(scene, model, response, found)
    return replace(response, differences=tuple(own or found), comparable=COMPARED if own else EDGE)


def differences(scene: Scene, model: Response, run: Response, until: float = math.inf) -> list[Difference]:
    """What a run has other than the model; impacts are compared up to the time `until` [s]."""
    found = []
    if _outcome(scene, run) != _outcome(scene, model) and run.decided and model.decided:
        found.append(Difference("outcome", run.outcome, model.outcome, None))
    if "overturns" not in (run.outcome, model.outcome):
        length = scene.block.radius * scene.block.slenderness
        for name, least in (
            ("peak_tilt", LEAST_TILT * scene.block.slenderness),
            ("peak_base_displacement", LEAST_DISPLACEMENT * length),
        ):
            here, there = getattr(run, name), getattr(model, name)
            if not abs(here - there) <= PEAK * max(there, least):  # not: NaN
                found.append(Difference(name, here, there, PEAK))
    return found + _impact_differences(scene, model, run, until)


def _impact_differences(scene, model, run, until):
    ours, theirs = _impacts(run), _impacts(model)
    until = min(until, model.end.time, run.end.time) - LAST * 2 * math.pi / scene.rocking_frequency
    wanted, partner = _matched(scene, theirs, ours, until)
    pairs, found = partner >= 0, []
    met, own = wanted[pairs], ours[partner[pairs]]
    here, there = own[:, 2] / own[:, 1], met[:, 2] / met[:, 1]
    if len(here):
        worst = int(np.argmax(np.abs(here - there)))
        if not abs(here[worst] - there[worst]) <= RESTITUTION:
            found.append(Difference("restitution", float(here[worst]), float(there[worst]), RESTITUTION))
    late = np.abs(own[:, 0] - met[:, 0]) > OUT_OF_PHASE * np.diff(met[:, 0], prepend=0.0)
    until = met[late, 0].min(initial=until)
    for name, one, other in (("missing_impacts", theirs, ours), ("extra_impacts", ours, theirs)):
        _, partner = _matched(scene, one, other, until)
        if (partner < 0).any():
            counted, matched = len(partner), int((partner >= 0).sum())
            here, there = (matched, counted) if name == "missing_impacts" else (counted, matched)
            found.append(Difference(name, here, there, 0.0))
    return found


def _impacts(response: Response) -> np.ndarray:
    """Rows of time, rate before and rate after."""
    rows = [(impact.time, impact.rate_before, impact.rate_after) for impact in response.impacts]
    return np.array(rows, dtype=float).reshape(-1, 3)


def _matched(scene: Scene, impacts: np.ndarray, others: np.ndarray, until: float) -> tuple[np.ndarray, np.ndarray]:
    """(those of `impacts` that count up to `until`, the index in `others` of each one's match, -1 without)."""
    partner = np.full(len(impacts), -1)
    for side in (-1.0, 1.0):
        mine, theirs = (np.flatnonzero(np.sign(rows[:, 1]) == side) for rows in (impacts, others))
        if not (len(mine) and len(theirs)):
            continue
        time, other = impacts[mine, 0], others[theirs, 0]
        nearest = np.searchsorted((other[1:] + other[:-1]) / 2, time)  # of the others to each of mine
        back = np.searchsorted((time[1:] + time[:-1]) / 2, other)
        mutual = back[nearest] == np.arange(len(mine))
        partner[mine[mutual]] = theirs[nearest[mutual]]
    counted = _counts(scene, impacts) & ~(impacts[:, 0] > until)
    return impacts[counted], partner[counted]


def _counts(scene: Scene, impacts: np.ndarray) -> np.ndarray:
    """Whether each impact counts. A NaN does: it must be found."""
    model = RockingModel.of(scene)
    before, after = np.abs(impacts[:, 1:]).T
    pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])
    least = math.sqrt(2 * pull * 0.1 * LEAST_TILT * model.gamma)  # rate at the impact of a swing that small
    small = (before < max(least, COUNTED * np.nanmax(before, initial=0.0))) | (np.fmax(before, after) < least)
    return ~small


def _outcome(scene: Scene, response: Response) -> str:
    """The outcome; a tilt that counts as none stands."""
    none = PEAK * LEAST_TILT * scene.block.slenderness
    return "stands" if response.outcome == "rocks" and response.peak_tilt < none else response.outcome


def _outside(scene: Scene, model: Response) -> str | None:
    """Why no run of a scene can be compared with the model's, or None."""
    if model.failure:
        return f"the analytic model fails: {model.failure.reason}"
    if not model.min_normal_ratio > 0:
        return "the normal force falls to 0 in the analytic model"
    limit = scene.friction or FRICTION
    if not model.friction_demand <= limit:
        return f"the friction demand is {model.friction_demand:.3g} in the analytic model, above {limit:g}"
    return None


def _off_edges(scene: Scene, model: Response, run: Response, found: list[Difference]) -> list[Difference]:
    """Those of the differences that no copy of the scene has."""
    edges, until = set(), math.inf
    for copy in near_copies(scene):
        other = simulate(copy, history=False)
        apart = {difference.quantity for difference in differences(scene, model, other)}
        edges |= apart & {"outcome", "peak_base_displacement"}
        if apart & {"outcome", "peak_tilt"}:
            edges.add("peak_tilt")
        until = min(until, _parting(scene, model, other))
    early = {difference.quantity for difference in _impact_differences(scene, model, run, until)}
    impacts = {"restitution", "missing_impacts", "extra_impacts"}
    return [one for one in found if one.quantity in early or one.quantity not in impacts | edges]


def _parting(scene: Scene, model: Response, other: Response) -> float:
    """Time [s] of the first impact that counts of either run without a match in the other; inf where all match."""
    times = [
        rows[partner < 0, 0].min(initial=math.inf)
        for rows, partner in (
            _matched(scene, _impacts(model), _impacts(other), math.inf),
            _matched(scene, _impacts(other), _impacts(model), math.inf),
        )
    ]
    return float(min(times))


def near_copies(scene: Scene) -> Iterator[Scene]:
    """The scene with its slenderness, restitution, motion or start changed by `CHANGE`, up and down."""
    for factor in (1 + CHANGE, 1 - CHANGE):
        yield scene.with_(block={"slenderness": scene.block.slenderness * factor})
    yield from changed_copies(scene, CHANGE).values()


def changed_copies(scene: Scene, change: float) -> dict[str, Scene]:
    """Scenes next to `scene`, by name: restitution, motion and start changed by +-change, relative."""
    copies = {}
    e, start = restitution(scene), scene.start
    for sign, word in ((1, "up"), (-1, "down")):
        factor = 1 + sign * change
        if 0 < e * factor <= 1:
            copies[f"restitution {word}"] = scene.with_(block={"restitution": e * factor})
        if scene.motion is not None:
            copies[f"motion {word}"] = scene.with_(motion=scene.motion.scaled(factor))
        changed = {name: getattr(start, name) * factor for name in type(start).model_fields}
        if changed != start.model_dump():
            copies[f"start {word}"] = scene.with_(start=changed)
    return copies
