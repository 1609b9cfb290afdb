"""How Chipmunk's contact solver gets on with a scene: iterations, and the friction at which they settle.

Chipmunk solves contact after contact, normal and friction of a contact at once: a Gauss-Seidel method of blocks whose
two equations are solved by Jacobi's.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from analytic import Start
from analytic.rocking import restitution

if TYPE_CHECKING:
    from analytic import Scene

# Coefficients between the block and what it stands on, of which the first is taken that settles, where the scene gives
# none: the model's "no sliding". At 5 blocks of J_O = 1.03 m R^2 and less and slenderness .4 to .8 come out of an
# impact at any rate, 7 times that before it, say, however many the iterations.
FRICTIONS = (5.0, 2.5, 1.5, 1.0)
SETTLED, RIGHT = 1e-9, 1e-6  # change of an impulse in the last iteration, error of the tilt rate; shares
LEAST_ITERATIONS, MOST_ITERATIONS, LOST_ITERATIONS = 10, 20_000, 1000  # lost: where they never settle
RESERVE = 2  # times the iterations that an impact needs from nothing
# What the iterations of a step may leave undone, as a share, pivoting on one corner and standing on two.
ROCKING_REST, STANDING_REST = 1e-8, 1e-6


def iterations(scene: Scene, corners: int) -> int:
    """Iterations until ROCKING_REST (one corner) or STANDING_REST (two) is left of a load."""
    return max(_iterations(one, corners) for one in _grounds(scene))


def _grounds(scene: Scene) -> tuple[Scene, ...]:
    """The scene, and that on rigid ground: a base that bearings hold meets an impulse with more than its mass."""
    return (scene,) if scene.bearings is None else (scene, scene.with_(base=None, bearings=None, start=Start()))


def _iterations(scene: Scene, corners: int) -> int:
    """Their rate is an eigenvalue, near 1 for J_O near m R^2 and, on two corners, for slender blocks."""
    block = scene.block
    b, h, light = block.half_width, block.half_height, scene.base.mass if scene.base else math.inf
    mobility = np.diag([1 / block.mass, 1 / block.mass, 1 / block.centre_inertia, 1 / light])
    across = (b,) if corners == 1 else (-b, b)
    directions = np.array([row for x in across for row in ([0, 1, -x, 0], [1, 0, -h, -1])])
    delassus = directions @ mobility @ directions.T
    contact = np.arange(2 * corners) // 2
    solved = np.where((contact[:, None] > contact) | np.eye(2 * corners, dtype=bool), delassus, 0.0)
    rates = np.abs(np.linalg.eigvals(np.linalg.solve(solved, solved - delassus)))
    rate = rates[rates < 1 - 1e-9].max()  # 1: the two corners' shares of the friction, which do not matter
    rest = (ROCKING_REST, STANDING_REST)[corners - 1]
    needed = math.log(rest * min(1.0, light / block.mass)) / math.log(rate) if rate > 0 else 1.0
    return min(max(math.ceil(needed), LEAST_ITERATIONS), MOST_ITERATIONS)


def landing(scene: Scene, friction: float, first: int) -> tuple[int, float]:
    """(iterations, error of the tilt rate after it as a share) of an impact of the block: Chipmunk's method, by hand.

    The block turns about one corner, at rest, on to the other; both are in contact, no impulse is known. first: 1 where
    Chipmunk solves the corner that lands first, -1 where it is the other.
    """
    block = scene.block
    b, h, m, inertia = block.half_width, block.half_height, block.mass, block.centre_inertia
    drag = 1 / scene.base.mass if scene.base else 0.0
    push, pull = 1 / (1 / m + b * b / inertia), 1 / (1 / m + h * h / inertia + drag)
    vx, vz, spin, v, normal, tangent = -h, -b, 1.0, 0.0, [0.0, 0.0], [0.0, 0.0]
    corners, unit = ((0, -first * b), (1, first * b)), 2 * b * m
    for done in range(MOST_ITERATIONS):
        change = 0.0
        for k, x in corners:
            up, across = vz + spin * x, vx + spin * h - v
            n = max(normal[k] - up * push, 0.0)
            t = min(max(tangent[k] - across * pull, -friction * n), friction * n)
            dn, dt, normal[k], tangent[k] = n - normal[k], t - tangent[k], n, t
            vx, vz, spin, v = vx + dt / m, vz + dn / m, spin + (dn * x + dt * h) / inertia, v - dt * drag
            change = max(change, abs(dn), abs(dt))
        if change < SETTLED * unit:
            return done + 1, abs(spin - max(restitution(scene), 0.0))
    return MOST_ITERATIONS, math.inf


def settled(scene: Scene) -> tuple[float, int, bool]:
    """(friction, iterations of an impact, whether these settle at once) for a scene.

    At once: at the first choice of friction, on eq. (7); at a friction that the scene gives the block may slide.
    """
    choices = FRICTIONS if scene.friction is None else (scene.friction,)
    for friction in choices:
        found = [landing(one, friction, first) for one in _grounds(scene) for first in (1, -1)]
        counts, errors = zip(*found, strict=True)
        if max(errors) < (RIGHT if scene.friction is None else math.inf):
            return friction, max(RESERVE * max(counts), LEAST_ITERATIONS), friction == choices[0]
    return friction, LOST_ITERATIONS, False
