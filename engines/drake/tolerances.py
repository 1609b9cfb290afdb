"""Tolerances of the variants of Drake; the scenes are those of the tolerance table."""

from ..tolerance_rows import ToleranceRow

ONE_POINT = "two boxes touch in one point, and sink by 1 mm"

TOLERANCES = {
    "first-script": (
        ToleranceRow(
            "restitution from swings, |mean error|", "rigid ground, slenderness 0.2", 2.33e-3, 1.168e-3, ONE_POINT
        ),
        ToleranceRow(
            "restitution from swings, |mean error|", "sliding base, slenderness 0.2", 0.0224, 0.01121, ONE_POINT
        ),
        ToleranceRow("base velocity jump, rms", "sliding base, slenderness 0.2", 0.0454, 0.02273, ONE_POINT),
    )
}
