"""Animation of the runs at common times: data for the page's script, and the frame shown without a script."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..running.provenance import Result

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
    """Time of the still frame: during the first overturning, before the block lies down, else at the peak."""
    for scene in scenes:
        tilt = np.abs(scene["tracks"][0]["tilt"])
        if tilt.max(initial=0.0) > 1.0:
            return round(float(np.argmax(tilt > 0.5)) * step, 4)
    found = [np.abs(scene["tracks"][0].get("x", scene["tracks"][0]["tilt"])) for scene in scenes]
    return round(float(np.argmax(found[-1])) * step, 4)
