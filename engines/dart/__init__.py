"""DART: ``get_engine("dart").simulate(scene, variant=...)``."""

from ..contract import EXTRA, Engine

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="dart",
    package="dartpy",
    install=EXTRA.format("dart"),
    adapter="engines.dart.adapter",
    tolerances="engines.dart.tolerances",
    colour="#882255",
    marker="P",
    dashes=(0, (9, 3)),
)
