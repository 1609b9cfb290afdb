"""Lesson 2: the loss of tilt rate at an impact."""

import numpy as np

from analytic import Block, Scene, Start, load_scene, simulate
from analytic.rocking import RockingModel, momentum_restitution
from analytic.scene import BASE, MASS, RADIUS, caryatid_block
from engines import ENGINES

from ...plotting.diagrams import labelled
from ..lesson import MODEL, OTHER, SOFT, Control, Equation, Exercise, Lesson, View, canvas, edge, history_until, legend

START, WINDOW = 0.8, 8.0  # tilt over slenderness, s
CURVE = np.linspace(0.02, 1.2, 80)
SCRIPTED, MEASURED = "free-rocking-rigid", 0.8  # the scene whose script is changed, and a measured restitution
# The engine whose contact has a restitution, and the call of its script that would state it.
WHOSE, (WAS,) = next(
    (name, known["restitution 1"].replacements)
    for name, engine in ENGINES.items()
    if "restitution 1" in (known := engine.known_mistakes())
)


def released(slenderness: float) -> Scene:
    """Return a block of the Caryatid's mass and radius, released at 0.8 of its slenderness on rigid ground."""
    return Scene(block=Block(mass=MASS, radius=RADIUS, slenderness=slenderness), start=Start(tilt=START * slenderness))


def restitution_of(slenderness: float, on_base: bool = False) -> float:
    """Return e_phi of eq. (7), on rigid ground or on the Caryatid's base."""
    return momentum_restitution(Scene(block=caryatid_block(slenderness), base=BASE if on_base else None))


def view(slenderness: float) -> View:
    """Tilt after the release, and restitution over slenderness."""
    scene = released(slenderness)
    response = history_until(scene, WINDOW)
    impact, e = response.impacts[0], restitution_of(slenderness)
    figure, (tilt, curve) = canvas(2, (1.1, 1))
    tilt.plot(response.history.time, response.history.tilt / slenderness, color=MODEL)
    times = [hit.time for hit in response.impacts if hit.time < WINDOW]
    tilt.plot(times, np.zeros(len(times)), "o", color=OTHER, markersize=4)
    tilt.set(xlim=(0, WINDOW), ylim=(-1, 1), xlabel="time [s]", ylabel="tilt φ / γ")
    curve.plot(CURVE, [restitution_of(g) for g in CURVE], color=MODEL, label="rigid ground")
    curve.plot(CURVE, [restitution_of(g, True) for g in CURVE], "--", color=OTHER, label="on a base of 212 kg")
    curve.plot(slenderness, e, "o", color=MODEL, markersize=8)
    curve.axhline(0, color=SOFT, linewidth=0.9)
    curve.set(xlim=(0, 1.2), ylim=(-0.5, 1.05), xlabel="slenderness γ [rad]", ylabel="restitution e")
    legend(curve, loc="upper right")
    return View(
        figure,
        {
            "rate after / before, simulated": (impact.rate_after / impact.rate_before, ""),
            "e of eq. (7)": (e, ""),
            "energy lost in one impact": (100 * (1 - e * e), "%"),
        },
        f"Released from 0.8 of its slenderness {slenderness:.2f}, the block loses {100 * (1 - e * e):.0f} % of its "
        "energy at each impact.",
    )


def swings_to_a_tenth(scene: Scene | None = None) -> float:
    """Impacts until the swings of the Caryatid are below a tenth of its slenderness."""
    response = simulate(scene or released(0.28))
    times, tilt = response.history.time, np.abs(response.history.tilt)
    last = times[np.flatnonzero(tilt > 0.1 * 0.28)[-1]]
    return float(sum(impact.time < last for impact in response.impacts)) + 1


def with_a_material() -> float:
    """Restitution e_phi of `SCRIPTED`, whatever coefficient of restitution its contacts have."""
    return momentum_restitution(load_scene(SCRIPTED))


def swings_of_the_measured() -> float:
    """Impacts as in `swings_to_a_tenth`, of `SCRIPTED` with the restitution `MEASURED`."""
    return swings_to_a_tenth(load_scene(SCRIPTED).with_(block={"restitution": MEASURED}))


def no_rocking_on() -> float:
    """Slenderness [rad] from which the block lands flat on rigid ground."""
    return edge(lambda gamma: restitution_of(gamma) <= 0, 0.5, 1.4)


def momentum_on_the_base() -> float:
    """Jump of the base's velocity [m/s] when the Caryatid strikes its base at 1 rad/s."""
    return float(RockingModel.of(Scene(block=caryatid_block(0.28), base=BASE)).impact(1.0)[1])


def code() -> float:
    from analytic import Block, Scene, Start, simulate

    statue = Block(mass=3172.05, radius=1.0884, slenderness=0.28)  # kg, m, rad
    response = simulate(Scene(block=statue, start=Start(tilt=0.8 * 0.28)))
    first = response.impacts[0]
    answer = first.rate_after / first.rate_before
    return answer


LESSON = Lesson(
    number=2,
    name="impacts",
    title="Why impacts lose speed",
    question="A rocking block strikes the ground with its other corner. The tilt rate after the impact can be computed "
    "without knowing the stone or the mortar. How?",
    aims=(
        "derive the restitution from the angular momentum about the new corner",
        "state the quantities on which it depends",
        "check an impact of a simulation by hand",
    ),
    needs="angular momentum, moment of inertia",
    minutes=12,
    drawing=labelled,
    symbols=("b", "h", r"\gamma", "R", "m", "J_O", r"\phi", r"\dot{\phi}^{\pm}", r"e_{\phi}", r"\tilde{m}"),
    equations=(
        Equation(
            r"e_{\phi} = \frac{\dot{\phi}^+}{\dot{\phi}^-} = 1 - \frac{2 m b^2}{J_O - m \tilde{m} h^2}",
            "7",
            "Angular momentum about the new corner is conserved, as the impulse acts there.",
        ),
        Equation(
            r"e_{\phi} = 1 - \frac{3}{2} \sin^2 \gamma", "7", "A rectangle on rigid ground: only its shape counts."
        ),
    ),
    controls=(Control("slenderness γ", tuple(round(0.04 * k, 2) for k in range(2, 16)), 0.28, "rad"),),
    view=view,
    guess="Which block loses more speed at an impact, a slender one or a stocky one? How much of its energy does the "
    "Caryatid ($\\gamma = 0.28$) lose at each impact: 1 %, 10 % or 20 %?",
    look="Change the slenderness. Dots are impacts; the lower picture shows the restitution of every block.",
    wrong=(
        "*Restitution is no material constant here.* A table with 0.6 for stone on stone is about bouncing balls. For "
        "a rigid block that neither bounces nor slips, the restitution follows from momentum.",
        "*Mass and size cancel.* If the restitution in your simulation changes with the mass, the cause is "
        "a soft contact, the step, or a solver that stopped too early.",
        "*Stocky blocks do not continue to rock.* Where (7) is not positive the block lands flat. Code that continues "
        "with a negative restitution swings the block through the floor.",
        "*The base takes part.* On a light base the tilt rate after the impact is smaller, and the base velocity "
        "jumps: eq. (8).",
    ),
    exercises=(
        Exercise(
            "What is the restitution of the Caryatid ($\\gamma = 0.28$) on rigid ground? Release it, and divide the "
            "tilt rates after and before an impact.",
            code,
            "",
            "$1 - 1.5 \\sin^2 0.28$.",
        ),
        Exercise(
            "Release it at $0.8\\,\\gamma$: after how many impacts do its peaks stay below $0.1\\,\\gamma$?",
            swings_to_a_tenth,
            "impacts",
            "Each impact leaves $e_{\\phi}^2$ of the energy, which is $\\cos(\\gamma - |\\phi|) - \\cos \\gamma$ at a "
            "peak.",
            0,
        ),
        Exercise(
            f"`rocking script {WHOSE} {SCRIPTED}` writes the Caryatid, released at $0.6\\,\\gamma$, in plain calls of "
            f"the engine. In its `build`, change `{WAS}` to `{WAS}, restitution=0.5`. Predict the `e` of the first "
            "impact, then run the script.",
            with_a_material,
            "",
            "Not 0.5, but as before: the contact’s impulse acts at the new corner, and has no moment about it.",
        ),
        Exercise(
            f"A test of your statue gave {MEASURED:g}. In a file `measured.toml`, put `mass = 3172.05`, "
            f"`radius = 1.0884`, `slenderness = 0.28` and `restitution = {MEASURED:g}` under `[block]`, and "
            f"`tilt = 0.168` under `[start]`. `rocking script {WHOSE} measured.toml` then has what a contact lacks: "
            "find the couple that acts before each landing. Predict after how many impacts the peaks stay below "
            "$0.1\\,\\gamma$, then run the script.",
            swings_of_the_measured,
            "impacts",
            "The couple takes the same share of the rate at every impact: as above, with 0.8 for $e_{\\phi}$.",
            0,
        ),
        Exercise(
            "From which slenderness does a rectangle land flat?", no_rocking_on, "rad", "$\\sin^2 \\gamma = 2/3$."
        ),
        Exercise(
            "The Caryatid strikes its base of 212 kg at 1 rad/s. By how much does the base’s velocity jump?",
            momentum_on_the_base,
            "m/s",
            "Horizontal momentum: $\\tilde{m} h (1 - e_{\\phi}) \\dot{\\phi}^-$, eq. (8) corrected.",
        ),
    ),
    code=code,
    playground="motion=release&tilt=0.8",
)
