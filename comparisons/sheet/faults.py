"""Known mistakes, and the answers that each would give, computed by the model or a modified version of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .observed import Value, solved
from .variants import Fault, with_fault

if TYPE_CHECKING:
    from .problems import Problem

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
