"""Errors that a user can correct, limited reading of files that users name, and types used in signatures.

Each message names place, value and remedy. Only plain files of limited size are read, so that no read blocks.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable
from os import PathLike
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np

KEY_LENGTH, VALUE_LENGTH, TEXT_LENGTH, FILE_LENGTH = 100, 120, 500, 400  # characters of the parts of a message
MOST_LINES = 20  # mistakes listed in one message, so that it fits on a screen; further ones are counted


def cut(text: object, length: int) -> str:
    """Return the text on one line, printable; of a longer text than `length` characters the middle is left out."""
    text = str(text)
    if len(text) > length:
        text = f"{text[: length * 2 // 3]} ... {text[-(length // 6) :]} ({len(text)} characters)"
    return "".join(sign if sign.isprintable() else ascii(sign)[1:-1] for sign in text)


def _shown(value: object) -> str:
    """Return the value as Python writes it, of readable length."""
    if isinstance(value, int) and value.bit_length() > 4 * VALUE_LENGTH:
        return f"an integer of {value.bit_length()} bits"
    if isinstance(value, str) and len(value) > VALUE_LENGTH:
        return repr(value[: VALUE_LENGTH * 2 // 3]) + f" ... ({len(value)} characters)"
    try:
        return cut(repr(value), VALUE_LENGTH)
    except (ValueError, RecursionError):  # huge integers and deep nesting inside of it
        return f"something that cannot be printed ({type(value).__name__})"


class SceneError(ValueError):
    """A scene that cannot be simulated.

    Parameters
    ----------
    key : str
        Dotted name of the field, as in a scene file (``block.mass``).
    value : object
        The value of that field.
    problem, remedy : str
        What is wrong with it, and what to write instead.
    file : str or None
        The scene file or record, where there is one.
    others : tuple of SceneError
        Further mistakes found with this one, none of which has others.
    """

    def __init__(
        self,
        key: str,
        value: object,
        problem: str,
        remedy: str,
        file: str | None = None,
        others: tuple[SceneError, ...] = (),
    ) -> None:
        self.key, self.value, self.problem, self.remedy, self.file = key, value, problem, remedy, file
        self.others = others
        super().__init__(key, value, problem, remedy, file, others)  # all of them, for pickle

    def __str__(self) -> str:
        return "\n".join(self.lines)

    @property
    def lines(self) -> list[str]:
        """Return the message: one line of readable length for each mistake."""
        lines = [mistake._line() for mistake in (self, *self.others)[:MOST_LINES]]
        left = len(self.others) + 1 - len(lines)
        return [*lines, f"and {left} more"] if left else lines

    def _line(self) -> str:
        where = f"{cut(self.file, FILE_LENGTH)}: " if self.file else ""
        value_text = "" if self.value is None else f" = {_shown(self.value)}"
        problem, remedy = cut(self.problem, TEXT_LENGTH), cut(self.remedy, TEXT_LENGTH)
        return f"{where}{cut(self.key, KEY_LENGTH)}{value_text}: {problem}; {remedy}"

    def with_others(self, *mistakes: SceneError) -> SceneError:
        """Return the same error with further mistakes, and those that they carry, added."""
        others = (*self.others, *(error for mistake in mistakes for error in (mistake, *mistake.others)))
        return SceneError(self.key, self.value, self.problem, self.remedy, self.file, others)

    def in_file(self, file: str | PathLike[str]) -> SceneError:
        """Return the same error with the name of the file."""
        others = tuple(other.in_file(file) for other in self.others)
        return SceneError(self.key, self.value, self.problem, self.remedy, str(file), others)


class EngineNotInstalled(ImportError):
    """The engine asked for is not installed; the message says how to install it."""


class EngineBroken(EngineNotInstalled):
    """An engine of another package cannot be used; the message names the package that declares it.

    Parameters
    ----------
    origin : str
        The entry and its distribution.
    problem : str
    """

    def __init__(self, origin: str, problem: object) -> None:
        self.origin, self.problem = origin, problem
        super().__init__(origin, problem)

    def __str__(self) -> str:
        return f"{self.origin}: {cut(self.problem, TEXT_LENGTH)}; mend or uninstall that package"


class SettingError(ValueError):
    """A solver setting that does not exist or is out of range."""


def require(holds: object, refusal: str) -> None:
    """Raise `SettingError` with the words of the refusal unless the condition holds."""
    if not holds:
        raise SettingError(refusal)


KINDS = ((stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"), (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"))


def read_plain(path: str | PathLike[str], limit: int) -> bytes:
    """Return the bytes of the plain file at `path`.

    Parameters
    ----------
    path : str or Path
    limit : int
        Largest size read [bytes].

    Raises
    ------
    OSError
        The file does not exist, is a folder, a pipe or a device, is too large, or the path is not valid; see its
        ``strerror``.
    """
    try:
        mode = os.stat(path).st_mode
        # Opening a pipe waits for its writer, and opening a device may act on it, so that neither is opened.
        kind = next((words for is_kind, words in KINDS if is_kind(mode)), None)
        if kind:
            raise OSError(errno.EINVAL, f"is {kind}, not a file: copy what it gives to a file")
        with open(path, "rb") as file:
            content = file.read(limit + 1)  # the stated size is not used: it is 0 for some system files
    except (ValueError, UnicodeError) as error:  # a NUL in the path, or half a character
        raise OSError(errno.EINVAL, "a path cannot contain such characters") from error
    if len(content) > limit:
        raise OSError(errno.EFBIG, f"holds more than {limit / 1e6:.3g} MB")
    return content


GroundFunction = Callable[[float], float]  # a_g(t) [m/s2] of one time [s]
Values = TypeVar("Values", float, "np.ndarray")  # a number or an array; the result has the type of the argument
