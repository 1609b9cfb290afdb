"""Scenes of a statue on a free pedestal, and random ones."""

import math

import numpy as np

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, SampledMotion, Scene, Start

GRAVITY = 9.81


def rectangle(width, height, mass):
    """Return a `Block`."""
    return Block(mass=mass, radius=0.5 * math.hypot(width, height), slenderness=math.atan2(width, height))


FIGURE, PLINTH = rectangle(0.28, 0.9, 150.0), Pedestal(width=0.5, mass=380.0, height=0.8, free=True)
STACK = Scene(block=FIGURE, pedestal=PLINTH, duration=1.0)
SOFT = {"base": Base(mass=400.0), "bearings": Bearings(count=4, ka=2.4e4, kb=2.4e3, alpha=44.69)}
BENT = {"base": Base(mass=250.0), "bearings": Bearings(law="bilinear", ka=4e4, kb=6e3, yield_force=1800.0)}
_SWAY = np.sin(np.arange(41) * 0.4) * np.array([0.0, 4.0, 7.5, 9.0] * 10 + [0.0])
RECORD = SampledMotion(0.02, _SWAY, vertical=SampledMotion(0.02, 0.6 * _SWAY[::-1]))
# {name: (scene, tilt of the pedestal at the start)}
SIX = {
    "leaning": (STACK.with_(start=Start(tilt=0.07)), 0.11),
    "opposite": (STACK.with_(start=Start(tilt=0.1)), -0.08),
    "joined": (STACK.with_(), 0.05),
    "jolt": (STACK.with_(motion=PulseMotion("rectangular", 6.0, 18.0)), 0.0),
    "soft base": (STACK.with_(motion=PulseMotion("one-cosine", 9.0, 8.0), **SOFT), 0.0),
    "record": (STACK.with_(motion=RECORD, **BENT), 0.0),
}


def random_stack(rng, base=None):
    """Return a scene of museum size; base : share of the mass of both, None for rigid ground."""
    width, height, tangent = rng.uniform(0.35, 0.9), rng.uniform(0.4, 1.3), rng.uniform(0.12, 0.4)
    across = width * rng.uniform(0.3, 0.9)
    mass, block = 2700 * width**2 * height, rectangle(across, across / tangent, 1500 * across**3 / tangent)
    under = None if base is None else Base(mass=base * (mass + block.mass))
    return Scene(block=block, pedestal=Pedestal(width=width, mass=mass, height=height, free=True), base=under)
