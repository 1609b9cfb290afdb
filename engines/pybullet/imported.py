"""PyBullet as it is imported here: without the line that it prints then."""

import numpy  # noqa: F401 else PyBullet loads it, which takes longer than all the rest

from ..greeting import without

with without(b"pybullet build time"):
    import pybullet

__all__ = ["pybullet"]
