"""CSMIP volume 2, COSMOS, K-NET, KiK-net and USGS SMC: made-up files, and real ones where they are present."""

import gzip
import io
import math
import random
import zipfile
from datetime import datetime, timedelta

import numpy as np
import pytest
from made_up_records import VALUES, corrected, cosmos, csmip, csmnc, knet, knet_csv, smc
from mutated_files import damaged_bytes
from record_files import FORMATS, assert_refused, needs_records, write
from undamaged_records import records

from analytic.errors import SceneError
from analytic.records import G, content, read_channels, read_record

COUNTS = [5, -3, 8, 1, -12, 4, 7, 0, 3, -9]  # of mean 0.4: 10 cm/s2 a million counts


def same(motion, values, dt=0.005):
    np.testing.assert_allclose(motion.samples, values, rtol=1e-15, atol=0)
    return motion.dt == dt


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("channel, times", [(1, 1), ("2", 2), ("up", 2), ("90 deg", 1), (" H1 ", 3)])
def test_a_csmip_channel_is_chosen_by_number_or_direction(tmp_path, channel, times, end):
    motion = read_record(write(tmp_path, csmip(VALUES).replace("\n", end)), channel=channel)
    assert same(motion, np.array(VALUES) * times) and not motion.warnings
    assert motion.label == f"record, channel {times} ({['90 Deg', 'Up', 'H1'][times - 1]})"


def test_csmip_numbers_that_touch_are_cut_by_position(tmp_path):
    values = [12.3456, 2.0, -1.5, 4.25] * 3  # 1234.56000 fills its ten columns
    assert same(read_record(write(tmp_path, csmip(values)), channel=1), values)


@pytest.mark.parametrize(
    "step, old, new, dt",
    [
        (".0025", "spaced at .0025", "spaced at .003", 0.0025),
        (".005", "   0.00500", "-999.00000", 0.005),  # unknown to the reals
    ],
)
def test_the_csmip_step_that_the_line_before_the_data_rounds_is_read_from_the_reals(tmp_path, step, old, new, dt):
    text = csmip(VALUES, step).replace(old, new)
    assert new in text and read_record(write(tmp_path, text), channel=1).dt == dt


@pytest.mark.parametrize("channel, times", [(1, 1), ("340 deg", 1), ("2", 2), ("UP", 2)])
@pytest.mark.parametrize("layout, units", [("8F10.5", "cm/sec2(04)"), ("1E15.6", "cm/s^2 (4)"), ("1F15.6E", "cm/s^2")])
def test_cosmos(tmp_path, channel, times, layout, units):
    motion = read_record(write(tmp_path, cosmos(VALUES, layout, units)), channel=channel)
    assert same(motion, np.array(VALUES) * times) and not motion.warnings
    assert motion.label == f"record, channel {times} ({['340 deg', 'Up'][times - 1]})"


def test_cosmos_without_its_step_asks_for_one(tmp_path):
    path = write(tmp_path, cosmos(VALUES, step=-999.0))
    assert_refused(path, "motion.dt: missing; the record states no sampling interval; add dt, the step", channel=1)
    assert read_record(path, channel=1, dt=0.02).dt == 0.02


def test_cosmos_of_one_channel_without_a_number_needs_no_choice(tmp_path):
    motion = read_record(write(tmp_path, cosmos(VALUES, channels=("?:Other",))))
    assert same(motion, VALUES) and motion.label == "record, channel 1 (Other)"


def test_cosmos_velocities_behind_the_accelerations_are_passed_over(tmp_path):
    text = cosmos(VALUES)
    data = text[text.index("      12 acceleration pts") : text.index("End-of-data")]
    text = text.replace(data, data + data.replace("acceleration", "velocity"), 1)
    assert same(read_record(write(tmp_path, text), channel=2), np.array(VALUES) * 2)


def test_knet_mean_is_removed_and_said(tmp_path):
    channel = read_channels(write(tmp_path, knet(COUNTS)))[0]
    assert same(channel.motion, (np.array(COUNTS) * 10 - 4) * 1e-8)  # in whole numbers: 10 x count - sum
    assert (channel.motion.label, channel.direction, channel.note) == ("record (mean removed)", "E-W", "mean removed")


def test_knet_loses_nothing_of_small_counts_on_a_large_mean(tmp_path):
    near, far = (read_record(write(tmp_path, knet([count + mean for count in COUNTS]))) for mean in (0, 90_000_000))
    np.testing.assert_array_equal(near.samples, far.samples)


@pytest.mark.parametrize("high", [False, True])
def test_smc(tmp_path, high):
    motion = read_record(write(tmp_path, smc(VALUES, high)))
    assert same(motion, VALUES) and not motion.warnings and motion.label == "record"


WORDS = "12 acceleration pts"
BAD = {
    "comments not counted": (cosmos(VALUES), "Comment line(s)", "line(s)", "not the count of comment lines"),
    "counts": (
        cosmos(VALUES),
        "units=cm/sec2(04)",
        "units=counts (50)",
        "line 48, units = 'counts': not an acceleration",
    ),
    "two units": (cosmos(VALUES), "cm/sec2(04)", "cm/sec2(02)", "units = 'cm/sec2': but their code is 2; correct the"),
    "velocities": (
        cosmos(VALUES),
        WORDS,
        "12 velocity pts",
        "line 48 = '12 velocity pts, approx    0 secs, units=cm/s",
    ),
    "velocities by code": (
        cosmos(VALUES),
        "       2       1       4",
        "       2       2       4",
        "not an acceleration",
    ),
    "fewer stated": (cosmos(VALUES), WORDS, "8 acceleration pts", "line 48 = 8: more numbers follow than these"),
    "more stated": (cosmos(VALUES), WORDS, "99 acceleration pts", "not 8 numbers of 10 characters; 99 samples are"),
    "other length": (cosmos(VALUES), "0.060000", "9.000000", "length = 9.0: but 12 samples at the step of 0.005 s"),
    "header cut": (cosmos(VALUES), "-999.000000", "", "line 25 = 100: but 5 header values follow; the file is cut"),
    "no end": (
        cosmos(VALUES),
        "End-of-data for Chan  2 acceleration",
        "",
        "no line that ends the channel follows; the file is cut",
    ),
    "no layout": (cosmos(VALUES), "Format=(8F10.5)", "Format=(8I10)", "names no Fortran format of decimals"),
    "no scale": (
        knet(COUNTS),
        "Scale Factor ",
        "",
        "Scale Factor: missing from the header, or damaged; give the file as the network sends it",
    ),
    "scale of 0": (knet(COUNTS), "2000(gal)", "0(gal)", "Scale Factor = 0.0: not above 0"),
    "no frequency": (knet(COUNTS), "200Hz", "manyHz", "Sampling Freq(Hz): missing from the header, or damaged"),
    "cut": (knet(COUNTS), "       3       -9 ", "", "Duration Time(s) = 0.05: but 8 samples follow at 200 Hz"),
    "no whole number": (knet(COUNTS), "      -3 ", "    -3.0 ", "line 11 = '-3.0': not a whole number"),
    "no memo": (knet(COUNTS), "Memo.", "", "Memo.: missing from the header"),
    "twice": (knet(COUNTS), "Lat.", "Dir.", "Dir.: stated twice"),
    "velocity": (smc(VALUES, first="3 VELOCITY"), "", "", "line 1 = 'velocity': not an acceleration; give the accel"),
    "spectra": (smc(VALUES, first="5 RESPONSE SPECTRA"), "", "", "line 1 = 'response spectra': not an acceleration"),
    "uneven": (
        smc(VALUES, rate=1.7e38),
        "",
        "",
        "no sampling frequency: the file has uneven times; give the corrected",
    ),
    "comments lost": (
        smc(VALUES),
        "| made up\n",
        "",
        "line 30 = '-2.0000E+1 1.1000E+1 4.0000E+1-3.3000E+1': not 8 numb",
    ),
    "half a sample": (
        smc(VALUES),
        "        12         0",
        "      12.5         0",
        "integers of the header = 12.5: not a whole number",
    ),
    "numbers left": (smc(VALUES), "        12", "         8", "the 17th integer = 8: more numbers follow than these"),
    "another exponent": (smc(VALUES), "-4.5600E+1", "4.5600E+01", "not printed as the other numbers are"),
    "a row short": (smc(VALUES), "    -32768\n", "\n", "not 8 header values; the file is cut or damaged"),
}


@pytest.mark.parametrize("text, old, new, message", BAD.values(), ids=BAD)
def test_refused(tmp_path, text, old, new, message):
    assert old in text
    path = write(tmp_path, text.replace(old, new) if old else text)
    assert_refused(path, message, channel=2 if "Sta Chan" in text else None)


CSMIP = {
    "no channel named": ({"channel": 1}, "Chan  2:", "Chan  Up", "names no channel, as Chan 1: 90 Deg"),
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
    "cut": (
        {"channel": 1},
        "/&  ----------  End of data for channel  3",
        "/ 3",
        "no line that ends the channel follows",
    ),
    "two steps": ({"channel": 1}, "spaced at .005", "spaced at .010", "line 40, step = 0.005: but line 46 says 0.01 s"),
    "no step": (
        {"channel": 1},
        "spaced at .005",
        "spaced at .000",
        "line 46, step = 0.0: not a sampling interval; give a step above 0",
    ),
}


@pytest.mark.parametrize("options, old, new, message", CSMIP.values(), ids=CSMIP)
def test_csmip_refused(tmp_path, options, old, new, message):
    assert_refused(write(tmp_path, csmip(VALUES).replace(old, new) if old else csmip(VALUES)), message, **options)


def test_a_file_of_one_channel_has_none_to_choose(tmp_path):
    words = "motion.channel = 1: but the file has no several channels; remove channel"
    assert_refused(write(tmp_path, "0 1\n.01 2\n"), words, units="g", channel=1)


@pytest.mark.parametrize(
    "text, old, new, words",
    [
        (csmip(VALUES), "=  -150.000", "=  -152.000", "states a peak of -152 cm/s2, the data have 150"),
        (cosmos(VALUES), "   -150.000000", "   -152.000000", "states a peak of -152 cm/sec2, the data have 150"),
        (knet(COUNTS), "0.000", "7.500", "states a peak of 7.5 gal, the data have 0.000124"),
        (smc(VALUES), "-1.5000000E+02", "-1.6000000E+02", "states a peak of 160 cm/s2, the data have 150"),
        (smc(VALUES), "12         0", "12         1", "its header flags a problem: see its comments"),
    ],
)
def test_what_is_odd_is_said(tmp_path, text, old, new, words):
    assert text.count(old) >= 1
    first, *others = read_channels(write(tmp_path, text.replace(old, new)))
    assert any(words in warning for warning in first.motion.warnings)
    assert not any(other.motion.warnings for other in others)


@needs_records
@pytest.mark.parametrize(
    "name, dt, count, peak, within, at",
    [
        ("AOM001.EW", 0.01, 10200, 4.078, 5e-4, None),
        ("RSN1063_NORTHR_RRS228.AT2", 0.01, 1991, -0.8741 * 981, 0.05, 2.560),
        ("0111a.smc", 0.005, 6001, 104.4, 0.05, 10.17),
        ("cosmos.V2c", 0.005, 42000, -6.852, 5e-4, 76.215),
    ],
)
def test_real_files(name, dt, count, peak, within, at):
    """The figures [cm/s2, s] are those that the files' own headers state."""
    motion = read_record(FORMATS / name)
    assert (motion.dt, len(motion.samples), motion.warnings) == (dt, count, ())
    largest = motion.samples[int(np.abs(motion.samples).argmax())]
    assert 100 * largest == pytest.approx(peak, abs=within)
    assert at is None or motion.peak_time == pytest.approx(at, abs=1e-9)


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
def test_real_csmip_files(name, dt, counts, directions):
    """Each channel's header states its peak and the time of the peak."""
    lines = (FORMATS / name).read_text().splitlines()
    stated = [line.split() for line in lines if line.lower().startswith("peak acceleration")]
    for channel, (count, direction) in enumerate(zip(counts, directions, strict=True), 1):
        motion = read_record(FORMATS / name, channel=direction)
        assert (motion.dt, len(motion.samples), motion.warnings) == (dt, count, ())
        assert f"channel {channel} ({direction})" in motion.label
        at = int(np.abs(motion.samples).argmax())
        assert motion.samples[at] == pytest.approx(float(stated[channel - 1][3]) / 100, abs=5.01e-6)
        assert at * dt == pytest.approx(float(stated[channel - 1][6]), abs=1e-9)


# Packed records: read as what they hold, or refused; damaged ones never read as something else.
AT2 = "a\nb\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n.1 .2 -.3 .4\n"


def zipped(files, method=zipfile.ZIP_DEFLATED):
    """Return a zip file of {name: text}; a name that ends in / is a folder."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        for file in files.items():
            archive.writestr(*file)
    return packed.getvalue()


SOUND = [record[:3] for record in records() if "refused" not in record[0]]


@pytest.mark.parametrize("name, text, options", SOUND, ids=[name for name, *_ in SOUND])
def test_packed_is_read_as_plain(tmp_path, name, text, options):
    plain = read_record(write(tmp_path, text.encode(), "plain"), **options)
    for packed in (gzip.compress(text.encode()), zipped({"folder/": "", "folder/x.dat": text, "__MACOSX/x": "-"})):
        motion = read_record(write(tmp_path, packed), **options)
        np.testing.assert_array_equal(motion.samples, plain.samples)
        assert motion.dt == plain.dt and motion.label.startswith("record")


def locked():
    """Return a zip file that says that it has a password."""
    packed = bytearray(zipped({"a": AT2}))
    for magic, place in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        packed[packed.index(magic) + place] |= 1
    return bytes(packed)


BAD_PACKED = {
    "gzip cut": (gzip.compress(AT2.encode())[:-9], "is a damaged gzip file"),
    "zip cut": (zipped({"a": AT2})[:-30], "is a damaged zip file"),
    "several": (zipped({f"{n}.AT2": AT2 for n in "abcdefg"}), "holds 7 files: a.AT2, b.AT2, c.AT2, d.AT2, e.AT2, ...;"),
    "none": (zipped({}), "is packed by zip, and empty"),
    "folder alone": (zipped({"a/": ""}), "holds 0 files"),
    "password": (locked(), "is a zip file with a password; unpack it first"),
    "twice": (gzip.compress(zipped({"a": AT2})), "is packed by zip; unpack it once, it is packed twice (unzip)"),
    "bzip2": (b"BZh91AY&SY", "is packed by bzip2; unpack it first (bunzip2)"),
    "velocities": (zipped({"a.VT2": AT2}), "holds velocities, as .VT2 files do"),
    "velocities by the name without .gz": (gzip.compress(AT2.encode()), "holds velocities, as .VT2 files do"),
    "Excel": (
        zipped({"[Content_Types].xml": "", "xl/workbook.xml": ""}),
        "record: is a spreadsheet; save the sheet with the record as CSV",
    ),
    "nothing in it": (zipped({"a": ""}), "record: is empty"),
}


@pytest.mark.parametrize("packed, message", BAD_PACKED.values(), ids=BAD_PACKED)
def test_packed_refused(tmp_path, packed, message):
    assert_refused(write(tmp_path, packed, "record.VT2.gz"), message)


@pytest.mark.parametrize("pack", [gzip.compress, lambda text: zipped({"a": text})])
def test_no_more_is_unpacked_than_a_record_can_hold(tmp_path, monkeypatch, pack):
    monkeypatch.setattr(content, "LARGEST", 100_000)
    assert_refused(write(tmp_path, pack(bytes(10_000_000))), "unpacks to more than 0.1 MB")


PACKED = [
    (pack(text.encode()), options)
    for text, options in ((AT2, {}), (csmip(VALUES), {"channel": 2}), (cosmos(VALUES), {"channel": 1}))
    for pack in (gzip.compress, lambda text: zipped({"a": text}), lambda text: zipped({"a": text}, zipfile.ZIP_STORED))
]


@pytest.mark.slow
def test_damaged_packed_files_are_refused_or_read_the_same(tmp_path):
    chance, read = random.Random(0), 0
    for packed, options in PACKED:
        whole = read_record(write(tmp_path, packed), **options)
        for _ in range(100):
            path = write(tmp_path, damaged_bytes(packed, chance))
            try:
                motion = read_record(path, "g" if chance.random() < 0.1 else None, **options)
            except SceneError as error:
                assert str(error).isprintable() and error.remedy
                continue
            assert motion.dt == whole.dt and motion.samples.tolist() == whole.samples.tolist()
            read += 1
    assert 0 < read < 450


# Layouts of programs, loggers and networks: one motion as each writes it, read as it is or refused with a remedy that


DT = 0.02
GAL = [120 * math.exp(-(((DT * i - 0.36) / 0.15) ** 2)) * math.sin(5 * math.pi * DT * i) for i in range(36)]
IN_G, METRES = [gal / 100 / G for gal in GAL], [gal / 100 for gal in GAL]
PEAK = -1.062929  # m/s2


def rows(form, values=IN_G, begin="2030-01-02T03:04:15"):
    """Return a line for each value a with its number n, at time t or stamp s."""
    stamps = [datetime.fromisoformat(begin) + timedelta(milliseconds=20 * i) for i in range(len(values))]
    return "".join(
        form.format(t=DT * i, a=value, n=i + 1, s=stamps[i].isoformat(timespec="milliseconds")) + "\n"
        for i, value in enumerate(values)
    )


def lines(form, per_line, values=IN_G):
    """Return lines of so many values each, with their times t."""
    words = [form.format(t=DT * i, a=value) for i, value in enumerate(values)]
    return "".join("".join(words[i : i + per_line]) + "\n" for i in range(0, len(words), per_line))


PLOTS = "Time [s] - Plot 0\tAmplitude - Plot 0\tTime [s] - Plot 1\tAmplitude - Plot 1\t\n"
PLOTS += rows("{t:g}\t{a:g}\t{t:g}\t-{n}\t")
EQSIG = "example\n36 0.0200\n" + rows("{a:.6f}", METRES)
FIVE = lines(" {a:14.7E}", 5)
# name: (text, what the user says)
READ = {
    "ETABS, pairs": ("$ time and value, in g\n" + lines("{t:.3f} {a:.6f} ", 4), {"column": 2}),
    "pairs under titles": ("Time (s) Acc (g) Time (s) Acc (g)\n" + lines("{t:.3f} {a:.6f} ", 2), {}),
    "pairs, the last line shorter": (lines("{t:.3f} {a:.6f} ", 5), {"units": "g"}),
    "a unit in the title": ("time,acc_cms2\n" + rows("{t:.2f},{a:.5f}", GAL), {}),
    "China": (csmnc(METRES), {}),
    "SMTK": (corrected(METRES, DT), {}),
    "eqsig": (EQSIG, {"units": "m/s2"}),
    "eqsig, five a line": ("36 0.0200\n" + lines(" {a:.7f}", 5), {"units": "g"}),
    "DEEPSOIL": ("36 0.02\n" + rows("{t:.4f} {a:.7f}"), {"units": "g"}),
    "number alone": ("36\n" + rows("{a:.7f}"), {"units": "g", "dt": DT}),
    "NPTS and DT, a line each": ("NPTS = 36\nDT = 0.02\nUNITS = g\n" + rows("{a:.7f}"), {}),
    "numbered headings, as in Peru": (
        "1. ESTACION\n   NOMBRE : X\n2. SISMO\n3. REGISTRO\n NUMERO DE MUESTRAS : 36\n MUESTREO (muestras/s) : 50\n"
        " UNIDADES : cm/s2\n4. DATOS DE ACELERACION\n  Z  N  E\n" + rows("1.0000 {a:.4f} -1.0000", GAL),
        {"column": "N"},
    ),
    "PEER with marked data": (
        "made up\n36 points at equal spacing of 0.02 sec\nThe units are (g)\n*** Begin data ***\n"
        "NPTS=  36, DT= .02000 SEC\n" + lines(" {a:9.7f}", 8) + "*** End data ***\n",
        {},
    ),
    "PEER, marked below its counts": (
        "made up\nin g\nNPTS= 36, DT= .02 SEC\n*** BEGIN ACCELERATION DATA ***\n" + lines(" {a:9.7f}", 8) + "** END **",
        {"units": "g"},
    ),
    "columns with marked data": (
        "t [s] a [g]\n*** Begin data ***\n" + rows("{t:.2f} {a:.7f}") + "*** End data ***\n",
        {"units": "g"},
    ),
    "a number above that is an acceleration": (
        "# samples: 36\n" + rows("{a:.7f}").replace("0.0", "0", 1),
        {"units": "g", "dt": DT},
    ),
    "a step in a line": ("Time Step: 0.02\n" + rows("{a:.9f}"), {"units": "g"}),
    "OpenSees": (FIVE, {"units": "g", "dt": DT}),
    "Excel, all in quotes": ('"Time (s)","Acc (g)"\n' + rows('"{t:.2f}","{a:.7f}"'), {}),
    "quotes, commas": ('"t, s","a, g"\n' + rows('"{t:.2f}","{a:.7f}"').replace(".", ","), {}),
    "quotes, commas in the titles": ('"Time, s","a, g"\n' + rows('"{t:.2f}","{a:.7f}"'), {}),
    "quotes, semicolons": ('"Zeit [s]";"a [g]"\n' + rows('"{t:.2f}";"{a:.7f}"').replace(".", ","), {}),
    "R, write.csv": ('"","time","acc_g"\n' + rows('"{n}",{t:.2f},{a:.7f}'), {}),
    "R, write.table": ('"time" "acc"\n' + rows('"{n}" {t:.2f} {a:.7f}'), {"units": "g"}),
    "pandas": (",time,acc_g\n" + rows("{n},{t:.2f},{a:.7f}"), {}),
    "stamps": ("time,acc (gal)\n" + rows("{s},{a:.4f}", GAL), {}),
    "stamps over midnight": ("t;a [gal]\n" + rows("{s}Z; {a:.4f}", GAL, "2027-12-31T23:59:59.5"), {}),
    "stamps with blanks": ("time acc (gal)\n" + rows("{s} {a:.4f}", GAL).replace("T", " "), {}),
    "clock": ("t;a [gal]\n" + rows("{s};{a:.4f}", GAL).replace("2030-01-02T", "").replace(".", ","), {}),
    "LabVIEW": (PLOTS, {"units": "g", "column": 2}),
    "units below": ("Time,Acc\ns,gal\n" + rows("{t:.2f},{a:.4f}", GAL), {}),
    "units below, in brackets": ("Time\tAcc\n[s]\t[g]\n" + rows("{t:.2f}\t{a:.7f}"), {}),
    "a ruler below": ("Time (s)  Acc (g)\n--------  -------\n" + rows("{t:8.2f}  {a:.7f}"), {}),
    "accelerations first": ("acc (g),time (s)\n" + rows("{a:.7f},{t:.2f}"), {}),
    "numbered rows": (rows("{n} {t:.2f} {a:.7f}"), {"units": "g"}),
    "velocities beside": ("t a v d\n" + rows("{t:.2f} {a:.7f} 1.0 2.0"), {"units": "g", "column": "a"}),
    "BBP": ("#  time(sec)  N-S(cm/s/s)\n" + rows("{t:.6e} {a:.6e}", GAL), {}),
    "separators behind": ("Time (s),Acc (g),,\n" + rows("{t:.2f},{a:.7f},,"), {}),
    "fit to a spectrum": ("# compatible with the spectrum of EC8\n" + rows("{t:.2f} {a:.7f}"), {"units": "g"}),
}


@pytest.mark.parametrize("text, options", READ.values(), ids=READ)
def test_a_layout_is_read(tmp_path, text, options):
    (channel,) = read_channels(write(tmp_path, text), **options)
    motion = channel.motion
    assert (len(motion.samples), motion.dt, motion.peak_time, motion.warnings) == (36, DT, pytest.approx(0.32), ())
    assert motion.samples.tolist() == pytest.approx(METRES, abs=1e-5)
    assert motion.samples[16] == pytest.approx(PEAK, abs=1e-5)


SPECTRUM = "".join(f"{0.05 * i:.2f},{0.12 + 0.03 * math.sin(0.3 * i):.5f}\n" for i in range(36))
TSPAIR = "TIMESERIES XX_A__HNE_R, 36 samples, 50 sps, 2030-01-02T03:04:15.0, TSPAIR, FLOAT, Counts\n"
TSPAIR += rows("{s}  {a:+.6e}", GAL)
NOT_A_TIME = (
    "not a time; give the accelerations over time of this record; if these are, title their columns time [s] and"
)
ASKED = "may be a unit, and is none of acceleration that is known; write one of m/s2, cm/s2, g, gal, mm/s2, %g in its"
# name: (text, what the user says, words of the message, the text after the remedy, what the user says then)
REFUSED = {
    "spectrum": (
        "T (s),Sa (g)\n" + SPECTRUM,
        {},
        f"line 1, title = 'T (s)': is a period, {NOT_A_TIME}",
        "time [s],acceleration (g)\n" + SPECTRUM,
        {},
    ),
    "spectra of SeismoSignal": (
        "Constant ductility spectrum\n   Period [sec]   Acc./Elastic   Vel./Elastic\n" + rows("{t:.3f} 1.2 1.5"),
        {"units": "m/s2"},
        "line 2, title = 'Period [sec]': is a period",
        None,
        {},
    ),
    "a spectrum by its header": (
        "# Design spectrum, 5%\n" + SPECTRUM,
        {"units": "g"},
        "line 1 = '# Design spectrum, 5%': names a spectrum, not an acceleration over time",
        "# Design spectrum, 5%\n# time [s], acceleration [g]\n" + SPECTRUM,
        {},
    ),
    "unit in the title": (
        "time,acc_cms2\n" + rows("{t:.2f},{a:.5f}", GAL),
        {"units": "g"},
        "motion.units = 'g': but the record carries its own unit, cm/s2 (line 1); remove units",
        "time,acc_cms2\n" + rows("{t:.2f},{a:.5f}", GAL),
        {},
    ),
    "unknown unit": (
        "time,acc [lsb]\n" + rows("{t:.2f},{a:.7f}"),
        {"units": "g"},
        f"line 1, title = 'acc [lsb]': 'lsb' {ASKED}",
        "time,acc\n" + rows("{t:.2f},{a:.7f}"),
        {"units": "g"},
    ),
    "unknown unit in a list": (
        "acc_counts\n" + rows("{a:.7f}"),
        {"units": "g", "dt": DT},
        f"line 1, title = 'acc_counts': 'counts' {ASKED}",
        "acc_g\n" + rows("{a:.7f}"),
        {"dt": DT},
    ),
    "units below": (
        "Time,Acc\ns,g\n" + rows("{t:.2f},{a:.7f}"),
        {"units": "m/s2"},
        "but the record carries its own unit, g (line 2)",
        "Time,Acc\ns,g\n" + rows("{t:.2f},{a:.7f}"),
        {},
    ),
    "OpenSees, no step": (
        FIVE,
        {"units": "g"},
        "motion.dt: missing; the file holds accelerations alone, 5 a line, or columns without times; add dt",
        FIVE,
        {"units": "g", "dt": DT},
    ),
    "pairs, a damaged time": (
        "$ in g\n" + lines("{t:.3f} {a:.6f} ", 4).replace("0.100", "0.l00"),
        {"column": 2},
        "line 3: its times do not rise along the pairs of time and value; mend the damaged time",
        "$ in g\n" + lines("{t:.3f} {a:.6f} ", 4),
        {"column": 2},
    ),
    "eqsig, no unit": (EQSIG, {}, "motion.units: missing; the header names no unit", EQSIG, {"units": "m/s2"}),
    "eqsig, a value lost": (
        EQSIG.replace("-1.062929\n", ""),
        {"units": "m/s2"},
        "line 2 = '36 0.0200': may be the number of values and their step, but 35 values follow; correct it, or begin",
        EQSIG.replace("-1.062929\n", "").replace("36 0.02", "35 0.02"),
        {"units": "m/s2"},
    ),
    "SMTK, a line lost": (
        corrected(METRES, DT).replace("\n-7.0448655E-03", "\n"),
        {},
        "number of samples = 36: but 35 samples follow; the file is cut or damaged",
        None,
        {},
    ),
    "the step alone above": (
        "0.02\n" + rows("{a:.7f}"),
        {"units": "g", "dt": DT},
        "line 1 = '0.02': not printed as the numbers below are, and may be their step, their number or a factor; write",
        "# dt = .02 s\n" + rows("{a:.7f}"),
        {"units": "g"},
    ),
    "number and step, a line each": (
        "36\n0.02\n" + rows("{a:.7f}"),
        {"units": "g", "dt": DT},
        "line 1 = '36': as many as the numbers below, and may be their step, their number or a factor; write it in",
        "36 0.02\n" + rows("{a:.7f}"),
        {"units": "g"},
    ),
    "another number than follow": (
        "40\n" + rows("{a:.7f}"),
        {"units": "g", "dt": DT},
        "line 1 = '40': not printed as the numbers below are, and may be their step, their number or a factor",
        "# 40\n" + rows("{a:.7f}"),
        {"units": "g", "dt": DT},
    ),
    "a row of number and step above times": (
        "0.02 36\n" + rows("{t:.2f} {a:.7f}"),
        {"units": "g", "dt": DT, "column": 2},
        "line 1 = '0.02 36': no row as those below are, and may be their step, their number or a factor; begin",
        "# dt = .02 s\n" + rows("{t:.2f} {a:.7f}"),
        {"units": "g"},
    ),
    "a number above several a line": (
        "0.02\n" + FIVE,
        {"units": "g", "dt": DT},
        "line 1 = '0.02': no row as those below are, and may be their step, their number or a factor; begin the line",
        "# dt = .02 s\n" + FIVE,
        {"units": "g"},
    ),
    "the step first of five a line": (
        lines(" {a:14.7E}", 5, [DT, *IN_G]),
        {"units": "g", "dt": DT},
        "line 1 = '2.0000000E-02': equal to the step that is given, and may be",
        "# samples: 37\n" + lines(" {a:14.7E}", 5, [DT, *IN_G]),
        {"units": "g", "dt": DT},
    ),
    "a table of earthquakes": (
        "Record Sequence Number,EQID,Earthquake Name,YEAR,PGA (g)\n"
        '1,0001,"Hill, North-01",1935,0.15\n2,0002,Hill,1936,0.04\n',
        {"column": 5},
        "line 1, titles = 'Record Sequence Number, EQID, Earthquake Name, YEAR, PGA (g)': are those of a table",
        None,
        {},
    ),
    "peaks by year": (
        "Year,PGA (g)\n1935,0.15\n1936,0.04\n1937,.1\n",
        {},
        "are those of a table of earthquakes or stations (year); give the file of one record, its accelerations over",
        None,
        {},
    ),
    "marks inside": (
        rows("{t:.2f} {a:.7f}") + "*** End data ***\n" + rows("{t:.2f} {a:.7f}"),
        {"units": "g"},
        "line 37 = '***': not a number; mend or remove it",
        None,
        {},
    ),
    "days first": (
        "time,acc (g)\n" + rows("02.01.2030 03:04:{t:06.3f},{a:.7f}"),
        {},
        "line 2 = '02.01.2030 03:04:00.000,0.0000000': its time is a date or a clock of no known form; write the times",
        "time,acc (g)\n" + rows("{t:.3f},{a:.7f}"),
        {},
    ),
    "no day of the calendar": (
        "time,acc (g)\n" + rows("{s},{a:.7f}").replace("2030-01-02", "2030-13-02"),
        {},
        "line 2 = '2030-13-02T03:04:15.000': not a date (month must be in 1..12); write the times in seconds",
        "time,acc (g)\n" + rows("{s},{a:.7f}"),
        {},
    ),
    "a header that begins with a number": (
        "1995 Kobe\ndt = 0.02\n" + rows("{a:.7f}"),
        {"units": "g"},
        "line 1 = 'Kobe': not a number; mend it, or begin the lines of the header with #",
        "# 1995 Kobe\n# dt = 0.02\n" + rows("{a:.7f}"),
        {"units": "g"},
    ),
    "TSPAIR": (
        TSPAIR,
        {},
        "is a TSPAIR file, which is not read; with ObsPy, write two columns, time [s] and acceleration, counts divided",
        "time [s] acceleration [cm/s2]\n" + rows("{t:.2f} {a:.4f}", GAL),
        {},
    ),
    "NPTS without its number": (
        "NPTS = many\nDT = 0.02\n" + rows("{a:.7f}"),
        {"units": "g"},
        "line 1 = 'NPTS = many': names NPTS, but not as PEER AT2 does",
        None,
        {},
    ),
    "only velocities": (
        "Time (s),Vel. (cm/s),Arias (%)\n" + rows("{t:.2f},{a:.7f},1"),
        {},
        "line 1, title = 'Vel. (cm/s)': is a velocity, a displacement or another quantity, not an acceleration",
        None,
        {},
    ),
    "a profile": ("Depth (m),PGA (g)\n" + SPECTRUM, {"column": 2}, f"'Depth (m)': is a place, {NOT_A_TIME}", None, {}),
}


@pytest.mark.parametrize("text, options, message, mended, then", REFUSED.values(), ids=REFUSED)
def test_a_layout_is_refused_and_its_remedy_works(tmp_path, text, options, message, mended, then):
    assert_refused(write(tmp_path, text), message, **options)
    if mended:
        motion = read_record(write(tmp_path, mended), **then)
        assert len(motion.samples) in (35, 36, 37) and motion.dt in (DT, 0.05)


def test_columns_that_are_no_accelerations_are_not_offered(tmp_path):
    path = write(tmp_path, "Time (s),Acc (g),Vel (cm/s),Disp (cm),Sa\n" + rows("{t:.2f},{a:.7f},1,2,3"))
    assert_refused(path, "motion.column: missing; not all columns are accelerations (line 1, title: is a velocity, ")
    assert_refused(path, "; add column, 2 (Acc)")
    assert read_record(path, column="acc").samples.tolist() == pytest.approx(METRES, abs=1e-5)
    assert_refused(path, "'Vel (cm/s)': is a velocity, a displacement or another quantity", column=3, units="cm/s2")
    assert_refused(path, "motion.column = 1: is the time; give column, 2 (Acc)", column=1)


@pytest.mark.parametrize("titles", ["Time_A A_g Time_B B_g", "T_A A_g T_B A_g", "T A_g T B_g"])
def test_pairs_under_titles_that_differ_are_columns(tmp_path, titles):
    """Two instruments are sampled in turn."""
    text = "".join(f"{DT * i:.3f} {a:.7f} {DT * i + 0.01:.3f} {a:.7f}\n" for i, a in enumerate(IN_G))
    first, second = read_channels(write(tmp_path, f"{titles}\n{text}"))
    assert (len(first.motion.samples), first.motion.dt, second.number) == (36, DT, "4")
    assert read_record(write(tmp_path, text), "g").dt == 0.01


def test_rows_whose_times_rise_are_not_counted_by_the_first_one(tmp_path):
    """The first number would count the rows; and their number may be stated as that of all numbers."""
    assert len(read_record(write(tmp_path, "3 0.5\n4 -.1\n5 .2\n6 .3\n"), "m/s2").samples) == 4
    motion = read_record(write(tmp_path, "# number of data: 72\n" + rows("{t:.2f} {a:.7f}")), "g")
    assert len(motion.samples) == 36 and "states 72 samples, the data have 36" in motion.warnings[0]


def test_each_of_several_columns_has_the_times_before_it(tmp_path):
    text = "Time [s]\tA (g)\tTime [ms]\tB (g)\n" + rows("{t:.2f}\t{a:.7f}\t{n}\t{a:.7f}")
    first, second = read_channels(write(tmp_path, text))
    assert (first.direction, first.motion.dt, second.direction, second.motion.dt) == ("A", DT, "B", 0.001)


def test_knet_csv(tmp_path):
    """The offsets are subtracted: one of 16.5 gal would be a constant acceleration."""
    path = write(tmp_path, knet_csv(GAL))
    channels = read_channels(path)
    assert [(channel.number, channel.direction, channel.note) for channel in channels] == [
        (number, name, "offset subtracted") for number, name in (("1", "N-S"), ("2", "E-W"), ("3", "U-D"))
    ]
    for channel, times in zip(channels, (1, -2, 3), strict=True):
        assert (channel.motion.dt, channel.unit.word, channel.motion.warnings) == (DT, "gal", ())
        assert channel.motion.samples.tolist() == pytest.approx([times * value for value in METRES], abs=0.51e-4)
    assert read_record(path, channel="n-s").samples[16] == pytest.approx(-1.0629, abs=1e-12)
    assert_refused(path, "motion.channel: missing; the file holds channels 1 (N-S) or 2 (E-W) or 3 (U-D); add channel")
    assert_refused(path, "motion.column = 3: but the file is K-NET CSV; remove column", column=3)
    (warning, *_) = read_record(write(tmp_path, knet_csv(GAL, seconds=1)), channel=1).warnings
    assert "the header states 1 s, the data have 0.72 s: check that the file is whole" in warning


KNET_CSV = {
    "no offsets": (
        "#Offset\n",
        "",
        "Offset: missing from the header, or damaged; give the file as the network sends it",
    ),
    "an offset too few": (",16.50\n#Time", "\n#Time", "no offset of each component"),
    "no frequency": ("(Hz)\n#50\n", "(Hz)\n#fast\n", "SamplingFrequency(Hz) = 'fast': not a number"),
    "another frequency": ("(Hz)\n#50\n", "(Hz)\n#100\n", "but the times have a step of 0.02 s"),
    "a digit lost": (",-104.44,", ",-104.4,", "= '-104.4': not printed as the other numbers are"),
    "a column lost": (",16.50\n2030", "\n2030", "holds 4 columns, not 5; the file is cut or damaged"),
}


@pytest.mark.parametrize("old, new, message", KNET_CSV.values(), ids=KNET_CSV)
def test_a_damaged_knet_csv_is_refused(tmp_path, old, new, message):
    text = knet_csv(GAL)
    assert text.count(old) >= 1
    assert_refused(write(tmp_path, text.replace(old, new, 1)), message)


FORMS = "{:.2f}|{:.5f}|{:.0f}|{:.7E}|{:g}|{!r}|{:.12g}|{:9.4f}".split("|")
NOISE = [(-1) ** i * (1.7 * i * i % 9.73) * math.exp(-i / 60) for i in range(120)]
COSINE = [math.cos(0.3 * i) for i in range(80)]
STEPS = [1.0] * 30 + [-1.0] * 30 + [0.0] * 20
LATE = [0.0] * 12 + NOISE


def one_a_line(form, values):
    return "".join(f"{form.format(value)}\n" for value in values)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("size", [0.05, 116.0])
@pytest.mark.parametrize("values", [NOISE, COSINE, STEPS, LATE])
def test_a_list_of_accelerations_is_read_however_it_is_printed(tmp_path, form, size, values):
    for first in ("", "0\n"):
        text = first + one_a_line(form, [size * value for value in values])
        motion = read_record(write(tmp_path, text), "m/s2", dt=0.005)
        assert motion.samples.tolist() == [float(line) for line in text.split()]


# What stands above lists: of the form of their numbers, or of its own.
ABOVE = {
    "step": [DT],
    "factor, step": [1, DT],
    "another factor, step": [9.81, DT],
    "step, number": [DT, len(NOISE)],
    "number": [len(NOISE)],
    "factor, number, step": [386.4, len(NOISE), DT],
    "number, step, wrong": [len(NOISE) + 9, DT],
}
REST = [*(2e-6 * i for i in range(10)), *(0.1 * value for value in NOISE[10:])]


@pytest.mark.parametrize("above", ABOVE.values(), ids=ABOVE)
@pytest.mark.parametrize("form", ["{:.7E}", "{:g}", "{!r}"])
@pytest.mark.parametrize("zeros", [0, 2])
@pytest.mark.parametrize("given", [DT, 0.005])
def test_numbers_above_a_list_are_never_taken_for_accelerations(tmp_path, above, form, zeros, given):
    """They are refused, or read as what they are; a step given wrongly does not help them."""
    for head_form in (form, "{}", "{:g}"):
        for header in ("", "# made up\n"):
            text = header + one_a_line(head_form, above) + "0\n" * zeros + one_a_line(form, REST)
            try:
                motion = read_record(write(tmp_path, text), "g", dt=given)
            except SceneError as error:
                words = (
                    "their step, their number",
                    "the number of values and their step",
                    "the step of the record itself",
                )
                assert any(word in error.problem for word in words)
            else:
                assert motion.samples.tolist() == [G * float(form.format(value)) for value in [0.0] * zeros + REST]


def test_a_whole_number_above_integers_that_counts_them_is_refused(tmp_path):
    integers = one_a_line("{:.0f}", [20 * value for value in NOISE])
    assert_refused(write(tmp_path, f"120\n{integers}"), "line 1 = '120': as many as the numbers", units="gal", dt=DT)
    assert len(read_record(write(tmp_path, f"3\n{integers}"), "gal", dt=DT).samples) == 121


def test_a_chosen_column_without_times_begins_with_an_acceleration(tmp_path):
    text = "36 0.02\n" + rows("{a:.4f} {a:.4f}")
    for column, number in ((1, "1"), (2, "0.02")):
        assert len(read_record(write(tmp_path, text), "g", dt=DT, column=column).samples) == 36
        path = write(tmp_path, text.replace("36", "1"))
        assert_refused(path, f"line 1 = '{number}': ", units="g", dt=DT, column=column)
