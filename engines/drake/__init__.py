"""Drake: ``get_engine("drake").simulate(scene, variant=...)``.

The record of Drake and the tolerances of its variants; their scenes are those of the tolerance table.
"""

from ..contract import EXTRA, Engine, ToleranceRow

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="drake",
    title="Drake",
    package="pydrake",
    install=EXTRA.format("drake"),
    adapter="engines.drake.adapter",
    tolerances="engines.drake",
    colour="#8C510A",
    marker="X",
    dashes=(0, (3, 1, 1, 1, 1, 1)),
)


ONE_POINT = "two boxes touch in one point, and sink by 1 mm"

TOLERANCES = {
    "first-script": (
        ToleranceRow(
            "restitution from swings, |mean error|", "rigid ground, slenderness 0.2", 2.33e-3, 1.168e-3, ONE_POINT
        ),
        ToleranceRow(
            "restitution from swings, |mean error|", "sliding base, slenderness 0.2", 0.0224, 0.01121, ONE_POINT
        ),
        ToleranceRow("base velocity jump, rms", "sliding base, slenderness 0.2", 0.0454, 0.02273, ONE_POINT),
    )
}
