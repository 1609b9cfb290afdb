"""CSMIP volume 2: files of three channels made up here, and the real ones where they are."""

import numpy as np
import pytest
from mutated_files import VALUES, csmip
from record_files import FORMATS, needs_records, write

from analytic.errors import SceneError
from analytic.records import read_record


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("channel, times", [(1, 1), ("2", 2), ("up", 2), ("90 deg", 1), (" H1 ", 3)])
def test_a_channel_is_chosen_by_number_or_direction(tmp_path, channel, times, end):
    motion = read_record(write(tmp_path, csmip(VALUES).replace("\n", end)), channel=channel)
    assert motion.dt == 0.005 and not motion.warnings
    np.testing.assert_allclose(motion.samples, np.array(VALUES) * times, rtol=1e-15)
    assert motion.label == f"record, channel {times} ({['90 Deg', 'Up', 'H1'][times - 1]})"


def test_numbers_that_touch_are_cut_by_position(tmp_path):
    values = [12.3456, 2.0, -1.5, 4.25] * 3  # 1234.56000 fills its ten columns
    motion = read_record(write(tmp_path, csmip(values)), channel=1)
    np.testing.assert_allclose(motion.samples, values, rtol=1e-15)


def test_the_step_that_the_line_before_the_data_rounds_is_read_from_the_reals(tmp_path):
    text = csmip(VALUES, step=".0025").replace("spaced at .0025", "spaced at .003")
    assert read_record(write(tmp_path, text), channel=1).dt == 0.0025


def test_a_peak_that_is_not_the_data_s_is_said(tmp_path):
    text = csmip(VALUES).replace("Peak acceleration =  -150.000", "Peak acceleration =  -152.000")
    assert "states a peak of -152 cm/s2, the data have 150" in read_record(write(tmp_path, text), channel=1).warnings[0]
    assert not read_record(write(tmp_path, text), channel=2).warnings


BAD = {
    "no channel": ({}, "", "", "motion.channel: missing; the file holds channels 1 (90 Deg) or 2 (Up) or 3 (H1)"),
    "no such channel": ({"channel": 4}, "", "", "motion.channel = 4: not a channel of the file; choose one of 1 (90"),
    "two of a name": ({"channel": "up"}, "1: 90 Deg", "1: Up", "motion.channel = 'up': names several channels"),
    "other units": ({"channel": 1, "units": "g"}, "", "", "but the record carries its own unit, cm/sec2 (line 46)"),
    "velocities alone": ({"channel": 1}, "points of accel data", "points of other data", "no line N points of accel"),
    "too many": ({"channel": 1}, " 12 points of accel", " 20 points of accel", "not 8 numbers of 10 characters"),
    "too few": ({"channel": 1}, " 12 points of accel", " 8 points of accel", "= 8: more numbers follow than these"),
    "a digit lost": (
        {"channel": 1},
        "-45.60000",
        "-4.60000",
        "not 8 numbers of 10 characters; 12 samples are stated; the file is cut",
    ),
    "a digit moved": ({"channel": 1}, " -45.60000", " -45.6000 ", "line 47 = '-45.6000 ': not a number"),
    "another digit behind": ({"channel": 1}, " -45.60000", "  -45.6000", "not printed as the other numbers are"),
    "stars": ({"channel": 1}, " -45.60000", "**********", "= '**********': not a number"),
    "cut": ({"channel": 1}, "/&  ----------  End of data for channel  3", "/ 3", "channel 3 has no last line /&"),
    "two steps": ({"channel": 1}, "spaced at .005", "spaced at .010", "line 40, step = 0.005: but line 46 says 0.01 s"),
    "no step": ({"channel": 1}, "spaced at .005", "spaced at .000", "line 46, step = 0.0: not a sampling interval"),
}


@pytest.mark.parametrize("said, old, new, message", BAD.values(), ids=BAD)
def test_refused(tmp_path, said, old, new, message):
    path = write(tmp_path, csmip(VALUES).replace(old, new) if old else csmip(VALUES))
    with pytest.raises(SceneError) as caught:
        read_record(path, **said)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def test_a_file_of_one_channel_has_none_to_choose(tmp_path):
    with pytest.raises(SceneError, match="motion.channel = 1: but the file has no several channels; remove channel"):
        read_record(write(tmp_path, "0 1\n.01 2\n"), "g", channel=1)


@needs_records
@pytest.mark.parametrize(
    "name, dt, counts, directions",
    [
        ("ferndale.v2", 0.01, (10100, 10100, 10100), ("180 Deg", "90 Deg", "Up")),
        ("ce36456p_CE36456.V2", 0.02, (3251, 3250, 3250), ("90 DEG", "UP", "0 DEG")),
        ("CE89146.V2", 0.005, (12000, 12000, 12000), ("360 Deg", "Up", "90 Deg")),
        ("CE58667.V2", 0.01, (7500, 7500, 7500), ("H1", "Up", "H2")),
    ],
)
def test_real_files(name, dt, counts, directions):
    """Against the peak and its time, which each channel's header states."""
    lines = (FORMATS / name).read_text().splitlines()
    stated = [line.split() for line in lines if line.lower().startswith("peak acceleration")]
    for channel, (count, direction) in enumerate(zip(counts, directions, strict=True), 1):
        motion = read_record(FORMATS / name, channel=direction)
        assert (motion.dt, len(motion.samples), motion.warnings) == (dt, count, ())
        assert f"channel {channel} ({direction})" in motion.label
        at = int(np.abs(motion.samples).argmax())
        assert motion.samples[at] == pytest.approx(float(stated[channel - 1][3]) / 100, abs=5.01e-6)
        assert at * dt == pytest.approx(float(stated[channel - 1][6]), abs=1e-9)
