"""Columns of the study's tables and axes."""

from ...showing.parts import Column, Row, short

FLOOR = 1e-9  # errors below are drawn here

ERROR = Column("error of restitution by swings, rms [-]", "rms")
DRAWN_ERROR = Column(ERROR.head, lambda row: row["rms"] and max(row["rms"], FLOOR))
MEAN, WORST = Column("mean error by swings [-]", "bias"), Column("worst impact by swings [-]", "worst")
JUMP = Column("base velocity jump, relative error, rms [-]", "jump_rms")
STATE = Column("error of restitution by states, rms [-]", "rms_state")
WORST_STATE = Column("worst impact by states [-]", "worst_state")
WORST_JUMP = Column("worst base velocity jump [-]", "jump_worst")
LATE = Column("impact times, relative, rms [-]", "time_rms")
LOST = Column("missed impacts [-]", "lost")
CPU = Column("CPU time per simulated second [s/s]", "cpu_per_second")
FAILED = Column("failed runs [-]", "{failed} of {runs}")
GROUND = Column("ground", "ground")
GAMMA = Column("slenderness γ [rad]", "slenderness", digits=None)
BASE_RATIO, PERIOD = Column("base mass over block mass [-]", "ratio"), Column("isolation period [s]", "period")
BASE = Column("base mass over block mass [-]", lambda row: "rigid" if row["ratio"] is None else short(row["ratio"]))


def ground(row: Row) -> str:
    """What the block of a row stands on."""
    return "rigid ground" if row["ratio"] is None else "sliding base"
