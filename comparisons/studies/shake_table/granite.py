"""The shake-table tests of two granite boulders: their published layout, and what is known of the two.

"Virtual Shake Robot: Simulating Dynamics of Precariously Balanced Rocks for Overturning and Large-displacement
Processes", Seismica 3(1), 2024. Nothing of the data is here: their licence is another (GPL-3.0). What is here describes
the two boulders, by the authors' meshes.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from analytic import Block, SampledMotion, Scene, SceneError
from analytic.errors import SettingError
from analytic.records import read_record

from .campaign import Campaign, Specimen, TableTest, flag, thinned
from .measures import unfit

DOI = "10.26443/seismica.v3i1.692"
REPOSITORY = "https://github.com/ZhiangChen/virtual_shake_robot_pybullet"
CITE = f"Virtual Shake Robot, Seismica 3(1), 2024, doi {DOI}"
WHERE = f"the data are to be had at {REPOSITORY} (data/Shake_Table_Response, GPL-3.0)"

RESULTS, SHEET = "Results_Granite.xlsx", "All Results"
RECORDS = "Earthquake_Records_Info.xlsx"
BELOW = Path("data") / "Shake_Table_Response"
NUMBER, RECORD = "Test Number", "Ground Motion"
MEASURED = "Experimental Results for response-Specimen {}"
STATED = {"PGV/PGA": "ratio", "Scaled PGA (g)": "peak"}
COLUMN = 2  # of a motion file: Plot 0, the acceleration of the table along the motion [g]
PUBLISHED = 800.0  # Hz
SECONDS = 1.0  # s at the beginning, where the table is at rest: what its accelerometer says then is its offset

# From the meshes, by the density 2700 kg/m3: mass [kg], height of the centre of mass over the lowest point [m]. The
# smallest angle [deg] between the vertical and the line from the nearest edge of the footprint to the centre of mass,
# where all points within 2, 5, 10 mm of the lowest one are the footprint.
DENSITY = 2700.0
BOULDERS = {"boulder 1": (331.0, 0.294, (5.8, 10.1, 12.9)), "boulder 2": (335.0, 0.292, (8.5, 11.1, 13.8))}
# m5: moment of inertia about the centre of mass over the density. The meshes have about .0074 and .0064 about their two
# horizontal axes, both boulders alike. Which of them the boulders rocked about is not said: their mean.
INERTIA = 0.0069
SPAN = (2.0, 14.0)  # deg: beyond what the meshes say on either side
UPRIGHT = np.radians(10.0)  # stands in the scene until a slenderness is fitted: no drawing says it


def specimens() -> tuple[Specimen, ...]:
    """The two boulders as planar blocks."""
    found = []
    for name, (mass, height, footprints) in BOULDERS.items():
        radius = float(height / np.cos(UPRIGHT))
        corner = INERTIA * DENSITY + mass * radius**2
        block = Block(mass=mass, radius=radius, slenderness=float(UPRIGHT), corner_inertia=corner)
        angles = " or ".join(f"{angle:g}" for angle in footprints)
        note = (
            f"slenderness by the mesh: {angles} deg, the footprint being all within 2, 5 or 10 mm of the lowest point"
        )
        low, high = np.radians(SPAN).tolist()
        found.append(Specimen(name, Scene(block=block, name=name), (low, high), note))
    return tuple(found)


def place_in(folder: Path) -> Path | None:
    """Where the published files are in a folder or in a checkout of the repository; None: not there."""
    return next((place for place in (folder, folder / BELOW) if (place / RESULTS).is_file()), None)


def read(place: Path, every: int, progress: Callable[[int, int], None]) -> Campaign:
    """The published campaign in a folder; see `reading.read_campaign`."""
    results = _table(place / RESULTS, NUMBER, SHEET)
    records = {row["Test No."]: (at, row) for at, row in _table(place / RECORDS, "Test No.")}
    names = list(BOULDERS)
    authors = [_settings(results, number) for number in range(1, len(names) + 1)]
    files, known, missing = {}, [], []
    for at, row in results:
        number = row[NUMBER]
        if type(number) is not int or number not in records:
            raise SettingError(
                f"{place / RESULTS}, row {at}, {NUMBER} = {number!r}: {RECORDS} has no such test; fetch both again"
            )
        measured = tuple(flag(place / RESULTS, at, MEASURED.format(k), row) for k in range(1, len(names) + 1))
        said = tuple({word: flag(place / RESULTS, at, title, row) for word, title in one.items()} for one in authors)
        line, record = records[number]
        stated = {key: float(record[title]) for title, key in STATED.items() if type(record.get(title)) in (int, float)}
        if zero := next((title for title, key in STATED.items() if not stated.get(key, 1.0) > 0), None):
            raise SettingError(
                f"{place / RECORDS}, row {line}, {zero} = {record[zero]!r}: not above 0; fetch the file again"
            )
        test = TableTest(str(number), record_of(record[RECORD]), measured, None, said, stated)
        if (file := _file(place, number)) is None:
            missing.append(test)
        else:
            files[test.name] = file
            known.append(test)
    chosen, tests = thinned(known, every), []
    for count, test in enumerate(chosen, 1):
        tests.append(replace(test, motion=motion_of(files[test.name])))
        progress(count, len(chosen))
    cite = f"{CITE}; {WHERE}"
    return Campaign("two granite boulders", specimens(), tuple(tests), cite, tuple(missing), PUBLISHED)


def motion_of(file: Path) -> SampledMotion:
    """The table's acceleration [m/s2] at the sampling of the file, less its offset: the median of the first second."""
    try:
        motion = read_record(file, "g", column=COLUMN)
    except SceneError as error:
        raise SettingError(f"{error} (a test without its file is left out)") from error
    rest = motion.samples[: max(int(SECONDS / motion.dt), 1)]
    motion = SampledMotion(motion.dt, motion.samples - np.median(rest), file.name, motion.warnings)
    if why := unfit(motion):
        raise SettingError(f"{file}: {why} (a test without its file is left out)")
    return motion


def record_of(said: Any) -> str:
    """A record's name without the marks about it: both components of a station's record are one record."""
    words = re.sub(r"x?\.xlsx$|\.AT2$", "", str(said).strip(" '\""), flags=re.I)
    number = re.match(r"RSN(\d+)", words, re.I)
    return f"RSN{number[1]}" if number else words


def _file(place, number):
    names = (f"Test{number:03d}.txt", f"Test{number:03d}.txt.gz")
    return next((place / name for name in names if (place / name).is_file()), None)


def _settings(results: Sequence[tuple[int, dict]], specimen: int) -> dict[str, str]:
    """{setting of the authors' discrete elements: title of its column}."""
    pattern = re.compile(rf"Specimen {specimen}-Numerical (.+)")
    return {found[1]: title for title in results[0][1] if (found := pattern.fullmatch(title))} if results else {}


def _table(path: Path, first: str, sheet: str | None = None) -> list[tuple[int, dict]]:
    """(number of the row, {title: value}) of a sheet whose titles begin with a column `first`."""
    rows = _cells(path, sheet)
    at = next((k for k, row in enumerate(rows) if any(_title(cell) == first for cell in row)), None)
    if at is None:
        raise SettingError(f"{path}: no column {first!r}; fetch the file again")
    titles = [_title(cell) for cell in rows[at]]
    wanted = (MEASURED.format(1), MEASURED.format(2)) if sheet else (RECORD,)
    if absent := next((name for name in wanted if name not in titles), None):
        raise SettingError(f"{path}, row {at + 1}: no column {absent!r}; fetch the file again")
    return [
        (number, dict(zip(titles, row, strict=True)))
        for number, row in enumerate(rows[at + 1 :], at + 2)
        if any(cell is not None for cell in row)
    ]


def _title(cell):
    return str(cell).strip()


def _cells(path, sheet):
    """The rows of a sheet, or of the only one."""
    try:
        from openpyxl import load_workbook
    except ImportError as error:
        raise SettingError(f'{path}: needs openpyxl; pip install -e ".[records]" installs it') from error
    try:
        with path.open("rb") as file:
            book = load_workbook(file, read_only=True, data_only=True)
            if sheet is not None and sheet not in book.sheetnames:
                known = ", ".join(book.sheetnames)
                raise SettingError(f"{path}: no sheet {sheet!r}, but {known}; fetch the file again")
            return [tuple(row) for row in book[sheet or book.sheetnames[0]].iter_rows(values_only=True)]
    except SettingError:
        raise
    except Exception as error:  # whatever a damaged archive or its XML raises
        raise SettingError(f"{path}: no readable workbook ({type(error).__name__}: {error}); fetch it again") from error
