"""The named hard cases of the stability study: a scene each, and what is known about it.

First stand the block and the motions that several cases share. Cases without friction follow, each with one extreme
quantity of the start, the motion, the bearings or the block. The last ones have friction: the block slides, or nearly
so.
"""

import functools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start
from analytic.scene import BASE, BEARINGS, MASS, benchmark_block, caryatid_block
from analytic.sliding.run import slipping_friction
from analytic.solver import parameters

BLOCK = benchmark_block()  # omega_r = 2.60 rad/s, slenderness 0.25
GAMMA = BLOCK.slenderness
THRESHOLD = 9.81 * math.tan(GAMMA)  # uplift acceleration on rigid ground [m/s2]
STATUE = caryatid_block(0.28)
ISOLATED = Scene(block=STATUE, base=BASE, bearings=BEARINGS, duration=8.0)

FREE, SLIDING = "free rocking", "model and Moreau"


@dataclass(frozen=True, eq=False)
class HardCase:
    """One hard case.

    title: what is hard about it. closed: whether the solution is known in closed form. expected: measure -> value known
    beforehand, slips in m. step [s]: the step that every stepping solver has to take. tolerances: kind of solver ->
    measure -> (value, reason), in place of the general ones. twin_until: the twin is slow, so it judges the kernel only
    up to this time [s]. quick: whether it is part of the quick study.
    """

    title: str
    scene: Scene
    closed: bool = False
    expected: dict = field(default_factory=dict)
    step: float | None = None
    tolerances: dict = field(default_factory=dict)
    twin_until: float = math.inf
    quick: bool = False

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def oracle(self) -> str:
        """Kind of solution that judges the case.

        With friction Moreau's time stepping judges the model, and the model all others. Without friction the closed
        form of free rocking, if there is one, judges the kernel; else kernel and twin judge each other. The kernel
        judges all others.
        """
        if self.scene.friction is not None:
            return SLIDING
        return FREE if self.closed else "kernel and twin"


def sampled(values: npt.ArrayLike, dt: float = 0.01) -> SampledMotion:
    """Return a motion from its accelerations [m/s2] at a step [s]."""
    return SampledMotion(dt, np.asarray(values, dtype=float))


def times(seconds: float, dt: float = 0.01) -> np.ndarray:
    """Return the times [s] of a sampled motion."""
    return np.arange(round(seconds / dt) + 1) * dt


SPEED = 0.8  # m/s, gained by the ground in a pulse or a spike that makes the block rock without overturning it
# Damper of each bearing [N s/m] that is critical for block and base on the stiffness after yielding.
CRITICAL = 2 * math.sqrt(BEARINGS.given("kb") * ISOLATED.total_mass / BEARINGS.count)
# The other laws with the stiffnesses of BEARINGS; bilinear with a characteristic strength near theirs, 640 N.
LAWS = {
    "bilinear": Bearings(law="bilinear", count=4, ka=BEARINGS.ka, kb=BEARINGS.kb, yield_force=700.0),
    "bouc-wen": Bearings(law="bouc-wen", count=4, ka=BEARINGS.ka, kb=BEARINGS.kb, alpha=BEARINGS.alpha),
    "linear": Bearings(law="linear", count=4, ka=BEARINGS.ka),
}


def extremes() -> list[HardCase]:
    """Return the cases without friction that have one extreme quantity."""
    return [*_starts(), *_pulses(), *_samples(), *_vertical(), *_extreme_bearings(), *_inertias()]


def _starts():
    # Time to |tilt| = pi/2 of a block at rest just beyond the unstable point: its distance grows as cosh(omega_r t),
    # then as the separatrix of a pendulum, tan(distance/4) ~ exp(omega_r t); off by the square of the share.
    share = 1e-9
    beyond = GAMMA * (1 + share) - GAMMA  # as rounded
    falls = math.log(8 * math.tan((math.pi / 2 - GAMMA) / 4) / beyond)
    known: dict[int, dict] = {
        -1: {"outcome": "rocks"},
        1: {"outcome": "overturns", "overturning time": falls / Scene(block=BLOCK).rocking_frequency},
    }
    return [
        HardCase(
            "released at the unstable point, but for 1e-9 of the slenderness",
            Scene(
                name=f"unstable point {sign * share:+g}",
                block=BLOCK,
                start=Start(tilt=GAMMA * (1 + sign * share)),
                duration=12.0,
            ),
            expected=expected,
        )
        for sign, expected in known.items()
    ]


def _pulses():
    return [
        *(
            HardCase(
                f"ground acceleration jumps to {share:g} of what lifts the block",
                Scene(
                    name=f"jump to {share:g}",
                    block=BLOCK,
                    motion=PulseMotion("rectangular", share * THRESHOLD, 1.5),
                    duration=6.0,
                ),
                expected=expected,
                quick=True,
            )
            for share, expected in ((0.999, {"outcome": "stands"}), (1.001, {"outcome": "rocks", "uplift time": 0.0}))
        ),
        *(
            HardCase(
                f"pulse of {math.pi / frequency:.2g} s",
                Scene(
                    name=f"pulse of {frequency:g} rad/s",
                    block=BLOCK,
                    motion=PulseMotion("half-sine", 0.5 * SPEED * frequency, frequency),
                    duration=4.0,
                ),
                expected={
                    "outcome": "rocks",
                    "uplift time": math.asin(THRESHOLD / (0.5 * SPEED * frequency)) / frequency,
                },
                quick=frequency == 1e4,
            )
            for frequency in (1e2, 1e4)
        ),
    ]


def _samples():
    spike = np.zeros(100)
    spike[20] = SPEED / 0.01
    return [
        *(
            HardCase(
                "each sample of the ground acceleration is the opposite of the last one",
                Scene(
                    name=f"alternating at {dt:g} s",
                    block=BLOCK,
                    motion=sampled(height * THRESHOLD * (-1.0) ** np.arange(1 + round(2 / dt)), dt),
                    duration=4.0,
                ),
            )
            for dt, height in ((0.01, 3.0), (0.05, 10.0))
        ),
        HardCase(
            "one sample of 8 g among zeros",
            Scene(name="one sample", block=BLOCK, motion=sampled(spike), duration=4.0),
            expected={"outcome": "rocks"},
            quick=True,
        ),
    ]


def _vertical():
    return [
        HardCase(
            "the vertical motion leaves 1 % of gravity",
            Scene(
                name=f"1 % of gravity, {shape}",
                block=BLOCK,
                motion=PulseMotion(shape, amplitude, 6.0, vertical=PulseMotion(shape, -0.99 * 9.81, 6.0)),
                duration=3.0,
            ),
            quick=shape == "rectangular",
        )
        for shape, amplitude in (("one-sine", 1.0), ("rectangular", 0.3))
    ]


def _extreme_bearings():
    rocking = ISOLATED.with_(motion=PulseMotion("one-sine", 3.0, 6.0), start=Start(tilt=0.1), duration=6.0)
    return [
        *(
            HardCase(f"{law} bearings, rocking", rocking.with_(name=f"{law} bearings", bearings=bearings))
            for law, bearings in LAWS.items()
        ),
        *(
            HardCase(
                f"dampers of {share:g} times critical, rocking",
                rocking.with_(name=f"damping {share:g}", bearings={"damping": share * CRITICAL}),
            )
            for share in (0.99, 100)
        ),
    ]


def _inertias():
    def block(ratio):
        return BLOCK.model_copy(update={"corner_inertia": ratio * BLOCK.mass * BLOCK.radius**2})

    return [
        case
        for ratio, duration in ((1.0001, 6.0), (100.0, 24.0))
        for case in (
            HardCase(
                f"moment of inertia {ratio:g} m R2 about a corner, free rocking",
                Scene(
                    name=f"inertia {ratio:g}, free rocking",
                    block=block(ratio),
                    start=Start(tilt=0.6 * GAMMA),
                    duration=duration,
                ),
                closed=True,
                quick=ratio < 2,
            ),
            HardCase(
                f"moment of inertia {ratio:g} m R2 about a corner, pulse",
                Scene(
                    name=f"inertia {ratio:g}, pulse",
                    block=block(ratio),
                    motion=PulseMotion("one-sine", 1.3 * THRESHOLD, 2 * Scene(block=block(ratio)).rocking_frequency),
                    duration=duration,
                ),
            ),
        )
    ]


G = 9.81
# One cosine of 4.6 THRESHOLD at 3.2 rad/s on BLOCK: the friction from which the corner that lands slips on, and the
# slips [m] of a block that slides to and fro, from its equations of motion (the tests find both again).
SLIPS_FROM = 0.2633756360465358
TO_AND_FRO = {"peak slip": 0.29498304635961, "end slip": 0.27196034003751}


def sliding() -> list[HardCase]:
    """Return the cases with friction."""
    return [*_level(), *_near_slenderness(), *_impacts(), *_swings(), *_isolated()]


def _case(title, name, mu, *, expected=None, quick=False, scene=None, **parts):
    scene = Scene(block=BLOCK, duration=6.0) if scene is None else scene
    return HardCase(title, scene.with_(name=name, friction=mu, **parts), expected=expected or {}, quick=quick)


def _slides(slip):
    return {"outcome": "slides", "peak slip": slip, "end slip": -slip}


def _level():
    a, mu, T = 4.0, 0.2, 0.5
    v = (a - mu * G) * T
    stops = v * T / 2 + v**2 / (2 * mu * G)
    hop, T_hop = PulseMotion("rectangular", -2 * G, math.pi / 0.1), 0.1
    # it flies until sqrt(2) T later, as its vertical velocity is g T at T; what it lands with takes mu of itself
    v = a * T_hop - mu * G * math.sqrt(2) * T_hop
    flies = a * T_hop**2 * (1.5 + math.sqrt(2)) + v**2 / (2 * mu * G)
    return [
        _case(
            "slides from rest to rest under a jump of the ground acceleration",
            "slides",
            mu,
            motion=PulseMotion("rectangular", a, math.pi / T),
            expected=_slides(stops),
            quick=True,
        ),
        _case(
            "turns round twice while it slides, without sticking",
            "slides to and fro",
            mu,
            motion=PulseMotion("one-cosine", 4 * mu * G, 6.0),
            expected={"outcome": "slides"} | TO_AND_FRO,
            quick=True,
        ),
        _case(
            "flies under a vertical motion of 2 g, and slides where it lands",
            "flies and slides",
            mu,
            motion=PulseMotion("rectangular", a, hop.frequency, vertical=hop),
            duration=2.0,
            expected=_slides(flies),
        ),
    ]


def _near_slenderness():
    """Two cases with friction just below and just above tan(slenderness).

    The half-sine has twice the acceleration that lifts a block which does not slide.
    """
    w, share = 3.0, 0.999
    pulse = PulseMotion("half-sine", 2 * THRESHOLD, w)
    begins = math.asin(share / 2)
    # slip of the ground under the block until the pulse ends, less what friction takes of it; then the block stops
    v = 2 * THRESHOLD / w * (math.cos(begins) + 1) - share * THRESHOLD * (math.pi - begins) / w
    slip = 2 * THRESHOLD * (math.cos(begins) * (math.pi - begins) + math.sin(begins)) / w**2
    slip += v**2 / (2 * share * THRESHOLD) - share * THRESHOLD * ((math.pi - begins) / w) ** 2 / 2
    lifts = {"outcome": "rocks", "uplift time": math.asin(0.5) / w}
    return [
        _case(
            f"friction of {factor:g} tan(slenderness): {words}",
            f"friction {factor:g} of uplift",
            factor * math.tan(GAMMA),
            motion=pulse,
            expected=expected,
            quick=True,
        )
        for factor, words, expected in (
            (share, "it only slides", _slides(slip)),
            (1.001, "it lifts, and slides", lifts),
        )
    ]


def _impacts():
    released = Scene(block=BLOCK, start=Start(tilt=0.6 * GAMMA), friction=1.0, duration=6.0)
    cosine = PulseMotion("one-cosine", 4.6 * THRESHOLD, 3.2)
    return [
        _case(
            "friction 0.1 % above that at which the impacts slip",
            "impacts nearly slip",
            1.001 * slipping_friction(parameters(released)),
            scene=released,
            expected={"outcome": "rocks", "peak slip": 0.0, "end slip": 0.0},
        ),
        *(
            _case(
                f"slides into an impact after which the corner just {words}",
                f"impact just {words}",
                factor * SLIPS_FROM,
                motion=cosine,
                duration=2.5,
            )
            for factor, words in ((0.999, "sticks"), (1.001, "slips"))
        ),
    ]


def _swings():
    tall, broad = (
        Scene(block=BLOCK.model_copy(update={"mass": MASS, "radius": radius, "slenderness": slenderness}), duration=4.0)
        for radius, slenderness in ((1.86, 0.348), (1.044, 0.449))
    )
    return [
        _case(
            "slides and sticks within a swing; overturns without sliding",
            "saved by sliding",
            0.4,
            scene=tall,
            motion=PulseMotion("half-sine", 9.38, 6.34),
            duration=6.0,
            quick=True,
        ),
        _case(
            "slides through an impact; stays upright without sliding",
            "overturned by sliding",
            0.5,
            scene=broad,
            motion=PulseMotion("one-sine", 17.39, 10.13),
        ),
    ]


def _isolated():
    return [
        _case(
            "on bearings, slides and never lifts",
            "isolated, slides",
            0.25,
            scene=ISOLATED,
            motion=PulseMotion("one-sine", 5.0, 5.0),
            duration=5.0,
            expected={"outcome": "slides"},
        ),
        _case(
            "on bearings, slides while it lifts and overturns",
            "isolated, slides and rocks",
            0.25,
            scene=ISOLATED,
            block=caryatid_block(0.2),
            motion=PulseMotion("one-sine", 6.0, 4.0),
            duration=3.0,
        ),
    ]


# One sine of 7.8 rad/s on BLOCK: amplitudes over THRESHOLD at which the outcome changes, from bisection with the kernel
# (the tests bisect again).
OVERTURNS_FROM = 1.401851713752694
GAP = 3.62  # between overturning with and without an impact


@functools.cache
def hard_cases() -> dict[str, HardCase]:
    """Return {name: `HardCase`}, in the order of the report."""
    cases = [
        *_rest(),
        *_uplift(),
        *_overturning(),
        *_proportions(),
        *_bearings(),
        *_steps(),
        *_records(),
        *extremes(),
        *sliding(),
    ]
    by_name = {case.name: case for case in cases}
    if len(by_name) != len(cases):
        raise ValueError("two hard cases share a name")
    return by_name


def _rest():
    burst, quiet = 1.3 * THRESHOLD * np.sin(4 * np.pi * times(2.0)), np.zeros(1200)
    flat = BLOCK.model_copy(update={"slenderness": math.asin(math.sqrt(2 / 3))})
    return [
        HardCase(
            "impacts accumulate until the block rests",
            Scene(name="zeno", block=BLOCK, start=Start(tilt=0.6 * GAMMA), duration=12.0),
            closed=True,
            quick=True,
        ),
        HardCase(
            "impacts accumulate on bearings",
            ISOLATED.with_(name="zeno on bearings", start=Start(tilt=0.6 * STATUE.slenderness)),
        ),
        HardCase(
            "rest inside a motion, then uplift again",
            Scene(
                name="rest and re-uplift",
                block=BLOCK,
                motion=sampled(np.concatenate([burst, quiet, burst, quiet])),
                duration=28.0,
            ),
        ),
        HardCase(
            "restitution 0: both corners land at once",
            Scene(name="flat drop", block=flat, start=Start(tilt=0.2), duration=3.0),
            closed=True,
            quick=True,
        ),
        HardCase(
            "restitution of eq. (7) below 0: the block lands flat, its momentum goes to the base",
            Scene(
                name="stocky on a light base",
                block=Block(mass=1000.0, radius=1.0, slenderness=1.0),
                base=Base(mass=10.0),
                bearings=BEARINGS,
                start=Start(tilt=0.1),
                duration=4.0,
            ),
            quick=True,
        ),
    ]


def _uplift():
    triangle = np.concatenate([np.linspace(0, THRESHOLD, 50), np.linspace(THRESHOLD, 0, 50)[1:]])
    lifts = {"outcome": "rocks", "uplift time": math.asin(1 / 1.01) / 3.0}
    return [
        *(
            HardCase(
                f"ground acceleration {share:g} of what lifts the block",
                Scene(
                    name=f"uplift {share:g}",
                    block=BLOCK,
                    motion=PulseMotion("one-sine", share * THRESHOLD, 3.0),
                    duration=4.0,
                ),
                expected=expected,
                quick=True,
            )
            for share, expected in ((0.99, {"outcome": "stands"}), (1.01, lifts))
        ),
        HardCase(
            "ground acceleration touches the threshold and turns back",
            Scene(name="touching the threshold", block=BLOCK, motion=sampled(triangle), duration=3.0),
            expected={"outcome": "stands"},
        ),
        *(
            HardCase(
                f"the tilt comes back to 0 with hardly any speed and just {word} it",
                Scene(
                    name=f"grazing, {word}",
                    block=BLOCK,
                    start=Start(tilt=0.4 * GAMMA),
                    motion=PulseMotion("half-sine", -amplitude, 4.0, 0.2),
                    duration=6.0,
                ),
                quick=word == "touches",
            )
            for amplitude, word in ((4.58, "misses"), (4.48, "touches"))
        ),
    ]


def _overturning():
    def pulse(name, amplitude, title, outcome, quick=False):
        motion = PulseMotion("one-sine", amplitude * THRESHOLD, 3 * 2.60)
        scene = Scene(name=name, block=BLOCK, duration=8.0, motion=motion)
        return HardCase(title, scene, expected={"outcome": outcome}, quick=quick)

    return [
        *(
            pulse(
                f"critical pulse {sign}{margin:g}",
                OVERTURNS_FROM * (1 + float(f"{sign}{margin}")),
                f"pulse {margin:g} {where} the amplitude that overturns",
                outcome,
                quick=margin == 0.01,
            )
            for margin in (0.01, 1e-3, 1e-5)
            for sign, where, outcome in (("-", "below", "rocks"), ("+", "above", "overturns"))
        ),
        pulse("safe gap", GAP, "stands between overturning with one impact and without", "rocks"),
        *(
            HardCase(
                "released at the unstable point, but for 1e-6 of the slenderness",
                Scene(
                    name=f"unstable point {share:+g}", block=BLOCK, start=Start(tilt=GAMMA * (1 + share)), duration=8.0
                ),
                expected={"outcome": "overturns" if share > 0 else "rocks"},
            )
            for share in (-1e-6, 1e-6)
        ),
    ]


def _proportions():
    light, heavy = (ISOLATED.with_(base=Base(mass=ratio * STATUE.mass), start=Start(tilt=0.1)) for ratio in (1e-4, 1e3))
    return [
        HardCase("base of 1e-4 of the block's mass", light.with_(name="light base"), quick=True),
        HardCase("the same base, free to slide", light.with_(name="light base, free", bearings=None)),
        HardCase("base of 1000 times the block's mass", heavy.with_(name="heavy base")),
    ]


def _bearings():
    t = times(8.0, 0.005)
    reason = "eqs (9), (11) add the travel, here 6e-12 m, to 1 m: each reversal is rounded to 4e-5 of it"
    extreme = ISOLATED.with_(motion=PulseMotion("one-sine", 3.0, 6.0), start=Start(tilt=0.1), duration=6.0)
    return [
        HardCase(
            "bearing driven beyond the 1.33 m at which eqs (10), (12) as printed give NaN",
            ISOLATED.with_(
                name="beyond 1.33 m", start=Start(base_velocity=8.0), block={"slenderness": 1.2}, duration=6.0
            ),
            quick=True,
        ),
        *(
            HardCase(
                f"reversals under {amplitude:g} m/s2",
                ISOLATED.with_(
                    name=f"reversals, {amplitude:g} m/s2",
                    motion=SampledMotion(0.005, amplitude * np.sin(10 * np.pi * t)),
                ),
                quick=amplitude == 1e-3,
                tolerances=tolerances,
            )
            for amplitude, tolerances in ((1e-3, {}), (1e-9, {"event-driven": {"displacement": (1e-3, reason)}}))
        ),
        *(
            HardCase("extreme bearing law, rocking", extreme.with_(name=name, bearings=law), quick=name == "alpha 200")
            for name, law in (
                ("alpha 1.5", {"alpha": 1.5}),
                ("alpha 200", {"alpha": 200.0}),
                ("ka = 1.0001 kb", {"ka": 6.22e3 * 1.0001}),
                ("ka = 1e9 N/m", {"ka": 1e9}),
            )
        ),
    ]


def _steps():
    gentle = SampledMotion(1 / 60, np.sin(np.pi * times(8.0, 1 / 60)))
    free = Scene(block=BLOCK, start=Start(tilt=0.6 * GAMMA))
    return [
        case
        # scenes of different steps, shorter or with another motion, so that no two are the same
        for steps, duration, motion in ((60, 6.0, gentle), (20, 6.5, gentle.scaled(1.01)))
        for case in (
            HardCase(
                f"free rocking at steps of 1/{steps} s",
                free.with_(name=f"step 1/{steps} s, free rocking", duration=duration),
                step=1 / steps,
                closed=True,
                quick=steps == 60,
            ),
            HardCase(
                f"isolated, not rocking, at steps of 1/{steps} s",
                ISOLATED.with_(name=f"step 1/{steps} s, isolated", motion=motion),
                step=1 / steps,
                quick=steps == 60,
            ),
        )
    ]


def _records():
    weak: dict[str, Any] = {"motion": sampled(0.3 * np.sin(2.6 * np.pi * times(600.0))), "duration": 600.0}
    t = times(12.0)
    gaps: dict[str, Any] = {
        "motion": sampled(1.3 * THRESHOLD * np.sin(4 * np.pi * t) * (np.sin(0.4 * np.pi * t) > 0.3)),
        "duration": 14.0,
    }
    t = times(100.0, 1e-3)[:100_000]
    many = 0.4 * (1 + np.sin(0.2 * t)) * np.sin(np.pi * t) + 0.3 * np.sin(37.0 * t)
    t = times(100.0)
    pulses = 1.3 * THRESHOLD * np.sin(4 * np.pi * t) * (t % 10 < 1)
    return [
        HardCase(
            "10 minutes at rest under weak shaking, rigid ground",
            Scene(name="10 minutes, rigid ground", block=BLOCK, **weak),
            expected={"outcome": "stands"},
            twin_until=20.0,
        ),
        HardCase(
            "10 minutes at rest under weak shaking, isolated",
            ISOLATED.with_(name="10 minutes, isolated", **weak),
            expected={"outcome": "stands"},
            twin_until=20.0,
        ),
        HardCase("record with gaps of zeros, isolated", ISOLATED.with_(name="gaps, isolated", **gaps)),
        HardCase("record with gaps of zeros, rocking", Scene(name="gaps, rocking", block=BLOCK, **gaps)),
        HardCase(
            "record of 1e5 samples",
            ISOLATED.with_(name="1e5 samples", motion=SampledMotion(1e-3, many), duration=100.0),
            twin_until=10.0,
        ),
        *(
            HardCase(
                f"sampling interval of {dt:g} s",
                Scene(name=f"sampled at {dt:g} s", block=BLOCK, motion=_decaying(dt), duration=6.0),
                twin_until=until,
                quick=dt == 0.05,
            )
            for dt, until in ((1e-4, 1.0), (0.05, math.inf))
        ),
        HardCase(
            "10 pulses in 100 s",
            Scene(name="pulses in a row", block=BLOCK, motion=sampled(pulses), duration=105.0),
            twin_until=25.0,
        ),
    ]


def _decaying(dt):
    t = times(4.0, dt)
    return SampledMotion(dt, 1.5 * THRESHOLD * np.sin(2 * np.pi * t) * np.exp(-0.5 * t))
