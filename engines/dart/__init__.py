"""DART: ``get_engine("dart").simulate(scene, variant=...)``.

The record of DART and the tolerances of its variants; their scenes are those of the tolerance table.
"""

from ..contract import EXTRA, HELD, LARGE_STEP, READING, ROUNDING, STEP, Engine, ToleranceRow

__all__ = ["ENGINE"]  # keeps the reference from importing the adapter of an extra that may be absent

ENGINE = Engine(
    name="dart",
    title="DART",
    package="dartpy",
    install=EXTRA.format("dart"),
    adapter="engines.dart.adapter",
    tolerances="engines.dart",
    colour="#882255",
    marker="P",
    dashes=(0, (9, 3)),
)


TOLERANCES = {
    "impact-aware": (
        ToleranceRow("restitution, rms", "rigid ground", 4.16e-5, 2.1e-5, LARGE_STEP),
        ToleranceRow("restitution, rms", "sliding base", 1.8e-4, 9.07e-5, LARGE_STEP),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.07e-5, 5.4e-6, LARGE_STEP),
        ToleranceRow("impact times", "rigid ground", 1.12e-3, 5.63e-4, LARGE_STEP),
        ToleranceRow("impact times", "sliding base", 1.88e-4, 9.43e-5, LARGE_STEP),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 6.85e-4, 3.44e-4, LARGE_STEP),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 1.82e-3, 9.14e-4, LARGE_STEP),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 2.59e-5, 1.3e-5, LARGE_STEP),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 2.2e-5, 1.11e-5, LARGE_STEP),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 9.84e-5, 4.95e-5, LARGE_STEP),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 2.5e-5, 1.25e-5, LARGE_STEP
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            3.6e-4,
            1.81e-4,
            LARGE_STEP,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 6.42e-14, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.08e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 5.63e-7, 2.83e-7, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 1.42e-6, 7.13e-7, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 5.81e-7, 2.92e-7, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 7.01e-7, 3.53e-7, LARGE_STEP),
    ),
    "first-script": (
        ToleranceRow("restitution from swings, |mean error|", "rigid ground, slenderness 0.2", 1.1e-3, 5.54e-4, STEP),
        ToleranceRow("restitution from swings, |mean error|", "sliding base, slenderness 0.2", 1.25e-3, 6.41e-4, STEP),
        ToleranceRow("base velocity jump, rms", "sliding base, slenderness 0.2", 3e-3, 1.515e-3, STEP),
    ),
}
