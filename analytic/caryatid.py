"""The Caryatid, its base and its bearings (text and Table 1 of the paper), used in most studies."""

from .scene import Base, Bearings, Block

MASS, RADIUS = 3172.05, 1.0884  # kg, m
BASE = Base(mass=212.0)
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


def caryatid_block(slenderness: float) -> Block:
    """A block of the Caryatid's mass and radius; slenderness [rad]."""
    return Block(mass=MASS, radius=RADIUS, slenderness=slenderness)
