"""Computations that several lessons share."""

from __future__ import annotations

from collections.abc import Callable

from analytic import Response, Scene, simulate

G = 9.81  # m/s2
HALVINGS = 50


def edge(differs: Callable[[float], bool], low: float, high: float) -> float:
    """The value at which `differs` changes between low and high, by bisection; on the side of high.

    Raises
    ------
    ValueError
        `differs` is the same at both ends.
    """
    there = differs(high)
    if differs(low) == there:
        raise ValueError(f"nothing changes between {low:g} and {high:g}")
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if differs(middle) == there else (middle, high)
    return high


def overturns(scene: Scene) -> bool:
    return simulate(scene, history=False).outcome == "overturns"


def history_until(scene: Scene, duration: float) -> Response:
    """The response of the first `duration` [s], with its history every 0.01 s."""
    return simulate(scene.with_(duration=duration), output_step=0.01)
