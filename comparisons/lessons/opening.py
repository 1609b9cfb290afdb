"""A lesson's notebook in the browser, by marimo."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

from analytic.errors import SettingError

from ..running.files import TemporaryFolder
from .notebook import notebook_file
from .topics import lesson

# Cells run when the notebook opens, which marimo does not do unasked.
SETTINGS = "[tool.marimo.runtime]\nauto_instantiate = true\n"
INSTALL = "pip install marimo, or this project with .[lessons]"


def open_notebook(name: str) -> int:
    """Open the notebook of a lesson, a copy of it; returns marimo's status when it ends.

    Raises
    ------
    SettingError
        There is no such lesson, or marimo is not installed.
    """
    try:
        file = notebook_file(lesson(name))
    except KeyError as error:
        raise SettingError(str(error.args[0])) from None
    if importlib.util.find_spec("marimo") is None:
        raise SettingError(
            f"notebooks need the package marimo: {INSTALL}; rocking lessons export writes pages without it"
        )
    with TemporaryFolder("rocking-lesson-") as folder:
        copy = Path(shutil.copy(file, folder))
        copy.with_name("pyproject.toml").write_text(SETTINGS, encoding="utf-8")
        return subprocess.call([sys.executable, "-m", "marimo", "edit", str(copy)])
