"""Step and unit stated in other words, formats by networks, and files that are refused by name."""

import numpy as np
import pytest
from made_up_records import SMOOTH, VALUES, cwa, dyna, jma, turkey
from record_files import FORMATS, RECORDS, assert_refused, needs_records, write

from analytic.errors import SceneError
from analytic.records import G, read_channels, read_record
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


@pytest.mark.parametrize("words, sentence", [*ODD.items(), ("scale factor 1.0", "")])
def test_what_is_odd_in_a_header_is_a_warning(tmp_path, words, sentence):
    warnings = read_record(write(tmp_path, f"# {words}\n# dt = .01 s\n{ONE_COLUMN}"), "m/s2").warnings
    assert len(warnings) == bool(sentence) and all(sentence in warning for warning in warnings)


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
    channels = [(channel.direction, channel.motion.dt, channel.unit.factor) for channel in read_channels(path)]
    assert channels == [(name, step, 0.01) for name in names]
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
    for options in ({}, {"dt": 0.02}, {"column": 2}):
        assert_refused(path, f"line 1, title = {first!r}: is ", **options)
        assert_refused(path, ", not a time; ", **options)


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
        ("acc_top_of_pier_cms2", "cm/s2"),
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


# Record readers: small records written here, and the real ones where they are.


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


TIMED = "".join(f"\n{i / 200} {a}" for i, a in enumerate(SAMPLES))
LETTERS = [*"\u00ddç¿$~%&+*\\?@^`}.x_-!#", "\u0411", "\u00b5"]
DAMAGED = [f"# time [s] acceleration [{letter}m/s2]" for letter in [*LETTERS, "0", "."]]
DAMAGED += [f"# time, acc ({letter}m/s^2)" for letter in [*LETTERS, "0", "."]] + [
    f"# {letter}m/s/s" for letter in LETTERS
]


@pytest.mark.parametrize("header", ["# 0m/s/s", "# Vs30 = 360 m/s", "# g = 9.81m/s2", "# peak 1.2 m/s/s"])
def test_what_stands_behind_a_number_is_no_unit_of_the_record(tmp_path, header):
    path = write(tmp_path, header + TIMED)
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
    path = write(tmp_path, header + TIMED)
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
    path = write(tmp_path, header + TIMED)
    for units in (None, "cm/s2", "g"):
        assert_refused(path, word, units=units)
        assert_refused(path, more, units=units)


def test_a_column_is_named_as_the_file_writes_it(tmp_path):
    path = write(tmp_path, "時間(s) 加速度（ガル） 東西（伽）" + TIMED.replace("\n", " 1\n")[2:] + " 1")
    for column, number in (("加速度（ガル）", "2"), ("加速度", "2"), ("東西(伽)", "3")):
        assert read_record(path, column=column).label.startswith(f"record, column {number}")


@pytest.mark.parametrize("header", ["時間(s) 加速度(東西)", "t a(С-Ю)", "t a(90º)"])
def test_a_direction_in_another_script_is_no_unit(tmp_path, header):
    assert read_record(write(tmp_path, header + TIMED), "g").peak == pytest.approx(1.5 * G)


@pytest.mark.parametrize("units, factor", [("m/s2", 1.0), ("cm/s2", 0.01), ("g", G)])
@pytest.mark.parametrize("row", ["{t:8.4f} {a:14.6E}", "{t},{a}", "{t}\t{a}  # remark"])
def test_two_columns(tmp_path, units, factor, row):
    text = "# time acceleration\n" + "\n".join(row.format(t=i / 200, a=a) for i, a in enumerate(SAMPLES))
    motion = read_record(write(tmp_path, text), units)
    assert motion.dt == pytest.approx(0.005, rel=1e-12)
    np.testing.assert_allclose(motion.samples, np.array(SAMPLES) * factor, rtol=1e-15)


COUNTED = AT2_TOP + "NPTS= 4, DT= .02 SEC\n"
BAD = {
    "empty": ("", None, "record: is empty; give a record with at least two accelerations"),
    "blank": (" \r\n\n", None, "record: is empty"),
    "no samples": (COUNTED.replace("4", "0"), None, "record: holds 0 samples; give at least two"),
    "one sample": ("0 1\n", "g", "record: holds 1 samples"),
    "short": (COUNTED + "1 2 3\n", None, "line 4, NPTS = 4: but 3 samples follow; the file is cut or damaged"),
    "long": (COUNTED + "1 2 3\n4 5", None, "line 4, NPTS = 4: but 5 samples follow"),
    "old header with a second step": (AT2_TOP + "4 .005 NPTS, DT= .01\n1 2 3 4\n", None, "'4 .005 NPTS': not a number"),
    "old header, number stuck to a word": (AT2_TOP + "4 .005NPTS, DT\n1 2 3 4\n", None, "'4 .005NPTS': not a number"),
    "NaN in AT2": (COUNTED + "1 2\n3 NaN\n", None, "line 6 = 'NaN': not finite; mend or remove it"),
    "infinite in AT2": (COUNTED + "1 2\n3 -Inf\n", None, "line 6 = '-Inf': not finite"),
    "stars": (COUNTED + "1 2 3 *******\n", None, "line 5 = '*******': not a number"),
    "dt of zero": (
        COUNTED.replace(".02", ".00") + "1 2 3 4",
        None,
        "line 4, step = 0.0: not a sampling interval or rate",
    ),
    "unreadable dt": (
        COUNTED.replace(".02", "?") + "1 2 3 4",
        None,
        "line 4, step = 'NPTS= 4, DT= ? SEC': its sampling",
    ),
    "unreadable count": (COUNTED.replace("NPTS= 4", "NPTS= many") + "1 2 3 4", None, "NPTS = 'many': not a number of"),
    "velocity": (
        COUNTED.replace("UNITS OF G", "UNITS OF CM/S") + "1 2 3 4",
        None,
        "line 3, unit = 'CM/S': not an acceleration in a unit that is known; write one of",
    ),
    "AT2 with other units": (
        COUNTED + "1 2 3 4",
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
    "step of days": (COUNTED.replace(".02", "86400.") + "1 2 3 4", None, "not a sampling interval of a ground motion"),
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
    """OpenSees reads such files; the last line may be shorter."""
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


@pytest.mark.parametrize("text, options, message", BAD_COLUMNS.values(), ids=BAD_COLUMNS)
def test_columns_refused(tmp_path, text, options, message):
    assert_refused(write(tmp_path, text), message, **{"units": "m/s2"} | options)


@pytest.mark.parametrize(
    "text, column, values",
    [
        (STEEP, 2, [-2 * value for value in SMOOTH]),
        ("0 2\n0 3\n1 2\n1 4\n", 1, [0, 0, 1, 1]),  # times would rise
    ],
)
def test_channels_side_by_side_are_read_when_one_is_chosen(tmp_path, text, column, values):
    assert read_record(write(tmp_path, text), "m/s2", dt=0.01, column=column).samples.tolist() == values


@pytest.mark.parametrize("samples", [17_000, 39_996])
def test_times_of_six_digits_that_are_half_a_unit_off_are_those_of_a_whole_frequency(tmp_path, samples):
    """LabVIEW writes 800 Hz so: 16.03125 s stands there as 16.0312, and one step alone fits all times."""
    text = "Time [s]\tAmplitude\n" + "".join(f"{k / 800:.6g}\t{(-1) ** k * 0.1}\n" for k in range(samples))
    assert read_record(write(tmp_path, text), "g").dt == 1 / 800
