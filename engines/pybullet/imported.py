"""Import of PyBullet without the line that it prints."""

import numpy  # noqa: F401 imported before PyBullet, which would load it slowly

from ..greeting import without

with without(b"pybullet build time"):
    import pybullet

__all__ = ["pybullet"]
