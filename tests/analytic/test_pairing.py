"""Two components of a record brought to one step and length."""

import numpy as np
import pytest

from analytic import SampledMotion
from analytic.pairing import paired


def test_equal_steps_and_lengths_are_taken_as_they_are():
    level, up = SampledMotion(0.1, [1.0, 2.0, 0.0], "H", ("odd",)), SampledMotion(0.1, [3.0, 4.0, 5.0], "V", ("odder",))
    motion = paired(level, up)
    assert (motion.samples.tolist(), motion.vertical.samples.tolist()) == ([1, 2, 0], [3, 4, 5])
    assert (motion.label, motion.warnings) == ("H, vertical V", ("odd", "odder"))
    assert motion.vertical.warnings == () and motion.vertical.vertical is None


def test_the_shorter_one_is_padded_and_that_is_said():
    short, long = SampledMotion(0.1, [1.0, 2.0], "short"), SampledMotion(0.1, [1.0, 2.0, 3.0, 4.0], "long")
    for level, up in ((short, long), (long, short)):
        motion = paired(level, up)
        shorter = motion.samples if level is short else motion.vertical.samples
        assert shorter.tolist() == [1, 2, 0, 0] and len(motion.samples) == 4
        assert motion.warnings == ("short: 0.2 s of zeros put at its end, as the other component is longer",)


@pytest.mark.parametrize("coarse, fine", [(0.02, 0.01), (0.01, 0.004), (1 / 3, 0.1)])
def test_the_coarser_one_is_resampled_to_the_finer_step_and_that_is_said(coarse, fine):
    rng = np.random.default_rng(1)
    level = SampledMotion(coarse, rng.normal(size=11), "level")
    up = SampledMotion(fine, rng.normal(size=round(10 * coarse / fine) + 1), "up")
    for motion in (paired(level, up), paired(up, level)):
        found = motion if motion.label.startswith("level") else motion.vertical
        times = np.arange(0, level.end * (1 - 1e-9), fine)
        assert motion.dt == motion.vertical.dt == fine
        assert found.samples[: len(times)] == pytest.approx(level.acceleration(times), rel=1e-12, abs=1e-12)
        assert motion.warnings[0].startswith(f"level: resampled from {coarse:.6g} s to the {fine:.6g} s of the other")


def test_the_last_sample_of_a_resampled_motion_is_kept():
    level, up = SampledMotion(0.3, [1.0, 2.0, 4.0]), SampledMotion(0.1, np.zeros(7))
    assert paired(level, up).samples.tolist() == pytest.approx([1, 4 / 3, 5 / 3, 2, 8 / 3, 10 / 3, 4])


def test_steps_printed_to_other_digits_are_one_step():
    motion = paired(SampledMotion(0.005, [1.0, 2.0]), SampledMotion(0.005 * (1 + 1e-12), [1.0, 2.0]))
    assert motion.dt == 0.005 and not motion.warnings
