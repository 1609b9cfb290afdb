"""MuJoCo: ``get_engine("mujoco").simulate(scene, variant=...)``."""

from ..contract import EXTRA, Engine

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="mujoco",
    package="mujoco",
    install=EXTRA.format("mujoco"),
    adapter="engines.mujoco.adapter",
    tolerances="engines.mujoco.tolerances",
    colour="#CC79A7",
    marker="D",
    dashes="-.",
)
