"""Record readers: small records written here, and the real ones where they are."""

import numpy as np
import pytest
from made_up_records import SMOOTH, VALUES, dyna
from record_files import FORMATS, RECORDS, assert_refused, needs_records, write

from analytic.records import G, read_record

SAMPLES = [0.001, -0.123, -0.456, 0.25, -1.5, 0.0, 0.75]

AT2_TOP = "PEER STRONG MOTION DATABASE\nMADE UP, 01/01/00, NOWHERE, 000\nACCELERATION TIME HISTORY IN UNITS OF G\n"
COUNTS = {
    "padded": "NPTS=  7, DT= .02000 SEC",
    "filter text": "NPTS=   7, DT=   .0200 SEC,   5 POLE @    50.00000 HZ,  -5 POLE @      .08000",
    "no blanks": "NPTS=7,DT=.02",
    "no comma": "NPTS= 7 DT= 0.02 SEC",
    "exponent": "NPTS= 7, DT= 2.0E-02 SEC",
    "old": "     7    .02000  NPTS, DT",
    "old with commas": " 7, 0.0200, NPTS, DT(SEC)",
}


DATA = (  # stuck numbers, exponents of Fortran
    "  .1000E-02-.1230E+00-.4560E+00  .2500D+00\n-.1500D+01 .0000D+00 .7500D+00\n",
    "0.1000E-02-.1230E+00-.4560E+00+.2500E+00\n-.1500E+01+.0000E+00+.7500E+00\n",
    "1.000E-003 -1.230E-001 -4.560e-001 2.500d-001 -1.500E+000 0.000E000 7.500D-001\n",
)
AT2_FILES = {
    **{name: f"{AT2_TOP}{count}\n{DATA[0]}" for name, count in COUNTS.items()},
    **{f"data {at}": f"{AT2_TOP}{COUNTS['padded']}\n{data}" for at, data in enumerate(DATA)},
    **{repr(end): f"{AT2_TOP}{COUNTS['padded']}\n{DATA[0]}\x1a".replace("\n", end) for end in ("\r\n", "\r\r\n", "\r")},
    "UTF-16": f"{AT2_TOP}{COUNTS['padded']}\n{DATA[0]}".encode("utf-16"),
}


@pytest.mark.parametrize(
    "text, factor, dt",
    [*((text, G, 0.02) for text in AT2_FILES.values()), (dyna(SAMPLES), 1.0, 0.005)],
    ids=[*AT2_FILES, "DYNA"],
)
def test_at2_and_dyna(tmp_path, text, factor, dt):
    motion = read_record(write(tmp_path, text, "x.AT2"))
    np.testing.assert_allclose(motion.samples, np.array(SAMPLES) * factor, rtol=1e-15)
    assert motion.dt == dt and motion.label == "x.AT2"


ROWS = "".join(f"\n{i / 200} {a}" for i, a in enumerate(SAMPLES))
LETTERS = [*"\u00ddç¿$~%&+*\\?@^`}.x_-!#", "\u0411", "\u00b5"]
DAMAGED = [f"# time [s] acceleration [{letter}m/s2]" for letter in [*LETTERS, "0", "."]]
DAMAGED += [f"# time, acc ({letter}m/s^2)" for letter in [*LETTERS, "0", "."]] + [
    f"# {letter}m/s/s" for letter in LETTERS
]


@pytest.mark.parametrize("header", ["# 0m/s/s", "# Vs30 = 360 m/s", "# g = 9.81m/s2", "# peak 1.2 m/s/s"])
def test_what_stands_behind_a_number_is_no_unit_of_the_record(tmp_path, header):
    path = write(tmp_path, header + ROWS)
    assert_refused(path, "missing; the header names no unit")
    np.testing.assert_allclose(read_record(path, "cm/s2").samples, np.array(SAMPLES) * 0.01, rtol=1e-15)


def test_a_letter_beyond_ascii_behind_ms_leaves_milliseconds(tmp_path):
    path = write(tmp_path, "time [ms\u0663],acc [g]\n" + "".join(f"{5 * i},{a}\n" for i, a in enumerate(SAMPLES)))
    assert read_record(path).dt == pytest.approx(0.005, rel=1e-12)


IN_CENTIMETRES = (
    "время(с) ускорение(см/с²)|# ускорение (см/с^2)|# Единицы: см/с/с|# единицы измерения: гал|t, с; a, СМ/С²"
    "|# 加速度（ガル）|# 単位：ガル|時間(s) 加速度(ガル)|時間(秒) 加速度(伽)|时间(s) 加速度(厘米/秒²)"
    "|# 单位: 伽|# a, ㎝/s²|# Unità: gal|# Unidade: gal"
)


UNITS = {header: 0.01 for header in IN_CENTIMETRES.split("|")}
UNITS |= {f"# time acceleration {sign}cm/s2": 0.01 for sign in ("", "\t", *",;:=([{<'\"|")}
UNITS |= {f"time,acc{sign}cm/s2": 0.01 for sign in "_-"}
UNITS |= {header: 0.01 for header in ("#cm/s2", "! cm/s2", "# time [s] acceleration (cm/s^{2})")}
UNITS |= {f"# time [s] acceleration [{inch}]": 0.0254 for inch in ("inch/s2", "in/s^2", "inches/sec/sec", "in/sec2")}


@pytest.mark.parametrize("header, factor", UNITS.items())
def test_a_unit_that_stands_by_itself_is_read_in_any_script_and_not_overruled(tmp_path, header, factor):
    path = write(tmp_path, header + ROWS)
    np.testing.assert_allclose(read_record(path).samples, np.array(SAMPLES) * factor, rtol=1e-15)
    assert_refused(path, "but the record carries its own unit", units="g")


REMEDY = "; write one of m/s2, cm/s2, g, gal, mm/s2, %g in its place"
ASKED = [
    ("χρόνος επιτάχυνση(εκ/δ²)", "εκ/δ²", REMEDY),
    ("# επιτάχυνση, εκ/δ/δ", "εκ/δ/δ", REMEDY),
    ("# μονάδες: εκ", "εκ", REMEDY),
    ("# Unit: 重力加速度", "重力加速度", REMEDY),
    ("時間(s) 加速度(重力)", "重力", REMEDY),
    ("# تسارع (سم/ث²)", "سم/ث²", REMEDY),
    ("# ความเร่ง (ซม/วินาที²)", "ซม/วินาที²", REMEDY),
    ("время ускорение(ж)", "ж", REMEDY),
    ("время(с) скорость(см/с)", "unit = 'cm/s': not an acceleration", ""),
    *((f"# time [s] acceleration {word}", "not an acceleration", "") for word in ("[cm/s2^]", "(cm/s(^2)", "[cm/s^]")),
    *((header, "line 1, ", "" if "time" in header else "not an acceleration") for header in DAMAGED),
]


@pytest.mark.parametrize("header, word, more", ASKED)
def test_a_damaged_or_unknown_unit_is_asked_about_whatever_the_user_gives(tmp_path, header, word, more):
    """One damaged byte of "cm/s2" must not make metres of centimetres."""
    path = write(tmp_path, header + ROWS)
    for units in (None, "cm/s2", "g"):
        assert_refused(path, word, units=units)
        assert_refused(path, more, units=units)


def test_a_column_is_named_as_the_file_writes_it(tmp_path):
    path = write(tmp_path, "時間(s) 加速度（ガル） 東西（伽）" + ROWS.replace("\n", " 1\n")[2:] + " 1")
    for column, number in (("加速度（ガル）", "2"), ("加速度", "2"), ("東西(伽)", "3")):
        assert read_record(path, column=column).label.startswith(f"record, column {number}")


@pytest.mark.parametrize("header", ["時間(s) 加速度(東西)", "t a(С-Ю)", "t a(90º)"])
def test_a_direction_in_another_script_is_no_unit(tmp_path, header):
    assert read_record(write(tmp_path, header + ROWS), "g").peak == pytest.approx(1.5 * G)


@pytest.mark.parametrize("units, factor", [("m/s2", 1.0), ("cm/s2", 0.01), ("g", G)])
@pytest.mark.parametrize("row", ["{t:8.4f} {a:14.6E}", "{t},{a}", "{t}\t{a}  # remark"])
def test_two_columns(tmp_path, units, factor, row):
    text = "# time acceleration\n" + "\n".join(row.format(t=i / 200, a=a) for i, a in enumerate(SAMPLES))
    motion = read_record(write(tmp_path, text), units)
    assert motion.dt == pytest.approx(0.005, rel=1e-12)
    np.testing.assert_allclose(motion.samples, np.array(SAMPLES) * factor, rtol=1e-15)


AT2 = AT2_TOP + "NPTS= 4, DT= .02 SEC\n"
BAD = {
    "empty": ("", None, "record: is empty; give a record with at least two accelerations"),
    "blank": (" \r\n\n", None, "record: is empty"),
    "no samples": (AT2.replace("4", "0"), None, "record: holds 0 samples; give at least two"),
    "one sample": ("0 1\n", "g", "record: holds 1 samples"),
    "short": (AT2 + "1 2 3\n", None, "line 4, NPTS = 4: but 3 samples follow; the file is cut or damaged"),
    "long": (AT2 + "1 2 3\n4 5", None, "line 4, NPTS = 4: but 5 samples follow"),
    "old header with a second step": (AT2_TOP + "4 .005 NPTS, DT= .01\n1 2 3 4\n", None, "'4 .005 NPTS': not a number"),
    "old header, number stuck to a word": (AT2_TOP + "4 .005NPTS, DT\n1 2 3 4\n", None, "'4 .005NPTS': not a number"),
    "NaN in AT2": (AT2 + "1 2\n3 NaN\n", None, "line 6 = 'NaN': not finite; mend or remove it"),
    "infinite in AT2": (AT2 + "1 2\n3 -Inf\n", None, "line 6 = '-Inf': not finite"),
    "stars": (AT2 + "1 2 3 *******\n", None, "line 5 = '*******': not a number"),
    "dt of zero": (AT2.replace(".02", ".00") + "1 2 3 4", None, "line 4, step = 0.0: not a sampling interval or rate"),
    "unreadable dt": (AT2.replace(".02", "?") + "1 2 3 4", None, "line 4, step = 'NPTS= 4, DT= ? SEC': its sampling"),
    "unreadable count": (AT2.replace("NPTS= 4", "NPTS= many") + "1 2 3 4", None, "NPTS = 'many': not a number of"),
    "velocity": (
        AT2.replace("UNITS OF G", "UNITS OF CM/S") + "1 2 3 4",
        None,
        "line 3, unit = 'CM/S': not an acceleration in a unit that is known; write one of",
    ),
    "AT2 with other units": (
        AT2 + "1 2 3 4",
        "cm/s2",
        "motion.units = 'cm/s2': but the record carries its own unit, G (line 3); remove units, or correct the record",
    ),
    "DYNA with other units": (dyna(SAMPLES), "g", "motion.units = 'g': but the record carries its own unit, cm/s^2"),
    "DYNA without interval": (
        dyna(SAMPLES).replace("SAMPLING_INTERVAL_S: 0.005000\n", ""),
        None,
        "SAMPLING_INTERVAL_S: missing",
    ),
    "DYNA without units": (dyna(SAMPLES).replace("cm/s^2", ""), None, "UNITS: missing from the header"),
    "DYNA velocity": (dyna(SAMPLES).replace("cm/s^2", "cm/s"), None, "UNITS = 'cm/s': not an acceleration"),
    "DYNA spectrum": (
        dyna(SAMPLES).replace("TYPE: ACCELERATION", "TYPE: ACCELERATION RESPONSE SPECTRUM"),
        None,
        "DATA_TYPE = 'ACCELERATION RESPONSE SPECTRUM': not an acceleration",
    ),
    "DYNA short": (dyna(SAMPLES).replace("NDATA: 7", "NDATA: 9"), None, "NDATA = 9: but 7 samples follow"),
    "DYNA NaN": (dyna([*SAMPLES, float("nan")]), None, "line 19 = 'nan': not finite"),
    "a damaged sign before a word": (
        "# dt = 5 ms\u00ecVELOCITY\n" + "\n".join(map(str, SAMPLES)),
        "g",
        "line 1, step = '5 msivelocity': not a time",
    ),
    "no units": ("0 1\n0.01 2\n", None, "motion.units: missing; columns of numbers carry no unit; add units, one of"),
    "bad units": ("0 1\n0.01 2\n", "inch/s2", "motion.units = 'inch/s2': not a known unit; choose one of m/s2, cm/s2"),
    "NaN in columns": ("0 1\n.01 nan\n", "g", "line 2 = 'nan': not finite"),
    "infinite in columns": ("0 1\n.01 inf\n", "g", "line 2 = 'inf': not finite"),
    "words in columns": ("0 1\n.01 abc\n", "g", "line 2 = 'abc': not a number"),
    "gap": (
        "0 1\n.01 2\n.02 3\n.04 4\n.05 1\n",
        "g",
        "sample 4, time = 0.04: the sampling is not uniform: this step is 0.02 s, most are 0.01 s; resample",
    ),
    "slow drift": ("\n".join(f"{0.01 * i + 1e-5 * i * i:.6f} 1" for i in range(50)), "g", "sampling is not uniform"),
    "small jitter": ("0 1\n.0100 2\n.0200 3\n.0304 4\n.0400 5\n.0500 5\n", "g", "sampling is not uniform"),
    "time going back": ("0 1\n-0.01 2\n-0.02 3\n", "g", "sampling is not uniform"),
    "time standing still": ("0 1\n0 2\n0 3\n", "g", "sampling is not uniform"),
    "minutes": ("time [min],a [g]\n0.0,1.0\n1.0,2.0\n", None, "not a time in s or ms; write the times in seconds"),
    "two units of time": ("# time [s]\ntime [ms],a [g]\n0.0,1.0\n1.0,2.0\n", None, "line 2: times in s and in ms"),
    "step of days": (AT2.replace(".02", "86400.") + "1 2 3 4", None, "not a sampling interval of a ground motion"),
    "binary": (bytes(range(128, 256)), None, "not a known record format"),
    "unknown format": ("hello\nworld\n", None, "line 1 = 'hello': not a known record format; give PEER AT2"),
}


@pytest.mark.parametrize("text, units, message", BAD.values(), ids=BAD)
def test_bad_record(tmp_path, text, units, message):
    assert_refused(write(tmp_path, text), message, units=units)


@needs_records
@pytest.mark.parametrize(
    "name, units, dt, count, peak, unit",
    [
        ("RSN1605_DUZCE_DZC270.AT2", None, 0.005, 5177, None, G),
        ("RSN1605_DUZCE_DZC180.AT2", None, 0.005, 5177, None, G),
        ("ARL360.at2", None, 0.02, 2000, None, G),
        ("IELC180.AT2", None, 0.01, 4000, None, G),
        ("19991112165722_1401_mp_RawAcc_E.asc", None, 0.01, 5590, "PGA_CM/S^2", 0.01),
        ("HL.DLFA..HNE.D.20190728.160908.C.ACC.ASC", None, 0.005, 13876, "PGA_CM/S^2", 0.01),
        ("CHV1-20140203E.txt", "cm/s2", 0.005, 13549, None, 0.01),
    ],
)
def test_real_records(name, units, dt, count, peak, unit):
    path = RECORDS / name
    motion = read_record(path, units)
    assert (motion.dt, len(motion.samples)) == (dt, count)
    text = path.read_text(errors="replace")
    if peak:  # the header states the peak itself
        stated = next(float(line.split(":")[1]) for line in text.splitlines() if line.startswith(peak))
        assert motion.peak == pytest.approx(abs(stated) * unit, rel=1e-6)
    last = float(text.split()[-1])
    assert motion.samples[-1] == pytest.approx(last * unit, rel=1e-12)


@needs_records
def test_a_real_file_that_is_no_record():
    assert_refused(FORMATS / "README.md", "not a known record format", units="g")


# Columns of numbers: several of them, accelerations alone at a step, values one after the other.
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
BAD_COLUMNS = {
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


@pytest.mark.parametrize("text, said, message", BAD_COLUMNS.values(), ids=BAD_COLUMNS)
def test_columns_refused(tmp_path, text, said, message):
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
