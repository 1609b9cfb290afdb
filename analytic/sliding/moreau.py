"""The second implementation of the block that may slide: Moreau's time stepping, of first order.

It knows no modes and no events: a planar block with two corners, unilateral contact and Coulomb friction at each. In a
step of length h the coordinates move to the midpoint q + h/2 v; corners that do not gape there are closed; impulses on
these give the velocities after the step, with which the coordinates move on. An impact is a step as any other: what is
required of the velocities after it (no corner penetrates, Coulomb's law on the impulses) is the plastic impact.

J. J. Moreau (1999), Numerical aspects of the sweeping process, Comput. Methods Appl. Mech. Eng. 177, 329-349;
M. Jean (1999), The non-smooth contact dynamics method, ibid., 235-257.
"""

from __future__ import annotations

import math
import time
from collections import namedtuple
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..bearing import hysteretic_force
from ..budget import MOST_ROWS
from ..compiled import entry, inner
from ..errors import SceneError, SettingError
from ..motion import SampledMotion
from ..response import State
from ..solver import parameters

if TYPE_CHECKING:
    from ..motion import Motion
    from ..scene import Scene

# Of the centre of mass (X, Y), the tilt, and the base x relative to the ground: coordinates or velocities.
Planar = namedtuple("Planar", "X Y tilt x")
# m, J_G, 1/m_b (0 on rigid ground), coefficient of friction.
Body = namedtuple("Body", "m J base mu")
# A corner lies at (n, -c) from the centre of mass; closed: it does not gape.
Corner = namedtuple("Corner", "c n closed")
NEITHER, FIRST, SECOND, BOTH = range(4)  # corners that carry; the first is that at -x


@dataclass(frozen=True)
class Slid:
    """What became of the block.

    outcome : "stands", "slides" (never lifted), "rocks" or "overturns". overturning_time : of |tilt| = pi/2 [s].
    end : at the duration, or at overturning.
    slip : displacement of the lower corner along its base at the end [m]; peak_slip : the largest |slip|; path : the
    whole way slid. peak_tilt [rad] and peak_base_displacement [m] are at ends of steps; impacts : how often the block
    goes from one corner to the other.
    """

    outcome: str
    overturning_time: float | None
    peak_tilt: float
    peak_base_displacement: float
    slip: float
    peak_slip: float
    path: float
    impacts: int
    end: State
    steps: int
    cpu_seconds: float


def simulate_moreau(scene: Scene, *, step: float) -> Slid:
    """Simulate a scene that has a duration and `friction`.

    Parameters
    ----------
    scene : Scene
    step : float
        Longest step [s]; the duration is divided into equal ones.

    Raises
    ------
    SceneError
        The scene has no duration or friction, or a given restitution.
    SettingError
        The step is not positive, or too short for the run.
    """
    if scene.friction is None:
        raise SceneError("friction", None, "missing", "give the coefficient of friction")
    if scene.duration is None:
        raise SceneError("run.duration", None, "missing", "give one [s]")
    if scene.block.restitution is not None:
        raise SceneError("block.restitution", scene.block.restitution, "not used where the block slides", "remove it")
    if not (step > 0 and scene.duration <= MOST_ROWS * step < math.inf):
        raise SettingError(f"step = {step!r}: give at least {scene.duration / MOST_ROWS:.3g} s")
    par, count = parameters(scene), math.ceil(scene.duration / step * (1 - 1e-12))
    h = scene.duration / count
    body = Body(par.m, scene.block.centre_inertia, 1 / scene.base.mass if scene.base else 0.0, scene.friction)
    nothing = np.zeros(0)
    _march(par, body, h, nothing, nothing)  # compiled before the clock starts
    started = time.process_time()
    ground = _means(scene.motion, h, count)
    gravity = scene.gravity + _means(scene.motion and scene.motion.vertical, h, count)
    taken, lifted, impacts, (tilt, x, slip, path), end_slip, end = _march(par, body, h, ground, gravity)
    over = taken < count or abs(end[0]) >= math.pi / 2
    upright = "rocks" if lifted else "slides" if slip > 0 else "stands"
    return Slid(
        outcome="overturns" if over else upright,
        overturning_time=taken * h if over else None,
        peak_tilt=tilt,
        peak_base_displacement=x,
        slip=end_slip,
        peak_slip=slip,
        path=path,
        impacts=impacts,
        end=State(taken * h, *end),
        steps=math.ceil(taken),
        cpu_seconds=time.process_time() - started,
    )


def _means(motion: Motion | None, h: float, count: int) -> np.ndarray:
    """Mean acceleration [m/s2] in each step, exact where it jumps: the gain of ground velocity over h."""
    if motion is None:
        return np.zeros(count)
    edges = h * np.arange(count + 1)
    if isinstance(motion, SampledMotion):
        from scipy.interpolate import make_interp_spline  # slow to load

        sampled = make_interp_spline(motion.dt * np.arange(len(motion.samples)), motion.samples, k=1)
        speed = sampled.antiderivative()(np.minimum(edges, motion.end))
    else:
        u = np.clip(motion.frequency * (edges - motion.start), 0.0, motion.form.length)
        speed = motion.amplitude / motion.frequency * motion.form.integral(np, u, motion.phase)
    return np.diff(speed) / h


@inner
def _slip_rate(v, corner):
    return v.X - corner.c * v.tilt - v.x


@inner
def _approach(v, corner):
    """Velocity at which a closed corner would penetrate [m/s]."""
    return max(corner.n * v.tilt - v.Y, 0.0) if corner.closed else 0.0


@inner
def _on_one(v, body, corner, sigma):
    """(T, N, velocities after): one corner carries, and sticks (sigma = 0) or slips with this sign.

    T and N are the tangential and normal impulse of the base on the block [N s].
    """
    slip, gap, c, n, m = _slip_rate(v, corner), v.Y - corner.n * v.tilt, corner.c, corner.n, body.m
    nn, tn, tt = 1 / m + n * n / body.J, c * n / body.J, 1 / m + body.base + c * c / body.J
    if sigma == 0:
        T, N = (tn * gap - nn * slip) / (nn * tt - tn * tn), (tn * slip - tt * gap) / (nn * tt - tn * tn)
    else:
        N = -gap / (nn - sigma * body.mu * tn)
        T = -sigma * body.mu * N
    return T, N, Planar(v.X + T / m, v.Y + N / m, v.tilt - (c * T + n * N) / body.J, v.x - T * body.base)


@inner
def _on_both(v, body, first, second, sigma):
    """(T, N, the lesser N of a corner, velocities after): both carry, thus the block does not turn.

    They share T as N, which is Coulomb's law where they slip, and one way among others where they stick.
    """
    N = -body.m * v.Y
    T = -(v.X - v.x) / (1 / body.m + body.base) if sigma == 0 else -sigma * body.mu * N
    ratio = T / N if N > 0 else 0.0
    here, there = first.c * ratio + first.n, second.c * ratio + second.n  # here N_1 + there N_2 = J_G tilt'
    one = (body.J * v.tilt - there * N) / (here - there)
    x = v.x - T * body.base
    return T, N, min(one, N - one), Planar(x if sigma == 0 else v.X + T / body.m, 0.0, 0.0, x)


@inner
def _solve(v, body, first, second):
    """(velocities after, corners that carry): the mode that violates the laws of contact least, by rounding only."""
    carrying, after, best = NEITHER, v, max(_approach(v, first), _approach(v, second))
    for corners in (BOTH, FIRST, SECOND):
        if (corners & FIRST and not first.closed) or (corners & SECOND and not second.closed):
            continue
        corner, other = (second, first) if corners == SECOND else (first, second)
        for sigma in (0.0, -1.0, 1.0):
            if best <= 0:
                return after, carrying
            if corners == BOTH:
                T, N, least, found = _on_both(v, body, first, second, sigma)
                wrong = 0.0
            else:
                T, N, found = _on_one(v, body, corner, sigma)
                least, wrong = N, _approach(found, other)
            impulse = max(-least, abs(T) - body.mu * N)
            wrong = max(wrong, impulse / body.m, -sigma * _slip_rate(found, corner))
            if wrong < best:
                carrying, after, best = corners, found, wrong
    return after, carrying


@inner
def _corner(par, s, q):
    c, n = par.R * math.cos(s * par.gamma - q.tilt), par.R * math.sin(s * par.gamma - q.tilt)
    return Corner(c, n, q.Y <= c)


@inner
def _moved(q, v, duration):
    return Planar(q.X + duration * v.X, q.Y + duration * v.Y, q.tilt + duration * v.tilt, q.x + duration * v.x)


@inner
def _slip(par, q):
    """Displacement of the lower corner along its base [m]."""
    s = math.copysign(1.0, q.tilt)
    return q.X - q.x + par.R * (math.sin(s * par.gamma - q.tilt) - s * math.sin(par.gamma))


@inner
def _start(par):
    """Coordinates and velocities: the lower corner touches the base and does not slip."""
    s = math.copysign(1.0, par.tilt if par.tilt != 0 else par.rate)
    corner = _corner(par, s, Planar(0.0, 0.0, par.tilt, 0.0))
    q = Planar(par.x + (s * par.R * math.sin(par.gamma) - corner.n), corner.c, par.tilt, par.x)
    return q, Planar(par.v + corner.c * par.rate, corner.n * par.rate, par.rate, par.v)


@entry
def _march(par, body, h, ground, gravity):
    """All steps, under the mean a_g and g + a_v [m/s2] in each.

    Returns (steps taken, lifted?, impacts, (peaks of tilt, x and slip, path), slip, (tilt, rate, x, v, force)).
    """
    (q, v), z, pivot, impacts, taken = _start(par), par.z, NEITHER, 0, 0.0
    lifted = q.tilt != 0 or v.tilt != 0
    slip, peak_tilt, peak_x, peak_slip, path = _slip(par, q), abs(q.tilt), abs(q.x), 0.0, 0.0
    for k in range(len(ground)):
        before, middle = q, _moved(q, v, 0.5 * h)
        force = par.count * (
            par.kb * middle.x + hysteretic_force(z, middle.x - q.x, par.law, par.constants) + par.damping * v.x
        )
        base = v.x - h * (ground[k] + force * body.base) if body.base > 0 else 0.0
        free = Planar(v.X - h * ground[k], v.Y - h * gravity[k], v.tilt, base)
        v, carrying = _solve(free, body, _corner(par, -1.0, middle), _corner(par, 1.0, middle))
        q = _moved(middle, v, 0.5 * h)
        z = hysteretic_force(z, q.x - before.x, par.law, par.constants)
        lifted = lifted or carrying != BOTH
        if (carrying == FIRST and pivot == SECOND) or (carrying == SECOND and pivot == FIRST):
            impacts += 1
        pivot = carrying if carrying != NEITHER else pivot
        taken, share = k + 1.0, 1.0
        if abs(q.tilt) >= 0.5 * math.pi:
            share = (0.5 * math.pi - abs(before.tilt)) / (abs(q.tilt) - abs(before.tilt))
            taken, q = k + share, _moved(before, _moved(q, before, -1.0), share)
        last, slip = slip, _slip(par, q)
        path += abs(slip - last)
        peak_tilt, peak_x, peak_slip = max(peak_tilt, abs(q.tilt)), max(peak_x, abs(q.x)), max(peak_slip, abs(slip))
        if share < 1:
            break
    force = par.count * (par.kb * q.x + z + par.damping * v.x)
    return taken, lifted, impacts, (peak_tilt, peak_x, peak_slip, path), slip, (q.tilt, v.tilt, q.x, v.x, force)
