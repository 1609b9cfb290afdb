"""Formats that are known and not read: each is refused by its name."""

import re
from collections.abc import Sequence
from typing import NoReturn

from ..errors import SceneError
from .content import Asked

NAME = "a format that is not read"
SIGNS = {"CSMIP volume 1": re.compile(r"\s*uncorrected accelerogram", re.I)}


def recognises(lines: Sequence[str]) -> bool:
    """Whether the first line is that of a known format that is not read."""
    return _name(lines) is not None


def read(lines: Sequence[str], asked: Asked) -> NoReturn:
    """Refuse the file, saying what to do instead."""
    raise SceneError(
        "record",
        None,
        f"is a {_name(lines)} file, which is not read",
        "write its accelerations as two columns, time [s] and acceleration, and give their units",
    )


def _name(lines: Sequence[str]) -> str | None:
    first = next((line for line in lines if line.strip()), "")[:200]
    return next((name for name, sign in SIGNS.items() if sign.search(first)), None)
