"""What the variants of pymunk are held to; the scenes are those of the tolerance table."""

from ..bounds import APPROACH, LARGE_STEP, READING, ROUNDING, STEP, Bound

TOLERANCES = {
    "impact-aware": (
        Bound("restitution, rms", "rigid ground", 1.5e-6, 7.83e-7, APPROACH),
        Bound("restitution, rms", "sliding base", 1.5e-5, 7.73e-6, APPROACH),
        Bound("base velocity jump, rms", "sliding base", 7.6e-10, 3.85e-10, APPROACH),
        Bound("impact times", "rigid ground", 1.1e-5, 5.82e-6, LARGE_STEP),
        Bound("impact times", "sliding base", 5.6e-6, 2.82e-6, LARGE_STEP),
        Bound("peak tilt", "rocking on bearings, one-sine", 5.8e-5, 2.94e-5, LARGE_STEP),
        Bound("tilt graph", "rocking on bearings, one-sine", 1.6e-4, 8.08e-5, LARGE_STEP),
        Bound("peak displacement", "rocking on bearings, one-sine", 4.9e-6, 2.46e-6, LARGE_STEP),
        Bound("peak displacement", "isolated Caryatid, synthetic motion", 6.8e-6, 3.43e-6, LARGE_STEP),
        Bound("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 3e-5, 1.52e-5, LARGE_STEP),
        Bound("overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 2.5e-5, 1.25e-5, APPROACH),
        Bound(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            7.6e-4,
            3.84e-4,
            APPROACH,
        ),
        Bound("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 1.05e-13, ROUNDING),
        Bound("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.56e-13, ROUNDING),
        Bound("bearing impulse in the motion", "rocking on bearings, one-sine", 3.3e-5, 1.65e-5, READING),
        Bound("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 3.5e-5, 1.78e-5, READING),
        Bound(
            "corner lift at rest",
            "60 s of shaking below uplift, rigid ground",
            0.0,
            0.0,
            "the adapter puts a block on both corners level",
        ),
        Bound("base drift at rest", "60 s of shaking below uplift, on bearings", 4.7e-7, 2.36e-7, LARGE_STEP),
    ),
    "first-script": (
        Bound(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.016,
            0.00827,
            "default slop, into which the corners sink",
            least=0.005,
        ),
        Bound(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.036,
            0.0182,
            "default slop, and too few iterations for the base's guide",
            least=0.01,
        ),
        Bound(
            "base velocity jump, rms",
            "sliding base, slenderness 0.2",
            0.18,
            0.0931,
            "default slop, and too few iterations for the base's guide",
            least=0.05,
        ),
    ),
}
