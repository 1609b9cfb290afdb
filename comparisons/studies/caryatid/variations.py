"""What the paper leaves out: other slendernesses, intensities and motions. Does isolation help, when does it harm?"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import simulate, simulate_many, synthetic_motion
from analytic.rocking import restitution

from ...running.refine import boundaries, drive
from . import paper
from .runs import FREE, ISOLATED, caryatid

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.types import Motion

# who stays upright
BOTH, ONLY_ISOLATED, ONLY_FREE, NEITHER = range(4)
CATEGORIES = ("both stay upright", "only the isolated one does", "only the free-standing one does", "both overturn")
WITHIN = "only the isolated one does, within 0.30 m"
SEEDS = 12
FRICTION_LIMITS = (0.3, 0.5, 0.7)  # [-], of stone on stone and steel, low to high


def grid(quick: bool, fine: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """(slendernesses [rad], intensities [-])."""
    if quick:
        return np.linspace(0.10, 0.45, 15), np.linspace(0.25, 3.0, 12)
    return (
        (np.linspace(0.10, 0.45, 71), np.linspace(0.25, 3.0, 56))
        if fine
        else (np.linspace(0.10, 0.45, 36), np.linspace(0.25, 3.0, 34))
    )


def benefit(
    motion: Motion, slendernesses: np.ndarray, intensities: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Category (uint8), whether the isolated block lifts, and its peak base displacement [m], shape (n, k).

    The displacement is NaN where the isolated block overturns: runs end when that is certain.
    """
    kept = {}
    scaled = [motion.scaled(float(factor)) for factor in intensities]
    shape = len(slendernesses), len(intensities)
    for name in (FREE, ISOLATED):
        base = caryatid(name, motion)
        scenes = [
            base.with_(block={"slenderness": float(gamma)}, motion=shaking)
            for gamma in slendernesses
            for shaking in scaled
        ]
        kept[name] = simulate_many(scenes)
    if any(outcomes.failed.any() for outcomes in kept.values()):
        raise RuntimeError("the analytic model failed on a scene of the map; report it with its slenderness")
    overturns = {name: outcomes.overturns.reshape(shape) for name, outcomes in kept.items()}
    category = np.select(
        [
            ~overturns[FREE] & ~overturns[ISOLATED],
            overturns[FREE] & ~overturns[ISOLATED],
            ~overturns[FREE] & overturns[ISOLATED],
        ],
        [BOTH, ONLY_ISOLATED, ONLY_FREE],
        NEITHER,
    )
    isolated = kept[ISOLATED]
    displacement = np.where(overturns[ISOLATED], np.nan, isolated.peak_base_displacement.reshape(shape))
    return category.astype(np.uint8), isolated.lifted.reshape(shape), displacement.astype(np.float32)


def maps(
    motion: Motion, quick: bool = False, advance: Callable[[str], Any] = lambda text: None
) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """(rows, arrays): the map of `motion`, how many of the synthetic motions agree cell by cell, and critical
    intensities of the Caryatid itself."""
    slendernesses, intensities = grid(quick)
    category, lifted, displacement = benefit(motion, slendernesses, intensities)
    arrays = {
        "benefit/slenderness": slendernesses,
        "benefit/intensity": intensities,
        "benefit/category": category,
        "benefit/isolated lifts": lifted,
        "benefit/isolated displacement": displacement,
    }
    rows = [_shares("this motion", category, lifted, displacement)]
    coarse = grid(quick, fine=False)
    counts = np.zeros((len(CATEGORIES), len(coarse[0]), len(coarse[1])), dtype=np.uint8)
    seeds = range(3 if quick else SEEDS)
    for seed in seeds:
        advance(f"synthetic motion {seed + 1} of {len(seeds)}")
        category, lifted, displacement = benefit(synthetic_motion(seed=seed), *coarse)
        rows.append(_shares(f"synthetic, seed {seed}", category, lifted, displacement))
        for kind in range(len(CATEGORIES)):
            counts[kind] += category == kind
    arrays |= {"seeds/slenderness": coarse[0], "seeds/intensity": coarse[1], "seeds/counts": counts}
    return rows + _critical(motion), arrays


def _shares(name, category, lifted, displacement):
    shares = {text: float((category == kind).mean()) for kind, text in enumerate(CATEGORIES)}
    within = (category == ONLY_ISOLATED) & (displacement <= paper.X_MAX)
    return {
        "part": "benefit",
        "motion": name,
        "cells": int(category.size),
        **shares,
        WITHIN: float(within.mean()),
        "isolated lifts": float(lifted.mean()),
        "beyond x_max": float((displacement > paper.X_MAX).mean()),
    }


def _critical(motion):
    """Intensities at which the Caryatid's state changes, free-standing and isolated: the first, and all."""
    rows = []
    questions = (
        (FREE, "overturns", lambda outcomes: outcomes.overturns),
        (ISOLATED, "overturns", lambda outcomes: outcomes.overturns),
        (ISOLATED, "lifts", lambda outcomes: outcomes.lifted),
        (
            ISOLATED,
            "exceeds x_max",
            lambda outcomes: outcomes.overturns | (outcomes.peak_base_displacement > paper.X_MAX),
        ),
    )
    for name, what, read in questions:
        scene = caryatid(name, motion)

        def evaluate(batch, scene=scene, read=read):
            scenes = [scene.with_(motion=scene.motion.scaled(point)) for _, point in batch]
            return list(map(bool, read(simulate_many(scenes))))

        (column,) = drive([boundaries(0.25, 4.0, 151, 1e-4)], evaluate)
        changes = [round(transition.position, 4) for transition in column.transitions]
        rows.append(
            {
                "part": "critical intensity",
                "scene": name,
                "what": what,
                "first": changes[0] if changes else None,
                "changes": changes,
            }
        )
    return rows


def contact(motion: Motion, quick: bool = False) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """(rows, arrays): friction demand and least normal force over slenderness and intensity.

    Of runs that overturn only what comes before the tilt first reaches the slenderness counts: nobody needs a block
    not to slide while it falls.
    """
    slendernesses, intensities = (axis[::2] for axis in grid(quick, fine=False))
    arrays = {"contact/slenderness": slendernesses, "contact/intensity": intensities}
    rows = []
    for name in (FREE, ISOLATED):
        scene = caryatid(name, motion)
        friction, normal = np.empty((2, len(slendernesses), len(intensities)))
        upright = np.empty(friction.shape, dtype=bool)
        for i, gamma in enumerate(slendernesses):
            for k, factor in enumerate(intensities):
                one = scene.with_(block={"slenderness": float(gamma)}, motion=motion.scaled(float(factor)))
                friction[i, k], normal[i, k], upright[i, k] = _demand(one)
        arrays |= {
            f"contact/{name} friction": friction.astype(np.float32),
            f"contact/{name} normal": normal.astype(np.float32),
            f"contact/{name} upright": upright,
        }
        over = {f"friction above {limit:g}": float((friction > limit).mean()) for limit in FRICTION_LIMITS}
        at = _demand(scene)
        rows.append(
            {
                "part": "contact",
                "scene": name,
                "friction_demand": at[0],
                "min_normal_ratio": at[1],
                **over,
                "worst_friction": float(friction.max()),
                "least_normal": float(normal.min()),
                "jumps": float((normal <= 0).mean()),
                "impact_friction": impact_friction(scene),
            }
        )
    return rows, arrays


def _demand(scene):
    """(friction demand, least N/(m g), stays upright) of a run, up to its last fall if it overturns."""
    response = simulate(scene, history=False)
    return response.friction_demand, response.min_normal_ratio, response.outcome != "overturns"


def impact_friction(scene: Scene) -> float:
    """Horizontal over vertical impulse at an impact [-], for any speed: the friction an impact itself asks for.

    With w before and e w after, the centre of mass changes its velocity by (1 - mt) h (1 - e) w sideways, jump of the
    base included, and by b (1 + e) w upward.
    """
    block, e = scene.block, max(restitution(scene), 0.0)
    return (1 - scene.mass_share) * (1 - e) / (1 + e) / math.tan(block.slenderness)
