"""Histories of the report's own runs: in files, thinned for drawing, as charts and as an animation.

Files hold the histories, so that memory holds one at a time. All measurements use whole histories; only figures and the
result file have thinned ones. Charts and the animation are drawn from the arrays and rows of a result file.
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
from ..execution.results import Result, ResultError
from ..execution.writing import write
from ..plotting.charts import Axis, Chart, figure
from ..plotting.parts import Figure
from ..plotting.plots import mode_spans
from ..schemas.columns import Row, number
from .detail import environment

# A history of at most so many samples is drawn whole; of a longer one the extremes in each of so many parts.
MOST_SHOWN, PARTS = 20_000, 1_500


@dataclass(frozen=True)
class ToFile:
    """Measure that returns a whole response; its history becomes a file in `folder`, an array for each column."""

    folder: str

    def __call__(self, case: Case, response: Response) -> dict[str, Any]:
        content = (response.scene, response.engine, response.variant)
        name = hashlib.sha256(repr(content).encode()).hexdigest()[:16] + ".npz"
        data = io.BytesIO()
        np.savez(data, **{column: getattr(response.history, column) for column in response.history.columns})
        write(Path(self.folder) / name, data.getbuffer())
        return {**response.to_json(), "history": name}


def response_of(values: Mapping[str, Any], folder: str | PathLike[str]) -> Response:
    """Return the `Response` of a row's values, with its history from `folder`."""
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
    """Return history minus reference, thinned: {"apart/time", "apart/tilt", "apart/base_displacement": array}.

    It has "apart/slip", too, if both have slip. Samples are the reference's, up to the end of the shorter history.
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
    """Return the indices, in order, of the samples to draw of columns of equal length.

    These are all samples up to `most`. Of more samples they are both ends, and the least and greatest of each column in
    each of `parts` equal parts. So no peak is lost, and a line covers what a line through all samples covers.
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
TILT = 0.01, 1.6  # least and largest limit of a tilt axis, over slenderness; the least one hides contact noise
SHOWN = 700  # samples of a line
LEAST = 1e-9  # smaller differences are drawn here
WORDS = {"tilt": "tilt", "slip": "slip", "base_displacement": "displacement"}  # in the titles of panels


def pairs(result: Result, name: str) -> Iterator[list[Chart]]:
    """Yield charts of a scene, in pairs: all solvers overlaid, and the engines' differences from the analytic model.

    There is a pair for tilt if the block lifts, for slip if it slides, and for base displacement if there is a base.
    """
    scene = result.settings["scenes"][name]
    rows = drawn(result, name)
    if any(row["outcome"] not in LEVEL for row in rows):
        yield _overlay_and_error(result, name, rows, "tilt", "tilt φ/γ [-]", scene["block"]["slenderness"])
    if slides(rows):
        whole, *beside = _overlay_and_error(result, name, rows, "slip", "slip on the support [m]", 1.0)
        for row in rows:
            _shade_sliding(whole, row)
        yield [whole, *beside]
    if scene["base"] and rows:
        yield _overlay_and_error(result, name, rows, "base_displacement", "base displacement x [m]", 1.0)


def drawn(result: Result, name: str) -> list[Row]:
    """Return the rows of a scene whose histories are stored."""
    rows = [row for row in result.rows if row["scene"] == name and not row["failure"]]
    return [row for row in rows if f"{name}/{row['engine']}/time" in result.arrays]


def slides(rows: Sequence[Row]) -> bool:
    """Return whether the block slides in one of these runs."""
    return any((row.get("sliding") or {}).get("peak") for row in rows)


def _shade_sliding(chart, row):
    """Shade the times at which the block of a run slides, if the run tells them."""
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


def _overlay_and_error(result, name, rows, column, label, scale):
    scene = result.settings["scenes"][name]
    lines, errors = {}, {}
    for row in rows:
        key = f"{name}/{row['engine']}"
        if f"{key}/{column}" not in result.arrays:
            continue
        lines[row["engine"]] = _thinned_line(result, key, column, scale)
        if f"{key}/apart/{column}" in result.arrays and row["engine"] != ANALYTIC:
            errors[row["engine"]] = _thinned_line(result, f"{key}/apart", column, scale)
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
    if not errors:
        return [whole]
    sizes = {who: np.maximum(np.abs(values), LEAST) for who, (_, values) in errors.items()}
    largest_error = max(float(values.max()) for values in sizes.values())
    largest = "; ".join(f"{who} {number(float(values.max()), 2)}" for who, values in sizes.items())
    # neighbouring motions of a falling block part as it falls: no horizon to mark
    marked = bool(scene["horizon"]) and scene["horizon"] < 0.99 * end
    beside = Chart(
        Axis("time [s]", 0.0, end),
        Axis(
            f"|engine − model| {label[label.index('[') :]}",
            LEAST,
            10.0 ** max(np.ceil(np.log10(largest_error)), -7),
            "log",
        ),
        f"{scene['name']}: how far the engines are from the analytic model in {label}; largest: {largest}.",
        title=f"{scene['name']}: {WORDS[column]}, error",
        height=240,
        head=16 * marked,
    )
    for who, values in sizes.items():
        beside.line(errors[who][0], values, who)
    if marked:
        beside.rule(scene["horizon"])
        beside.heading(scene["horizon"], "sensitivity horizon")
        beside.says += f" Dashed: the sensitivity horizon of changes by 10⁻⁴, {number(scene['horizon'])} s."
    return [whole, beside]


def _thinned_line(result, key, column, scale):
    time, values = result.arrays[f"{key}/time"], result.arrays[f"{key}/{column}"] / scale
    kept = thinned(values, most=SHOWN, parts=SHOWN // 2)
    return time[kept], values[kept]


def loops(result: Result, name: str) -> Chart:
    """Draw force over displacement of all bearings of a scene together."""
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
    """Draw the blocks of scenes, given as in a result's settings, to scale on their supports."""
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
    """Draw the ground acceleration of a result over time."""
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
LONGEST = 2000  # frames; a longer run has longer steps between frames
LYING = math.pi / 2
PLATE = 0.4  # m, by which a base is drawn wider than the block and its slip


def animation(result: Result) -> dict[str, Any] | None:
    """Return the animation of a result's runs on one clock, ready for JSON; None if no run has a history.

    step [s]; count of frames; still [s]: time of the first frame shown; ground: acceleration [m/s2] at the frames;
    scenes. A scene: name; size: half width and half height [m]; base, bearings and slides: whether it has them; plate:
    half width of the base [m]; reach: largest displacement [m]; tracks. A track: who; tilt [rad], with a base x [m], of
    a block that slides slip [m], at the frames up to the end of the run.
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
        "still": _still_time(scenes, step),
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
    """Return a run at the frames up to its end; an overturned block lies from then on."""
    time = result.arrays[f"{key}/time"]
    shown = times[times <= time[-1] + 1e-9]
    tilt = np.clip(np.interp(shown, time, result.arrays[f"{key}/tilt"]), -LYING, LYING)
    track = {"who": who, "tilt": [round(float(value), 4) for value in tilt]}
    for name, column in moved.items():
        if f"{key}/{column}" in result.arrays:
            values = np.interp(shown, time, result.arrays[f"{key}/{column}"])
            track[name] = [round(float(value), 4) for value in values]
    return track


def _still_time(scenes, step):
    """Return the time of the still frame [s]: during the first overturning, else at the peak."""
    for scene in scenes:
        tilt = np.abs(scene["tracks"][0]["tilt"])
        if tilt.max(initial=0.0) > 1.0:
            return round(float(np.argmax(tilt > 0.5)) * step, 4)
    motions = [np.abs(scene["tracks"][0].get("x", scene["tracks"][0]["tilt"])) for scene in scenes]
    if not motions[-1].any():
        motions = [np.abs(scene["tracks"][0].get("slip", scene["tracks"][0]["tilt"])) for scene in scenes]
    return round(float(np.argmax(motions[-1])) * step, 4)
