"""Lesson 6: two almost equal blocks."""

import functools
import math

import numpy as np

from analytic import SampledMotion, Scene, simulate
from analytic.scene import caryatid_block

from ...schemas.columns import MINUS_DIGITS
from ..lesson import MODEL, OTHER, SOFT, Control, Equation, Exercise, G, Lesson, View, canvas, legend

SLENDERNESS, RESTITUTION, DURATION = 0.28, 0.98, 30.0  # rad, -, s
APART = 0.1  # tilts that differ by more, over slenderness, have separated
EXPONENTS = tuple(float(k) for k in range(-12, -1))
STEP = 0.01  # s
TIMES = np.arange(0, DURATION + STEP / 2, STEP)  # s


@functools.cache
def scene() -> Scene:
    """A nearly elastic block under two sines with incommensurate periods."""
    sines = 0.5 * np.sin(11.7 * TIMES) + 0.5 * np.sin(1.618 * 11.7 * TIMES + 1)  # in the golden ratio
    motion = SampledMotion(STEP, 4 * G * math.tan(SLENDERNESS) * sines, "two sines")
    return Scene(block=caryatid_block(SLENDERNESS), motion=motion, duration=DURATION).with_(
        block={"restitution": RESTITUTION}
    )


@functools.cache
def tilt_of(exponent: float | None) -> np.ndarray:
    """Return tilt over slenderness every `STEP`; exponent k: of a block with a restitution 1 + 10^k times as large."""
    e = RESTITUTION * (1 + (0.0 if exponent is None else 10.0**exponent))
    history = simulate(scene().with_(block={"restitution": e}), output_step=STEP).history
    return np.interp(TIMES, history.time, history.tilt) / SLENDERNESS


def horizon(exponent: float) -> float:
    """Return the time [s] at which both tilts differ by `APART`; the whole duration if they never do."""
    apart = np.flatnonzero(np.abs(tilt_of(exponent) - tilt_of(None)) > APART)
    return float(apart[0] * STEP) if len(apart) else DURATION


def view(exponent: float) -> View:
    """Show both tilts and their difference; exponent: power of ten of the relative difference in restitution."""
    block, neighbour, end = tilt_of(None), tilt_of(exponent), horizon(exponent)
    power = "10" + f"{exponent:.0f}".translate(MINUS_DIGITS)
    figure, (tilt, distance) = canvas(2, (1, 1), sharex=True)
    figure.subplots_adjust(hspace=0.12)
    tilt.plot(TIMES, block, color=MODEL, linewidth=1.3, label=f"e = {RESTITUTION}")
    tilt.plot(TIMES, neighbour, "--", color=OTHER, linewidth=1.2, label=f"e = {RESTITUTION} (1 + {power})")
    tilt.axvline(end, color=SOFT, linewidth=1)
    tilt.set(ylim=(-1.5, 2.0), ylabel="tilt φ / γ", xlim=(0, DURATION))
    legend(tilt, loc="upper left", ncols=2)
    distance.semilogy(TIMES, np.maximum(np.abs(block - neighbour), 1e-16), color=MODEL, linewidth=0.9)
    distance.axhline(APART, color=SOFT, linewidth=0.9, linestyle=(0, (4, 4)))
    distance.axvline(end, color=SOFT, linewidth=1)
    distance.set(ylim=(1e-15, 10), ylabel="distance / γ", xlabel="time [s]", yticks=[1e-15, 1e-10, 1e-5, 1])
    last = "overturns" if abs(neighbour[-1]) > 2 else "rocks"
    return View(
        figure,
        {
            "horizon": (end, "s"),
            "the first block": ("overturns" if abs(block[-1]) > 2 else "rocks", ""),
            "the second block": (last, ""),
        },
        f"Two blocks that differ by 10^{exponent:.0f} in restitution separate after {end:.1f} s; the second {last}.",
    )


def growth() -> float:
    """Rate [1/s] at which a small distance grows: slope of its logarithm against the horizon, over all exponents."""
    ends = np.array([horizon(k) for k in EXPONENTS])
    logs = np.log(10.0) * np.array(EXPONENTS)
    inside = ends < DURATION
    return float(-np.polyfit(ends[inside], logs[inside], 1)[0])


def perturbation_for_twenty_seconds() -> float:
    """Horizon [s] of double precision, 1e-16, at that growth rate."""
    return float(np.log(APART / 1e-16) / growth())


def code() -> float:
    import numpy as np

    from analytic import simulate_many
    from comparisons.lessons.topics.chaos import RESTITUTION, scene

    spread = RESTITUTION * (1 + 0.01 * np.linspace(-1, 1, 200))
    crowd = simulate_many([scene().with_(block={"restitution": e}) for e in spread])
    answer = 100 * crowd.overturns.mean()  # %
    return answer


LESSON = Lesson(
    number=6,
    name="chaos",
    title="Two almost equal blocks",
    question="Two blocks differ in the twelfth digit of their restitution. For how long do they move alike?",
    aims=(
        "distinguish a wrong result from a sensitive one",
        "estimate a sensitivity horizon, and know that it is a property of the scene",
        "compare statistics of many runs where single runs are not comparable",
    ),
    needs="lesson 2; logarithms",
    minutes=10,
    symbols=(r"\phi", r"\Delta \phi", r"\lambda", "t"),
    equations=(
        Equation(
            r"|\Delta \phi(t)| \approx |\Delta \phi(0)| \exp(\lambda t)",
            "",
            "On average: between impacts neighbours separate as inverted pendulums do, and each impact turns a "
            "difference in time into one in rate.",
        ),
    ),
    controls=(Control("difference in restitution, power of ten", EXPONENTS, -6.0, "", 0),),
    view=view,
    guess="With a difference of $10^{-6}$ the blocks separate after some seconds. By which factor does that time grow "
    "with a difference of $10^{-9}$: 1000, 3, or less than 3?",
    look="Change the difference. Every factor of a thousand adds only a few seconds.",
    wrong=(
        "*A hundred times smaller error does not give a hundred times longer agreement.* It adds a constant: some "
        "seconds.",
        "*After the horizon two good solvers disagree, and both are right.* Compare them point by point before it, and "
        "by the statistics of many runs after it.",
        "*A single outcome under a long record is one sample.* Report the share of many, with its interval.",
        "*Do not mistake an error for chaos.* Chaos takes time: a solver that is off at the second impact is wrong.",
    ),
    exercises=(
        Exercise(
            "At which rate does a small difference grow? Fit the horizon against the logarithm of the difference.",
            growth,
            "per second",
            "A straight line through the horizons of all powers of ten.",
            2,
        ),
        Exercise(
            "How long a horizon does double precision, $10^{-16}$, allow at that rate?",
            perturbation_for_twenty_seconds,
            "s",
            "$\\ln(0.1/10^{-16})$ over the rate. No solver gets further in this number format.",
            2,
        ),
        Exercise(
            "Restitution is known to 1 %. What share of 200 such blocks overturns?",
            code,
            "%",
            "This number is stable, though no single outcome is.",
            2,
        ),
    ),
    code=code,
    playground="motion=synthetic&slenderness=0.2",
)
