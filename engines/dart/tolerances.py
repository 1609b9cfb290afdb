"""What the variants of DART are held to; the scenes are those of the tolerance table."""

from ..bounds import APPROACH, LARGE_STEP, READING, ROUNDING, STEP, Bound

LEVEL = "the adapter puts a block on both corners level"

TOLERANCES = {
    "impact-aware": (
        Bound("restitution, rms", "rigid ground", 1.3e-5, 6.78e-6, APPROACH),
        Bound("restitution, rms", "sliding base", 3.3e-5, 1.65e-5, APPROACH),
        Bound("base velocity jump, rms", "sliding base", 2.08e-5, 1.04e-5, APPROACH),
        Bound("impact times", "rigid ground", 2.6e-4, 1.33e-4, LARGE_STEP),
        Bound("impact times", "sliding base", 1.07e-4, 5.39e-5, LARGE_STEP),
        Bound("peak tilt", "rocking on bearings, one-sine", 5.6e-4, 2.84e-4, LARGE_STEP),
        Bound("tilt graph", "rocking on bearings, one-sine", 1.48e-3, 7.43e-4, LARGE_STEP),
        Bound("peak displacement", "rocking on bearings, one-sine", 6.4e-6, 3.23e-6, LARGE_STEP),
        Bound("peak displacement", "isolated Caryatid, synthetic motion", 1.66e-5, 8.35e-6, LARGE_STEP),
        Bound("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 2e-5, 1.001e-5, LARGE_STEP),
        Bound("overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 7.5e-5, 3.75e-5, APPROACH),
        Bound(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            2.8e-4,
            1.42e-4,
            APPROACH,
        ),
        Bound("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 6.42e-14, ROUNDING),
        Bound("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.08e-13, ROUNDING),
        Bound("bearing impulse in the motion", "rocking on bearings, one-sine", 5e-5, 2.51e-5, READING),
        Bound("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 8.4e-5, 4.23e-5, READING),
        Bound("corner lift at rest", "60 s of shaking below uplift, rigid ground", 0.0, 0.0, LEVEL),
        Bound("base drift at rest", "60 s of shaking below uplift, on bearings", 1.2e-6, 6e-7, LARGE_STEP),
    ),
    "expert": (
        Bound("restitution, rms", "rigid ground, slenderness 0.2", 6.6e-4, 3.32e-4, STEP),
        Bound("restitution, rms", "sliding base, slenderness 0.2", 2.2e-3, 1.135e-3, STEP),
        Bound("base velocity jump, rms", "sliding base, slenderness 0.2", 3.9e-4, 1.99e-4, STEP),
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
