"""Lesson 8: how to check a simulation."""

import functools
import math

import numpy as np

from analytic import Response, Scene, Start, simulate
from analytic.checks.closed_form import free_rocking
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.rocking import RockingModel, base_jump_length, base_jump_length_as_printed, restitution
from analytic.scene import BASE, caryatid_block

from ...execution.results import RESULTS
from ...plotting.parts import where
from ...schemas.columns import number, power_of_ten
from ...studies.rows import read_study
from ..lesson import MODEL, SOFT, Control, Equation, Exercise, Lesson, View, canvas

SLENDERNESS, START, DURATION = 0.28, 0.6, 2.5  # rad, tilt over slenderness, s
TESTS, OVERTURNED = 490, 187  # tests of a granite boulder on a shake table, see the study
SOLVERS = ("event-driven", "fixed steps")
# Step [s] of level 0. The second impact is at another place in each halved step; with 0.02 s three halvings in a row
# would end their steps at the same time beside it.
COARSEST = 0.0165
LEVELS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
FLOOR = 1e-17  # zero is drawn here


def scene(side: float = 1.0) -> Scene:
    """The Caryatid released on rigid ground, to one side or the other."""
    start = Start(tilt=side * START * SLENDERNESS)
    return Scene(block=caryatid_block(SLENDERNESS), start=start, duration=DURATION)


def run(solver: str, level: float, side: float = 1.0) -> Response:
    """Run the scene; level: tolerance 10^(-2 level) of the event-driven solver, step `COARSEST` / 2^level if fixed."""
    if solver == SOLVERS[0]:
        return simulate(scene(side), tolerance=10.0 ** (-2 * level))
    return simulate_time_stepping(scene(side), step=COARSEST / 2**level)


@functools.cache
def second() -> float:
    """Return the time of the second impact [s] in the second implementation: the same equations, scipy’s integrator."""
    return simulate_twin(scene(), history=False, energy=False).impacts[1].time


def energy_defect(response: Response) -> float:
    """Defect of the energy balance: |final energy + loss in impacts - initial energy| / initial energy."""
    model, end, start = RockingModel.of(scene()), response.end, scene().start

    def energy(tilt, rate):
        side = float(np.sign(tilt or rate))
        return model.kinetic_energy(side, tilt, rate, 0.0) + model.potential_energy(side, tilt, 0.0)

    lost = sum(0.5 * model.J * (hit.rate_before**2 - hit.rate_after**2) for hit in response.impacts)
    first = energy(start.tilt, start.tilt_rate)
    return abs(energy(end.tilt, end.tilt_rate) + lost - first) / first


@functools.cache
def checks(solver: str, level: float) -> dict[str, float]:
    """Relative defect by check."""
    response, finer, mirrored = run(solver, level), run(solver, level + 1), run(solver, level, -1.0)
    block = scene()
    known = free_rocking(block.rocking_frequency, SLENDERNESS, restitution(block), START * SLENDERNESS, 2).times[1]
    time = response.impacts[1].time
    return {
        "closed form": abs(time / known - 1),
        "finer level": abs(time / finer.impacts[1].time - 1),
        "energy": energy_defect(response),
        "mirror": abs(response.end.tilt + mirrored.end.tilt) / SLENDERNESS,
        "second program": abs(time / second() - 1),
    }


def view(solver: str, level: float) -> View:
    """The five defects as bars."""
    defects = checks(solver, level)
    figure, axis = canvas()
    figure.subplots_adjust(left=0.29)
    names = list(defects)[::-1]
    sizes = [max(defects[name], FLOOR) for name in names]
    axis.barh(names, sizes, left=0, color=MODEL, height=0.55)
    for place, (name, size) in enumerate(zip(names, sizes, strict=True)):
        axis.text(size * 2, place, "exact" if defects[name] == 0 else number(size, 1), va="center", color=SOFT)
    axis.set(xscale="log", xlim=(FLOOR / 3, 30), xlabel="relative defect")
    axis.grid(axis="y", visible=False)
    fixed = f"step {number(1e3 * COARSEST / 2**level)} ms"
    setting = f"tolerance {power_of_ten(10.0 ** (-2 * level))}" if solver == SOLVERS[0] else fixed
    return View(
        figure,
        {"setting": (setting, ""), **{name: (value, "") for name, value in defects.items()}},
        f"Five checks of {solver}, {setting}: the largest defect is {number(max(defects.values()), 2)}.",
    )


def misprint_factor() -> float:
    """Excess of e_x as printed over the corrected one, in per cent; a trajectory would have to show it."""
    on_base = Scene(block=caryatid_block(SLENDERNESS), base=BASE)
    return 100 * (base_jump_length_as_printed(on_base) / base_jump_length(on_base) - 1)


def observed_order() -> float:
    """Order of convergence of the fixed steps, from halvings of the step and the defect of the closed form."""
    block, steps = scene(), 0.02 / 2 ** np.arange(3.0, 9.0)
    known = free_rocking(block.rocking_frequency, SLENDERNESS, restitution(block), START * SLENDERNESS, 1)
    rate = known.rates_after[0]
    # the envelope over neighbouring steps, as the phase of the impact in its step is random
    errors = [
        max(
            abs(
                abs(simulate_time_stepping(scene(), step=step * (1 + 0.01 * k), history=False).impacts[0].rate_after)
                / rate
                - 1
            )
            for k in range(12)
        )
        for step in steps
    ]
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def mirror_defect() -> float:
    """Defect of mirror symmetry: |tilt + tilt of the mirrored run| at the end of the event-driven run [rad]."""
    return abs(run(SOLVERS[0], 6.0).end.tilt + run(SOLVERS[0], 6.0, -1.0).end.tilt)


def skill() -> float:
    """Brier score of a forecast by the share of overturnings alone, over the model's score on the shake table.

    It is nan if the study is not stored.
    """
    path = RESULTS / "shake-table"
    rows = where(read_study(path).rows, part="fit", change="as it is") if path.exists() else ()
    share = OVERTURNED / TESTS
    return share * (1 - share) / rows[0]["brier"] if rows else math.nan


def code() -> float:
    from analytic import Base, Block, Scene
    from analytic.rocking import base_jump_length_as_printed, restitution

    on_base = Scene(block=Block(mass=3172.05, radius=1.0884, slenderness=0.28), base=Base(mass=212.0))
    block, rate = on_base.block, -0.8  # rad/s
    before = block.mass * block.half_height * rate
    kept = block.mass * block.half_height * restitution(on_base) * rate
    pushed = -on_base.total_mass * base_jump_length_as_printed(on_base) * rate
    answer = 100 * abs((kept + pushed) / before - 1)  # %
    return answer


LESSON = Lesson(
    number=8,
    name="checks",
    title="How to check a simulation",
    question="The curve looks right. How would you notice if it were not?",
    aims=(
        "name five checks, and the errors that each of them detects",
        "measure an order of convergence",
        "find a misprint by a law that it violates",
        "tell verification (are the equations solved right?) from validation (are they the right equations?)",
    ),
    needs="lessons 2 and 5",
    minutes=10,
    symbols=(r"\gamma", r"\phi_0", r"\phi_1", r"e_{\phi}", "e_x", "R", "m", r"\tilde{m}", "J_O"),
    equations=(
        Equation(
            r"\cos(\gamma - |\phi_1|) - \cos \gamma = e_{\phi}^2 \left( \cos(\gamma - |\phi_0|) - \cos \gamma \right)",
            "",
            "Closed form: the peaks of free rocking, from energy and (7).",
        ),
        Equation(
            r"e_x = \frac{2 R^3 \sin^2 \gamma \cos \gamma \, m \tilde{m}}{R^2 \cos^2 \gamma \, m \tilde{m} - J_O}",
            "8",
            "Corrected, a length; the paper prints $R^4$ and $\\cos^2$ in the numerator, a length squared.",
        ),
    ),
    controls=(Control("solver", SOLVERS, "fixed steps"), Control("accuracy", LEVELS, 2.0, "", 0)),
    view=view,
    guess="Five checks of one run: closed form, finer level, energy, mirror image, second program. Which of them "
    "does not detect a time step that is too large?",
    look="Choose a solver, then refine it. Bars are relative errors, on a logarithmic axis.",
    wrong=(
        "*Each check misses some errors.* Energy does not show a shift in time. The mirror image shows only errors "
        "that differ between the two sides. A second program shares the errors of its equations.",
        "*A finer level checks the solver, not the model.* It converges to wrong equations, too.",
        "*None of the five is a validation.* A model can be solved to ten digits and be wrong about a real block. Only "
        "tests tell, those to which nothing was fitted, and beside a simpler rule that may do as well.",
        "*Trajectories do not show small misprints.* (8) as printed changes the base’s jump by a few per cent. No plot "
        "shows that, but the momentum does.",
        "*A check that cannot fail is no check.* Introduce an error into the model, and see which check fails.",
    ),
    exercises=(
        Exercise(
            "How much momentum does (8) as printed create, in per cent of that before the impact?",
            code,
            "%",
            "$m h \\dot{\\phi} + (m + m_b) \\dot{x}$ before and after.",
        ),
        Exercise(
            "By how many per cent is its length too long?",
            misprint_factor,
            "%",
            "The extra factor is $R \\cos \\gamma$ in metres.",
        ),
        Exercise(
            "What is the order of the fixed steps, measured against the closed form?",
            observed_order,
            "",
            "Halve the step six times, take the worst of neighbouring steps, fit a line.",
            2,
        ),
        Exercise(
            "By how much does the event-driven run to the left differ from the mirror image of that to the right?",
            mirror_defect,
            "rad",
            "Every operation is the same but for signs, which floating-point arithmetic keeps.",
        ),
        Exercise(
            f"Validation: of {TESTS} tests on a shake table {OVERTURNED} overturned a granite boulder (`rocking study "
            "shake-table`). The mean square error of a probability is its Brier score. How many times larger than the "
            "model’s is that of a forecast that always gives the share of tests that overturned?",
            skill,
            "",
            "A share $p$ has a Brier score of $p (1 - p)$. The model’s is stored, on records to which it was not "
            "fitted. It is far from 0: whatever the solver’s digits, that is how well a planar block describes a "
            "boulder.",
            2,
        ),
    ),
    code=code,
    playground="motion=release&tilt=0.6&base=true",
)
