"""Position, velocity and impulses of both bottom corners of a block in a trace.

Pairs are (landing corner, old corner): the one that comes down in an impact, and the pivot before it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from analytic.motion import vertical_acceleration
from engines.ground_velocity import ground_velocity
from engines.swings import ArrayModel

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.motion import Motion
    from engines.swings import Trace


def corner_motion(scene: Scene, trace: Trace, side: float) -> dict[str, np.ndarray]:
    """How the corners move in a trace with a centre; `side`, +1 or -1, is the old corner's.

    Returns
    -------
    dict
        height above the ground [m], sinking: speed downward, slip: speed along the base [m/s]; arrays, shape (n, 2).
    """
    lever, drop = _levers(scene, trace.tilt, side)
    _, z, vx, vz = np.asarray(trace.centre).T
    height = z + scene.block.half_height + drop.T
    slip = vx - trace.base_velocity + drop.T * trace.tilt_rate
    return {"height": height.T, "sinking": (lever.T * trace.tilt_rate - vz).T, "slip": slip.T}


def _levers(scene: Scene, tilt: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
    """(x, z) [m] of landing corner and old corner from the block's centre, shapes (n, 2)."""
    b, h = scene.block.half_width, scene.block.half_height
    across, cos, sin = np.array([-side * b, side * b]), np.cos(tilt)[:, None], np.sin(tilt)[:, None]
    return across * cos - h * sin, -across * sin - h * cos


def corner_impulses(scene: Scene, trace: Trace, side: float) -> dict[str, np.ndarray]:
    """Impulses on the corners between the n steps of a trace with a centre, from the change of its momentum.

    Returns
    -------
    dict
        impulse: of each corner upward, shape (n - 1, 2), friction: of both along the ground, shape (n - 1,) [N s].
    """
    block, time, (_, _, across, up) = scene.block, trace.time, np.asarray(trace.centre).T
    lever, drop = (0.5 * (each[1:] + each[:-1]) for each in _levers(scene, trace.tilt, side))
    ground, upright = (_gained(part, time) for part in (scene.motion, scene.motion and scene.motion.vertical))
    friction = block.mass * (np.diff(across) + ground)
    upward = block.mass * (np.diff(up) + scene.gravity * np.diff(time) + upright)
    spin = block.centre_inertia * np.diff(trace.tilt_rate)
    # Friction at the lower corner (both are loaded where level): z H - x_a N_a - x_o N_o = spin, N_a + N_o = N
    landing = (drop.min(axis=1) * friction - lever[:, 1] * upward - spin) / (lever[:, 0] - lever[:, 1])
    return {"impulse": np.column_stack([landing, upward - landing]), "friction": friction}


def _gained(motion: Motion | None, time: np.ndarray) -> np.ndarray | float:
    """Velocity [m/s] that the ground gains in each step."""
    velocity = ground_velocity(motion)
    return np.diff([velocity(t) for t in time.tolist()]) if velocity else 0.0


def pivot_forces(
    scene: Scene, trace: Trace, side: float, landing: float, rates: tuple[float, float]
) -> tuple[float, float]:
    """Normal force on a block that pivots at tilt 0 [N], before and after the landing [s], by eqs (3)-(6).

    rates: tilt rates before and after it [rad/s].
    """
    model, motion = ArrayModel.of(scene), scene.motion
    ground, up = (motion.acceleration(landing), vertical_acceleration(motion, landing)) if motion else (0.0, 0.0)
    force = float(np.interp(landing, trace.time, trace.bearing_force))

    def normal(s, rate):
        tilting, sliding = model.accelerations(s, 0.0, rate, ground, force, up)
        return float(model.contact_forces(s, 0.0, rate, tilting, ground + sliding, up)[1])

    return normal(side, rates[0]), normal(-side, rates[1])
