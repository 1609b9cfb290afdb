"""Limits of one run: steps, events, rows of the history; and the error for a scene that exceeds them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .decision import CAP_PERIODS, motion_end, period
from .errors import SceneError
from .events import NEARLY_ELASTIC
from .motion import SampledMotion, slowest_key
from .rocking import RockingModel

if TYPE_CHECKING:
    from .scene import Scene

# Steps of a run until its outcome is decided, some seconds of CPU time: both Caryatid scenes take 6000, bearings of ten
# thousand rocking frequencies five million. A longer given duration may take more, up to a minute or two.
STEPS, MOST_STEPS = 5_000_000, 100_000_000
STEPS_PER_SAMPLE = 10  # further steps for each sample of a record; one or two are usual
EVENTS = 1_000_000  # impacts, uplifts or rests of a response
ROWS, MOST_ROWS = 1_000_000, 10_000_000  # of a history: by default, and with a given interval
USUAL_EXPONENT = 100.0  # of a bearing law: up to it, the yielding is no stiffer than the rest


def most_steps(scene: Scene) -> int:
    """Largest number of steps of a run of the scene."""
    longer = 1.0
    if scene.duration is not None:
        longer = max(1.0, (scene.duration - motion_end(scene)) / (CAP_PERIODS * period(scene)))
    samples = len(scene.motion.samples) if isinstance(scene.motion, SampledMotion) else 0
    return int(min(STEPS * longer, MOST_STEPS)) + STEPS_PER_SAMPLE * samples


def too_long(scene: Scene, spent: str) -> SceneError:
    """The error for a run that has `spent` its limit; it names the part of the scene that is furthest from usual.

    The bearings' frequency and decay rate are compared with omega_r, their exponent with 100, and the duration with a
    hundred rocking periods.
    """
    _, key, value, problem, remedy = max(_parts(scene), key=lambda part: part[0])
    return SceneError(key, value, f"{problem}: {spent}", remedy, scene.name or None)


def _parts(scene: Scene) -> list[tuple[float, str, float, str, str]]:
    """[(ratio to a usual value, key, value, problem, remedy)] of all causes of a long run."""
    model, omega, turn = RockingModel.of(scene), scene.rocking_frequency, 2 * math.pi
    found = [(0.0, "block.radius", scene.block.radius, f"the block rocks at {omega:.3g} rad/s", "give a larger one")]
    if model.restitution > NEARLY_ELASTIC:
        problem, remedy = "impacts lose almost no energy", "give a smaller one"
        found.append((1.0, "block.restitution", model.restitution, problem, remedy))
    if scene.duration is not None:
        periods = scene.duration * omega / turn
        found.append((periods / 100, "run.duration", scene.duration, f"{periods:.3g} rocking periods", "shorten it"))
    if scene.motion is not None:
        periods, key = scene.motion.end * omega / turn, slowest_key(scene.motion)
        problem = f"the motion lasts {scene.motion.end:.3g} s, {periods:.3g} rocking periods"
        remedy = "raise it" if key == "motion.frequency" else "lower it"
        found.append((periods / 100, key, getattr(scene.motion, key.removeprefix("motion.")), problem, remedy))
    return found + _bearing_parts(scene, model)


def _bearing_parts(scene, model):
    bearings, law, omega = scene.bearings, model.bearing, scene.rocking_frequency
    if bearings is None:
        return []
    free = model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J  # effective mass of the base [kg]
    ringing, decay = math.sqrt(law.count * (law.kb + law.dk) / free), law.count * law.damping / free
    problem = f"the base vibrates at {ringing:.3g} rad/s on such bearings"
    found = [(ringing / omega, "bearings.ka", bearings.ka, problem, "lower it")]
    if decay:
        problem = f"such dampers stop the base within {1 / decay:.3g} s"
        found.append((decay / omega, "bearings.damping", law.damping, problem, "lower it"))
    if bearings.alpha is not None:
        problem, remedy = "the law yields almost at a point", 'lower it, or give law = "bilinear"'
        found.append((bearings.alpha / USUAL_EXPONENT, "bearings.alpha", bearings.alpha, problem, remedy))
    return found
