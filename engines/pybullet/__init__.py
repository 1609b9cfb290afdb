"""PyBullet (Bullet's multibody solver): ``get_engine("pybullet").simulate(scene, variant=...)``."""

from ..contract import Engine

ENGINE = Engine(
    name="pybullet",
    package="pybullet",
    install="pip install pybullet (its wheels end at CPython 3.11: use Python 3.11)",
    adapter="engines.pybullet.adapter",
    tolerances="engines.pybullet.tolerances",
    colour="#0072B2",
    marker="^",
    dashes=":",
)

# Of first-script: PyBullet's default on either body, which Bullet multiplies. Below tan(slenderness) the block slides.
FIRST_SCRIPT_FRICTION = 0.5 * 0.5
