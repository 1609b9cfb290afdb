"""A ground motion as the text of a file that `read_record` reads back bit for bit."""

from ..motion import SampledMotion


def two_columns(motion: SampledMotion) -> str:
    """Time [s] and acceleration [m/s2], one sample a line, under a line that states the units and the step.

    The step stands in the header because a column of times has too few digits for one such as 1/120 s.
    """
    rows = (f"{index * motion.dt:.12g} {value!r}\n" for index, value in enumerate(motion.samples.tolist()))
    return f"# time [s], acceleration [m/s2], dt = {motion.dt!r} s\n" + "".join(rows)
