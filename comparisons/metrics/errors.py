"""Errors of a response, the sensitivity horizon of a scene, and scenes modelled with more than they need.

The errors are the same for every solver and in every command, study and page. Restitution is measured from the swings
around an impact (`swing_restitution`, as in an experiment), from the states at it (`state_restitution`, also under
forces), and from successive rates (`rate_restitution`, without a history). Other measures are the base velocity jump,
impact times, missed impacts, the distance of the tilt graphs, and the energy.

The sensitivity horizon is the time up to which trajectories can be compared. Rocking under a long record is chaotic: a
change of the restitution in the fourth digit soon gives another motion, in the exact model, too. Two solvers can agree
point by point only until then. The horizon depends on the size of a solver's errors, so each solver has its own.
"""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from analytic import Base, Bearings, Impact, Response, Scene, SceneError, simulate
from analytic.errors import Values
from analytic.rocking import RockingModel, base_jump_length, base_jump_length_as_printed, restitution
from engines.comparison import changed_copies
from engines.events import impacts_of, matched
from engines.swings import Trace
from engines.trace_checks import energy_balance, energy_gain

# Least rate of an impact over the fastest of the run: slower impacts are an engine's chatter before rest.
SLOWEST_IMPACT = 0.1
# Time after an impact that belongs to it [s]: exudyn's compliant corners relax for 6 ms.
SETTLE = 0.01


def swing_restitution(scene: Scene, response: Response) -> np.ndarray:
    """Return the restitution of each impact from the energies of the swings around it, shape (impacts,).

    For free rocking on rigid ground: cos(u') - cos(gamma) = e^2 (cos(u) - cos(gamma)), u = gamma - peak |tilt| of the
    swing before, u' of the swing after. On a base that slides freely the same holds for the energy relative to the
    centre of mass of block and base. Each peak is refined from the nearest sample by the energy integral. NaN if a
    swing has no peak in the history, that is fewer than about four samples.

    Raises
    ------
    ValueError
        The scene has bearings or a motion (the swings keep no energy of their own), or there is no history.
    """
    if scene.bearings is not None or scene.motion is not None:
        raise ValueError("swing_restitution needs free rocking without bearings: use state_restitution")
    history = _history(response)
    bounds = np.array([-math.inf] + [impact.time for impact in response.impacts] + [math.inf])
    energy = np.full(len(bounds) - 1, np.nan)
    edges = np.searchsorted(history.time, bounds)
    for k, (first, last) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
        tilt, rate = history.tilt[first:last], history.tilt_rate[first:last]
        if len(tilt) < 2 or rate[0] * rate[-1] > 0:
            continue  # no peak between the samples
        i = int(np.abs(rate).argmin())
        energy[k] = flight_energy(scene, tilt[i], rate[i])
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.sqrt(energy[1:] / energy[:-1])


def flight_energy(scene: Scene, tilt: Values, rate: Values) -> Values:
    """Return the energy over m g R of a block in free flight, 0 at tilt = rate = 0. Arrays or floats.

    It is constant between impacts: cos(u) - cos(gamma) + rate^2/(2 p^2), u = gamma - |tilt|; on a freely sliding base
    relative to the centre of mass.
    """
    block, tilt = scene.block, np.abs(tilt)
    u = block.slenderness - tilt
    # the base follows the block: inertia J_O - m mt c^2 instead of J_O
    share = 1 - block.mass * scene.mass_share * (block.radius * np.cos(u)) ** 2 / block.inertia
    # cos(u) - cos(gamma) without its cancellation at small tilt
    raised = 2 * np.sin(tilt / 2) * np.sin((block.slenderness + u) / 2)
    return raised + share * rate**2 / (2 * scene.rocking_frequency**2)


def state_restitution(response: Response) -> np.ndarray:
    """Return e_phi = rate after / rate before of each impact, shape (impacts,), for any base and motion, eq. (7).

    An engine's rates are its flight states extrapolated to the impact by the model's equations (engines.observe).
    """
    rates = _rates(response)
    return rates[:, 1] / rates[:, 0]


def base_jump_error(scene: Scene, response: Response) -> np.ndarray:
    """Return the relative error of the jump of the base velocity against momentum, shape (impacts,).

    Momentum: x'+ - x'- = mt h (w- - w+), eq. (8) corrected, with the response's own rates. The scene has a base.
    """
    rates = _rates(response)
    expected = scene.mass_share * scene.block.half_height * (rates[:, 0] - rates[:, 1])
    jumps = np.array([impact.base_velocity_jump for impact in response.impacts])
    return jumps / expected - 1


def strong_impacts(response: Response) -> tuple[Impact, ...]:
    """Return the impacts of a response that are at least `SLOWEST_IMPACT` times as fast as the fastest."""
    fastest = max((abs(impact.rate_before) for impact in response.impacts), default=0.0)
    return tuple(impact for impact in response.impacts if abs(impact.rate_before) >= SLOWEST_IMPACT * fastest)


def impact_errors(scene: Scene, response: Response, most: int | None = None) -> dict[str, np.ndarray]:
    """Return the errors of the first `most` strong impacts of a run.

    Returns
    -------
    dict
        Arrays of shape (impacts,). state: restitution from the states at the impact, less the scene's. time [s]. For
        free rocking with a history also swing: the same from the energies of the swings, NaN if a swing has no peak.
        On a base also the relative errors of the base velocity jump: against momentum with the run's own rates (jump),
        against e_x of eq. (8) corrected (jump_8), and as printed (jump_8_printed).
    """
    response = dataclasses.replace(response, impacts=strong_impacts(response))
    expected = restitution(scene)
    errors = {
        "state": state_restitution(response) - expected,
        "time": np.array([impact.time for impact in response.impacts]),
    }
    if scene.motion is None and scene.bearings is None and response.history is not None:
        errors["swing"] = swing_restitution(scene, response) - expected
    if scene.base is not None:
        rates = np.array([impact.rate_before for impact in response.impacts])
        jumps = np.array([impact.base_velocity_jump for impact in response.impacts])
        errors["jump"] = base_jump_error(scene, response)
        errors["jump_8"] = jumps / (-base_jump_length(scene) * rates) - 1
        errors["jump_8_printed"] = jumps / (-base_jump_length_as_printed(scene) * rates) - 1
    return {name: values[:most] for name, values in errors.items()}


def rate_restitution(response: Response) -> np.ndarray:
    """Return the restitution of strong impacts of free rocking from successive rates, shape (impacts used,).

    A swing between two impacts conserves energy (and the base's momentum), so the rate before the next impact equals
    the rate after this one. For a solver that applies eq. (7) exactly, the error is that of the swing.
    """
    before = np.array([impact.rate_before for impact in response.impacts])
    fast = np.abs(before) >= SLOWEST_IMPACT * np.abs(before).max(initial=0.0)
    used = fast[:-1] & fast[1:] & (before[:-1] * before[1:] < 0)
    return np.abs(before[1:] / before[:-1])[used]


def rms(values: npt.ArrayLike) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def worst(values: npt.ArrayLike) -> float:
    return float(np.abs(values).max())


def impact_time_errors(response: Response, reference: Response) -> np.ndarray:
    """Return the error of the time [s] of each impact of the reference, shape (impacts,); NaN for a missed one.

    It is the time of the response's nearest impact on the same side, minus that of the reference. The impact counts as
    missed if that is further than half the interval to the reference's neighbouring impacts.
    """
    expected = np.array([impact.time for impact in reference.impacts])
    sides = np.sign([impact.rate_before for impact in reference.impacts])
    times = np.array([impact.time for impact in response.impacts])
    own_sides = np.sign([impact.rate_before for impact in response.impacts])
    errors = np.full(len(expected), np.nan)
    gaps = np.diff(expected, prepend=-math.inf, append=math.inf)
    for i in range(len(expected)):
        near = times[own_sides == sides[i]] - expected[i]
        if len(near):
            error = near[np.abs(near).argmin()]
            if -gaps[i] / 2 <= error <= gaps[i + 1] / 2:
                errors[i] = error
    return errors


def strong_time_errors(response: Response, reference: Response, until: float = math.inf) -> np.ndarray:
    """Return `impact_time_errors` for the reference's strong impacts up to `until` [s]."""
    strong = {impact.time for impact in strong_impacts(reference) if impact.time <= until}
    return impact_time_errors(response, reference)[[impact.time in strong for impact in reference.impacts]]


def lost_impacts(response: Response, reference: Response, until: float = math.inf) -> int:
    """Return the number of strong impacts of the reference up to `until` [s] that the response misses."""
    return int(np.isnan(strong_time_errors(response, reference, until)).sum())


def graph_distance(
    response: Response, reference: Response, *, tilt_scale: float, time_scale: float, until: float = math.inf
) -> float | None:
    """Return the Hausdorff distance of the graphs (time/time_scale, tilt/tilt_scale) of two responses.

    None if a history has fewer than two samples up to `until` [s].

    This is the measure for motions whose velocity jumps (M. D. P. Monteiro Marques 1987,
    doi:10.1016/0022-0396(87)90143-4; V. Acary 2012, doi:10.1016/j.apnum.2012.06.026), here with the Euclidean norm in
    place of the maximum norm. An impact that is late by dt contributes dt/time_scale, however large the difference at
    one instant. Distances are measured from the samples of one graph to the straight lines between the samples of the
    other. The samples are those up to `until`, or up to the end of the shorter history; the lines may lie beyond.
    """
    graphs = [_history(each) for each in (response, reference)]
    end = min(until, *(history.time[-1] for history in graphs))
    (ta, ya), (tb, yb) = lines = [(history.time / time_scale, history.tilt / tilt_scale) for history in graphs]
    spans = []
    for time, tilt in lines:
        inside = time <= end / time_scale
        if inside.sum() < 2:
            return None
        span = time[inside], tilt[inside]
        if span[0][-1] < end / time_scale:
            last = np.interp(end / time_scale, time, tilt)
            span = np.append(span[0], end / time_scale), np.append(span[1], last)
        spans.append(span)
    return float(max(_directed(*spans[0], tb, yb), _directed(*spans[1], ta, ya)))


@njit(cache=True)
def _segment_distance(t, y, t0, y0, t1, y1):
    dt, dy = t1 - t0, y1 - y0
    length2, along = dt * dt + dy * dy, 0.0
    if length2 > 0:  # otherwise both samples are the same point, as the last two of a history may be
        along = min(1.0, max(0.0, ((t - t0) * dt + (y - y0) * dy) / length2))
    return math.hypot(t - t0 - along * dt, y - y0 - along * dy)


@njit(cache=True)
def _directed(ta, ya, tb, yb):
    """The largest distance of a point of graph a from graph b, which is searched outward from the same time."""
    worst = 0.0
    for i in range(len(ta)):
        begin = min(max(np.searchsorted(tb, ta[i]) - 1, 0), len(tb) - 2)
        best = np.inf
        for k in range(begin, len(tb) - 1):
            if tb[k] - ta[i] > best:
                break
            best = min(best, _segment_distance(ta[i], ya[i], tb[k], yb[k], tb[k + 1], yb[k + 1]))
        for k in range(begin - 1, -1, -1):
            if ta[i] - tb[k + 1] > best:
                break
            best = min(best, _segment_distance(ta[i], ya[i], tb[k], yb[k], tb[k + 1], yb[k + 1]))
        worst = max(worst, best)
    return worst


def energy_errors(
    scene: Scene, response: Response, *, until: float = math.inf, step: float = 0.0, settle: float = SETTLE
) -> tuple[float, float]:
    """Return (drift between events, gain without a source) up to `until` [s] or the unstable point, from the history.

    Drift: the largest change of the balance (mechanical energy + loss in the bearings - input work) within a swing or
    rest, over m g R (1 - cos gamma); 0 if exact. Samples within about one sample or `step` [s] of an event are left
    out. Gain: as `engines.trace_checks.energy_gain`, without the time `settle` [s] after an uplift or impact.
    """
    history = _history(response)
    last = min(until, math.inf if response.unstable_time is None else response.unstable_time)
    trace = Trace(*(getattr(history, name) for name in Trace.COLUMNS), contact_tilt=1e-12, settle=settle)  # type: ignore[misc]  # the columns come before these
    trace = trace.upto(max(2, int(np.searchsorted(history.time, last, side="right"))))
    balance, _ = energy_balance(scene, trace)
    events = sorted([impact.time for impact in response.impacts] + list(response.rests) + list(response.uplifts))
    beside = max(SETTLE, 1.5 * float(np.diff(trace.time).max()), 1.5 * step)
    begins = np.searchsorted(trace.time, np.add([-math.inf] + events, beside))
    ends = np.searchsorted(trace.time, np.subtract(events + [math.inf], beside))
    drift = max((np.ptp(balance[a:b]) for a, b in zip(begins, ends, strict=True) if b > a), default=0.0)
    block = scene.block
    unit = block.mass * scene.gravity * block.radius * (1 - math.cos(block.slenderness))
    return float(drift / unit), energy_gain(scene, trace)


@dataclass(frozen=True)
class Agreement:
    """The errors of a response, response minus reference.

    overturning_time_error [s]: None unless both overturn. peak_tilt_error: over the slenderness.
    peak_displacement_error: relative to the reference's peak, None on rigid ground. impact_time_error [s]: root mean
    square over the matched impacts, None without any. lost_impacts: impacts of the reference that are missed.
    graph_distance: of the tilt, None with fewer than two samples. The last three are taken up to `until` [s].
    """

    same_outcome: bool
    overturning_time_error: float | None
    peak_tilt_error: float
    peak_displacement_error: float | None
    impact_time_error: float | None
    lost_impacts: int
    graph_distance: float | None
    until: float


def compare(scene: Scene, response: Response, reference: Response, *, until: float = math.inf) -> Agreement:
    """Return the `Agreement` of two responses of a scene, with trajectories up to the sensitivity horizon `until` [s].

    Tilt is scaled by the slenderness and time by 2 pi/omega_r.
    """
    overturning = None
    if response.overturning_time is not None and reference.overturning_time is not None:
        overturning = response.overturning_time - reference.overturning_time
    displacement = None
    if scene.base is not None and reference.peak_base_displacement > 0:
        displacement = response.peak_base_displacement / reference.peak_base_displacement - 1
    errors = strong_time_errors(response, reference, until)
    known = errors[np.isfinite(errors)]
    distance = None
    if response.history is not None and reference.history is not None:
        distance = graph_distance(
            response,
            reference,
            tilt_scale=scene.block.slenderness,
            time_scale=2 * math.pi / scene.rocking_frequency,
            until=until,
        )
    return Agreement(
        same_outcome=response.outcome == reference.outcome,
        overturning_time_error=overturning,
        peak_tilt_error=(response.peak_tilt - reference.peak_tilt) / scene.block.slenderness,
        peak_displacement_error=displacement,
        impact_time_error=float(np.sqrt(np.mean(known**2))) if len(known) else None,
        lost_impacts=len(errors) - len(known),
        graph_distance=distance,
        until=until,
    )


def _rates(response):
    return np.array([(impact.rate_before, impact.rate_after) for impact in response.impacts]).reshape(-1, 2)


def _history(response):
    if response.history is None:
        raise ValueError("this measure needs a history: simulate with history=True")
    return response.history


# Relative change of the copies if no solver is given. Errors of tuned engines correspond to 1e-5 to 1e-3.
PERTURBATION = 1e-4
# Sizes of a solver's perturbation: least, factor from one to the next, most.
LEAST, LADDER, MOST = 1e-6, 2.0, 0.5
# Share of the slenderness: copies further apart no longer show the same motion.
SPREAD = 0.01
# Share of SPREAD at which a solver's distance from the model measures its errors: early enough to predict where it
# reaches SPREAD, and above the error of sampling.
EARLY = 0.1
# Samples of the copies in a period 2 pi/omega_r, so that no part of a swing is overlooked.
SAMPLES_PER_PERIOD = 1000


@dataclass(frozen=True, eq=False)
class Horizon:
    """The sensitivity horizon [s], and the spread of the copies that it follows from.

    horizon: the last time before a copy departs, or the end of the run. perturbation: relative change of the copies
    [-]. time [s] and spread, arrays of shape (n,): the largest |tilt of a copy - tilt of the scene| / slenderness up to
    each time. copies: {name of the copy: time [s] at which it departed, or None}.
    """

    horizon: float
    perturbation: float
    time: np.ndarray
    spread: np.ndarray
    copies: dict

    @property
    def parts(self) -> bool:
        """Whether a copy departs before the run ends."""
        return any(time is not None for time in self.copies.values())


def sensitivity_horizon(scene: Scene, *, perturbation: float = PERTURBATION) -> Horizon:
    """Return the time until which the motion of a scene can be compared point by point.

    Parameters
    ----------
    scene : Scene
    perturbation : float
        Relative change of restitution, motion amplitude and start, above 0 and below 1. A copy that the model refuses
        is left out.
    """
    period = 2 * np.pi / scene.rocking_frequency
    step = min(period / SAMPLES_PER_PERIOD, (scene.duration or period) / 2)
    base = simulate(scene, output_step=step).history
    largest = np.zeros(len(base.time))
    parted = {}
    for name, copy in changed_copies(scene, perturbation).items():
        try:
            other = simulate(copy, output_step=step).history
        except SceneError:
            continue
        # A copy that has overturned and ended keeps its last tilt.
        tilt = np.interp(base.time, other.time, other.tilt)
        apart = np.abs(tilt - base.tilt) / scene.block.slenderness
        beyond = np.flatnonzero(apart > SPREAD)
        parted[name] = float(base.time[max(beyond[0] - 1, 0)]) if len(beyond) else None
        largest = np.maximum(largest, apart)
    times = [time for time in parted.values() if time is not None]
    return Horizon(
        min(times, default=float(base.time[-1])), perturbation, base.time, np.maximum.accumulate(largest), parted
    )


def perturbation_of(scene: Scene, response: Response, reference: Response) -> float:
    """Return the relative change of `changed_copies` that has as much effect as the errors of a solver.

    The size starts at `restitution_error` and grows by factors of `LADDER`, until the copies differ from the model as
    much as the solver's tilt does when it first differs by `EARLY` times `SPREAD`. This holds for all errors:
    compliance, steps, times of uplift, missed impacts.

    Parameters
    ----------
    scene : Scene
    response, reference : Response
        The solver's and the analytic model's, with histories.

    Returns
    -------
    float
        At least `LEAST`, at most `MOST`.
    """
    solver, model = response.history, reference.history
    time = model.time[model.time <= solver.time[-1]]
    apart = np.abs(np.interp(time, solver.time, solver.tilt) - model.tilt[: len(time)]) / scene.block.slenderness
    off = np.flatnonzero(apart > EARLY * SPREAD)
    until = time[off[0]] if len(off) else np.inf
    error = (
        _slipping_error(scene, response, reference, until)
        if reference.sliding
        else restitution_error(scene, response, until=until)
    )
    size = max(LEAST, error)
    if len(off) and off[0] > 0:
        short = scene.with_(duration=float(time[off[0]]))
        while size < MOST and sensitivity_horizon(short, perturbation=size).spread[-1] < apart[off[0]]:
            size *= LADDER
    return float(min(size, MOST))


def restitution_error(scene: Scene, response: Response, *, until: float = np.inf) -> float:
    """Return the relative rms error of e_phi over the impacts up to `until` [s], weighted by rate; 0 without any."""
    rates = np.array([impact.rate_before for impact in response.impacts if impact.time <= until])
    e = RockingModel.of(scene).restitution
    if not len(rates) or e == 0:
        return 0.0
    errors = state_restitution(response)[: len(rates)] / e - 1
    return float(np.sqrt(np.sum((rates * errors) ** 2) / np.sum(rates**2)))


def _slipping_error(scene: Scene, response: Response, reference: Response, until: float) -> float:
    """`restitution_error` of a block that slides, against matching impacts of the model, since (7) does not hold."""
    here, there = impacts_of(response), impacts_of(reference)
    meant, partner = matched(scene, there, here, until)
    (_, before, after), (_, model, left) = here[partner[partner >= 0]].T, meant[partner >= 0].T
    if not len(before):
        return 0.0
    errors = after / before / (left / model) - 1
    return float(np.sqrt(np.sum((before * errors) ** 2) / np.sum(before**2)))


def solver_horizon(scene: Scene, response: Response, reference: Response) -> Horizon:
    """Return the `Horizon` of a solver, for its own `perturbation_of`."""
    return sensitivity_horizon(scene, perturbation=perturbation_of(scene, response, reference))


HEAVY = 1e6  # mass of a base that represents rigid ground, over the block's
SUPPORT_FREQUENCY = 2 * math.pi * 50  # rad/s, of a support meant to be rigid


def on_heavy_base(scene: Scene) -> Scene:
    """Model rigid ground as a free base of 10^6 block masses: two degrees of freedom instead of one."""
    return scene.with_(base=Base(mass=HEAVY * scene.block.mass))


def on_stiff_springs(scene: Scene) -> Scene:
    """Model rigid ground as a heavy base on linear springs of 50 Hz: two degrees of freedom, one of them stiff."""
    base = Base(mass=HEAVY * scene.block.mass)
    springs = Bearings(law="linear", ka=(base.mass + scene.block.mass) * SUPPORT_FREQUENCY**2)
    return scene.with_(base=base, bearings=springs)
