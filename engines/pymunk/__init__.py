"""pymunk (Chipmunk, planar): ``get_engine("pymunk").simulate(scene, variant=...)``.

The record of pymunk and the tolerances of its variants; their scenes are those of the tolerance table.
"""

from ..contract import EXTRA, HELD, LARGE_STEP, READING, ROUNDING, Engine, ToleranceRow

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="pymunk",
    package="pymunk",
    install=EXTRA.format("pymunk"),
    adapter="engines.pymunk.adapter",
    tolerances="engines.pymunk",
    colour="#009E73",
    marker="v",
    dashes=(0, (6, 1.5, 1, 1.5, 1, 1.5)),
)


TOLERANCES = {
    "impact-aware": (
        ToleranceRow("restitution, rms", "rigid ground", 5.21e-5, 2.62e-5, LARGE_STEP),
        ToleranceRow("restitution, rms", "sliding base", 2.29e-4, 1.15e-4, LARGE_STEP),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.29e-5, 6.49e-6, LARGE_STEP),
        ToleranceRow("impact times", "rigid ground", 1.15e-3, 5.78e-4, LARGE_STEP),
        ToleranceRow("impact times", "sliding base", 1.9e-4, 9.55e-5, LARGE_STEP),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 2.76e-4, 1.39e-4, LARGE_STEP),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 8.09e-4, 4.07e-4, LARGE_STEP),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 1.46e-5, 7.33e-6, LARGE_STEP),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 5.46e-7, 2.75e-7, LARGE_STEP),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 5.42e-4, 2.73e-4, LARGE_STEP),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 2.5e-5, 1.25e-5, LARGE_STEP
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            1.99e-4,
            1e-4,
            LARGE_STEP,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 1.05e-13, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.56e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 5.61e-7, 2.82e-7, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 1.49e-6, 7.49e-7, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 3.62e-8, 1.82e-8, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 3.68e-8, 1.85e-8, LARGE_STEP),
    ),
    "first-script": (
        ToleranceRow(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.016,
            8.27e-3,
            "default slop, into which the corners sink",
        ),
        ToleranceRow(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.036,
            0.0182,
            "default slop, and too few iterations for the base's guide",
        ),
        ToleranceRow(
            "base velocity jump, rms",
            "sliding base, slenderness 0.2",
            0.0457,
            0.023,
            "default slop, and too few iterations for the base's guide",
        ),
    ),
}
