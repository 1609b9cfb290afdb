"""Packed files: gzip, and zip of one file."""

import gzip
import io
import lzma
import struct
import zipfile
import zlib

from ..errors import SceneError

GZIP, ZIP = b"\x1f\x8b", b"PK\x03\x04"
OTHERS = {b"BZh": ("bzip2", "bunzip2"), b"\xfd7zXZ": ("xz", "unxz"), b"PK\x05\x06": ("zip, and empty", "give a record")}
LISTED = 5  # names of files in a message
SPREADSHEET = {"[Content_Types].xml", "content.xml"}  # in the files of Excel, and of LibreOffice
# What gzip and zipfile raise where a file is damaged.
DAMAGE = (
    *(OSError, EOFError, ValueError, RuntimeError, IndexError, OverflowError),
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error),
)


def unpacked(content: bytes, name: str, limit: int) -> tuple[bytes, str]:
    """(content, name) of the file that a packed file holds, or of a plain file as they are.

    Parameters
    ----------
    content : bytes
    name : str
        Name of the file.
    limit : int
        Largest size unpacked [bytes].

    Raises
    ------
    SceneError
        Damaged, locked, too large, several files, or packed by another program or twice.
    """
    if content.startswith(GZIP):
        content, name = _gunzipped(content, limit), name.removesuffix(".gz")
    elif content.startswith(ZIP):
        content, name = _unzipped(content, limit)
    else:
        _refuse(content, OTHERS, "unpack it first")
        return content, name
    if len(content) > limit:
        raise SceneError("record", None, f"unpacks to more than {limit / 1e6:.3g} MB", "give one record of it")
    _refuse(content, OTHERS | {GZIP: ("gzip", "gunzip"), ZIP: ("zip", "unzip")}, "unpack it once, it is packed twice")
    return content, name


def _refuse(content: bytes, packers: dict[bytes, tuple[str, str]], remedy: str) -> None:
    for magic, (packer, command) in packers.items():
        if content.startswith(magic):
            raise SceneError("record", None, f"is packed by {packer}", f"{remedy} ({command})")


def _gunzipped(content: bytes, limit: int) -> bytes:
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as file:
            return file.read(limit + 1)
    except DAMAGE as error:
        raise SceneError("record", None, f"is a damaged gzip file ({error})", "fetch it again") from error


def _unzipped(content: bytes, limit: int) -> tuple[bytes, str]:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            # What macOS adds of its own is no record.
            inside = [
                one for one in archive.infolist() if not one.is_dir() and not one.filename.startswith("__MACOSX/")
            ]
            if SPREADSHEET & {one.filename for one in inside}:
                raise SceneError("record", None, "is a spreadsheet", "save the sheet with the record as CSV")
            if len(inside) != 1:
                names = ", ".join(one.filename for one in inside[:LISTED]) + (", ..." if len(inside) > LISTED else "")
                raise SceneError(
                    "record", None, f"holds {len(inside)} files: {names}", "unpack it and give one of them"
                )
            if inside[0].flag_bits & 1:
                raise SceneError("record", None, "is a zip file with a password", "unpack it first")
            with archive.open(inside[0]) as file:
                return file.read(limit + 1), inside[0].filename
    except SceneError:
        raise
    except DAMAGE as error:
        raise SceneError("record", None, f"is a damaged zip file ({error})", "fetch it again") from error
