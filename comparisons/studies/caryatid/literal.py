"""The paper's equations written out literally, misprints included: to be held against the corrected model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scipy.optimize import brentq

from analytic.rocking import restitution

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.bearing import BearingLaw


def branch(law: BearingLaw, x: float, s: float, x_j: float, misprinted: bool = False) -> float:
    """Force of one bearing [N] on the branch of direction s, eqs (9) to (12), with the paper's x_j.

    The bracket is 1 + s x - s x_j + 2 x0. As printed, eq. (12) for unloading (s = -1) has the signs of loading:
    1 + x - x_j + 2 x0.
    """
    sign = 1 if misprinted else s
    bracket = 1 + sign * (x - x_j) + 2 * law.x0
    return law.kb * x + law.dk * (bracket ** (1 - law.alpha) - law.d0) / (s * (1 - law.alpha)) + s * law.f0


def history_point(law: BearingLaw, x: float, force: float, s: float) -> float:
    """x_j [m] of the branch of direction s through the point (x [m], force [N]) of a reversal, found as a root."""
    # at the root the bracket lies between 1 (on the other limit curve) and 1 + 2 x0 (on this one)
    edges = sorted((x, x + 2 * s * law.x0))
    return brentq(lambda x_j: branch(law, x, s, x_j) - force, *edges, xtol=1e-15, rtol=1e-15)


def momentum_after(scene: Scene, jump_length: float, rate: float = -1.0) -> float:
    """Horizontal momentum after an impact over that before it, for a base velocity jump -e_x phi'-; 1 if conserved.

    Before: m h w (the base stands). After: m h e_phi w + (m + m_b) jump.
    """
    before = scene.block.mass * scene.block.half_height * rate
    after = restitution(scene) * before - scene.total_mass * jump_length * rate
    return after / before
