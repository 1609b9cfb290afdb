"""Events of a trace (impacts, uplifts, rests), its contact forces and its end; matching of two runs' impacts.

Events and contact forces follow from the states by the model's equations. A trace ends at a state that is not finite,
at overturning, or before the scene's duration.

Impacts are those at tilt 0. The analytic model also has impacts in which a corner lands at another tilt after a flight.
They are left out here, as the trace of an engine does not show them.

Two impacts of two runs on the same side match if they are closer to each other than to the next ones on that side. An
impact counts if its rate is at least `COUNTED` of the largest of its run, and at least that of a swing of a tenth of
`LEAST_TILT`: an engine cannot tell smaller ones from the compliance of its contact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from analytic.kernel.layout import FLIGHT, MODES
from analytic.motion import vertical_acceleration
from analytic.response import Failure, Impact, State
from analytic.rocking import RockingModel

from .swings import LEAST_SLIDING, ArrayModel, Trace, cubic_through, to_contact
from .trace_checks import HEIGHT_TOLERANCE, pivoting_centre, settled, slips

if TYPE_CHECKING:
    from analytic import Response, Scene

    from .swings import Swings

# A landing after which the block stays in flat contact counts as an impact with rate 0 after it, if the rate before it
# is at least this many times the rate that just reaches contact_tilt. A weaker one is the end of a chatter.
LANDING = 10.0
# Share of a rate that may come from the time between a landing and a lift that are one impact.
SURE = 0.1
# An engine must not miss impacts above this share of the largest tilt rate and above CLEAR times the rate that just
# reaches contact_tilt. Coarse steps skip smaller ones at the end of a chatter.
STRONG, CLEAR = 0.2, 3.0
# Ratio of the rates after and before an impact above which a run counts as failed, as no impact adds energy. Tuned
# variants and exact motions sampled at random steps stay below 1; first scripts reach 1.1 by their step errors. It says
# nothing where the block may slide: an impact turns the energy of the slip into rotation, and the model's ratio reaches
# 1.4. Energy that a run gains is seen by `checks.check_energy`.
MOST_RESTITUTION = 1.2


def find_events(
    scene: Scene, trace: Trace, swings: Swings
) -> tuple[tuple[Impact, ...], tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Find the events of a trace: (impacts, uplifts, rests, missed); see `engines.observe`.

    missed: times [s] at which a swing ends and the next begins on the other side without a resolved impact or landing
    between them, although both count by `strong_swings`.
    """
    n = len(swings)
    if n == 0:
        return (), (), (), ()
    model = ArrayModel.of(scene)
    counts, missed = strong_swings(model, trace, swings), []
    land, before, v_before = to_contact(scene, trace, swings, 1)
    lift, after, v_after = to_contact(scene, trace, swings, -1)
    impacts, uplifts, rests = [], [], []
    for i in range(n):
        first, last = swings.first[i], swings.last[i]
        if i == 0 and scene.start.tilt == 0 and scene.start.tilt_rate == 0:
            uplifts.append(_uplift_time(model, scene, trace, 0, first))
        if last == len(trace.time) - 1:
            break  # the trace ends in flight
        following = swings.first[i + 1] if i + 1 < n else None
        if following is not None:
            if _goes_on(scene, trace, swings, i, land[i]):
                continue
            if _passes(trace, swings, i, lift[i + 1] - land[i], before[i], after[i + 1], _pull(model)):
                impacts.append(
                    Impact(float(land[i]), float(before[i]), float(after[i + 1]), float(v_after[i + 1] - v_before[i]))
                )
                continue
        landing = float(land[i]) if np.isfinite(land[i]) else float(trace.time[last])
        limit, pull = _limit_time(model, scene, trace, last, swings.side[i], landing, before[i])
        turned = following is not None and swings.side[i + 1] == -swings.side[i] and counts[i] and counts[i + 1]
        if following is not None and trace.time[following] < limit:
            if turned:
                missed.append(float(trace.time[last]))
            continue  # chatter below the resolution
        strong = pull > 0 and abs(before[i]) > LANDING * math.sqrt(2 * pull * trace.contact_tilt)
        if strong:
            k = min(int(np.searchsorted(trace.time, landing)) + 1, len(trace.time) - 1)
            impacts.append(Impact(landing, float(before[i]), 0.0, float(trace.base_velocity[k] - v_before[i])))
        elif turned:
            missed.append(float(trace.time[last]))
        if following is None:
            if limit <= trace.time[-1]:
                rests.append(limit)
        else:
            uplift = _uplift_time(model, scene, trace, last + 1, following)
            rests.append(min(limit, uplift))
            uplifts.append(uplift)
    return tuple(impacts), tuple(uplifts), tuple(float(rest) for rest in rests), tuple(missed)


def _goes_on(scene: Scene, trace: Trace, swings: Swings, i: int, landing: float) -> bool:
    """Whether swing i goes on in the next one without a landing: after a graze of contact, or in the air.

    In the air only where the scene gives a friction: in the model no other block leaves its support.
    """
    if swings.side[i + 1] == swings.side[i] and not np.isfinite(landing):
        return True
    if scene.friction is None or trace.centre is None:
        return False
    between = trace.at(slice(swings.last[i], swings.first[i + 1] + 1))
    height = (between.centre - pivoting_centre(scene, between))[:, 1]
    return bool((height > HEIGHT_TOLERANCE * scene.block.radius).all())


def _passes(trace: Trace, swings: Swings, i: int, apart: float, before: float, after: float, pull: float) -> bool:
    """Whether swing i passes through contact into the next one, on the other side, without a rest between them.

    apart: time from landing to lift [s]; before, after: tilt rates there [rad/s]; pull: see `_pull`.
    """
    if swings.side[i + 1] != -swings.side[i]:
        return False
    time, last, following = trace.time, swings.last[i], swings.first[i + 1]
    if following == last + 1 and np.isfinite(before + after):
        return True
    slack = 2 * max(time[last + 1] - time[last], time[following] - time[following - 1])
    slack += trace.contact_tilt / abs(before) + trace.contact_tilt / abs(after) + trace.early
    # A hop of a compliant contact after an impact shifts the extrapolated lift, but not the time in contact. A lift so
    # long before the landing that gravity would have changed its rate gives no rate after the impact: the block came to
    # rest, and its new motion has another cause.
    if not -apart * pull <= SURE * abs(after):
        return False
    return min(apart, time[following] - time[last]) <= slack  # False for NaN


def strong_swings(model: ArrayModel, trace: Trace, swings: Swings) -> np.ndarray:
    """Whether the unforced block would reach the impact of each swing at a rate that counts."""
    bounds = np.column_stack([swings.first, swings.last + 1]).ravel()[:-1]
    speed = np.maximum.reduceat(_speeds(model, trace), bounds)[::2]
    return speed >= _least_speed(model, trace, speed.max())


def _pull(model: ArrayModel) -> float:
    """|tilt''| toward contact of an unforced block at tilt = 0 [rad/s2]."""
    return abs(float(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0]))


def _speeds(model: ArrayModel, trace: Trace) -> np.ndarray:
    """|Tilt rate| [rad/s] at which an unforced block reaches tilt = 0 from each step, at constant acceleration."""
    return np.sqrt(trace.tilt_rate**2 + 2 * _pull(model) * np.abs(trace.tilt))


def _least_speed(model: ArrayModel, trace: Trace, fastest: float) -> float:
    """|Tilt rate| [rad/s] from which an impact counts."""
    return max(STRONG * fastest, CLEAR * math.sqrt(2 * _pull(model) * trace.contact_tilt))


def straddled(scene: Scene, trace: Trace) -> np.ndarray:
    """Times [s] of steps in flight that are longer than the time to the impact plus the whole swing after it.

    Both follow from the model's restitution and the acceleration at the step. Only impacts after which the rate still
    counts are considered.
    """
    model = ArrayModel.of(scene)
    flight = np.abs(trace.tilt[:-1]) > trace.contact_tilt
    if not flight.any():
        return np.empty(0)
    least = _least_speed(model, trace, _speeds(model, trace)[:-1][flight].max())
    return np.concatenate([_straddling(scene, model, piece, least) for piece in trace.pieces()])


def _straddling(scene: Scene, model: ArrayModel, trace: Trace, least: float) -> np.ndarray:
    """`straddled` for impacts with a |tilt rate| of at least `least` [rad/s]."""
    k = np.flatnonzero(np.abs(trace.tilt[:-1]) > trace.contact_tilt)
    side, step = np.sign(trace.tilt[k]), np.diff(trace.time)[k]
    ground = scene.motion.acceleration(trace.time[k]) if scene.motion else np.zeros(len(k))
    up = vertical_acceleration(scene.motion, trace.time[k])
    gain = side * model.accelerations(side, trace.tilt[k], trace.tilt_rate[k], ground, trace.bearing_force[k], up)[0]
    p, q = np.abs(trace.tilt[k]), side * trace.tilt_rate[k]
    speed = np.sqrt(np.maximum(q * q - 2 * gain * p, 0.0))
    falls = (gain < 0) & (model.restitution * speed >= least)
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = (q + speed + 2 * model.restitution * speed) / -gain
    return trace.time[k[falls & (step > needed)]]


def check_impacts(scene: Scene, trace: Trace, impacts: Sequence[Impact], missed: Sequence[float]) -> Failure | None:
    """A `Failure` where an impact added energy or was not resolved, else None; `missed` as in `find_events`."""
    slides = scene.friction is not None and trace.centre is not None
    least = _least_speed(ArrayModel.of(scene), trace, max((abs(impact.rate_before) for impact in impacts), default=0.0))
    for impact in impacts:
        before, after = abs(impact.rate_before), abs(impact.rate_after)
        if before >= least and not after <= MOST_RESTITUTION * before and not slides:  # not: NaN
            return Failure(
                "an impact added energy",
                f"at {impact.time:.9g} s the tilt rate goes from {impact.rate_before:.6g} to "
                f"{impact.rate_after:.6g} rad/s; error of the steps: at most {MOST_RESTITUTION} times",
            )
    if missed:
        return Failure(
            "an impact could not be resolved",
            f"at {missed[0]:.9g} s the tilt changes side, and its rates before and after cannot be determined"
            f"{f'; {len(missed)} such times' if len(missed) > 1 else ''}",
        )
    stepped = straddled(scene, trace)
    if len(stepped):
        return Failure(
            "the steps are longer than whole swings",
            f"the step after {stepped[0]:.9g} s leaps over an impact and the swing that follows"
            f"{f'; {len(stepped)} such steps' if len(stepped) > 1 else ''}",
        )
    return None


def _limit_time(
    model: ArrayModel, scene: Scene, trace: Trace, last: int, side: float, landing: float, rate: float
) -> tuple[float, float]:
    """Return (limit time of the model's impacts after a landing [s], |tilt''| toward contact there [rad/s2])."""
    ground = float(scene.motion.acceleration(landing)) if scene.motion else 0.0
    up = float(vertical_acceleration(scene.motion, landing))
    pull = -side * float(model.accelerations(side, 0.0, 0.0, ground, trace.bearing_force[last], up)[0])
    e = model.restitution
    if not (pull > 0 and np.isfinite(rate) and e < 1):
        return landing, pull
    return landing + 2 * e * abs(float(rate)) / (pull * (1 - e)), pull


def _uplift_time(model: ArrayModel, scene: Scene, trace: Trace, begin: int, first: int) -> float:
    """Last time in steps begin..first at which |absolute base acceleration| rose through (g + a_v) tan(gamma), (2)."""
    steps = slice(begin, first + 1)
    limit = model.uplift_limit(vertical_acceleration(scene.motion, trace.time[steps]))
    size = np.abs(_contact_acceleration(model, scene, trace, steps)) - limit
    rising = np.flatnonzero((size[:-1] <= 0) & (size[1:] > 0))
    if not len(rising):
        return float(trace.time[begin] if size[0] > 0 else trace.time[first])
    k = int(rising[-1])
    t0, t1 = trace.time[begin + k], trace.time[begin + k + 1]
    return float(t0 - size[k] * (t1 - t0) / (size[k + 1] - size[k]))


def _contact_acceleration(model: ArrayModel, scene: Scene, trace: Trace, steps: slice = slice(None)) -> np.ndarray:
    """Absolute acceleration of the base in full contact [m/s2] at the steps, eq. (2)."""
    if model.on_base:
        return model.contact_acceleration(trace.bearing_force[steps])
    time = trace.time[steps]
    return scene.motion.acceleration(time) if scene.motion else np.zeros(len(time))


def contact_measures(scene: Scene, trace: Trace) -> tuple[float, float, float]:
    """Extremes over a trace: (max |H|/N, min N/(m g), max |absolute base acceleration| [m/s2])."""
    demands, normals, peaks = [], [], []
    for piece in trace.pieces():
        demand, normal, absolute = at_contact(scene, piece)
        demands.append(demand.max())
        normals.append(normal.min())
        peaks.append(np.abs(absolute).max())
    return float(np.max(demands)), float(np.min(normals)), float(np.max(peaks))


def at_contact(scene: Scene, trace: Trace) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Contact measures at the steps: (|H|/N, N/(m g), absolute base acceleration [m/s2])."""
    model = ArrayModel.of(scene)
    level = _contact_acceleration(model, scene, trace)
    vertical = vertical_acceleration(scene.motion, trace.time)
    weight = (model.g + vertical) / model.g
    # In contact above the uplift acceleration the block has already lifted, by less than the engine resolves.
    lifting = np.abs(level) > model.uplift_limit(vertical)
    flight = lifting | (np.abs(trace.tilt) > trace.contact_tilt)
    demand, normal, absolute = np.abs(level) / model.g / weight, weight.copy(), level.copy()
    if flight.any():
        tilt, rate = trace.tilt[flight], trace.tilt_rate[flight]
        side = np.where(np.abs(tilt) > trace.contact_tilt, np.sign(tilt), -np.sign(level[flight]))
        ground = scene.motion.acceleration(trace.time[flight]) if scene.motion else np.zeros(len(tilt))
        up = vertical[flight]
        tilting, sliding = model.accelerations(side, tilt, rate, ground, trace.bearing_force[flight], up)
        absolute[flight] = ground + sliding
        H, N = model.contact_forces(side, tilt, rate, tilting, absolute[flight], up)
        demand[flight] = np.where(N > 0, np.abs(H) / np.where(N > 0, N, 1.0), np.inf)
        normal[flight] = N / (model.m * model.g)
    if scene.friction is not None and trace.centre is not None:
        _where_it_moves(scene, trace, demand, normal, absolute)
    return demand, normal, absolute


def _where_it_moves(scene: Scene, trace: Trace, demand: np.ndarray, normal: np.ndarray, absolute: np.ndarray) -> None:
    """Replace the measures where a corner slides or the block is in the air; the given ones hold where it sticks.

    They follow from (S1) to (S4) of `analytic.sliding.equations` at the scene's friction. Nothing is measured while a
    compliant contact relaxes.
    """
    model, mu = ArrayModel.of(scene), scene.friction
    apart = trace.centre - pivoting_centre(scene, trace)
    flies = apart[:, 1] > HEIGHT_TOLERANCE * model.R
    slides = ~flies & (np.abs(apart[:, 2]) > LEAST_SLIDING * math.sqrt(model.g * model.R))
    moves = flies | slides
    tilt, rate = trace.tilt[moves], trace.tilt_rate[moves]
    pivots, friction = np.abs(tilt) > trace.contact_tilt, -np.sign(apart[moves, 2]) * mu * ~flies[moves]
    c, n = model.lever(np.sign(tilt), tilt)
    weight = model.g + vertical_acceleration(scene.motion, trace.time[moves])
    lifted = np.where(pivots, weight - c * rate**2, weight)
    lever = n + friction * c
    alpha = np.where(pivots, -lever * model.m * lifted / (scene.block.centre_inertia + lever * n * model.m), 0.0)
    N = np.where(flies[moves], 0.0, np.maximum(model.m * (lifted + n * alpha), 0.0))
    clean = settled(trace)[moves]
    demand[moves], normal[moves] = np.abs(friction) * clean, np.where(clean, N / model.m, weight) / model.g
    if scene.base is not None:
        absolute[moves] = -(trace.bearing_force[moves] + friction * N) / scene.base_mass * clean


def finite_part(trace: Trace, failure: Failure | None) -> tuple[Trace | None, Failure | None]:
    """Cut a trace before its first non-finite step: (the steps, or None; failure with the last finite state)."""
    finite = np.isfinite(trace.time)
    for name in Trace.COLUMNS[1:]:
        finite &= np.isfinite(getattr(trace, name))
    if trace.centre is not None:
        finite &= np.isfinite(trace.centre).all(axis=1)
    all_finite = bool(finite.all())
    count = len(finite) if all_finite else int(np.argmin(finite))
    if not all_finite:
        failure = failure or Failure("the state is no longer finite", f"at step {count}, t = {trace.time[count]:.9g} s")
    if failure is not None and failure.last_state is None and count:
        failure = replace(failure, last_state=last_state(trace, count - 1))
    if count < 2:
        return None, failure
    return trace if all_finite else trace.upto(count), failure


def upto_overturning(scene: Scene, trace: Trace, ended: str | None) -> tuple[Trace, float | None]:
    """Cut a trace at |tilt| = pi/2: (trace with that state as its last step, its time), or (whole trace, None)."""
    limit = math.pi / 2
    over = np.flatnonzero(np.abs(trace.tilt) >= limit)
    if len(over) and over[0] > 0:
        cut = _upto_crossing(trace, int(over[0]), limit)
        return cut, float(cut.time[-1])
    side = np.sign(trace.tilt[-1])
    if ended == "overturned" and side * trace.tilt_rate[-1] > 0:
        model = ArrayModel.of(scene)
        ground = scene.motion.acceleration(trace.time[-1]) if scene.motion else 0.0
        up = vertical_acceleration(scene.motion, trace.time[-1])
        force = trace.bearing_force[-1]
        pull = side * model.accelerations(side, trace.tilt[-1], trace.tilt_rate[-1], ground, force, up)[0]
        q, p = side * trace.tilt_rate[-1], abs(trace.tilt[-1]) - limit
        return trace, float(trace.time[-1] - 2 * p / (q + math.sqrt(max(q * q - 2 * pull * p, 0.0))))
    return trace, None


def upto_edge(scene: Scene, trace: Trace) -> tuple[Trace, bool]:
    """Cut a trace after the first step at which the block is off its pedestal: (trace, whether it is cut).

    It is off as in the model (`analytic.sliding.equations.edge_event`): level, its centre of pressure is beyond the
    edge; tilted, its lower corner, unless it is in the air or past its balance.
    """
    slip, model, b, mu = slips(scene, trace), ArrayModel.of(scene), scene.block.half_width, scene.friction
    if slip is None or mu is None or scene.pedestal is None:
        return trace, False
    apart = trace.centre - pivoting_centre(scene, trace)
    slides = np.abs(apart[:, 2]) > LEAST_SLIDING * math.sqrt(model.g * model.R)
    held = _contact_acceleration(model, scene, trace) / (model.g + vertical_acceleration(scene.motion, trace.time))
    across = np.where(slides, -mu * np.sign(apart[:, 2]), np.clip(held, -mu, mu))  # H/N of a level block
    level, pressure = np.abs(trace.tilt) <= trace.contact_tilt, np.clip(-scene.block.half_height * across, -b, b)
    pressure = np.where(level, pressure, np.sign(trace.tilt) * b)
    touches = (apart[:, 1] <= HEIGHT_TOLERANCE * model.R) & (np.abs(trace.tilt) <= model.gamma)
    off = np.flatnonzero((np.abs(slip + pressure) > scene.edge) & touches)
    return (trace.upto(max(int(off[0]) + 1, 2)), True) if len(off) else (trace, False)


def upright_part(scene: Scene, trace: Trace, falls: bool) -> Trace:
    """The trace up to the last passage of the slenderness if the block `falls`; all of it otherwise or without one."""
    if not falls:
        return trace
    slenderness = scene.block.slenderness
    below = np.flatnonzero(np.abs(trace.tilt) <= slenderness)
    last = int(below[-1]) + 1 if len(below) else 1
    if last == len(trace.time) or not len(below):
        return trace.upto(max(last, 2))
    return _upto_crossing(trace, last, slenderness)


def _upto_crossing(trace: Trace, last: int, level: float) -> Trace:
    """Cut a trace where |tilt| passes `level`, between the steps last - 1 and last; the passage is its last step."""
    pair = slice(last - 1, last + 1)
    tilt = math.copysign(level, trace.tilt[last])
    t = _crossing(trace.time[pair], trace.tilt[pair], trace.tilt_rate[pair], tilt)
    weight = (t - trace.time[last - 1]) / (trace.time[last] - trace.time[last - 1])

    def closed(values, end=None):
        """The values before the passage, then the value at it."""
        if end is None:
            end = (1 - weight) * values[last - 1] + weight * values[last]
        return np.append(values[: last if weight > 0 else last - 1], [end], axis=0)

    columns = {name: closed(getattr(trace, name)) for name in Trace.COLUMNS[2:]}
    columns.update(time=closed(trace.time, t), tilt=closed(trace.tilt, tilt))
    return replace(trace, centre=None if trace.centre is None else closed(trace.centre), **columns)


def _crossing(time: np.ndarray, value: np.ndarray, rate: np.ndarray, level: float) -> float:
    """Time at which the cubic through both ends of a step first takes `level`."""
    roots = cubic_through(time, value, rate).solve(level, extrapolate=False)
    roots = roots[np.isfinite(roots)]
    if len(roots):
        return float(roots.min())
    return float(np.interp(level, value, time)) if value[0] < value[1] else float(np.interp(-level, -value, time))


def unstable_time(scene: Scene, trace: Trace) -> float | None:
    """First time of |tilt| = slenderness [s], or None."""
    over = np.flatnonzero(np.abs(trace.tilt) >= scene.block.slenderness)
    if not len(over):
        return None
    i = int(over[0])
    if i == 0:
        return float(trace.time[0])
    pair = slice(i - 1, i + 1)
    return _crossing(
        trace.time[pair], trace.tilt[pair], trace.tilt_rate[pair], math.copysign(scene.block.slenderness, trace.tilt[i])
    )


def last_state(trace: Trace, step: int = -1) -> State:
    """The `State` of a trace at a step, by default its last."""
    return State(*(float(getattr(trace, name)[step]) for name in Trace.COLUMNS))


def ended_early(scene: Scene, trace: Trace) -> Failure | None:
    """A `Failure` if a trace ends more than one of its steps before the scene's duration, else None."""
    end = last_state(trace)
    short = scene.end * (1 - 1e-9) - end.time  # equal steps need not end at the duration
    if short > np.diff(trace.time).max():
        return Failure("the run ended early", f"last step at {end.time:.9g} s of {scene.duration:.9g} s", end)
    return None


COUNTED = 0.1
LEAST_TILT = 0.01  # of the slenderness: a smaller tilt is compared as one of that size
STILL = 0.02 * LEAST_TILT  # of the slenderness: a block whose peak tilt is smaller has not lifted; a contact yields


def impacts_of(response: Response) -> np.ndarray:
    """Impacts that end no flight: rows of time [s], rate before and rate after [rad/s], shape (impacts, 3)."""
    rows = [(impact.time, impact.rate_before, impact.rate_after) for impact in response.impacts]
    impacts = np.array(rows, dtype=float).reshape(-1, 3)
    modes = response.sliding.modes if response.sliding else ()
    begun = np.searchsorted([time for time, _ in modes], impacts[:, 0])  # of the modes; an impact ends the last
    flown = np.array([False, *(mode == MODES[FLIGHT] for _, mode in modes)])
    return impacts[~flown[begun]]


def matched(scene: Scene, impacts: np.ndarray, others: np.ndarray, until: float) -> tuple[np.ndarray, np.ndarray]:
    """Match impacts: (`impacts` that count up to the time `until`; index of the match of each in `others`, or -1)."""
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
    counted = counts(scene, impacts) & ~(impacts[:, 0] > until)
    return impacts[counted], partner[counted]


def counts(scene: Scene, impacts: np.ndarray, share: float = COUNTED) -> np.ndarray:
    """Whether each impact counts, at `share` of the largest rate. A NaN counts, so that it is found."""
    model = RockingModel.of(scene)
    before, after = np.abs(impacts[:, 1:]).T
    pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])
    least = math.sqrt(2 * pull * 0.1 * LEAST_TILT * model.gamma)  # rate at the impact of a swing that small
    small = (before < max(least, share * np.nanmax(before, initial=0.0))) | (np.fmax(before, after) < least)
    return ~small


def parting(scene: Scene, first: Response, second: Response) -> float:
    """Time [s] of the first impact that counts of either run without a match in the other; inf where all match."""
    pairs = (first, second), (second, first)
    matches = (matched(scene, impacts_of(run), impacts_of(other), math.inf) for run, other in pairs)
    return float(min(impacts[partner < 0, 0].min(initial=math.inf) for impacts, partner in matches))
