"""Tolerances of the variants of exudyn; the scenes are those of the tolerance table."""

from ..tolerance_rows import HELD, READING, ROUNDING, ToleranceRow

# A jump of the ground's acceleration errs as the others only where the block is at rest from the start until then; see
# `sizing.CompliantCorners`.
STIFFNESS = "contact stiffness; goes as its inverse"

TOLERANCES = {
    "compliant-corners": (
        ToleranceRow("restitution, rms", "rigid ground", 8.8e-6, 4.41e-6, STIFFNESS),
        ToleranceRow("restitution, rms", "sliding base", 1.9e-5, 9.76e-6, STIFFNESS),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.37e-5, 6.89e-6, STIFFNESS),
        ToleranceRow("impact times", "rigid ground", 1.8e-4, 1.0e-4, STIFFNESS),
        ToleranceRow("impact times", "sliding base", 3.8e-5, 2.44e-5, STIFFNESS),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 6.4e-4, 3.23e-4, STIFFNESS),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 1.6e-3, 8.14e-4, STIFFNESS),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 3.8e-5, 2.72e-5, STIFFNESS),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 1.4e-5, 1.09e-5, STIFFNESS),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 8.2e-5, 4.12e-5, STIFFNESS),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 7.5e-5, 3.75e-5, STIFFNESS
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            5.3e-4,
            2.67e-4,
            STIFFNESS,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 2.2e-13, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 4.4e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 7.5e-6, 3.77e-6, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 8e-6, 4.11e-6, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 2.8e-7, 1.40e-7, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 1.5e-6, 9.98e-7, HELD),
    ),
    "native-contact": (
        ToleranceRow(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.04,
            0.0275,
            "the damper pulls at the lifting corner, friction creeps",
        ),
        ToleranceRow(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.07,
            0.0451,
            "the damper pulls at the lifting corner, friction creeps",
        ),
    ),
}
