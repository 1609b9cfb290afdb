"""The bearing laws, one file each; compiled code identifies a law by its index in `LAWS`.

A new law is a file, and its name in the first import; `Law` describes what the file holds.
"""

from collections import namedtuple
from types import ModuleType
from typing import Any

from ..kernel.compiled import chosen
from . import algebraic, bilinear, bouc_wen, linear  # noqa: F401 a law named here is in LAWS
from .law import Law

__all__ = ["LAWS", "NUMBERS", "Constants", "Law", "law_function"]

LAWS = tuple(file.LAW for file in list(globals().values()) if isinstance(file, ModuleType) and hasattr(file, "LAW"))
NUMBERS = {law.name: number for number, law in enumerate(LAWS)}


def _record(names: tuple[str, ...]) -> Any:
    return namedtuple("Constants", names, defaults=[0.0] * len(names))


# Constants of all laws: dk, f0, and those of each law; a law fills its own only.
Constants = _record(("dk", "f0", *dict.fromkeys(name for law in LAWS for name in law.constant_names)))


def law_function(name: str) -> Any:
    """Return the compiled function of (law's number, *arguments) that calls the law's function `name`."""
    return chosen([getattr(law, name) for law in LAWS])
