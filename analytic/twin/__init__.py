"""The second implementation: the equations of rocking.py solved by scipy's `solve_ivp` with events; slow and simple.

It is independent of the compiled kernel, which it verifies, and is what a careful user would write. One call of
`solve_ivp` covers one interval of smooth motion. It ends at the next corner of the ground motion, at an impact, an
uplift, a reversal of the base (where the bearing's history is committed), a corner of the bearing law, or at
overturning.
"""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..budget import most_steps, too_long
from ..errors import SettingError
from ..response import Response
from ..termination import is_decided, until_decided
from .run import Run

if TYPE_CHECKING:
    from ..scene import Scene

METHODS = ("DOP853", "RK45", "LSODA", "Radau")


def simulate_twin(
    scene: Scene,
    *,
    method: str = "DOP853",
    rtol: float = 1e-10,
    atol: float | None = None,
    history: bool = True,
    energy: bool = True,
    max_step: float | None = None,
    rest_rate: float = 1e-8,
) -> Response:
    """Simulate a scene with scipy.

    Parameters
    ----------
    scene : Scene
    method : str
        One of `METHODS`.
    rtol : float
        Relative tolerance of `solve_ivp`.
    atol : float, optional
        Absolute tolerance as a share of each state's scale (slenderness, R times slenderness, omega_r times
        these, f0); default rtol.
    history, energy : bool
        Whether to keep the states at every step, and to integrate the energy ledger with them.
    max_step : float, optional
        Longest step [s]; default the least of half a sampling interval and, on bearings, half of 1/omega at ka.
    rest_rate : float
        Impacts count as accumulated if |phi'+| < rest_rate omega_r and the contact force is compressive; the block then
        rests.

    Returns
    -------
    Response
        engine "twin". Extremes of forces and accelerations are taken at the steps; peaks of tilt and displacement are
        located as events.

    Raises
    ------
    SettingError
        The method is unknown, a tolerance is not positive, or `max_step` too short for the run.
    SceneError
        Stiff bearings or a long run need more steps than `budget` allows; the message names the part.
    """
    settings: dict[str, Any] = {
        "method": method,
        "rtol": rtol,
        "atol": atol,
        "max_step": max_step,
        "rest_rate": rest_rate,
    }
    _check(settings)
    if scene.duration is None:
        return until_decided(functools.partial(simulate_twin, history=history, energy=energy, **settings), scene)
    run = Run(scene, {**settings, "atol": rtol if atol is None else atol}, history, energy)
    _check_cost(run, max_step)
    run.model.bearing.hysteretic(0.0, 1e-6)  # compiled before the time is taken
    started = time.process_time()
    failure = run.go()
    response = run.response(time.process_time() - started, failure)
    return replace(response, decided=is_decided(scene, response))


def _check_cost(run: Run, max_step: float | None) -> None:
    """Refuse a run that needs more steps of the largest length than the model itself may take."""
    end, most = run.scene.end, most_steps(run.scene)
    if end <= most * run.max_step:
        return
    if max_step is not None:
        raise SettingError(f"max_step = {max_step!r}: {end / max_step:.3g} steps; give at least {end / most:.3g} s")
    raise too_long(run.scene, f"{end / run.max_step:.3g} steps of the second implementation")


def _check(settings: Mapping[str, Any]) -> None:
    """Refuse a method that is unknown, or a number that is not positive."""
    if settings["method"] not in METHODS:
        raise SettingError(f"method {settings['method']!r} is unknown: choose one of {', '.join(METHODS)}")
    for name, value in settings.items():
        if name != "method" and value is not None and not (value > 0 and math.isfinite(value)):
            raise SettingError(f"{name} = {value!r} is not positive: give a finite value above 0")
