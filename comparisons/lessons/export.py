"""The pages that one can open without a network: `export_pages`."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from .playground import PAGE, playground_page


def export_pages(folder: str | PathLike[str]) -> list[Path]:
    """Write the pages into `folder`, which exists; returns their paths."""
    path = Path(folder) / PAGE
    path.write_text(playground_page(), encoding="utf-8")
    return [path]
