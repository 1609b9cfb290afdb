"""The laws of a bearing for tests that go through them all, matched in ka, kb and f0."""

from analytic.laws import LAWS
from analytic.rocking import BearingLaw
from analytic.scene import Bearings

NAMES = [law.name for law in LAWS]
USUAL = {"ka": 6.22e4, "kb": 6.22e3, "alpha": 44.69}
F0 = BearingLaw.of(Bearings(**USUAL)).f0


def to_law(name, ka=USUAL["ka"], kb=USUAL["kb"], f0=F0):
    """Changes to the keys of algebraic bearings that give them this law."""
    if name == "bilinear":
        return {"law": name, "alpha": None, "yield_force": f0 * ka / (ka - kb)}
    return {"law": name}


def bearings_of(name, **keys):
    """`Bearings` of this law, with `keys` beside or in place of the usual ones."""
    return Bearings(**{**USUAL, **to_law(name), **keys})
