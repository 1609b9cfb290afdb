"""Output of the commands: result files, figures and what the terminal shows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ..execution.writing import STANDARD_OUTPUT, PlaceError, write, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..schemas import Form


def write_output(
    results: Mapping[str | None, Form | str],
    show: Callable[[], object],
    plot: str | None = None,
    draw: Callable[[], Figure] | None = None,
) -> None:
    """Write each result to its file and the figure of `draw` to `plot`, then call `show`.

    results: {file: content}; a content whose file is None is not written. `show` is not called if a result is printed.

    Raises
    ------
    PlaceError
        A file could not be written; the others are written and shown nevertheless.
    """
    files = {path: content for path, content in results.items() if path}
    writers = [
        partial(write_text, path, content if isinstance(content, str) else content.text())
        for path, content in files.items()
    ]
    if plot and draw:
        from ..plotting.plots import picture

        writers.append(partial(write, plot, picture(draw(), Path(plot).suffix), keep=True))
    problems = []
    for writer in writers:
        try:
            writer()
        except PlaceError as error:
            problems.append(str(error))
    if STANDARD_OUTPUT not in files:
        show()
    if problems:
        raise PlaceError("; ".join(problems))
