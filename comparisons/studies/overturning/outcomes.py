"""Outcomes of the engines at default settings beside those of the analytic model, near its boundaries and far off."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import simulate

from ...measuring.statistics import cohen_kappa, confusion
from ...showing.wording import solver_name
from .edges import pulse

if TYPE_CHECKING:
    from analytic import Scene

BAND = 0.01  # relative distance from a boundary beyond which no solver may differ


@dataclass(frozen=True)
class _Points:
    """What the points of the map came to, arrays of shape (n,).

    keys: (engine, ground, shape, frequency, amplitude) of each. reference, own: whether the analytic model and the
    engine overturn; decided: whether the engine says; scanned: of the coarse scan. normal: least N/(m g) of the model.
    distance: from its nearest boundary, relative.
    """

    keys: list
    reference: np.ndarray
    own: np.ndarray
    decided: np.ndarray
    scanned: np.ndarray
    normal: np.ndarray
    distance: np.ndarray


def judge(
    answers: Mapping[Any, Any],
    engines: Sequence[Any],
    grounds: Mapping[str, Scene],
    shapes: Sequence[str],
    edges: Mapping[Any, Any],
) -> tuple[np.ndarray, list[dict[str, Any]]]:
    """(array "points", rows "confusion" and "surprise") of the study's result, see its plan.

    Outside the band those are apart ("pulled") in which the normal force of the analytic model becomes negative.

    Parameters
    ----------
    answers : dict
        {(engine, ground, shape, frequency, amplitude): (overturns, or None where undecided; whether of the scan)}.
    engines, shapes : sequence
        In the order of the indices in "points".
    grounds : dict
        {name: scene}
    edges : dict
        {(ground, shape): {frequency: the `Edge`s there}}
    """
    points = _compare(answers, grounds, edges)
    rows = [
        row for engine in engines for ground in grounds for row in _confusions(points, engine, ground)
    ] + _surprises(points)
    return _table(points, engines, list(grounds), shapes), rows


def _compare(answers, grounds, edges):
    """`_Points` of the answers: the analytic model at each, and how far its nearest boundary is."""
    keys = list(answers)
    scenes = []
    for _, ground, shape, frequency, amplitude in keys:
        scene = grounds[ground]
        scenes.append(scene.with_(motion=pulse(scene, shape, frequency, amplitude)))
    responses = [simulate(scene, history=False) for scene in scenes]
    outcomes = [outcome for outcome, _ in answers.values()]
    distance = [
        min((abs(amplitude / edge.amplitude - 1) for edge in edges[ground, shape][frequency]), default=math.inf)
        for _, ground, shape, frequency, amplitude in keys
    ]
    return _Points(
        keys,
        reference=np.array([response.outcome == "overturns" for response in responses], dtype=bool),
        own=np.array([bool(outcome) for outcome in outcomes], dtype=bool),
        decided=np.array([outcome is not None for outcome in outcomes], dtype=bool),
        scanned=np.array([scanned for _, scanned in answers.values()], dtype=bool),
        normal=np.array([response.min_normal_ratio for response in responses]),
        distance=np.array(distance),
    )


def _confusions(points, engine, ground):
    """Rows of one engine on one ground: outcomes against outcomes, region by region."""
    here = np.array([key[0] == engine and key[1] == ground for key in points.keys]) & points.decided
    outside = points.distance > BAND
    for region, mask in (
        ("scan", points.scanned),
        ("outside", outside & (points.normal >= 0)),
        ("pulled", outside & (points.normal < 0)),
        ("inside", ~outside),
    ):
        chosen = here & mask
        if not chosen.any():
            continue
        table = confusion(points.reference[chosen], points.own[chosen])
        kappa, low, high = cohen_kappa(table.table())
        yield {
            "part": "confusion",
            "solver": label_of(engine),
            "ground": ground,
            "region": region,
            **vars(table),
            "kappa": kappa,
            "kappa_low": low,
            "kappa_high": high,
        }


def _surprises(points):
    """A row for each disagreement outside the band."""
    rows = []
    for k in np.flatnonzero(points.decided & (points.distance > BAND) & (points.reference != points.own)):
        engine, ground, shape, frequency, amplitude = points.keys[k]
        rows.append(
            {
                "part": "surprise",
                "solver": label_of(engine),
                "ground": ground,
                "shape": shape,
                "frequency": frequency,
                "amplitude": amplitude,
                "analytic_overturns": bool(points.reference[k]),
                "distance": float(points.distance[k]),
                "min_normal": float(points.normal[k]),
            }
        )
    return rows


def _table(points, engines, grounds, shapes):
    """Array of shape (n, 8), the columns as the study's plan names them."""
    rows = [
        (
            grounds.index(ground),
            shapes.index(shape),
            engines.index(engine),
            frequency,
            amplitude,
            points.reference[k],
            points.own[k] if points.decided[k] else -1,
            points.scanned[k],
        )
        for k, (engine, ground, shape, frequency, amplitude) in enumerate(points.keys)
    ]
    return np.array(rows, dtype=float)


def label_of(engine: tuple[Any, ...]) -> str:
    """A solver, its variant and the settings in place of its defaults, if any, in words."""
    name = solver_name(*engine[:2])
    return name if not any(engine[2:]) else f"{name}, " + ", ".join(f"{k} {v:g}" for k, v in engine[2].items())
