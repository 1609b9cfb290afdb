"""The ground motion in exudyn: in the ground's frame its acceleration is one more gravity."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import exudyn as exu

from ..ground_velocity import ground_velocity

if TYPE_CHECKING:
    from .model import Model

BEGIN = exu.ConfigurationType.StartOfStep


class Ground:
    """Sets the loads of a scene's motion before each attempt of a step, to a mean by which the motion's impulse is exact.

    part: 1 for explicit steps, the mean over the step; 1/2 for the implicit rules, which take the load at a step's end
    and weigh both ends alike: the mean from half a step before it to half a step after. end: time [s] of a jump, beyond
    which no mean extends. Steps cut at the samples of a record, with the acceleration as a formula inside, are no
    better.
    """

    def __init__(self, model: Model) -> None:
        scene, self.weight, self.push, self.part, self.end = model.scene, model.weight, model.push, 0.5, math.inf
        self.mass, self.gravity = scene.base.mass if scene.base else 0.0, scene.gravity
        self.velocities = [ground_velocity(motion) for motion in (scene.motion, scene.motion and scene.motion.vertical)]

    def prepare(self, mbs: exu.MainSystem, t: float) -> bool:
        """Before each attempt of a step that would end at t (PreStep)."""
        step = t - mbs.systemData.GetTime(BEGIN)
        begin, end = t - self.part * step, min(t + (1 - self.part) * step, self.end)
        across, up = ((v(end) - v(begin)) / (end - begin) if v else 0.0 for v in self.velocities)
        mbs.SetLoadParameter(self.weight, "loadVector", [-across, -self.gravity - up, 0.0])
        if self.push is not None:
            mbs.SetLoadParameter(self.push, "loadVector", [-self.mass * across, 0.0, 0.0])
        return True
