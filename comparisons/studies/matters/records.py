"""Recorded triples beside the synthetic motions: with and without their vertical component, and turned.

Of a record nothing is kept but counts and ratios.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import SampledMotion, simulate_many
from analytic.errors import SceneError, SettingError
from analytic.pairing import paired
from analytic.records import read_channels
from analytic.records.folder import VERTICAL, turned
from analytic.synthetic import PEAK

from ...running.cases import Case
from ...running.study import say

if TYPE_CHECKING:
    from analytic import Scene

DIRECTIONS = 12  # of the block's plane, over half a turn; the other half is the same, mirrored
TURNED = 2  # of these steps, 30 degrees: what the two horizontal components are turned by
TRIED = np.geomspace(0.1, 10.0, 40)  # factors among which the one is found that overturns half of the directions
SPREAD = np.exp(0.4 * np.array([-1.5, -0.9, -0.3, 0.3, 0.9, 1.5]))  # factors about it


@dataclass(frozen=True, eq=False)
class Triple:
    """name: of the file. first, second: horizontal components, of one step and length. up: the vertical one.

    Scaled together, so that the stronger horizontal one peaks like the synthetic motions.
    """

    name: str
    first: SampledMotion
    second: SampledMotion
    up: SampledMotion

    @property
    def ratio(self) -> float:
        """Peak vertical over the larger peak horizontal acceleration, V/H."""
        return self.up.peak / max(self.first.peak, self.second.peak)

    @property
    def faster(self) -> float:
        """Mean frequency of the vertical over that of the horizontal motion, of their spectra's second moments."""
        level = math.hypot(_frequency(self.first), _frequency(self.second)) / math.sqrt(2)
        return _frequency(self.up) / level

    def turned(self, step: int) -> SampledMotion:
        """The horizontal motion in the plane of this direction."""
        return turned(self.first, self.second, math.pi * step / DIRECTIONS, self.name)


def triples(folder: str | None) -> list[Triple]:
    """The triples in a folder and those below it, in the order of their names; none for None.

    Raises
    ------
    SettingError
        There is no such folder, or no triple in it.
    """
    if folder is None:
        return []
    if not Path(folder).is_dir():
        raise SettingError(f"--records {folder}: no folder; give one with record files")
    read = (_triple(path) for path in sorted(Path(folder).rglob("*")) if path.is_file())
    found = [triple for triple in read if triple is not None]
    if not found:
        raise SettingError(
            f"--records {folder}: no file with two horizontal channels and one called {', '.join(VERTICAL)}; "
            "give a folder with CSMIP volume 2 files, say"
        )
    return found


def _triple(path):
    """The `Triple` of a file; None where it holds none, or is no record."""
    try:
        channels = read_channels(path)
    except (SceneError, OSError):
        return None
    up = [channel.motion for channel in channels if channel.direction.casefold() in VERTICAL]
    level = [channel.motion for channel in channels if channel.direction.casefold() not in VERTICAL]
    if len(up) != 1 or len(level) != 2:
        return None
    both = paired(*level)
    other = both.vertical
    factor = PEAK / max(both.peak, other.peak)
    first = replace(both, vertical=None, samples=factor * both.samples)
    return Triple(path.name, first, replace(other, samples=factor * other.samples), up[0].scaled(factor))


def record_cases(usual: Scene, slendernesses: Sequence[float], recorded: Sequence[Triple]) -> Iterator[Case]:
    """Every triple in all directions, about the factor that overturns half of them, with and without its vertical."""
    for place, slenderness in enumerate(slendernesses):
        scene = usual.with_(block={"slenderness": slenderness})
        for number, triple in enumerate(recorded):
            half = _half(scene, triple)
            if half is None:
                say(f"{triple.name}: no factor overturns half of its directions at slenderness {slenderness:g}")
                continue
            for step in range(DIRECTIONS):
                level = triple.turned(step)
                for raised, motion in ((False, level), (True, paired(level, triple.up))):
                    for k, factor in enumerate(SPREAD):
                        tag = {"record": number, "place": place, "step": step, "raised": raised, "factor": k}
                        shaken = scene.with_(motion=motion.scaled(float(half * factor)))
                        yield Case(shaken, settings={"history": False}, tag=tag)


def _half(scene, triple):
    """The factor at which half of the directions overturn the block, or None."""
    fallen = overturned(scene, map(triple.turned, range(DIRECTIONS)), TRIED)
    above = int(np.argmax(fallen >= 0.5))
    return float(TRIED[above]) if fallen[above] >= 0.5 else None


def overturned(scene: Scene, motions: Iterable[SampledMotion], factors: np.ndarray) -> np.ndarray:
    """Share of motions that overturn the block, at each of the factors; shape (factors,)."""
    scenes = [scene.with_(motion=motion) for motion in motions for _ in factors]
    runs = simulate_many(scenes, scales=np.tile(factors, len(scenes) // len(factors)))
    return runs.overturns.reshape(-1, len(factors)).mean(axis=0)


def record_rows(recorded: Sequence[Triple], results: Iterable[Any]) -> Iterator[dict[str, Any]]:
    """A row for every triple: V/H, how fast its vertical motion is, and outcomes changed by it and by turning.

    No intervals: runs under one record are no sample.
    """
    outcomes: dict[int, dict[tuple, bool]] = {}
    for row in results:
        if not row.failed:
            place = tuple(row.case.tag[key] for key in ("raised", "place", "factor", "step"))
            outcomes.setdefault(row.case.tag["record"], {})[place] = row.values["overturns"]
    for number, found in outcomes.items():
        level = {place[1:]: fallen for place, fallen in found.items() if not place[0]}
        turned = {(*rest, (step - TURNED) % DIRECTIONS): fallen for (*rest, step), fallen in level.items()}
        yield {
            "part": "record",
            "record": recorded[number].name,
            "ratio": recorded[number].ratio,
            "faster": recorded[number].faster,
            "runs": len(level),
            "outcomes_changed": sum(found.get((True, *key), fallen) != fallen for key, fallen in level.items()),
            "outcomes_changed_by_turning": sum(turned.get(key, fallen) != fallen for key, fallen in level.items()),
        }


def _frequency(motion):
    return math.sqrt((np.diff(motion.samples) ** 2).sum() / (motion.samples**2).sum()) / motion.dt
