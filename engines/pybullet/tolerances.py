"""Tolerances of the variants of PyBullet; the scenes are those of the tolerance table."""

from ..tolerance_rows import HELD, LARGE_STEP, READING, ROUNDING, STEP, ToleranceRow

TOLERANCES = {
    "impact-aware": (
        ToleranceRow("restitution, rms", "rigid ground", 1.47e-5, 7.41e-6, LARGE_STEP),
        ToleranceRow("restitution, rms", "sliding base", 4e-5, 3.49e-5, LARGE_STEP),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.5e-6, 7.57e-7, LARGE_STEP),
        ToleranceRow("impact times", "rigid ground", 3.36e-4, 1.69e-4, LARGE_STEP),
        ToleranceRow("impact times", "sliding base", 9.37e-5, 4.71e-5, LARGE_STEP),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 4.5e-5, 2.26e-5, LARGE_STEP),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 7.31e-5, 3.68e-5, LARGE_STEP),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 4.58e-6, 2.3e-6, LARGE_STEP),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 6.5e-6, 4.26e-6, LARGE_STEP),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 4.4e-4, 2.21e-4, LARGE_STEP),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 1.24e-4, 6.25e-5, LARGE_STEP
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            1.12e-3,
            5.64e-4,
            LARGE_STEP,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 8.7e-14, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.2e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 1.24e-5, 6.26e-6, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 3.5e-5, 1.88e-5, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 5e-10, 2.52e-10, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 4.5e-7, 2.36e-7, LARGE_STEP),
    ),
    "fixed-step": (
        ToleranceRow("restitution, rms", "rigid ground, slenderness 0.2", 1.2e-3, 6.18e-4, STEP),
        ToleranceRow("restitution, rms", "sliding base, slenderness 0.2", 2.1e-3, 1.08e-3, STEP),
        ToleranceRow("base velocity jump, rms", "sliding base, slenderness 0.2", 1.2e-4, 6.18e-5, STEP),
    ),
    "first-script": (
        ToleranceRow(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.025,
            0.0151,
            "default damping of 0.04 in flight; independent of the step",
        ),
        ToleranceRow(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.12,
            0.0746,
            "default damping in flight and the joint's default motor",
        ),
        ToleranceRow(
            "base velocity jump, rms",
            "sliding base, slenderness 0.2",
            0.09,
            0.0491,
            "contact spread over several steps",
        ),
    ),
}
