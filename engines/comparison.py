"""Comparison of an engine's run with the analytic model's run of the same scene.

A `Difference` is reported where a limit is exceeded:

- outcome: it differs, and both runs are decided.
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
restitution changed by `CHANGE`: these near copies of the scene show how sensitive a result is. Where a copy differs
from the model in the outcome, a peak or a time, the scene is near an outcome boundary, for all engines alike; the
stored value is "on an edge". There, an outcome that a copy has is not a difference. Neither is a number within the
range of the copies with the run's outcome, widened by the limit. Impacts are compared up to the first one that the
copies do not share.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from analytic import simulate
from analytic.errors import SceneError
from analytic.response import COMPARED, EDGE, JUDGED, LEVEL, UNCOMPARED, Caution, Difference
from analytic.rocking import RockingModel, restitution

from .events import COUNTED, LEAST_TILT, STILL, at_contact, counts, impacts_of, matched, parting
from .loads import FRICTION
from .swings import Trace
from .trace_checks import LEAST_SLIP

if TYPE_CHECKING:
    from analytic import Response, Scene

    from .contract import Variant

CHANGE = 1e-4  # relative; errors of tuned engines are 1e-5 to 1e-4


def near_copies(scene: Scene) -> Iterator[Scene]:
    """Copies of a scene with slenderness, restitution (or a given friction), motion or start changed by `CHANGE`."""
    for factor in (1 + CHANGE, 1 - CHANGE):
        yield from _changed(scene, block={"slenderness": scene.block.slenderness * factor})
    yield from changed_copies(scene, CHANGE).values()


def changed_copies(scene: Scene, change: float) -> dict[str, Scene]:
    """Copies {name: scene} with restitution (or a given friction), motion or start changed by +-change, relative.

    A stack keeps its restitution.
    """
    copies = {}
    e, start = restitution(scene), scene.start
    for sign, word in ((1, "up"), (-1, "down")):
        factor = 1 + sign * change
        if scene.friction is not None:  # a restitution that is given needs a corner that sticks
            copies[f"friction {word}"] = scene.with_(friction=scene.friction * factor)
        elif 0 < e * factor <= 1 and not scene.is_stack:
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
FALLS = ("overturns", "pedestal overturns")  # one that falls off is compared as one that is upright
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
        if reason := _why_incomparable(scene, model):
            return cls(model, comparable=reason)
        try:
            copies = tuple(simulate(copy, history=False) for copy in near_copies(scene))
        except SceneError as error:
            return cls(model, comparable=f"the analytic model refuses a scene within {CHANGE:g} of it: {error}")
        near = frozenset(
            difference.quantity for copy in copies for difference in _number_differences(scene, (model,), copy)
        )
        if failed := next((copy.failure for copy in copies if copy.failure), None):
            return cls(model, comparable=f"the analytic model fails within {CHANGE:g} of it: {failed.reason}")
        if scene.is_stack:
            return cls(model, copies, EDGE if near else COMPARED, near)
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
    models = (reference.model, *reference.copies)
    numbers = _number_differences(scene, models, run)
    if scene.is_stack:
        return tuple(numbers)
    return (*numbers, *_impact_differences(scene, reference.model, run, reference.until))


def _number_differences(scene: Scene, models: Sequence[Response], run: Response) -> list[Difference]:
    """Differences of outcome, peaks and times from the runs `models`: the model's own, then those of the copies."""
    model, beyond = models[0], []
    outcomes = {outcome_of(scene, response) for response in models if response.decided}
    differs = run.outcome != model.outcome and not _possible_outcomes(scene, run) & outcomes
    if run.decided and model.decided and differs:  # two outcomes of one word are compared by the peak tilt
        beyond.append(Difference("outcome", run.outcome, model.outcome, None))
    falls = run.outcome in FALLS
    ends = run.outcome if falls else None
    alike = [response for response in models if (response.outcome if response.outcome in FALLS else None) == ends]
    if not alike:
        return beyond
    slips = ["peak_slip"] if run.sliding and scene.friction is not None else []  # where it was read
    upright = ("peak_tilt", "peak_base_displacement", *slips, *["pedestal_tilt"] * scene.is_stack)
    for name in ("peak_base_displacement", "fall_time") if falls else upright:
        values = [_value(response, name) for response in alike]
        low, high, value = min(values), max(values), _value(run, name)
        if not low - _limit(scene, name, low) <= value <= high + _limit(scene, name, high):  # not: NaN
            limit = _limit(scene, name, values[0]) if name == "fall_time" else PEAK
            expected = _model_value(models, alike, values)
            beyond.append(Difference(name, value, expected, limit, _range(models, low, high)))
    if falls and not scene.is_stack:
        beyond += [*_before_fall(scene, models, alike, run), *_overturning(scene, models, alike, run, beyond)]
    return beyond


def _value(response: Response, name: str) -> float:
    """A number of a response by its name, one of `response.DIFFERENCES`."""
    if name == "peak_slip":
        return response.sliding.peak if response.sliding else 0.0
    if name == "pedestal_tilt":
        return response.stack.peak_tilt
    return getattr(response, name)


def _model_value(models: Sequence[Response], alike: Sequence[Response], values: Sequence[float]) -> float | None:
    """The model's value among the `values` of the runs `alike`; None where the model is not one of these."""
    return values[0] if alike[0] is models[0] else None


def _range(models: Sequence[Response], low: float, high: float) -> tuple[float, float] | None:
    """(lowest, highest) value of the model and its copies; None where no copies were run."""
    return (low, high) if len(models) > 1 else None


def _limit(scene: Scene, name: str, value: float) -> float:
    """Limit of the difference of a number from the model's `value`, in its unit."""
    gamma = scene.block.slenderness
    if name in ("peak_tilt", "pedestal_tilt"):
        return PEAK * max(value, LEAST_TILT * gamma)
    if name == "peak_slip":
        return max(PEAK * value, LEAST_SLIP * scene.block.radius)
    if name == "peak_base_displacement":
        return PEAK * max(value, LEAST_DISPLACEMENT * scene.block.radius * gamma)
    return FALL * 2 * math.pi / scene.rocking_frequency


def _overturning(
    scene: Scene, models: Sequence[Response], alike: Sequence[Response], run: Response, beyond: Sequence[Difference]
) -> list[Difference]:
    """The difference in the time of overturning, for runs whose fall begins as the model's does."""
    if any(difference.quantity == "fall_time" for difference in beyond) or models[0].outcome not in FALLS:
        return []
    time, limit = run.overturning_time, _limit(scene, "fall_time", 0.0)
    times = [response.overturning_time for response in alike]
    low, high = min(times), max(times)
    for delay_of in (lambda: 0.0, lambda: times[0] - _contact_lost(scene, models[0])):  # the second takes a run
        if low - limit - (delay := delay_of()) <= time <= high + limit + delay:
            return []
    return [Difference("overturning_time", time, times[0], limit + delay, _range(models, low, high))]


def _contact_lost(scene: Scene, model: Response) -> float:
    """Time [s] at which the model loses contact in its last fall.

    It is the time of overturning where contact holds until then, and in a scene with a friction.
    """
    over = model.overturning_time
    if scene.friction is not None:
        return over
    step = max((over - model.fall_time) / FALL_POINTS, over / MOST_POINTS)
    history = simulate(scene.with_(duration=over), output_step=step).history
    trace = Trace(*(getattr(history, name) for name in Trace.COLUMNS), contact_tilt=LEAST_TILT)  # type: ignore[misc]  # the columns come before it
    demand, normal, _ = at_contact(scene, trace)
    holds = (normal > 0) & (demand <= FRICTION)
    return float(trace.time[(trace.time >= model.fall_time) & ~holds].min(initial=over))


def _before_fall(
    scene: Scene, models: Sequence[Response], alike: Sequence[Response], run: Response
) -> list[Difference]:
    """The difference in the number of impacts before the last passage of the slenderness."""

    def numbers(response: Response) -> list[int]:
        """(lowest, actual, highest) number of impacts that count."""
        impacts = impacts_of(response)
        shares = COUNTED * (1 + PEAK), COUNTED, COUNTED * (1 - PEAK)
        before = ~(impacts[:, 0] > response.fall_time)
        return [int((counts(scene, impacts, share) & before).sum()) for share in shares]

    fewest, number, most = numbers(run)
    lowest, actual, highest = zip(*map(numbers, alike), strict=True)
    low, high = min(lowest), max(highest)
    if most >= low and fewest <= high:
        return []
    model = _model_value(models, alike, actual)
    return [Difference("impacts_before_fall", number, model, 0.0, _range(models, low, high))]


def _impact_differences(scene: Scene, model: Response, run: Response, until: float) -> list[Difference]:
    """Differences of matched impacts, and impacts without a match, up to the time `until` [s]."""
    run_impacts, model_impacts = impacts_of(run), impacts_of(model)
    until = min(until, model.end.time, run.end.time) - LAST * 2 * math.pi / scene.rocking_frequency
    counted, partner = matched(scene, model_impacts, run_impacts, until)
    expected, computed = counted[partner >= 0], run_impacts[partner[partner >= 0]]
    beyond = _restitution_differences(computed[:, 2] / computed[:, 1], expected[:, 2] / expected[:, 1])
    late = np.abs(computed[:, 0] - expected[:, 0]) > OUT_OF_PHASE * np.diff(expected[:, 0], prepend=0.0)
    until = expected[late, 0].min(initial=until)
    _, partner = matched(scene, model_impacts, run_impacts, until)
    if (partner < 0).any():
        beyond.append(Difference("missing_impacts", int((partner >= 0).sum()), len(partner), 0.0))
    _, partner = matched(scene, run_impacts, model_impacts, until)
    if (partner < 0).any():
        beyond.append(Difference("extra_impacts", len(partner), int((partner >= 0).sum()), 0.0))
    return beyond


def _restitution_differences(run_e: np.ndarray, model_e: np.ndarray) -> list[Difference]:
    """Difference of the restitution e at the matched impact furthest beyond its limit, else of the loss 1 - e^2."""
    if not len(run_e):
        return []
    run_loss, model_loss = 1 - run_e**2, 1 - model_e**2
    for name, values, expected, limit, room in (
        ("restitution", run_e, model_e, RESTITUTION, np.full(len(model_e), RESTITUTION)),
        ("impact_loss", run_loss, model_loss, LOSS, LOSS * np.maximum(np.abs(model_loss), LEAST_LOSS)),
    ):
        worst = int(np.argmax(np.abs(values - expected) / room))
        if not abs(values[worst] - expected[worst]) <= room[worst]:
            return [Difference(name, float(values[worst]), float(expected[worst]), limit)]
    return []


TOO_COARSE = "restitution at an impact"  # the quantity of the warning
# Tilt over the slenderness that an impact may add to a free swing, or take from it, by an error of its restitution. It
# is the least of 1e-4, 3e-4 and 1e-3 with at most 5 % false alarms on the first draw of the study `statues`: runs that
# warn, and yet keep 1 % of the slenderness.
KICK = 3e-4


def is_too_coarse(run: Response) -> bool:
    """Return whether a run carries the warning `too_coarse`."""
    return any(caution.quantity == TOO_COARSE for caution in run.warnings)


def too_coarse(scene: Scene, run: Response, variant: Variant) -> tuple[Caution, ...]:
    """Return the warning that a tuned variant's run is too coarse for the scene, with a finer level; () for others.

    It is judged by the run alone: its rate after an impact differs from that of equation (7) so much that the tilt of
    the next free swing changes by more than `KICK`. Nothing is known of a block that slides, as an impact turns the
    energy of the slip into rotation. The level is the next finer one of the variant's levels.
    """
    if variant.kind != "tuned" or not run.impacts or scene.is_stack or (run.sliding and run.sliding.peak):
        return ()
    time, before, after = impacts_of(run).T
    model, expected = RockingModel.of(scene), restitution(scene)
    pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])
    kicks = np.nan_to_num(np.abs(after**2 - (expected * before) ** 2) / (2 * pull * model.gamma))
    worst = int(np.argmax(kicks))
    if kicks[worst] <= KICK:
        return ()
    name, levels = variant.accuracy_parameter, variant.levels
    sign = math.copysign(1.0, levels[-1] - levels[0])
    finer = next((level for level in levels if sign * (level - run.settings[name]) > 0), None)
    remedy = "no finer level is offered: do not trust it" if finer is None else f"use {name} = {finer:g}"
    found = float(after[worst] / before[worst])
    words = (
        f"too coarse here: at {time[worst]:.4g} s the restitution of the run's own impact is {found:.3g}, by equation "
        f"(7) it is {expected:.3g}; {remedy}"
    )
    return (Caution("engine", words, TOO_COARSE, found, expected),)


def outcome_of(scene: Scene, response: Response) -> str:
    """The outcome; "stands" where the peak tilt is too small to count."""
    still = response.peak_tilt < STILL * scene.block.slenderness and not (response.stack and response.stack.rocked)
    if response.outcome not in ("rocks", "slides") or not still:
        return response.outcome
    return "slides" if _value(response, "peak_slip") > LEAST_SLIP * scene.block.radius else "stands"


def _with_friction(does: str) -> str:
    return (
        f"give the scene a friction of the block on its support (friction = 0.6), with which the model's block {does}"
    )


def _possible_outcomes(scene: Scene, run: Response) -> set[str]:
    """The outcomes that an engine's run may have. Where the slip is not read, standing and sliding look alike."""
    outcome = outcome_of(scene, run)
    unread = scene.friction is not None and run.sliding is None
    return {*LEVEL} if unread and outcome in LEVEL else {outcome}


def _why_incomparable(scene: Scene, model: Response) -> str | None:
    """Why no run of the scene can be compared with the model's, or None."""
    if model.failure:
        return f"the analytic model fails: {model.failure.reason}"
    if scene.friction is not None:
        return None
    if scene.is_stack:
        asked = max(model.friction_demand, model.stack.friction_demand, *model.stack.impulses)
        if min(model.min_normal_ratio, model.stack.min_normal_ratio) > 0 and asked <= FRICTION:
            return None
        return f"a normal force falls to 0 in the analytic model, or it asks for a friction of {asked:.3g}"
    if not model.min_normal_ratio > 0:
        return f"the normal force falls to 0 in the analytic model; {_with_friction('flies')}"
    if not model.friction_demand <= FRICTION:
        demand = f"the friction demand is {model.friction_demand:.3g} in the analytic model, above {FRICTION:g}"
        return f"{demand}; {_with_friction('slides')} (at {model.friction_demand:.3g} or more it does not)"
    return None
