"""Record readers: small records written here, and the real ones where they are."""

import numpy as np
import pytest
from record_files import FORMATS, RECORDS, needs_records, write

from analytic.errors import SceneError
from analytic.records import G, read_record

VALUES = [0.001, -0.123, -0.456, 0.25, -1.5, 0.0, 0.75]

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


def fortran(values, width=15):
    """Numbers as Fortran prints them: no leading zero, five a line."""
    printed = [f"{value:.7E}".replace("0.", ".") for value in values]
    return "\n".join("".join(text.rjust(width) for text in printed[i : i + 5]) for i in range(0, len(printed), 5))


@pytest.mark.parametrize("count", COUNTS.values(), ids=COUNTS)
def test_at2_header_variants(tmp_path, count):
    motion = read_record(write(tmp_path, f"{AT2_TOP}{count}\n{fortran(VALUES)}\n", "x.AT2"))
    assert motion.dt == 0.02
    np.testing.assert_allclose(motion.samples, np.array(VALUES) * G, rtol=1e-15)
    assert motion.label == "x.AT2"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r\r\n", "\r"])
def test_line_ends(tmp_path, end):
    text = f"{AT2_TOP}{COUNTS['padded']}\n{fortran(VALUES)}\n".replace("\n", end) + "\x1a"
    np.testing.assert_allclose(read_record(write(tmp_path, text)).samples, np.array(VALUES) * G, rtol=1e-15)


@pytest.mark.parametrize(
    "data",
    [
        "  .1000E-02-.1230E+00-.4560E+00  .2500D+00\n-.1500D+01 .0000D+00 .7500D+00\n",
        "0.1000E-02-.1230E+00-.4560E+00+.2500E+00\n-.1500E+01+.0000E+00+.7500E+00\n",
        "1.000E-003 -1.230E-001 -4.560e-001 2.500d-001 -1.500E+000 0.000E000 7.500D-001\n",
    ],
)
def test_stuck_numbers_and_fortran_exponents(tmp_path, data):
    motion = read_record(write(tmp_path, f"{AT2_TOP}{COUNTS['padded']}\n{data}"))
    np.testing.assert_allclose(motion.samples, np.array(VALUES) * G, rtol=1e-15)


def dyna(values, **changes):
    """A DYNA 1.2 file: 64 header lines, one value a line; a key set to None is left out."""
    keys = {
        "EVENT_NAME": "MADE UP",
        "EVENT_DATE_YYYYMMDD": "20000101",
        "VS30_M/S": "",
        "SAMPLING_INTERVAL_S": "0.010000",
        "NDATA": len(values),
        "UNITS": "cm/s^2",
        "PGA_CM/S^2": "",
        "HEADER_FORMAT": "DYNA 1.2",
        "ORIGINAL_DATA_MEDIATOR_CITATION": ": made up",
    }
    keys |= {f"USER{n}": "" for n in range(1, 65 - len(keys))} | changes
    assert len(keys) == 64
    lines = [f"{key}: {value}" for key, value in keys.items() if value is not None]
    return "\n".join(lines + [f"{value:.6f}" for value in values]) + "\n"


def test_dyna(tmp_path):
    motion = read_record(write(tmp_path, dyna(VALUES)))
    assert motion.dt == 0.01
    np.testing.assert_allclose(motion.samples, np.array(VALUES) * 0.01, rtol=1e-15)


@pytest.mark.parametrize("letter", [*"\u00ddç¿$~%&+*\\?@^`}0.x_-!#", "\u0411", "\u00b5"])
@pytest.mark.parametrize("header", ["# time [s] acceleration [{}m/s2]", "# time, acc ({}m/s^2)", "# {}m/s/s"])
def test_a_damaged_letter_leaves_no_unit_behind_it(tmp_path, letter, header):
    """One damaged byte of "cm/s2" must not make metres of centimetres."""
    for units in (None, "cm/s2"):
        path = write(tmp_path, "\n".join([header.format(letter), *(f"{i / 200} {a}" for i, a in enumerate(VALUES))]))
        if units is None:
            with pytest.raises(SceneError, match="missing; the header names no unit|not an acceleration"):
                read_record(path)
        else:
            np.testing.assert_allclose(read_record(path, units).samples, np.array(VALUES) * 0.01, rtol=1e-15)


@pytest.mark.parametrize(
    "word, known", [("[cm/s2^]", False), ("(cm/s(^2)", False), ("[cm/s^]", False), ("(cm/s^{2})", True)]
)
def test_a_power_without_its_number_and_an_open_bracket_are_no_unit(tmp_path, word, known):
    path = write(
        tmp_path, f"# time [s] acceleration {word}\n" + "".join(f"{i / 200} {a}\n" for i, a in enumerate(VALUES))
    )
    if known:
        np.testing.assert_allclose(read_record(path).samples, np.array(VALUES) * 0.01, rtol=1e-15)
    else:
        with pytest.raises(SceneError, match="missing; the header names no unit|not an acceleration"):
            read_record(path)


def test_a_letter_beyond_ascii_behind_ms_leaves_milliseconds(tmp_path):
    path = write(tmp_path, "time [ms\u0663],acc [g]\n" + "".join(f"{5 * i},{a}\n" for i, a in enumerate(VALUES)))
    assert read_record(path).dt == pytest.approx(0.005, rel=1e-12)


def test_a_damaged_sign_before_the_word_velocity_makes_no_acceleration_of_it(tmp_path):
    path = write(tmp_path, "# dt = 5 ms\u00ecVELOCITY\n" + "\n".join(map(str, VALUES)))
    with pytest.raises(SceneError, match="line 1, step = '5 msivelocity': not a time"):
        read_record(path, "g")


@pytest.mark.parametrize(
    "header",
    [
        *(f"# time acceleration {sign}cm/s2" for sign in ("", "\t", *",;:=([{<'\"|")),
        *("#cm/s2", "! cm/s2", "time,acc_cm/s2", "time,acc-cm/s2"),
    ],
)
def test_a_unit_stands_by_itself_behind_what_parts_words(tmp_path, header):
    text = "\n".join([header, *(f"{i / 200} {a}" for i, a in enumerate(VALUES))])
    np.testing.assert_allclose(read_record(write(tmp_path, text)).samples, np.array(VALUES) * 0.01, rtol=1e-15)


@pytest.mark.parametrize("units, factor", [("m/s2", 1.0), ("cm/s2", 0.01), ("g", G)])
@pytest.mark.parametrize("row", ["{t:8.4f} {a:14.6E}", "{t},{a}", "{t}\t{a}  # remark"])
def test_two_columns(tmp_path, units, factor, row):
    text = "# time acceleration\n" + "\n".join(row.format(t=i / 200, a=a) for i, a in enumerate(VALUES))
    motion = read_record(write(tmp_path, text), units)
    assert motion.dt == pytest.approx(0.005, rel=1e-12)
    np.testing.assert_allclose(motion.samples, np.array(VALUES) * factor, rtol=1e-15)


def test_times_rounded_as_printed_are_uniform(tmp_path):
    text = "\n".join(f"{i / 128:.4f} {i % 3}" for i in range(1000))
    assert read_record(write(tmp_path, text), "g").dt == pytest.approx(1 / 128, rel=1e-4)


def test_scale_and_label(tmp_path):
    motion = read_record(write(tmp_path, "0 1\n0.5 -2\n"), "m/s2", scale=-1.5)
    np.testing.assert_array_equal(motion.samples, [-1.5, 3.0])
    assert motion.label == "record x -1.5"


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
    "dt of zero": (AT2.replace(".02", ".00") + "1 2 3 4", None, "line 4, step = 0.0: not a sampling interval"),
    "unreadable dt": (AT2.replace(".02", "?") + "1 2 3 4", None, "line 4, step = 'NPTS= 4, DT= ? SEC': its sampling"),
    "unreadable count": (AT2.replace("NPTS= 4", "NPTS= many") + "1 2 3 4", None, "NPTS = 'many': not a number of"),
    "velocity": (
        AT2.replace("UNITS OF G", "UNITS OF CM/S") + "1 2 3 4",
        None,
        "line 3, UNITS OF = 'CM/S': not an acceleration in g; give the acceleration file",
    ),
    "AT2 with other units": (
        AT2 + "1 2 3 4",
        "cm/s2",
        "motion.units = 'cm/s2': but the record carries its own unit, G (line 3); remove units, or correct the record",
    ),
    "DYNA with other units": (dyna(VALUES), "g", "motion.units = 'g': but the record carries its own unit, cm/s^2"),
    "DYNA without interval": (dyna(VALUES, SAMPLING_INTERVAL_S=None), None, "SAMPLING_INTERVAL_S: missing"),
    "DYNA without units": (dyna(VALUES, UNITS=""), None, "UNITS: missing from the header"),
    "DYNA velocity": (dyna(VALUES, UNITS="cm/s"), None, "UNITS = 'cm/s': not an acceleration"),
    "DYNA short": (dyna(VALUES, NDATA=9), None, "NDATA = 9: but 7 samples follow"),
    "DYNA NaN": (dyna([*VALUES, float("nan")]), None, "line 72 = 'nan': not finite"),
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
    "unknown format": ("hello\nworld\n", None, "line 1 = 'hello': not a known record format; give PEER AT2"),
}


@pytest.mark.parametrize("text, units, message", BAD.values(), ids=BAD)
def test_bad_record(tmp_path, text, units, message):
    path = write(tmp_path, text)
    with pytest.raises(SceneError) as caught:
        read_record(path, units)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def test_binary_file(tmp_path):
    with pytest.raises(SceneError, match="not a known record format"):
        read_record(write(tmp_path, bytes(range(128, 256))))


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
    assert motion.dt == dt
    assert len(motion.samples) == count
    text = path.read_text(errors="replace")
    if peak:  # the header states the peak itself
        stated = next(float(line.split(":")[1]) for line in text.splitlines() if line.startswith(peak))
        assert motion.peak == pytest.approx(abs(stated) * unit, rel=1e-6)
    last = float(text.split()[-1])
    assert motion.samples[-1] == pytest.approx(last * unit, rel=1e-12)


@needs_records
def test_real_near_fault_record():
    motion = read_record(FORMATS / "RSN1063_NORTHR_RRS228.AT2")
    assert (motion.dt, len(motion.samples), motion.warnings) == (0.01, 1991, ())
    assert motion.peak / G == pytest.approx(0.8741, abs=5e-5)
    assert motion.peak_time == pytest.approx(2.560, abs=1e-9)


@needs_records
def test_a_real_file_that_is_no_record():
    with pytest.raises(SceneError, match="not a known record format"):
        read_record(FORMATS / "README.md", "g")
