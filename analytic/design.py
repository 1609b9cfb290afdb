"""Design of bearings: ka, kb and alpha, Table 1(b), from target period, damping and displacement, Table 1(a)."""

import math
from dataclasses import dataclass

from scipy.optimize import brentq, minimize_scalar

from .bearing import BearingLaw
from .errors import SettingError
from .scene import LEAST, MOST, Bearings

# The usual equivalent damping is W_D/(4 pi E_s). The paper's 30 % is W_D/(2 pi E_s), twice the usual value.
DEFINITIONS = {"equivalent": 4 * math.pi, "paper": 2 * math.pi}
# Exponents searched; Table 1(b) has 44.69.
STEEPEST = 1e4
# The design equations assume a loop on the limit curves; tolerated difference of the law's own loop.
LOOP_AGREEMENT = 1e-3
SETTLING_CYCLES = 50


@dataclass(frozen=True)
class BearingProperties:
    """Properties of a set of bearings at the displacement x_max.

    period : float
        Secant period at x_max [s], 2 pi sqrt(M x_max/F(x_max)); with kb alone it would be `period_kb`.
    damping_paper, damping_equivalent : float
        W_D/(2 pi E_s), as in Table 1(a), and the usual W_D/(4 pi E_s), with E_s = k_sec x_max^2/2.
    secant_stiffness, force : float
        Of one bearing at x_max [N/m, N].
    cycle_loss : float
        W_D of one bearing [J], in a steady cycle of the law itself.
    """

    period: float
    period_kb: float
    damping_paper: float
    damping_equivalent: float
    secant_stiffness: float
    force: float
    cycle_loss: float


def steady_cycle(law: BearingLaw, amplitude: float) -> tuple[float, float]:
    """(loss [J], force [N] at +amplitude) of one bearing in the steady cycle between +-amplitude [m].

    The loss is the integral of the hysteretic force along both branches, exact.
    """
    z = law.hysteretic(0.0, amplitude)
    for _ in range(SETTLING_CYCLES):
        low = law.hysteretic(z, -2 * amplitude)
        z = law.hysteretic(low, 2 * amplitude)
    return 2 * law.work(low, 2 * amplitude), law.kb * amplitude + z


def properties(bearings: Bearings, mass: float, x_max: float) -> BearingProperties:
    """`BearingProperties` of bearings under `mass` (block and base) [kg] at x_max [m]."""
    law = BearingLaw.of(bearings)
    loss, force = steady_cycle(law, x_max)
    secant = force / x_max
    energy = 0.5 * secant * x_max**2
    kb_period = 2 * math.pi * math.sqrt(mass / (bearings.count * law.kb)) if law.kb else math.inf
    return BearingProperties(
        2 * math.pi * math.sqrt(mass / (bearings.count * secant)),
        kb_period,
        loss / (2 * math.pi * energy),
        loss / (4 * math.pi * energy),
        secant,
        force,
        loss,
    )


def _mismatch(alpha: float, loss: float, secant: float, x_max: float, ratio: float) -> tuple[float, float]:
    """ka - kb from f0 and alpha minus ka - kb from kb and the ratio; f0 from the loss on the limit curves."""
    f0 = loss / (4 * (x_max - 1 / (alpha - 2)))
    return 2 * f0 * (alpha - 1) - (ratio - 1) * (secant - f0 / x_max), f0


def _feasible(damping: float, divisor: float, secant: float, x_max: float, ratio: float) -> tuple[float, float]:
    """(alpha of least mismatch, the mismatch there); a design exists where it is below 0."""
    loss = damping * divisor * 0.5 * secant * x_max**2
    low = math.log(1 / x_max * (1 + 1e-9))

    def at(u):
        return _mismatch(2 + math.exp(u), loss, secant, x_max, ratio)[0] / secant

    best = minimize_scalar(at, bounds=(low, math.log(STEEPEST)), method="bounded")
    return 2 + math.exp(best.x), best.fun


def design_bearings(
    mass: float,
    period: float,
    damping: float,
    x_max: float,
    *,
    count: int = 4,
    stiffness_ratio: float = 10.0,
    definition: str = "equivalent",
    delta_k: float = 1e-20,
) -> Bearings:
    """Bearings with a given secant period and damping at x_max.

    Parameters
    ----------
    mass : float
        Block and base together [kg].
    period : float
        Secant period at x_max [s].
    damping : float
        Equivalent damping at x_max, over critical damping; see `definition`.
    x_max : float
        Design displacement [m].
    count : int
        Number of bearings.
    stiffness_ratio : float
        ka/kb. The paper does not print it; its Table 1(b) has 10.
    definition : str
        "equivalent" for the usual W_D/(4 pi E_s), "paper" for the Caryatid paper's W_D/(2 pi E_s), twice as much.

    Returns
    -------
    Bearings
        With x_max.

    Raises
    ------
    SettingError
        A target is out of range or cannot be met; the message states the limit.
    SceneError
        The bearings that meet the targets are outside the range of a scene.
    """
    targets = {"mass": mass, "period": period, "damping": damping, "x_max": x_max, "delta_k": delta_k}
    _check(targets, count, stiffness_ratio, definition)
    divisor = DEFINITIONS[definition]
    try:
        secant = mass * (2 * math.pi / period) ** 2 / count
        alpha, f0 = _exponent(damping, definition, divisor, secant, x_max, stiffness_ratio)
    except (ArithmeticError, ValueError) as error:  # scipy's, where numbers overflow
        if isinstance(error, SettingError):
            raise
        asked = ", ".join(f"{name} = {value:.4g}" for name, value in targets.items() if name != "delta_k")
        ratio = f"stiffness_ratio = {stiffness_ratio:.4g}"
        raise SettingError(f"{asked}, {ratio}: no bearings give that; change one of them") from None
    kb = secant - f0 / x_max
    bearings = Bearings(count=count, ka=stiffness_ratio * kb, kb=kb, alpha=alpha, delta_k=delta_k, x_max=x_max)
    got = properties(bearings, mass, x_max)
    got_damping = got.damping_paper if definition == "paper" else got.damping_equivalent
    if abs(got.period / period - 1) > LOOP_AGREEMENT or abs(got_damping / damping - 1) > LOOP_AGREEMENT:
        raise SettingError(
            f"x_max = {x_max:.4g} m is too small for bearings with alpha = {alpha:.4g} to reach their "
            f"limit curves (period {got.period:.4g} s, damping {got_damping:.4g} result); "
            "raise x_max or stiffness_ratio"
        )
    return bearings


def _check(targets, count, stiffness_ratio, definition):
    """Refuse what is out of range."""
    for name, number in targets.items():
        if not (math.isfinite(number) and number > 0):
            raise SettingError(f"{name} = {number!r}: give a finite number above 0")
        if name != "delta_k" and not LEAST <= number <= MOST:  # so that products do not overflow
            raise SettingError(f"{name} = {number!r}: give a number from {LEAST:g} to {MOST:g}")
    if not 1 < stiffness_ratio <= MOST:
        raise SettingError(f"stiffness_ratio = {stiffness_ratio!r}: ka/kb must be above 1, and at most {MOST:g}")
    if count < 1:
        raise SettingError(f"count = {count!r}: give at least one bearing")
    if definition not in DEFINITIONS:
        raise SettingError(f"definition = {definition!r}: choose one of {', '.join(DEFINITIONS)}")


def _exponent(damping, definition, divisor, secant, x_max, ratio):
    """(alpha, f0 [N]) that give the damping at x_max with the stiffness ratio; `SettingError` states the limit."""
    turn, least = _feasible(damping, divisor, secant, x_max, ratio)
    if least >= 0:
        # damping -> 0 is always possible: with f0 -> 0 only the ratio term remains
        widest = 8 / divisor  # damping of a rectangular loop, W_D = 4 F x, an upper bound
        most = brentq(lambda d: _feasible(d, divisor, secant, x_max, ratio)[1], 1e-9, min(damping, widest))
        raise SettingError(
            f"damping = {damping:.4g} ({definition} definition) cannot be met at x_max = {x_max:.4g} m "
            f"with ka/kb = {ratio:.4g}: the most is {most:.4g}; lower it, "
            "or raise stiffness_ratio"
        )
    loss = damping * divisor * 0.5 * secant * x_max**2
    if _mismatch(STEEPEST, loss, secant, x_max, ratio)[0] < 0:
        raise SettingError(
            f"damping = {damping:.4g} is so small that alpha would exceed {STEEPEST:g}; "
            "raise it, or lower stiffness_ratio"
        )
    alpha = brentq(lambda a: _mismatch(a, loss, secant, x_max, ratio)[0], turn, STEEPEST, xtol=1e-12)
    return alpha, _mismatch(alpha, loss, secant, x_max, ratio)[1]
