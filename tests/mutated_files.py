"""Small records and scenes, made up here, and what damage makes of them: the same for the same seed."""

import itertools
import math
import random

VALUES = [0.001, -0.123, -0.456, 0.25, -1.5, 0.0, 0.75, 0.031, -0.2, 0.11, 0.4, -0.33]
SMOOTH = [round(math.sin(0.3 * i) * math.exp(-0.02 * i), 4) for i in range(46)]


def _lines(words, per_line):
    return "".join("".join(words[i : i + per_line]) + "\n" for i in range(0, len(words), per_line))


def _fortran(values, width=15, digits=7, exponent=2):
    parts = [f"{value:.{digits}E}".split("E") for value in values]
    return _lines([f"{part}E{int(power):+0{exponent + 1}d}".rjust(width) for part, power in parts], 5)


def _at2(third, fourth, data):
    return f"PEER STRONG MOTION DATABASE\nMADE UP, 01/01/00, NOWHERE, 000\n{third}\n{fourth}\n{data}"


def _dyna(values):
    head = f"""\
EVENT_NAME: MADE UP
EVENT_DATE_YYYYMMDD: 20000101
STATION_ELEVATION_M: 746.0
VS30_M/S: 294
SAMPLING_INTERVAL_S: 0.005000
NDATA: {len(values)}
UNITS: cm/s^2
PGA_CM/S^2: -150.000000
HEADER_FORMAT: DYNA 1.2
DATA_TYPE: ACCELERATION
USER5: \n"""
    return head + "".join(f"{100 * value:.6f}\n" for value in values)


def _rows(row, step=0.005, origin=0.0, count=24):
    return "".join(row.format(t=origin + i * step, a=VALUES[i % 12]) + "\n" for i in range(count))


def csmip(values, step=".005", layout="8f10.5", words="in cm/sec2."):
    """Three channels of volume 2, 25 lines of text each; velocities and displacements as long as the accelerations."""
    names, text, count = ("90 Deg", "Up", "H1"), "", len(values)
    for number, name in enumerate(names, 1):
        samples = [100 * value * number for value in values]
        data = _columns(samples, 8, 10, int(layout[-1]))
        text += (
            f"Corrected accelerogram   00000-X0000-00000.00       Chan  {number}: {name:10s}from\n"
            "Uncorrected Accelerogram Data             Processed: 01/01/00\n"
            + ("Nowhere\n" * 13)
            + f" {count} points of instrument- and baseline-corrected accel, veloc and displ data\n"
            f"At equally-spaced intervals of {step} sec.\n"
            f"Peak acceleration = {max(samples, key=abs):9.3f}    cm/sec/sec  at  .020   sec.\n"
            + "Nowhere\n" * 7
            + _columns(range(100), 16, 5)
            + _columns([0.0] * 60 + [float(step)] + [-999.0] * 39, 8, 10, 5)
            + f" {count} points of accel data equally spaced at {step} sec, {words} ({layout})\n{data}"
            f" {count} points of veloc data equally spaced at {step} sec, in cm/sec. ({layout})\n{data}"
            f" {count} points of displ data equally spaced at {step} sec, in cm. ({layout})\n{data}"
            f"/&  ----------  End of data for channel  {number}  ----------\n"
        )
    return text


def cosmos(
    values, layout="8F10.5", units="cm/sec2(04)", step=5.0, channels=("1:340 deg", "2:Up"), form=",", volume="Corrected"
):
    """Channels of COSMOS 1.20; the accelerations of the second one are twice those of the first.

    `form`: what stands between the unit and the word Format.
    """
    text = ""
    for times, name in enumerate(channels, 1):
        samples = [100 * value * times for value in values]
        reals = [-999.0] * 33 + [0.02] + [-999.0] * 27 + [step, step * len(values) / 1000, max(samples, key=abs), 0.02]
        words = [f"{value:15.6e}" for value in samples]
        text += (
            f"{volume} acceleration    (Format v01.20 with 13 text lines)\n"
            + "Nowhere\n" * 7
            + f"Sta Chan   {name} (Rcrdr Chan  1) Location:\n"
            + "Nowhere\n" * 4
            + " 100 Integer-header values follow on  10 lines, Format= (10I8)\n"
            + _columns([2, 1, 4, 120, 1] + [-999] * 95, 10, 8)
            + " 100 Real-header values follow on  20 lines, Format= (5F15.6)\n"
            + _columns(reals + [-999.0] * (100 - len(reals)), 5, 15, 6)
            + '   1 Comment line(s) follow, each starting with a "|":\n| made up\n'
            f"{len(values):8d} acceleration pts, approx    0 secs, units={units}{form}Format=({layout})\n"
            + (_columns(samples, 8, 10, 5) if layout.startswith("8") else _lines(words, 1))
            + f"End-of-data for Chan  {times} acceleration\n"
        )
    return text


def knet(counts, direction="E-W", frequency=200):
    """A K-NET file of 10 gals a million counts."""
    mean = sum(counts) / len(counts)
    return f"""\
Origin Time       2000/01/01 00:00:00
Lat.              0.0
Station Code      NWH001
Sampling Freq(Hz) {frequency}Hz
Duration Time(s)  {len(counts) / frequency:g}
Dir.              {direction}
Scale Factor      2000(gal)/200000000
Max. Acc. (gal)   {max(abs(count - mean) for count in counts) / 1e5:.3f}
Last Correction   2000/01/01 00:00:00
Memo.             \n""" + _lines([f"{count:8d} " for count in counts], 8)


def smc(values, high=False, rate=200.0, first="2 CORRECTED ACCELEROGRAM"):
    """A USGS SMC file [cm/s2] with two lines of comments; `high`: of the newer, longer numbers."""
    samples = [100 * value for value in values]
    integers = [-32768] * 48
    integers[15:18], integers[46] = (2, len(samples), 0), 8 if high else -32768
    reals = [1.7e38] * 50
    reals[1], reals[29], reals[31] = rate, max(samples), min(samples)
    per_line, width, digits = (5, 14, 7) if high else (8, 10, 4)
    words = [f"{value:.{digits}E}".replace("E+0", "E+").replace("E-0", "E-").rjust(width) for value in samples]
    text = f"{first}\n" + "*\n" * 5 + "station = Nowhere          component=    360\n" + "*\n" * 4
    return text + _columns(integers, 8, 10) + _fortran(reals) + "|\n| made up\n" + _lines(words, per_line)


def _columns(values, per_line, width, decimals=0):
    return _lines([f"{value:{width}.{decimals}f}" for value in values], per_line)


def cwa(values):
    """A file of Taiwan's weather administration: times and three components, the second the made-up one."""
    return (
        "#StationCode: X001\n#InstrumentKind: made up\n#StartTime: 2000/01/01-00:00:00.000\n"
        f"#RecordLength(sec): {len(values) / 200:g}\n#SampleRate(Hz): 200\n#AmplitudeUnit:  gal. DCoffset(corr)\n"
        "#AmplitudeMAX.  U: 1.0~ -1.0\n#DataSequence: Time U(+); N(+); E(+)\n#Data: 4F10.3\n"
    ) + "".join(
        f"{0.005 * i:10.3f}{10 * value:10.3f}{100 * value:10.3f}{-value:10.3f}\n" for i, value in enumerate(values)
    )


def jma(values, titles="NS,EW,UD"):
    """A CSV of Japan's weather agency."""
    return (
        "SITE CODE= 47000NOWHERE\nLAT.= 35.0\nLON.= 135.0\nSAMPLING RATE= 100Hz\nUNIT  = gal(cm/s/s)\n"
        f"INITIAL TIME = 2000 01 01 00 00 00\n{titles}\n"
    ) + "".join(f"{100 * value:.3f},{-50 * value:.3f},{value:.3f}\n" for value in values)


def knet_csv(values, offsets=(0.1, 1.7, 16.5), seconds=None):
    """A K-NET CSV of 50 Hz, times of one minute; its three components are the offsets and the values, 1, -2 and 3
    times, in 0.01 gal."""
    seconds = len(values) / 50 if seconds is None else seconds
    rows = [
        [f"2030/01/02 03:04:{15 + 0.02 * i:05.2f}", f"{0.02 * i:.2f}"]
        + [f"{offset + times * value:.2f}" for offset, times in zip(offsets, (1, -2, 3), strict=True)]
        for i, value in enumerate(values)
    ]
    return (
        "#K-NET CSV\n#Event\n#OriginTime,Depth(km),Magnitude\n#2030/01/02 03:04:00,31,7.0\n#Record\n"
        f"#SamplingFrequency(Hz)\n#50\n#DurationTime(s)\n#{seconds:g}\n#Offset\n#N-S(gal),E-W(gal),U-D(gal)\n"
        f"#{','.join(f'{offset:.2f}' for offset in offsets)}\n#Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)\n"
    ) + "".join(",".join(row) + "\n" for row in rows)


def csmnc(values):
    """A file of China's network [cm/s2] at 0.02 s."""
    return (
        "099XYZ300102030401\n0300102030415 2030-01-02 03:04:15 BTM\nMADE UP, NOWHERE\nCOMP. EW\n"
        "UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC\n"
        f"NO. OF POINTS: {len(values):6d}  EQUALLY SPACED INTERVALS OF:  0.02  SEC\n"
        "PRE-EVENT TIME:  0  SEC  RECORDER TIME:  2030-01-2 03:04:15.000 BTM\n"
    ) + _columns([100 * value for value in values], 8, 10, 3)


def corrected(values, step=0.005):
    """Corrected accelerations [m/s2] in 5E14.7, whose signs fill the columns."""
    return (
        "Station Code / Name           : 1 / Nowhere\nOrientation                   : NS\n"
        "Filter Cut-off Frequency (Hz) : 0.100 - 50.000\n"
        f"Time Increment (s)            : {step}\n"
        f"Number of Data                : {len(values)}\nAccelaration time series in m/s/s\n"
    ) + _fortran(values, 14)


def turkey(values):
    """Columns of Turkey's disaster management."""
    return (
        "STRONG GROUND MOTION RECORDS OF TURKEY\nPLACE                  : NOWHERE\n"
        f"NUMBER OF DATA         : {len(values)}\nSAMPLING INTERVAL (sec) : 0.02\n"
        "RAW PGA VALUES (gal)   : (N-S) 1.0 (E-W) 2.0 (U-D) 3.0\n\n       N-S        E-W        U-D\n"
    ) + "".join(f"{100 * value:11.6f}{-50 * value:11.6f}{value:11.6f}\n" for value in values)


TWICE, FALLING = VALUES * 2, [-0.005 * i for i in range(24)]
GAL, GRAVITY = 0.01, 9.81  # m/s2
# What headers say of the step, one of them of 1/256 s and the others of 5 ms
STATED = (
    "Sampling rate: 200 Hz",
    "SAMPLING_RATE (samples/s) = 200.0",
    "Digitization rate 200 sps",
    "recorded at 200 samples/sec",
    "fs = 200",
    "Sampled at 200.0 samples per second",
    "sampling interval is 5 ms",
    "Equally-spaced at 0.005 sec",
    "delta-t [s]: .005",
    "time step = 0,005 s",
    "Sample period (msec): 5.0",
    "Sampling rate: 256 Hz, sampling interval: .0039 s",
    "Frecuencia de muestreo: 200 muestras/s",
    "Tasa de muestreo = 200,0 Hz",
    "INTERVALO DE MUESTREO (seg): 0,005",
    "paso de tiempo: 5 milisegundos",
    "Abtastrate: 200 Hz",
    "Abtastfrequenz [Hz] = 200",
    "Zeitschritt = 0,005 Sekunden",
    "Abtastintervall: 5 ms",
    "Fréquence d'échantillonnage : 200 Hz",
    "Frequence d echantillonnage : 200,0 echantillons par seconde",
    "Pas de temps : 0,005 s",
    "Période d'échantillonnage (ms) = 5",
    "Örnekleme frekansı: 200 Hz",
    "ORNEKLEME FREKANSI : 200 ornek/s",
    "Örnekleme aralığı (sn): 0.005",
    "zaman adimi = 5 ms",
)
UNITS = {
    "acceleration [cm/s2]": GAL,
    "Units: gal": GAL,
    "NS_gal": GAL,
    "Unidades de los datos: cm/s/s": GAL,
    "Aceleración (gal)": GAL,
    "Einheit: m/s^2": 1,
    "Beschleunigung [mg]": GRAVITY / 1000,
    "Unités : g": GRAVITY,
    "İvme (cm/s²)": GAL,
    "birim: gal": GAL,
    "PGA [gal]": GAL,
}


def stated():
    """Lists and columns, as in `records`, whose headers say the step in words."""
    rows = _rows("{a:.4f}  -{t:.4f} 1.0")
    for at, (step, unit) in enumerate(zip(STATED, itertools.cycle(UNITS), strict=False)):
        column = {"column": ("EW", 1, "2", "ns")[at % 4], "units": "gal" if unit == "NS_gal" else None}
        comment = f"# {unit.replace('NS_gal', 'gal: units: gal')}\n# {step}\n"
        forms = (
            (f"{step}\n{unit}\n" + _rows("{a:.4f}"), {}, TWICE),
            (comment + _list(SMOOTH).rstrip("\n"), {}, SMOOTH),
            (f"{step}; {unit}\nNS  EW  UD\n{rows}", column, (FALLING, TWICE)[at % 2]),
        )
        text, said, numbers = forms[at % 3]
        yield f"words {at}", text, said, (numbers, UNITS[unit], 1 / 256 if "256" in step else 0.005)


def _list(values, per_line=6):
    parts = [values[i : i + per_line] for i in range(0, len(values), per_line)]
    return "".join(" ".join(f"{value:.5f}" for value in part) + "\n" for part in parts)


def records():
    """(name, text, what the user says, (numbers, unit [m/s2], step [s])) of undamaged records of every family.

    The names of those that are to be refused say so.
    """
    history, counts = "ACCELERATION TIME HISTORY IN UNITS OF G", "NPTS=    12, DT=   .0050 SEC"
    semicolons = _rows("{t:.3f};{a:.4f}").replace(".", ",")
    hundreds, below = [100 * one for one in VALUES], [-abs(one) - 0.01 for one in VALUES]
    return [
        ("at2", _at2(history, counts, _fortran(VALUES)), {}, (VALUES, GRAVITY, 0.005)),
        (
            "at2 old",
            _at2("ACCELERATION TIME SERIES IN UNITS OF CM/S/S", "    12    .00500  NPTS, DT", _fortran(VALUES)),
            {},
            (VALUES, GAL, 0.005),
        ),
        (
            "at2 ms",
            _at2("ACCELERATION (CM/SEC2)", "NPTS= 12, DT= 5.0 MSEC", _fortran(VALUES)),
            {},
            (VALUES, GAL, 0.005),
        ),
        ("at2 stuck", _at2(history, "NPTS=12,DT=5.0E-003", _fortran(below, 13)), {}, (below, GRAVITY, 0.005)),
        ("at2 long exponents", _at2(history, counts, _fortran(VALUES, 16, 7, 3)), {}, (VALUES, GRAVITY, 0.005)),
        (
            "at2 of given units",
            _at2("TIME HISTORY", counts, _fortran(VALUES)),
            {"units": "g"},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2 of velocities, refused",
            _at2("VELOCITY TIME HISTORY IN UNITS OF CM/S", counts, _fortran(VALUES)),
            {},
            (VALUES, GAL, 0.005),
        ),
        ("dyna", _dyna(VALUES), {}, (hundreds, GAL, 0.005)),
        ("blanks", _rows("{t:8.4f} {a:14.6E}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        (
            "comments",
            "# time acceleration\n" + _rows("{t:.3f}\t{a:.4f}  # remark"),
            {"units": "m/s2"},
            (TWICE, 1, 0.005),
        ),
        ("256 Hz", _rows("{t:.3f} {a:.4f}", 1 / 256), {"units": "g"}, (TWICE, GRAVITY, 1 / 256)),
        ("epoch", _rows("{t:.4f} {a:.4f}", origin=1.5e9), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("csv", "Time (s),Acceleration (cm/s^2)\n" + _rows("{t:.3f},{a:.4f}"), {}, (TWICE, GAL, 0.005)),
        ("csv ms", "time [ms],acc [g]\n" + _rows("{t:.1f},{a:.4f}", 5.0), {}, (TWICE, GRAVITY, 0.005)),
        ("semicolons", "t;a [m/s2]\n" + semicolons, {}, (TWICE, 1, 0.005)),
        ("decimal commas", semicolons.replace(";", "   "), {"units": "cm/s2"}, (TWICE, GAL, 0.005)),
        ("one column", "acceleration [cm/s2]\n" + _rows("{a:.4f}"), {"dt": 0.005}, (TWICE, GAL, 0.005)),
        ("one column, own step", "# dt = 5 ms\n" + _rows("{a:.4f}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("list", _list(SMOOTH), {"units": "g", "dt": 0.01}, (SMOOTH, GRAVITY, 0.01)),
        (
            "channels",
            "t [s];x (g);y (g);v (cm/s)\n" + _rows("{t:.3f};{a:.4f};-{t:.4f};1"),
            {"column": 3},
            (FALLING, GRAVITY, 0.005),
        ),
        (
            "tabs",
            "Time (s)\tx (g)\ty (g)\n" + _rows("{t:.3f}\t{a:.4f}\t-{t:.4f}"),
            {"column": 2},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "channels, no times",
            _rows("{a:.4f} -{t:.4f} 1"),
            {"units": "g", "dt": 0.01, "column": 2},
            (FALLING, GRAVITY, 0.01),
        ),
        ("csmip", csmip(VALUES), {"channel": 2}, ([2 * one for one in hundreds], GAL, 0.005)),
        (
            "csmip, upper case",
            csmip(VALUES, words="(UNITS: CM/SEC/SEC)", layout="8f10.3").upper(),
            {"channel": "up"},
            ([2 * one for one in hundreds], GAL, 0.005),
        ),
        (
            "csmip, touching",
            csmip([value - 1.6 for value in VALUES], ".0025", "8f10.5"),
            {"channel": "1"},
            ([one - 160 for one in hundreds], GAL, 0.0025),
        ),
        ("cosmos", cosmos(VALUES), {"channel": "Up"}, ([2 * one for one in hundreds], GAL, 0.005)),
        ("cosmos, one channel", cosmos(VALUES, "1E15.6", "g (2)", 5.0, ("?:Other",)), {}, (hundreds, GRAVITY, 0.005)),
        (
            "cosmos, no step",
            cosmos(VALUES, "1E15.6", "cm/s^2 (4)", -999.0),
            {"channel": 1, "dt": 0.005},
            (hundreds, GAL, 0.005),
        ),
        (
            "knet",
            knet([round(1e5 * value) - 12_000 for value in VALUES]),
            {},
            ([1e5 * one - 12_000 for one in VALUES], 1e-7, 0.005),
        ),
        (
            "kiknet",
            knet([round(1e6 * value) for value in VALUES], "5", 100),
            {"units": "cm/s2"},
            ([1e6 * one for one in VALUES], 1e-7, 0.01),
        ),
        ("smc", smc(VALUES), {}, (hundreds, GAL, 0.005)),
        ("smc, long numbers", smc(VALUES, high=True), {}, (hundreds, GAL, 0.005)),
        *changed(),
        *titled(),
    ]


def changed():
    """Records of what came last: steps in words, named columns, data as several services write them."""
    history, semicolons = "ACCELERATION TIME HISTORY IN UNITS OF G", _rows("{t:.3f};{a:.4f};1,0").replace(".", ",")
    small = [0.00012, 9.5e-05, 0, -0.0003, 1e-05, 0.25] * 4
    hundreds, volume_1 = [100 * one for one in VALUES], {"form": "     ", "volume": "Uncorrected"}
    return [
        (
            "cosmos, volume 1",
            cosmos(VALUES, units="g.     (02)", **volume_1),
            {"channel": 1},
            (hundreds, GRAVITY, 0.005),
        ),
        (
            "cosmos, volume 1, gals",
            cosmos(VALUES, "1E15.6", "cm/sec2 (4)", channels=("?:Up",), **volume_1),
            {},
            (hundreds, GAL, 0.005),
        ),
        ("cwa", cwa(VALUES), {"column": 3}, (hundreds, GAL, 0.005)),
        ("cwa, name", cwa(VALUES * 2), {"column": "n"}, (hundreds * 2, GAL, 0.005)),
        ("jma", jma(VALUES), {"column": "EW"}, ([-one / 2 for one in hundreds], GAL, 0.01)),
        ("jma, refused without a column", jma(VALUES), {}, (hundreds, GAL, 0.01)),
        ("jma, number", jma(VALUES * 2).rstrip("\n"), {"column": "1"}, (hundreds * 2, GAL, 0.01)),
        ("turkey", turkey(VALUES), {"column": "N-S"}, (hundreds, GAL, 0.02)),
        ("turkey, number", turkey(VALUES * 2), {"column": 3}, (TWICE, GAL, 0.02)),
        (
            "names with gals",
            "t_s,NS_gal,EW_gal\n" + _rows("{t:.3f},{a:.4f},-{t:.4f}"),
            {"column": "ew_gal"},
            (FALLING, GAL, 0.005),
        ),
        (
            "names with g",
            "Zeit [s]\tNS_g\tEW_mg\n" + _rows("{t:.3f}\t{a:.4f}\t-{t:.4f}"),
            {"column": "EW_mg"},
            (FALLING, GRAVITY / 1000, 0.005),
        ),
        (
            "tiempo",
            "Tiempo (ms); Aceleración (cm/s2); v\n" + _rows("{t:.1f};{a:.4f};1", 5.0),
            {"column": "Aceleración"},
            (TWICE, GAL, 0.005),
        ),
        ("temps", "temps (s);x (gal);y\n" + semicolons, {"column": 2}, (TWICE, GAL, 0.005)),
        ("gal given", "Time  a\n" + _rows("{t:.3f} {a:.4f}"), {"units": "gal"}, (TWICE, GAL, 0.005)),
        ("%g given", _rows("{t:.3f} {a:.4f}").rstrip("\n"), {"units": "%g"}, (TWICE, GRAVITY / 100, 0.005)),
        ("mm/s2 given", "zaman,a\n" + _rows("{t:.3f},{a:.4f}"), {"units": "mm/s2"}, (TWICE, 0.001, 0.005)),
        ("general form", "a (g)\n" + "".join(f"{value:g}\n" for value in small), {"dt": 0.01}, (small, GRAVITY, 0.01)),
        (
            "general form, csv",
            "b;a [g];c\n" + "".join(f"{v:e};{v:g};x\n" for v in small).rstrip("\n"),
            {"dt": 0.01, "column": 2},
            (small, GRAVITY, 0.01),
        ),
        (
            "general form, times",
            "".join(f"{0.01 * i:.2f},{v:g}\n" for i, v in enumerate(small)).rstrip("\n"),
            {"units": "g"},
            (small, GRAVITY, 0.01),
        ),
        ("no last end", _rows("{t:.3f} {a:.4f}").rstrip("\n"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("no last end, exponents", "# acc (m/s2)\n" + _rows("{t:.3f}, {a:.3E}").rstrip("\n"), {}, (TWICE, 1, 0.005)),
        (
            "comment inside",
            _rows("{t:.3f} {a:.4f}") + "# remark\n" + _rows("{t:.3f} {a:.4f}", origin=0.12),
            {"units": "g"},
            (TWICE * 2, GRAVITY, 0.005),
        ),
        (
            "step inside, refused",
            _list(SMOOTH[:24]) + "# dt = 0.01\n" + _list(SMOOTH[24:]),
            {"units": "g", "dt": 0.01},
            (SMOOTH, GRAVITY, 0.01),
        ),
        (
            "at2, rate",
            _at2(history, "NPTS= 12, DT= .005, SAMPLING RATE= 200 HZ", _fortran(VALUES)),
            {},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, rate above",
            _at2(history + ", 200 SPS", "NPTS= 12, DT= .005 SEC", _fortran(VALUES)),
            {},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, step above",
            _at2(history, "NPTS= 12, DT: 5 ms", _fortran(VALUES)),
            {"dt": 0.005},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, no last end",
            _at2(history, "NPTS= 12, DT= .005 SEC", _fortran(VALUES).rstrip("\n")),
            {},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, small",
            _at2(history, "NPTS= 12, DT= .005", _fortran([1e-102, *VALUES[1:]])),
            {},
            ([1e-102, *VALUES[1:]], GRAVITY, 0.005),
        ),
        ("dyna, no last end", _dyna(VALUES).rstrip("\n"), {}, (hundreds, GAL, 0.005)),
        *stated(),
    ]


def titled():
    """Records whose columns say in their titles what they are, or whose first lines how many they are."""
    hundreds, pairs = [100 * one for one in VALUES], [f"{0.005 * i:.3f} {VALUES[i % 12]:.5f}" for i in range(24)]
    stamps = "".join(f"2030-01-02T03:04:{15 + 0.005 * i:06.3f},{VALUES[i % 12]:.4f}\n" for i in range(24))
    plots = _rows("{t:.4f}\t{a:.5f}\t{t:.4f}\t-{t:.5f}\t")
    numbered = [f"{0.005 * i:.3f},{VALUES[i % 12]}" for i in range(24)]
    clocks = stamps.replace("2030-01-02T", "").replace(",", ";").replace(".", ",")
    ordinates, four = [1 + one / 10 for one in TWICE], _rows("{t:.3f} {a:.4f} 1 2")
    spectrum = "".join(f"{0.05 * i:.2f},{one:.5f}\n" for i, one in enumerate(ordinates))
    return [
        (
            "knet csv",
            knet_csv([100 * value for value in SMOOTH]),
            {"channel": 3},
            ([16.5 + 300 * one for one in SMOOTH], GAL, 0.02),
        ),
        (
            "knet csv, name",
            knet_csv([100 * value for value in VALUES * 2]).rstrip("\n"),
            {"channel": "n-s"},
            ([0.1 + one for one in hundreds] * 2, GAL, 0.02),
        ),
        ("csmnc", csmnc(SMOOTH), {}, ([100 * one for one in SMOOTH], GAL, 0.02)),
        ("csmnc, step given", csmnc(VALUES), {"dt": 0.02}, (hundreds, GAL, 0.02)),
        ("corrected", corrected(VALUES * 2), {}, (TWICE, 1, 0.005)),
        ("counted", "made up\n24 0.0050\n" + _rows("{a:.6f}"), {"units": "m/s2"}, (TWICE, 1, 0.005)),
        ("counted, a list", f"46 .01\n{_list(SMOOTH)}", {"units": "g"}, (SMOOTH, GRAVITY, 0.01)),
        ("counted, times", "24 0.005\n" + _rows("{t:.3f} {a:.4f}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("counted, lines", "24\n0.005\n" + _rows("{a:.4f}"), {"units": "cm/s2"}, (TWICE, GAL, 0.005)),
        ("step line", "Time Step: 0.005\n" + _rows("{a:.5f}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("pairs", "$ in g\n" + _lines([f"{pair}  " for pair in pairs], 4), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("pairs, three a line", _lines([f"{pair} " for pair in pairs], 3), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("quoted", '"Time (s)","Acc (g)"\n' + _rows('"{t:.3f}","{a:.4f}"'), {}, (TWICE, GRAVITY, 0.005)),
        (
            "quoted commas",
            '"t [s]","a, g"\n' + _rows('"{t:.3f}","{a:.4f}"').replace(".", ","),
            {},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "quoted numbers",
            '"","time","acc_g"\n' + "".join(f'"{i}",{row}\n' for i, row in enumerate(numbered, 1)),
            {},
            (TWICE, GRAVITY, 0.005),
        ),
        ("stamps", "time,acc (gal)\n" + stamps, {}, (TWICE, GAL, 0.005)),
        ("stamps, clock", f"time;acc (gal)\n{clocks}", {}, (TWICE, GAL, 0.005)),
        (
            "plots",
            "Time [s] - 0\tA - Plot 0\tTime [s] - 1\tA - Plot 1\t\n" + plots,
            {"units": "g", "column": 2},
            (TWICE, GRAVITY, 0.005),
        ),
        ("plots, second", "Time [ms]\tA [mg]\tTime [s]\tB [g]\n" + plots, {"column": 4}, (FALLING, GRAVITY, 0.005)),
        (
            "units below",
            "Time,Acc,Vel\nms,mg,m/s\n" + _rows("{t:.1f},{a:.4f},1", 5.0),
            {"column": "acc"},
            (TWICE, GRAVITY / 1000, 0.005),
        ),
        ("glued units", "time,acc_cms2,vel_cms\n" + _rows("{t:.3f},{a:.4f},1"), {"column": 2}, (TWICE, GAL, 0.005)),
        (
            "numbered",
            "no.,time,acc_m_s2\n" + "".join(f"{i},{row}\n" for i, row in enumerate(numbered)),
            {},
            (TWICE, 1, 0.005),
        ),
        ("a v d", "t a v d\n" + four, {"units": "g", "column": "a"}, (TWICE, GRAVITY, 0.005)),
        ("reversed", "acc (g),time (s)\n" + _rows("{a:.4f},{t:.3f}"), {}, (TWICE, GRAVITY, 0.005)),
        (
            "velocity, refused",
            "t a v d\n" + _rows("{t:.3f} {a:.4f} 1 2"),
            {"units": "g", "column": "v"},
            ([1.0] * 24, GRAVITY, 0.005),
        ),
        ("spectrum, refused", "T (s),Sa (g)\n" + spectrum, {}, (ordinates, GRAVITY, 0.05)),
        (
            "spectra, refused",
            "Period [sec],Acc./Elastic\n" + spectrum,
            {"units": "g", "column": 2},
            (ordinates, GRAVITY, 0.05),
        ),
        ("frequency, refused", "f [Hz],Acc (g)\n" + spectrum, {}, (ordinates, GRAVITY, 0.05)),
        ("spectrum above, refused", "# Design spectrum\n" + spectrum, {"units": "g"}, (ordinates, GRAVITY, 0.05)),
        (
            "unknown unit, refused",
            "time,acc [lsb]\n" + _rows("{t:.3f},{a:.4f}"),
            {"units": "g"},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "unknown suffix, refused",
            "time,acc_foo2\n" + _rows("{t:.3f},{a:.4f}"),
            {"units": "g"},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "km, refused",
            "# acceleration in km/s2\n" + _rows("{t:.3f},{a:.4f}"),
            {"units": "g"},
            (TWICE, GRAVITY, 0.005),
        ),
    ]


SCENE = """\
name = "made up"
gravity = 9.81
friction = 0.6
[block]
mass = 3172.05            # kg
radius = 1.0884
slenderness = 0.28
corner_inertia = 5010.2
[base]
mass = 212.0
[bearings]
law = "algebraic"
count = 4
ka = 6.22e4
kb = 6.22e3
alpha = 44.69
[motion]
{motion}
scale = 1.5
[start]
tilt = 0.01
[run]
duration = 20.0
"""


def scenes():
    """(name, text) of undamaged scene files."""
    return [
        ("pulse", SCENE.format(motion='pulse = "one-cosine"\namplitude = -2.0\nfrequency = 3')),
        ("synthetic", SCENE.format(motion='synthetic = "duzce-like"\nseed = 5')),
        ("least", "[block]\nmass = 1\nradius = 1.0\nslenderness = 0.2\n"),
    ]


SIGNS = 2 * "0123456789" + "+-..,,;:eEdD \t\n\r=()[]/^*_#%!\"'gGmMsScC²³٣\u00a0\ufeff\x00\x1a"
WORDS = [
    "nan",
    "-inf",
    "1E400",
    "1e-400",
    "1_000",
    "0x1F",
    ".",
    "-",
    "E-05",
    "1.5.2",
    40 * "9",
    "*******",
    "1,5",
    "1;5",
    ".1025061E-1022243E-01",
    "-.10-100",
    "1e-105",
    "1e-012",
    "²",
    "G",
    "CM/S",
    "CM/S/S",
    "cm/s2",
    "m/s**2",
    "gal",
    "UNITS OF M/S2",
    "units: g",
    "VELOCITY",
    "(ms)",
    "ms",
    "NPTS= 12",
    "DT= .01",
    "true",
    "[]",
    "{}",
    "[block]",
    "1979-05-27",
    "'a'",
    '"',
    '"""',
    "a.b = 1",
    "seed = -1",
    "1e41",
    "-1.0",
    "0",
    "# 1 2",
    "Hz",
    "200Hz",
    "sps",
    "200 sps",
    "muestras/s",
    "200 samples per second",
    "dt = 5",
    "T",
    "Sa",
    "Period",
    "Hz sampling",
    "acc_cms2",
    "(counts)",
    "_foo2",
    "spectrum",
    "24",
    "NO. OF POINTS: 24",
    "samples: 24",
    "step",
    "0.005 s intervals",
    "time_ms",
    "dt = 0.005 s",
    "dt:",
    "# dt = .01",
    "Abtastrate",
    "Sampling rate: 200",
    "fs",
    "fs = 100 Hz",
    "sampling interval of",
    "1,000",
    "0,005",
    "(gal)",
    "[gals]",
    "gal(cm/s/s)",
    "_gal",
    "unidades",
    "Zeit",
    "DataSequence:",
    "# gal",
    "kHz",
    "per second",
    "is",
    "=",
    ":",
]


def damaged(text, chance):
    """The text as bytes after one to three kinds of damage drawn from `chance` (a `random.Random`)."""
    for _ in range(chance.choice((1, 1, 1, 1, 2, 3))):
        text = chance.choice(DAMAGE)(text, chance)
    content = text.encode("utf-8", errors="surrogatepass")
    if chance.random() < 0.05 and content:
        at = chance.randrange(len(content))
        content = content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :]
    return content


def damaged_bytes(content, chance):
    """Bytes after one to three of them were changed, lost, doubled or cut away."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        at, length = chance.randrange(len(content) + 1), chance.choice((1, 1, 4, 30))
        changes = (
            content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :],
            content[:at] + content[at + length :],
            content[: at + length] + content[at:],
            content[:at],
        )
        content = chance.choice(changes)
    return content


def _sign(text, chance):
    at = chance.randrange(len(text) + 1)
    return text[:at] + chance.choice(SIGNS) + text[at + chance.randrange(2) :]


def _lost(text, chance):
    at = chance.randrange(len(text) + 1)
    return text[:at] + text[at + chance.choice((1, 1, 1, 2, 5, 15, 40)) :]


def _doubled(text, chance):
    at, length = chance.randrange(len(text) + 1), chance.choice((1, 2, 15, 40))
    return text[: at + length] + text[at:]


def _cut(text, chance):
    at = chance.randrange(len(text) + 1)
    return text[:at] if chance.random() < 0.7 else text[at:]


def _line(text, chance):
    """A line lost, doubled elsewhere, exchanged with another, or joined to the next."""
    lines = text.split("\n")
    low, high = sorted(chance.choices(range(len(lines)), k=2))
    changes = (
        lines[:low] + lines[low + 1 :],
        lines[:high] + lines[low : low + 1] + lines[high:],
        lines[:low] + lines[high : high + 1] + lines[low + 1 : high] + lines[low : low + 1] + lines[high + 1 :],
        lines[:low] + ["".join(lines[low : low + 2])] + lines[low + 2 :],
    )
    return "\n".join(chance.choice(changes))


def _word(text, chance):
    words = text.split(" ")
    words[chance.randrange(len(words))] = chance.choice(WORDS)
    return " ".join(words)


def _field(text, chance):
    """One field of a line replaced, or a word put in."""
    lines = text.split("\n")
    at = chance.randrange(len(lines))
    fields = lines[at].split()
    if fields and chance.random() < 0.7:
        place = chance.randrange(len(fields))
        lines[at] = lines[at].replace(fields[place], chance.choice(WORDS), 1)
    else:
        lines[at] += " " + chance.choice(WORDS)
    return "\n".join(lines)


def _everywhere(text, chance):
    """A sign replaced throughout, as a conversion does, or in one line."""
    old, new = chance.choice(
        (
            (".", ","),
            (",", "."),
            (",", ";"),
            (";", ","),
            (" ", ""),
            (" ", ","),
            ("\n", "\r\n"),
            ("\n", "\r"),
            ("\n", " "),
            ("E", "D"),
            ("E-0", "E-00"),
            ("-", ""),
            ("-", "−"),
            ("e", ""),
        )
    )
    if chance.random() < 0.4:
        return text.replace(old, new)
    lines = text.split("\n")
    at = chance.randrange(len(lines))
    lines[at] = lines[at].replace(old, new)
    return "\n".join(lines)


def _case(text, chance):
    return text.upper() if chance.random() < 0.5 else text.lower()


DAMAGE = (
    _sign,
    _sign,
    _sign,
    _sign,
    _lost,
    _lost,
    _doubled,
    _cut,
    _line,
    _line,
    _word,
    _field,
    _field,
    _everywhere,
    _case,
)


def cases(undamaged, number, seed):
    """`number` times one of the files (name, text, ...), and the bytes that damage makes of its text."""
    chance = random.Random(seed)
    for _ in range(number):
        one = chance.choice(undamaged)
        yield one, damaged(one[1], chance)
