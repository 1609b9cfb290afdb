"""Undamaged records of every family, with what they are made of."""

import itertools

from made_up_records import (
    SMOOTH,
    VALUES,
    at2,
    corrected,
    cosmos,
    csmip,
    csmnc,
    cwa,
    dyna,
    fortran,
    in_lines,
    jma,
    knet,
    knet_csv,
    rows_of,
    smc,
    turkey,
)

TWICE, FALLING = VALUES * 2, [-0.005 * i for i in range(24)]
GAL, GRAVITY = 0.01, 9.81  # m/s2
# What headers say of the step, one of them of 1/256 s and the others of 5 ms
STATED = (
    "Sampling rate: 200 Hz|SAMPLING_RATE (samples/s) = 200.0|fs = 200|delta-t [s]: .005|time step = 0,005 s|"
    "Sample period (msec): 5.0|Sampling rate: 256 Hz, sampling interval: .0039 s|"
    "Frecuencia de muestreo: 200 muestras/s|Tasa de muestreo = 200,0 Hz|INTERVALO DE MUESTREO (seg): 0,005|"
    "paso de tiempo: 5 milisegundos"
).split("|")
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
    rows = rows_of("{a:.4f}  -{t:.4f} 1.0")
    for at, (step, unit) in enumerate(zip(STATED, itertools.cycle(UNITS), strict=False)):
        column = {"column": ("EW", 1, "2", "ns")[at % 4], "units": "gal" if unit == "NS_gal" else None}
        comment = f"# {unit.replace('NS_gal', 'gal: units: gal')}\n# {step}\n"
        forms = (
            (f"{step}\n{unit}\n" + rows_of("{a:.4f}"), {}, TWICE),
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
    semicolons = rows_of("{t:.3f};{a:.4f}").replace(".", ",")
    hundreds, below = [100 * one for one in VALUES], [-abs(one) - 0.01 for one in VALUES]
    return [
        ("at2", at2(history, counts, fortran(VALUES)), {}, (VALUES, GRAVITY, 0.005)),
        (
            "at2 old",
            at2("ACCELERATION TIME SERIES IN UNITS OF CM/S/S", "    12    .00500  NPTS, DT", fortran(VALUES)),
            {},
            (VALUES, GAL, 0.005),
        ),
        ("at2 ms", at2("ACCELERATION (CM/SEC2)", "NPTS= 12, DT= 5.0 MSEC", fortran(VALUES)), {}, (VALUES, GAL, 0.005)),
        ("at2 stuck", at2(history, "NPTS=12,DT=5.0E-003", fortran(below, 13)), {}, (below, GRAVITY, 0.005)),
        ("at2 long exponents", at2(history, counts, fortran(VALUES, 16, 7, 3)), {}, (VALUES, GRAVITY, 0.005)),
        ("at2 of given units", at2("TIME HISTORY", counts, fortran(VALUES)), {"units": "g"}, (VALUES, GRAVITY, 0.005)),
        (
            "at2 of velocities, refused",
            at2("VELOCITY TIME HISTORY IN UNITS OF CM/S", counts, fortran(VALUES)),
            {},
            (VALUES, GAL, 0.005),
        ),
        ("dyna", dyna(VALUES), {}, (hundreds, GAL, 0.005)),
        ("blanks", rows_of("{t:8.4f} {a:14.6E}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        (
            "comments",
            "# time acceleration\n" + rows_of("{t:.3f}\t{a:.4f}  # remark"),
            {"units": "m/s2"},
            (TWICE, 1, 0.005),
        ),
        ("256 Hz", rows_of("{t:.3f} {a:.4f}", 1 / 256), {"units": "g"}, (TWICE, GRAVITY, 1 / 256)),
        ("epoch", rows_of("{t:.4f} {a:.4f}", origin=1.5e9), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("csv", "Time (s),Acceleration (cm/s^2)\n" + rows_of("{t:.3f},{a:.4f}"), {}, (TWICE, GAL, 0.005)),
        ("csv ms", "time [ms],acc [g]\n" + rows_of("{t:.1f},{a:.4f}", 5.0), {}, (TWICE, GRAVITY, 0.005)),
        ("semicolons", "t;a [m/s2]\n" + semicolons, {}, (TWICE, 1, 0.005)),
        ("decimal commas", semicolons.replace(";", "   "), {"units": "cm/s2"}, (TWICE, GAL, 0.005)),
        ("one column", "acceleration [cm/s2]\n" + rows_of("{a:.4f}"), {"dt": 0.005}, (TWICE, GAL, 0.005)),
        ("one column, own step", "# dt = 5 ms\n" + rows_of("{a:.4f}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("list", _list(SMOOTH), {"units": "g", "dt": 0.01}, (SMOOTH, GRAVITY, 0.01)),
        (
            "channels",
            "t [s];x (g);y (g);v (cm/s)\n" + rows_of("{t:.3f};{a:.4f};-{t:.4f};1"),
            {"column": 3},
            (FALLING, GRAVITY, 0.005),
        ),
        (
            "tabs",
            "Time (s)\tx (g)\ty (g)\n" + rows_of("{t:.3f}\t{a:.4f}\t-{t:.4f}"),
            {"column": 2},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "channels, no times",
            rows_of("{a:.4f} -{t:.4f} 1"),
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
    history, semicolons = "ACCELERATION TIME HISTORY IN UNITS OF G", rows_of("{t:.3f};{a:.4f};1,0").replace(".", ",")
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
            "t_s,NS_gal,EW_gal\n" + rows_of("{t:.3f},{a:.4f},-{t:.4f}"),
            {"column": "ew_gal"},
            (FALLING, GAL, 0.005),
        ),
        (
            "names with g",
            "Zeit [s]\tNS_g\tEW_mg\n" + rows_of("{t:.3f}\t{a:.4f}\t-{t:.4f}"),
            {"column": "EW_mg"},
            (FALLING, GRAVITY / 1000, 0.005),
        ),
        (
            "tiempo",
            "Tiempo (ms); Aceleración (cm/s2); v\n" + rows_of("{t:.1f};{a:.4f};1", 5.0),
            {"column": "Aceleración"},
            (TWICE, GAL, 0.005),
        ),
        ("temps", "temps (s);x (gal);y\n" + semicolons, {"column": 2}, (TWICE, GAL, 0.005)),
        ("gal given", "Time  a\n" + rows_of("{t:.3f} {a:.4f}"), {"units": "gal"}, (TWICE, GAL, 0.005)),
        ("%g given", rows_of("{t:.3f} {a:.4f}").rstrip("\n"), {"units": "%g"}, (TWICE, GRAVITY / 100, 0.005)),
        ("mm/s2 given", "zaman,a\n" + rows_of("{t:.3f},{a:.4f}"), {"units": "mm/s2"}, (TWICE, 0.001, 0.005)),
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
        ("no last end", rows_of("{t:.3f} {a:.4f}").rstrip("\n"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("no last end, exponents", "# acc (m/s2)\n" + rows_of("{t:.3f}, {a:.3E}").rstrip("\n"), {}, (TWICE, 1, 0.005)),
        (
            "comment inside",
            rows_of("{t:.3f} {a:.4f}") + "# remark\n" + rows_of("{t:.3f} {a:.4f}", origin=0.12),
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
            at2(history, "NPTS= 12, DT= .005, SAMPLING RATE= 200 HZ", fortran(VALUES)),
            {},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, rate above",
            at2(history + ", 200 SPS", "NPTS= 12, DT= .005 SEC", fortran(VALUES)),
            {},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, step above",
            at2(history, "NPTS= 12, DT: 5 ms", fortran(VALUES)),
            {"dt": 0.005},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, no last end",
            at2(history, "NPTS= 12, DT= .005 SEC", fortran(VALUES).rstrip("\n")),
            {},
            (VALUES, GRAVITY, 0.005),
        ),
        (
            "at2, small",
            at2(history, "NPTS= 12, DT= .005", fortran([1e-102, *VALUES[1:]])),
            {},
            ([1e-102, *VALUES[1:]], GRAVITY, 0.005),
        ),
        ("dyna, no last end", dyna(VALUES).rstrip("\n"), {}, (hundreds, GAL, 0.005)),
        *stated(),
    ]


def titled():
    """Records whose columns say in their titles what they are, or whose first lines how many they are."""
    hundreds, pairs = [100 * one for one in VALUES], [f"{0.005 * i:.3f} {VALUES[i % 12]:.5f}" for i in range(24)]
    stamps = "".join(f"2030-01-02T03:04:{15 + 0.005 * i:06.3f},{VALUES[i % 12]:.4f}\n" for i in range(24))
    plots = rows_of("{t:.4f}\t{a:.5f}\t{t:.4f}\t-{t:.5f}\t")
    numbered = [f"{0.005 * i:.3f},{VALUES[i % 12]}" for i in range(24)]
    clocks = stamps.replace("2030-01-02T", "").replace(",", ";").replace(".", ",")
    ordinates, four = [1 + one / 10 for one in TWICE], rows_of("{t:.3f} {a:.4f} 1 2")
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
        ("counted", "made up\n24 0.0050\n" + rows_of("{a:.6f}"), {"units": "m/s2"}, (TWICE, 1, 0.005)),
        ("counted, a list", f"46 .01\n{_list(SMOOTH)}", {"units": "g"}, (SMOOTH, GRAVITY, 0.01)),
        ("counted, times", "24 0.005\n" + rows_of("{t:.3f} {a:.4f}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("counted, lines, refused", "24\n0.005\n" + rows_of("{a:.4f}"), {"units": "cm/s2"}, (TWICE, GAL, 0.005)),
        ("step line", "Time Step: 0.005\n" + rows_of("{a:.5f}"), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("pairs", "$ in g\n" + in_lines([f"{pair}  " for pair in pairs], 4), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("pairs, three a line", in_lines([f"{pair} " for pair in pairs], 3), {"units": "g"}, (TWICE, GRAVITY, 0.005)),
        ("quoted", '"Time (s)","Acc (g)"\n' + rows_of('"{t:.3f}","{a:.4f}"'), {}, (TWICE, GRAVITY, 0.005)),
        (
            "quoted commas",
            '"t [s]","a, g"\n' + rows_of('"{t:.3f}","{a:.4f}"').replace(".", ","),
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
            "Time,Acc,Vel\nms,mg,m/s\n" + rows_of("{t:.1f},{a:.4f},1", 5.0),
            {"column": "acc"},
            (TWICE, GRAVITY / 1000, 0.005),
        ),
        ("glued units", "time,acc_cms2,vel_cms\n" + rows_of("{t:.3f},{a:.4f},1"), {"column": 2}, (TWICE, GAL, 0.005)),
        (
            "numbered",
            "no.,time,acc_m_s2\n" + "".join(f"{i},{row}\n" for i, row in enumerate(numbered)),
            {},
            (TWICE, 1, 0.005),
        ),
        ("a v d", "t a v d\n" + four, {"units": "g", "column": "a"}, (TWICE, GRAVITY, 0.005)),
        ("reversed", "acc (g),time (s)\n" + rows_of("{a:.4f},{t:.3f}"), {}, (TWICE, GRAVITY, 0.005)),
        (
            "velocity, refused",
            "t a v d\n" + rows_of("{t:.3f} {a:.4f} 1 2"),
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
            "time,acc [lsb]\n" + rows_of("{t:.3f},{a:.4f}"),
            {"units": "g"},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "unknown suffix, refused",
            "time,acc_foo2\n" + rows_of("{t:.3f},{a:.4f}"),
            {"units": "g"},
            (TWICE, GRAVITY, 0.005),
        ),
        (
            "km, refused",
            "# acceleration in km/s2\n" + rows_of("{t:.3f},{a:.4f}"),
            {"units": "g"},
            (TWICE, GRAVITY, 0.005),
        ),
    ]
