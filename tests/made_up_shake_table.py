"""Made-up shake-table tests in the two layouts that the study reads: no value is of a real one."""

import gzip

import numpy as np
from record_files import write

TITLES = "".join(f"Time [s] - Plot {k}\tAmplitude - Plot {k}\t" for k in range(4))
RESULTS, SHEET, RECORDS = "Results_Granite.xlsx", "All Results", "Earthquake_Records_Info.xlsx"
MEASURED = [f"Experimental Results for response-Specimen {k}" for k in (1, 2)]
AUTHORS = ["Specimen 1-Numerical KN=1 KS=1", "Specimen 1-Numerical KN=3 KS=1", "Specimen 2-Numerical KN=3 KS=1"]
NAMES = ("' RSN1_MADEUP.xlsx'", "RSN1_MADEUP-NS.AT2 ", "RSN22_OTHER", "Nowhere ", "RSN3_THIRD", "RSN4_FOURTH")
REST, OFFSET = 1.5, 0.03  # s at rest before the pulse; g


def pulse(peak, rate, seconds=4.0, frequency=1.5):
    """Acceleration [g] of a table at rest that plays one period of a sine."""
    t = np.arange(round(seconds * rate)) / rate
    inside = (t >= REST) & (t <= REST + 1 / frequency)
    return t, np.where(inside, peak * np.sin(2 * np.pi * frequency * (t - REST)), 0.0)


def labview(t, acceleration, offset=OFFSET):
    """A motion as LabVIEW exports it, in six digits: the acceleration first, then plots that say nothing of it."""
    pairs = zip(t, acceleration + offset, strict=True)
    rows = (f"{a:.6g}\t{b:.6g}\t{a:.6g}\t7\t{a:.6g}\t-900.5\t{a:.6g}\t33\t\n" for a, b in pairs)
    return f"{TITLES}\n{''.join(rows)}"


def peak_of(number):
    """The peak [g] of a made-up test: from far too small to more than enough."""
    return 0.05 * 1.12 ** (number % 24)


def fell(number, specimen):
    """Whether a made-up test overturned: the stronger ones, and a few that nothing explains."""
    return int((peak_of(number) > (0.3, 0.35)[specimen]) != (number % 11 == 5))


def book(path, sheets):
    """An xlsx file of {sheet: rows}."""
    from openpyxl import Workbook

    found = Workbook()
    found.remove(found.active)
    for title, rows in sheets.items():
        sheet = found.create_sheet(title)
        for row in rows:
            sheet.append(row)
    found.save(path)


def lists(folder, numbers, change=lambda rows: rows):
    """The two lists of a published campaign; change: of the rows of the results."""
    rows = [["Test Number", *MEASURED, *AUTHORS]]
    rows += [[n, fell(n, 0), fell(n, 1), 1, fell(n, 0), fell(n, 1)] for n in numbers]
    book(folder / RESULTS, {SHEET: change(rows), "Notes": [["Overturned = 1"]]})
    heads = [[None] * 6, ["Test No. ", "Date", "Test Type", "Ground Motion", "PGV/PGA", "Scaled PGA (g)"]]
    said = [[n, 20300102, "Earthquake", NAMES[n % len(NAMES)], 0.1 + 0.001 * n, peak_of(n)] for n in numbers]
    book(folder / RECORDS, {"Sheet1": heads + said})


def published(folder, numbers=range(11, 35), rate=200, packed=True, without=()):
    """The folder with a published campaign in it; without: numbers of tests whose motion is not there."""
    lists(folder, numbers)
    for n in numbers:
        text = labview(*pulse(peak_of(n), rate))
        if n not in without:
            name = f"Test{n:03d}.txt"
            write(folder, gzip.compress(text.encode()), f"{name}.gz") if packed else write(folder, text, name)
    return folder


SCENE = "[block]\nmass = 300.0\nradius = 0.3\nslenderness = 0.11\n"


def own(folder, numbers=range(24), rate=200, header="motion,overturned,record"):
    """The folder with tests of one's own in it."""
    write(folder, SCENE, "scene.toml")
    lines = [header]
    for n in numbers:
        rows = "".join(f"{x:.4f},{y:.6f}\n" for x, y in zip(*pulse(peak_of(n), rate), strict=True))
        write(folder, f"time [s],acc [g]\n{rows}", f"{n}.csv")
        lines.append(f"{n}.csv,{fell(n, 0)},{NAMES[n % len(NAMES)].strip()}")
    write(folder, "\n".join(lines) + "\n", "tests.csv")
    return folder
