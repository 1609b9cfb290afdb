"""What the variants of Drake are held to; the scenes are those of the tolerance table."""

from ..bounds import APPROACH, LARGE_STEP, READING, ROUNDING, STEP, Bound

LEVEL = "the adapter puts a block on both corners level"
SINK = "Drake's contact yields: a block sinks while it pivots"
ONE_POINT = "two boxes touch in one point, and sink by 1 mm"

TOLERANCES = {
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
    )
}
