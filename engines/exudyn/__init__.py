"""exudyn: ``get_engine("exudyn").simulate(scene, variant=...)``."""

from ..contract import Engine

ENGINE = Engine(
    name="exudyn",
    package="exudyn",
    install="pip install exudyn",
    adapter="engines.exudyn.adapter",
    tolerances="engines.exudyn.tolerances",
    script="engines.exudyn:script.py.jinja",
    mistakes="engines.exudyn.mistakes",
    colour="#E69F00",
    marker="s",
    dashes="--",
    subject=True,
)
