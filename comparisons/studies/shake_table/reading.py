"""A campaign read from a folder of one of two layouts.

    campaign = read_campaign("folder")

That of the tests of two granite boulders, as their authors publish them (`granite`), or the checkout of their
repository. Or one's own: a scene file ``scene.toml`` of the block, and ``tests.csv`` with a line for each test, its
columns ``motion`` (a record file in the folder), ``overturned`` (1 or 0) and, if there are any, ``units`` (of a file
that states none), ``name`` and ``record``: tests under one record at several scales say the same there, and count as
one where intervals are told. Its motions are taken as they are.
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
from .campaign import Campaign, Specimen, TableTest, flag

SCENE, TESTS = "scene.toml", "tests.csv"
LARGEST = 10_000_000  # bytes of a list of tests
STEEPEST = 1.5  # rad
OWN_SPAN = (0.5, 1.5)  # of the slenderness of one's own scene
OWN_COLUMNS = ("motion", "overturned", "name", "record", "units")


def read_campaign(
    folder: str | PathLike[str], every: int = 1, progress: Callable[[int, int], None] = lambda done, total: None
) -> Campaign:
    """The campaign in a folder; every: only the first of so many tests that have a motion.

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
        found = granite.read(published, every, progress)
    elif (place / TESTS).is_file():
        found = _own(place, every, progress)
    else:
        raise SettingError(
            f"--data {folder}: holds neither {granite.RESULTS} (as published) nor {TESTS} (your own tests); "
            f"give such a folder: {granite.WHERE}"
        )
    if not found.tests:
        raise SettingError(f"--data {folder}: no test has a motion; fetch them again, or give another folder")
    return found


def _own(place, every, progress):
    try:
        scene = load_scene(place / SCENE)
    except SceneError as error:
        raise SettingError(f"--data {place}: {error}") from error
    rows = _rows(place / TESTS)
    tests = []
    for count, (number, row) in enumerate(rows[::every], 1):
        name = row.get("name") or str(number - 1)
        fell = flag(place / TESTS, number, "overturned", row)
        tests.append(TableTest(name, row.get("record") or name, (fell,), _motion(place, number, row)))
        progress(count, len(rows[::every]))
    names = [test.name for test in tests]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise SettingError(f"{place / TESTS}: two tests are called {twice!r}; give each a name of its own")
    if (given := scene.block.restitution) is not None:
        words = "engines that are judged decide it; leave it out"
        raise SettingError(f"{place / SCENE}: block.restitution = {given!r}: {words}")
    drawn = scene.block.slenderness
    span = (OWN_SPAN[0] * drawn, min(OWN_SPAN[1] * drawn, STEEPEST))
    note = f"slenderness of its scene file: {drawn:.4g} rad"
    specimen = Specimen(scene.name, scene.with_(motion=None, duration=None), span, note)
    return Campaign(place.resolve().name, (specimen,), tuple(tests))


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
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if not any(word.strip() for word in line):
            continue
        if len(line) != len(head):
            raise SettingError(f"{path}, row {number}: holds {len(line)} columns, the first row {len(head)}; mend it")
        rows.append((number, dict(zip(head, map(str.strip, line), strict=True))))
    return rows


def _motion(place, number, row):
    """The table's motion of a test, as its file has it."""
    where = f"{place / TESTS}, row {number}"
    if row.get("units", "") not in ("", *UNITS):
        raise SettingError(
            f"{where}, units = {row['units']!r}: no unit of acceleration; give one of {', '.join(UNITS)}"
        )
    if not row["motion"]:
        raise SettingError(f"{where}, motion = '': missing; give a record file, or remove the row")
    try:
        return read_record(place / row["motion"], row.get("units") or None)
    except SceneError as error:
        raise SettingError(f"{where}, motion = {row['motion']!r}: {error}") from error
