"""Lesson 3: a lead-rubber bearing."""

import numpy as np

from analytic.rocking import BearingLaw, BearingProperties, properties
from analytic.scene import BASE, BEARINGS, MASS

from ...plotting.diagrams import labelled_on_bearings
from ..lesson import MODEL, OTHER, THIRD, Control, Equation, Exercise, Lesson, View, canvas, legend

LAW = BearingLaw.of(BEARINGS)
CARRIED, X_MAX = MASS + BASE.mass, 0.30  # kg, m
AMPLITUDES = np.linspace(0.02, 0.4, 77)


def at(amplitude: float) -> BearingProperties:
    """Properties of the bearings at an amplitude [m]."""
    return properties(BEARINGS, CARRIED, amplitude)


def loop(amplitude: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (x [m], force [N]) of one bearing: from rest to +amplitude, then a full cycle."""
    turn = np.linspace(amplitude, -amplitude, 160)
    x = np.concatenate([np.linspace(0, amplitude, 80), turn, turn[::-1]])
    return x, LAW.kb * x + LAW.path(x)


def view(amplitude: float) -> View:
    """The loop of one bearing at an amplitude [m], and damping by two definitions."""
    x, force = loop(amplitude)
    here = at(amplitude)
    figure, (cycle, damping) = canvas(2, (1.35, 1))
    cycle.plot(x, force / 1e3, color=MODEL)
    cycle.fill(x[80:], force[80:] / 1e3, color=MODEL, alpha=0.13, linewidth=0)
    reach = np.array([-amplitude, amplitude])
    cycle.plot(reach, here.secant_stiffness * reach / 1e3, "--", color=OTHER, linewidth=1.4, label="secant stiffness")
    cycle.set(xlim=(-0.42, 0.42), ylim=(-3.7, 3.7), xlabel="displacement x [m]", ylabel="force [kN]")
    legend(cycle, loc="upper left")
    known = [at(value) for value in AMPLITUDES]
    damping.plot(AMPLITUDES, [100 * p.damping_paper for p in known], color=MODEL, label="W_D / 2πE, Table 1(a)")
    damping.plot(AMPLITUDES, [100 * p.damping_equivalent for p in known], "--", color=OTHER, label="W_D / 4πE, usual")
    damping.plot([amplitude] * 2, [100 * here.damping_paper, 100 * here.damping_equivalent], "o", color=THIRD)
    damping.set(xlim=(0, 0.42), ylim=(0, 90), xlabel="amplitude [m]", ylabel="damping [%]")
    legend(damping, loc="upper right")
    return View(
        figure,
        {
            "energy of a cycle": (here.cycle_loss, "J"),
            "period": (here.period, "s"),
            "damping, Table 1(a)": (100 * here.damping_paper, "%"),
            "damping, usual": (100 * here.damping_equivalent, "%"),
        },
        f"With an amplitude of {amplitude:.2f} m, one bearing dissipates {here.cycle_loss:.0f} J per cycle.",
    )


def secant_period() -> float:
    """Return the isolation period at x_max [s]."""
    return at(X_MAX).period


def usual_damping() -> float:
    """Equivalent viscous damping at x_max [%]."""
    return 100 * at(X_MAX).damping_equivalent


def misprinted_jump() -> float:
    """Jump of the force of eq. (12) as printed at a reversal from 0.20 m [N].

    The bracket as printed increases, 1 + (x - x_j) + 2 x0, where it must decrease, and x_j is such that the correct
    form is continuous. Both brackets are D_c at the reversal, so that the force as printed jumps by 2 f0.
    """
    z = LAW.start(0.20)
    return 2 * min(abs(z), LAW.f0)


def code() -> float:
    import numpy as np

    from analytic.rocking import BearingLaw
    from analytic.scene import BEARINGS

    law = BearingLaw.of(BEARINGS)
    x = np.concatenate([[0.0], 0.30 * np.cos(np.linspace(0, 2 * np.pi, 20001))])  # m, from rest to a cycle
    force = law.kb * x + law.path(x)  # N, of one bearing
    answer = np.trapezoid(force[1:], x[1:])  # J
    return answer


LESSON = Lesson(
    number=3,
    name="bearing",
    title="A lead-rubber bearing",
    question="Four rubber bearings with a lead core carry the statue’s base. How stiff are they, how much energy do "
    "they dissipate, and what does “30 % damping” mean?",
    aims=(
        "read stiffness and energy from a hysteresis loop",
        "tell the two definitions of equivalent damping apart",
        "check a printed formula by a property it must have",
    ),
    needs="work of a force, harmonic oscillator",
    minutes=12,
    drawing=labelled_on_bearings,
    symbols=(
        "b",
        "h",
        r"\gamma",
        "R",
        "m",
        "J_O",
        r"\phi",
        "m_b",
        "n_d",
        "x",
        "f",
        "k_a",
        "k_b",
        "f_0",
        r"\alpha",
        "x_0",
        "x_j",
        "D_0",
        "X",
        "W_D",
        "k_{sec}",
        "E_s",
        r"\xi",
    ),  # fmt: skip
    equations=(
        Equation(
            r"f = k_b x + (k_a - k_b) \frac{(1 + x - x_j + 2 x_0)^{1-\alpha} - D_0}{1 - \alpha} + f_0",
            "9, 11",
            "Loading: stiff at first (the lead is elastic), then soft (the rubber alone).",
        ),
        Equation(
            r"W_D = 4 f_0 X - \frac{2 (k_a - k_b)}{(\alpha - 1)(\alpha - 2)}",
            "",
            "For a cycle large enough to reach the limit curves of the loop.",
        ),
        Equation(
            r"\xi = \frac{W_D}{4 \pi E_s}, \quad E_s = \frac{1}{2} k_{sec} X^2",
            "",
            "The usual definition. Table 1(a) divides by half as much.",
        ),
    ),
    controls=(
        Control("amplitude", (0.02, 0.04, 0.06, 0.08, *(round(0.1 + 0.025 * k, 3) for k in range(13))), 0.3, "m"),
    ),
    view=view,
    guess="The amplitude grows from 0.1 m to 0.3 m. Does the bearing become softer or stiffer? Does its damping ratio "
    "rise or fall?",
    look="Change the amplitude. The shaded area is the energy of one cycle.",
    wrong=(
        "*Stiffness and damping depend on the amplitude.* The same bearing is stiff and strongly damped at 0.05 m, "
        "soft and weakly damped at 0.40 m: no spring and dashpot stands for both.",
        "*Two definitions differ by a factor of two.* The 30 % of Table 1(a) are $W_D/(2 \\pi E_s)$. A design for 30 % "
        "in the usual sense needs other bearings.",
        "*Eq. (12) is misprinted.* With its bracket as printed the force jumps at every reversal. A property that must "
        "hold (the force is continuous) shows it; a plot of one loop might not.",
        "*The 1 in the bracket is one metre.* The law depends on the unit of length: in millimetres it is another law.",
    ),
    exercises=(
        Exercise(
            "How much energy does one bearing dissipate in a cycle of 0.30 m? Integrate the loop by the trapezoidal "
            "rule.",
            code,
            "J",
            "The closed form for $W_D$ gives the same.",
            4,
        ),
        Exercise(
            "What is the period of the statue on its base ($3384$ kg) at 0.30 m?",
            secant_period,
            "s",
            "$2 \\pi \\sqrt{M X/F(X)}$ with the force of all four bearings.",
        ),
        Exercise(
            "How much is the “30 %” of Table 1(a) in the usual definition?",
            usual_damping,
            "%",
            "Half of it: $4 \\pi E_s$ in place of $2 \\pi E_s$.",
        ),
        Exercise(
            "At a reversal from 0.20 m, by how much would the force jump if the hysteretic part changed its sign "
            "there?",
            misprinted_jump,
            "N",
            "$2 f_0$, once the loop is on its limit curve: this is what the misprint of (12) does.",
        ),
    ),
    code=code,
    playground="motion=synthetic&base=true",
)
