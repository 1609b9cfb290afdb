"""Small records, made up here, as the networks and programs write them."""

import math

VALUES = [0.001, -0.123, -0.456, 0.25, -1.5, 0.0, 0.75, 0.031, -0.2, 0.11, 0.4, -0.33]
SMOOTH = [round(math.sin(0.3 * i) * math.exp(-0.02 * i), 4) for i in range(46)]


def in_lines(words, per_line):
    return "".join("".join(words[i : i + per_line]) + "\n" for i in range(0, len(words), per_line))


def fortran(values, width=15, digits=7, exponent=2):
    parts = [f"{value:.{digits}E}".split("E") for value in values]
    return in_lines([f"{part}E{int(power):+0{exponent + 1}d}".rjust(width) for part, power in parts], 5)


def at2(third, fourth, data):
    return f"PEER STRONG MOTION DATABASE\nMADE UP, 01/01/00, NOWHERE, 000\n{third}\n{fourth}\n{data}"


def dyna(values):
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


def rows_of(row, step=0.005, origin=0.0, count=24):
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
            + (_columns(samples, 8, 10, 5) if layout.startswith("8") else in_lines(words, 1))
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
Memo.             \n""" + in_lines([f"{count:8d} " for count in counts], 8)


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
    return text + _columns(integers, 8, 10) + fortran(reals) + "|\n| made up\n" + in_lines(words, per_line)


def _columns(values, per_line, width, decimals=0):
    return in_lines([f"{value:{width}.{decimals}f}" for value in values], per_line)


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
    ) + fortran(values, 14)


def turkey(values):
    """Columns of Turkey's disaster management."""
    return (
        "STRONG GROUND MOTION RECORDS OF TURKEY\nPLACE                  : NOWHERE\n"
        f"NUMBER OF DATA         : {len(values)}\nSAMPLING INTERVAL (sec) : 0.02\n"
        "RAW PGA VALUES (gal)   : (N-S) 1.0 (E-W) 2.0 (U-D) 3.0\n\n       N-S        E-W        U-D\n"
    ) + "".join(f"{100 * value:11.6f}{-50 * value:11.6f}{value:11.6f}\n" for value in values)
