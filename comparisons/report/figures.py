"""The figures of the report's own runs, each drawn from the arrays and rows of a result file; and the runs on one
clock: what the page's script moves, and the frame shown without one.

Histories of the report's runs: kept in files, so that memory holds one at a time; reduced for drawing.

Measured is what was computed; thinned only what a figure or the result file shows of a long record.
"""

import hashlib
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from analytic.records import G
from analytic.response import LEVEL, History, Response

from ..execution.cases import Case
from ..execution.files import write
from ..execution.provenance import Result, ResultError
from ..plotting.charts import Axis, Chart, figure
from ..plotting.parts import Figure
from ..plotting.plots import mode_spans
from ..schemas.columns import Row, number
from .detail import environment

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


ANALYTIC = "analytic"
TILT = 0.01, 1.6  # least and largest limit of a tilt axis, over slenderness, so that contact noise is not shown
SHOWN = 700  # samples of a line
LEAST = 1e-9  # of a difference drawn
WORDS = {"tilt": "tilt", "slip": "slip", "base_displacement": "displacement"}  # in the titles of panels


def pairs(result: Result, name: str) -> Iterator[list[Chart]]:
    """Of a scene tilt where the block lifts, slip where it slides, and base displacement where there is a base: all
    solvers over each other, and how far the engines are from the analytic model.
    """
    scene = result.settings["scenes"][name]
    rows = drawn(result, name)
    if any(row["outcome"] not in LEVEL for row in rows):
        yield _pair(result, name, rows, "tilt", "tilt φ/γ [-]", scene["block"]["slenderness"])
    if slides(rows):
        whole, *beside = _pair(result, name, rows, "slip", "slip on the support [m]", 1.0)
        for row in rows:
            _shade(whole, row)
        yield [whole, *beside]
    if scene["base"] and rows:
        yield _pair(result, name, rows, "base_displacement", "base displacement x [m]", 1.0)


def drawn(result: Result, name: str) -> list[Row]:
    """The rows of a scene whose histories are there."""
    rows = [row for row in result.rows if row["scene"] == name and not row["failure"]]
    return [row for row in rows if f"{name}/{row['engine']}/time" in result.arrays]


def slides(rows: Sequence[Row]) -> bool:
    """Whether the block slides in one of these runs."""
    return any((row.get("sliding") or {}).get("peak") for row in rows)


def _shade(chart, row):
    """Shade when the block of a run slides, if it tells."""
    spans = [
        (begin, end)
        for begin, end, mode in mode_spans((row.get("sliding") or {}).get("modes") or (), row["end"]["time"])
        if mode in ("slide", "slide-rock")
    ]
    low, high = chart.y.low, chart.y.high
    for begin, end in spans:
        chart.area([begin, end, end, begin], [low, low, high, high], "falls")
    if spans:
        chart.says += f" Shaded: the block slides in {row['engine']}."


def _pair(result, name, rows, column, label, scale):
    scene = result.settings["scenes"][name]
    lines, apart = {}, {}
    for row in rows:
        key = f"{name}/{row['engine']}"
        if f"{key}/{column}" not in result.arrays:
            continue
        lines[row["engine"]] = _line(result, key, column, scale)
        if f"{key}/apart/{column}" in result.arrays and row["engine"] != ANALYTIC:
            apart[row["engine"]] = _line(result, f"{key}/apart", column, scale)
    end = max(float(time[-1]) for time, _ in lines.values())
    limit = 1.08 * (max(float(np.abs(values).max()) for _, values in lines.values()) or 1.0)
    limit = float(np.clip(limit, *TILT)) if column == "tilt" else limit
    whole = Chart(
        Axis("time [s]", 0.0, end),
        Axis(label, -limit, limit),
        f"{scene['name']}: {label} over time in {', '.join(lines)}.",
        title=f"{scene['name']}: {WORDS[column]}",
        height=240,
    )
    for who, (time, values) in lines.items():
        whole.line(time, values, who)
    if not apart:
        return [whole]
    sizes = {who: np.maximum(np.abs(values), LEAST) for who, (_, values) in apart.items()}
    most = max(float(values.max()) for values in sizes.values())
    largest = "; ".join(f"{who} {number(float(values.max()), 2)}" for who, values in sizes.items())
    # copies of a block that overturns part as it falls: nothing to mark
    marked = bool(scene["horizon"]) and scene["horizon"] < 0.99 * end
    beside = Chart(
        Axis("time [s]", 0.0, end),
        Axis(f"|engine − model| {label[label.index('[') :]}", LEAST, 10.0 ** max(np.ceil(np.log10(most)), -7), "log"),
        f"{scene['name']}: how far the engines are from the analytic model in {label}; largest: {largest}.",
        title=f"{scene['name']}: {WORDS[column]}, error",
        height=240,
        head=16 * marked,
    )
    for who, values in sizes.items():
        beside.line(apart[who][0], values, who)
    if marked:
        beside.rule(scene["horizon"])
        beside.heading(scene["horizon"], "sensitivity horizon")
        beside.says += f" Dashed: the sensitivity horizon of changes by 10⁻⁴, {number(scene['horizon'])} s."
    return [whole, beside]


def _line(result, key, column, scale):
    time, values = result.arrays[f"{key}/time"], result.arrays[f"{key}/{column}"] / scale
    kept = thinned(values, most=SHOWN, parts=SHOWN // 2)
    return time[kept], values[kept]


def loops(result: Result, name: str) -> Chart:
    """Force over displacement of all bearings of a scene together."""
    scene, lines = result.settings["scenes"][name], {}
    for row in drawn(result, name):
        key = f"{name}/{row['engine']}"
        lines[row["engine"]] = result.arrays[f"{key}/base_displacement"], result.arrays[f"{key}/bearing_force"] / 1e3
    x, force = (1.08 * max(float(np.abs(line[k]).max()) for line in lines.values()) or 1.0 for k in (0, 1))
    chart = Chart(
        Axis("base displacement x [m]", -x, x),
        Axis("force of all bearings [kN]", -force, force),
        f"{scene['name']}: hysteresis loops of {', '.join(lines)} over each other.",
        title=f"{scene['name']}: the bearings together",
    )
    for who, line in lines.items():
        chart.line(*line, who)
    return chart


def blocks(scenes: Sequence[Mapping[str, Any]]) -> Figure:
    """The blocks of scenes, as they stand in a result's settings, to scale on what carries them."""
    draw = environment().get_template("statue.html").module.block  # type: ignore[attr-defined]  # a macro there
    words = "; ".join(
        f"{scene['name']}: a block of {scene['block']['mass']:g} kg, {2 * scene['half_width']:.3f} m wide and "
        f"{2 * scene['half_height']:.3f} m high, "
        + (
            f"on a base of {scene['base']['mass']:g} kg carried by {scene['bearings']['count']} bearings"
            if scene["bearings"]
            else "on rigid ground"
        )
        for scene in scenes
    )
    svg = "".join(f'<div class="block">{draw(scene)}</div>' for scene in scenes)
    return Figure(svg.encode(), words, f"Blocks to scale. {words}.")


def ground_motion(result: Result) -> Figure:
    motion, time = result.settings["motion"], result.arrays["motion/time"]
    chart = Chart(
        Axis("time [s]", 0.0, float(time[-1])),
        Axis("ground acceleration [m/s²]", -1.08 * motion["peak"], 1.08 * motion["peak"]),
        f"Ground acceleration over time; its peak of {motion['peak']:.3f} m/s² is at {motion['peak_time']:.2f} s.",
        title=motion["label"],
    )
    chart.line(time, result.arrays["motion/acceleration"])
    chart.rule(motion["peak_time"])
    caption = (
        f"Ground acceleration, {motion['label']}: peak {number(motion['peak'])} m/s² "
        f"({number(motion['peak'] / G)} g) at {number(motion['peak_time'])} s, dashed."
    )
    return figure([chart], caption)


FRAMES = 25.0  # 1/s
LONGEST = 2000  # frames; a longer run is shown in longer steps
LYING = math.pi / 2
PLATE = 0.4  # m, by which a base is drawn wider than the block and its slip


def animation(result: Result) -> dict[str, Any] | None:
    """What is moved, JSON-ready; None where no run has a history.

    step [s], count of frames, still [s] (the frame to begin with), ground: acceleration [m/s2] at the frames; scenes:
    name, size (half width and height [m]), base, its half width [m], limit of what is drawn [m], and tracks: who, tilt
    [rad] and, with a base, x [m], and of a block that slides slip [m] at the frames, up to where the run ended.
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
    rows = drawn(result, name)
    moved = {"x": "base_displacement"} if scene["base"] else {}
    moved |= {"slip": "slip"} if slides(rows) else {}
    tracks = [_track(result, f"{name}/{row['engine']}", times, row["engine"], moved) for row in rows]
    reach, slip = (max((abs(x) for track in tracks for x in track.get(way, ())), default=0.0) for way in ("x", "slip"))
    return {
        "name": scene["name"],
        "size": [round(scene["half_width"], 5), round(scene["half_height"], 5)],
        "base": scene["base"] is not None,
        "bearings": scene["bearings"] is not None,
        "slides": slip > 0,
        "plate": round(scene["half_width"] + PLATE + slip, 3),
        "reach": round(reach + slip, 3),
        "tracks": tracks,
    }


def _track(result, key, times, who, moved):
    """A run at the frames up to its end; a block that overturned lies down from there on."""
    own = result.arrays[f"{key}/time"]
    kept = times[times <= own[-1] + 1e-9]
    tilt = np.clip(np.interp(kept, own, result.arrays[f"{key}/tilt"]), -LYING, LYING)
    track = {"who": who, "tilt": [round(float(value), 4) for value in tilt]}
    for name, column in moved.items():
        if f"{key}/{column}" in result.arrays:
            values = np.interp(kept, own, result.arrays[f"{key}/{column}"])
            track[name] = [round(float(value), 4) for value in values]
    return track


def _still(scenes, step):
    """Time of the still frame: during the first overturning, before the block lies down, else at the peak."""
    for scene in scenes:
        tilt = np.abs(scene["tracks"][0]["tilt"])
        if tilt.max(initial=0.0) > 1.0:
            return round(float(np.argmax(tilt > 0.5)) * step, 4)
    found = [np.abs(scene["tracks"][0].get("x", scene["tracks"][0]["tilt"])) for scene in scenes]
    if not found[-1].any():
        found = [np.abs(scene["tracks"][0].get("slip", scene["tracks"][0]["tilt"])) for scene in scenes]
    return round(float(np.argmax(found[-1])) * step, 4)
