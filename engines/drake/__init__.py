"""Drake: ``get_engine("drake").simulate(scene, variant=...)``."""

from ..contract import EXTRA, Engine

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="drake",
    package="pydrake",
    install=EXTRA.format("drake"),
    adapter="engines.drake.adapter",
    tolerances="engines.drake.tolerances",
    colour="#8C510A",
    marker="X",
    dashes=(0, (3, 1, 1, 1, 1, 1)),
)
