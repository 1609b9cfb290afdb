"""Two rigid blocks on each other, on the ground or on a base with bearings, by Moreau's time stepping.

The lower block is the scene's pedestal, which here may lift and rock. Nothing slides. There are four corners: two of
the lower block on its support, two of the upper block on the top of the lower one, which has no edge. In a step of
length h the coordinates move to the midpoint q + h/2 v; corners that do not gape there are closed. The velocities after
the step are those nearest to the free ones, in the metric of the kinetic energy, at which no closed corner penetrates
and no corner that carries slips. All sets of carrying corners are tried. Impacts are steps like any other, of
Moreau's law; for a single block that is eqs (7), (8). The method is of first order in h.

J. J. Moreau (1999), Numerical aspects of the sweeping process, Comput. Methods Appl. Mech. Eng. 177, 329-349.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from ..errors import SceneError, require
from ..rocking import hysteretic_force
from ..scene import Scene
from ..solver import parameters
from .time_stepping import _means

LOWER, UPPER, BASE = 2, 5, 6  # tilts, and the base, of the coordinates X_1 Y_1 phi_1 X_2 Y_2 phi_2 x
ROUNDING = 1e-12  # of impulses and velocities, relative to those without contact


@dataclass(frozen=True, eq=False)
class TwoBodies:
    """A run of two blocks, arrays of shape (n,): time [s], absolute tilts [rad], base displacement [m], energy [J].

    The run ends where a block has turned by pi/2, the upper one from the lower one. energy : kinetic energy and that of
    gravity, in the ground's frame.
    """

    time: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    base: np.ndarray
    energy: np.ndarray

    @property
    def fallen(self) -> str:
        """Return which block has overturned first: "lower", "upper", or ""."""
        turned = {"lower": abs(self.lower[-1]), "upper": abs(self.upper[-1] - self.lower[-1])}
        most = max(turned, key=turned.__getitem__)
        return most if turned[most] >= 0.5 * math.pi else ""


def simulate_two_bodies(scene: Scene, *, step: float, lower_tilt: float = 0.0) -> TwoBodies:
    """Simulate the block and its pedestal as two blocks that do not slide, in equal steps of at most `step` [s].

    Parameters
    ----------
    scene : Scene
        With a pedestal that has mass and height, and a duration. The block starts at its tilt from the pedestal, and
        both without a velocity.
    lower_tilt : float
        Tilt of the pedestal at the start [rad].

    Raises
    ------
    SceneError
        The pedestal has no mass, the run no duration, or a velocity or restitution is given.
    SettingError
        The step is not positive.
    """
    require(step > 0 and math.isfinite(step), f"step = {step!r} is not positive: give a finite value above 0 [s]")
    pedestal, block, start = scene.pedestal, scene.block, scene.start
    for key, value in (
        ("start.tilt_rate", start.tilt_rate),
        ("start.base_velocity", start.base_velocity),
        ("block.restitution", block.restitution),
    ):
        if value:
            raise SceneError(key, value, "not used by two blocks", "remove it")
    if pedestal is None or pedestal.mass is None or pedestal.height is None or scene.duration is None:
        raise SceneError("pedestal", None, "incomplete", "give its mass and height, and the run a duration")
    m, b, h = pedestal.mass, 0.5 * pedestal.width, 0.5 * pedestal.height
    masses = (m, m, m * (b * b + h * h) / 3, block.mass, block.mass, block.centre_inertia)
    inverse = 1 / np.array([*masses, scene.base.mass if scene.base else math.inf])
    sizes = np.array([b, h, block.half_width, block.half_height])
    count = math.ceil(scene.duration / step * (1 - 1e-12))
    length = scene.duration / count
    gravity = scene.gravity + _means(scene.motion and scene.motion.vertical, length, count)
    q, rows = _placed(sizes, lower_tilt, start.tilt, start.base_displacement), np.empty((count + 1, 5))
    taken = _march(parameters(scene), sizes, inverse, length, _means(scene.motion, length, count), gravity, q, rows)
    return TwoBodies(*rows[: taken + 1].T)


def _placed(sizes, lower, tilt, x):
    """Return the coordinates at the start: a corner of each block on what carries it."""
    b, h, half, height = sizes
    (foot, sunk), (over, up) = _turned(math.copysign(b, lower), -h, lower), _turned(math.copysign(half, tilt), h, lower)
    across, down = _turned(math.copysign(half, tilt), -height, lower + tilt)
    first = x + math.copysign(b, lower) - foot
    return np.array([first, -sunk, lower, first + over - across, up - sunk - down, lower + tilt, x])


@njit(cache=True)
def _turned(across, up, tilt):
    """Return a vector of a block that is tilted toward +x."""
    return across * math.cos(tilt) + up * math.sin(tilt), up * math.cos(tilt) - across * math.sin(tilt)


@njit(cache=True)
def _contacts(q, sizes, gaps, rows):
    """Fill the gaps of the corners [m], and the rows that give their velocities along and off what carries them."""
    b, h, half, height = sizes
    rows[:] = 0.0
    for k in range(4):
        lower, side = k < 2, 2.0 * (k % 2) - 1.0
        at, phi = (0, 0.0) if lower else (3, q[LOWER])
        ox, oz = _turned(side * (b if lower else half), -(h if lower else height), q[at + 2])
        arm_x, arm_z = q[at] + ox - q[0], q[at + 1] + oz - q[1]  # of an upper corner, from the lower centre
        for way in range(2):
            dx, dz = _turned(1.0 - way, 1.0 * way, phi)
            rows[k, way, at], rows[k, way, at + 1], rows[k, way, at + 2] = dx, dz, oz * dx - ox * dz
            if lower:
                rows[k, way, BASE] = way - 1.0
            else:
                rows[k, way, 0], rows[k, way, 1], rows[k, way, 2] = -dx, -dz, arm_x * dz - arm_z * dx
        gaps[k] = q[1] + oz if lower else arm_x * dx + arm_z * dz - h


@njit(cache=True)
def _penetrating(v, gaps, rows):
    """Return the largest velocity at which a closed corner penetrates [m/s], at least 0."""
    return np.max(np.where(gaps <= 0, -(rows[:, 1] * v).sum(axis=1), 0.0))


@njit(cache=True)
def _carried(v, gaps, rows, inverse, scale):
    """Return the velocities after a step, of the set of carrying corners that violates the laws of contact least."""
    best, after, closed = _penetrating(v, gaps, rows), v, np.sum((gaps <= 0) * 2.0 ** np.arange(4))
    for chosen in range(15, 0, -1):
        if best <= ROUNDING * scale:
            break
        if chosen & ~int(closed):
            continue
        A, normal, count = np.zeros((6, 7)), np.zeros(6), 0
        for k in range(4):
            if chosen >> k & 1:
                if k % 2 == 0 or not chosen >> (k - 1) & 1:  # two corners stick as one does
                    A[count], count = rows[k, 0], count + 1
                A[count], normal[count], count = rows[k, 1], inverse[3], count + 1
        used = A[:count]
        impulses = np.linalg.solve((used * inverse) @ used.T, -(used @ v))
        velocities = v + inverse * (used.T @ impulses)
        wrong = max(_penetrating(velocities, gaps, rows), -np.min(normal[:count] * impulses))
        if wrong < best:
            best, after = wrong, velocities
    return after


@njit(cache=True)
def _march(par, sizes, inverse, h, ground, gravity, q, rows):
    """Take all steps under the mean a_g and g + a_v [m/s2] in each; return how many were taken before a fall."""
    v, z, gaps, contacts = np.zeros(7), par.z, np.zeros(4), np.zeros((4, 2, 7))
    for k in range(len(ground) + 1):
        energy = par.g * (q[1] / inverse[0] + q[4] / inverse[3]) + 0.5 * np.sum(
            v[inverse > 0] ** 2 / inverse[inverse > 0]
        )
        rows[k] = k * h, q[LOWER], q[UPPER], q[BASE], energy
        if k == len(ground) or max(abs(q[LOWER]), abs(q[UPPER] - q[LOWER])) >= 0.5 * math.pi:
            break
        middle = q + 0.5 * h * v
        free = v.copy()
        free[:UPPER] -= h * np.array([ground[k], gravity[k], 0.0, ground[k], gravity[k]])
        if inverse[BASE] > 0:
            hysteretic = hysteretic_force(z, middle[BASE] - q[BASE], par.law, par.constants)
            force = par.count * (par.kb * middle[BASE] + hysteretic + par.damping * v[BASE])
            free[BASE] -= h * (ground[k] + force * inverse[BASE])
        _contacts(middle, sizes, gaps, contacts)
        v = _carried(free, gaps, contacts, inverse, par.g * h + np.abs(v).max())
        last, q = q[BASE], middle + 0.5 * h * v
        z = hysteretic_force(z, q[BASE] - last, par.law, par.constants)
    return k
