"""Recorded triples beside the synthetic motions: with and without their vertical component, and turned.

Of a record nothing is kept but counts and ratios.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
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


def record_cases(usual: Scene, slendernesses: Sequence[float], recorded: Sequence[Triple]) -> list[Case]:
    """Every triple in all directions, about the factor that overturns half of them, with and without its vertical."""
    cases = []
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
                    cases += [
                        Case(
                            scene.with_(motion=motion.scaled(float(half * factor))),
                            settings={"history": False},
                            tag={"record": number, "place": place, "step": step, "raised": raised, "factor": k},
                        )
                        for k, factor in enumerate(SPREAD)
                    ]
    return cases


def _half(scene, triple):
    """The factor at which half of the directions overturn the block, or None."""
    scenes = [scene.with_(motion=triple.turned(step)) for step in range(DIRECTIONS) for _ in TRIED]
    fallen = simulate_many(scenes, scales=np.tile(TRIED, DIRECTIONS)).overturns.reshape(DIRECTIONS, -1).mean(axis=0)
    above = int(np.argmax(fallen >= 0.5))
    return float(TRIED[above]) if fallen[above] >= 0.5 else None


def record_rows(recorded: Sequence[Triple], results: Iterable[Any]) -> list[dict]:
    """A row for every triple: V/H, how fast its vertical motion is, and outcomes changed by it and by turning.

    No intervals: runs under one record are no sample.
    """
    outcomes: dict[int, dict[tuple, bool]] = {}
    for row in results:
        tag = row.case.tag
        if not row.failed:
            place = tag["place"], tag["factor"], tag["step"], tag["raised"]
            outcomes.setdefault(tag["record"], {})[place] = row.values["overturns"]
    rows = []
    for number, found in outcomes.items():
        level = {(place, factor, step): fallen for (place, factor, step, raised), fallen in found.items() if not raised}
        raised = [(fallen, found.get((*key, True))) for key, fallen in level.items()]
        turned = [
            (fallen, level.get((place, factor, (step + TURNED) % DIRECTIONS)))
            for (place, factor, step), fallen in level.items()
        ]
        rows.append(
            {
                "part": "record",
                "record": recorded[number].name,
                "ratio": recorded[number].ratio,
                "faster": recorded[number].faster,
                "runs": len(raised),
                "outcomes_changed": sum(after is not None and before != after for before, after in raised),
                "outcomes_changed_by_turning": sum(after is not None and before != after for before, after in turned),
            }
        )
    return rows


def _frequency(motion):
    return math.sqrt((np.diff(motion.samples) ** 2).sum() / (motion.samples**2).sum()) / motion.dt
