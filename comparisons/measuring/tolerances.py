"""The one table of agreement tolerances: what each engine is held to, and how far off it was when that was set.

The verification tests assert every row, the report prints the table with the value measured anew beside it. A bound
is at most twice the `measured` worst (but for round-off); where an engine gets better, the test says so, and the
bound is to be tightened.
"""

from collections.abc import Callable
from dataclasses import dataclass

from . import agreement
from .agreement import (
    DRIVEN,
    FALLING,
    HARD_PULSES,
    ISOLATED,
    PULSES,
    RIGID,
    RIGID_2,
    SLIDING,
    SLIDING_2,
    STANDING,
    STANDING_ISOLATED,
)

SLACK = 2.0  # a bound is no looser than this times the measured worst


@dataclass(frozen=True)
class Tolerance:
    """One row: `quantity` of an engine's variant over `scenes`, measured by `measure`, is at most `bound` [unit].

    measured: the worst found when the bound was set. least: of a first-script variant, whose error is known and must
    not vanish unnoticed, the lower end of the band; 0 else. round_off: the bound is what is asked for, and the
    measured value mere round-off, far below. source: what the error comes from.
    """

    quantity: str
    measure: Callable
    engine: str
    variant: str
    scenes: str
    bound: float
    unit: str
    measured: float
    source: str
    least: float = 0.0
    round_off: bool = False

    @property
    def name(self):
        return f"{self.quantity}: {self.engine}, {self.variant}, {self.scenes}"

    def found(self, runs=None):
        """The quantity measured here and now; `runs` (dict) keeps simulations that rows share.

        Raises
        ------
        Unmeasurable
            A run failed.
        EngineNotInstalled
        """
        return self.measure(self.engine, self.variant, self.scenes, {} if runs is None else runs)

    def holds(self, value):
        """Whether a measured value lies within the bound (and not below the band)."""
        return self.least <= value <= self.bound


# quantity: how it is measured, unit
QUANTITIES = {
    "restitution, rms": (agreement.restitution_rms, "-"),
    "restitution from swings, |mean error|": (agreement.swing_restitution_bias, "-"),
    "base velocity jump, rms": (agreement.base_jump_rms, "relative"),
    "impact times": (agreement.impact_times, "s"),
    "peak tilt": (agreement.peak_tilt, "slenderness"),
    "peak displacement": (agreement.peak_displacement, "relative"),
    "tilt graph": (agreement.tilt_graph, "-"),
    "overturning time": (agreement.overturning_time, "s"),
    "overturning boundary": (agreement.boundary_shift, "relative"),
    "bearing force replayed": (agreement.bearing_replay, "f0"),
    "bearing impulse in the motion": (agreement.bearing_impulse, "relative"),
    "corner lift at rest": (agreement.corner_lift, "m"),
    "base drift at rest": (agreement.base_drift, "m"),
}

STIFFNESS = "contact stiffness; goes as its inverse"
APPROACH = "share of its speed that the block gains in the step of the impact (accuracy)"
STEP = "step; first order, by the phase of the impact in it"
LARGE_STEP = "steps in flight and at rest"
HELD = "what the contact gives at rest"
READING = "steps, and their force and momentum as read between them"
ROUNDING = "history committed once per accepted step; round-off"

# engine and variant: rows of (quantity, scenes, bound, measured, source)
_BOUNDS = {
    ("exudyn", "compliant-corners"): (
        ("restitution, rms", RIGID, 1.6e-5, 8.63e-6, STIFFNESS),
        ("restitution, rms", SLIDING, 1.9e-5, 9.92e-6, STIFFNESS),
        ("base velocity jump, rms", SLIDING, 1.4e-5, 7.26e-6, STIFFNESS),
        ("impact times", RIGID, 1.8e-4, 9.53e-5, STIFFNESS),
        ("impact times", SLIDING, 3.8e-5, 1.93e-5, STIFFNESS),
        ("peak tilt", DRIVEN, 8.5e-4, 4.49e-4, STIFFNESS),
        ("tilt graph", DRIVEN, 2.2e-3, 1.15e-3, STIFFNESS),
        ("peak displacement", DRIVEN, 3.8e-5, 1.91e-5, STIFFNESS),
        ("peak displacement", ISOLATED, 1.4e-5, 7.15e-6, STIFFNESS),
        ("overturning time", FALLING, 8.5e-5, 4.32e-5, STIFFNESS),
        ("overturning boundary", PULSES, 1.75e-4, 8.75e-5, STIFFNESS),
        ("overturning boundary", HARD_PULSES, 2.2e-3, 1.18e-3, STIFFNESS),
        ("bearing force replayed", DRIVEN, 1e-9, 2.2e-13, ROUNDING),
        ("bearing force replayed", ISOLATED, 1e-9, 4.4e-13, ROUNDING),
        ("bearing impulse in the motion", DRIVEN, 9.5e-7, 4.97e-7, READING),
        ("bearing impulse in the motion", ISOLATED, 1.4e-6, 7.19e-7, READING),
        ("corner lift at rest", STANDING, 2.8e-7, 1.40e-7, HELD),
        ("base drift at rest", STANDING_ISOLATED, 1.5e-6, 7.92e-7, HELD),
    ),
    ("pybullet", "impact-aware"): (
        ("restitution, rms", RIGID, 4e-5, 2.11e-5, APPROACH),
        ("restitution, rms", SLIDING, 4e-5, 2.14e-5, APPROACH),
        ("base velocity jump, rms", SLIDING, 2.7e-6, 1.39e-6, APPROACH),
        ("impact times", RIGID, 1e-3, 5.14e-4, LARGE_STEP),
        ("impact times", SLIDING, 2.7e-4, 1.40e-4, LARGE_STEP),
        ("peak tilt", DRIVEN, 2e-4, 1.02e-4, LARGE_STEP),
        ("tilt graph", DRIVEN, 5e-4, 2.55e-4, LARGE_STEP),
        ("peak displacement", DRIVEN, 5e-6, 2.57e-6, LARGE_STEP),
        ("peak displacement", ISOLATED, 6.5e-6, 3.43e-6, LARGE_STEP),
        ("overturning time", FALLING, 4.4e-4, 2.21e-4, LARGE_STEP),
        ("overturning boundary", PULSES, 7.5e-5, 3.75e-5, APPROACH),
        ("overturning boundary", HARD_PULSES, 1.5e-3, 8.03e-4, APPROACH),
        ("bearing force replayed", DRIVEN, 1e-9, 8.7e-14, ROUNDING),
        ("bearing force replayed", ISOLATED, 1e-9, 2.2e-13, ROUNDING),
        ("bearing impulse in the motion", DRIVEN, 3.8e-5, 1.96e-5, READING),
        ("bearing impulse in the motion", ISOLATED, 3.5e-5, 1.78e-5, READING),
        ("corner lift at rest", STANDING, 5e-10, 2.52e-10, HELD),
        ("base drift at rest", STANDING_ISOLATED, 4.5e-7, 2.36e-7, LARGE_STEP),
    ),
    ("exudyn", "switched-joints"): (
        ("restitution, rms", RIGID_2, 8e-10, 4.03e-10, "step squared; the impact is the model's own"),
        ("restitution, rms", SLIDING_2, 4.6e-9, 2.35e-9, "step squared; the impact is the model's own"),
        ("base velocity jump, rms", SLIDING_2, 4.3e-9, 2.19e-9, "step squared; the impact is the model's own"),
        ("bearing force replayed", DRIVEN, 1e-9, 9.4e-14, ROUNDING),
        ("bearing impulse in the motion", DRIVEN, 1.2e-5, 6.37e-6, READING),
    ),
    ("pybullet", "fixed-step"): (
        ("restitution, rms", RIGID_2, 1.2e-3, 6.18e-4, STEP),
        ("restitution, rms", SLIDING_2, 2.1e-3, 1.08e-3, STEP),
        ("base velocity jump, rms", SLIDING_2, 1.2e-4, 6.18e-5, STEP),
    ),
    ("mujoco", "impact-aware"): (
        ("restitution, rms", RIGID, 4.8e-5, 2.50e-5, APPROACH),
        ("restitution, rms", SLIDING, 6.5e-5, 3.34e-5, APPROACH),
        ("base velocity jump, rms", SLIDING, 1.6e-6, 8.33e-7, APPROACH),
        ("impact times", RIGID, 2.8e-4, 1.45e-4, LARGE_STEP),
        ("impact times", SLIDING, 1.4e-4, 7.23e-5, LARGE_STEP),
        ("peak tilt", DRIVEN, 2.1e-4, 1.05e-4, LARGE_STEP),
        ("tilt graph", DRIVEN, 5.4e-4, 2.71e-4, LARGE_STEP),
        ("peak displacement", DRIVEN, 9e-6, 4.51e-6, LARGE_STEP),
        ("peak displacement", ISOLATED, 5e-7, 2.67e-7, LARGE_STEP),
        ("overturning time", FALLING, 1.1e-4, 5.61e-5, LARGE_STEP),
        ("overturning boundary", PULSES, 7.5e-5, 3.75e-5, APPROACH),
        ("overturning boundary", HARD_PULSES, 2.6e-4, 1.34e-4, APPROACH),
        ("bearing force replayed", DRIVEN, 1e-9, 1.8e-13, ROUNDING),
        ("bearing force replayed", ISOLATED, 1e-9, 3.6e-13, ROUNDING),
        ("bearing impulse in the motion", DRIVEN, 1e-6, 5.32e-7, READING),
        ("bearing impulse in the motion", ISOLATED, 1.45e-6, 7.51e-7, READING),
        ("corner lift at rest", STANDING, 6e-8, 3.09e-8, HELD),
        ("base drift at rest", STANDING_ISOLATED, 4.5e-8, 2.26e-8, LARGE_STEP),
    ),
    ("mujoco", "fixed-step"): (
        ("restitution, rms", RIGID_2, 3e-4, 1.58e-4, STEP),
        ("restitution, rms", SLIDING_2, 7.5e-4, 3.86e-4, STEP),
        ("base velocity jump, rms", SLIDING_2, 8e-5, 4.29e-5, STEP),
    ),
}
# The first-script variants, as bands: rows of (quantity, scenes, least, bound, measured, source)
_BANDS = {
    ("exudyn", "native-contact"): (
        ("restitution from swings, |mean error|", RIGID_2, 0.02, 0.04, 0.0275,
         "the damper pulls at the lifting corner, friction creeps"),
        ("restitution from swings, |mean error|", SLIDING_2, 0.03, 0.07, 0.0451,
         "the damper pulls at the lifting corner, friction creeps"),
    ),
    ("pybullet", "first-script"): (
        ("restitution from swings, |mean error|", RIGID_2, 0.01, 0.025, 0.0151,
         "default damping of 0.04 in flight; independent of the step"),
        ("restitution from swings, |mean error|", SLIDING_2, 0.04, 0.12, 0.0746,
         "default damping in flight and the joint's default motor"),
        ("base velocity jump, rms", SLIDING_2, 0.03, 0.09, 0.0491, "contact spread over several steps"),
    ),
    ("mujoco", "first-script"): (
        ("restitution from swings, |mean error|", RIGID_2, 0.002, 0.006, 0.0039, "soft contact over several steps"),
        ("restitution from swings, |mean error|", SLIDING_2, 0.04, 0.12, 0.0725, "soft contact over several steps"),
        ("base velocity jump, rms", SLIDING_2, 0.012, 0.04, 0.0227, "soft contact over several steps"),
    ),
}


def _table():
    entries = [(*key, quantity, scenes, 0.0, *rest)
               for key, rows in _BOUNDS.items() for quantity, scenes, *rest in rows]
    entries += [(*key, *row) for key, rows in _BANDS.items() for row in rows]
    table = []
    for engine, variant, quantity, scenes, least, bound, measured, source in entries:
        measure, unit = QUANTITIES[quantity]
        table.append(Tolerance(quantity, measure, engine, variant, scenes, bound, unit, measured, source, least,
                               round_off=source == ROUNDING))
    return tuple(table)


TABLE = _table()


def measure_all(rows=TABLE):
    """The table measured here and now: a list of dict, JSON values, in the order of `rows`.

    Each holds the row's columns, `found` (None where a run failed), `holds`, and `failure`, in words or None.
    """
    results, runs = [], {}
    for row in rows:
        found, failure = None, None
        try:
            found = row.found(runs)
        except agreement.Unmeasurable as error:
            failure = str(error)
        results.append({"quantity": row.quantity, "engine": row.engine, "variant": row.variant, "scenes": row.scenes,
                        "least": row.least, "bound": row.bound, "unit": row.unit, "measured": row.measured,
                        "source": row.source, "found": found, "holds": found is not None and row.holds(found),
                        "failure": failure})
    return results
