"""Reading files named by users: only plain files of limited size, so that no read blocks."""

import errno
import os
import stat
from os import PathLike

KINDS = ((stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"), (stat.S_ISCHR, "a device"), (stat.S_ISBLK, "a device"))


def read_plain(path: str | PathLike[str], limit: int) -> bytes:
    """The bytes of the plain file at `path`.

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
