"""Histories of the report's runs: in files while it is made, so that memory holds one at a time; thinned for drawing;
and on one clock, as the page's script moves them.

Measured is what was computed; thinned only what a figure or the result file shows of a long record.
"""

import hashlib
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from analytic.response import History, Response

from ..running.cases import Case
from ..running.files import write
from ..running.provenance import Result, ResultError

# A history of up to so many samples is shown whole; of a longer one the extremes in each of so many parts.
MOST_SHOWN, PARTS = 20_000, 1_500


@dataclass(frozen=True)
class ToFile:
    """Measure: everything, the history as a file in `folder`, an array for each column of `History`."""

    folder: str

    def __call__(self, case: Case, response: Response) -> dict[str, Any]:
        content = (response.scene, response.engine, response.variant)
        name = hashlib.sha256(repr(content).encode()).hexdigest()[:16] + ".npz"
        data = io.BytesIO()
        np.savez(data, **{column: getattr(response.history, column) for column in History.COLUMNS})
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
        return History(*(table[column] for column in History.COLUMNS))


def differences(history: History, reference: History) -> dict[str, np.ndarray]:
    """{"apart/time", "apart/tilt", "apart/base_displacement": array}: history minus reference, thinned.

    At the reference's samples up to the end of the shorter one.
    """
    time = reference.time[reference.time <= history.time[-1]]
    apart = {
        column: np.interp(time, history.time, getattr(history, column)) - getattr(reference, column)[: len(time)]
        for column in ("tilt", "base_displacement")
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


FRAMES = 25.0  # 1/s
LONGEST = 2000  # frames; a longer run is shown in longer steps
LYING = math.pi / 2
ANALYTIC = "analytic"


def animation(result: Result) -> dict[str, Any] | None:
    """What is moved, JSON-ready; None where no run has a history.

    step [s], count of frames, still [s] (the frame to begin with), ground: acceleration [m/s2] at the frames; scenes:
    name, size (half width and height [m]), base, limit of what is drawn [m], and tracks: who, tilt [rad] and, with a
    base, x [m] at the frames, up to where the run ended.
    """
    names = [name for name in result.settings["scenes"] if f"{name}/{ANALYTIC}/time" in result.arrays]
    if not names:
        return None
    end = max(float(result.arrays[f"{name}/{ANALYTIC}/time"][-1]) for name in names)
    step = max(1.0 / FRAMES, end / LONGEST)
    times = np.arange(0.0, end + step / 2, step)
    scenes = [_scene(result, name, times) for name in names]
    ground = (
        np.interp(times, result.arrays["motion/time"], result.arrays["motion/acceleration"], left=0.0, right=0.0)
        if "motion/time" in result.arrays
        else np.zeros_like(times)
    )
    return {
        "step": round(step, 6),
        "count": len(times),
        "still": _still(scenes, step),
        "ground": [round(float(value), 3) for value in ground],
        "scenes": scenes,
    }


def _scene(result, name, times):
    scene = result.settings["scenes"][name]
    tracks = [
        _track(result, f"{name}/{row['engine']}", times, row["engine"], scene["base"] is not None)
        for row in result.rows
        if row["scene"] == name and not row["failure"] and f"{name}/{row['engine']}/time" in result.arrays
    ]
    reach = max((abs(x) for track in tracks for x in track.get("x", ())), default=0.0)
    return {
        "name": scene["name"],
        "size": [round(scene["half_width"], 5), round(scene["half_height"], 5)],
        "base": scene["base"] is not None,
        "bearings": scene["bearings"] is not None,
        "reach": round(reach, 3),
        "tracks": tracks,
    }


def _track(result, key, times, who, base):
    """A run at the frames up to its end; a block that overturned lies down from there on."""
    own = result.arrays[f"{key}/time"]
    kept = times[times <= own[-1] + 1e-9]
    tilt = np.clip(np.interp(kept, own, result.arrays[f"{key}/tilt"]), -LYING, LYING)
    track = {"who": who, "tilt": [round(float(value), 4) for value in tilt]}
    if base:
        track["x"] = [
            round(float(value), 4) for value in np.interp(kept, own, result.arrays[f"{key}/base_displacement"])
        ]
    return track


def _still(scenes, step):
    """A time with something to see: the first block that tips, well off its base and not yet down, else the peak."""
    for scene in scenes:
        tilt = np.abs(scene["tracks"][0]["tilt"])
        if tilt.max(initial=0.0) > 1.0:
            return round(float(np.argmax(tilt > 0.5)) * step, 4)
    found = [np.abs(scene["tracks"][0].get("x", scene["tracks"][0]["tilt"])) for scene in scenes]
    return round(float(np.argmax(found[-1])) * step, 4)
