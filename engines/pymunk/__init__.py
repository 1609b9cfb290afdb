"""pymunk (Chipmunk, planar): ``get_engine("pymunk").simulate(scene, variant=...)``."""

from ..contract import EXTRA, Engine

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="pymunk",
    package="pymunk",
    install=EXTRA.format("pymunk"),
    adapter="engines.pymunk.adapter",
    tolerances="engines.pymunk.tolerances",
    colour="#009E73",
    marker="v",
    dashes=(0, (6, 1.5, 1, 1.5, 1, 1.5)),
)
