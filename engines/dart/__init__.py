"""DART: ``get_engine("dart").simulate(scene, variant=...)``."""

from ..contract import EXTRA, Engine

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
