"""What headers say of step and unit in other words, formats by networks, and files that are refused by their names."""

import numpy as np
import pytest
from made_up_records import VALUES, cwa, jma, turkey
from record_files import assert_refused, write

from analytic.errors import SceneError
from analytic.records import read_channels, read_record
from analytic.records.statements import read_statements, stated_count, stated_unit
from analytic.records.table import Titles, kinds_of, with_unit

ONE_COLUMN = "".join(f"{value:.4f}\n" for value in VALUES)
THREE = "".join(f"{value:9.3f} {-2 * value:9.3f} {value / 2:9.3f}\n" for value in VALUES)


@pytest.mark.parametrize(
    "words, step",
    [
        ("Sampling rate: 200 Hz", 0.005),
        ("sample_rate_hz = 200", 0.005),
        ("SampleRate(Hz): 200", 0.005),
        ("Digitization rate (samples/s): 200", 0.005),
        ("fs=200", 0.005),
        ("Time step: 5 ms", 0.005),
        ("DELTA T = 0.005 SEC", 0.005),
        ("delta_t [ms]: 5", 0.005),
        ("Frecuencia de muestreo: 200 Hz", 0.005),
        ("INTERVALO DE MUESTREO (s) : 0,005", 0.005),
        ("Paso de tiempo = 5 milisegundos", 0.005),
        ("Tasa de muestreo: 200 muestras por segundo", 0.005),
        ("Sampling rate: 120 Hz, dt = 0.0083 s", 1 / 120),
        ("Time Step: 0.005", 0.005),
        ("TIME INCREMENT = .005", 0.005),
        ("EQUALLY SPACED INTERVALS OF:  0.005  SEC", 0.005),
        ("Δt = 0,005 s", 0.005),
        ("Data interval: 0.005 s", 0.005),
        ("Acquisition rate (Hz): 200", 0.005),
        ("DT= .005 UNIT= m/s2", 0.005),
    ],
)
def test_a_step_in_words(tmp_path, words, step):
    path = write(tmp_path, f"# {words}\n{ONE_COLUMN}")
    motion = read_record(path, "m/s2")
    assert motion.dt == step and motion.samples.tolist() == VALUES and not motion.warnings
    assert_refused(path, "motion.dt = 0.01: but the step of the record itself is", units="m/s2", dt=0.01)


# Sentences, other languages, and keys without a sign.
NOT_READ = """
SAMPLING FREQUENCY 200.0 HZ
200 samples per second
recorded at 200 sps
Sampled at 200 Hz, filtered
TIME INTERVAL (SEC) .005
delta: 0.005
samprate 200
sampled every 0.005 s
interval_ms=5
time base 0.005 s
sampling period is 0,005 s
equally spaced at .005 sec
Abtastrate: 200 Hz
Zeitschritt: 0,005 s
Abtastintervall [ms] 5,0
Fréquence d'échantillonnage : 200 Hz
Frequence d’echantillonnage: 200 Hz
pas de temps (s) 0,005
Örnekleme frekansı: 200 Hz
ÖRNEKLEME ARALIĞI (sn) : 0,005
zaman adimi: 0.005 saniye
sampling rate .005 sec
time interval between samples: 5 ms
SPS: 200
samples per second = 200
Step (s): 0.005
record 12; interval 5 ms
Sampling: 200 Hz
recorded at 0.005 sec. intervals
200-Hz sampling, corner at .1 s
lowpass 25 Hz sampling rate 200 Hz
Paso temporal: 0,005 s
Incremento de tiempo = 0,005
Abtastung: 200 Hz
Zeitabstand: 5 ms
Échantillonnage : 200 Hz
Örnekleme: 200 Hz
Sampling interval fs 200
""".strip().splitlines()


@pytest.mark.parametrize("words", NOT_READ)
def test_a_step_in_a_sentence_is_asked_for(tmp_path, words):
    path = write(tmp_path, f"# {words}\n{ONE_COLUMN}")
    assert_refused(path, "add dt, the step in s", units="m/s2")
    (warning,) = read_record(path, "m/s2", dt=0.005).warnings
    assert "line 1 speaks of sampling in words that are not understood" in warning


@pytest.mark.parametrize(
    "words, problem",
    [
        ("Sampling rate: fast", "no number"),
        ("Sampling rate: 1,000 Hz", "thousands"),
        ("Sampling rate: 0.5", "a rate below 1, without a unit"),
        ("Sampling interval: 5 m", "not a time in s or ms"),
        ("Sampling interval: 0 s", "give one above 0"),
        ("Sampling rate: 100 Hz, dt = 0.02 s", "states a step of 0.01 s"),
        ("dt = 0.02 s, dt = 0.0204 s", "states a step of 0.02 s"),
    ],
)
def test_a_faulty_statement_is_refused(tmp_path, words, problem):
    assert_refused(write(tmp_path, f"# {words}\n{ONE_COLUMN}"), problem, units="m/s2", dt=0.01)


@pytest.mark.parametrize("words", ["corner at 200 Hz", "Sampling interval of channel 2, in s: 0.005"])
def test_what_is_not_understood_of_the_sampling_is_a_warning_where_the_user_gives_the_step(tmp_path, words):
    path = write(tmp_path, f"# {words}\n{ONE_COLUMN}")
    (warning,) = read_record(path, "m/s2", dt=0.01).warnings
    assert "line 1" in warning and "not understood" in warning
    stated = write(tmp_path, f"# {words}\n# dt = .01 s\n{ONE_COLUMN}")
    assert not read_record(stated, "m/s2").warnings


@pytest.mark.parametrize(
    "words",
    ["Significant interval: 5 s", "rate: 5", "pas de filtre", "steps of 5 m", "step 1", "Duracion de muestreo: 60 s"],
)
def test_a_mere_word_states_no_step_without_its_unit_or_behind_others(words):
    assert read_statements([(1, words)]).step is None


@pytest.mark.parametrize(
    "words, count",
    [
        ("NO. OF POINTS:     40  EQUALLY SPACED", 40),
        ("Number of Data                : 40", 40),
        ("NUMBER OF DATA POINTS = 40", 40),
        ("NPTS = 40", 40),
        ("samples: 40", 40),
        ("Número de muestras: 40", 40),
        ("Anzahl der Werte: 40", 40),
        ("Nombre d'échantillons : 40", 40),
        ("Veri sayısı: 40", 40),
        ("number of points 40.5", None),
        ("no. of points: 40, no. of data: 80", None),
        ("samples of soil 3", None),
    ],
)
def test_a_number_of_samples_in_words(words, count):
    assert stated_count([(1, words)]) == count


NOT_TAKEN = "line 1 names a factor, and the numbers are taken without it: # "
FACTORS = ("Scale factor: 981", "Factor = 0.01", "multiply by 9.81", "Skalierungsfaktor: 1e-3")
ODD = {words: NOT_TAKEN + words for words in FACTORS} | {
    "number of points: 40": "the header states 40 samples, the data have 12: check that the file is whole"
}


@pytest.mark.parametrize("words, said", [*ODD.items(), ("scale factor 1.0", "")])
def test_what_is_odd_in_a_header_is_a_warning(tmp_path, words, said):
    found = read_record(write(tmp_path, f"# {words}\n# dt = .01 s\n{ONE_COLUMN}"), "m/s2").warnings
    assert len(found) == bool(said) and all(said in warning for warning in found)


@pytest.mark.parametrize("comment", ["# Sampling rate: 50 Hz", "# acceleration [g]"])
def test_a_statement_inside_the_data_is_refused(tmp_path, comment):
    head = f"# dt = .01 s, acceleration [m/s2]\n{ONE_COLUMN}"
    assert_refused(write(tmp_path, f"{head}{comment}\n{ONE_COLUMN}"), "a statement inside the data")
    assert len(read_record(write(tmp_path, f"{head}# a remark\n{ONE_COLUMN}")).samples) == 2 * len(VALUES)


@pytest.mark.parametrize(
    "line, titles, word",
    [
        ("AmplitudeUnit:  gal. DCoffset(corr)", None, "gal"),
        ("UNIT  = gal(cm/s/s)", None, "gal(cm/s/s)"),
        ("RAW PGA VALUES (gal) : (N-S) 12.5", None, "gal"),
        ("Unidades: cm/s2", None, "cm/s2"),
        ("Einheit: mm/s²", None, "mm/s²"),
        ("Birim: gal", None, "gal"),
        ("Ivme (g)", None, "g"),
        ("NS_gal", 1, "gal"),
        ("acc_g", 1, "g"),
        ("NS_gal", None, None),
        ("mass (g)", None, None),
        ("Acceleration, g", None, "g"),
        ("Units: sec, g", None, "g"),
        ("UNITS ARE SECONDS AND CM/S2", None, "CM/S2"),
    ],
)
def test_units_in_words(line, titles, word):
    unit = stated_unit(read_statements([(1, line)]).rest, titles)
    assert (unit and unit.word) == word


@pytest.mark.parametrize(
    "line, units",
    [
        ("UNITS ARE SECONDS AND G/10", "m/s2"),
        ("# Units: 0.01 gal", "m/s2"),
        ("acc in km/s2", "m/s2"),
        ("# µm/s^2", "m/s2"),
        ("Acc [nm/s**2]", "m/s2"),
        ("UNIT = gal(m/s/s)", None),  # two names that do not agree
    ],
)
def test_a_unit_that_is_not_known_is_refused_whatever_the_user_gives(tmp_path, line, units):
    assert_refused(write(tmp_path, f"{line}\n{ONE_COLUMN}"), "not an acceleration", units=units, dt=0.01)


NETWORKS = {
    "Japan": (jma(VALUES), ("NS", "EW", "UD"), (1, -0.5, 0.01), 0.01),
    "Taiwan": (cwa(VALUES), ("U", "N", "E"), (0.1, 1, -0.01), 0.005),
    "Turkey": (turkey(VALUES), ("N-S", "E-W", "U-D"), (1, -0.5, 0.01), 0.02),
}


@pytest.mark.parametrize("text, names, factors, step", NETWORKS.values(), ids=NETWORKS)
def test_columns_of_networks(tmp_path, text, names, factors, step):
    path = write(tmp_path, text)
    found = [(one.direction, one.motion.dt, one.unit.factor) for one in read_channels(path)]
    assert found == [(name, step, 0.01) for name in names]
    first = 2 if names[0] == "U" else 1
    for place, (name, factor) in enumerate(zip(names, factors, strict=True), first):
        for column in (place, str(place), name, name.lower()):
            np.testing.assert_allclose(read_record(path, column=column).samples, np.array(VALUES) * factor, atol=6e-6)
    assert_refused(path, "motion.column: missing; the file holds columns")
    assert_refused(path, f"motion.column = 'Z': but the file has {first + 2} columns; give column, ", column="Z")
    assert_refused(path, "motion.units = 'g': but the record carries its own unit, gal", units="g", column=3)


AT2 = "PEER\nMADE UP\nACCELERATION TIME HISTORY IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n .1250E+00 -.2500E-01  .1000E+00 "
DYNA = "EVENT_NAME: X\nSAMPLING_INTERVAL_S: 0.01\nUNITS: cm/s^2\nNDATA: 4\n1.250000\n-2.500000\n1.000000\n"
KNET = (
    "Origin Time 0\nSampling Freq(Hz)100Hz\nDuration Time(s)  0.06\nDir. E-W\n"
    "Scale Factor 2000(gal)/8000000\nMemo.\n   12500     -300      120 \n"
)


@pytest.mark.parametrize(
    "head, sound, broken",
    [
        (f"# dt = .01 s, acceleration [m/s2]\n{ONE_COLUMN}", "0.1250\n", ["0.12", "0.125e"]),
        (
            AT2,
            " .3750E+00\n",
            [" .3750\n", " .375E+00\n", " .3750E+0", " .37505E+00\n", "3.37.50E+00\n", "12.3750E+00\n"],
        ),
        (DYNA, "3.750000\n", ["3.75", "3.7500000\n", "3.750000E1\n", "3\n"]),
        (KNET, "   12500     -300      120 ", ["   12500     -300      12", "   12500     -30      120 "]),
    ],
    ids=["a column", "PEER", "DYNA", "K-NET"],
)
def test_a_damaged_number_is_told_by_the_form_of_the_others(tmp_path, head, sound, broken):
    read_record(write(tmp_path, head + sound))
    for text in broken:
        with pytest.raises(SceneError, match="damaged|cut|not a number|without a blank"):
            read_record(write(tmp_path, head + text))


def test_a_sign_that_is_lost_from_a_column_is_told_by_the_length_of_the_line(tmp_path):
    rows = [" .1250E+00 -.2500E-01  .1000E+00\n"] * 4
    text = "PEER\nMADE UP\nACCELERATION TIME HISTORY IN UNITS OF G\nNPTS= 12, DT= .01 SEC\n"
    assert len(read_record(write(tmp_path, text + "".join(rows))).samples) == 12
    rows[1] = rows[1].replace("-.25", ".25")
    assert_refused(write(tmp_path, text + "".join(rows)), "not as long as all other lines")


@pytest.mark.parametrize(
    "name, text",
    [
        ("GeoNet", "Uncorrected accelerogram 20160214_001343_NBLC_20 GNS Science\nSite NBLC\n1 2\n"),
        ("GeoNet", "Corrected accelerogram   20160214_001343_NBLC_20 GNS Science\nSite NBLC\n1 2\n"),
        ("UNAM/ASA", "*******\n  INSTITUTE\n*******\nARCHIVO ESTANDAR DE ACELERACION:\n1 2\n"),
        ("BHRC", "* VOL1DS FILE:  0000/01\n1 2\n"),
        ("SAC", b"\0" * 304 + b"\x06\0\0\0" + b"\0" * 400),
        ("miniSEED", b"000001D ABC  00HNE" + b"\0" * 500),
        ("miniSEED", b"MS\x03\x00" + b"\0" * 500),
        (
            "SLIST",
            "TIMESERIES XX_AA_20_HNE_D, 4 samples, 50 sps, 2001-01-01T00:00:00.0, SLIST, FLOAT, M/S**2\n1 2 3 4\n",
        ),
        ("TSPAIR", "TIMESERIES XX_AA__HNE_R, 4 samples, 50 sps, 2001-01-01T00:00:00.0, TSPAIR, FLOAT, Counts\n1 2\n"),
        ("GeoCSV", "# dataset: GeoCSV 2.0\n# delimiter: ,\nTime, Sample\n"),
        ("CSMIP volume 1", "UNCORRECTED ACCELEROGRAM DATA\n1 2\n"),
        ("CSMIP volume 3", "Response Spectra  00000-X0000\n1 2\n"),
        ("CSMIP volume 3", "RESPONSE AND FOURIER AMPLITUDE SPECTRA\n1 2\n"),
        ("COSMOS volume 0", "Raw acceleration counts   (Format v01.20 with 13 text lines)\n1 2\n"),
    ],
)
def test_a_known_format_that_is_not_read_is_refused_by_its_name(tmp_path, name, text):
    assert_refused(write(tmp_path, text), f"is a {name} file, which is not read; ", units="g", dt=0.01)


# Titles of columns: what each names, and its unit.
ROWS = "".join(f"{0.02 * i:.2f},{(-1) ** i * i / 10:.2f},{i % 3 - 1}\n" for i in range(12))
TWO = "".join(",".join(row.split(",")[:2]) + "\n" for row in ROWS.splitlines())
PERIODS = "Period (s)|PERIOD|Periods|Tn [s]|T_n|T0|Per.|Periodo (s)|Periode [s]|Période|Periyot|Natural period"
FREQUENCIES = "Freq (Hz)|Frequency|FREQUENCIES|f [Hz]|f|Hz|x [Hz]|frecuencia|Frequenz|Fréquence|frekans|omega (rad/s)"
OTHERS = "PGA (g)|Displacement (mm)|x [m]|Depth|Load|Story"
SPECTRAL = "Sa|SA (g)|PSa_g|PSA [g]|Sv|SD (cm)|pseudo-acceleration (g)|RotD50|Arias (%)|Arias Intensity (%)|CAV|PGV"
MOVEMENTS = (
    "Vel.|Vel./Elastic|velocity|Veloc (cm/s)|Dsp.|Disp.|displ|Displacement [mm]|Geschwindigkeit|Verschiebung|vitesse"
    "|desplazamiento|déplacement|hız|Fourier amplitude|drift|Force (kN)|Gyro_x|x_cms|x (cm)"
)


@pytest.mark.parametrize("first", f"{PERIODS}|{FREQUENCIES}|{OTHERS}".split("|"))
def test_a_period_a_frequency_or_another_quantity_that_rises_is_no_time(tmp_path, first):
    path = write(tmp_path, f"{first},acc (g)\n{TWO}")
    for said in ({}, {"dt": 0.02}, {"column": 2}):
        assert_refused(path, f"line 1, title = {first!r}: is ", **said)
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
