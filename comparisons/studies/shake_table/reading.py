"""A campaign read from a folder of one of two layouts.

    campaign = read_campaign("folder")

That of the tests of two granite boulders, as their authors publish them (`granite`), or the checkout of their
repository. Or one's own: a scene file ``scene.toml`` of the block, and ``tests.csv`` with a line for each test, its
columns ``motion`` (a record file in the folder), ``overturned`` (1 or 0) and, if there are any, ``units`` (of a file
that states none), ``name`` and ``record``: tests under one record at several scales say the same there, and count as
one where intervals are told. Its motions are taken as they are. The scene has no motion, start, duration or restitution
of its own.

All that is computed of a campaign later is asked of it here, before anything is run: two records or more, as each is
held out in turn, and motions that have a PGA and a PGV.
"""

import csv
import io
from collections.abc import Callable
from os import PathLike
from pathlib import Path

from analytic import SceneError, load_scene
from analytic.errors import SettingError
from analytic.files import read_plain
from analytic.records import UNITS, read_record

from . import granite
from .campaign import Campaign, Specimen, TableTest, flag, thinned
from .measures import unfit

SCENE, TESTS = "scene.toml", "tests.csv"
LARGEST = 10_000_000  # bytes of a list of tests
STEEPEST = 1.5  # rad
OWN_SPAN = (0.5, 1.5)  # of the slenderness of one's own scene
OWN_COLUMNS = ("motion", "overturned", "name", "record", "units")


def read_campaign(
    folder: str | PathLike[str], every: int = 1, progress: Callable[[int, int], None] = lambda done, total: None
) -> Campaign:
    """The campaign in a folder; every: only the first of so many tests that have a motion, or of fewer where these are
    under one record.

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
    if (published := granite.place_in(place)) is not None:
        found, listed = granite.read(published, every, progress), published / granite.RECORDS
    elif (place / TESTS).is_file():
        found, listed = _own(place, every, progress), place / TESTS
    else:
        raise SettingError(
            f"--data {folder}: holds neither {granite.RESULTS} (as published) nor {TESTS} (your own tests); "
            f"give such a folder: {granite.WHERE}"
        )
    if not found.tests:
        raise SettingError(f"--data {folder}: no test has a motion; fetch them again, or give another folder")
    if len({test.record for test in found.tests}) == 1:
        test = found.tests[0]
        raise SettingError(
            f"{listed}, record = {test.record!r}: no test is under another ({len(found.tests)} in all), and each "
            "record is held out in turn; add tests under a second record"
        )
    return found


def _own(place, every, progress):
    scene, rows = _scene(place), _rows(place / TESTS)
    tests, rows_of = [], {}
    for count, (number, row) in enumerate(rows, 1):
        name = row.get("name") or str(number - 1)
        record, fell = row.get("record") or name, flag(place / TESTS, number, "overturned", row)
        motion = _motion(place, number, row, scene)
        first, known = rows_of.setdefault(motion.digest(), (number, record))
        if known != record:
            raise SettingError(
                f"{place / TESTS}, row {number}, record = {record!r}: its motion is that of row {first}, under the "
                f"record {known!r}; tests under one motion tell the same: give both one record"
            )
        tests.append(TableTest(name, record, (fell,), motion))
        progress(count, len(rows))
    names = [test.name for test in tests]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise SettingError(f"{place / TESTS}: two tests are called {twice!r}; give each a name of its own")
    drawn = scene.block.slenderness
    span = (OWN_SPAN[0] * drawn, min(OWN_SPAN[1] * drawn, STEEPEST))
    note = f"slenderness of its scene file: {drawn:.4g} rad"
    return Campaign(place.resolve().name, (Specimen(scene.name, scene, span, note),), tuple(thinned(tests, every)))


def _scene(place):
    """The block and its support; what a test brings itself, or a solver, is refused."""
    try:
        scene = load_scene(place / SCENE)
    except SceneError as error:
        raise SettingError(f"--data {place}: {error}") from error
    moves = {f"start.{name}": value or None for name, value in scene.start.model_dump().items()}
    given = {
        "block.restitution": (scene.block.restitution, "engines that are judged decide it"),
        "motion": (scene.motion and scene.motion.label, "each test has its own"),
        "run.duration": (scene.duration, "a test is run until its outcome is decided"),
        **{name: (value, "a tested block stands at rest before its motion") for name, value in moves.items()},
    }
    for name, (value, why) in given.items():
        if value is not None:
            raise SettingError(f"{place / SCENE}: {name} = {value!r}: {why}; leave it out")
    return scene


def _rows(path):
    """(number of the line, {column: text}) of a list of tests."""
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
    if twice := next((name for name in head if head.count(name) > 1), None):
        raise SettingError(f"{path}, row 1: two columns are called {twice!r}; remove one")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if not any(word.strip() for word in line):
            continue
        if len(line) != len(head):
            raise SettingError(f"{path}, row {number}: holds {len(line)} columns, the first row {len(head)}; mend it")
        rows.append((number, dict(zip(head, map(str.strip, line), strict=True))))
    return rows


def _motion(place, number, row, scene):
    """The table's motion of a test, as its file has it; the scene can be run with it."""
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
