"""Columns of numbers: several of them, accelerations alone at a step, values one after the other."""

import numpy as np
import pytest
from made_up_records import SMOOTH, VALUES
from record_files import assert_refused, write

from analytic.records import read_record

TIMES = [0.005 * i for i in range(12)]
TITLES = "Time (s){0}x (g){0}y (cm/s2){0}v (cm/s)\n"


def table(by, decimal=".", digits=4):
    rows = zip(TIMES, VALUES, VALUES, TIMES, strict=True)
    text = "".join(f"{t:.3f};{a:.{digits}f};{-b:.{digits}f};{v:.3f}\n" for t, a, b, v in rows)
    return text.replace(".", decimal).replace(";", by)


@pytest.mark.parametrize("by, decimal", [(";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), ("  ", ".")])
@pytest.mark.parametrize("column, factor", [(2, 9.81), (3, -0.01)])
def test_one_of_several_columns_in_the_unit_of_its_own_title(tmp_path, by, decimal, column, factor):
    motion = read_record(write(tmp_path, TITLES.format(by) + table(by, decimal)), column=column)
    np.testing.assert_allclose(motion.samples, np.array(VALUES) * factor, rtol=1e-14)
    assert motion.dt == 0.005 and motion.label.startswith(f"record, column {column}")


@pytest.mark.parametrize("row", ["{a:.4f}", " {a:.4f} ", "{a:.4f}  # remark"])
@pytest.mark.parametrize(
    "header, given",
    [("", 0.02), ("# made up\n", 0.02), ("Acceleration [m/s2]\n", 0.02), ("# n = 12, DT: 20 MSEC\n", None)],
)
def test_one_column_at_the_step_given_or_stated(tmp_path, header, given, row):
    motion = read_record(write(tmp_path, header + "".join(row.format(a=a) + "\n" for a in VALUES)), "m/s2", dt=given)
    assert motion.samples.tolist() == VALUES and motion.dt == 0.02


@pytest.mark.parametrize("per_line", [1, 2, 5, 8, 46, 50])
@pytest.mark.parametrize("by", [" ", "\t", ", "])
def test_values_one_after_the_other(tmp_path, per_line, by):
    """As OpenSees reads them; the last line may be shorter."""
    words = [f"{value:.6f}" for value in SMOOTH]
    text = "".join(by.join(words[i : i + per_line]) + "\n" for i in range(0, len(words), per_line))
    motion = read_record(write(tmp_path, text), "m/s2", dt=0.01)
    assert motion.samples.tolist() == [float(word) for word in words] and motion.dt == 0.01


def test_a_step_of_the_header_goes_before_what_the_times_round(tmp_path):
    text = "# dt = 0.00833333333333333 s\n" + "".join(f"{i / 120:.4f} {a}\n" for i, a in enumerate(VALUES))
    assert read_record(write(tmp_path, text), "g").dt == 0.00833333333333333


STEEP = "".join(f"{a} {-2 * a} {0.5 - a}\n" for a in SMOOTH)  # three channels side by side
COPIES = "".join(f"{a} {a}\n" for a in SMOOTH)
BAD = {
    "several columns": (table(";"), {}, "motion.column: missing; the file holds columns 2 or 3 or 4; add column"),
    "the time": (table(";"), {"column": 1}, "motion.column = 1: is the time; give column, 2 or 3 or 4"),
    "beyond": (table(";"), {"column": 5}, "motion.column = 5: but the file has 4 columns; give column, 2 or 3 or 4"),
    "a velocity": (
        TITLES.format(";") + table(";"),
        {"column": 4, "units": None},
        "line 1, unit = 'cm/s': not an acceleration",
    ),
    "a column less": (table(";") + "0.1;2\n", {"column": 2}, "line 13 = '0.1;2': holds 2 columns, the first line 4"),
    "one column, no step": ("1\n2\n", {}, "motion.dt: missing; the file holds one column of numbers, no times; add dt"),
    "two of one column": (
        "1\n2\n",
        {"dt": 0.1, "column": 2},
        "motion.column = 2: but the file has 1 columns; give column, 1",
    ),
    "channels": (STEEP, {"dt": 0.01}, "motion.column: missing; the 3 numbers a line may be columns of their own"),
    "channels alike": (
        COPIES,
        {"dt": 0.01},
        "motion.column: missing; the 2 numbers a line may be columns of their own",
    ),
    "a number lost": ("3 2 1\n4 5\n2 5 4\n", {"dt": 0.01}, "line 2 = '4 5': holds 2 numbers, the first line 3"),
    "two steps": ("# dt = .02\n0 1\n.01 2\n.02 3\n", {}, "dt = 0.02: but the times have a step of 0.01 s; correct the"),
    "two headers": ("# dt = .02\n# dt = 10 ms\n1\n2\n", {}, "line 2, step = 0.01: but line 1 states a step of 0.02 s"),
    "step of the user": ("0 1\n.01 2\n", {"dt": 0.02}, "motion.dt = 0.02: but the step of the record itself is 0.01 s"),
    "no number": (
        "# dt = fine\n1\n2\n",
        {},
        "line 1, step = '# dt = fine': its sampling interval or rate is no number",
    ),
    "hours": ("# dt = 2 h\n1\n2\n", {}, "line 1, step = '2 h': not a time in s or ms"),
    "negative step": ("1\n2\n", {"dt": -0.1}, "motion.dt = -0.1: not a sampling interval; give a step above 0 s"),
}


@pytest.mark.parametrize("text, said, message", BAD.values(), ids=BAD)
def test_refused(tmp_path, text, said, message):
    assert_refused(write(tmp_path, text), message, **{"units": "m/s2"} | said)


@pytest.mark.parametrize(
    "text, column, values",
    [
        (STEEP, 2, [-2 * value for value in SMOOTH]),
        ("0 2\n0 3\n1 2\n1 4\n", 1, [0, 0, 1, 1]),  # times would rise
    ],
)
def test_channels_side_by_side_are_read_when_one_is_chosen(tmp_path, text, column, values):
    assert read_record(write(tmp_path, text), "m/s2", dt=0.01, column=column).samples.tolist() == values


@pytest.mark.parametrize("samples", [17_000, 22_856, 39_996])
def test_times_of_six_digits_that_are_half_a_unit_off_are_those_of_a_whole_frequency(tmp_path, samples):
    """As LabVIEW writes 800 Hz: 16.03125 s stands there as 16.0312, and one step alone fits them all."""
    text = "Time [s]\tAmplitude\n" + "".join(f"{k / 800:.6g}\t{(-1) ** k * 0.1}\n" for k in range(samples))
    assert read_record(write(tmp_path, text), "g").dt == 1 / 800
