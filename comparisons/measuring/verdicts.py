"""Is an engine's run of a scene right? Judged against the analytic model, from what `kept.keep` keeps of both.

`judge` tells it for the bench of the engines, `doubts` to a user of one run.

Off is a run with at least one finding, each further from the analytic model than its limit:

- restitution: an impact's rate after over rate before differs from the model's by more than RESTITUTION. Impacts count
  that meet at least RESOLVED of the largest rate of their run, and that lie between swings that would exceed
  LEAST_SWING of the slenderness with the ground at rest: smaller ones an engine does not tell from the compliance of
  its contact.
- tilt, displacement: a peak differs by more than PEAK of the model's. One below LEAST_TILT of the slenderness (the
  least tilt of the box) or LEAST_DISPLACEMENT of R gamma (3 micrometres for the Caryatid) counts as one of that size:
  a block that stands on compliant corners tilts a little.
- outcome: another one; "rocks" below LEAST_TILT is not told from "stands".
- lost impact: an impact of the model that counts has none in the engine on its side within half the intervals to the
  next ones on that side, before the first that the model itself loses for a relative change of 1e-4 of start,
  amplitude, slenderness or restitution: from there on the motion is not determined. Nor does one count that comes in
  the last EDGE of its swing before the run's end: the engine's may come right after it.

A block that overturns is judged up to its first passage of the slenderness, and by its outcome: falling, every block
loses the contact that the model assumes. A run cut short before its outcome is decided has none that could be another.

Three things are no fault of the engine, and each excuses as little as can be. *Left out* is a scene whose analytic run
has N <= 0 or a friction demand above FRICTION at the contact. *Ill-conditioned* is a peak that the analytic
model itself changes by more than PEAK for relative changes of 1e-4 of start, amplitude, slenderness or restitution: it
is compared up to the time where that begins. *Near a boundary* is an outcome that the model changes for a change of
1 % of start, amplitude or slenderness: it does not count, and peaks do only up to the time where those of the copies
with another outcome part by more than APART.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.rocking import RockingModel

from .horizon import LEAST, PERTURBATION, changed_copies, unsure_outcome
from .kept import GRID, RESOLVED, ends

if TYPE_CHECKING:
    from analytic import Response, Scene

RESTITUTION, PEAK, APART, EDGE = 1e-2, 0.02, 0.2, 1e-2
LEAST_TILT, LEAST_DISPLACEMENT, LEAST_SWING = 1e-4, 1e-5, 1e-3
FRICTION = 5.0  # of every engine's default, where the scene names none
SMALL, BOUNDARY = 1e-4, 1e-2  # relative changes of the copies
CLASSES = ("right", "right but warned", "off and warned", "failed and said", "off and silent", "left out")


def range_warnings(model: Mapping[str, Any], run: Mapping[str, Any]) -> list[str]:
    """The warnings of a run that are about the engine: those that the analytic model's run does not give as well."""
    known = {_cause(sentence) for sentence in model["warnings"]}
    return [sentence for sentence in run["warnings"] if _cause(sentence) not in known]


def _cause(sentence):
    return re.split(r"-?\d", sentence)[0]


def near_copies(scene: Scene) -> dict[str, Scene]:
    """{name: scene} of the copies that tell how well the peaks are determined."""
    return {f"{name}, {SMALL:g}": copy for name, copy in _copies(scene, SMALL).items()}


def boundary_copies(scene: Scene) -> dict[str, Scene]:
    """{name: scene} of the copies that tell whether another outcome is near."""
    return {name: copy for name, copy in _copies(scene, BOUNDARY).items() if not name.startswith("restitution")}


def _copies(scene, change):
    """`changed_copies`, and those of another slenderness."""
    return {
        **{
            f"slenderness {word}": scene.with_(block={"slenderness": scene.block.slenderness * (1 + sign * change)})
            for sign, word in ((1, "up"), (-1, "down"))
        },
        **changed_copies(scene, change),
    }


def rule(scene: Scene, model: Mapping[str, Any]) -> str | None:
    """Why a scene is left out, by the kept values of its analytic run, or None."""
    if model["normal"] is None or model["normal"] <= 0:
        return "N <= 0"
    limit = scene.friction or FRICTION
    if model["friction"] is None or model["friction"] > limit:
        return f"friction demand above {limit:g}"
    return None


def span(scene: Scene, model: Mapping[str, Any]) -> float:
    """Time [s] up to which a scene is judged: inf, or where a block that overturns first passes the slenderness."""
    return min(scene.duration, model["unstable"]) if model["outcome"] == "overturns" else math.inf


def findings(
    scene: Scene,
    model: Mapping[str, Any],
    run: Mapping[str, Any],
    until: float = math.inf,
    determined: float = math.inf,
) -> list[dict[str, Any]]:
    """What is off in a run up to the time `until` [s]: list of {quantity, error, limit}; both as kept by `keep`.

    determined: time [s] before which impacts are compared one by one.
    """
    wrong: list[dict[str, Any]] = []
    if _other(scene, model, run):
        wrong.append({"quantity": "outcome", "error": f"{run['outcome']}, not {model['outcome']}", "limit": None})
    for name, error in peak_errors(scene, model, run, until).items():
        if not error <= PEAK:  # not: NaN
            wrong.append({"quantity": name, "error": error, "limit": PEAK})
    error = restitution_error(scene, run, until)
    if not error <= RESTITUTION:
        wrong.append({"quantity": "restitution", "error": error, "limit": RESTITUTION})
    if lost := [time for time in lost_impacts(scene, model, run) if time <= until and time < determined]:
        wrong.append({"quantity": "lost impact", "error": len(lost), "limit": 0})
    return wrong


def _outcome(scene, kept):
    """The outcome as it is told from others; None while the block falls, with neither outcome certain."""
    if kept["outcome"] == "overturns":
        return "overturns"
    if not kept["decided"]:
        return None
    seen = kept["tilt"] is None or kept["tilt"] > LEAST_TILT * scene.block.slenderness
    return kept["outcome"] if seen else "stands"


def _other(scene, one, other):
    outcomes = {_outcome(scene, one), _outcome(scene, other)}
    return None not in outcomes and len(outcomes) > 1


def least(scene: Scene) -> dict[str, float]:
    """{peak: value below which it is not told from nothing}: [rad], [m]."""
    block = scene.block
    return {
        "tilt": LEAST_TILT * block.slenderness,
        "displacement": LEAST_DISPLACEMENT * block.radius * block.slenderness,
    }


def peak_errors(
    scene: Scene, model: Mapping[str, Any], run: Mapping[str, Any], until: float = math.inf
) -> dict[str, float]:
    """{"tilt", "displacement": |difference| of the peaks up to `until` over the model's}."""
    last = _last(scene, until)
    errors = {}
    for name, floor in least(scene).items():
        wanted, got = (
            kept[name] if last is None or kept[name] is None else kept[f"{name}s"][last] if last >= 0 else 0.0
            for kept in (model, run)
        )
        errors[name] = math.nan if got is None else abs(max(got, floor) / max(wanted, floor) - 1)
    return errors


def _last(scene, until):
    """Index of the last growing peak up to `until`; -1 where there is none, None where all count."""
    return None if until > scene.duration else math.floor(until / scene.duration * GRID * (1 + 1e-9)) - 1


def resolved(scene: Scene, kept: Mapping[str, Any], until: float = math.inf) -> np.ndarray:
    """The impacts, rows of time, rate before and after, that count, up to `until`."""
    model, impacts = RockingModel.of(scene), np.array(kept["impacts"], dtype=float).reshape(-1, 3)
    before, after = np.abs(impacts[:, 1:]).T
    pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])
    least = math.sqrt(2 * pull * LEAST_SWING * model.gamma)
    least_before = max(least, RESOLVED * np.nanmax(before, initial=0.0))
    # A NaN counts: it must be found. So does a swing that is there and should not be.
    small = (before < least_before) | (np.maximum(after, model.restitution * before) < least)
    return impacts[~small & ~(impacts[:, 0] > until)]


def restitution_error(scene: Scene, run: Mapping[str, Any], until: float = math.inf) -> float:
    """Largest |e - eq. (7)| of the impacts that count; 0 without any."""
    impacts = resolved(scene, run, until)
    if not len(impacts):
        return 0.0
    expected = RockingModel.of(scene).restitution
    with np.errstate(invalid="ignore", divide="ignore"):
        return float(np.abs(impacts[:, 2] / impacts[:, 1] - expected).max())


def lost_impacts(scene: Scene, model: Mapping[str, Any], run: Mapping[str, Any]) -> list[float]:
    """Times [s] of the model's impacts that count and have none in the run."""
    wanted, lost = resolved(scene, model), []
    own = np.array(run["impacts"], dtype=float).reshape(-1, 3)
    every = np.array(model["impacts"], dtype=float).reshape(-1, 3)
    for time, before, _ in wanted:
        swing = time - every[every[:, 0] < time, 0].max(initial=0.0)
        if not (every[:, 0] > time).any() and scene.duration - time < EDGE * swing:
            continue
        side, near = (one[np.sign(one[:, 1]) == np.sign(before), 0] for one in (every, own))
        low = (time + side[side < time].max(initial=-math.inf)) / 2
        high = (time + side[side > time].min(initial=math.inf)) / 2
        if not ((near >= low) & (near <= high)).any():
            lost.append(float(time))
    return lost


def parting(scene: Scene, model: Mapping[str, Any], copies: Iterable[Mapping[str, Any]], share: float) -> float:
    """Time [s] up to which no copy's peaks part from the model's by more than a share; inf where none ever does."""
    first, piece = math.inf, scene.duration / GRID  # type: ignore[operator]  # scenes of the box have one
    for copy in copies:
        if copy["outcome"] == "failed":
            continue
        for name, floor in least(scene).items():
            other, own = (np.maximum([*kept[f"{name}s"], kept[name]], floor) for kept in (copy, model))
            beyond = np.flatnonzero(np.abs(other / own - 1) > share)
            if len(beyond) and beyond[0] < GRID:
                first = min(first, beyond[0] * piece)
            elif len(beyond):
                first = min(first, (GRID - 1) * piece)
    return first


def judge(
    scene: Scene,
    model: Mapping[str, Any],
    run: Mapping[str, Any],
    small: Mapping[str, Mapping[str, Any]],
    large: Mapping[str, Mapping[str, Any]],
    until: float = math.inf,
) -> tuple[list[dict[str, Any]], list[str]]:
    """(findings, notes) of a run; small, large: kept values of the near and the boundary copies, until: as `findings`.

    notes: "ill-conditioned" or "near a boundary" where these took something from the comparison.
    """
    if not findings(scene, model, run, until):
        return [], []
    determined = min((time for copy in small.values() for time in lost_impacts(scene, model, copy)), default=math.inf)
    wrong = findings(scene, model, run, until, determined)
    if not wrong:
        return wrong, ["ill-conditioned"]
    notes, apart = [], parting(scene, model, small.values(), PEAK)
    others = [copy for copy in [*small.values(), *large.values()] if _other(scene, copy, model)]
    if others and any(finding["quantity"] == "outcome" for finding in wrong):
        notes, apart = ["near a boundary"], min(apart, parting(scene, model, others, APART))
    elif apart < until:
        notes = ["ill-conditioned"]
    until = min(until, apart)
    if notes:
        wrong = [
            finding
            for finding in findings(scene, model, run, until, determined)
            if finding["quantity"] != "outcome" or "near a boundary" not in notes
        ]
    return wrong, notes


def doubts(scene: Scene, response: Response, model: Response) -> Iterator[str]:
    """Sentences for whoever sees this response alone: where the analytic model says otherwise, and where the model's
    own outcome hangs on a change as small as a good solver's errors. model: its response, or `response` itself."""
    if model is not response:
        yield from off_the_model(scene, response, model)
    if response.decided:
        yield from unsure_outcome(scene, model.outcome, LEAST if model is response else PERTURBATION)


def off_the_model(scene: Scene, response: Response, model: Response) -> Iterator[str]:
    """One sentence on what `findings` finds in an engine's response, or none; nothing is excused.

    Of a block that overturns, in either, no peaks are compared, and of the model's, impacts up to the unstable point.
    """
    until: float = model.unstable_time if model.outcome == "overturns" else math.inf  # type: ignore[assignment]  # it fell
    run, wanted = (
        {**ends(one), "impacts": [(at.time, at.rate_before, at.rate_after) for at in one.impacts if at.time <= until]}
        for one in (response, model)
    )
    ended = scene if scene.duration is not None else scene.with_(duration=model.end.time)
    falls = "overturns" in (response.outcome, model.outcome)
    words = {
        "outcome": f"its block {model.outcome}",
        "tilt": f"its peak tilt is {model.peak_tilt:.3g} rad, here {response.peak_tilt:.3g}",
        "displacement": f"its peak displacement is {model.peak_base_displacement:.3g} m, here "
        f"{response.peak_base_displacement:.3g}",
        "restitution": "its e is {expected:.3f} at every impact, here off by up to {error:.2g}",
        "lost impact": "impacts of it that are missing here: {error}",
    }
    parts = [
        words[finding["quantity"]].format(expected=RockingModel.of(scene).restitution, error=finding["error"])
        for finding in findings(ended, wanted, run)
        if not (falls and finding["quantity"] in least(scene))
    ]
    if parts:
        yield f"the analytic model says otherwise: {'; '.join(parts)}; see rocking compare"
