"""A campaign of shake-table tests: specimens, and tests with the motion of the table and what overturned."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike

import numpy as np

from analytic import SampledMotion, Scene
from analytic.errors import SettingError

GRID = 61  # slendernesses of a grid


@dataclass(frozen=True, eq=False)
class Specimen:
    """A block that was tested. scene: it and its support; the slenderness there is that of a drawing, or stands in
    place of one. span: slendernesses [rad] among which the fitted one is sought. note: what else is known of it."""

    name: str
    scene: Scene
    span: tuple[float, float]
    note: str = ""

    def slendernesses(self) -> np.ndarray:
        """Those of the grid [rad], from `GRID` one to the next."""
        return np.linspace(*self.span, GRID)


@dataclass(frozen=True, eq=False)
class TableTest:
    """A test. record: what the table played, at any scale. overturned: by specimen; None: not tested. authors: what a
    simulation of others said, {specimen: {its setting: overturned}}. motion: of the table as measured; None: there is
    none, and nothing can be run."""

    name: str
    record: str
    overturned: tuple[bool | None, ...]
    motion: SampledMotion | None = None
    authors: tuple[dict[str, bool], ...] = ()
    stated: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Campaign:
    """name: as pages call it. cite: how to cite it, and where it is to be had. missing: tests without a motion.
    published: sampling of the files as published [Hz], 0 where there is no other."""

    name: str
    specimens: tuple[Specimen, ...]
    tests: tuple[TableTest, ...]
    cite: str = ""
    missing: tuple[TableTest, ...] = ()
    published: float = 0

    def digest(self) -> str:
        """Of names, motions and outcomes: whether another has the same at hand."""
        content = hashlib.sha256()
        for test in self.tests:
            content.update(repr((test.name, test.record, test.overturned)).encode())
            content.update(test.motion.digest().encode() if test.motion else b"")
        return content.hexdigest()


def flag(file: str | PathLike[str], number: int, column: str, row: dict) -> bool:
    """What a list of tests says of an outcome: 1 or 0.

    Raises
    ------
    SettingError
        It says something else.
    """
    value = row[column]
    if isinstance(value, bool) or str(value).strip() not in ("0", "1", "0.0", "1.0"):
        raise SettingError(f"{file}, row {number}, {column} = {value!r}: no outcome; write 1 (overturned) or 0 (not)")
    return float(value) == 1


def thinned(tests: Sequence[TableTest], every: int) -> Sequence[TableTest]:
    """The first of so many tests, of fewer where those were all under one record."""
    while every > 1 and len({test.record for test in tests[::every]}) < 2:
        every -= 1
    return tests[::every]


def outcomes_of(tests: Sequence[TableTest], specimen: int) -> np.ndarray:
    """What overturned, bool, shape (tests,)."""
    return np.array([bool(test.overturned[specimen]) for test in tests])
