"""A run of a statue on a free pedestal: `simulate_stack`, by scipy's DOP853 between events.

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

import math
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy
from scipy.integrate import DOP853
from scipy.optimize import brentq, minimize_scalar

from ..checks.twin import shared_segments
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
from ..response import Failure, History, Impact, Response, Stack, State
from ..rocking import uplift_of_both
from ..solver import compile_kernels, parameters, too_long, versions
from .equations import LOWER, UPPER, Instant, StackModel

if TYPE_CHECKING:
    from ..errors import GroundFunction
    from ..scene import Scene

RTOL, ATOL = 3e-14, 1e-15  # of a step; ATOL in rad, m, s and limit forces of the bearings
POINTS = 6  # of a step at which events are looked for
REST = 1e-10  # slendernesses; of 100 times less, rates later differ by 1e-11 of theirs, and peaks by none
FALLING = 0.6  # rad, see above
TOGETHER = 1e-12  # rad: a corner that is closer to what carries it at an impact is closed, too
SIZABLE = 0.01  # omega_r slenderness: slower landings, as at the end of an accumulation, have no part in `closest`
EVENTS = 50_000  # of a run
NAMES = ("pedestal", "statue")


class _Outside(Exception):
    """The run has left the model."""


@entry
def _recoverable(law, constants, z):
    return recoverable_energy(law, constants, z)


def simulate_stack(scene: Scene, *, history: bool = True, pedestal_tilt: float = 0.0) -> Response:
    """Simulate a statue on a free pedestal.

    Without a duration the run ends when, after the motion, the energy suffices for no fall and no larger peak, or at
    `longest_duration`.

    Parameters
    ----------
    scene : Scene
        With a free pedestal. The tilt at the start is that of the statue from the pedestal.
    history : bool
        Keep the history, at the points where events were looked for.
    pedestal_tilt : float
        Tilt of the pedestal at the start [rad].

    Returns
    -------
    Response
        Tilts, impacts, friction demand and normal force are those of the statue on the pedestal; `Response.stack` has
        those of the pedestal. A run that has left the model has failed, for a reason "outside the model: ...".

    Raises
    ------
    SceneError
        The run has too many events; the message names the cause in the scene.
    """
    compile_kernels()
    begin = time.process_time()
    run = _Run(scene, history, pedestal_tilt)
    failure = run.go()
    return run.response(time.process_time() - begin, failure)


class _Run:
    """The state of a run: time, sides of the pivots, y = [phi_1, phi_1', psi, psi', x, x', z]; and its results.

    psi = phi_2 - phi_1 is the tilt of the statue from the pedestal, which is thus known to its own last digit. x and x'
    are there on a base, z [N] of one bearing where its law is a rate.
    """

    def __init__(self, scene: Scene, history: bool, pedestal_tilt: float) -> None:
        self.scene, self.model = scene, StackModel.of(scene)
        self.law, start, self.on_base = self.model.bearing, scene.start, scene.base is not None
        self.par = parameters(scene.with_(pedestal={"free": False}))
        slope = min(scene.block.half_width / scene.block.half_height, uplift_of_both(scene) / scene.gravity)
        self.par = self.par._replace(slope=slope)  # the first uplift of either
        self.weights = scene.gravity * (self.model.lower.mass + scene.block.mass), scene.gravity * scene.block.mass
        self.gammas = tuple(slab.slenderness for slab in self.model.slabs)
        y = [pedestal_tilt, 0.0, start.tilt, 0.0]
        self.fixed = start.base_displacement, self.law.start(start.base_displacement)  # x, z at the last reversal
        if self.on_base:
            y += [start.base_displacement, 0.0, *([self.fixed[1]] if self.law.unit.branch else [])]
        self.y, self.t = np.array(y), 0.0
        self.atol = np.array([ATOL] * 6 + [ATOL * self.law.f0])[: len(y)]
        self.sides = [int(np.sign(pedestal_tilt)), int(np.sign(start.tilt))]
        self.lifted, self.step, self.corner, self.travel = [0.0, 0.0], 0.05 / scene.rocking_frequency, math.inf, 0.0
        self.longest_step = math.inf
        if self.on_base and (stiffness := self.law.count * (self.law.kb + self.law.dk)):
            self.longest_step = 0.5 * math.sqrt(self.model.mass / stiffness)
        self.peaks, self.statue_tilt = [abs(pedestal_tilt), abs(start.tilt)], abs(pedestal_tilt + start.tilt)
        # largest |x|, |a|, friction demands; least normal forces over weights; the same when each block last passed
        # its slenderness, with the time
        self.most = np.array([abs(start.base_displacement), 0.0, 0.0, 0.0, -1.0, -1.0])
        self.held = [(0.0, self.most.copy())] * 2
        self.impacts, self.uplifts, self.rests = ([], []), ([], []), ([], [])
        self.unstable: float | None = None
        self.fallen: int | None = None
        self.ratios, self.closest, self.last, self.steps = [0.0, 0.0], math.inf, (-1, 0.0), 0
        self.rows: list[Sequence[float]] | None = [] if history else None

    # equations

    def hysteretic(self, y: np.ndarray) -> float:
        """Return z of one bearing [N]: of the state, or in closed form from the last reversal."""
        return float(y[6]) if self.law.unit.branch else self.law.hysteretic(self.fixed[1], float(y[4]) - self.fixed[0])

    def force(self, y: np.ndarray) -> float:
        """Return the force of all bearings [N]."""
        return self.law.force(float(y[4]), self.hysteretic(y), float(y[5])) if self.on_base else 0.0

    def instant(self, t: float, y: np.ndarray, sides: Sequence[int] | None = None) -> Instant:
        """Return what the equations give, by default with the sides as they are."""
        loads = self.ground(t), self.force(y), self.vertical(t)
        return self.model.instant(self.sides if sides is None else sides, *self.absolute(y), *loads)

    def slope(self, t: float, y: np.ndarray) -> list[float]:
        """Return y'."""
        now = self.instant(t, y)
        slope = [y[1], now.spins[0], y[3], now.spins[1] - now.spins[0]]
        if self.on_base:
            slope += [y[5], now.a - self.ground(t)]
        return slope + [self.branch(y[6], y[5])] if self.branch else slope

    @staticmethod
    def relative(y: np.ndarray, at: int = 0) -> tuple[float, float]:
        """Return the tilts (at = 0) or rates (1) of the pedestal, and of the statue from it."""
        return float(y[at]), float(y[2 + at])

    @staticmethod
    def absolute(y: np.ndarray) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the absolute tilts, and their rates."""
        tilt, rate, psi, turn = y[:4].tolist()
        return (tilt, tilt + psi), (rate, rate + turn)

    # one interval

    def go(self) -> Failure | None:
        """Run to the end; return a `Failure` where that is outside the model."""
        scene, decides = self.scene, self.scene.duration is None
        end = longest_duration(scene) if scene.duration is None else scene.duration
        self.shortest = shortest_duration(scene) if decides else math.inf
        events = 0
        try:
            for _, until, self.ground, self.vertical in shared_segments(scene.motion, end):
                for stop in (self.shortest, until):  # where a run may end
                    while self.t < min(stop, until) and self.fallen is None and not self.finished():
                        event = self.stretch(min(stop, until))
                        if event:
                            getattr(self, "at_" + event[0])(event[1])
                        events += bool(event)
                        if events > EVENTS:
                            raise too_long(scene, f"{events} events of the two blocks")
        except _Outside as cause:
            return Failure(f"outside the model: {cause}", f"at {self.t:.6g} s", self.state())
        return None

    def stretch(self, end: float) -> tuple[str, int] | None:
        """Integrate to `end` or the first event; return that, (name, interface)."""
        self.settle()
        self.prepare(end)
        if not self.on_base and self.sides == [0, 0]:  # at rest
            event = self.step_to(end, lambda t: np.outer(self.y, np.ones_like(t)))
            self.t = self.t if event else end
            return event
        if end - self.t < 8 * math.ulp(end):
            self.t = end
            return None
        first = min(self.step, 1.1 * self.flight(), end - self.t, self.longest_step)
        solver = DOP853(
            self.slope, self.t, self.y, end, rtol=RTOL, atol=self.atol, max_step=self.longest_step, first_step=first
        )
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise _Outside(message)
            self.steps, self.step = self.steps + 1, solver.h_abs
            if event := self.step_to(solver.t, solver.dense_output()):
                return event
            self.t, self.y = solver.t, solver.y
            if self.t > self.shortest and self.finished():
                break
        return None

    def flight(self) -> float:
        """Return the time [s] until an open corner lands, as it moves now; inf where none does."""
        now, times = self.instant(self.t, self.y), [math.inf]
        spins = now.spins[0], now.spins[1] - now.spins[0]
        for side, tilt, rate, spin in zip(self.sides, self.relative(self.y), self.relative(self.y, 1), spins, strict=True):
            tilt, rate, spin = side * tilt, side * rate, side * spin
            if spin < 0 < rate:
                times.append((rate + math.sqrt(rate * rate - 2 * spin * tilt)) / -spin)
        return min(times)

    def prepare(self, end: float) -> None:
        """Set the direction of the base's travel, the law's branch in it, and its next corner."""
        self.travel, self.branch, self.corner, z = 0.0, None, math.inf, self.hysteretic(self.y) if self.on_base else 0.0
        if not self.on_base:
            return
        self.travel = float(np.sign(self.y[5]))
        for t in (self.t, self.t + 1e-3 * (end - self.t)):  # at the start of a motion a_g may still be 0
            self.travel = self.travel or float(np.sign(self.instant(t, self.y).a - self.ground(t)))
        if self.law.unit.branch:
            self.branch = self.law.unit.branch(z, self.travel, self.law.constants)
        if self.travel:
            self.corner = self.law.unit.begin.py_func(self.travel, z, 1.0, self.law.constants)[2]

    def settle(self) -> None:
        """Let interfaces in full contact open where their centres of pressure are beyond a corner, as after a jump."""
        shut = [side == 0 for side in self.sides]
        if not any(shut):
            return
        loads = self.ground(self.t), self.force(self.y), self.vertical(self.t)
        sides = self.model.opened(self.sides, shut, self.absolute(self.y), *loads)
        if sides is None:
            raise _Outside("contact is lost")
        for k in (LOWER, UPPER):
            if sides[k] != self.sides[k]:
                self.open(k, sides[k])

    def open(self, k: int, side: int) -> None:
        self.sides[k], self.lifted[k] = side, self.t
        self.uplifts[k].append(self.t)

    # events

    def watch(self, t: float, y: np.ndarray) -> dict[tuple[str, int], float]:
        """Return {(event, interface): a function that is above 0 until the event}; keep forces and history."""
        now, watched = self.instant(t, y), {}
        tilts, rates = self.relative(y), self.relative(y, 1)
        upright = max(map(abs, tilts)) < FALLING
        for k, slab in enumerate(self.model.slabs):
            side, tilt = self.sides[k], abs(tilts[k])
            if side:
                # the root at the uplift is divided out
                watched["landing", k] = side * tilts[k] / (t - self.lifted[k]) if t > self.lifted[k] else 1.0
                watched["turn", k] = side * rates[k] if tilt > 0.9 * self.peaks[k] else 1.0  # else it is no new peak
                watched["passage", k] = self.gammas[k] - tilt
                watched["fall", k] = 0.5 * math.pi - tilt
            else:
                watched["uplift", k] = slab.b - abs(now.pressure[k])
            watched["loss", k] = now.normal[k] if upright else 1.0
        if self.travel:
            watched["reversal", 0] = self.travel * y[5]
            if self.corner < math.inf:
                watched["corner", 0] = self.corner - self.travel * self.hysteretic(y)
        return watched

    def step_to(self, end: float, dense) -> tuple[str, int] | None:
        """Go to the first event of a step, or keep its points; dense : y(t) of the step. Return the event."""
        times = np.linspace(self.t, end, POINTS + 1)
        width = times[1] - times[0]
        times = np.array([times[0] - width, *times, end + width])  # beyond both ends: minima there
        states = dense(times).T
        rows = [self.watch(t, y) for t, y in zip(times.tolist(), states, strict=True)]
        keys, table = list(rows[0]), np.array([list(row.values()) for row in rows])
        found = None
        for i, j in zip(*np.nonzero(self.suspect(table)), strict=True):
            key = keys[j]
            if found and times[i] > found[0]:
                continue

            def value(t, key=key):
                return self.watch(t, dense(t).ravel())[key]

            low, high = max(times[i - 1], self.t), min(times[i + 1], end)
            if table[i, j] > 0 >= table[i + 1, j] and i <= POINTS:
                low, high = times[i], times[i + 1]
            else:
                high = minimize_scalar(value, bounds=(low, high), method="bounded", options={"xatol": 1e-9}).x
                if not value(low) > 0 >= value(high):
                    continue
            root = brentq(value, low, high, xtol=1e-16, rtol=1e-15)
            while value(root) > 0:  # beyond the event, so that it is not found again
                root = min(root + 4 * math.ulp(root), high)
            if found is None or root < found[0]:
                found = root, key
        until = found[0] if found else end
        for t, y in zip(times[1:-1].tolist(), states[1:-1], strict=True):
            if t < until:
                self.keep(t, y)
        if found:
            self.t, self.y = float(found[0]), dense(found[0]).ravel()
            self.keep(self.t, self.y)
            return found[1]
        self.keep(end, states[-2])
        return None

    @staticmethod
    def suspect(table: np.ndarray) -> np.ndarray:
        """Return where a function, (points, events), becomes negative, or has a minimum that may be."""
        suspect = np.zeros(table.shape, bool)
        suspect[1:-2] = (table[1:-2] > 0) & (table[2:-1] <= 0)
        left, middle, right = table[:-2], table[1:-1], table[2:]
        bend = right - 2 * middle + left
        lowest = (right - left) ** 2 / (8 * np.where(bend > 0, bend, math.inf))  # of a parabola, below the middle
        suspect[1:-1] |= (middle > 0) & (middle <= np.minimum(left, right)) & (2 * lowest > middle)
        return suspect

    def keep(self, t: float, y: np.ndarray) -> None:
        """Include a state in the extremes and the history."""
        now, tilts = self.instant(t, y), self.relative(y)
        self.peaks = [max(peak, abs(tilt)) for peak, tilt in zip(self.peaks, tilts, strict=True)]
        self.statue_tilt = max(self.statue_tilt, abs(self.absolute(y)[0][UPPER]))
        demands = [abs(h) / n if n > 0 else math.inf for h, n in zip(now.along, now.normal, strict=True)]
        least = [-n / weight for n, weight in zip(now.normal, self.weights, strict=True)]
        x, v = (float(y[4]), float(y[5])) if self.on_base else (0.0, 0.0)
        self.most = np.maximum(self.most, [abs(x), abs(now.a), *demands, *least])
        if self.rows is not None:
            rate = self.relative(y, 1)[UPPER]
            self.rows.append((t, tilts[UPPER], rate, x, v, self.force(y), self.ground(t), tilts[LOWER]))

    def at_turn(self, k: int) -> None:
        """Keep the largest tilt of a swing, which `keep` has seen."""

    def at_passage(self, k: int) -> None:
        self.held[k] = self.t, self.most.copy()
        if k == UPPER and self.unstable is None:
            self.unstable = self.t

    def at_fall(self, k: int) -> None:
        self.fallen = k

    def at_uplift(self, k: int) -> None:
        self.open(k, int(np.sign(self.instant(self.t, self.y).pressure[k])))

    def at_loss(self, k: int) -> None:
        raise _Outside("contact is lost")

    def at_reversal(self, k: int) -> None:
        self.fix()
        self.y[5] = 0.0

    def at_corner(self, k: int) -> None:
        self.y[6] = self.travel * self.corner

    def fix(self) -> None:
        """Keep x and z as those from which the base goes on."""
        if self.on_base:
            self.fixed = float(self.y[4]), self.hysteretic(self.y)

    def at_landing(self, k: int) -> None:
        """Apply the law of impact, and let interfaces rest whose bounces are over."""
        shut = [
            j == k or side == 0 or abs(tilt) < TOGETHER
            for j, (side, tilt) in enumerate(zip(self.sides, self.relative(self.y), strict=True))
        ]
        self.fix()
        landing = [closed and side != 0 for closed, side in zip(shut, self.sides, strict=True)]
        self.y[0] = 0.0 if shut[LOWER] else self.y[0]
        self.y[2] = 0.0 if shut[UPPER] else self.y[2]
        before, v = self.relative(self.y, 1), self.velocity
        self.strike(shut, (False, False))
        after, jump = self.relative(self.y, 1), self.velocity - v
        for j in (LOWER, UPPER):
            if landing[j]:
                self.impacts[j].append(Impact(self.t, before[j], after[j], jump))
                if abs(before[j]) > SIZABLE * self.scene.rocking_frequency * self.gammas[j]:
                    if self.last[0] == 1 - j:
                        self.closest = min(self.closest, self.t - self.last[1])
                    self.last = j, self.t
        for over in ((True, True), (False, True), (True, False)):  # interfaces that may rest at once
            if all(shut[j] and self.rests_at(j, over) for j in (LOWER, UPPER) if over[j]):
                self.strike(shut, over)
                break
        for j in (LOWER, UPPER):
            if landing[j] and self.sides[j] == 0:
                self.rests[j].append(self.t)

    @property
    def velocity(self) -> float:
        """Return that of the base [m/s]."""
        return float(self.y[5]) if self.on_base else 0.0

    def strike(self, shut: Sequence[bool], forced: Sequence[bool]) -> None:
        """Take the velocities and sides after an impact; see `StackModel.impact`."""
        answers = self.model.impact(self.sides, *self.absolute(self.y), self.velocity, shut, forced)
        if not answers or answers[0 if any(forced) else -1].jumps:
            raise _Outside("the pivot would jump")
        answer = answers[0]
        for k, (along, normal) in enumerate(answer.impulses):
            if shut[k]:
                self.sides[k], self.lifted[k] = int(answer.sides[k] or 0), self.t
            if normal > 0 and not any(forced):
                self.ratios[k] = max(self.ratios[k], abs(along) / normal)
        self.y[1] = answer.rates[0] if self.sides[LOWER] else 0.0
        self.y[3] = answer.rates[1] - answer.rates[0] if self.sides[UPPER] else 0.0
        if self.on_base:
            self.y[5] = answer.v

    def rests_at(self, k: int, over: Sequence[bool]) -> bool:
        """Return whether a closed interface is held on both corners, and bounces lower than `REST` slendernesses.

        over : interfaces that rest with it.
        """
        pulls = []
        for side in (-1, 1):
            sides = [side if j == k else 0 if over[j] else each for j, each in enumerate(self.sides)]
            spins = self.instant(self.t, self.y, sides).spins
            pulls.append(-side * (spins[1] - spins[0] if k == UPPER else spins[0]))
        rate = self.relative(self.y, 1)[k]
        return rate * rate < 2 * REST * self.gammas[k] * min(pulls)  # height of a bounce: rate^2/(2 pull)

    # end and results

    def remaining_energy(self) -> float:
        """Return the energy [J] that can still reach the blocks after the motion, as `kernel.decision` does for one."""
        (w1, w2), model = self.absolute(self.y)[1], self.model
        energy = model.kinetic_energy(self.sides, *self.absolute(self.y), self.velocity)
        energy += model.height_energy(*self.relative(self.y))
        if not self.on_base:
            return energy
        law, x = self.law, float(self.y[4])
        if law.count == 0:
            *_, c1, c2 = model.geometry(self.sides, self.absolute(self.y)[0])
            return energy - 0.5 * (model.mass * self.velocity + c1 * w1 + c2 * w2) ** 2 / model.mass
        back = _recoverable(float(law.law), law.constants, self.hysteretic(self.y))
        return energy + law.count * (0.5 * law.kb * x * x + back)

    def base(self) -> Base:
        if not self.on_base:
            return Base(0.0, 0.0, 0.0)
        return Base(float(self.y[4]), self.velocity, self.hysteretic(self.y))

    def certain(self) -> bool:
        """Return whether the outcome is: after a fall, or where the energy or, in full contact, the force is too low."""
        if self.fallen is not None or self.t < motion_end(self.scene) * (1 - 1e-9):
            return self.fallen is not None
        if self.sides == [0, 0] and will_not_overturn(self.par, Body(0.0, 0.0, 0.0), self.base(), False):
            return True
        most, *rim = self.model.barrier
        inside = all(abs(tilt) < limit for tilt, limit in zip(self.relative(self.y), rim, strict=True))
        return inside and self.remaining_energy() < most

    def finished(self) -> bool:
        """Return whether a run without a duration may end: the outcome is certain, and no peak can grow."""
        if self.t < self.shortest or not self.certain():
            return False
        if self.sides == [0, 0]:
            peaks = max(self.peaks), float(self.most[0]), -1.0
            return bool(peaks_are_final(self.par, Body(0.0, 0.0, 0.0), self.base(), peaks))
        return not self.on_base and self.remaining_energy() < self.model.rim(*self.peaks)

    def state(self) -> State:
        """Return the statue's state on the pedestal, and the base's."""
        x = float(self.y[4]) if self.on_base else 0.0
        tilt, rate = self.relative(self.y)[UPPER], self.relative(self.y, 1)[UPPER]
        return State(self.t, tilt, rate, x, self.velocity, self.force(self.y))

    def response(self, cpu_seconds: float, failure: Failure | None) -> Response:
        """Return the `Response` of the run."""
        scene, (fall_time, most) = self.scene, (None, self.most) if self.fallen is None else self.held[self.fallen]
        rocked = tuple(name for k, name in enumerate(NAMES) if self.uplifts[k] or self.impacts[k] or self.peaks[k])
        outcome = "failed" if failure else "rocks" if rocked else "stands"
        if self.fallen is not None:
            outcome = ("pedestal overturns", "overturns")[self.fallen]
        x, acceleration, demand1, demand2, least1, least2 = most.tolist()
        history = None
        if self.rows is not None:
            columns = np.array(self.rows).T
            history = History(*columns[:7], pedestal_tilt=columns[7])
        return Response(
            engine="analytic",
            variant="stack",
            outcome=outcome,
            overturning_time=None if self.fallen is None else self.t,
            unstable_time=self.unstable,
            fall_time=fall_time,
            peak_tilt=self.peaks[UPPER],
            peak_tilt_ratio=self.peaks[UPPER] / self.gammas[UPPER],
            peak_base_displacement=x,
            peak_base_acceleration=acceleration,
            impacts=tuple(self.impacts[UPPER]),
            uplifts=tuple(self.uplifts[UPPER]),
            rests=tuple(self.rests[UPPER]),
            friction_demand=demand2,
            min_normal_ratio=-least2,
            end=self.state(),
            cpu_seconds=cpu_seconds,
            steps=self.steps,
            settings={"method": "DOP853", "rtol": RTOL},
            versions={**versions(), "scipy": scipy.__version__},
            scene=scene.name,
            decided=failure is None and self.certain(),
            warnings=run_warnings(scene, demand2, -least2, x, self.velocity),
            failure=failure,
            stack=Stack(
                rocked=rocked,
                peak_tilt=self.peaks[LOWER],
                statue_tilt=self.statue_tilt,
                impacts=tuple(self.impacts[LOWER]),
                uplifts=tuple(self.uplifts[LOWER]),
                rests=tuple(self.rests[LOWER]),
                friction_demand=demand1,
                min_normal_ratio=-least1,
                impulses=(self.ratios[LOWER], self.ratios[UPPER]),
                closest=None if self.closest == math.inf else self.closest * scene.rocking_frequency / (2 * math.pi),
            ),
            history=history,
        )
