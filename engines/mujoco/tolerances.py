"""What the variants of MuJoCo are held to; the scenes are those of the tolerance table."""

from ..bounds import APPROACH, HELD, LARGE_STEP, READING, ROUNDING, STEP, Bound

TOLERANCES = {
    "impact-aware": (
        Bound("restitution, rms", "rigid ground", 4.8e-5, 2.50e-5, APPROACH),
        Bound("restitution, rms", "sliding base", 6.5e-5, 3.34e-5, APPROACH),
        Bound("base velocity jump, rms", "sliding base", 1.6e-6, 8.33e-7, APPROACH),
        Bound("impact times", "rigid ground", 1.25e-4, 6.40e-5, LARGE_STEP),
        Bound("impact times", "sliding base", 1.4e-4, 7.23e-5, LARGE_STEP),
        Bound("peak tilt", "rocking on bearings, one-sine", 7e-5, 3.60e-5, LARGE_STEP),
        Bound("tilt graph", "rocking on bearings, one-sine", 2.1e-4, 1.10e-4, LARGE_STEP),
        Bound("peak displacement", "rocking on bearings, one-sine", 4.7e-8, 2.37e-8, LARGE_STEP),
        Bound("peak displacement", "isolated Caryatid, synthetic motion", 5e-7, 2.67e-7, LARGE_STEP),
        Bound("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 1.1e-4, 5.61e-5, LARGE_STEP),
        Bound("overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 7.5e-5, 3.75e-5, APPROACH),
        Bound(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            2.5e-5,
            1.25e-5,
            APPROACH,
        ),
        Bound("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 1.8e-13, ROUNDING),
        Bound("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 3.6e-13, ROUNDING),
        Bound("bearing impulse in the motion", "rocking on bearings, one-sine", 1e-6, 5.32e-7, READING),
        Bound("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 1.45e-6, 7.51e-7, READING),
        Bound("corner lift at rest", "60 s of shaking below uplift, rigid ground", 6e-8, 3.09e-8, HELD),
        Bound("base drift at rest", "60 s of shaking below uplift, on bearings", 4.5e-8, 2.26e-8, LARGE_STEP),
    ),
    "fixed-step": (
        Bound("restitution, rms", "rigid ground, slenderness 0.2", 3e-4, 1.58e-4, STEP),
        Bound("restitution, rms", "sliding base, slenderness 0.2", 7.5e-4, 3.86e-4, STEP),
        Bound("base velocity jump, rms", "sliding base, slenderness 0.2", 8e-5, 4.29e-5, STEP),
    ),
    "first-script": (
        Bound(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.006,
            0.0039,
            "soft contact over several steps",
            least=0.002,
        ),
        Bound(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.12,
            0.0725,
            "soft contact over several steps",
            least=0.04,
        ),
        Bound(
            "base velocity jump, rms",
            "sliding base, slenderness 0.2",
            0.04,
            0.0227,
            "soft contact over several steps",
            least=0.012,
        ),
    ),
}
