"""A small fixed-step integrator that, like multibody engines, detects an impact only at the end of a step.

Semi-implicit Euler: accelerations at the start of the step, velocities first, then positions. The impact law is that of
eqs (7), (8), so that all differences from the event-driven model come from time stepping.
"""

from __future__ import annotations

import math
import platform
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numba
import numpy as np
from numba import njit

from .bearing import hysteretic_force
from .budget import MOST_ROWS, MOST_STEPS
from .compiled import inner
from .errors import SettingError
from .layout import Body
from .motion import vertical_acceleration
from .response import History, Impact, Response, State
from .solver import parameters
from .termination import is_decided, until_decided

if TYPE_CHECKING:
    from .scene import Scene


def simulate_time_stepping(scene: Scene, *, step: float, history: bool = True) -> Response:
    """Simulate a scene with steps of fixed length.

    Parameters
    ----------
    scene : Scene
    step : float
        [s]; the last step may end after the duration.
    history : bool
        Whether to keep the state at every step.

    Returns
    -------
    Response
        engine "time-stepping", without energy ledger. All times and extremes are at ends of steps.

    Raises
    ------
    SettingError
        The step is not positive, or too short for the run.
    """
    if not (step > 0 and math.isfinite(step)):
        raise SettingError(f"step = {step!r} is not positive: give a finite value above 0 [s]")
    if scene.duration is None:
        return until_decided(lambda cut: simulate_time_stepping(cut, step=step, history=history), scene)
    most = MOST_ROWS if history else MOST_STEPS
    if scene.duration > most * step:
        steps, least = scene.duration / step, scene.duration / most
        raise SettingError(f"step = {step!r}: {steps:.3g} steps; give at least {least:.3g} s")
    par, count = parameters(scene), math.ceil(scene.duration / step * (1 - 1e-12))
    nothing = np.zeros(1)
    _march(par, step, nothing, nothing, np.empty((0, 6)))  # compiled before the clock starts
    started = time.process_time()
    times = step * np.arange(count + 1)
    ground = np.zeros(count + 1) if scene.motion is None else scene.motion.acceleration(times)
    gravity = np.full(count + 1, par.g) + vertical_acceleration(scene.motion, times)
    rows = np.empty((count + 1 if history else 0, 6))
    marched = _march(par, step, ground, gravity, rows)
    response = _response(scene, step, marched, time.process_time() - started)
    if history:
        taken = response.steps
        kept = History(*[*rows[: taken + 1].T, ground[: taken + 1]])
        response = replace(response, history=kept)
    return replace(response, decided=is_decided(scene, response))


def _response(scene, step, marched, seconds):
    """The `Response` of what `_march` returns, without history."""
    taken, over, impacts, uplifts, rests, (unstable, fall), extremes, end = marched
    peak_tilt, peak_x, peak_acceleration, friction, normal = extremes
    rocked = scene.start.tilt != 0 or scene.start.tilt_rate != 0 or len(uplifts) > 0
    return Response(
        engine="time-stepping",
        variant="semi-implicit Euler",
        outcome="overturns" if over else "rocks" if rocked else "stands",
        overturning_time=taken * step if over else None,
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
        end=State(taken * step, *end),
        cpu_seconds=seconds,
        steps=taken,
        settings={"step": step},
        versions={"python": platform.python_version(), "numpy": np.__version__, "numba": numba.__version__},
        scene=scene.name,
    )


@inner
def _rocking(par, body, a, g, force):
    """(phi'', absolute acceleration of the base, forces at the corner) while the block rocks, (3)-(6)."""
    (side, tilt, rate), m, M, J = body, par.m, par.M, par.J
    c, n = par.R * math.cos(side * par.gamma - tilt), par.R * math.sin(side * par.gamma - tilt)
    spin, absolute = -m * (c * a + g * n) / J, a
    if par.on_base:
        push, moment = -m * n * rate * rate - force, -m * g * n
        determinant = M * J - (m * c) ** 2
        spin, absolute = (M * moment - m * c * push) / determinant, (J * push - m * c * moment) / determinant
    return spin, absolute, m * (absolute + c * spin + n * rate * rate), m * (g + n * spin - c * rate * rate)


@njit(cache=True, nogil=True)
def _march(par, h, ground, gravity, rows):
    """All steps, under a_g and g + a_v [m/s2] at each.

    Returns (steps taken, overturned?, impacts, uplifts, rests, (unstable time or -1, fall time), extremes, end).
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
    return taken, over, impacts, uplifts, rests, (unstable, held[4]), extremes, end
