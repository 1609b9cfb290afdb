"""exudyn, variant switched-joints: the idealised block. Joints hold the corner in contact. The adapter, not exudyn,
locates uplift, impact and rest in time, and applies the impact of eqs (7) and (8)."""

from __future__ import annotations

import math
import time
from array import array
from dataclasses import dataclass
from typing import TYPE_CHECKING

import exudyn as exu
import numpy as np
from exudyn.itemInterface import MarkerNodeCoordinate, NodePointGround, ObjectConnectorCoordinate, ObjectJointRevolute2D
from scipy.interpolate import CubicHermiteSpline

from analytic.motion import vertical_acceleration
from analytic.response import Failure
from analytic.rocking import RockingModel

from ..contract import Run
from .ground import Ground
from .scene import build
from .stepping import OVERTURNED, check, interruptible, make_trace, release, solve, solver_settings

if TYPE_CHECKING:
    from analytic import Scene

REST = 0  # the side of a block in full contact
STUCK = 10  # events at one time after which a run is stopped; uplift and rest together are two
INITIAL = exu.ConfigurationType.Initial


@dataclass(frozen=True)
class SwitchedJoints:
    """Settings of switched-joints. `step` is the accuracy parameter: the error is proportional to its square."""

    step: float = 1e-3  # s


class Stepper:
    """A scene with switched joints: parts of exudyn's time integration, from one event to the next."""

    def __init__(self, scene: Scene, settings: SwitchedJoints) -> None:
        self.scene, self.step = scene, settings.step
        self.equations = RockingModel.of(scene)
        self.model = build(scene)
        self._add_joints()
        check(self.model)
        self.solver = exu.MainSolverImplicitSecondOrder()
        self.settings = solver_settings(
            scene, automaticStepSize=False, adaptiveStep=False, solverType=exu.DynamicSolverType.TrapezoidalIndex2
        )
        alpha = self.settings.timeIntegration.generalizedAlpha
        alpha.useNewmark = alpha.useIndex2Constraints = True
        if scene.motion is not None:
            self.model.mbs.SetPreStepUserFunction(Ground(self.model).prepare)
        self.model.mbs.SetPostStepUserFunction(self.keep)
        self.rows: list[tuple[float, np.ndarray, np.ndarray]]
        self.z: list[float]
        self.rows, self.z, self.time, self.side, self.watching = [], [], 0.0, REST, True
        self.interrupts: list[int] = []  # not empty after Ctrl-C

    def _add_joints(self):
        model, mbs = self.model, self.model.mbs
        node = mbs.GetObject(model.block)["nodeNumber"]
        fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()), coordinate=0))
        turn = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
        self.joints = {
            side: mbs.AddObject(ObjectJointRevolute2D(markerNumbers=model.corner_markers(side))) for side in (-1, 1)
        }
        self.lock = mbs.AddObject(ObjectConnectorCoordinate(markerNumbers=[fixed, turn]))
        model.connectors.update(left=self.joints[-1], right=self.joints[1], lock=self.lock)

    def keep(self, mbs: exu.MainSystem, t: float) -> bool:
        """After each step (PostStep): record it and commit the bearing's history; False stops at an event."""
        system, bearing = mbs.systemData, self.model.bearing
        q, v = system.GetODE2Coordinates(), system.GetODE2Coordinates_t()
        if self.rows and t <= self.rows[-1][0]:
            return True  # exudyn also calls it at the start of each part
        self.rows.append((t, q, v))
        if bearing is not None:
            self.z.append(bearing.commit(mbs, q.item(3)))
        tilt = -q.item(2)
        if not abs(tilt) < OVERTURNED or self.interrupts:
            return False
        return not (self.watching and self.event())

    def event(self) -> bool:
        """Whether the last step ended beyond an impact or an uplift."""
        t, q, v = self.rows[-1]
        if self.side == REST:
            return self.excess(len(self.rows) - 1) > 0
        return -self.side * q.item(2) < 0

    def excess(self, index: int) -> float:
        """|absolute acceleration in full contact| above the uplift acceleration [m/s2] at a row."""
        limit = self.equations.uplift_limit(float(vertical_acceleration(self.scene.motion, self.rows[index][0])))
        return abs(self.contact_acceleration(index)) - limit

    def contact_acceleration(self, index: int) -> float:
        t, q, v = self.rows[index]
        if self.scene.base:
            return self.equations.contact_acceleration(self.force(index))
        return float(self.scene.motion.acceleration(t)) if self.scene.motion else 0.0

    def force(self, index: int) -> float:
        """Force of all bearings [N] at a row."""
        if self.model.bearing is None:
            return 0.0
        t, q, v = self.rows[index]
        return self.model.bearing.law.force(q.item(3), self.z[index], v.item(3))

    def advance(self, until: float, watching: bool = True) -> Failure | None:
        """Integrate from the last row to `until` [s], at most to an event."""
        t, q, v = self.rows[-1]
        mbs, integration = self.model.mbs, self.settings.timeIntegration
        self.watching = watching
        for side, joint in self.joints.items():
            mbs.SetObjectParameter(joint, "activeConnector", side == (self.side or 1))
        mbs.SetObjectParameter(self.lock, "activeConnector", self.side == REST)
        mbs.Assemble()
        mbs.systemData.SetODE2Coordinates(q, configuration=INITIAL)
        mbs.systemData.SetODE2Coordinates_t(v, configuration=INITIAL)
        integration.startTime, integration.endTime = t, until
        integration.numberOfSteps = max(1, math.ceil((until - t) / self.step - 1e-9))
        return solve(self.solver, mbs, self.settings)

    def take_back(self) -> None:
        """Undo the last step."""
        self.rows.pop()
        bearing = self.model.bearing
        if bearing is not None:
            self.z.pop()
            bearing.restore(self.model.mbs, self.rows[-1][1].item(3), self.z[-1])

    def event_time(self) -> float:
        """Time of the event within the last step [s]."""
        (t0, q0, v0), (t1, q1, v1) = self.rows[-2:]
        if self.side == REST:
            e0, e1 = self.excess(len(self.rows) - 2), self.excess(len(self.rows) - 1)
            return t0 - e0 * (t1 - t0) / (e1 - e0) if e0 < 0 else t0
        curve = CubicHermiteSpline((t0, t1), (q0[2], q1[2]), (v0[2], v1[2]))
        roots = [root for root in curve.roots(extrapolate=False) if t0 < root <= t1]
        return max(roots) if roots else t0

    def impact(self) -> None:
        """Apply eqs (7) and (8) to the last row; the new side, or REST if the next swing is shorter than a step."""
        t, q, v = self.rows[-1]
        equations, old = self.equations, self.side
        rate = -v.item(2)
        speed = v.item(3) if self.scene.base else 0.0
        after, jump = equations.impact(rate)
        ground = float(self.scene.motion.acceleration(t)) if self.scene.motion else 0.0
        up = float(vertical_acceleration(self.scene.motion, t))
        pull = old * equations.accelerations(-old, 0.0, 0.0, ground, self.force(len(self.rows) - 1), up)[0]
        side = -old
        if after == 0 or (pull > 0 and 2 * abs(after) / pull < self.step):
            side, after = REST, 0.0
            jump = self.scene.mass_share * self.scene.block.half_height * rate
        self.place(side, after, speed + jump)

    def place(self, side: int, rate: float, speed: float) -> None:
        """Set the block flat on the base at the last row, with these rates [rad/s, m/s]."""
        t, q, v = self.rows[-1]
        x = q.item(3) if self.scene.base else 0.0
        h, b = self.scene.block.half_height, self.scene.block.half_width
        q = np.array([x, 0.0, 0.0, x])[: len(q)]
        v = np.array([speed + h * rate, side * b * rate, -rate, speed])[: len(v)]
        self.rows[-1] = (t, q, v)
        self.side = side

    def run(self) -> Failure | None:
        """Step to the scene's end; the failure, or None."""
        system, scene = self.model.mbs.systemData, self.scene
        q, v = np.array(system.GetODE2Coordinates()), np.array(system.GetODE2Coordinates_t())
        self.rows.append((0.0, q, v))
        if self.model.bearing is not None:
            self.z.append(self.model.bearing.z)
        lean = scene.start.tilt or scene.start.tilt_rate
        self.side = int(math.copysign(1, lean)) if lean else REST
        if self.side == REST and self.excess(0) > 0:
            self.lift()
        reached, tries = -1.0, 0
        while self.rows[-1][0] < scene.duration * (1 - 1e-12):
            tries = tries + 1 if self.rows[-1][0] <= reached else 0
            reached = self.rows[-1][0]
            if tries > STUCK:
                return Failure("uplift and rest alternate without progress", f"{tries} times at t = {reached:.9g} s")
            failure = self.advance(scene.duration)
            if failure or self.interrupts or not abs(self.rows[-1][1].item(2)) < OVERTURNED:
                return failure
            if not self.event():
                continue
            at = self.event_time()
            self.take_back()
            if at - self.rows[-1][0] > 1e-9 * self.step:
                failure = self.advance(at, watching=False)
                if failure:
                    return failure
            if self.side == REST:
                self.lift()
            else:
                self.impact()
        return None

    def lift(self) -> None:
        """Uplift: the block rocks opposite to the acceleration of the base."""
        side = -int(math.copysign(1, self.contact_acceleration(len(self.rows) - 1)))
        self.place(side, 0.0, self.rows[-1][2].item(3) if self.scene.base else 0.0)


def run(scene: Scene, settings: SwitchedJoints) -> Run:
    """Step a scene between switched joints."""
    exu.config.printToConsole = False
    stepper = Stepper(scene, settings)
    began = time.process_time()
    try:
        with interruptible() as stepper.interrupts:
            failure = stepper.run()
    finally:
        release(stepper.model.mbs)
    cpu = time.process_time() - began
    t, q, v = map(np.array, zip(*stepper.rows, strict=True))
    trace = make_trace(scene, t, q, v, array("d", stepper.z), stepper.model.bearing, 1e-9, 0.0)
    ended = "overturned" if trace is not None and abs(trace.tilt[-1]) >= OVERTURNED else None
    return Run(trace, len(stepper.rows) - 1, cpu, failure, ended)
