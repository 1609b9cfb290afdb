"""Lesson 5: an impact in an engine with time steps."""

import functools
import math

import numpy as np
from matplotlib.patches import Rectangle

from analytic import simulate
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.scene import RADIUS
from engines import ENGINES

from ...execution.results import RESULTS
from ...metrics.agreement import RIGID
from ...plotting.parts import Table, where
from ...plotting.plots import marker
from ...schemas.columns import number
from ...studies.rows import read_study
from ..lesson import (
    MODEL,
    OTHER,
    SCENE,
    SLENDERNESS,
    SOFT,
    STONE,
    THIRD,
    Control,
    Equation,
    Exercise,
    Lesson,
    View,
    canvas,
    engine_runs,
    error_of,
    legend,
    straddled,
)

# ms. The error falls from a step here to its half; steps of 20 and of 10 ms would have the same error.
STEPS = (0.5, 1.0, 2.4, 3.0, 5.0, 6.0, 9.0, 12.0, 18.0, 28.0)
SCAN = np.geomspace(4e-4, 0.05, 160)  # s
EXAGGERATED = 12  # factor on the angles of the four frames


def rate_error(step: float) -> float:
    """Relative error of the tilt rate after the first impact, at a step [s]; nan without an impact."""
    return error_of(simulate_time_stepping(SCENE, step=step, history=False))


@functools.cache
def scanned() -> np.ndarray:
    """The error over `SCAN`."""
    return np.array([rate_error(float(step)) for step in SCAN])


def view(step: float) -> View:
    """Four steps around the first impact, and the error over all steps; step [ms]."""
    run = simulate_time_stepping(SCENE, step=1e-3 * step)
    exact = simulate(SCENE, history=False).impacts[0].time
    history = run.history
    landed = int(np.argmax(history.tilt <= 0))
    figure, (above, errors) = canvas(2, (0.7, 1.5))
    frames = [
        (history.tilt[landed - 2], "a step before"),
        (history.tilt[landed - 1], "the last above"),
        (history.tilt[landed], "in the ground"),
        (history.tilt[min(landed + 2, len(history.tilt) - 1)], "two steps on"),
    ]
    for place, (tilt, words) in enumerate(frames):
        _frame(above, 4.0 * place, tilt, words, old_corner=place == 2)
    above.axhline(0, color=SOFT, linewidth=1.4)
    above.set(xlim=(-1.7, 13.7), ylim=(-1.3, 2.0), aspect="equal")
    above.axis("off")
    above.set_position((0.02, 0.68, 0.96, 0.3))
    errors.loglog(1e3 * SCAN, 100 * scanned(), color=MODEL, linewidth=1.2, label="every step")
    guide = 100 * np.nanmax(scanned()) * SCAN / SCAN[-1]
    errors.loglog(1e3 * SCAN, guide, "--", color=SOFT, linewidth=1, label="first order")
    here = 100 * rate_error(1e-3 * step)
    errors.loglog(step, here, "o", color=OTHER, markersize=9)
    errors.set(xlabel="step [ms]", ylabel="error of the rate [%]", xlim=(0.4, 50), ylim=(1e-3, 30))
    legend(errors, loc="upper left")
    shift = 1e3 * (run.impacts[0].time - exact)
    around = [1e3 * straddled(1e-3 * step)[0], 100 * straddled(1e-3 * step)[1]]
    return View(
        figure,
        {
            "impact shifted by": (shift, "ms"),
            "error of the rate after it": (here, "%"),
            "shift, rms of all steps within a tenth": (around[0], "ms"),
            "error of the rate, rms of these": (around[1], "%"),
            "depth of the corner": (1e3 * 2 * RADIUS * math.sin(SLENDERNESS) * abs(frames[2][0]), "mm"),
        },
        f"With steps of {step:g} ms the impact comes {number(abs(shift))} ms {'late' if shift > 0 else 'early'}, and "
        f"the rate is off by {number(here)} %; over all steps within a tenth of it by {number(around[1])} % (rms).",
    )


def _frame(axis, middle, tilt, words, old_corner):
    """The foot of the block, its angle exaggerated; old_corner: it still pivots about the corner before the impact."""
    pivot = middle + (1 if tilt > 0 or old_corner else -1)
    axis.add_patch(
        Rectangle(
            (middle - 1, 0),
            2,
            1.15,
            angle=-math.degrees(EXAGGERATED * tilt),
            rotation_point=(pivot, 0),
            facecolor=STONE,
            edgecolor=MODEL,
            linewidth=1.6,
        )
    )
    axis.text(middle, -1.15, words, ha="center", fontsize=10, color=SOFT)


def engines_table() -> Table:
    """Error of the rate after the first impact in every installed engine, variant and level."""
    rows = [
        [
            run.name,
            run.kind,
            f"{run.parameter} = {run.value:g}",
            "no impact" if math.isnan(run.error) else number(100 * run.error, 2),
        ]
        for run in engine_runs()
    ]
    return Table(
        "The same impact in the engines installed here", ("engine, variant", "kind", "level", "error [%]"), rows
    )


def bad_example() -> View:
    """Show the error of restitution over the step of subject engines: finer levels of their defaults do not help."""
    study = read_study(RESULTS / "restitution")
    mains = study.settings["default_variants"]
    chosen = [
        variant
        for variant in study.settings["variants"]
        if ENGINES[variant["engine"]].subject
        and variant["parameter"].endswith("step")
        and (variant["tier"] == "defaults" or mains[variant["engine"]] == variant["variant"])
    ]
    figure, axis = canvas()
    numbers: dict[str, tuple[float | str, str]] = {}
    for variant, colour in zip(chosen, (MODEL, OTHER, THIRD), strict=True):
        levels = sorted(
            (row["level"], row["rms"])
            for row in where(
                study.rows, scope="levels", ground=RIGID, engine=variant["engine"], variant=variant["variant"]
            )
        )
        steps, errors = zip(*levels, strict=True)
        name = f"{variant['engine']}, {variant['tier']}"
        axis.loglog(
            [1e3 * step for step in steps],
            [100 * error for error in errors],
            marker=marker(variant["engine"]),
            color=colour,
            linestyle=":" if variant["tier"] == "defaults" else "-",
            label=name,
        )
        over = f"{name}: error at {1e3 * steps[0]:g} ms over that at {1e3 * steps[-1]:.3g} ms"
        numbers[over] = (errors[0] / errors[-1], "")
    axis.set(xlabel="step [ms]", ylabel="error of restitution, rms [%]")
    legend(axis, loc="center right")
    return View(
        figure,
        numbers,
        "With the variants “defaults” the error of restitution hardly falls while the step becomes ten times finer: "
        "their contact is not the rigid one. With the tuned variants it falls with the step.",
    )


def step_for_one_per_cent() -> float:
    """Largest step of `SCAN` [ms] with an error of the rate below 1 % at it and at all smaller steps."""
    over = np.flatnonzero(~(scanned() < 0.01))
    return 1e3 * float(SCAN[over[0] - 1])


def order() -> float:
    """Order of the error in the step: slope of its upper envelope, of the largest errors in each twelfth of `SCAN`."""
    parts = np.array_split(np.arange(len(SCAN)), 12)
    tops = [max(part, key=lambda k: scanned()[k]) for part in parts]
    return float(np.polyfit(np.log(SCAN[tops]), np.log(scanned()[tops]), 1)[0])


MADE = "default damping"
WHOSE, MISTAKE = next(
    (name, known[MADE]) for name, engine in ENGINES.items() if MADE in (known := engine.known_mistakes())
)
((WAS, BECOMES),) = MISTAKE.replacements.items()


def hidden_loss() -> float:
    """Error [%] of restitution from the rates of successive impacts with `MISTAKE`; nan if its study is not stored."""
    path = RESULTS / "mistakes"
    rows = where(read_study(path).rows, engine=WHOSE, mistake=MADE, scene="released") if path.exists() else ()
    return 100 * rows[0]["energy"] if rows else math.nan


def code() -> float:
    import numpy as np

    from analytic import simulate
    from analytic.checks.time_stepping import simulate_time_stepping
    from comparisons.lessons.lesson import SCENE

    exact = simulate(SCENE, history=False).impacts[0].time
    steps = np.linspace(4e-3, 5e-3, 41)  # s
    shifts = [simulate_time_stepping(SCENE, step=step).impacts[0].time - exact for step in steps]
    answer = 1e3 * max(abs(shift) for shift in shifts)  # ms
    return answer


LESSON = Lesson(
    number=5,
    name="corner",
    title="What an engine does at a corner",
    question="An engine for games and robots moves in steps. What happens if the impact falls between two of them?",
    aims=(
        "explain why an impact inside a step causes an error",
        "measure an order of convergence, and the scatter around it",
        "decide whether a smaller step reduces the error",
    ),
    needs="lesson 2; explicit Euler steps",
    minutes=12,
    symbols=(r"\phi", r"\dot{\phi}^{\pm}", r"e_{\phi}", r"\Delta t", "k"),
    equations=(
        Equation(
            r"\dot{\phi}_{k+1} = \dot{\phi}_k + \Delta t \, \ddot{\phi}_k, \quad \phi_{k+1} = \phi_k + \Delta t \, "
            r"\dot{\phi}_{k+1}",
            "",
            "Semi-implicit Euler: what most engines do between two contacts.",
        ),
        Equation(
            r"\dot{\phi}^+ = e_{\phi} \dot{\phi}^-",
            "7",
            "Applied at the end of the step that contains the impact, while semi-implicit steps run half a step "
            "ahead: up to half a step early or late, and at another rate than that of the impact.",
        ),
    ),
    controls=(Control("step", STEPS, 12.0, "ms", 1),),
    view=view,
    guess="Halve the step from 12 ms to 6 ms, and to 3 ms. Does the error halve? And for every engine?",
    look="Change the step. The steps are those of the model’s own fixed-step integrator, no engine’s. Above: the foot "
    "of the block at four steps (angles twelve times too large). Below: your step among all others.",
    wrong=(
        "*The error depends on the phase of the step.* Two steps that differ by a tenth of a millisecond may have "
        "errors that differ tenfold, depending on where in its step the impact falls. One small error proves nothing: "
        "halve the step, and halve it again, or take the mean over neighbouring steps, which does fall with the step.",
        "*A soft contact is another error.* In an engine without an impact law the corner penetrates. The playground "
        "shows the energy that is lost.",
        "*A small step does not correct a wrong law.* In the second picture some errors do not fall with the step: "
        "those engines have another contact law.",
    ),
    exercises=(
        Exercise(
            "With steps of 4 to 5 ms, by how much is the first impact early or late at worst?",
            code,
            "ms",
            "About half a step.",
        ),
        Exercise(
            "Below which step does the error of the rate stay under 1 %?",
            step_for_one_per_cent,
            "ms",
            "Go up from small steps and stop at the first larger error: larger steps that happen to be right do not "
            "count.",
            2,
        ),
        Exercise(
            "What is the order of the error in the step?",
            order,
            "",
            "The slope of the envelope in a doubly logarithmic plot.",
            2,
        ),
        Exercise(
            f"Make a mistake on purpose. `rocking script {WHOSE} free-rocking-rigid --output rock.py` writes a script "
            "that is exact; run it, and note $e_{\\phi}$ and the times of the impacts. Then forget something in it: "
            f"for `{WAS}` write `{BECOMES}`, so that the engine damps by 0.04 1/s, its default. Predict before you run "
            "it again: does the $e_{\\phi}$ that it prints change, do the times? And by how much is $e_{\\phi}$ too "
            "small if you take it from the rates just before two successive impacts?",
            hidden_loss,
            "%",
            "The impacts are as they were, so the $e_{\\phi}$ printed keeps its digits. Between them the block loses "
            "energy, so each impact is slower, and its time moves. An error that is not at the impact shows in "
            "the energy, and in the graph of the tilt: measure these, too. What other mistakes cost is on the report’s "
            "page *What a mistake costs*.",
            2,
        ),
    ),
    code=code,
    playground="motion=pulse&amplitude=0.4&period=0.8&engine=straddling&step=20",
    table=engines_table,
    example=bad_example,
)
