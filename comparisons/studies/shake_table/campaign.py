"""A campaign of shake-table tests: specimens, motions of the table, and what overturned.

    campaign = read_campaign("folder")

A folder has one of two layouts. The first is that of the tests of two granite boulders, as their authors publish them,
or the checkout of their repository: "Virtual Shake Robot: Simulating Dynamics of Precariously Balanced Rocks for
Overturning and Large-displacement Processes", Seismica 3(1), 2024. None of the data is here: they have another licence
(GPL-3.0). What is here describes the two boulders, by the authors' meshes.

The second is for one's own tests: a scene file ``scene.toml`` of the block, and ``tests.csv`` with a line for each
test. Its columns are ``motion`` (a record file in the folder), ``overturned`` (1 or 0) and, if needed, ``units`` (of a
file that states none), ``name`` and ``record``. Tests under one record at several scales have the same ``record``, and
count as one in intervals. Motions are taken as they are. The scene has no motion, start, duration or restitution of its
own.

What later computations need is checked here, before anything is run: two records or more, as each is held out in turn,
five tests or more, and motions that have a PGA and a PGV.
"""

import csv
import hashlib
import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import butter, sosfiltfilt

from analytic import Block, SampledMotion, Scene, SceneError, load_scene
from analytic.errors import SettingError, read_plain
from analytic.records import UNITS, read_record

from ...ensembles import peak_velocity

GRID = 61  # number of slendernesses in a grid
ALL = "all"  # all specimens together
FEWEST = 5  # least number of tests in a sum that is disclosed, see `disclosed`


@dataclass(frozen=True, eq=False)
class Specimen:
    """A block that was tested.

    scene: the block and its support; its slenderness is that of a drawing, or stands in place of one. span:
    slendernesses [rad] among which the fitted one is searched for. note: what else is known of it.
    """

    name: str
    scene: Scene
    span: tuple[float, float]
    note: str = ""

    def slendernesses(self) -> np.ndarray:
        """Return the `GRID` slendernesses of the grid [rad], evenly spaced."""
        return np.linspace(*self.span, GRID)


@dataclass(frozen=True, eq=False)
class TableTest:
    """One test.

    record: what the table played, at any scale. overturned: by specimen; None: not tested. authors: outcomes of the
    authors' simulations by specimen, {setting: overturned}. motion: that of the table as measured; None: there is none,
    and nothing can be run.
    """

    name: str
    record: str
    overturned: tuple[bool | None, ...]
    motion: SampledMotion | None = None
    authors: tuple[dict[str, bool], ...] = ()
    stated: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Campaign:
    """Specimens and tests of a campaign.

    name: as on pages. cite: how to cite it, and where it is available. missing: tests without a motion. published:
    sampling rate of the files as published [Hz]; 0: they are as published.
    """

    name: str
    specimens: tuple[Specimen, ...]
    tests: tuple[TableTest, ...]
    cite: str = ""
    missing: tuple[TableTest, ...] = ()
    published: float = 0

    def digest(self) -> str:
        """Return a digest of names, motions and outcomes: it tells whether another copy is the same."""
        content = hashlib.sha256()
        for test in self.tests:
            content.update(repr((test.name, test.record, test.overturned)).encode())
            content.update(test.motion.digest().encode() if test.motion else b"")
        return content.hexdigest()


def flag(file: str | PathLike[str], number: int, column: str, row: dict) -> bool:
    """Read an outcome in a list of tests: 1 or 0.

    Raises
    ------
    SettingError
        It says something else.
    """
    value = row[column]
    if isinstance(value, bool) or str(value).strip() not in ("0", "1", "0.0", "1.0"):
        raise SettingError(f"{file}, row {number}, {column} = {value!r}: no outcome; write 1 (overturned) or 0 (not)")
    return float(value) == 1


def disclosed(sums: dict[str, Any], *sizes: int) -> dict[str, Any]:
    """Return `sums` if they may be stored or shown, else {name: None}.

    The data of a campaign may not be passed on. The one rule is that sums over at least `FEWEST` tests are disclosed:
    where one of the `sizes` is smaller, and not 0, all of `sums` are None. sizes: numbers of tests in the sums, and in
    what follows from them as a difference of two.
    """
    return dict.fromkeys(sums) if any(0 < size < FEWEST for size in sizes) else sums


def thinned(tests: Sequence[TableTest], every: int) -> Sequence[TableTest]:
    """Return one in `every` tests, from the first.

    More tests are returned if those were under one record or fewer than `FEWEST`.
    """
    while every > 1 and (len(tests[::every]) < FEWEST or len({test.record for test in tests[::every]}) < 2):
        every -= 1
    return tests[::every]


def outcomes_of(tests: Sequence[TableTest], specimen: int) -> np.ndarray:
    """Return what overturned, bool, shape (tests,)."""
    return np.array([bool(test.overturned[specimen]) for test in tests])


CORNER = 0.2  # Hz; below it a measured acceleration is drift
TABLE = "PGV of the table"
PADDED = 9  # samples by which the filter extends a motion at either end; the motion has to be longer


def unfit(motion: SampledMotion) -> str | None:
    """Return why a motion has no PGA or PGV whose logarithm can be taken, and the remedy; None: it has both."""
    if (count := len(motion.samples)) <= PADDED:
        return f"holds {count} samples, PGV needs {PADDED + 1} or more; give the whole record, or remove the test"
    if not motion.dt < 0.5 / CORNER:
        return (
            f"sampled at {motion.dt:g} s, PGV above {CORNER:g} Hz needs less than {0.5 / CORNER:g} s; give it as it "
            "was sampled, or mend its step"
        )
    if np.ptp(motion.samples) == 0 or not _peak_velocity(motion) > 0:
        return f"is {motion.samples[0]:g} m/s2 throughout, no shaking; give what was measured, or remove the test"
    return None


def measures_of(campaign: Campaign) -> dict[str, np.ndarray]:
    """Return PGA [g] and PGV [m/s] of each test, arrays of shape (tests,).

    They are what the campaign states for the motion sent to the table, with the PGV of the measured motion beside them.
    If nothing is stated, both are those of the measured motion.
    """
    tests, gravity = campaign.tests, campaign.specimens[0].scene.gravity
    table = np.array([_peak_velocity(test.motion) for test in tests])
    if not all({"peak", "ratio"} <= test.stated.keys() for test in tests):
        return {"PGA": np.array([test.motion.peak / gravity for test in tests]), "PGV": table}
    peak, ratio = (np.array([test.stated[name] for test in tests]) for name in ("peak", "ratio"))
    return {"PGA": peak, "PGV": peak * ratio * gravity, TABLE: table}


def _peak_velocity(motion):
    """Peak velocity [m/s] of a measured acceleration, without the drift that its integral would gather."""
    steady = motion.samples - motion.samples.mean()
    high = butter(2, CORNER, "highpass", fs=1 / motion.dt, output="sos")
    return peak_velocity(SampledMotion(motion.dt, sosfiltfilt(high, steady, padlen=PADDED), motion.label))


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
SECONDS = 1.0  # s at the beginning, in which the table is at rest: its accelerometer then shows its offset

# From the meshes, by the density 2700 kg/m3: mass [kg], height of the centre of mass over the lowest point [m]. The
# smallest angle [deg] between the vertical and the line from the nearest edge of the footprint to the centre of mass,
# where all points within 2, 5, 10 mm of the lowest one are the footprint.
DENSITY = 2700.0
BOULDERS = {"boulder 1": (331.0, 0.294, (5.8, 10.1, 12.9)), "boulder 2": (335.0, 0.292, (8.5, 11.1, 13.8))}
# m5: moment of inertia about the centre of mass over the density. The meshes have about .0074 and .0064 about their two
# horizontal axes, both boulders alike. It is not said about which they rocked, so this is the mean.
INERTIA = 0.0069
SPAN = (2.0, 14.0)  # deg: wider on either side than the angles of the meshes
UPRIGHT = np.radians(10.0)  # in the scene until a slenderness is fitted: no drawing gives it


def specimens() -> tuple[Specimen, ...]:
    """Return the two boulders as planar blocks."""
    blocks = []
    for name, (mass, height, footprints) in BOULDERS.items():
        radius = float(height / np.cos(UPRIGHT))
        corner = INERTIA * DENSITY + mass * radius**2
        block = Block(mass=mass, radius=radius, slenderness=float(UPRIGHT), corner_inertia=corner)
        angles = " or ".join(f"{angle:g}" for angle in footprints)
        note = (
            f"slenderness by the mesh: {angles} deg, the footprint being all within 2, 5 or 10 mm of the lowest point"
        )
        low, high = np.radians(SPAN).tolist()
        blocks.append(Specimen(name, Scene(block=block, name=name), (low, high), note))
    return tuple(blocks)


def _published_folder(folder: Path) -> Path | None:
    """Find the published files in a folder or in a checkout of the repository; None: they are not there."""
    return next((place for place in (folder, folder / BELOW) if (place / RESULTS).is_file()), None)


def _read_published(place: Path, every: int, progress: Callable[[int, int], None]) -> Campaign:
    """Read the published campaign in a folder; see `read_campaign`."""
    results = _read_table(place / RESULTS, NUMBER, SHEET)
    records = {row["Test No."]: (at, row) for at, row in _read_table(place / RECORDS, "Test No.")}
    names = list(BOULDERS)
    authors = [_author_settings(results, number) for number in range(1, len(names) + 1)]
    files, with_motion, missing = {}, [], []
    for at, row in results:
        number = row[NUMBER]
        if type(number) is not int or number not in records:
            raise SettingError(
                f"{place / RESULTS}, row {at}, {NUMBER} = {number!r}: {RECORDS} has no such test; fetch both again"
            )
        measured = tuple(flag(place / RESULTS, at, MEASURED.format(k), row) for k in range(1, len(names) + 1))
        authors_answers = tuple(
            {word: flag(place / RESULTS, at, title, row) for word, title in titles.items()} for titles in authors
        )
        line, record = records[number]
        stated = {key: float(record[title]) for title, key in STATED.items() if type(record.get(title)) in (int, float)}
        if zero := next((title for title, key in STATED.items() if not stated.get(key, 1.0) > 0), None):
            raise SettingError(
                f"{place / RECORDS}, row {line}, {zero} = {record[zero]!r}: not above 0; fetch the file again"
            )
        test = TableTest(str(number), record_of(record[RECORD]), measured, None, authors_answers, stated)
        if (file := _motion_file(place, number)) is None:
            missing.append(test)
        else:
            files[test.name] = file
            with_motion.append(test)
    chosen, tests = thinned(with_motion, every), []
    for count, test in enumerate(chosen, 1):
        tests.append(replace(test, motion=motion_of(files[test.name])))
        progress(count, len(chosen))
    cite = f"{CITE}; {WHERE}"
    return Campaign("two granite boulders", specimens(), tuple(tests), cite, tuple(missing), PUBLISHED)


def motion_of(file: Path) -> SampledMotion:
    """Return the table's acceleration [m/s2] at the sampling of the file, less its offset.

    The offset is the median of the first second.
    """
    try:
        motion = read_record(file, "g", column=COLUMN)
    except SceneError as error:
        raise SettingError(f"{error} (a test without its file is left out)") from error
    rest = motion.samples[: max(int(SECONDS / motion.dt), 1)]
    motion = SampledMotion(motion.dt, motion.samples - np.median(rest), file.name, motion.warnings)
    if why := unfit(motion):
        raise SettingError(f"{file}: {why} (a test without its file is left out)")
    return motion


def record_of(written: Any) -> str:
    """Return a record's name without the marks about it: both components of a station's record are one record."""
    words = re.sub(r"x?\.xlsx$|\.AT2$", "", str(written).strip(" '\""), flags=re.I)
    number = re.match(r"RSN(\d+)", words, re.I)
    return f"RSN{number[1]}" if number else words


def _motion_file(place, number):
    """Find the motion file of a test; None: there is none."""
    names = (f"Test{number:03d}.txt", f"Test{number:03d}.txt.gz")
    return next((place / name for name in names if (place / name).is_file()), None)


def _author_settings(results: Sequence[tuple[int, dict]], specimen: int) -> dict[str, str]:
    """Return {setting of the authors' discrete elements: title of its column}."""
    pattern = re.compile(rf"Specimen {specimen}-Numerical (.+)")
    return {match[1]: title for title in results[0][1] if (match := pattern.fullmatch(title))} if results else {}


def _read_table(path: Path, first: str, sheet: str | None = None) -> list[tuple[int, dict]]:
    """Read a sheet with a column `first` as [(number of the row, {title: value})]."""
    rows = _read_cells(path, sheet)
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


def _read_cells(path, sheet):
    """Read the rows of a sheet, or of the only one."""
    try:
        from openpyxl import load_workbook
    except ImportError as error:
        raise SettingError(f'{path}: needs openpyxl; pip install -e ".[records]" installs it') from error
    try:
        with path.open("rb") as file:
            book = load_workbook(file, read_only=True, data_only=True)
            if sheet is not None and sheet not in book.sheetnames:
                names = ", ".join(book.sheetnames)
                raise SettingError(f"{path}: no sheet {sheet!r}, but {names}; fetch the file again")
            return [tuple(row) for row in book[sheet or book.sheetnames[0]].iter_rows(values_only=True)]
    except SettingError:
        raise
    except Exception as error:  # whatever a damaged archive or its XML raises
        raise SettingError(f"{path}: no readable workbook ({type(error).__name__}: {error}); fetch it again") from error


SCENE, TESTS = "scene.toml", "tests.csv"
LARGEST = 10_000_000  # bytes of a list of tests
STEEPEST = 1.5  # rad
OWN_SPAN = (0.5, 1.5)  # over the slenderness of one's own scene
OWN_COLUMNS = ("motion", "overturned", "name", "record", "units")


def read_campaign(
    folder: str | PathLike[str], every: int = 1, progress: Callable[[int, int], None] = lambda done, total: None
) -> Campaign:
    """Read the campaign in a folder.

    every: only one in so many of the tests that have a motion is read; see `thinned`.

    Raises
    ------
    SettingError
        No such folder, or none of the two layouts; a sheet, a column or a value is not as it should be. The message
        names the file, the row, the value and the remedy.
    SceneError
        As `read_record` and `load_scene`.
    """
    place = Path(folder)
    if not place.is_dir():
        raise SettingError(f"--data {folder}: no such folder; give the one that holds the tests")
    if (published := _published_folder(place)) is not None:
        campaign, listed = _read_published(published, every, progress), published / RECORDS
    elif (place / TESTS).is_file():
        campaign, listed = _read_own(place, every, progress), place / TESTS
    else:
        raise SettingError(
            f"--data {folder}: holds neither {RESULTS} (as published) nor {TESTS} (your own tests); "
            f"give such a folder: {WHERE}"
        )
    if not campaign.tests:
        raise SettingError(f"--data {folder}: no test has a motion; fetch them again, or give another folder")
    if len({test.record for test in campaign.tests}) == 1:
        test = campaign.tests[0]
        raise SettingError(
            f"{listed}, record = {test.record!r}: no test is under another ({len(campaign.tests)} in all), and each "
            "record is held out in turn; add tests under a second record"
        )
    if len(campaign.tests) < FEWEST:
        raise SettingError(
            f"{listed}: {len(campaign.tests)} tests, and sums over fewer than {FEWEST} are not disclosed; add tests"
        )
    return campaign


def _read_own(place, every, progress):
    """Read a campaign of one's own tests."""
    scene, rows = _read_scene(place), _read_tests(place / TESTS)
    tests, rows_of = [], {}
    for count, (number, row) in enumerate(rows, 1):
        name = row.get("name") or str(number - 1)
        record, fell = row.get("record") or name, flag(place / TESTS, number, "overturned", row)
        motion = _read_motion(place, number, row, scene)
        first, first_record = rows_of.setdefault(motion.digest(), (number, record))
        if first_record != record:
            raise SettingError(
                f"{place / TESTS}, row {number}, record = {record!r}: its motion is that of row {first}, under the "
                f"record {first_record!r}; tests under one motion tell the same: give both one record"
            )
        tests.append(TableTest(name, record, (fell,), motion))
        progress(count, len(rows))
    names = [test.name for test in tests]
    if repeated := next((name for name in names if names.count(name) > 1), None):
        raise SettingError(f"{place / TESTS}: two tests are called {repeated!r}; give each a name of its own")
    slenderness = scene.block.slenderness
    span = (OWN_SPAN[0] * slenderness, min(OWN_SPAN[1] * slenderness, STEEPEST))
    note = f"slenderness of its scene file: {slenderness:.4g} rad"
    return Campaign(place.resolve().name, (Specimen(scene.name, scene, span, note),), tuple(thinned(tests, every)))


def _read_scene(place):
    """Read the block and its support; refuse what a test or a solver brings itself."""
    try:
        scene = load_scene(place / SCENE)
    except SceneError as error:
        raise SettingError(f"--data {place}: {error}") from error
    moves = {f"start.{name}": value or None for name, value in scene.start.model_dump().items()}
    refused = {
        "block.restitution": (scene.block.restitution, "engines that are judged decide it"),
        "motion": (scene.motion and scene.motion.label, "each test has its own"),
        "run.duration": (scene.duration, "a test is run until its outcome is decided"),
        **{name: (value, "a tested block stands at rest before its motion") for name, value in moves.items()},
    }
    for name, (value, why) in refused.items():
        if value is not None:
            raise SettingError(f"{place / SCENE}: {name} = {value!r}: {why}; leave it out")
    return scene


def _read_tests(path):
    """Read a list of tests as [(number of the line, {column: text})]."""
    try:
        text = read_plain(path, LARGEST).decode("utf-8-sig")
        lines = list(csv.reader(io.StringIO(text)))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SettingError(f"{path}: cannot be read ({error}); write it as CSV in UTF-8") from error
    head = [word.strip() for word in lines[0]] if lines else []
    if absent := [name for name in OWN_COLUMNS[:2] if name not in head]:
        raise SettingError(f"{path}, row 1: no column {absent[0]!r}; it needs {OWN_COLUMNS[0]} and {OWN_COLUMNS[1]}")
    if unknown := [name for name in head if name not in OWN_COLUMNS]:
        raise SettingError(f"{path}, row 1: column {unknown[0]!r} is none of {', '.join(OWN_COLUMNS)}; remove it")
    if repeated := next((name for name in head if head.count(name) > 1), None):
        raise SettingError(f"{path}, row 1: two columns are called {repeated!r}; remove one")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if not any(word.strip() for word in line):
            continue
        if len(line) != len(head):
            raise SettingError(f"{path}, row {number}: holds {len(line)} columns, the first row {len(head)}; mend it")
        rows.append((number, dict(zip(head, map(str.strip, line), strict=True))))
    return rows


def _read_motion(place, number, row, scene):
    """Read the table's motion of a test as its file has it, and check that the scene can be run with it."""
    where = f"{place / TESTS}, row {number}"
    if row.get("units", "") not in ("", *UNITS):
        raise SettingError(
            f"{where}, units = {row['units']!r}: no unit of acceleration; give one of {', '.join(UNITS)}"
        )
    if not row["motion"]:
        raise SettingError(f"{where}, motion = '': missing; give a record file, or remove the row")
    where += f", motion = {row['motion']!r}"
    try:
        motion = read_record(place / row["motion"], row.get("units") or None)
        scene.with_(motion=motion)
    except SceneError as error:
        raise SettingError(f"{where}: {error}") from error
    if why := unfit(motion):
        raise SettingError(f"{where}: {why}")
    return motion
