"""Lesson 1: uplift and overturning of a block."""

import functools
import math

import numpy as np
from matplotlib.colors import ListedColormap

from analytic import Block, PulseMotion, Scene, overturning_map, simulate
from analytic.rocking import RockingModel
from analytic.scene import MASS, RADIUS, caryatid_block

from ...plotting.diagrams import labelled
from ..lesson import (
    INK,
    OUTCOMES,
    PANEL,
    Control,
    Equation,
    Exercise,
    G,
    Lesson,
    View,
    canvas,
    edge,
    history_until,
    overturns,
    tilt_axis,
)

SLENDERNESS, PERIOD = 0.28, 0.8  # rad, s
PERIODS, AMPLITUDES = np.linspace(0.2, 2.0, 61), np.linspace(0.02, 1.5, 50)  # s, g
WINDOW = 6.0  # s


def pulse_scene(amplitude: float, period: float = PERIOD, slenderness: float = SLENDERNESS, size: float = 1.0) -> Scene:
    """The Caryatid, `size` times as large, under one sine; amplitude [g], period [s]."""
    motion = PulseMotion("one-sine", amplitude * G, 2 * math.pi / period)
    return Scene(block=Block(mass=MASS, radius=size * RADIUS, slenderness=slenderness), motion=motion)


@functools.cache
def overturning() -> np.ndarray:
    """Return the outcome over `AMPLITUDES` and `PERIODS`: 0 stands, 1 rocks, 2 overturns after impacts, 3 without."""
    scene, unit = Scene(block=caryatid_block(SLENDERNESS)), math.tan(SLENDERNESS)
    outcomes = overturning_map(scene, "one-sine", 2 * math.pi / PERIODS / scene.rocking_frequency, AMPLITUDES / unit)
    return np.where(outcomes.overturns, np.where(outcomes.impacts > 0, 2, 3), np.where(outcomes.lifted, 1, 0))


def view(amplitude: float) -> View:
    """Tilt over time, and the point on the overturning map; amplitude [g]."""
    scene = pulse_scene(amplitude)
    response, decided = history_until(scene, WINDOW), simulate(scene, history=False)
    figure, (tilt, field) = canvas(2, (1, 1.25))
    tilt_axis(tilt, response.history.time, response.history.tilt / SLENDERNESS, WINDOW, xlabel="time [s]")
    edges = [np.append(v - (v[1] - v[0]) / 2, v[-1] + (v[1] - v[0]) / 2) for v in (PERIODS, AMPLITUDES)]
    field.imshow(
        overturning(),
        origin="lower",
        aspect="auto",
        extent=(edges[0][0], edges[0][-1], edges[1][0], edges[1][-1]),
        cmap=ListedColormap(OUTCOMES),
        vmin=-0.5,
        vmax=3.5,
        interpolation="nearest",
    )
    field.grid(False)
    field.plot(PERIOD, amplitude, "o", markersize=11, markerfacecolor="none", markeredgecolor=PANEL, markeredgewidth=4)
    field.plot(PERIOD, amplitude, "o", markersize=11, markerfacecolor="none", markeredgecolor=INK, markeredgewidth=1.8)
    field.set(xlabel="period of the pulse [s]", ylabel="amplitude [g]")
    for x, y, words in (
        (1.45, 0.12, "stands"),
        (0.3, 0.9, "rocks"),
        (1.3, 1.0, "overturns at once"),
        (0.7, 0.7, "after impacts"),
    ):
        field.text(x, y, words, color="white" if "once" in words else "#1c1b1a", ha="center")
    return View(
        figure,
        {
            "outcome": (decided.outcome, ""),
            "peak tilt / γ": (decided.peak_tilt_ratio, ""),
            "impacts in 6 s": (len(response.impacts), ""),
        },
        f"Under a sine of {amplitude:.2f} g and {PERIOD:g} s the block {decided.outcome}.",
    )


def lifting_acceleration() -> float:
    """Uplift acceleration of a block 2 m high and 0.6 m wide [g]."""
    block = Block(mass=1.0, radius=math.hypot(1.0, 0.3), slenderness=math.atan2(0.3, 1.0))
    return RockingModel.of(Scene(block=block)).uplift_acceleration / G


def first_fall() -> float:
    """Least amplitude [g] at which the sine of 0.8 s overturns the Caryatid."""
    return edge(lambda amplitude: overturns(pulse_scene(amplitude)), 0.3, 0.5)


def size_that_survives() -> float:
    """Factor on the size of the block at which it survives a sine of 0.5 g and 0.8 s."""
    return edge(lambda size: overturns(pulse_scene(0.5, size=size)), 1.0, 3.0)


def slip_of_a_push() -> float:
    """Slip [m] of a block with tan(gamma) = 0.3 and friction 0.2 under 0.4 g for half a second."""
    block = Block(mass=1.0, radius=math.hypot(1.0, 0.3), slenderness=math.atan2(0.3, 1.0))
    push = PulseMotion("rectangular", 0.4 * G, math.pi / 0.5)
    response = simulate(Scene(block=block, motion=push, friction=0.2))
    assert response.outcome == "slides" and response.sliding is not None
    return response.sliding.peak


def code() -> object:
    from math import pi

    from analytic import Block, PulseMotion, Scene, simulate

    statue = Block(mass=3172.05, radius=1.0884, slenderness=0.28)  # kg, m, rad
    pulse = PulseMotion("one-sine", amplitude=0.4 * 9.81, frequency=2 * pi / 0.8)  # m/s2, rad/s
    response = simulate(Scene(block=statue, motion=pulse))
    answer = response.peak_tilt_ratio
    return response.outcome, answer


LESSON = Lesson(
    number=1,
    name="tipping",
    title="When does a block tip?",
    question="A block stands on the ground, and the ground accelerates. When does the block lift, and when does it "
    "overturn? Are these one question?",
    aims=(
        "distinguish uplift from overturning",
        "compute the acceleration that lifts a block from its width and height",
        "read an overturning map, with its island of safety",
    ),
    needs="moment of a force, Newton’s second law",
    minutes=12,
    drawing=labelled,
    symbols=("b", "h", r"\gamma", "R", "m", "J_O", r"\phi", "s", "g", "a_g", r"\mu"),
    equations=(
        Equation(
            r"|a_g| > g \tan \gamma = g \frac{b}{h}",
            "",
            "Uplift: the moment of the inertia force about a corner exceeds that of the weight. Size does not matter.",
        ),
        Equation(
            r"J_O \ddot{\phi} + m g R \sin(s \gamma - \phi) + m R \cos(s \gamma - \phi) \, a_g = 0",
            "4",
            "Rocking about a corner. Size matters: $J_O$ grows with $R^2$, the moments only with $R$.",
        ),
    ),
    controls=(
        Control(
            "amplitude", (0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, *(round(0.1 * k, 1) for k in range(6, 16))), 0.4, "g"
        ),
    ),
    view=view,
    guess="This block lifts at 0.288 g. Does a sine of 0.8 s overturn it at 0.3 g, at 0.4 g or only at 0.5 g? And once "
    "it overturns, does it overturn at every larger amplitude?",
    look="Change the amplitude of a sine of 0.8 s. The ring marks it in the map of all sines.",
    wrong=(
        "*Uplift is not overturning.* Between the two lies the blue region: the block rocks, loses energy at every "
        "impact and comes to rest.",
        "*A stronger pulse is not always worse.* Along a vertical line of the map the block may overturn, survive, and "
        "overturn again. Bisection assumes a single boundary: it finds one of them and says nothing of the others.",
        "*A static check ignores size.* Two blocks of one shape lift at the same acceleration, but the larger one "
        "survives what overturns the smaller.",
        "*A block that cannot stick cannot rock.* With a friction $\\mu < \\tan \\gamma$ it slides before it could "
        "lift, at $\\mu g$; with a little more it may do both. Above, the friction is taken to be ample.",
    ),
    exercises=(
        Exercise(
            "A block is 2 m high and 0.6 m wide. Which ground acceleration lifts it?",
            lifting_acceleration,
            "g",
            "$\\tan \\gamma = b/h$, half the width over half the height.",
        ),
        Exercise(
            "Which sine of 0.8 s is the weakest that overturns the Caryatid ($\\gamma = 0.28$, $R = 1.09$ m)?",
            first_fall,
            "g",
            "Bisect between an amplitude that overturns it and one that does not. The result is well above the "
            "$0.288\\,g$ that lift it.",
        ),
        Exercise(
            "How many times larger must a block of the same shape be to survive 0.5 g of 0.8 s?",
            size_that_survives,
            "times",
            "The same bisection, over R. The acceleration that lifts it has not changed.",
        ),
        Exercise(
            "The block of the first exercise stands on a floor of friction $\\mu = 0.2$. The ground pushes with 0.4 g "
            "for half a second. Does the block slide or rock, and how far does it slide?",
            slip_of_a_push,
            "m",
            "$\\mu = 0.2$ is below $\\tan \\gamma = 0.3$: it only slides. Newmark’s closed form: it lags the more, "
            "by $a_g - \\mu g$, for the time $T$, up to $v = (a_g - \\mu g) T$, and slides on by $v^2 / (2 \\mu g)$. "
            "In a scene file: friction = 0.2.",
        ),
    ),
    code=code,
    playground="motion=pulse&period=0.8&amplitude=0.4",
)
