"""What a run shows of what the sheet asks for, whoever made it, and what each known mistake would answer: computed, by
the model or by the second implementation with a fault built in, one for each mistake that changes an equation.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic import Response, Scene, State, simulate
from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel
from analytic.twin.run import Run
from analytic.types import GroundFunction

from .problems import IMPACT, STATE, Problem, Quantity

Value = float | str
HISTORY_STEP = 1e-3  # s, of which every time asked for is a multiple


def answers_of(problem: Problem, response: Response, states: Mapping[float, State]) -> dict[str, Value]:
    """{quantity: value} of all that a run shows: its response, and the states by their time [s]."""
    values = {one.name: _value(one, response, states) for one in problem.quantities}
    return {name: value for name, value in values.items() if value is not None}


def _value(quantity: Quantity, response: Response, states: Mapping[float, State]) -> Value | None:
    """The answer; None where the run has no such event or state."""
    if quantity.source in STATE:
        return getattr(states.get(quantity.index), quantity.source, None)
    if quantity.source in IMPACT:
        hits = response.impacts[int(quantity.index) - 1 :]
        return getattr(hits[0], quantity.source) if hits else None
    found: Any = getattr(response, quantity.source)
    return found if not isinstance(found, tuple) else found[0] if found else None  # of uplifts and rests, the first


def of_response(problem: Problem, response: Response) -> dict[str, Value]:
    """The answers of a `Response` with a history."""
    history = response.history
    states = {
        t: State(*(float(np.interp(t, history.time, getattr(history, name))) for name in State.__dataclass_fields__))
        for t in problem.times
        if history is not None and t <= history.time[-1]
    }
    return answers_of(problem, response, states)


def solved(problem: Problem, scene: Scene | None = None, tolerance: float = 1e-16) -> dict[str, Value]:
    """The answers of the analytic model, to the problem's scene or another one in its place."""
    return of_response(problem, simulate(scene or problem.scene, tolerance=tolerance, output_step=HISTORY_STEP))


TOLERANCE = 1e-10  # of the variants: far below what an answer must match them by
LONGEST = 0.05  # s, of a step: events are found on its interpolant, which is less exact than its end
REVERSALS = 200  # of the base in one run: more are a fault's chatter, which has no solution
TIGHTEST = 1e-13  # of the estimate of the answers' own error
LOOSER = 1e-14  # tolerance of the run beside the tightest one


class Printed8(RockingModel):
    """Eq. (8) as printed: a factor R cos(gamma) too many."""

    def impact(self, rate: Any) -> tuple[Any, Any]:
        after, jump = super().impact(rate)
        return after, jump * self.R * math.cos(self.gamma)


class Printed12(BearingLaw):
    """Eq. (12) as printed: unloading with the bracket 1 + x - x_j + 2 x0 of loading, x_j being right."""

    def hysteretic(self, z: float, dx: float) -> float:
        if dx >= 0:
            return super().hysteretic(z, dx)
        c = self.constants
        full, power = 1 + 2 * c.x0, 1 - c.alpha
        mark = max(c.d0, c.d0 + power * (-z - c.f0) / c.dk) ** (1 / power)  # 1 - x_c + x_j + 2 x0
        bracket = 2 * full - mark + dx
        return -(c.dk * (bracket**power - c.d0) / power + c.f0)


@dataclass(frozen=True)
class Fault:
    """What is wrong in a run.

    lost: number of an impact without effect, from 1 on. seen: whether it is detected nevertheless. printed_8,
    printed_12: these equations as printed. inertia: factor on J_O in the equation of motion, and with `restitution` in
    eq. (7). step [s]: impacts happen at its next multiple, and with `smeared` the step that holds one is a Runge-Kutta
    step of fourth order across it, each stage on its own side.
    """

    lost: int | None = None
    seen: bool = True
    printed_8: bool = False
    printed_12: bool = False
    inertia: float = 1.0
    restitution: bool = True
    step: float | None = None
    smeared: bool = False


class FaultyRun(Run):
    """A run of the second implementation with a `Fault`."""

    def __init__(self, problem: Problem, fault: Fault, tolerance: float) -> None:
        settings = {"method": "DOP853", "rtol": tolerance, "atol": tolerance, "max_step": None, "rest_rate": 1e-8}
        super().__init__(problem.scene, settings, history=False, energy=False)
        self.max_step = min(self.max_step, LONGEST)
        self.fault, model = fault, self.model
        if fault.printed_12:
            self.law = Printed12(**vars(self.law))
            model = replace(model, bearing=self.law)
        if fault.inertia != 1:
            inertia = fault.inertia * model.J
            e = 1 - 2 * model.m * (model.R * math.sin(model.gamma)) ** 2 / inertia  # (7), on rigid ground
            model = replace(model, J=inertia, restitution=max(e, 0.0) if fault.restitution else model.restitution)
        self.right, self.reversals = Printed8(**vars(model)) if fault.printed_8 else model, 0
        self.model = self.right

    def answers(self, problem: Problem) -> dict[str, Value] | None:
        """The answers of the run, made now; None where it fails."""
        states: dict[float, State] = {}
        for t in (*problem.times, problem.scene.end):
            self.scene = problem.scene.with_(duration=t)
            with np.errstate(all="ignore"):
                if self.go():
                    return None
            if self.overturning is not None:
                break
            states[t] = self.state()
        if self.fault.lost and not self.fault.seen:
            del self.impacts[self.fault.lost - 1 : self.fault.lost]
        return answers_of(problem, self.response(0.0, None), states)

    def at_reversal(self, ground: float) -> None:
        self.reversals += 1
        if self.reversals > REVERSALS:
            raise ArithmeticError(f"the base turns back and forth at t = {self.t!r} s")
        super().at_reversal(ground)

    def at_impact(self, ground: float) -> None:
        lost = len(self.impacts) + 1 == self.fault.lost  # without loss the base is not pushed
        self.model = replace(self.right, restitution=1.0) if lost else self.right
        tilt = self._late() if self.fault.step else 0.0
        super().at_impact(ground)
        if self.side:
            self.y[0] = tilt

    def _late(self) -> float:
        """Go on to the end of the step in which the impact is noticed; returns the tilt there."""
        step, t = self.fault.step or math.inf, self.t
        before = math.floor(t / step) * step
        start = self._stepped(t, before, self.y, smeared=False)
        self.t = before + step
        self.y = self._stepped(before, self.t, start, smeared=self.fault.smeared)
        return float(self.y[0])

    def _stepped(self, begin: float, end: float, y: np.ndarray, smeared: bool) -> np.ndarray:
        """The state after one Runge-Kutta step of fourth order; smeared: each stage on the side its tilt says."""
        h, own = end - begin, self.side
        ground: GroundFunction = self.scene.motion.acceleration if self.scene.motion else (lambda t: 0.0)

        def slope(t, y):
            self.side = math.copysign(1.0, y[0]) if smeared else own
            return np.array(self.derivative(ground, 0.0)(t, y))

        a = slope(begin, y)
        b = slope(begin + h / 2, y + h / 2 * a)
        c = slope(begin + h / 2, y + h / 2 * b)
        d = slope(end, y + h * c)
        self.side = own
        return y + h / 6 * (a + 2 * b + 2 * c + d)


def with_fault(problem: Problem, fault: Fault, tolerance: float = TOLERANCE) -> dict[str, Value] | None:
    """The answers of a run with a fault; None where it comes to no end."""
    try:
        return FaultyRun(problem, fault, tolerance).answers(problem)
    except (ArithmeticError, ValueError):  # what a fault makes of the equations need not have a solution
        return None


Answers = Mapping[str, Value]
STEPS = tuple(digit * 10.0**-power for power in (2, 3, 4, 5) for digit in (1, 2, 2.5, 4, 5))
STEPS += tuple(1 / rate for rate in (30, 50, 60, 100, 120, 240, 250, 300, 400, 480, 500, 960))
FITTING = 1e-6  # of a step: so close to a multiple of it lie times that are one
MOST_STEPS = 4  # of the steps that fit, the largest: times that fit one fit its parts too


@dataclass(frozen=True)
class Mistake:
    """A mistake, in words that say what to look for. answers: ``(problem, given)`` -> what each of its forms would
    answer; none where it changes nothing, or where it is not known what it would give."""

    name: str
    words: str
    answers: Callable[[Problem, Answers], Iterator[Answers | None]]


def _lost(problem, given):
    asked = sum(one.source == "rate_after" for one in problem.quantities)
    if asked:
        yield solved(problem, problem.scene.with_(block={"restitution": 1.0}))
    for k in range(1, asked + 1):
        for seen in (True, False):
            yield with_fault(problem, Fault(lost=k, seen=seen))


def _late(problem, given):
    times = [given[one.name] for one in problem.quantities if one.source == "time" and one.name in given]
    fitting = [
        step for step in sorted(STEPS, reverse=True) if all(abs(t / step - round(t / step)) < FITTING for t in times)
    ]
    for step in fitting[:MOST_STEPS] if times else ():
        for smeared in (False, True):
            yield with_fault(problem, Fault(step=step, smeared=smeared))


def _printed_8(problem, given):
    if problem.scene.base is not None and any(one.source == "base_velocity_jump" for one in problem.quantities):
        yield with_fault(problem, Fault(printed_8=True))


def _printed_12(problem, given):
    if problem.scene.bearings is not None and problem.scene.bearings.law == "algebraic":
        yield with_fault(problem, Fault(printed_12=True))


def _inertia(problem, given):
    if problem.scene.base is None:  # on a base of these masses there is no motion at all with it
        block = problem.scene.block
        for restitution in (True, False):
            yield with_fault(problem, Fault(inertia=block.centre_inertia / block.inertia, restitution=restitution))


def _damping(problem, given):
    bearings = problem.scene.bearings
    for factor in (0.5, 2.0) if bearings is not None and bearings.damping else ():
        yield solved(problem, problem.scene.with_(bearings={"damping": factor * bearings.damping}))


def _degrees(problem, given):
    right, scene, turn = solved(problem), problem.scene, math.pi / 180
    yield _reported(problem, right, {"angle": 1 / turn})
    yield _reported(problem, right, {"angle": 1 / turn, "rate": 1 / turn})
    narrow, released = {"slenderness": scene.block.slenderness * turn}, {"tilt": scene.start.tilt * turn}
    yield solved(problem, scene.with_(block=narrow))
    if scene.start.tilt:
        yield solved(problem, scene.with_(start=released))
        yield solved(problem, scene.with_(block=narrow, start=released))
    if hasattr(scene.motion, "frequency"):
        slow = replace(scene.motion, frequency=scene.motion.frequency * turn)
        yield solved(problem, scene.with_(motion=slow))


def _scaled(*factors):
    """Answers under the ground motion times each factor."""

    def answers(problem, given):
        scene = problem.scene
        for factor in factors if scene.motion is not None else ():
            yield solved(problem, scene.with_(motion=scene.motion.scaled(factor)))

    return answers


def _one_bearing(problem, given):
    bearings = problem.scene.bearings
    if bearings is None:
        return
    yield solved(problem, problem.scene.with_(bearings={"count": 1}))
    yield _reported(problem, solved(problem), {"force": 1 / bearings.count})


def _tilt_sign(problem, given):
    yield _reported(problem, solved(problem), {"angle": -1, "rate": -1})


def _mirrored(problem, given):
    if problem.scene.motion is None:  # else it is the sign of the ground motion
        yield _reported(problem, solved(problem), dict.fromkeys(("angle", "rate", "length", "speed", "force"), -1))


def _reported(problem, answers, factors):
    """Right answers told in another unit or sign: by kind, peaks stay positive."""
    told = dict(answers)
    for one in problem.quantities:
        if one.name in told and one.kind in factors:
            told[one.name] *= abs(factors[one.kind]) if one.source.startswith("peak") else factors[one.kind]
    return told


MISTAKES = (
    Mistake("impact lost", "an impact is missed: the block passes to its other corner without a loss of rate", _lost),
    Mistake(
        "restitution off by the step",
        "impacts are applied at the end of the step in which φ changes its sign: locate them within it",
        _late,
    ),
    Mistake("eq. (8) as printed", "the jump of x′ has a factor R cos γ too many, as eq. (8) is printed", _printed_8),
    Mistake(
        "eq. (12) as printed",
        "the bearing unloads with the bracket 1 + x − x_j + 2 x₀, as eq. (12) is printed",
        _printed_12,
    ),
    Mistake(
        "wrong damping definition",
        "the damping is half or twice what it should be: ξ is a share of critical damping, 2 ξ ω_b",
        _damping,
    ),
    Mistake("degrees for radians", "an angle is taken, or told, in degrees: all are in rad", _degrees),
    Mistake(
        "g for m/s2",
        "the ground acceleration is off by a factor 9.81: it is in m/s², not in g",
        _scaled(9.81, 1 / 9.81),
    ),
    Mistake("sign of the ground motion", "the ground moves the other way: a_g is positive toward +x", _scaled(-1.0)),
    Mistake("force per bearing for all", "the force of one bearing stands for that of all n_d", _one_bearing),
    Mistake("inertia about the centre", "J is taken about the centre of mass: it is about a lower corner", _inertia),
    Mistake("sign of the tilt", "φ has the other sign: positive φ tips toward +x", _tilt_sign),
    Mistake("mirrored", "+x points the other way", _mirrored),
)


def error(problem: Problem, given: Mapping[str, Value], right: Mapping[str, Value]) -> dict[str, float]:
    """{quantity: error over its scale} of the answers given; of a word 0, or 1 where it is another."""
    return {
        one.name: float(given[one.name] != right[one.name])
        if one.kind == "outcome"
        else abs(float(given[one.name]) - float(right[one.name])) / problem.scale(one)
        for one in problem.quantities
        if one.name in given
    }


def own_error(problem: Problem) -> float:
    """What the exact answers may be off by: the largest difference, over the scales, from a run of the model at a
    looser tolerance and from one of the second implementation."""
    right = solved(problem)
    others = solved(problem, tolerance=LOOSER), with_fault(problem, Fault(), TIGHTEST)
    if any(other is None or other.keys() != right.keys() for other in others):
        raise ArithmeticError(f"{problem.name}: the second implementation fails, or two solutions do not show the same")
    return max(max(error(problem, other, right).values()) for other in others if other is not None)
