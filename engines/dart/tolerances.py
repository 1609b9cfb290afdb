"""What the variants of DART are held to; the scenes are those of the tolerance table."""

from ..bounds import APPROACH, LARGE_STEP, READING, ROUNDING, STEP, Bound

LEVEL = "the adapter puts a block on both corners level"

TOLERANCES = {
    "impact-aware": (
        Bound("restitution, rms", "rigid ground", 1.4e-6, 7.22e-7, APPROACH),
        Bound("restitution, rms", "sliding base", 1.5e-5, 7.52e-6, APPROACH),
        Bound("base velocity jump, rms", "sliding base", 5.2e-8, 2.61e-8, APPROACH),
        Bound("impact times", "rigid ground", 1.47e-5, 7.4e-6, LARGE_STEP),
        Bound("impact times", "sliding base", 8.1e-6, 4.07e-6, LARGE_STEP),
        Bound("peak tilt", "rocking on bearings, one-sine", 5.8e-4, 2.902e-4, LARGE_STEP),
        Bound("tilt graph", "rocking on bearings, one-sine", 1.53e-3, 7.69e-4, LARGE_STEP),
        Bound("peak displacement", "rocking on bearings, one-sine", 6.4e-6, 3.23e-6, LARGE_STEP),
        Bound("peak displacement", "isolated Caryatid, synthetic motion", 1.66e-5, 8.35e-6, LARGE_STEP),
        Bound("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 2e-5, 1.001e-5, LARGE_STEP),
        Bound("overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 2.5e-5, 1.25e-5, APPROACH),
        Bound(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            6.7e-4,
            3.375e-4,
            APPROACH,
        ),
        Bound("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 6.42e-14, ROUNDING),
        Bound("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.08e-13, ROUNDING),
        Bound("bearing impulse in the motion", "rocking on bearings, one-sine", 6e-5, 3.01e-5, READING),
        Bound("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 8.4e-5, 4.23e-5, READING),
        Bound("corner lift at rest", "60 s of shaking below uplift, rigid ground", 0.0, 0.0, LEVEL),
        Bound("base drift at rest", "60 s of shaking below uplift, on bearings", 8.5e-7, 4.26e-7, LARGE_STEP),
    ),
    "first-script": (
        Bound(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            1.1e-3,
            5.54e-4,
            STEP,
            least=2.8e-4,
        ),
        Bound(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            1.25e-3,
            6.41e-4,
            STEP,
            least=3.25e-4,
        ),
        Bound("base velocity jump, rms", "sliding base, slenderness 0.2", 3e-3, 1.515e-3, STEP, least=7.6e-4),
    ),
}
