"""The second implementation with a built-in fault, one for each mistake that changes an equation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.bearing import BearingLaw
from analytic.response import State
from analytic.rocking import RockingModel
from analytic.twin.run import Run

from .observed import Value, answers_of

if TYPE_CHECKING:
    from analytic.types import GroundFunction

    from .problems import Problem

TOLERANCE = 1e-10  # of the variants: far below what an answer must match them by
LONGEST = 0.05  # s, of a step: events are found on its interpolant, which is less exact than its end
REVERSALS = 200  # of the base in one run: more are a fault's chatter, which has no solution
TIGHTEST = 1e-13  # of the estimate of the answers' own error


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
