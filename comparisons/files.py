"""Result files and folders: refused before the work if they cannot be written."""

from pathlib import Path

from analytic.errors import SettingError

PICTURES = (".png", ".svg", ".pdf")


def check_writable(paths, picture=None):
    """Raise `SettingError` if a file (None is skipped) lies in no folder, or is one; or no picture format is meant."""
    if picture and Path(picture).suffix.lower() not in PICTURES:
        raise SettingError(f"{picture}: not a known picture format; end the name in {', '.join(PICTURES)}")
    for path in filter(None, [*paths, picture]):
        path = Path(path)
        if path.is_dir():
            raise SettingError(f"{path}: is a folder; give a file name")
        if not path.parent.is_dir():
            raise SettingError(f"{path}: there is no folder {path.parent}; make it first")


def check_folder(output):
    """Raise `SettingError` if `output`, the folder to write to, is a file; it need not exist."""
    if Path(output).exists() and not Path(output).is_dir():
        raise SettingError(f"--output {output}: is a file; give a folder")


def write_text(path, text):
    """Write `text` to the file `path` in UTF-8."""
    Path(path).write_text(text, encoding="utf-8")
