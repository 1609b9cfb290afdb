"""When is the outcome of a run decided? (The rule is written here; the kernel and the engines' runs both end by it.)"""

import math

# A run without a duration goes on for at least these after the motion's end, and at most CAP_PERIODS.
TAIL_PERIODS, CAP_PERIODS = 3.0, 200.0


def shortest_duration(scene):
    """End of the motion and some rocking periods after it [s]."""
    end = scene.motion.end if scene.motion is not None else 0.0
    return end + TAIL_PERIODS * 2 * math.pi / scene.rocking_frequency
