"""Reading files that users name: plain files of a bearable size and nothing else, so that no read ever blocks."""

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
        Its ``strerror`` says why: not there, a folder, a pipe or device, too large, or a path no system has.
    """
    try:
        mode = os.stat(path).st_mode
        # Opening a pipe waits for its writer and opening a device may act on it: neither is ever opened.
        kind = next((words for is_kind, words in KINDS if is_kind(mode)), None)
        if kind:
            raise OSError(errno.EINVAL, f"is {kind}, not a file: copy what it gives to a file")
        with open(path, "rb") as file:
            content = file.read(limit + 1)  # not by its size: some system files state none
    except (ValueError, UnicodeError) as error:  # a NUL in the path, or half a character
        raise OSError(errno.EINVAL, "no path has such characters") from error
    if len(content) > limit:
        raise OSError(errno.EFBIG, f"holds more than {limit / 1e6:.3g} MB")
    return content
