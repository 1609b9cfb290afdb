"""Names shared by the parts of the compiled march: modes, rows of the workspace, slots of the totals."""

from collections import namedtuple

from ..layout import ROWS as SHARED_ROWS

# Modes: both corners in contact, at rest or sliding on the support; pivoting about a corner that is at rest, or slides;
# no contact; fallen.
STICK, SLIDE, ROCK, SLIDE_ROCK, FLIGHT, FALLEN = range(6)
MODES = ("stick", "slide", "rock", "slide-rock", "flight")
# Kinds of event inside a step, after those of the kernel: the friction is used up, the slip stops, the normal force
# vanishes, a corner lands, the other corner becomes the lower one.
CONE, STOP, LOSS, LANDING, LEVEL = range(10, 15)
# Impacts: of the landing corner alone, which sticks or slips; of both, which stick or slip.
NEW_STICKS, NEW_SLIPS, BOTH_STICK, BOTH_SLIP, LANDS = range(5)

# Further rows of the workspace: horizontal velocity of the centre of mass from the base, slip of the corner and its
# rate, gap of the corner and its rate, vertical velocity of the centre of mass, forces of the support on the block.
DRIFT, SLIP, SPEED, GAP, RISE, CLIMB, H, N = range(SHARED_ROWS, SHARED_ROWS + 8)
ROWS = SHARED_ROWS + 8

# What only this march needs of a scene: friction, mass of the base, moment of inertia about the centre of mass, whether
# the restitution is given.
Contact = namedtuple("Contact", "mu mb centre given")
# State of the block: mode, side of the pivot (1 or -1; 0 in full contact), direction of slip (1 or -1; 0 without),
# tilt and its rate, slip of the corner and its rate, gap of the corner and its rate.
Block = namedtuple("Block", "mode s sigma tilt rate slip speed gap rise")
# Tilt rate, horizontal velocity of the centre of mass from the base, its vertical one.
Velocity = namedtuple("Velocity", "rate drift climb")
# What acts at an instant: gravity g + a_v, a_g and the bearings' force.
Start = namedtuple("Start", "gravity ground force")
# Slots of the totals. OVER_TIME: where a later run overturned. HELD: up to the last |tilt| of at most the slenderness.
(
    STATUS, END_MODE, TIME, STEPS, PEAK_TILT, PEAK_X, PEAK_SLIP, PATH, UNSTABLE_TIME, FALL_TIME, FRICTION, NORMAL,
    PEAK_ACCELERATION, INPUT, HYSTERETIC, VISCOUS, FRICTION_WORK, IMPACT_LOSS, IMPACTS, CHANGES, LIFTED, CERTAIN,
    END_TILT, END_RATE, END_SLIP, END_SPEED, END_X, END_V, END_Z, END_GAP, END_RISE, WRITTEN, OVER_TIME,
    HELD_X, HELD_FRICTION, HELD_NORMAL, HELD_ACCELERATION,
) = range(37)  # fmt: skip
TOTALS = 37
# Endings, after those of the kernel: an impact of a given restitution leaves the cone; no mode is admissible, or more
# than one; an impact of a given restitution comes while the block slides, or after a jump.
GIVEN_LEAVES, NO_MODE, GIVEN_SLIDES, GIVEN_JUMPS = range(5, 9)
