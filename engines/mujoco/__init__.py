"""MuJoCo: ``get_engine("mujoco").simulate(scene, variant=...)``.

The record of MuJoCo and the tolerances of its variants; their scenes are those of the tolerance table.
"""

from ..contract import EXTRA, HELD, LARGE_STEP, READING, ROUNDING, STEP, Engine, ToleranceRow

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="mujoco",
    title="MuJoCo",
    package="mujoco",
    install=EXTRA.format("mujoco"),
    adapter="engines.mujoco.adapter",
    tolerances="engines.mujoco",
    colour="#CC79A7",
    marker="D",
    dashes="-.",
)


TOLERANCES = {
    "impact-aware": (
        ToleranceRow("restitution, rms", "rigid ground", 3.73e-5, 1.88e-5, LARGE_STEP),
        ToleranceRow("restitution, rms", "sliding base", 3.58e-5, 1.8e-5, LARGE_STEP),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.15e-5, 5.76e-6, LARGE_STEP),
        ToleranceRow("impact times", "rigid ground", 5.94e-4, 2.99e-4, LARGE_STEP),
        ToleranceRow("impact times", "sliding base", 5.47e-5, 2.75e-5, LARGE_STEP),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 1.19e-4, 5.98e-5, LARGE_STEP),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 3.51e-4, 1.76e-4, LARGE_STEP),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 7.8e-6, 3.92e-6, LARGE_STEP),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 6.92e-7, 3.48e-7, LARGE_STEP),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 8.99e-5, 4.52e-5, LARGE_STEP),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 2.48e-5, 1.25e-5, LARGE_STEP
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            4.38e-4,
            2.2e-4,
            LARGE_STEP,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 1.8e-13, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 3.6e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 5.56e-7, 2.8e-7, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 1.45e-6, 7.51e-7, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 5.11e-8, 2.57e-8, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 8.05e-8, 4.05e-8, LARGE_STEP),
    ),
    "fixed-step": (
        ToleranceRow("restitution, rms", "rigid ground, slenderness 0.2", 4.14e-4, 2.08e-4, STEP),
        ToleranceRow("restitution, rms", "sliding base, slenderness 0.2", 1.48e-3, 7.46e-4, STEP),
        ToleranceRow("base velocity jump, rms", "sliding base, slenderness 0.2", 1.63e-4, 8.2e-5, STEP),
    ),
    "first-script": (
        ToleranceRow(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            6e-3,
            3.9e-3,
            "soft contact over several steps",
        ),
        ToleranceRow(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.12,
            0.0725,
            "soft contact over several steps",
        ),
        ToleranceRow(
            "base velocity jump, rms", "sliding base, slenderness 0.2", 0.04, 0.0227, "soft contact over several steps"
        ),
    ),
}
