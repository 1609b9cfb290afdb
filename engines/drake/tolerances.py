"""What the variants of Drake are held to; the scenes are those of the tolerance table."""

from ..bounds import Bound

ONE_POINT = "two boxes touch in one point, and sink by 1 mm"

TOLERANCES = {
    "first-script": (
        Bound("restitution from swings, |mean error|", "rigid ground, slenderness 0.2", 2.33e-3, 1.168e-3, ONE_POINT),
        Bound("restitution from swings, |mean error|", "sliding base, slenderness 0.2", 0.0224, 0.01121, ONE_POINT),
        Bound("base velocity jump, rms", "sliding base, slenderness 0.2", 0.0454, 0.02273, ONE_POINT),
    )
}
