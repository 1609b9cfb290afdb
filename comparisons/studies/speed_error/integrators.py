"""Problems A and B, a block alone, solved by the kernel and by scipy's `solve_ivp`.

The references have 30 digits. Both are set up by someone who wants them fast: there are no classes, the right-hand side
uses floats instead of arrays, the set of events is the smallest possible, and the first step follows from the length of
the next swing. The simple form to learn from is `analytic.checks.twin`.
"""

import functools
import itertools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analytic import Response, Scene, State
from analytic.checks.twin import Event
from analytic.kernel import layout
from analytic.kernel import march as kernel
from analytic.rocking import RockingModel
from analytic.scene import problem_a, problem_b
from analytic.solver import REST_RATE, ground, options, parameters

from ...execution.cases import Case

SOLVER = f"{__name__}:prepared"
SHORT_HOP = 0.3  # in units of 1/omega_r: below it, the first step is the whole hop


@dataclass(frozen=True)
class Problem:
    """One problem: phi'' = -p2 (sin(s gamma - phi) + a sin(frequency t) cos(s gamma - phi)), where s = ±1 is the side.

    It moves from `begin` [s] on, with `tilt` [rad] and no velocity; at an impact the velocity is multiplied by
    `restitution`, and the block rests when less than `rest_rate` [rad/s] is left. a = 0 without a pulse, or after
    `pulse_end` [s].

    reference: |tilt| [rad] at `horizon` [s]. impacts: how many there are to the scene's duration.
    """

    scene: Scene
    horizon: float
    rest_rate: float
    impacts: int
    reference: float
    p2: float
    gamma: float
    restitution: float
    a: float
    frequency: float
    begin: float
    tilt: float
    side: float
    pulse_end: float

    @property
    def stops(self) -> list[float]:
        """Return the times [s] at which an integrator has to stop: the pulse's end, the horizon, the end."""
        return sorted({self.pulse_end, self.horizon, self.scene.duration} - {0.0})

    def error(self, tilt: float) -> float:
        """Return the error of a tilt [rad] at the horizon, over the slenderness [-]."""
        return abs(abs(tilt) - self.reference) / self.gamma


def _problem(scene: Scene, rest: float, **known: Any) -> Problem:
    """Build a problem from a scene.

    rest: rest_rate over omega_r. known: what the scene does not say.
    """
    model, omega, pulse = RockingModel.of(scene), scene.rocking_frequency, scene.motion
    if pulse is None:
        a, frequency, pulse_end, begin, side = 0.0, 0.0, 0.0, 0.0, math.copysign(1.0, scene.start.tilt)
    else:  # the block lifts to the left when the pulse first reaches g tan(gamma)
        a, frequency, pulse_end, side = pulse.amplitude / scene.gravity, pulse.frequency, pulse.end, -1.0
        begin = math.asin(1 / (pulse.amplitude / (scene.gravity * math.tan(scene.block.slenderness)))) / frequency
    return Problem(
        scene=scene, rest_rate=rest * omega, p2=omega**2, gamma=model.gamma, restitution=model.restitution, a=a,
        frequency=frequency, begin=begin, tilt=scene.start.tilt, side=side, pulse_end=pulse_end, **known,
    )  # fmt: skip


A = dict(horizon=7.0, impacts=10, reference=0.01588089793859602683756374)
B = dict(horizon=6.0, impacts=81, reference=0.01186179747282689895957273)
SOLVED = _problem(problem_a(duration=7.0), REST_RATE, **A), _problem(problem_b(duration=9.2), 1e-4, **B)
PROBLEMS = {problem.scene.name: problem for problem in SOLVED}


def kernel_run(problem: Problem, tolerance: float) -> Callable[[], tuple[float, int]]:
    """Return a function that runs `problem` without history or ledger and returns (tilt at the horizon, impacts)."""
    scene = problem.scene
    inside = problem.horizon < scene.duration
    rest = problem.rest_rate / scene.rocking_frequency
    chosen = options(tolerance, rest_rate=rest, record=False, output_step=problem.horizon if inside else 0.0)
    arguments = parameters(scene), ground(scene.motion), chosen

    def run():
        totals, *_, history = kernel.run(*arguments)
        return float(history[1, 1] if inside else totals[layout.END_TILT]), int(totals[layout.IMPACTS])

    return run


def scipy_run(problem: Problem, rtol: float, method: str) -> Callable[[], tuple[float, int]]:
    """Return a function that runs `problem` by `solve_ivp` and returns (tilt at the horizon, impacts).

    It integrates flight by flight.

    Absolute tolerances are `rtol` of gamma and of gamma omega_r.
    """
    p2, gamma, a, frequency = problem.p2, problem.gamma, problem.a, problem.frequency
    omega = math.sqrt(p2)
    atol = rtol * np.array([gamma, gamma * omega])
    sin, cos = math.sin, math.cos

    def fly(begin, stop, tilt, rate, side, pushed):
        def free(t, y):
            phi, w = y.tolist()
            return w, -p2 * sin(side * gamma - phi)

        def forced(t, y):
            phi, w = y.tolist()
            angle = side * gamma - phi
            return w, -p2 * (sin(angle) + a * sin(frequency * t) * cos(angle))

        def impact(t, y):  # the root at take-off is divided out
            return side * y[0] / (t - begin) if t > begin else 1.0

        step = {}
        if tilt == 0.0:
            push = a * sin(frequency * begin) * cos(gamma) if pushed else 0.0
            hop = 2 * abs(rate) / (p2 * (sin(gamma) + side * push)) if rate else 0.0
            if 0 < hop * omega < SHORT_HOP:
                step["first_step"] = min(1.1 * hop, stop - begin)
        derivative, event = forced if pushed else free, Event(impact)
        solution = solve_ivp(
            derivative, (begin, stop), (tilt, rate), method, events=event, rtol=rtol, atol=atol, **step
        )
        if solution.status < 0:
            raise RuntimeError(solution.message)
        return float(solution.t[-1]), *solution.y[:, -1].tolist(), solution.status == 1

    def run():
        t, tilt, rate, side = problem.begin, problem.tilt, 0.0, problem.side
        impacts, end_tilt = 0, math.nan
        for stop in problem.stops:
            pushed = stop <= problem.pulse_end
            while t < stop:
                t, tilt, rate, hit = fly(t, stop, tilt, rate, side, pushed)
                if hit:
                    impacts, tilt, rate, side = impacts + 1, 0.0, problem.restitution * rate, -side
                    if abs(rate) < problem.rest_rate:
                        return end_tilt, impacts
            if stop == problem.horizon:
                end_tilt = tilt
        return end_tilt, impacts

    return run


METHODS = ("RK45", "DOP853", "LSODA", "Radau")
INTEGRATORS: dict[tuple[str, str], Callable[..., Any]] = {
    ("analytic", "kernel"): kernel_run,
    **{("scipy", method): functools.partial(scipy_run, method=method) for method in METHODS},
}
# relative tolerances of a full and of a quick study
TOLERANCES = {
    ("analytic", "kernel"): (
        (1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 1e-16),
        (1e-8, 1e-10, 1e-12, 1e-14, 1e-16),
    ),
    ("scipy", "RK45"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12), (1e-8, 1e-10)),
    ("scipy", "DOP853"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13), (1e-10, 1e-11, 1e-12)),
    ("scipy", "LSODA"): ((1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12), (1e-9, 1e-11)),
    ("scipy", "Radau"): ((1e-6, 1e-8, 1e-9), (1e-6,)),
}


@functools.lru_cache(maxsize=256)
def run_of(problem: str, engine: str, variant: str, tolerance: float) -> Callable[[], tuple[float, int]]:
    """Return a function without arguments that solves a problem by an integrator."""
    return INTEGRATORS[engine, variant](PROBLEMS[problem], tolerance)


def prepared(scene: Scene, *, engine: str, variant: str, tolerance: float, **settings: Any) -> Response:
    """Make the first run, which loads and compiles what the timed ones need; nothing is measured in it."""
    run_of(scene.name, engine, variant, tolerance)()
    identity = dict(engine=engine, variant=variant, outcome="rocks", settings=settings, versions={})
    return Response.unmeasured(**identity, end=State(scene.duration, *[math.nan] * 5))


def timed(case: Case, least: float) -> dict[str, Any]:
    """Return what the runs of a problem found, and their CPU time.

    It is the mean of the last runs, as many as take `least` [s] in all.
    """
    problem = PROBLEMS[case.scene.name]
    run = run_of(problem.scene.name, *(case.settings[name] for name in ("engine", "variant", "tolerance")))
    for repeats in (2**doubled for doubled in itertools.count()):
        begin = time.process_time()
        for _ in range(repeats):
            tilt, impacts = run()
        if (spent := time.process_time() - begin) >= least:
            break
    errors = {"lost": problem.impacts - impacts, "horizon_tilt": problem.error(tilt)}
    values = {"outcome": "rocks", "end": {"time": case.scene.duration}, "steps": 0, "settings": case.settings}
    return {**values, "boundary_shifts": None, "errors": errors, "cost": {"cpu_seconds": spent / repeats}}
