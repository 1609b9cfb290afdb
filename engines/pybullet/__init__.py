"""PyBullet (Bullet's multibody solver): ``get_engine("pybullet").simulate(scene, variant=...)``."""

from ..contract import Engine

ENGINE = Engine(
    name="pybullet",
    package="pybullet",
    install="pip install pybullet (its wheels end at CPython 3.11: use Python 3.11)",
    adapter="engines.pybullet.adapter",
    imported="engines.pybullet.imported",
    tolerances="engines.pybullet.tolerances",
    script="engines.pybullet:script.py.jinja",
    mistakes="engines.pybullet.mistakes",
    colour="#0072B2",
    marker="^",
    dashes=":",
    subject=True,
)
