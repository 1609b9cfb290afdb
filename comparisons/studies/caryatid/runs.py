"""The paper's simulations in every solver: Figs 4(b) and 6, points of Figs 5(a) and 5(b)."""

from collections.abc import Generator, Sequence
from itertools import product
from typing import Any

import numpy as np

from analytic import Base, Bearings, Response, Scene, load_scene, rocking_spectrum
from analytic.design import BearingProperties
from analytic.linear_oscillator import displacement_spectrum
from analytic.motion import Motion

from ...running.cases import Case
from ...running.plan import Batch
from ...running.sweep import Row

FREE, ISOLATED = "free-standing", "isolated"
SHIPPED = {FREE: "caryatid-rigid", ISOLATED: "caryatid-isolated"}
DAMPING_RATIOS = (0.05, 0.10, 0.15, 0.20, 0.30)  # Fig. 5(b); the paper's own are not at hand
OSCILLATOR_DAMPING = (0.05, 0.30)  # of those run in the engines
# A block this stocky stays down on its oscillator: it lifts at 0.84 g.
STOCKY = 0.7  # rad
TIME_LIMIT = 120.0  # s
HISTORY_STEP = 0.01  # s, at which histories are kept


def caryatid(name: str, motion: Motion | None) -> Scene:
    """The free-standing or the isolated Caryatid under `motion`."""
    return load_scene(SHIPPED[name]).with_(motion=motion, duration=None)


def slender_block(motion: Motion, period: float, slenderness: float) -> Scene:
    """A block on rigid ground whose rocking period T_r is `period` [s], as in Fig. 5(a)."""
    scene = caryatid(FREE, motion)
    radius = 3 * scene.gravity * (period / (2 * np.pi)) ** 2 / 4  # (1) with J_O = 4/3 m R^2
    return scene.with_(block={"radius": float(radius), "slenderness": slenderness})


def oscillator(motion: Motion, period: float, damping: float) -> Scene:
    """A linear oscillator as a scene: a block that cannot lift, on one linear bearing with a damper."""
    scene = caryatid(ISOLATED, motion)
    omega = 2 * np.pi / period
    bearing = Bearings(
        law="linear",
        count=1,
        ka=float(scene.total_mass * omega**2),
        damping=float(2 * damping * omega * scene.total_mass),
    )
    return Scene(
        block=scene.block.model_copy(update={"slenderness": STOCKY}),
        base=Base(mass=scene.base.mass),
        bearings=bearing,
        motion=motion,
        gravity=scene.gravity,
    )


def measure(case: Case, response: Response) -> dict[str, Any]:
    """The scalars that came out, and of Figs 4(b) and 6 tilt and displacement at multiples of `HISTORY_STEP`."""
    values = response.to_json()
    found = {name: value for name, value in values.items() if name not in ("impacts", "uplifts", "rests", "energy")}
    if case.tag["part"] == "run" and (history := response.history):
        time = np.arange(0.0, history.time[-1], HISTORY_STEP)
        columns = {
            name: np.interp(time, history.time, getattr(history, name)) for name in ("tilt", "base_displacement")
        }
        found["history"] = {name: column.tolist() for name, column in {"time": time, **columns}.items()}
    return found


def simulations(
    motion: Motion, engines: Sequence[str], quick: bool = False
) -> Generator[Batch, list[Row], tuple[list[dict[str, Any]], dict[str, np.ndarray]]]:
    """Plan of all runs; returns their rows, and the histories of Figs 4(b) and 6 as arrays."""
    solvers = ("analytic", *engines)
    figures = [
        Case(caryatid(name, motion), solver, tag={"part": "run", "scene": name})
        for name in SHIPPED
        for solver in solvers
    ]
    rows, histories = [], {}
    for row in (yield Batch([*figures, *_points(motion, solvers, quick)], measure, "Figs 4 to 6", TIME_LIMIT)):
        values, engine = dict(row.values), row.case.solver
        if row.case.scene.base is None:  # the ground's own peak: a value of the motion
            values.pop("peak_base_acceleration", None)
        for column, numbers in values.pop("history", {}).items():
            histories[f"{row.case.tag['scene']}/{engine}/{column}"] = np.array(numbers, dtype=np.float32)
        default = {"engine": engine, "variant": row.case.variant}  # of a run that failed
        rows.append({**default, **values, **row.case.tag, "failure": row.failure, **row.cost})
    return rows, histories


def _points(motion, solvers, quick):
    """Single blocks and oscillators of Fig. 5, in every solver."""
    free = caryatid(FREE, motion)
    slenderness, own = free.block.slenderness, 2 * np.pi / free.rocking_frequency
    blocks = (own, 5.0) if quick else (1.5, own, 3.0, 3.5, 4.5, 5.0, 6.0, 7.0)
    oscillators = (2.0,) if quick else (1.0, 2.0, 3.0)
    without = {"history": False}
    for solver, period in product(solvers, blocks):
        tag = {"part": "rocking spectrum", "period": float(period)}
        yield Case(slender_block(motion, period, slenderness), solver, settings=without, tag=tag)
    for solver, period, damping in product(solvers, oscillators, OSCILLATOR_DAMPING):
        tag = {"part": "displacement spectrum", "period": period, "damping": damping}
        yield Case(oscillator(motion, period, damping), solver, settings=without, tag=tag)


def spectra(motion: Motion, quick: bool = False) -> dict[str, np.ndarray]:
    """Arrays of Fig. 5(a), max tilt over slenderness against T_r, and Fig. 5(b), max displacement against T_bi."""
    slenderness = caryatid(FREE, motion).block.slenderness
    periods = np.linspace(0.5, 8.0, 151 if quick else 751)
    tilts = rocking_spectrum(motion, periods, slenderness)
    isolation = np.linspace(0.1, 5.0, 99 if quick else 246)
    return {
        "rocking/period": periods,
        "rocking/tilt": np.where(tilts.overturns, np.nan, tilts.peak_tilt / slenderness),
        "rocking/overturns": tilts.overturns,
        "displacement/period": isolation,
        "displacement/damping": np.array(DAMPING_RATIOS),
        "displacement/peak": displacement_spectrum(motion, isolation, DAMPING_RATIOS),
    }


def equivalent_oscillators(motion: Motion, properties: BearingProperties, nonlinear: float) -> list[dict[str, Any]]:
    """What a linear oscillator at T_bi predicts, with the damping in either definition, beside the bearings' own."""
    return [
        {
            "part": "equivalent",
            "definition": name,
            "damping": damping,
            "period": properties.period,
            "displacement": float(displacement_spectrum(motion, [properties.period], [damping])[0, 0]),
            "nonlinear": nonlinear,
        }
        for name, damping in (
            ("W_D/(2π E_s)", properties.damping_paper),
            ("W_D/(4π E_s)", properties.damping_equivalent),
        )
    ]
