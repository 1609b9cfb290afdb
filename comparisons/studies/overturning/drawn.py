"""Blocks drawn at random in the promised range, each under one pulse, with the boundary that is looked for."""

import math
from typing import Any

import numpy as np

from analytic import Scene, Start
from analytic.bearing import BearingLaw
from analytic.motion import PulseMotion
from analytic.pulses import PULSES

from ..random_scenes.scenes import random_scene
from .edges import Edge, edges

SEED = 46
FREQUENCY = (1.5, 8.0)  # of the pulses over omega_r, evenly over the logarithm
ROOM = 0.02  # relative distance of the next boundary, at least: nearer ones alternate as a fractal's do
JUMPS = tuple(shape for shape in PULSES if PulseMotion(shape, 1.0, 1.0, start=1.0).jumps)  # they begin with one


def drawn_edges(count: int) -> list[tuple[Scene, Edge]]:
    """`count` blocks with their lowest boundary at which the model keeps the block pressed on its base.

    Scenes of `random_scenes`, at rest; the pulses' shapes take turns. A block without such a boundary, and one that has
    another boundary within `ROOM` of it, is passed over.
    """
    found: list[tuple[Scene, Edge]] = []
    index = 0
    while len(found) < count:
        scene = random_scene(SEED, index).with_(motion=None, start=Start())
        low, high = map(math.log, FREQUENCY)
        frequency = math.exp(np.random.default_rng([SEED, index, 1]).uniform(low, high))
        index += 1
        for edge in edges(scene, f"drawn block {index}", list(PULSES)[len(found) % len(PULSES)], (frequency,)):
            room = min(1 - edge.low / edge.amplitude, edge.high / edge.amplitude - 1)
            if edge.rises and edge.min_normal >= 0 and room >= ROOM:
                found.append((scene, edge))
                break
    return found


def drawn_columns(scene: Scene) -> dict[str, Any]:
    """The columns that say what was drawn; period [s] on the stiffness after yielding."""
    base, bearings = scene.base, scene.bearings
    law = BearingLaw.of(bearings)
    period = 2 * math.pi * math.sqrt(scene.total_mass / (law.count * law.kb)) if bearings else None
    return {
        "slenderness": scene.block.slenderness,
        "radius": scene.block.radius,
        "base_mass": base and base.mass / scene.block.mass,
        "law": bearings and bearings.law,
        "period": period,
    }
