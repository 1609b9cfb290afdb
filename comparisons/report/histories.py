"""Histories of the report's runs: kept in files, so that memory holds one at a time; reduced for drawing.

Measured is what was computed; thinned only what a figure or the result file shows of a long record.
"""

import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from analytic.response import History, Response

from ..running.cases import Case
from ..running.files import write
from ..running.provenance import ResultError

# A history of up to so many samples is shown whole; of a longer one the extremes in each of so many parts.
MOST_SHOWN, PARTS = 20_000, 1_500


@dataclass(frozen=True)
class ToFile:
    """Measure: everything, the history as a file in `folder`, an array for each of its columns."""

    folder: str

    def __call__(self, case: Case, response: Response) -> dict[str, Any]:
        content = (response.scene, response.engine, response.variant)
        name = hashlib.sha256(repr(content).encode()).hexdigest()[:16] + ".npz"
        data = io.BytesIO()
        np.savez(data, **{column: getattr(response.history, column) for column in response.history.columns})
        write(Path(self.folder) / name, data.getbuffer())
        return {**response.to_json(), "history": name}


def response_of(values: Mapping[str, Any], folder: str | PathLike[str]) -> Response:
    """The `Response` of a row's values, its history from `folder`."""
    file = values["history"]
    return Response.from_json(
        {key: value for key, value in values.items() if key != "history"}, _history(Path(folder) / file)
    )


def _history(path):
    if not path.exists():
        raise ResultError(
            f"{path.parent.name}/{path.name}: missing; remove the folder {path.parent.name} and make the report again"
        )
    with np.load(path) as table:
        return History(**table)


def differences(history: History, reference: History) -> dict[str, np.ndarray]:
    """{"apart/time", "apart/tilt", "apart/base_displacement": array}: history minus reference, thinned; and the slip's.

    At the reference's samples up to the end of the shorter one.
    """
    time = reference.time[reference.time <= history.time[-1]]
    slip = ("slip",) if history.slip is not None and reference.slip is not None else ()
    apart = {
        column: np.interp(time, history.time, getattr(history, column)) - getattr(reference, column)[: len(time)]
        for column in ("tilt", "base_displacement", *slip)
    }
    shown = thinned(*apart.values())
    return {f"apart/{column}": values[shown] for column, values in {"time": time, **apart}.items()}


def thinned(*columns: np.ndarray, most: int = MOST_SHOWN, parts: int = PARTS) -> np.ndarray:
    """Indices, in order, of the samples to draw of columns of equal length.

    All of up to `most` samples. Else both ends, and where each column is least and greatest in each of so many
    equal parts: no peak is lost, and a line through them covers what a line through all covers.
    """
    count = len(columns[0])
    if count <= most:
        return np.arange(count)
    edges = np.linspace(0, count, parts + 1).astype(int)
    kept = [0, count - 1]
    for column in columns:
        for begin, end in zip(edges[:-1], edges[1:], strict=True):
            kept += [begin + int(column[begin:end].argmin()), begin + int(column[begin:end].argmax())]
    return np.unique(kept)
