"""A small fixed-step integrator that, like multibody engines, sees an impact only at the end of a step.

Without a friction it is semi-implicit Euler: accelerations at the start of the step, velocities first, then positions.
The impact law is that of eqs (7), (8), so that all differences from the event-driven model come from time stepping.

With a friction it is Moreau's time stepping, the second implementation of the block that may slide. It knows neither
modes nor events: a planar block has two corners, with unilateral contact and Coulomb friction at each. In a step of
length h the coordinates move to the midpoint q + h/2 v. Corners that do not gape there are closed. Impulses on these
give the velocities after the step, with which the coordinates move on. An impact is a step like any other: the plastic
impact follows from what is required of the velocities after it (no corner penetrates, and Coulomb's law holds).

J. J. Moreau (1999), Numerical aspects of the sweeping process, Comput. Methods Appl. Mech. Eng. 177, 329-349;
M. Jean (1999), The non-smooth contact dynamics method, ibid., 235-257.
"""

from __future__ import annotations

import functools
import math
import platform
import time
from collections import namedtuple
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from ..errors import SceneError, SettingError, require
from ..kernel.cache import cached
from ..kernel.compiled import inner
from ..kernel.layout import Body
from ..motion import SampledMotion
from ..response import History, Impact, Response, Sliding, State
from ..rocking import hysteretic_force
from ..solver import MOST_ROWS, MOST_STEPS, is_decided, parameters, until_decided

if TYPE_CHECKING:
    from ..motion import Motion
    from ..scene import Scene

# Of the centre of mass (X, Y), the tilt, and the base x relative to the ground: coordinates or velocities.
Planar = namedtuple("Planar", "X Y tilt x")
# m, J_G, 1/m_b (0 on rigid ground), coefficient of friction.
Slider = namedtuple("Slider", "m J base mu")
# A corner lies at (n, -c) from the centre of mass; closed: it does not gape.
Corner = namedtuple("Corner", "c n closed")
NEITHER, FIRST, SECOND, BOTH = range(4)  # corners that carry; the first is that at -x


def simulate_time_stepping(scene: Scene, *, step: float, history: bool = True) -> Response:
    """Simulate a scene with steps of fixed length.

    Parameters
    ----------
    scene : Scene
        With a `friction` the block may slide and fly; its restitution is then that of a plastic impact.
    step : float
        [s]; the last step may end after the duration. With a friction it is the longest step: the duration is divided
        into equal ones.
    history : bool
        Whether to keep the state at every step.

    Returns
    -------
    Response
        engine "time-stepping", without energy ledger. All times and extremes are at ends of steps. With a friction
        there are no uplifts and rests; forces, accelerations and the work of friction are NaN; an impact is where the
        block passes from one corner to the other.

    Raises
    ------
    SceneError
        The scene has a friction, and a given restitution or a pedestal.
    SettingError
        The step is not positive, or too short for the run.
    """
    require(step > 0 and math.isfinite(step), f"step = {step!r} is not positive: give a finite value above 0 [s]")
    if scene.duration is None:
        return until_decided(lambda cut: simulate_time_stepping(cut, step=step, history=history), scene)
    most = MOST_ROWS if history else MOST_STEPS
    if scene.duration > most * step:
        steps, least = scene.duration / step, scene.duration / most
        raise SettingError(f"step = {step!r}: {steps:.3g} steps; give at least {least:.3g} s")
    par, count, columns = parameters(scene), math.ceil(scene.duration / step * (1 - 1e-12)), 6
    march: Callable[..., Any] = _march
    h, shaking = step, _samples
    if scene.friction is not None:
        if scene.block.restitution is not None:
            words = "not used where the block slides"
            raise SceneError("block.restitution", scene.block.restitution, words, "remove it")
        if scene.pedestal is not None:
            raise SceneError("pedestal.width", scene.pedestal.width, "not known to this solver", "remove the pedestal")
        mass = scene.base_mass if scene.base else math.inf
        body = Slider(par.m, scene.block.centre_inertia, 1 / mass, scene.friction)
        h, columns, shaking, march = scene.duration / count, 7, _means, functools.partial(_slide, body)
    nothing = np.zeros(1)
    march(par, h, nothing, nothing, np.empty((0, columns)))  # compiled before the clock starts
    started = time.process_time()
    ground = shaking(scene.motion, h, count)
    gravity = par.g + shaking(scene.motion and scene.motion.vertical, h, count)
    rows = np.empty((count + 1 if history else 0, columns))
    marched = march(par, h, ground, gravity, rows)
    response = _response(scene, h, marched, time.process_time() - started)
    if history:
        table = rows[: response.steps + 1].T
        level = np.zeros(table.shape[1]) if scene.motion is None else scene.motion.acceleration(table[0])
        response = replace(response, history=History(*table[:6], level, *table[6:]))  # type: ignore[call-arg]  # of eight at most
    return replace(response, decided=is_decided(scene, response))


def _response(scene, h, marched, seconds):
    """Return the `Response` without history; marched: what `_march` or `_slide` returns."""
    taken, over, lifted, (impacts, uplifts, rests), (unstable, fall), extremes, end, slips = marched
    peak_tilt, peak_x, peak_acceleration, friction, normal = extremes
    end_slip, peak_slip, path = slips
    upright = "rocks" if lifted else "slides" if peak_slip > 0 else "stands"
    return Response(
        engine="time-stepping",
        variant="semi-implicit Euler" if scene.friction is None else "Moreau",
        outcome="overturns" if over else upright,
        overturning_time=taken * h if over else None,
        unstable_time=None if unstable < 0 else unstable,
        fall_time=fall if over else None,
        peak_tilt=peak_tilt,
        peak_tilt_ratio=peak_tilt / scene.block.slenderness,
        peak_base_displacement=peak_x,
        peak_base_acceleration=peak_acceleration,
        impacts=tuple(Impact(*impact) for impact in impacts),
        uplifts=tuple(uplifts),
        rests=tuple(rests),
        friction_demand=friction,
        min_normal_ratio=normal,
        end=State(taken * h, *end),
        cpu_seconds=seconds,
        steps=math.ceil(taken),
        settings={"step": h},
        versions={"python": platform.python_version(), "numpy": np.__version__, "numba": numba.__version__},
        scene=scene.name,
        sliding=Sliding(peak_slip, end_slip, path, math.nan, ()) if scene.friction is not None else None,
    )


def _samples(motion: Motion | None, h: float, count: int) -> np.ndarray:
    """Return the acceleration [m/s2] at the ends of the steps."""
    return np.zeros(count + 1) if motion is None else motion.acceleration(h * np.arange(count + 1))


def _means(motion: Motion | None, h: float, count: int) -> np.ndarray:
    """Return the mean acceleration [m/s2] in each step: the gain of ground velocity over h, exact where it jumps."""
    if motion is None:
        return np.zeros(count)
    edges = h * np.arange(count + 1)
    if isinstance(motion, SampledMotion):
        from scipy.interpolate import make_interp_spline

        sampled = make_interp_spline(motion.dt * np.arange(len(motion.samples)), motion.samples, k=1)
        speed = sampled.antiderivative()(np.minimum(edges, motion.end))
    else:
        u = np.clip(motion.frequency * (edges - motion.start), 0.0, motion.form.length)
        speed = motion.amplitude / motion.frequency * motion.form.integral(np, u, motion.phase)
    return np.diff(speed) / h


@inner
def _rocking(par, body, a, g, force):
    """Return (phi'', absolute acceleration of the base, forces at the corner) while the block rocks, (3)-(6)."""
    (side, tilt, rate), m, M, J = body, par.m, par.M, par.J
    c, n = par.R * math.cos(side * par.gamma - tilt), par.R * math.sin(side * par.gamma - tilt)
    spin, absolute = -m * (c * a + g * n) / J, a
    if par.on_base:
        push, moment = -m * n * rate * rate - force, -m * g * n
        determinant = M * J - (m * c) ** 2
        spin, absolute = (M * moment - m * c * push) / determinant, (J * push - m * c * moment) / determinant
    return spin, absolute, m * (absolute + c * spin + n * rate * rate), m * (g + n * spin - c * rate * rate)


@cached(nogil=True)
def _march(par, h, ground, gravity, rows):
    """Take all steps, under a_g and g + a_v [m/s2] at each.

    Returns (steps taken, overturned?, lifted?, (impacts, uplifts, rests), (unstable time or -1, fall time), extremes,
    end, (slip, largest slip, path)).
    """
    m, gamma, on_base, tilt, rate, x, v, z = par.m, par.gamma, par.on_base, par.tilt, par.rate, par.x, par.v, par.z
    side = math.copysign(1.0, tilt if tilt != 0 else rate) if tilt != 0 or rate != 0 else 0.0
    impacts, uplifts, rests = [(0.0, 0.0, 0.0, 0.0)], [0.0], [0.0]
    impacts.pop(), uplifts.pop(), rests.pop()
    unstable, peak_tilt, peak_x, peak_a, friction, normal = -1.0, abs(tilt), abs(x), 0.0, 0.0, 1.0
    force, taken, over, held = 0.0, 0, False, (peak_x, peak_a, friction, normal, 0.0)
    for k in range(len(ground)):
        taken, t, a, g = k, k * h, ground[k], gravity[k]
        force = par.count * (par.kb * x + z + par.damping * v)
        if len(rows) > 0:
            rows[k] = (t, tilt, rate, x, v, force)
        peak_tilt, peak_x = max(peak_tilt, abs(tilt)), max(peak_x, abs(x))
        if unstable < 0 and abs(tilt) >= gamma:
            unstable = t
        over = abs(tilt) >= math.pi / 2
        if over:
            break
        absolute = -force / par.M if on_base else a  # (2)
        if side == 0 and abs(absolute) > g * par.slope:
            side = -math.copysign(1.0, absolute)
            uplifts.append(t)
        spin, horizontal, vertical = 0.0, m * absolute, m * g
        if side != 0:
            spin, absolute, horizontal, vertical = _rocking(par, Body(side, tilt, rate), a, g, force)
        peak_a = max(peak_a, abs(absolute))
        friction = max(friction, abs(horizontal) / vertical if vertical > 0 else math.inf)
        normal = min(normal, vertical / (m * par.g))
        if abs(tilt) <= gamma:  # otherwise the last fall, unless the block comes back
            held = peak_x, peak_a, friction, normal, t
        if k == len(ground) - 1:
            break
        rate += h * spin
        tilt += h * rate
        if on_base:
            v += h * (absolute - a)
            x += h * v
            z = hysteretic_force(z, h * v, par.law, par.constants)
        if side != 0 and side * tilt <= 0 and side * rate < 0:
            before, rate = rate, par.e * rate  # (7)
            if on_base:
                v += par.arm * (before - rate)  # (8)
            impacts.append((t + h, before, rate, par.arm * (before - rate)))
            side = -side
            if abs(rate) <= abs(spin) * h:  # the swing would be shorter than a step
                v += par.arm * rate
                tilt, rate, side = 0.0, 0.0, 0.0
                rests.append(t + h)
    if over:
        peak_x, peak_a, friction, normal, _ = held
    extremes, end = (peak_tilt, peak_x, peak_a, friction, normal), (tilt, rate, x, v, force)
    lifted, slips = par.tilt != 0 or par.rate != 0 or len(uplifts) > 0, (0.0, 0.0, 0.0)
    return taken, over, lifted, (impacts, uplifts, rests), (unstable, held[4]), extremes, end, slips


@inner
def _slip_rate(v, corner):
    return v.X - corner.c * v.tilt - v.x


@inner
def _approach(v, corner):
    """Return the velocity at which a closed corner would penetrate [m/s]."""
    return max(corner.n * v.tilt - v.Y, 0.0) if corner.closed else 0.0


@inner
def _on_one(v, body, corner, sigma):
    """Return (T, N, velocities after): one corner carries, and sticks (sigma = 0) or slips with this sign.

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
    """Return (T, N, the lesser N of a corner, velocities after): both corners carry, so that the block does not turn.

    They share T as they share N. This is Coulomb's law where they slip, and one way among others where they stick.
    """
    N = -body.m * v.Y
    T = -(v.X - v.x) / (1 / body.m + body.base) if sigma == 0 else -sigma * body.mu * N
    ratio = T / N if N > 0 else 0.0
    # lever N_1 + other_lever N_2 = J_G tilt'
    lever, other_lever = first.c * ratio + first.n, second.c * ratio + second.n
    N_first = (body.J * v.tilt - other_lever * N) / (lever - other_lever)
    x = v.x - T * body.base
    return T, N, min(N_first, N - N_first), Planar(x if sigma == 0 else v.X + T / body.m, 0.0, 0.0, x)


@inner
def _solve(v, body, first, second):
    """Return (velocities after, corners that carry) of the mode that violates the laws of contact least.

    What it violates is by rounding only.
    """
    carrying, after, best = NEITHER, v, max(_approach(v, first), _approach(v, second))
    for corners in (BOTH, FIRST, SECOND):
        if (corners & FIRST and not first.closed) or (corners & SECOND and not second.closed):
            continue
        corner, opposite = (second, first) if corners == SECOND else (first, second)
        for sigma in (0.0, -1.0, 1.0):
            if best <= 0:
                return after, carrying
            if corners == BOTH:
                T, N, least, velocities = _on_both(v, body, first, second, sigma)
                wrong = 0.0
            else:
                T, N, velocities = _on_one(v, body, corner, sigma)
                least, wrong = N, _approach(velocities, opposite)
            impulse = max(-least, abs(T) - body.mu * N)
            wrong = max(wrong, impulse / body.m, -sigma * _slip_rate(velocities, corner))
            if wrong < best:
                carrying, after, best = corners, velocities, wrong
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
    """Return the displacement of the lower corner along its base [m]."""
    s = math.copysign(1.0, q.tilt)
    return q.X - q.x + par.R * (math.sin(s * par.gamma - q.tilt) - s * math.sin(par.gamma))


@inner
def _start(par):
    """Return coordinates and velocities at the start: the lower corner touches the base and does not slip."""
    s = math.copysign(1.0, par.tilt if par.tilt != 0 else par.rate)
    corner = _corner(par, s, Planar(0.0, 0.0, par.tilt, 0.0))
    q = Planar(par.x + (s * par.R * math.sin(par.gamma) - corner.n), corner.c, par.tilt, par.x)
    return q, Planar(par.v + corner.c * par.rate, corner.n * par.rate, par.rate, par.v)


@inner
def _force(par, x, z, v):
    """Return the force of all bearings [N]."""
    return par.count * (par.kb * x + z + par.damping * v)


@cached(nogil=True)
def _slide(body, par, h, ground, gravity, rows):
    """Take all steps of a block that may slide, under the mean a_g and g + a_v [m/s2] in each; return as `_march`."""
    (q, v), z, pivot, taken, impacts, never = _start(par), par.z, NEITHER, 0.0, [(0.0, 0.0, 0.0, 0.0)], [0.0]
    impacts.pop(), never.pop()
    lifted, unstable, slip, path = q.tilt != 0 or v.tilt != 0, -1.0, _slip(par, q), 0.0
    peak_tilt, peak_x, peak_slip = abs(q.tilt), abs(q.x), 0.0
    held = peak_x, 0.0  # up to the last |tilt| of at most the slenderness: largest |x|, time
    if len(rows) > 0:
        rows[0] = (0.0, q.tilt, v.tilt, q.x, v.x, _force(par, q.x, z, v.x), slip)
    for k in range(len(ground)):
        before, middle, rate, speed = q, _moved(q, v, 0.5 * h), v.tilt, v.x
        force = _force(par, middle.x, hysteretic_force(z, middle.x - q.x, par.law, par.constants), v.x)
        base = v.x - h * (ground[k] + force * body.base) if body.base > 0 else 0.0
        free = Planar(v.X - h * ground[k], v.Y - h * gravity[k], v.tilt, base)
        v, carrying = _solve(free, body, _corner(par, -1.0, middle), _corner(par, 1.0, middle))
        q = _moved(middle, v, 0.5 * h)
        z = hysteretic_force(z, q.x - before.x, par.law, par.constants)
        lifted = lifted or carrying != BOTH
        taken, share = k + 1.0, 1.0
        if abs(q.tilt) >= 0.5 * math.pi:
            share = (0.5 * math.pi - abs(before.tilt)) / (abs(q.tilt) - abs(before.tilt))
            taken, q = k + share, _moved(before, _moved(q, before, -1.0), share)
        if (carrying == FIRST and pivot == SECOND) or (carrying == SECOND and pivot == FIRST):
            impacts.append((taken * h, rate, v.tilt, v.x - speed))
        pivot = carrying if carrying != NEITHER else pivot
        last, slip = slip, _slip(par, q)
        path += abs(slip - last)
        peak_tilt, peak_x, peak_slip = max(peak_tilt, abs(q.tilt)), max(peak_x, abs(q.x)), max(peak_slip, abs(slip))
        if abs(q.tilt) <= par.gamma:
            held = peak_x, taken * h
        elif unstable < 0:
            unstable = taken * h
        if len(rows) > 0:
            rows[k + 1] = (taken * h, q.tilt, v.tilt, q.x, v.x, _force(par, q.x, z, v.x), slip)
        if share < 1:
            break
    over, end = (
        abs(q.tilt) >= 0.5 * math.pi or taken < len(ground),
        (q.tilt, v.tilt, q.x, v.x, _force(par, q.x, z, v.x)),
    )
    extremes = peak_tilt, held[0] if over else peak_x, math.nan, math.nan, math.nan
    return taken, over, lifted, (impacts, never, never), (unstable, held[1]), extremes, end, (slip, peak_slip, path)
