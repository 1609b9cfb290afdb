"""The equations of the model: rocking of a block, force of its bearings, and design of bearings.

Uplift, rocking and impact follow eqs (1)-(8) of the Caryatid paper, corrected where misprinted. The tilt phi is
positive toward +x; s = sgn(phi) is the side of the pivot; x is the base displacement relative to the ground. Under a
vertical ground acceleration a_v, upward, g is replaced by g + a_v: bearings are vertically rigid.

The force of one bearing has an elastic part kb x, a hysteretic part z with |z| <= f0 by one of `laws`, and a viscous
part. Bearings are designed from target period, damping and displacement, Table 1(a): ka, kb and alpha, Table 1(b).
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from .errors import SettingError, require
from .kernel.compiled import entry, inner
from .laws import LAWS, NUMBERS, Constants, law_function
from .scene import LEAST, MOST, Bearings

if TYPE_CHECKING:
    from .errors import Values
    from .laws.law import Law
    from .scene import Scene

_after_travel = law_function("after_travel")


@inner
def hysteretic_force(z: float, dx: float, law: float, c: Constants) -> float:
    """Return the hysteretic force [N] after monotonic travel dx [m] from a point with hysteretic force z [N]."""
    if dx == 0:
        return z
    return _after_travel(law, z, dx, c)


@entry
def _path(z: float, x: np.ndarray, law: int, c: Constants, forces: np.ndarray) -> None:
    forces[0] = z
    for i in range(1, len(x)):
        z = hysteretic_force(z, x[i] - x[i - 1], float(law), c)
        forces[i] = z


# Engines call it at every step: passing numbers takes half the time of passing a record.
@entry
def _hysteretic(z: float, dx: float, law: int, *constants: float) -> float:
    return hysteretic_force(z, dx, float(law), Constants(*constants))


@dataclass(frozen=True)
class BearingLaw:
    """Constants of the law of one bearing, and its force.

    Attributes
    ----------
    law : int
        Index of the law in `LAWS`.
    count : int
        Number of bearings n_d.
    damping : float
        Viscous coefficient [N s/m].
    kb : float
        Elastic stiffness [N/m]; for a linear law it is the stiffness.
    constants : Constants
        dk = ka - kb [N/m] and f0, the limit of the hysteretic part [N], both 0 for a linear law; and the law's own
        constants: for the algebraic law its exponent alpha, x0 [m] of eq. (13) and d0 = (1 + 2 x0)^(1 - alpha).
    """

    law: int
    count: int
    damping: float
    kb: float
    constants: Constants

    @classmethod
    @functools.lru_cache(maxsize=64)  # needed some forty times in a run of an engine
    def of(cls, bearings: Bearings | None) -> Self:
        """Return the law of a `Bearings` part; None gives no force."""
        if bearings is None:
            return cls(NUMBERS["linear"], 0, 0.0, 0.0, Constants(dk=0.0, f0=0.0))
        number = NUMBERS[bearings.law]
        values = LAWS[number].constants(bearings)
        return cls(number, bearings.count, bearings.damping, values.pop("kb"), Constants(**values))

    @property
    def unit(self) -> Law:
        """Return the `Law` itself."""
        return LAWS[self.law]

    @property
    def dk(self) -> float:
        """ka - kb [N/m]."""
        return self.constants.dk

    @property
    def f0(self) -> float:
        """Limit of the hysteretic part [N]."""
        return self.constants.f0

    def hysteretic(self, z: float, dx: float) -> float:
        """Return z of one bearing [N] after monotonic travel dx [m] from z."""
        return _hysteretic(z, dx, self.law, *self.constants)

    def path(self, x: np.ndarray) -> np.ndarray:
        """Return z [N] along displacements x [m], shape (n,), monotonic in between; x[0] is reached by `start`."""
        forces = np.empty(len(x))
        _path(self.start(float(x[0])), x, self.law, self.constants, forces)
        return forces

    def start(self, displacement: float) -> float:
        """Return z of one bearing [N] after monotonic loading of the virgin bearing to `displacement` [m]."""
        return self.hysteretic(0.0, displacement)

    def force(self, x: Values, z: Values, v: Values | float = 0.0) -> Values:
        """Return the force of all bearings together [N], positive against positive x: eqs (9), (11), and viscous."""
        return self.count * (self.kb * x + z + self.damping * v)

    def work(self, z: float, dx: float) -> float:
        """Return the integral of the hysteretic force of one bearing over monotonic travel dx [m] from z [J], exact."""
        return 0.0 if dx == 0 else self.unit.work(z, dx, self.constants)


@dataclass(frozen=True)
class RockingModel:
    """The equations of one scene, one method per equation.

    Attributes
    ----------
    m, M, J : float
        Mass of the block, of block and base together [kg]; J_O about a base corner [kg m2].
    R, gamma, g : float
        Radius [m], slenderness [rad], gravity [m/s2].
    on_base : bool
        False on rigid ground.
    bearing : BearingLaw
    restitution : float
        e_phi, see `restitution`.
    """

    m: float
    M: float
    J: float
    R: float
    gamma: float
    g: float
    on_base: bool
    bearing: BearingLaw
    restitution: float
    mass_share: float

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """Return the equations of a scene."""
        block = scene.block
        return cls(
            block.mass,
            scene.total_mass,
            block.inertia,
            block.radius,
            block.slenderness,
            scene.gravity,
            scene.base is not None,
            BearingLaw.of(scene.bearings),
            restitution(scene),
            scene.mass_share,
        )

    def lever(self, s: Values | float, tilt: Values) -> tuple[Values, Values]:
        """Return (c, n) [m]: height of the centre of mass above the corner, and its signed horizontal lever."""
        angle = s * self.gamma - tilt
        return self.R * math.cos(angle), self.R * math.sin(angle)  # type: ignore[return-value]  # `engines.swings.ArrayModel` has it for arrays

    def contact_acceleration(self, bearing_force: Values) -> Values:
        """Return x'' + a_g [m/s2] of the base in full contact, eq. (2)."""
        return -bearing_force / self.M

    @property
    def uplift_acceleration(self) -> float:
        """Return the |absolute base acceleration| above which the block lifts: g tan(gamma) [m/s2]."""
        return self.uplift_limit(0.0)

    def uplift_limit(self, vertical: Values) -> Values:
        """Return the uplift acceleration [m/s2] under a vertical ground acceleration [m/s2]."""
        return (self.g + vertical) * math.tan(self.gamma)

    def accelerations(
        self,
        s: Values | float,
        tilt: Values,
        rate: Values,
        ground: Values,
        bearing_force: Values,
        vertical: Values | float = 0.0,
    ) -> tuple[Values, Values]:
        """Return (phi'', x'') [rad/s2, m/s2] while rocking about the corner of side s, eqs (3)-(6).

        ground, vertical : ground accelerations a_g and a_v [m/s2]. On rigid ground x'' is 0 and the bearing force is
        not used.
        """
        (c, n), g = self.lever(s, tilt), self.g + vertical
        if not self.on_base:
            return -self.m * (c * ground + g * n) / self.J, 0.0  # type: ignore[return-value]  # 0 for all of an array
        m, M, J = self.m, self.M, self.J
        # M (a_g + x'') + m c phi'' = -m n phi'^2 - F;   m c (a_g + x'') + J phi'' = -m (g + a_v) n
        push, moment = -m * n * rate * rate - bearing_force, -m * g * n
        determinant = M * J - (m * c) ** 2
        absolute = (J * push - m * c * moment) / determinant
        return (M * moment - m * c * push) / determinant, absolute - ground

    @property
    def jump_arm(self) -> float:
        """Return the velocity that the base gains at an impact per tilt rate lost [m]: mt R cos(gamma), eq. (8).

        (8) is printed with a factor R cos(gamma) too many; this form conserves horizontal momentum.
        """
        return self.mass_share * self.R * math.cos(self.gamma)

    def impact(self, rate: Values) -> tuple[Values, Values]:
        """Return (phi'+, jump of x') of an impact at tilt rate phi'-, eqs (7) and (8)."""
        after = self.restitution * rate  # (7)
        return after, self.jump_arm * (rate - after)

    def contact_forces(
        self,
        s: Values | float,
        tilt: Values,
        rate: Values,
        tilt_acceleration: Values,
        base_acceleration: Values,
        vertical: Values | float = 0.0,
    ) -> tuple[Values, Values]:
        """Return (H, N) [N]: horizontal and normal force of the base on the block; base_acceleration is absolute."""
        c, n = self.lever(s, tilt)
        horizontal = self.m * (base_acceleration + c * tilt_acceleration + n * rate * rate)
        normal = self.m * (self.g + vertical + n * tilt_acceleration - c * rate * rate)
        return horizontal, normal

    def kinetic_energy(self, s: float, tilt: float, rate: float, v: float) -> float:
        """Return the kinetic energy [J], in the ground's frame; s = 0 for full contact."""
        c = self.lever(s, tilt)[0] if s else 0.0
        return 0.5 * self.M * v * v + self.m * c * rate * v + 0.5 * self.J * rate * rate

    def potential_energy(self, s: float, tilt: float, x: float) -> float:
        """Return the energy of gravity and of the springs kb [J], 0 at rest."""
        height = self.lever(s, tilt)[0] - self.R * math.cos(self.gamma) if s else 0.0
        return self.m * self.g * height + 0.5 * self.bearing.count * self.bearing.kb * x**2


def restitution(scene: Scene) -> float:
    """Return e_phi of a scene: the given one, else that of eq. (7), at least 0."""
    given = scene.block.restitution
    return max(momentum_restitution(scene), 0.0) if given is None else given


def momentum_restitution(scene: Scene) -> float:
    """Return e_phi of eq. (7), 1 - 2 m b^2/(J_O - m mt h^2), from momentum, even if the scene gives another.

    It may be negative (stocky block, light base).
    """
    block = scene.block
    b, h = block.half_width, block.half_height
    return 1 - 2 * block.mass * b**2 / (block.inertia - block.mass * scene.mass_share * h**2)  # (7)


def base_jump_length(scene: Scene) -> float:
    """Return e_x of eq. (8), corrected [m]: x'+ = x'- - e_x phi'-."""
    block, mt = scene.block, scene.mass_share
    R, gamma, m = block.radius, block.slenderness, block.mass
    return (
        2
        * R**3
        * math.sin(gamma) ** 2
        * math.cos(gamma)
        * m
        * mt
        / (R**2 * math.cos(gamma) ** 2 * m * mt - block.inertia)
    )  # (8)


def base_jump_length_as_printed(scene: Scene) -> float:
    """Return e_x of eq. (8) as printed, with a factor R cos(gamma) too many: a length squared.

    It is kept to show the misprint.
    """
    block, mt = scene.block, scene.mass_share
    R, gamma, m = block.radius, block.slenderness, block.mass
    return (
        2
        * R**4
        * (math.sin(gamma) * math.cos(gamma)) ** 2
        * m
        * mt
        / (R**2 * math.cos(gamma) ** 2 * m * mt - block.inertia)
    )


def uplift_of_both(scene: Scene) -> float:
    """Return the |acceleration| [m/s2] above which block and pedestal lift together: g b_1/h_c, of both's centre h_c.

    The scene has a pedestal with mass and height, on which the block is centred.
    """
    width, mass, height = (float(getattr(scene.pedestal, name)) for name in ("width", "mass", "height"))
    moment = 0.5 * mass * height + scene.block.mass * (height + scene.block.half_height)
    return scene.gravity * 0.5 * width * (mass + scene.block.mass) / moment


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
    """Return (loss [J], force [N] at +amplitude) of one bearing in the steady cycle between +-amplitude [m].

    The loss is the integral of the hysteretic force along both branches, exact.
    """
    z = law.hysteretic(0.0, amplitude)
    for _ in range(SETTLING_CYCLES):
        low = law.hysteretic(z, -2 * amplitude)
        z = law.hysteretic(low, 2 * amplitude)
    return 2 * law.work(low, 2 * amplitude), law.kb * amplitude + z


def properties(bearings: Bearings, mass: float, x_max: float) -> BearingProperties:
    """Return the `BearingProperties` of bearings under `mass` (block and base) [kg] at x_max [m]."""
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
    """Return (ka - kb from f0 and alpha minus ka - kb from kb and the ratio, f0 from the loss on the limit curves)."""
    f0 = loss / (4 * (x_max - 1 / (alpha - 2)))
    return 2 * f0 * (alpha - 1) - (ratio - 1) * (secant - f0 / x_max), f0


def _feasible(damping: float, divisor: float, secant: float, x_max: float, ratio: float) -> tuple[float, float]:
    """Return (alpha of least mismatch, the mismatch there); a design exists where it is below 0."""
    from scipy.optimize import minimize_scalar  # slow to load, and few need it

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
    """Return bearings with a given secant period and damping at x_max.

    Parameters
    ----------
    mass, x_max : float
        Mass of block and base together [kg]; design displacement [m].
    period, damping : float
        Secant period [s] and equivalent damping, over critical damping, at x_max; see `definition`.
    count, stiffness_ratio : int, float
        Number of bearings; ka/kb. The paper does not print this ratio; its Table 1(b) has 10.
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
        targets_text = ", ".join(f"{name} = {value:.4g}" for name, value in targets.items() if name != "delta_k")
        ratio = f"stiffness_ratio = {stiffness_ratio:.4g}"
        raise SettingError(f"{targets_text}, {ratio}: no bearings give that; change one of them") from None
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
        require(math.isfinite(number) and number > 0, f"{name} = {number!r}: give a finite number above 0")
        fits = name == "delta_k" or LEAST <= number <= MOST  # so that products do not overflow
        require(fits, f"{name} = {number!r}: give a number from {LEAST:g} to {MOST:g}")
    require(
        1 < stiffness_ratio <= MOST,
        f"stiffness_ratio = {stiffness_ratio!r}: ka/kb must be above 1, and at most {MOST:g}",
    )
    require(count >= 1, f"count = {count!r}: give at least one bearing")
    require(definition in DEFINITIONS, f"definition = {definition!r}: choose one of {', '.join(DEFINITIONS)}")


def _exponent(damping, definition, divisor, secant, x_max, ratio):
    """Return (alpha, f0 [N]) that give the damping at x_max with the stiffness ratio.

    `SettingError` states the limit where there are none.
    """
    from scipy.optimize import brentq  # slow to load, and few need it

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
