"""The scenes of the study: for each recorded component a block, a scale, and under the isolated one a base on bearings.

All is drawn by a fixed seed and the component's name alone, so that no result could choose it.
"""

import hashlib
import math
from typing import Any

import numpy as np

from analytic import Base, Bearings, Scene
from analytic.bearing import BearingLaw
from analytic.caryatid import MASS, caryatid_block
from analytic.design import design_bearings
from analytic.motion import SampledMotion

from ..fragility.cloud import peak_velocity

SEED = 695
X_MAX = 0.30  # m, at which period and damping of the bearings hold
LAWS = ("algebraic", "bouc-wen", "bilinear")
# Chosen once by the outcomes of the analytic model alone: both kinds mixed, few blocks that do not lift. intensity:
# omega_r PGV/(g tan(slenderness)); base_mass: over the block's; period [s] and damping of the bearings at X_MAX.
RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "free-standing": {"slenderness": (0.1, 0.3), "intensity": (0.35, 1.8)},
    "isolated": {
        "slenderness": (0.1, 0.2),
        "intensity": (0.5, 1.6),
        "base_mass": (0.1, 2.0),
        "period": (1.0, 2.0),
        "damping": (0.1, 0.2),
    },
}
LOGARITHMIC = ("intensity", "base_mass")  # evenly over the logarithm


def drawn_scene(configuration: str, name: str, motion: SampledMotion) -> tuple[Scene, dict[str, Any]]:
    """(the scene of a component, what was drawn for it); name: the component's, motion: as recorded."""
    seed = int(hashlib.sha256(f"{configuration} {name}".encode()).hexdigest()[:16], 16)
    rng = np.random.default_rng([SEED, seed])
    drawn: dict[str, Any] = {key: _draw(rng, key, *ends) for key, ends in RANGES[configuration].items()}
    scene = Scene(block=caryatid_block(drawn["slenderness"]), name=f"{name}, {configuration}")
    if "period" in drawn:
        drawn["law"] = str(rng.choice(LAWS))
        base = Base(mass=MASS * drawn["base_mass"])
        bearings = design_bearings(MASS + base.mass, drawn["period"], drawn["damping"], X_MAX)
        scene = scene.with_(base=base, bearings=_by_law(bearings, drawn["law"]))
    uplift = scene.gravity * math.tan(drawn["slenderness"])
    drawn["scale"] = drawn["intensity"] * uplift / (scene.rocking_frequency * peak_velocity(motion))
    return scene.with_(motion=motion.scaled(drawn["scale"])), drawn


def _draw(rng: np.random.Generator, key: str, low: float, high: float) -> float:
    return low * (high / low) ** rng.random() if key in LOGARITHMIC else float(rng.uniform(low, high))


def _by_law(bearings: Bearings, law: str) -> Bearings:
    """Bearings of another law with the stiffnesses and the characteristic strength of algebraic ones."""
    if law != "bilinear":
        return Bearings(**{**bearings.model_dump(), "law": law})
    given = BearingLaw.of(bearings)
    strength = given.f0 / (1 - bearings.given("kb") / bearings.ka)
    return Bearings(law=law, count=bearings.count, ka=bearings.ka, kb=bearings.kb, yield_force=strength, x_max=X_MAX)
