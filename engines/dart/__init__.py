"""DART: ``get_engine("dart").simulate(scene, variant=...)``."""

from ..contract import EXTRA, Engine

__all__ = ["ENGINE"]  # else the reference imports the rest, and an extra may be absent

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
