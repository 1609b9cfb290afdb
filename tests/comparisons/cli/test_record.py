"""``rocking record`` as a user calls it."""

import gzip
import json

import numpy as np
import pytest
from made_up_records import VALUES, csmip, knet

from analytic import SampledMotion
from analytic.records import G, read_record, two_columns
from comparisons.plotting.plots import DAMPING, PERIODS, spectrum


@pytest.fixture
def three_channels(tmp_path):
    path = tmp_path / "made-up.v2"
    path.write_text(csmip(VALUES))
    return path


def test_every_channel_is_shown_drawn_and_written(rocking, tmp_path, three_channels):
    picture, file = tmp_path / "record.png", tmp_path / "record.json"
    status, out, _ = rocking("record", three_channels, "--plot", picture, "--json", file)
    assert status == 0 and "made-up.v2: CSMIP volume 2" in out and picture.stat().st_size > 10_000
    rows = [line.split() for line in out.splitlines() if "(" in line]
    assert [row[:3] for row in rows] == [["1", "(90", "Deg)"], ["2", "(Up)", "cm/sec2"], ["3", "(H1)", "cm/sec2"]]
    result = json.loads(file.read_text())["channels"][1]
    assert (result["peak"], result["peak_time"], result["duration"]) == pytest.approx((3.0, 0.02, 0.055))


def test_one_channel_is_written_as_columns_that_are_read_back(rocking, tmp_path, three_channels):
    file = tmp_path / "up.txt"
    status, out, _ = rocking("record", three_channels, "--channel", "up", "--to", file)
    assert status == 0 and "2 (Up)" in out and "1 (90" not in out
    assert read_record(file).digest() == read_record(three_channels, channel=2).digest()


@pytest.mark.parametrize("dt", [1 / 120, 1 / 119.9, 1e-5, 0.1])
def test_columns_are_read_back_bit_for_bit(tmp_path, dt):
    samples = np.random.default_rng(1).normal(size=3000) * 10.0 ** np.linspace(-9, 0, 3000)
    path = tmp_path / "written.txt"
    path.write_text(two_columns(SampledMotion(dt, samples)))
    assert read_record(path).dt == dt
    np.testing.assert_array_equal(read_record(path).samples, samples)


def test_what_was_done_and_what_is_odd_are_said(rocking, tmp_path):
    path = tmp_path / "small.EW.gz"
    path.write_bytes(gzip.compress(knet([5, -3, 8, 1, -12, 4]).encode()))
    status, out, _ = rocking("record", path)
    assert status == 0 and "K-NET" in out and "E-W" in out
    assert "Mean removed." in out and "is below 1e-4 g: check the unit" in out.replace("\n", " ")


IN_UNITS = {"g": G, "mg": G / 1000, "%g": G / 100, "gal": 0.01, "cm/sec2": 0.01, "in/s2": 0.0254, "m/s2": 1.0}


@pytest.mark.parametrize("unit", IN_UNITS)
def test_a_record_is_read_in_its_unit_and_the_value_of_g_is_said(rocking, tmp_path, unit):
    path = tmp_path / "own.csv"
    path.write_text(f"t [s],a [{unit}]\n" + "".join(f"{0.01 * i:.2f},{a}\n" for i, a in enumerate(VALUES)))
    status, out, _ = rocking("record", path, "--json", tmp_path / "found.json")
    (result,) = json.loads((tmp_path / "found.json").read_text())["channels"]
    assert status == 0 and ("with g = 9.81 m/s2; other programs take 9.80665" in " ".join(out.split())) == (
        unit in ("g", "mg", "%g")
    )
    assert result["peak"] == pytest.approx(IN_UNITS[unit] * np.abs(VALUES).max())


def test_what_the_file_does_not_say_is_asked_for_and_taken(rocking, tmp_path):
    path = tmp_path / "channels.csv"
    path.write_text("".join(f"{a};{-a};1\n" for a in VALUES))
    status, _, err = rocking("record", path, "--units", "g", "--column", "2")
    assert status == 2 and "one column" not in err and "sampling is not uniform" in err
    status, out, _ = rocking("record", path, "--units", "g", "--column", "2", "--dt", "0.02", "--json", "-")
    channel = json.loads(out)["channels"][0]
    assert status == 0 and channel["peak"] == pytest.approx(1.5 * G)
    assert (channel["units"], channel["units_from"], channel["dt"]) == ("g", "units", 0.02)


def test_spectrum_is_that_of_the_equation_of_motion():
    """A long harmonic motion makes an oscillator in resonance swing 1/(2 zeta) times as far as a force at rest."""
    period = PERIODS[70]
    dt = period / 100
    result = spectrum(SampledMotion(dt, np.sin(2 * np.pi * dt / period * np.arange(6000))))
    assert result[70] == pytest.approx(1 / (2 * DAMPING), rel=2e-3)
    assert 1 < result[0] < 1 + PERIODS[0] / period  # a stiff one moves with the ground, but for its own start
