"""Names shared by the parts of the compiled kernel: modes, endings, totals, rows of the workspace."""

from collections import namedtuple

# Modes of the block: both corners in contact, at rest or sliding on the support; pivoting about a corner that is at
# rest, or slides; no contact; fallen; off its pedestal. Without a friction it sticks, rocks or has fallen.
STICK, SLIDE, ROCK, SLIDE_ROCK, FLIGHT, FALLEN, OFF = range(7)
MODES = ("stick", "slide", "rock", "slide-rock", "flight")
# How a run ended; of a block that may slide also: an impact of a given restitution leaves the cone; no mode is
# admissible, or more than one; an impact of a given restitution comes while the block slides, or after a jump.
COMPLETE, DECIDED, STUCK, NOT_FINITE, SPENT, GIVEN_LEAVES, NO_MODE, GIVEN_SLIDES, GIVEN_JUMPS = range(9)
# Slots of the totals that a run returns. OVER_TIME: where a later run overturned.
(
    STATUS, MODE, TIME, PEAK_TILT, PEAK_X, PEAK_ACCELERATION, UNSTABLE_TIME, FRICTION, NORMAL, INPUT, HYSTERETIC,
    VISCOUS, IMPACT_LOSS, STEPS, IMPACTS, UPLIFTS, RESTS, WILL_OVERTURN, LIFTED, CERTAIN, FALL_TIME, OVER_TIME,
    END_TILT, END_RATE, END_X, END_V, END_Z, WRITTEN, PATH, PEAK_SLIP, FRICTION_WORK, CHANGES, END_SLIP, END_SPEED,
    END_GAP, END_RISE,
) = range(36)  # fmt: skip
TOTALS = 36
# Rows of the workspace: Taylor coefficients of tilt, rate, sin and cos, base displacement and velocity, bearing memory,
# bearing force, absolute base acceleration, ground acceleration, gravity (used under vertical motion); then scratch.
(PHI, W, S, C, X, V, Q, F, ABSOLUTE, GROUND, GRAVITY, EVENT, PRODUCT_A, PRODUCT_B) = range(14)
# Of a block that may slide: horizontal velocity of the centre of mass from the base, slip of the corner and its rate,
# gap of the corner and its rate, vertical velocity of the centre of mass, forces of the support on the block.
DRIFT, SLIP, SPEED, GAP, RISE, CLIMB, H, N = range(14, 22)
ROWS = 22
# Kinds of event inside a step; of a block that may slide also: the friction is exhausted, the slip stops, the normal
# force vanishes, a corner lands, the other corner becomes the lower one, the block passes its pedestal's edge.
NONE, UPLIFT, IMPACT, REVERSAL, CORNER, PASSAGE, OVERTURNING, CONE, STOP, LOSS, LANDING, LEVEL, EDGE = range(13)
# Impacts: of the landing corner alone, which sticks or slips; of both, which stick or slip.
NEW_STICKS, NEW_SLIPS, BOTH_STICK, BOTH_SLIP, LANDS = range(5)

# The scene as numbers only, so that it fits a row of an array; `on_base` is 0 or 1. See RockingModel and BearingLaw for
# their meaning; slope is tan(gamma), arm the velocity that a
# base gains per tilt rate lost, eq. (8), law the number of the bearings' law, constants its `laws.Constants`.
Parameters = namedtuple(
    "Parameters", "m M J R gamma slope g p2 e arm on_base law count kb damping tilt rate x v z duration constants"
)
# The ground motion: `kind` is QUIET, LINEAR_GROUND (samples at intervals of dt), or from PULSE on that of a pulse,
# scale f(phase + frequency (t - start)); with frequency 0 it is constant. The vertical motion is of the same kind,
# times and frequency: a pulse, or samples of its own.
Ground = namedtuple("Ground", "kind dt samples upright shaking")
Shaking = namedtuple("Shaking", "scale frequency phase start end upright_scale upright_phase")
# Options: `record` keeps events (up to `capacity` of a kind), ledger and diagnostics; `decide` stops when
# the outcome is certain and the peaks are final (decision.py), but not before the time `shortest`; without `decide`,
# `shortest` applies only to a base in full contact. `most_steps` limits the steps of a run (SPENT).
Options = namedtuple("Options", "tolerance order rest_rate record decide output_step capacity shortest most_steps")
# Workspace of a run: Taylor coefficients and scratch, events, history and totals.
Arrays = namedtuple("Arrays", "P work impacts uplifts rests history totals")

# The same of a block that may slide; changes : (time, mode).
Marched = namedtuple("Marched", "P work impacts changes history totals")

# Parameters for event location, passed in every step.
Shape = namedtuple("Shape", "gamma slope on_base")
# The block: side of the pivot (1 or -1; 0 in full contact), tilt and its rate.
Body = namedtuple("Body", "s tilt rate")
# Displacement and velocity of the base, hysteretic force of a bearing.
Base = namedtuple("Base", "x v z")
# Of the bearings: direction of travel, displacement and mark (`laws.Law`) at the last reversal, power of the travel.
Branch = namedtuple("Branch", "direction x_c mark power")
# Ground motion without a corner, up to `end`: a_g is a0 + slope t, or a pulse of scale a0; a_v with lift and rise.
Stretch = namedtuple("Stretch", "kind a0 slope lift rise end order")
# A step from t: its length, order of its series and of the ground's (-1 without), gravity g + a_v at its start, factors
# of the bearing's series and the hysteretic force at which the bearing's stiffness next jumps.
Step = namedtuple("Step", "t h order highest gravity factors corner")

# What only a scene with a friction needs: friction, mass of the base, moment of inertia about the centre of mass,
# whether the restitution is given, half width of the pedestal (inf without one).
Contact = namedtuple("Contact", "mu mb centre given edge")
# State of a block that may slide: mode, side of the pivot (1 or -1; 0 in full contact), direction of slip (1 or -1; 0
# without), tilt and its rate, slip of the corner and its rate, gap of the corner and its rate.
Block = namedtuple("Block", "mode s sigma tilt rate slip speed gap rise")
# Tilt rate, horizontal velocity of the centre of mass from the base, its vertical one.
Velocity = namedtuple("Velocity", "rate drift climb")
# What acts at an instant: gravity g + a_v, a_g and the bearings' force.
Start = namedtuple("Start", "gravity ground force")
