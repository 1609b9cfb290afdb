"""The ground motion in exudyn: in the ground's frame its acceleration is one more gravity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import exudyn as exu

from ..ground_velocity import ground_velocity

if TYPE_CHECKING:
    from .model import Model

ALL, END = 1.0, 1e-4
BEGIN = exu.ConfigurationType.StartOfStep


class Ground:
    """Sets the loads of a scene's motion before each attempt of a step.

    part: share of a step, up to its end, of which they are the mean: all of an explicit one, which a jump so gives its
    impulse; the implicit rules weigh the loads at both ends of a step.
    """

    def __init__(self, model: Model) -> None:
        scene, self.weight, self.push, self.part = model.scene, model.weight, model.push, END
        self.mass, self.gravity = scene.base.mass if scene.base else 0.0, scene.gravity
        self.velocities = [ground_velocity(motion) for motion in (scene.motion, scene.motion and scene.motion.vertical)]

    def prepare(self, mbs: exu.MainSystem, t: float) -> bool:
        """Before each attempt of a step that would end at t (PreStep)."""
        begin = t - self.part * (t - mbs.systemData.GetTime(BEGIN))
        if t == begin:  # the last of steps that Newton's method makes shorter and shorter
            return True
        across, up = ((v(t) - v(begin)) / (t - begin) if v else 0.0 for v in self.velocities)
        mbs.SetLoadParameter(self.weight, "loadVector", [-across, -self.gravity - up, 0.0])
        if self.push is not None:
            mbs.SetLoadParameter(self.push, "loadVector", [-self.mass * across, 0.0, 0.0])
        return True
