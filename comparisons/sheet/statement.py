"""A problem in words, equations and numbers: paragraphs and equations, from its scene alone.

Nothing here says how the scenes are solved in this project. Equation numbers are those of the page.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from analytic import SampledMotion

from .problems import DAMPING, PERIOD

if TYPE_CHECKING:
    from .problems import Problem

UNITS = {"time": "s", "angle": "rad", "rate": "rad/s", "length": "m", "speed": "m/s", "force": "N", "outcome": "a word"}
SCALES = {
    "time": "1/ω_r",
    "angle": "γ",
    "rate": "γ ω_r",
    "length": "R γ",
    "speed": "R γ ω_r",
    "force": "(m + m_b) g γ",
    "outcome": "1 if another",
}
RECORD_FILE = "record.csv"


@dataclass(frozen=True)
class Part:
    """A piece of a page: kind "text", "equation" (plain, one a line) or "rows" (symbol, value with unit, meaning)."""

    kind: str
    content: str | tuple[tuple[str, str, str], ...]


def statement(problem: Problem) -> Iterator[Part]:
    """The parts of a page, in order; what is asked for stands after them."""
    scene = problem.scene
    yield Part("text", problem.story)
    yield Part("rows", tuple(_numbers(scene)))
    yield from _signs(scene)
    yield from _contact(scene)
    yield from _rocking(scene)
    yield from _impact(scene)
    if scene.bearings is not None:
        yield from _hysteresis(scene) if scene.bearings.law == "algebraic" else _viscous()


def _numbers(scene):
    block, start = scene.block, scene.start
    yield "m", f"{block.mass:g} kg", "mass of the block, a rigid rectangle"
    yield "R", f"{block.radius:g} m", "distance of a lower corner to the centre of mass"
    yield "γ", f"{block.slenderness:g} rad", "angle of that line to the vertical, the block upright"
    yield "J", "4 m R²/3", "moment of inertia about a lower corner"
    yield "g", f"{scene.gravity:g} m/s²", "gravity"
    yield "ω_r", "√(m g R/J)", "rocking frequency, in rad/s"
    if scene.base is not None:
        yield "m_b", f"{scene.base.mass:g} kg", "mass of the base under the block"
    if scene.bearings is not None:
        yield from _bearing_numbers(scene.bearings)
    if start.tilt:
        yield "φ(0)", f"{start.tilt:g} rad", "tilt at t = 0, where φ′ = 0"
    if scene.motion is not None and not isinstance(scene.motion, SampledMotion):
        pulse = scene.motion
        yield "A", f"{pulse.amplitude:g} m/s²", "amplitude of the ground acceleration"
        yield "ω", f"{pulse.frequency:g} rad/s", "its frequency"
        if pulse.start:
            yield "t₀", f"{pulse.start:g} s", "its start"
    yield "duration", f"{scene.duration:g} s", "until when it is to be solved"


def _bearing_numbers(bearings):
    yield "n_d", f"{bearings.count}", "number of bearings; what follows is for one of them"
    if bearings.law == "linear":
        yield "T", f"{PERIOD:g} s", "period of block and base together on all springs"
        yield "ξ", f"{DAMPING:g}", "share of critical damping, of block and base together on all bearings"
        return
    yield "k_a", f"{bearings.ka:g} N/m", "stiffness at first and after a reversal"
    yield "k_b", f"{bearings.kb:g} N/m", "stiffness far along a branch"
    yield "α", f"{bearings.alpha:g}", "exponent"
    yield "δ", f"{bearings.delta_k:g} N/m", "stiffness difference left at x₀"


def _signs(scene):
    yield Part(
        "text",
        "All in SI units; angles are in rad, ′ is the derivative by time. The motion is planar. Positive φ tips the "
        "block toward +x about its right corner; s = sign φ"
        + (
            ", and just after uplift or an impact the side it moves to."
            if scene.base is None
            else ", and just after uplift or an impact the side it moves to. x is the displacement of the base "
            "relative to the ground; block and base do not slide on each other."
        ),
    )
    motion = scene.motion
    if motion is None:
        yield Part("text", "The ground is at rest: a_g = 0.")
    elif isinstance(motion, SampledMotion):
        yield Part(
            "text",
            f"a_g(t), the ground acceleration toward +x, is given in {RECORD_FILE}: time [s] and acceleration [m/s²], "
            "to be interpolated linearly, without a correction of its base line.",
        )
    else:
        start = "t" if not motion.start else "(t − t₀)"
        yield Part("text", "The ground acceleration toward +x:")
        yield Part("equation", f"a_g = A sin(ω {start}) for 0 ≤ {start.strip('()')} ≤ 2π/ω, and 0 at all other times")


def _contact(scene):
    if scene.motion is None:
        return
    if scene.base is None:
        yield Part("text", "A block that stands upright lifts where")
        yield Part("equation", "|a_g| > g tan γ,    (1)")
        yield Part("text", "and tips to the side s = −sign a_g, from φ = φ′ = 0.")
        return
    yield Part("text", "As long as the block stands upright, φ = 0 and")
    yield Part("equation", "(m + m_b)(a_g + x″) + F = 0.    (1a)")
    yield Part("text", "It lifts where the absolute acceleration a = a_g + x″ of the base has")
    yield Part("equation", "|a| > g tan γ,    (1b)")
    yield Part("text", "and tips to the side s = −sign a, from φ = φ′ = 0.")


def _rocking(scene):
    yield Part("text", "While it rocks, with")
    yield Part("equation", "c = R cos(s γ − φ),   n = R sin(s γ − φ),")
    if scene.base is None:
        yield Part("equation", "J φ″ + m c a_g + m g n = 0.    (2)")
        return
    force = "" if scene.bearings is None else " + F"
    yield Part("equation", f"(m + m_b)(a_g + x″) + m (c φ″ + n φ′²){force} = 0,    (2a)")
    yield Part("equation", "J φ″ + m c (a_g + x″) + m g n = 0.    (2b)")


def _impact(scene):
    yield Part(
        "text", "When φ comes back to 0 the block hits its other corner and, unless it rests, rocks on about it:"
    )
    if scene.base is None:
        yield Part("equation", "φ′₊ = e φ′₋,   e = 1 − 2 m (R sin γ)²/J.    (3)")
    else:
        yield Part("equation", "φ′₊ = e φ′₋,   e = 1 − 2 m (R sin γ)²/(J − μ m (R cos γ)²),   μ = m/(m + m_b),    (3a)")
        yield Part("equation", "x′₊ = x′₋ + μ R cos γ (φ′₋ − φ′₊).    (3b)")
    yield Part(
        "text", "Impacts that follow each other ever faster end in rest: φ = φ′ = 0, until the block lifts again."
    )


def _hysteresis(scene):
    yield Part("text", "The force F = n_d f of the bearings, each with the constants")
    yield Part("equation", "2 x₀ = (δ/(k_a − k_b))^(−1/α) − 1   [m],   D₀ = (1 + 2 x₀)^(1 − α),")
    yield Part("equation", "f₀ = (k_a − k_b)(D₀ − 1)/(2 (1 − α)),    (4)")
    yield Part(
        "text",
        "(lengths in m: the 1 is 1 m). Let (x_c, z_c) be displacement and z = f − k_b x where x′ last changed its "
        "sign, (0, 0) at first, and σ = sign x′ since then:",
    )
    yield Part("equation", "D_c = max(D₀, D₀ + (1 − α)(σ z_c − f₀)/(k_a − k_b))^(1/(1 − α)),    (5)")
    yield Part("equation", "f = k_b x + σ {(k_a − k_b)[(D_c + σ (x − x_c))^(1 − α) − D₀]/(1 − α) + f₀}.    (6)")


def _viscous():
    yield Part("text", "Each bearing has a spring and a damper; for all of them together")
    yield Part("equation", "F = (m + m_b)(ω_b² x + 2 ξ ω_b x′),   ω_b = 2π/T.    (4)")


def scale_words(problem: Problem, kind: str) -> str:
    """The scale of a kind of quantity, in symbols and as a number."""
    return SCALES[kind] if kind == "outcome" else f"{SCALES[kind]} = {_scale(problem, kind):.6g} {UNITS[kind]}"


def _scale(problem, kind):
    return next(problem.scale(one) for one in problem.quantities if one.kind == kind)
