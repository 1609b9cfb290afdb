"""Names shared by the parts of the compiled kernel: modes, endings, slots of the totals, rows of the workspace."""

from collections import namedtuple

# Modes of the block.
CONTACT, ROCKING, OVERTURNED = range(3)
# How a run ended.
COMPLETE, DECIDED, STUCK, NOT_FINITE, SPENT = range(5)
# Slots of the totals a run returns.
(
    STATUS,
    MODE,
    TIME,
    PEAK_TILT,
    PEAK_X,
    PEAK_ACCELERATION,
    UNSTABLE_TIME,
    FRICTION,
    NORMAL,
    INPUT,
    HYSTERETIC,
    VISCOUS,
    IMPACT_LOSS,
    STEPS,
    IMPACTS,
    UPLIFTS,
    RESTS,
    WILL_OVERTURN,
    LIFTED,
    CERTAIN,
    FALL_TIME,
) = range(21)
TOTALS = 21
# Rows of the workspace: Taylor coefficients of tilt, rate, sin and cos, base displacement and velocity, bearing memory,
# bearing force, absolute base acceleration, ground acceleration, gravity (used under vertical motion); then scratch.
(PHI, W, S, C, X, V, Q, F, ABSOLUTE, GROUND, GRAVITY, EVENT, PRODUCT_A, PRODUCT_B) = range(14)
ROWS = 14
# Kinds of event inside a step.
NONE, UPLIFT, IMPACT, REVERSAL, CORNER, PASSAGE, OVERTURNING = range(7)

# Ground motion: sampled (dt, samples) or a pulse; `kind` is QUIET, LINEAR_GROUND (sampled), HARMONIC
# (scale sin(phase + frequency (t - start))) or RICKER. A rectangular pulse is HARMONIC with frequency 0.
# `vertical` is None or a `Vertical`, of the same kind, times and frequency. As the two have types of their own the
# kernel is compiled for each: what asks whether `vertical is None` is decided then.
Ground = namedtuple("Ground", "kind dt samples scale frequency phase start end vertical")
Vertical = namedtuple("Vertical", "samples scale phase")
# What to do: `record` keeps events (up to `capacity` of a kind), ledger and diagnostics; `decide` stops when
# the outcome is certain and the peaks are final (decision.py), but not before the time `shortest`; without it that ends
# a base in full contact alone. `most_steps` ends a run that does not get on (SPENT).
Options = namedtuple("Options", "tolerance order rest_rate record decide output_step capacity shortest most_steps")
