"""Scenes modelled with more than they need, to measure the cost of it and its effect on the error."""

import math

from analytic import Base, Bearings, Scene

HEAVY = 1e6  # mass of a base that stands for rigid ground, over the block's
SUPPORT_FREQUENCY = 2 * math.pi * 50  # rad/s: a support meant to be rigid


def on_heavy_base(scene: Scene) -> Scene:
    """Rigid ground as a free base of 10^6 block masses: two degrees of freedom instead of one."""
    return scene.with_(base=Base(mass=HEAVY * scene.block.mass))


def on_stiff_springs(scene: Scene) -> Scene:
    """Rigid ground as a heavy base on linear springs of 50 Hz: two degrees of freedom, and a stiff one."""
    base = Base(mass=HEAVY * scene.block.mass)
    springs = Bearings(law="linear", ka=(base.mass + scene.block.mass) * SUPPORT_FREQUENCY**2)
    return scene.with_(base=base, bearings=springs)
