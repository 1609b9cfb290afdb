"""CSMIP volume 2, COSMOS, K-NET, KiK-net and USGS SMC: files made up here, and the real ones where they are."""

import gzip
import io
import random
import zipfile

import numpy as np
import pytest
from made_up_records import VALUES, cosmos, csmip, knet, smc
from mutated_files import damaged_bytes
from record_files import FORMATS, assert_refused, needs_records, write
from undamaged_records import records

from analytic.errors import SceneError
from analytic.records import content, read_channels, read_record

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


@pytest.mark.parametrize("said, old, new, message", CSMIP.values(), ids=CSMIP)
def test_csmip_refused(tmp_path, said, old, new, message):
    assert_refused(write(tmp_path, csmip(VALUES).replace(old, new) if old else csmip(VALUES)), message, **said)


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
    """Against the figures that the files' own headers state [cm/s2, s]."""
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


# Packed records: read as what they hold, or refused; damaged ones never read as something else.
AT2 = "a\nb\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n.1 .2 -.3 .4\n"


def zipped(files, method=zipfile.ZIP_DEFLATED):
    """A zip file of {name: text}; a name that ends in / is a folder."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        for file in files.items():
            archive.writestr(*file)
    return packed.getvalue()


SOUND = [record[:3] for record in records() if "refused" not in record[0]]


@pytest.mark.parametrize("name, text, said", SOUND, ids=[name for name, *_ in SOUND])
def test_packed_is_read_as_plain(tmp_path, name, text, said):
    plain = read_record(write(tmp_path, text.encode(), "plain"), **said)
    for packed in (gzip.compress(text.encode()), zipped({"folder/": "", "folder/x.dat": text, "__MACOSX/x": "-"})):
        motion = read_record(write(tmp_path, packed), **said)
        np.testing.assert_array_equal(motion.samples, plain.samples)
        assert motion.dt == plain.dt and motion.label.startswith("record")


def locked():
    """A zip file that says that it has a password."""
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
    (pack(text.encode()), said)
    for text, said in ((AT2, {}), (csmip(VALUES), {"channel": 2}), (cosmos(VALUES), {"channel": 1}))
    for pack in (gzip.compress, lambda text: zipped({"a": text}), lambda text: zipped({"a": text}, zipfile.ZIP_STORED))
]


@pytest.mark.slow
def test_damaged_packed_files_are_refused_or_read_the_same(tmp_path):
    chance, read = random.Random(0), 0
    for packed, said in PACKED:
        whole = read_record(write(tmp_path, packed), **said)
        for _ in range(100):
            path = write(tmp_path, damaged_bytes(packed, chance))
            try:
                motion = read_record(path, "g" if chance.random() < 0.1 else None, **said)
            except SceneError as error:
                assert str(error).isprintable() and error.remedy
                continue
            assert motion.dt == whole.dt and motion.samples.tolist() == whole.samples.tolist()
            read += 1
    assert 0 < read < 450
