"""Differences between an engine's run and the analytic model's run of the same scene.

A `Difference` is reported where a limit is exceeded:

- outcome: it differs as tables tell it, and both runs are decided.
- peak tilt, of a block that stays upright, and peak base displacement: by more than `PEAK` of the model's. A tilt below
  `LEAST_TILT` of the slenderness is compared as one of that size, and so is a displacement below `LEAST_DISPLACEMENT`
  of R gamma. If the block overturns, the displacement is the peak up to its last passage of the slenderness.
- last passage of the slenderness, of a block that overturns: its time by more than `FALL` of a rocking period
  2 pi/omega_r, or the number of impacts that count before it. An impact whose rate is within `PEAK` of counting may
  count or not.
- time of overturning, where the model overturns: by more than `FALL` of a period plus the time that the model takes
  from the loss of contact on (N <= 0, or a friction demand above the friction available). From there on the block of an
  engine slides or flies, and this time differs by up to a sixth.
- restitution: the ratio of the rates after and before an impact differs by more than `RESTITUTION` from that of the
  matching impact of the model. Where no impact exceeds this, the loss 1 - e^2 is compared, by `LOSS` of the model's,
  which is more sensitive for slender blocks. A loss below `LEAST_LOSS` is compared as one of that size. Of a block that
  slides into the impact it may be below 0, and is compared by its size.
- largest slip, of a block that stays upright in a scene with a friction: by more than `PEAK` of the model's, or
  `LEAST_SLIP` of R.
- missing or extra impacts: impacts without a match (`engines.events`), up to the first one that is `OUT_OF_PHASE`.

A run cannot be compared where the model does not hold (without a friction in the scene: N <= 0, or a friction demand
that no contact provides), or does not reach an end. The model is also run with start, motion, slenderness and
restitution changed by `copies.CHANGE`. Where such a copy differs from the model in the outcome, a peak or a time, the
scene is near an outcome boundary, for all engines alike; the stored value is "on an edge". There, an outcome that a
copy has is not a difference. Neither is a number within the range of the copies with the run's outcome, widened by the
limit. Impacts are compared up to the first one that the copies do not share.

Near copies of a scene: runs of them show how sensitive a result is to small changes of the scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from analytic import simulate
from analytic.errors import SceneError
from analytic.response import COMPARED, EDGE, JUDGED, LEVEL, UNCOMPARED, Difference
from analytic.rocking import restitution

from .checks import LEAST_SLIP
from .events import COUNTED, LEAST_TILT, STILL, at_contact, counts, impacts_of, matched, parting
from .loads import FRICTION
from .swings import Trace

if TYPE_CHECKING:
    from analytic import Response, Scene

CHANGE = 1e-4  # relative; errors of tuned engines are 1e-5 to 1e-4


def near_copies(scene: Scene) -> Iterator[Scene]:
    """The scene with its slenderness, restitution (or friction, if given), motion or start changed by +-`CHANGE`."""
    for factor in (1 + CHANGE, 1 - CHANGE):
        yield from _changed(scene, block={"slenderness": scene.block.slenderness * factor})
    yield from changed_copies(scene, CHANGE).values()


def changed_copies(scene: Scene, change: float) -> dict[str, Scene]:
    """{name: scene} with restitution (or friction, if given), motion and start changed by +-change, relative."""
    copies = {}
    e, start = restitution(scene), scene.start
    for sign, word in ((1, "up"), (-1, "down")):
        factor = 1 + sign * change
        if scene.friction is not None:  # a restitution that is given needs a corner that sticks
            copies[f"friction {word}"] = scene.with_(friction=scene.friction * factor)
        elif 0 < e * factor <= 1:
            copies[f"restitution {word}"] = scene.with_(block={"restitution": e * factor})
        if scene.motion is not None:
            copies[f"motion {word}"] = scene.with_(motion=scene.motion.scaled(factor))
        changed = {name: getattr(start, name) * factor for name in type(start).model_fields}
        if changed != start.model_dump():
            copies |= {f"start {word}": copy for copy in _changed(scene, start=changed)}
    return copies


def _changed(scene: Scene, **change: dict[str, float]) -> Iterator[Scene]:
    """The changed scene; none where the change leaves the range of a scene."""
    try:
        yield scene.with_(**change)
    except SceneError:
        return


PEAK, RESTITUTION, LOSS, FALL = 0.02, 0.01, 0.1, 0.02
LEAST_DISPLACEMENT = 1e-5
LEAST_LOSS = 0.02  # smallest of the statue range by eq. (7): slenderness .1, J_O = 2 m R^2, rigid ground
OUT_OF_PHASE = 0.1  # share of a swing by which an impact is early or late; no later impact counts as missing
LAST = 0.01  # share of a rocking period before the end in which an impact may occur in one run only
FALLS = "overturns"
END = {"outcome", "fall_time", "overturning_time", "impacts_before_fall"}  # quantities of the block's end
FALL_POINTS, MOST_POINTS = 200, 100_000  # samples of the last fall, and at most of the run up to its end


@dataclass(frozen=True)
class Reference:
    """The reference that all engines' runs of a scene are compared with.

    model: the analytic model's run. copies: runs of the near copies, empty where nothing can be compared. comparable:
    see `Response.comparable`. near: quantities in which a copy differs from the model, keys of `response.DIFFERENCES`.
    until: time [s] of the first impact that the copies do not share; inf where they share all.
    """

    model: Response | None = None
    copies: tuple[Response, ...] = ()
    comparable: str = UNCOMPARED
    near: frozenset[str] = frozenset()
    until: float = math.inf

    @classmethod
    def of(cls, scene: Scene, model: Response | None = None) -> Self:
        """The reference of a scene; it takes some ten runs of the model.

        model : the model's run of the scene itself, if known.
        """
        try:
            model = model or simulate(scene, history=False)
        except SceneError as error:
            return cls(comparable=f"the analytic model refuses the scene: {error}")
        if why := _outside(scene, model):
            return cls(model, comparable=why)
        try:
            copies = tuple(simulate(copy, history=False) for copy in near_copies(scene))
        except SceneError as error:
            return cls(model, comparable=f"the analytic model refuses a scene within {CHANGE:g} of it: {error}")
        near = frozenset(one.quantity for copy in copies for one in _numbers(scene, (model,), copy))
        until = min((parting(scene, model, copy) for copy in copies), default=math.inf)
        return cls(model, copies, EDGE if near else COMPARED, near, until)

    @property
    def end_comparable(self) -> str:
        """`comparable` for the block's end alone: "on an edge" only where the end of a copy differs."""
        return COMPARED if self.comparable == EDGE and not self.near & END else self.comparable


def compare(scene: Scene, response: Response, reference: Reference | None = None) -> Response:
    """An engine's response with its `differences` from the analytic model, and whether it is `comparable`.

    reference : of the scene, if known. A failed run is not compared.
    """
    if response.failure:
        return response
    reference = reference or Reference.of(scene)
    return replace(response, differences=differences(scene, reference, response), comparable=reference.comparable)


def differences(scene: Scene, reference: Reference, run: Response) -> tuple[Difference, ...]:
    """Differences of a run from its reference; none where it cannot be compared."""
    if reference.model is None or reference.comparable not in JUDGED:
        return ()
    known = (reference.model, *reference.copies)
    return (*_numbers(scene, known, run), *_impact_differences(scene, reference.model, run, reference.until))


def _numbers(scene: Scene, known: Sequence[Response], run: Response) -> list[Difference]:
    """Differences of outcome, peaks and times from all `known` runs, the first of which is the model's."""
    model, found = known[0], []
    decided = [one for one in known if one.decided]
    differs = run.outcome != model.outcome and not _may_be(scene, run) & {outcome_of(scene, one) for one in decided}
    if run.decided and model.decided and differs:  # of those that are told alike the peak tilts tell
        found.append(Difference("outcome", run.outcome, model.outcome, None))
    alike = [one for one in known if (one.outcome == FALLS) == (run.outcome == FALLS)]
    if not alike:
        return found
    falls = run.outcome == FALLS
    slips = ["peak_slip"] if run.sliding and scene.friction is not None else []  # it is read
    upright = ("peak_tilt", "peak_base_displacement", *slips)
    for name in ("peak_base_displacement", "fall_time") if falls else upright:
        values = [_value(one, name) for one in alike]
        low, high, here = min(values), max(values), _value(run, name)
        if not low - _room(scene, name, low) <= here <= high + _room(scene, name, high):  # not: NaN
            limit = PEAK if name.startswith("peak") else _room(scene, name, values[0])
            found.append(Difference(name, here, _own(known, alike, values), limit, _span(known, low, high)))
    if falls:
        found += [*_before_fall(scene, known, alike, run), *_overturning(scene, known, alike, run, found)]
    return found


def _value(response: Response, name: str) -> float:
    """A number by its name, see `response.DIFFERENCES`."""
    if name == "peak_slip":
        return response.sliding.peak if response.sliding else 0.0
    return getattr(response, name)


def _own(known: Sequence[Response], alike: Sequence[Response], values: Sequence[float]) -> float | None:
    """The model's value among `values` of the runs that end `alike`; None if the model's end differs."""
    return values[0] if alike[0] is known[0] else None


def _span(known: Sequence[Response], low: float, high: float) -> tuple[float, float] | None:
    """(lowest, highest) value in the model near the scene; None where no copies were run."""
    return (low, high) if len(known) > 1 else None


def _room(scene: Scene, name: str, value: float) -> float:
    """Limit of the difference of a number from the model's `value`, in its unit."""
    gamma = scene.block.slenderness
    if name == "peak_tilt":
        return PEAK * max(value, LEAST_TILT * gamma)
    if name == "peak_slip":
        return max(PEAK * value, LEAST_SLIP * scene.block.radius)
    if name == "peak_base_displacement":
        return PEAK * max(value, LEAST_DISPLACEMENT * scene.block.radius * gamma)
    return FALL * 2 * math.pi / scene.rocking_frequency


def _overturning(
    scene: Scene, known: Sequence[Response], alike: Sequence[Response], run: Response, found: Sequence[Difference]
) -> list[Difference]:
    """The difference in the time of overturning, for runs whose fall begins as the model's does."""
    if any(one.quantity == "fall_time" for one in found) or known[0].outcome != FALLS:
        return []
    here, times, room = run.overturning_time, [one.overturning_time for one in alike], _room(scene, "fall_time", 0.0)
    low, high = min(times), max(times)
    for more in (lambda: 0.0, lambda: times[0] - _released(scene, known[0])):  # the second takes a run
        if low - room - (late := more()) <= here <= high + room + late:
            return []
    return [Difference("overturning_time", here, times[0], room + late, _span(known, low, high))]


def _released(scene: Scene, model: Response) -> float:
    """Time [s] at which the model loses contact in its last fall, at most that of overturning; that if it slides."""
    over = model.overturning_time
    if scene.friction is not None:
        return over
    step = max((over - model.fall_time) / FALL_POINTS, over / MOST_POINTS)
    history = simulate(scene.with_(duration=over), output_step=step).history
    trace = Trace(*(getattr(history, name) for name in Trace.COLUMNS), contact_tilt=LEAST_TILT)  # type: ignore[misc]  # the columns come before it
    demand, normal, _ = at_contact(scene, trace)
    holds = (normal > 0) & (demand <= FRICTION)
    return float(trace.time[(trace.time >= model.fall_time) & ~holds].min(initial=over))


def _before_fall(scene: Scene, known: Sequence[Response], alike: Sequence[Response], run: Response) -> list[Difference]:
    """The difference in the number of impacts before the last passage of the slenderness."""

    def numbers(response: Response) -> list[int]:
        """(lowest, actual, highest) number of impacts that count."""
        impacts = impacts_of(response)
        shares = COUNTED * (1 + PEAK), COUNTED, COUNTED * (1 - PEAK)
        before = ~(impacts[:, 0] > response.fall_time)
        return [int((counts(scene, impacts, share) & before).sum()) for share in shares]

    least, own, most = numbers(run)
    theirs = [numbers(one) for one in alike]
    low, high = min(one[0] for one in theirs), max(one[2] for one in theirs)
    if most >= low and least <= high:
        return []
    model = _own(known, alike, [one[1] for one in theirs])
    return [Difference("impacts_before_fall", own, model, 0.0, _span(known, low, high))]


def _impact_differences(scene: Scene, model: Response, run: Response, until: float) -> list[Difference]:
    """Differences of matched impacts, and impacts without a match, up to the time `until` [s]."""
    ours, theirs = impacts_of(run), impacts_of(model)
    until = min(until, model.end.time, run.end.time) - LAST * 2 * math.pi / scene.rocking_frequency
    wanted, partner = matched(scene, theirs, ours, until)
    pairs = partner >= 0
    met, own = wanted[pairs], ours[partner[pairs]]
    found = _restitution_differences(own[:, 2] / own[:, 1], met[:, 2] / met[:, 1])
    late = np.abs(own[:, 0] - met[:, 0]) > OUT_OF_PHASE * np.diff(met[:, 0], prepend=0.0)
    until = met[late, 0].min(initial=until)
    for name, one, other in (("missing_impacts", theirs, ours), ("extra_impacts", ours, theirs)):
        _, partner = matched(scene, one, other, until)
        if (partner < 0).any():
            counted, met_again = len(partner), int((partner >= 0).sum())
            here, there = (met_again, counted) if name == "missing_impacts" else (counted, met_again)
            found.append(Difference(name, here, there, 0.0))
    return found


def _restitution_differences(here: np.ndarray, there: np.ndarray) -> list[Difference]:
    """Difference of the restitution e at the matched impact furthest beyond its limit, else of the loss 1 - e^2."""
    if not len(here):
        return []
    lost, meant = 1 - here**2, 1 - there**2
    for name, own, model, limit, room in (
        ("restitution", here, there, RESTITUTION, np.full(len(there), RESTITUTION)),
        ("impact_loss", lost, meant, LOSS, LOSS * np.maximum(np.abs(meant), LEAST_LOSS)),
    ):
        worst = int(np.argmax(np.abs(own - model) / room))
        if not abs(own[worst] - model[worst]) <= room[worst]:
            return [Difference(name, float(own[worst]), float(model[worst]), limit)]
    return []


def outcome_of(scene: Scene, response: Response) -> str:
    """The outcome; "stands" where the peak tilt is too small to count."""
    still = response.peak_tilt < STILL * scene.block.slenderness
    if response.outcome not in ("rocks", "slides") or not still:
        return response.outcome
    return "slides" if _value(response, "peak_slip") > LEAST_SLIP * scene.block.radius else "stands"


def _with_friction(does: str) -> str:
    return (
        f"give the scene a friction of the block on its support (friction = 0.6), with which the model's block {does}"
    )


def _may_be(scene: Scene, run: Response) -> set[str]:
    """The outcomes that an engine's run may have: one whose slip is not read does not tell standing from sliding."""
    found = outcome_of(scene, run)
    unread = scene.friction is not None and run.sliding is None
    return {*LEVEL} if unread and found in LEVEL else {found}


def _outside(scene: Scene, model: Response) -> str | None:
    """Why no run of the scene can be compared with the model's, or None."""
    if model.failure:
        return f"the analytic model fails: {model.failure.reason}"
    if scene.friction is not None:
        return None
    if not model.min_normal_ratio > 0:
        return f"the normal force falls to 0 in the analytic model; {_with_friction('flies')}"
    if not model.friction_demand <= FRICTION:
        demand = f"the friction demand is {model.friction_demand:.3g} in the analytic model, above {FRICTION:g}"
        return f"{demand}; {_with_friction('slides')} (at {model.friction_demand:.3g} or more it does not)"
    return None
