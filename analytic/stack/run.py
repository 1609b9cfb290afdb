"""A run of a statue on a free pedestal, by scipy's DOP853 between events; `solver.simulate_stack` starts it.

One integration covers an interval of smooth motion. It ends at the next corner of the ground motion, or at an event:
an uplift, a landing, a reversal or a corner of the bearings, the largest tilt of a swing, the passage of a slenderness,
a fall, or the loss of contact. In each step the functions of all events are read at points of the dense output. One
that becomes negative has an event there; one with a minimum between points that may be negative is searched for it.

Landings whose bounces have become lower than `REST` slendernesses end in rest: the limit of the accumulation is the
velocities at which that interface is in full contact, by the same law of impact.

The model ends where the pivot would have to jump at an impact, and where a normal force vanishes while both blocks are
tilted, from what carries them, by less than `FALLING`. Beyond that it is a fall, which goes on until a block has turned
by pi/2.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from ..kernel.compiled import entry
from ..kernel.decision import (
    longest_duration,
    motion_end,
    peaks_are_final,
    recoverable_energy,
    run_warnings,
    shortest_duration,
    will_not_overturn,
)
from ..kernel.layout import Base, Body
from ..motion import shared_segments
from ..response import Failure, History, Impact, Response, Stack, State
from ..rocking import uplift_of_both
from .equations import LOWER, UPPER, Instant, StackModel

if TYPE_CHECKING:
    from ..kernel.layout import Parameters
    from ..scene import Scene

RTOL, ATOL = 3e-14, 1e-15  # of a step; ATOL in rad, m, s and limit forces of the bearings
POINTS = 6  # of a step at which events are looked for
REST = 1e-10  # slendernesses; of 100 times less, rates later differ by 1e-11 of theirs, and peaks by none
FALLING = 0.6  # rad, see above
TOGETHER = 1e-12  # rad: a corner that is closer to what carries it at an impact is closed, too
SIZABLE = 0.01  # omega_r slenderness: slower landings, as at the end of an accumulation, have no part in `closest`
STEPS = 200_000  # of a run, a minute or two; the longest seen took some thousands
NAMES, FALLS = ("pedestal", "statue"), ("pedestal overturns", "overturns")
LOST, JUMPS = "outside the model: contact is lost", "outside the model: the pivot would jump"


class _Ended(Exception):
    """The run cannot go on; says why."""


@entry
def _recoverable(law, constants, z):
    return recoverable_energy(law, constants, z)


class Run:
    """The state of a run: time, sides of the pivots, y = [phi_1, phi_1', psi, psi', x, x', z]; and its results.

    psi = phi_2 - phi_1 is the tilt of the statue from the pedestal, which is thus known to its own last digit. z [N] of
    one bearing is there where its law is a rate. par : of the same scene with a fixed pedestal.
    """

    def __init__(self, scene: Scene, par: Parameters, history: bool, pedestal_tilt: float) -> None:
        self.scene, self.model, start = scene, StackModel.of(scene), scene.start
        self.law, self.frequency = self.model.bearing, scene.rocking_frequency
        first_uplift = min(par.slope, uplift_of_both(scene) / scene.gravity)
        self.par = par._replace(slope=first_uplift)  # of the blocks in full contact
        lower, upper = (scene.gravity * slab.mass for slab in self.model.slabs)
        self.weights, self.gammas = (lower + upper, upper), [slab.slenderness for slab in self.model.slabs]
        self.fixed = start.base_displacement, self.law.start(start.base_displacement)  # x, z at the last reversal
        rate_of = self.law.unit.branch
        self.y = np.array(
            [pedestal_tilt, 0.0, start.tilt, 0.0, self.fixed[0], 0.0, *([self.fixed[1]] if rate_of else [])]
        )
        self.atol = np.array([ATOL] * 6 + [ATOL * self.law.f0])[: len(self.y)]
        self.sides, self.lifted = [int(np.sign(pedestal_tilt)), int(np.sign(start.tilt))], [0.0, 0.0]
        self.t, self.step, self.steps, self.fallen = 0.0, 0.05 / self.frequency, 0, -1
        stiffness = self.law.count * (self.law.kb + self.law.dk)
        self.longest = 0.5 * math.sqrt(self.model.mass / stiffness) if stiffness else math.inf
        self.peaks = np.abs([pedestal_tilt, start.tilt, pedestal_tilt + start.tilt])
        # largest |x|, |a|, friction demands, least normal forces over weights (negative); and with the time when each
        # block last passed its slenderness
        self.most = np.array([abs(self.fixed[0]), 0.0, 0.0, 0.0, -1.0, -1.0])
        self.held = [(0.0, self.most), (0.0, self.most)]
        self.unstable: float | None = None
        self.impacts: tuple[list[Impact], list[Impact]] = ([], [])
        self.uplifts: tuple[list[float], list[float]] = ([], [])
        self.rests: tuple[list[float], list[float]] = ([], [])
        self.ratios = [0.0, 0.0]
        self.rows: list[Sequence[float]] | None = [] if history else None

    # equations

    def hysteretic(self, y: np.ndarray) -> float:
        """Return z of one bearing [N]: of the state, or in closed form from the last reversal."""
        return float(y[6]) if self.law.unit.branch else self.law.hysteretic(self.fixed[1], float(y[4]) - self.fixed[0])

    def force(self, y: np.ndarray) -> float:
        """Return the force of all bearings [N]."""
        return self.law.force(float(y[4]), self.hysteretic(y), float(y[5]))

    @staticmethod
    def absolute(y: np.ndarray) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the absolute tilts, and their rates."""
        tilt, rate, psi, turn = y[:4].tolist()
        return (tilt, tilt + psi), (rate, rate + turn)

    def instant(self, t: float, y: np.ndarray, sides: Sequence[int] | None = None) -> Instant:
        """Return what the equations give, by default with the sides as they are."""
        loads = self.ground(t), self.force(y), self.vertical(t)
        return self.model.instant(self.sides if sides is None else sides, *self.absolute(y), *loads)

    def slope(self, t: float, y: np.ndarray) -> list[float]:
        """Return y'."""
        now = self.instant(t, y)
        slope = [y[1], now.spins[0], y[3], now.spins[1] - now.spins[0], y[5], now.a - self.ground(t)]
        return [*slope, self.branch(y[6], y[5])] if self.branch else slope

    # one interval

    def go(self) -> Failure | None:
        """Run to the end; return a `Failure` where the model ends before."""
        scene, self.shortest = self.scene, math.inf
        end = scene.duration
        if end is None:
            end, self.shortest = longest_duration(scene), shortest_duration(scene)
        try:
            for _, until, self.ground, self.vertical in shared_segments(scene.motion, end):
                for stop in (min(self.shortest, until), until):  # from `shortest` on the run may end
                    while self.t < stop and self.fallen < 0 and not self.finished():
                        self.stretch(stop)
        except _Ended as cause:
            return Failure(str(cause), f"at {self.t:.6g} s", self.state())
        return None

    def stretch(self, end: float) -> None:
        """Integrate to `end` or to the first event, and apply that."""
        self.settle()
        self.prepare(end)
        if (not self.scene.base and self.sides == [0, 0]) or end - self.t < 8 * math.ulp(end):  # at rest, or no time
            if not self.followed(end, lambda t: np.multiply.outer(self.y, np.ones_like(t))):
                self.t = end
            return
        first = min(self.step, end - self.t, self.longest)
        solver = DOP853(
            self.slope, self.t, self.y, end, rtol=RTOL, atol=self.atol, max_step=self.longest, first_step=first
        )
        while solver.status == "running":
            message, self.steps = solver.step(), self.steps + 1
            if solver.status == "failed" or self.steps > STEPS:
                raise _Ended(message or "too many steps")
            self.step = solver.h_abs
            if self.followed(solver.t, solver.dense_output()):
                return
            self.t, self.y = solver.t, solver.y
            if self.finished():
                return

    def prepare(self, end: float) -> None:
        """Set the direction of the base's travel, the law's branch in it, and its next corner."""
        self.travel, self.branch, z = float(np.sign(self.y[5])), None, self.hysteretic(self.y)
        for t in (self.t, self.t + 1e-3 * (end - self.t)):  # at the start of a motion a_g may still be 0
            self.travel = self.travel or float(np.sign(self.instant(t, self.y).a - self.ground(t)))
        if self.law.unit.branch:
            self.branch = self.law.unit.branch(z, self.travel, self.law.constants)
        self.corner = self.law.unit.begin.py_func(self.travel, z, 1.0, 0.0, self.law.constants)[2]

    def settle(self) -> None:
        """Let interfaces in full contact open where their centres of pressure are beyond a corner, as after a jump.

        After one a normal force may be negative, too.
        """
        shut = [side == 0 for side in self.sides]
        loads = self.ground(self.t), self.force(self.y), self.vertical(self.t)
        sides = self.model.opened(self.sides, shut, *self.absolute(self.y), *loads)
        for k in (LOWER, UPPER):
            if sides and sides[k] != self.sides[k]:
                self.lift(k, sides[k])
        if not sides or (np.abs(self.y[:4:2]) < FALLING).all() and min(self.instant(self.t, self.y).normal) <= 0:
            self.keep(self.t, self.y)
            raise _Ended(LOST)

    def lift(self, k: int, side: int) -> None:
        self.sides[k], self.lifted[k] = side, self.t
        self.uplifts[k].append(self.t)

    # events

    def watch(self, t: float, y: np.ndarray) -> dict[tuple[str, int], float]:
        """Return {(event, interface): a function that is above 0 until the event}."""
        now, watched, tilts = self.instant(t, y), {}, y[:4:2].tolist()
        upright = max(map(abs, tilts)) < FALLING
        for k, slab in enumerate(self.model.slabs):
            side, tilt = self.sides[k], abs(tilts[k])
            if side:
                # the root at the uplift is divided out
                watched["landing", k] = side * tilts[k] / (t - self.lifted[k]) if t > self.lifted[k] else 1.0
                watched["turn", k] = side * y[2 * k + 1] if tilt > 0.9 * self.peaks[k] else 1.0  # else no new peak
                watched["passage", k] = self.gammas[k] - tilt
                watched["fall", k] = 0.5 * math.pi - tilt
            else:
                watched["uplift", k] = slab.b - abs(now.pressure[k])
            watched["loss", k] = now.normal[k] if upright else 1.0
        if self.travel:
            watched["reversal", 0] = self.travel * y[5]
            watched["corner", 0] = min(self.corner - self.travel * self.hysteretic(y), self.law.f0)
        return watched

    def followed(self, end: float, dense: Callable[[Any], np.ndarray]) -> bool:
        """Follow a step, y(t) = dense(t), to its first event, and apply it; return whether there was one."""
        times, width = np.linspace(self.t, end, POINTS + 1), (end - self.t) / POINTS
        times = np.array([times[0] - width, *times, end + width])  # beyond both ends: minima there
        states = dense(times).T
        rows = [self.watch(t, y) for t, y in zip(times.tolist(), states, strict=True)]
        keys, table, until, event = list(rows[0]), np.array([[*row.values()] for row in rows]), math.inf, None
        for i, j in zip(*np.nonzero(suspect(table)), strict=True):
            if times[i] <= until and (root := self.root(keys[j], times, table[:, j], i, dense)) < until:
                until, event = root, keys[j]
        for t, y in zip(times[1:-1].tolist(), states[1:-1], strict=True):
            if t < until:
                self.keep(t, y)
        if event:
            self.t, self.y = until, dense(until).ravel()
            self.keep(self.t, self.y)
            self.apply(*event)
        return event is not None

    def root(self, key: tuple[str, int], times: np.ndarray, values: np.ndarray, i: int, dense: Callable) -> float:
        """Return the time [s] of an event after point i, or at a minimum beside it; inf where that is above 0.

        At it the function is 0 or less, so that the event is not found again.
        """

        def value(t: float) -> float:
            return self.watch(t, dense(t).ravel())[key]

        low, high, crosses = float(times[i]), float(times[i + 1]), values[i + 1] <= 0 and i <= POINTS
        if not crosses:
            low, high = float(times[max(i - 1, 1)]), float(times[min(i + 1, POINTS + 1)])
            high = float(minimize_scalar(value, bounds=(low, high), method="bounded", options={"xatol": 1e-9}).x)
        if not value(low) > 0 >= value(high):  # at a crossing by rounding alone, as many points are read at once
            return (low if value(low) <= 0 else high) if crosses else math.inf
        root = float(brentq(value, low, high, xtol=1e-16, rtol=1e-15))
        while value(root) > 0:
            root = min(root + 4 * math.ulp(root), high)
        return root

    def keep(self, t: float, y: np.ndarray) -> None:
        """Include a state in the extremes and the history."""
        now, (tilt, _, psi, turn, x, v) = self.instant(t, y), y[:6].tolist()
        self.peaks = np.maximum(self.peaks, np.abs([tilt, psi, tilt + psi]))
        demands = [abs(along) / normal if normal > 0 else math.inf for along, normal in zip(*now[2:4], strict=True)]
        least = [-normal / weight for normal, weight in zip(now.normal, self.weights, strict=True)]
        self.most = np.maximum(self.most, [abs(x), abs(now.a), *demands, *least])
        row = t, psi, turn, x, v, self.force(y), self.ground(t), tilt
        if self.rows is not None and row not in self.rows[-1:]:  # two rows of a time are before and after an impact
            self.rows.append(row)

    def apply(self, event: str, k: int) -> None:
        """Apply an event at interface k; the largest tilt of a swing, "turn", needs nothing more."""
        match event:
            case "landing":
                self.land(k)
            case "uplift":
                self.lift(k, int(np.sign(self.instant(self.t, self.y).pressure[k])))
            case "loss":
                raise _Ended(LOST)
            case "fall":
                self.fallen = k
            case "passage":
                self.held[k] = self.t, self.most
                if k == UPPER and self.unstable is None:
                    self.unstable = self.t
            case "reversal":
                self.fixed, self.y[5] = (float(self.y[4]), self.hysteretic(self.y)), 0.0
            case "corner":
                self.y[6] = self.travel * self.corner

    # impacts

    def land(self, k: int) -> None:
        """Apply the law of impact, and let interfaces rest whose bounces are over."""
        self.fixed = float(self.y[4]), self.hysteretic(self.y)
        shut = [j == k or not self.sides[j] or abs(self.y[2 * j]) < TOGETHER for j in (LOWER, UPPER)]
        landing = [j for j in (LOWER, UPPER) if shut[j] and self.sides[j]]
        self.y[:4:2][shut] = 0.0
        before = self.y.tolist()
        self.strike(shut, (False, False))
        for j in landing:
            rates = before[2 * j + 1], float(self.y[2 * j + 1])
            self.impacts[j].append(Impact(self.t, *rates, float(self.y[5]) - before[5]))
        for over in ((True, True), (False, True), (True, False)):  # interfaces that may rest at once
            resting = [j for j in (LOWER, UPPER) if over[j]]
            if any(self.sides[j] for j in resting) and all(shut[j] and self.rests_at(j, over) for j in resting):
                self.strike(shut, over)
                break
        for j in landing:
            if not self.sides[j]:
                self.rests[j].append(self.t)

    def strike(self, shut: Sequence[bool], forced: Sequence[bool]) -> None:
        """Take the velocities and sides after an impact; see `StackModel.impact`. Nothing rests that cannot."""
        answers = self.model.impact(self.sides, *self.absolute(self.y), float(self.y[5]), shut, forced)
        if any(forced):
            answers = [answer for answer in answers if None not in answer.sides][:1]
        elif not answers or None in answers[-1].sides:
            raise _Ended(JUMPS)
        for answer in answers[:1]:
            for k, impulse in enumerate(answer.impulses):
                if shut[k]:
                    self.sides[k], self.lifted[k] = int(answer.sides[k] or 0), self.t
                if impulse.imag > 0 and not any(forced):
                    self.ratios[k] = max(self.ratios[k], abs(impulse.real) / impulse.imag)
            (first, second), v = answer.rates, answer.v
            self.y[1], self.y[3], self.y[5] = first, second - first, v
            self.y[1:4:2][[side == 0 for side in self.sides]] = 0.0  # without rounding

    def rests_at(self, k: int, over: Sequence[bool]) -> bool:
        """Return whether a closed interface is held on both corners, and bounces lower than `REST` slendernesses.

        over : interfaces that rest with it.
        """
        pulls = []
        for side in (-1, 1):
            sides = [side if j == k else 0 if over[j] else each for j, each in enumerate(self.sides)]
            first, second = self.instant(self.t, self.y, sides).spins
            pulls.append(-side * (second - first if k == UPPER else first))
        return self.y[2 * k + 1] ** 2 < 2 * REST * self.gammas[k] * min(pulls)  # height of a bounce: rate^2/(2 pull)

    # end and results

    def remaining_energy(self) -> float:
        """Return the energy [J] that can still reach the blocks after the motion, as `kernel.decision` does for one."""
        model, law, x, v = self.model, self.law, float(self.y[4]), float(self.y[5])
        tilts, rates = self.absolute(self.y)
        energy = model.kinetic_energy(self.sides, tilts, rates, v) + model.height_energy(*self.y[:4:2].tolist())
        if self.scene.base and not law.count:  # its momentum is conserved
            *_, c1, c2 = model.geometry(self.sides, tilts)
            energy -= 0.5 * (model.mass * v + c1 * rates[0] + c2 * rates[1]) ** 2 / model.mass
        back = _recoverable(float(law.law), law.constants, self.hysteretic(self.y))
        return energy + law.count * (0.5 * law.kb * x * x + back)

    def at_rest(self) -> tuple[Parameters, Body, Base]:
        """Return the arguments of the rules of `kernel.decision`, of blocks in full contact."""
        base = Base(float(self.y[4]), float(self.y[5]), self.hysteretic(self.y))
        return self.par, Body(0.0, 0.0, 0.0), base

    def certain(self) -> bool:
        """Return whether the outcome is: after a fall, or where energy or, in full contact, force is too low."""
        if self.fallen >= 0 or self.t < motion_end(self.scene) * (1 - 1e-9):
            return self.fallen >= 0
        if self.sides == [0, 0] and will_not_overturn(*self.at_rest(), False):
            return True
        most, *rim = self.model.barrier
        return bool((np.abs(self.y[:4:2]) < rim).all()) and self.remaining_energy() < most

    def finished(self) -> bool:
        """Return whether a run without a duration may end: the outcome is certain, and no peak can grow."""
        if self.t < self.shortest or not self.certain():
            return False
        if self.sides == [0, 0]:
            return bool(peaks_are_final(*self.at_rest(), (float(self.peaks.max()), float(self.most[0]), -1.0)))
        return not self.scene.base and self.remaining_energy() < self.model.rim(*self.peaks[:2].tolist())

    def state(self) -> State:
        """Return the statue's state on the pedestal, and the base's."""
        psi, turn, x, v = self.y[2:6].tolist()
        return State(self.t, psi, turn, x, v, self.force(self.y))

    def response(self, cpu_seconds: float, failure: Failure | None) -> Response:
        """Return the `Response` of the run."""
        scene, fell = self.scene, self.fallen >= 0
        fall_time, most = self.held[self.fallen] if fell else (None, self.most)
        rocked = tuple(name for name, peak in zip(NAMES, self.peaks, strict=False) if peak > 0)
        outcome = FALLS[self.fallen] if fell else "failed" if failure else "rocks" if rocked else "stands"
        x, acceleration, lower_demand, demand, lower_least, least = most.tolist()
        (tilt, psi, absolute), columns = self.peaks.tolist(), np.array(self.rows).T
        period, least_rate = 2 * math.pi / self.frequency, SIZABLE * self.frequency
        sizable = [
            (impact.time / period, k)
            for k, impacts in enumerate(self.impacts)
            for impact in impacts
            if abs(impact.rate_before) > least_rate * self.gammas[k]
        ]
        pairs = itertools.pairwise(sorted(sizable))
        stack = Stack(
            rocked=rocked,
            peak_tilt=tilt,
            statue_tilt=absolute,
            impacts=tuple(self.impacts[LOWER]),
            uplifts=tuple(self.uplifts[LOWER]),
            rests=tuple(self.rests[LOWER]),
            friction_demand=lower_demand,
            min_normal_ratio=-lower_least,
            impulses=(self.ratios[LOWER], self.ratios[UPPER]),
            closest=min((later[0] - sooner[0] for sooner, later in pairs if sooner[1] != later[1]), default=None),
        )
        return Response(
            engine="analytic",
            variant="stack",
            outcome=outcome,
            overturning_time=self.t if fell else None,
            unstable_time=self.unstable,
            fall_time=fall_time,
            peak_tilt=psi,
            peak_tilt_ratio=psi / self.gammas[UPPER],
            peak_base_displacement=x,
            peak_base_acceleration=acceleration,
            impacts=tuple(self.impacts[UPPER]),
            uplifts=tuple(self.uplifts[UPPER]),
            rests=tuple(self.rests[UPPER]),
            friction_demand=demand,
            min_normal_ratio=-least,
            end=self.state(),
            cpu_seconds=cpu_seconds,
            steps=self.steps,
            settings={"method": "DOP853", "rtol": RTOL},
            versions={"numpy": np.__version__, "scipy": scipy.__version__},
            scene=scene.name,
            decided=failure is None and self.certain(),
            warnings=run_warnings(scene, demand, -least, x, float(self.y[5])),
            failure=failure,
            stack=stack,
            history=None if self.rows is None else History(*columns[:7], None, columns[7]),  # type: ignore[call-arg]  # of seven
        )


def suspect(table: np.ndarray) -> np.ndarray:
    """Return where a function, (points, events), becomes negative, or has a minimum that may be."""
    found = np.zeros(table.shape, bool)
    left, middle, right = table[:-2], table[1:-1], table[2:]
    found[1:-2] = (middle[:-1] > 0) & (middle[1:] <= 0)
    bend = right - 2 * middle + left
    lowest = (right - left) ** 2 / (8 * np.where(bend > 0, bend, math.inf))  # of a parabola, below the middle
    found[1:-1] |= (middle > 0) & (middle <= np.minimum(left, right)) & (2 * lowest > middle)
    return found
