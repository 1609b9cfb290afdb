"""What the variants of Drake are held to; the scenes are those of the tolerance table."""

from ..bounds import APPROACH, LARGE_STEP, READING, ROUNDING, STEP, Bound

LEVEL = "the adapter puts a block on both corners level"
SINK = "Drake's contact yields: a block sinks while it pivots"
ONE_POINT = "two boxes touch in one point, and sink by 1 mm"

TOLERANCES = {
    "impact-aware": (
        Bound("restitution, rms", "rigid ground", 2.3e-6, 1.152e-6, APPROACH),
        Bound("restitution, rms", "sliding base", 1.51e-5, 7.551e-6, APPROACH),
        Bound("base velocity jump, rms", "sliding base", 2.15e-6, 1.075e-6, APPROACH),
        Bound("impact times", "rigid ground", 6.32e-5, 3.162e-5, SINK),
        Bound("impact times", "sliding base", 3.91e-5, 1.958e-5, SINK),
        Bound("peak tilt", "rocking on bearings, one-sine", 0.000337, 1.689e-4, LARGE_STEP),
        Bound("tilt graph", "rocking on bearings, one-sine", 0.000916, 0.000458, LARGE_STEP),
        Bound("peak displacement", "rocking on bearings, one-sine", 7.07e-6, 3.538e-6, LARGE_STEP),
        Bound("peak displacement", "isolated Caryatid, synthetic motion", 1.02e-5, 5.141e-6, LARGE_STEP),
        Bound("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 3.72e-5, 1.86e-5, LARGE_STEP),
        Bound("overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 5e-5, 2.5e-5, APPROACH),
        Bound(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            0.000596,
            0.0002984,
            APPROACH,
        ),
        Bound("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 6.566e-14, ROUNDING),
        Bound("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 1.891e-13, ROUNDING),
        Bound("bearing impulse in the motion", "rocking on bearings, one-sine", 6e-5, 3.004e-5, READING),
        Bound("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 8.45e-5, 4.226e-5, READING),
        Bound("corner lift at rest", "60 s of shaking below uplift, rigid ground", 0.0, 0.0, LEVEL),
        Bound("base drift at rest", "60 s of shaking below uplift, on bearings", 1.73e-6, 8.685e-7, SINK),
    ),
    "expert": (
        Bound("restitution, rms", "rigid ground, slenderness 0.2", 0.000939, 0.0004699, STEP),
        Bound("restitution, rms", "sliding base, slenderness 0.2", 0.00169, 0.0008451, STEP),
        Bound("base velocity jump, rms", "sliding base, slenderness 0.2", 0.000367, 0.0001839, STEP),
    ),
    "first-script": (
        Bound(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.00233,
            0.001168,
            ONE_POINT,
            least=5.85e-4,
        ),
        Bound(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.0224,
            0.01121,
            ONE_POINT,
            least=0.00561,
        ),
        Bound("base velocity jump, rms", "sliding base, slenderness 0.2", 0.0454, 0.02273, ONE_POINT, least=0.0114),
    ),
}
