"""Titles of columns: what each names, and its unit."""

import pytest
from record_files import assert_refused, write

from analytic.errors import SceneError
from analytic.records import read_record
from analytic.records.table import Titles, kinds_of, with_unit

ROWS = "".join(f"{0.02 * i:.2f},{(-1) ** i * i / 10:.2f},{i % 3 - 1}\n" for i in range(12))
TWO = "".join(",".join(row.split(",")[:2]) + "\n" for row in ROWS.splitlines())
PERIODS = "Period (s)|PERIOD|Periods|Tn [s]|T_n|T0|Per.|Periodo (s)|Periode [s]|Période|Periyot|Natural period"
FREQUENCIES = "Freq (Hz)|Frequency|FREQUENCIES|f [Hz]|f|Hz|x [Hz]|frecuencia|Frequenz|Fréquence|frekans|omega (rad/s)"
SPECTRAL = "Sa|SA (g)|PSa_g|PSA [g]|Sv|SD (cm)|pseudo-acceleration (g)|RotD50|Arias (%)|Arias Intensity (%)|CAV|PGV"
MOVEMENTS = (
    "Vel.|Vel./Elastic|velocity|Veloc (cm/s)|Dsp.|Disp.|displ|Displacement [mm]|Geschwindigkeit|Verschiebung|vitesse"
    "|desplazamiento|déplacement|hız|Fourier amplitude|drift|Force (kN)|Gyro_x|x_cms|x (cm)"
)


@pytest.mark.parametrize("first", (PERIODS + "|" + FREQUENCIES).split("|"))
def test_a_period_or_a_frequency_is_no_time(tmp_path, first):
    path = write(tmp_path, f"{first},acc (g)\n{TWO}")
    for said in ({}, {"column": 2}, {"dt": 0.02}):
        assert_refused(path, f"line 1, title = {first!r}: is a ", **said)
        assert_refused(path, ", not a time; ", **said)


def test_periods_that_fall_are_no_times_either(tmp_path):
    text = "".join(f"{1 / (1 + i):.3f},{(-1) ** i}.5\n" for i in range(9))
    assert_refused(write(tmp_path, f"x,Period\n{text}"), "title = 'Period': is a period, not a time", units="g")
    assert_refused(write(tmp_path, f"Period,a\n{text}"), "title = 'Period': is a period", units="g", dt=0.1)


@pytest.mark.parametrize("first", ["T", "T (s)", "t", "Time"])
@pytest.mark.parametrize("second", SPECTRAL.split("|"))
def test_t_beside_an_ordinate_of_a_spectrum_is_a_period(tmp_path, first, second):
    timed = "is of a spectrum or an intensity, not an acceleration"
    path = write(tmp_path, f"{first},{second}\n{TWO}")
    assert_refused(path, timed if first == "Time" else "is a period, not a time", units="g")


@pytest.mark.parametrize("titles", ["T,acc (g)", "T [s],a [g]", "t,x (g)", "t_s,NS_g", "T (s),Acceleration (g)"])
def test_t_beside_an_acceleration_is_a_time(tmp_path, titles):
    assert read_record(write(tmp_path, f"{titles}\n{TWO}")).dt == 0.02


def test_t_under_a_header_that_names_a_spectrum_is_a_period_unless_ordinates_are_negative(tmp_path):
    text = f"# 5% damping\n# Response spectrum\nT,a (g)\n{TWO}"
    assert read_record(write(tmp_path, text)).dt == 0.02
    text = text.replace("-", "")
    assert_refused(write(tmp_path, text), "line 3, title = 'T': is a period, not a time")
    assert read_record(write(tmp_path, text.replace("T,", "time,"))).dt == 0.02


@pytest.mark.parametrize("first", ["PGA (g)", "Displacement (mm)", "x [m]", "Depth", "Load", "Story"])
def test_a_first_column_of_another_quantity_that_rises_is_no_time(tmp_path, first):
    path = write(tmp_path, f"{first},acc (g)\n{TWO}")
    for said in ({}, {"dt": 0.02}):
        assert_refused(path, f"line 1, title = {first!r}: is ", **said)
        assert_refused(path, ", not a time; ", **said)


@pytest.mark.parametrize(
    "first", ["time [ms]", "RelativeTime(ms)", "timestamp_ms", "elapsed_ms", "ms", "t/ms", "x [ms]"]
)
def test_milliseconds_of_any_title(tmp_path, first):
    text = f"{first},acc (g)\n" + "".join(f"{20 * i},{(-1) ** i}.5\n" for i in range(9))
    assert read_record(write(tmp_path, text)).dt == 0.02
    assert_refused(write(tmp_path, text.replace("ms", "min", 1)), "not a time in s or ms; write the times in seconds")


@pytest.mark.parametrize("second", (SPECTRAL + "|" + MOVEMENTS).split("|"))
def test_another_quantity_is_no_acceleration(tmp_path, second):
    for units in (None, "g"):
        assert_refused(write(tmp_path, f"time,{second}\n{TWO}"), "not an acceleration", units=units)


def test_letters_stand_for_velocity_and_displacement_beside_an_acceleration_alone():
    assert kinds_of(Titles(1, ("t", "a", "v", "d")), False)[1:] == ["an acceleration"] + 2 * [
        "a velocity, a displacement or another quantity"
    ]
    assert kinds_of(Titles(1, ("t", "n", "e", "v")), False) == ["the time", "", "", ""]


def test_the_only_acceleration_is_named_where_others_stand_beside_it(tmp_path):
    path = write(tmp_path, "Time,Vel.,Acc\n" + ROWS)
    assert_refused(path, "motion.column: missing; not all columns are accelerations", units="g")
    assert_refused(path, "; add column, 3 (Acc)", units="g")
    assert_refused(path, "title = 'Vel.': is a velocity", units="g", column=2)
    assert len(read_record(path, "g", column=3).samples) == 12


@pytest.mark.parametrize(
    "title, unit",
    [
        *((title, "cm/s2") for title in ("acc_cms2", "ACC_CM_S2", "acc (cms2)", "a_cmps2", "acc_cm_per_s2", "a cms²")),
        *((title, "m/s2") for title in ("a_ms2", "a_mps2", "acc_m_s2", "acc [ms²]")),
        *((title, "g") for title in ("acc_g", "acceleration_in_g", "acc/g", "NS, g", "x g", "g")),
        *((title, "gal") for title in ("NS_gal", "EW: gal", "gal")),
        ("a_mms2", "mm/s2"),
        ("acc_fts2", "ft/s2"),
        ("x_cms", "cm/s"),
        ("v_mps", "m/s"),
    ],
)
def test_a_unit_in_a_title(title, unit):
    assert unit in with_unit(Titles(1, ("time", title)), 1).lower()


@pytest.mark.parametrize(
    "title",
    "acc (N-S)|acc (corrected)|U(+)|a(t)|acc (090)|acc [raw]|acc (HNE)|acc (top of pier)|acc_in|acc2|Motion of block G"
    "|acc_top".split("|"),
)
def test_what_is_no_unit_is_none(title):
    assert with_unit(Titles(1, ("time", title)), 1) == title


@pytest.mark.parametrize(
    "title, word",
    [
        ("acc [lsb]", "lsb"),
        ("acc (counts)", "counts"),
        ("acc (V)", "V"),
        ("x [s]", "s"),
        ("acc (g*1000)", "g*1000"),
        ("acc (10^-3 g)", "10^-3 g"),
        ("acc_foo2", "foo2"),
        ("acc_um_s2", "s2"),
        ("acc_counts", "counts"),
        ("counts", "counts"),
        ("acc (%)", "%"),
        ("acc [.g]", ".g"),
    ],
)
def test_a_word_that_may_be_a_unit_is_asked_about(title, word):
    with pytest.raises(SceneError) as caught:
        with_unit(Titles(1, ("time", title)), 1)
    assert f"{word!r} may be a unit" in str(caught.value) and "take it out of the title" in str(caught.value)


def test_titles_that_differ_in_a_number_alone_are_numbered():
    assert with_unit(Titles(1, ("time", "acc_box1", "acc_box2")), 2) == "acc_box2"


@pytest.mark.parametrize("sign", ["", "-"])
def test_accelerations_of_one_sign_are_odd(tmp_path, sign):
    """A spectrum without titles, or a constant offset."""
    text = "".join(f"{0.05 * i:.2f} {sign}{1 + i % 3}\n" for i in range(9))
    (warning,) = read_record(write(tmp_path, text), "m/s2").warnings
    assert "all accelerations have one sign: check that they are no spectrum and have no offset" in warning
