"""Lesson 7: speed against error."""

import functools
import math
from itertools import groupby, takewhile
from operator import attrgetter

from analytic import simulate

from ...plotting.parts import Table
from ...plotting.plots import marker, style
from ...schemas.columns import number
from ..lesson import (
    INK,
    OTHER,
    OWN,
    OWN_STEPS,
    SOFT,
    THIRD,
    Control,
    EngineRun,
    Equation,
    Exercise,
    Lesson,
    View,
    canvas,
    engine_runs,
    legend,
    own_runs,
    timed,
)

TARGET = 0.01  # required error
MODEL = "event-driven"
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-9)  # of the event-driven model
FLOOR = 1e-12  # smaller errors are drawn here


@functools.cache
def model_runs() -> tuple[EngineRun, ...]:
    """The event-driven model at several tolerances."""
    return timed(MODEL, "tolerance", TOLERANCES, simulate)


def levels_by_variant(runs: tuple[EngineRun, ...]) -> dict[str, list[EngineRun]]:
    """Return {solver: its runs}, from coarse to fine."""
    return {name: list(levels) for name, levels in groupby(runs, attrgetter("name"))}


def trusted(runs: tuple[EngineRun, ...], target: float) -> dict[str, EngineRun]:
    """Return the cheapest run of each solver with an error below the target at its level and at every finer one."""

    passing = {
        name: list(takewhile(lambda run: run.error < target, reversed(levels)))
        for name, levels in levels_by_variant(runs).items()
    }
    return {name: min(those, key=lambda run: run.cpu) for name, those in passing.items() if those}


def everything() -> tuple[EngineRun, ...]:
    return (*model_runs(), *own_runs(), *engine_runs())


def view(step: float) -> View:
    """Error against CPU time; step [ms] of the fixed-step integrator."""
    figure, axis = canvas()
    for name, levels in levels_by_variant(everything()).items():
        solver, first = levels[0].solver, levels[0].kind == "defaults"
        colour = {OWN: THIRD, MODEL: INK}.get(solver) or style(solver)["color"]
        known = [run for run in levels if not math.isnan(run.error)]
        axis.loglog(
            [max(100 * run.error, 100 * FLOOR) for run in known],
            [max(1e3 * run.cpu, 1e-3) for run in known],
            marker=marker(solver),
            linestyle=":" if first else "-",
            color=colour,
            linewidth=1.2,
            markersize=5,
            markerfacecolor="none" if first else colour,
            label=name,
        )
    axis.axvline(100 * TARGET, 0, 0.74, color=SOFT, linewidth=1, linestyle=(0, (4, 4)))  # up to the legend
    here = next(run for run in own_runs() if abs(1e3 * run.value - step) < 1e-9)
    axis.loglog(100 * here.error, 1e3 * here.cpu, "o", color=OTHER, markersize=10, zorder=5)
    axis.set(xlabel="error of the rate after the first impact [%]", ylabel="CPU time [ms]", xlim=(60, 50 * 100 * FLOOR))
    figure.set_figheight(6.4)
    legend(axis, loc="upper left", fontsize=9, ncols=2)
    axis.set_ylim(axis.get_ylim()[0], axis.get_ylim()[1] * 200)
    best = trusted(everything(), TARGET)
    cheapest = min(best.values(), key=lambda run: run.cpu)
    return View(
        figure,
        {
            "error at this step": (100 * here.error, "%"),
            "CPU time": (1e3 * here.cpu, "ms"),
            "cheapest below 1 %": (f"{cheapest.name}, {cheapest.parameter} {cheapest.value:g}", ""),
        },
        f"Fixed steps of {step:g} ms err by {100 * here.error:.3f} %.",
    )


def table() -> Table:
    """The cheapest level of each solver below 1 % with all finer ones."""
    best = trusted(everything(), TARGET)
    rows = [
        [run.name, f"{run.parameter} = {run.value:g}", number(100 * run.error, 2), number(1e3 * run.cpu, 2)]
        for run in sorted(best.values(), key=lambda run: run.cpu)
    ]
    return Table(
        "The cheapest level of each solver with an error below 1 % at it and at all finer levels (this machine)",
        ("solver", "level", "error [%]", "CPU time [ms]"),
        rows,
    )


def coarsest_step() -> float:
    """Largest step of the fixed-step integrator [ms] with an error below 1 % at it and at all smaller steps."""
    return 1e3 * max(run.value for run in takewhile(lambda run: run.error < TARGET, reversed(own_runs())))


def event_driven_share() -> float:
    """CPU time of a run with fixed steps and an error of 1 %, over that of the event-driven model."""
    return trusted(own_runs(), TARGET)[OWN].cpu / min(run.cpu for run in model_runs())


def passing_solvers() -> float:
    """Number of solvers, each variant counted, that reach 1 % and stay below it at finer levels."""
    return float(len(trusted(everything(), TARGET)))


def code() -> object:
    from comparisons.lessons.lesson import engine_runs, own_runs
    from comparisons.lessons.topics.cost import TARGET, model_runs, trusted

    best = trusted((*model_runs(), *own_runs(), *engine_runs()), TARGET)
    answer = len(best)
    return {name: (f"{run.parameter} = {run.value:g}", f"{1e3 * run.cpu:.3g} ms") for name, run in best.items()}


LESSON = Lesson(
    number=7,
    name="cost",
    title="Speed against error",
    question="How accurate must it be, and what does that cost? Find the level at which an engine’s error is below "
    "1 %, then the cheapest solver.",
    aims=(
        "draw and read a work-precision diagram",
        "choose a level by a rule that excludes chance",
        "compare solvers at equal error, not at equal step",
    ),
    needs="lesson 5",
    minutes=10,
    symbols=(r"\Delta t", "p"),
    equations=(
        Equation(
            r"\text{cost} \propto \frac{1}{\Delta t}, \quad \text{error} \propto \Delta t^p",
            "",
            "Equal steps: where $p$ is 1, as with impacts at the ends of steps, a tenth of the error costs ten times "
            "the time.",
        ),
    ),
    controls=(Control("step of the fixed-step integrator", tuple(1e3 * step for step in OWN_STEPS), 1.0, "ms", 1),),
    view=view,
    guess="Which is the cheapest solver below 1 %: one with fixed steps of 1 ms, or one that finds each impact? How "
    "many times cheaper?",
    look="Right and down is better. Change the step and follow its line. Dotted lines: defaults.",
    wrong=(
        "*Equal steps are no fair comparison.* One engine needs ten times the steps of another for the same error.",
        "*One point below the target proves nothing.* Take the coarsest level below the target whose *finer ones are "
        "below it, too*.",
        "*Some lines do not reach the target.* Their error is that of another contact law, at any step.",
        "*Times belong to this machine.* Ratios carry over better; measure again on yours (`rocking study "
        "speed-error`).",
    ),
    exercises=(
        Exercise(
            "What is the largest of the fixed steps with an error below 1 % that all finer steps meet too?",
            coarsest_step,
            "ms",
            "Start from the finest and stop at the first above 1 %.",
            2,
        ),
        Exercise(
            "How many runs of the event-driven model does one run with fixed steps at 1 % cost?",
            event_driven_share,
            "runs",
            "The ratio of the two CPU times, each the least of several runs.",
            2,
        ),
        Exercise(
            "How many of the solvers here, variants counted separately, reach 1 % and stay below it?",
            passing_solvers,
            "",
            "Count the rows of the table.",
            0,
        ),
    ),
    code=code,
    playground="motion=release&tilt=0.6&engine=straddling&step=5",
    table=table,
)
