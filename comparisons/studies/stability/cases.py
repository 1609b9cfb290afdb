"""The named hard cases: a scene each, and what is known about it."""

import math
from dataclasses import dataclass, field

import numpy as np

from analytic import Base, Block, PulseMotion, SampledMotion, Scene, Start
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.problems import benchmark_block

BLOCK = benchmark_block()  # omega_r = 2.60 rad/s, slenderness 0.25
GAMMA = BLOCK.slenderness
THRESHOLD = 9.81 * math.tan(GAMMA)  # uplift acceleration on rigid ground [m/s2]
STATUE = caryatid_block(0.28)
ISOLATED = Scene(block=STATUE, base=BASE, bearings=BEARINGS, duration=8.0)
# One sine of 7.8 rad/s on BLOCK: amplitudes over THRESHOLD at which the outcome changes, from bisection with the kernel
# (the tests bisect again).
OVERTURNS_FROM = 1.401851713752694
GAP = 3.62  # between overturning with and without an impact


@dataclass(frozen=True, eq=False)
class HardCase:
    """One hard case.

    title: what is hard about it. oracle: "free rocking", where the solution is known in closed form, else "kernel and
    twin": each judges the other, and the kernel all others. expected: measure -> value known beforehand. step:
    [s], what every solver that steps is asked to take. tolerances: class of solvers -> measure -> (value, reason),
    in place of the general ones. twin_until: the twin is slow, and judges the kernel up to this time [s] only.
    quick: part of the quick study.
    """

    title: str
    scene: Scene
    oracle: str = "kernel and twin"
    expected: dict = field(default_factory=dict)
    step: float | None = None
    tolerances: dict = field(default_factory=dict)
    twin_until: float = math.inf
    quick: bool = False

    @property
    def name(self) -> str:
        return self.scene.name


def _sampled(values, dt=0.01):
    return SampledMotion(dt, np.asarray(values, dtype=float))


def _times(seconds, dt=0.01):
    return np.arange(round(seconds / dt) + 1) * dt


def hard_cases() -> dict[str, HardCase]:
    """Name -> `HardCase`, in the order of the report."""
    cases = [*_rest(), *_uplift(), *_overturning(), *_proportions(), *_bearings(), *_steps(), *_records()]
    by_name = {case.name: case for case in cases}
    if len(by_name) != len(cases):
        raise ValueError("two hard cases share a name")
    return by_name


def _rest():
    free = Scene(name="zeno", block=BLOCK, start=Start(tilt=0.6 * GAMMA), duration=12.0)
    yield HardCase("impacts accumulate until the block rests", free, oracle="free rocking", quick=True)
    yield HardCase(
        "impacts accumulate on bearings",
        ISOLATED.with_(name="zeno on bearings", start=Start(tilt=0.6 * STATUE.slenderness)),
    )
    quiet = np.zeros(1200)
    burst = 1.3 * THRESHOLD * np.sin(4 * np.pi * _times(2.0))
    yield HardCase(
        "rest inside a motion, then uplift again",
        Scene(
            name="rest and re-uplift",
            block=BLOCK,
            motion=_sampled(np.concatenate([burst, quiet, burst, quiet])),
            duration=28.0,
        ),
    )
    flat = BLOCK.model_copy(update={"slenderness": math.asin(math.sqrt(2 / 3))})
    yield HardCase(
        "restitution 0: both corners land at once",
        Scene(name="flat drop", block=flat, start=Start(tilt=0.2), duration=3.0),
        oracle="free rocking",
        quick=True,
    )
    stocky = Block(mass=1000.0, radius=1.0, slenderness=1.0)
    yield HardCase(
        "restitution of eq. (7) below 0: the block lands flat, its momentum goes to the base",
        Scene(
            name="stocky on a light base",
            block=stocky,
            base=Base(mass=10.0),
            bearings=BEARINGS,
            start=Start(tilt=0.1),
            duration=4.0,
        ),
        quick=True,
    )


def _uplift():
    for share in (0.99, 1.01):
        lifted = {} if share < 1 else {"uplift time": math.asin(1 / share) / 3.0}
        yield HardCase(
            f"ground acceleration {share:g} of what lifts the block",
            Scene(
                name=f"uplift {share:g}",
                block=BLOCK,
                motion=PulseMotion("one-sine", share * THRESHOLD, 3.0),
                duration=4.0,
            ),
            expected={"outcome": "rocks" if lifted else "stands", **lifted},
            quick=True,
        )
    triangle = np.concatenate([np.linspace(0, THRESHOLD, 50), np.linspace(THRESHOLD, 0, 50)[1:]])
    yield HardCase(
        "ground acceleration touches the threshold and turns back",
        Scene(name="touching the threshold", block=BLOCK, motion=_sampled(triangle), duration=3.0),
        expected={"outcome": "stands"},
    )
    for amplitude, word in ((4.58, "misses"), (4.48, "touches")):
        yield HardCase(
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


def _overturning():
    def pulse(name, amplitude, title, outcome, quick=False):
        scene = Scene(
            name=name, block=BLOCK, duration=8.0, motion=PulseMotion("one-sine", amplitude * THRESHOLD, 3 * 2.60)
        )
        return HardCase(title, scene, expected={"outcome": outcome}, quick=quick)

    for margin, quick in ((0.01, True), (1e-3, False), (1e-5, False)):
        yield pulse(
            f"critical pulse -{margin:g}",
            OVERTURNS_FROM * (1 - margin),
            f"pulse {margin:g} below the amplitude that overturns",
            "rocks",
            quick,
        )
        yield pulse(
            f"critical pulse +{margin:g}",
            OVERTURNS_FROM * (1 + margin),
            f"pulse {margin:g} above the amplitude that overturns",
            "overturns",
            quick,
        )
    yield pulse("safe gap", GAP, "stands between overturning with one impact and without", "rocks")
    for share in (-1e-6, 1e-6):
        yield HardCase(
            "released at the unstable point, but for 1e-6 of the slenderness",
            Scene(name=f"unstable point {share:+g}", block=BLOCK, start=Start(tilt=GAMMA * (1 + share)), duration=8.0),
            expected={"outcome": "overturns" if share > 0 else "rocks"},
        )


def _proportions():
    tilted = Start(tilt=0.1)
    light, heavy = Base(mass=1e-4 * STATUE.mass), Base(mass=1e3 * STATUE.mass)
    yield HardCase(
        "base of 1e-4 of the block's mass", ISOLATED.with_(name="light base", base=light, start=tilted), quick=True
    )
    yield HardCase(
        "the same base, free to slide", ISOLATED.with_(name="light base, free", base=light, start=tilted, bearings=None)
    )
    yield HardCase("base of 1000 times the block's mass", ISOLATED.with_(name="heavy base", base=heavy, start=tilted))


def _bearings():
    yield HardCase(
        "bearing driven beyond the 1.33 m at which eqs (10), (12) as printed give NaN",
        ISOLATED.with_(name="beyond 1.33 m", start=Start(base_velocity=8.0), block={"slenderness": 1.2}, duration=6.0),
        quick=True,
    )
    t = _times(8.0, 0.005)
    rounding = {
        "event-driven": {
            "displacement": (
                1e-3,
                "eqs (9), (11) add the travel, here 6e-12 m, to 1 m: each reversal is rounded to 4e-5 of it",
            )
        }
    }
    for amplitude in (1e-3, 1e-9):
        yield HardCase(
            f"reversals under {amplitude:g} m/s2",
            ISOLATED.with_(
                name=f"reversals, {amplitude:g} m/s2", motion=SampledMotion(0.005, amplitude * np.sin(10 * np.pi * t))
            ),
            quick=amplitude == 1e-3,
            tolerances={} if amplitude == 1e-3 else rounding,
        )
    for name, change in (
        ("alpha 1.5", {"alpha": 1.5}),
        ("alpha 200", {"alpha": 200.0}),
        ("ka = 1.0001 kb", {"ka": 6.22e3 * 1.0001}),
        ("ka = 1e9 N/m", {"ka": 1e9}),
    ):
        yield HardCase(
            "extreme bearing law, rocking",
            ISOLATED.with_(
                name=name,
                bearings=change,
                motion=PulseMotion("one-sine", 3.0, 6.0),
                start=Start(tilt=0.1),
                duration=6.0,
            ),
            quick=name == "alpha 200",
        )


def _steps():
    t = _times(8.0, 1 / 60)
    gentle = SampledMotion(1 / 60, np.sin(np.pi * t))
    for step, text in ((1 / 60, "1/60"), (1 / 20, "1/20")):
        first = step == 1 / 60
        yield HardCase(
            f"free rocking at steps of {text} s",
            Scene(
                name=f"step {text} s, free rocking",
                block=BLOCK,
                start=Start(tilt=0.6 * GAMMA),
                duration=6.0 if first else 6.5,
            ),
            step=step,
            oracle="free rocking",
            quick=first,
        )
        yield HardCase(
            f"isolated, not rocking, at steps of {text} s",
            ISOLATED.with_(name=f"step {text} s, isolated", motion=gentle if first else gentle.scaled(1.01)),
            step=step,
            quick=first,
        )


def _records():
    weak = 0.3 * np.sin(2.6 * np.pi * _times(600.0))
    yield HardCase(
        "10 minutes at rest under weak shaking, rigid ground",
        Scene(name="10 minutes, rigid ground", block=BLOCK, motion=_sampled(weak), duration=600.0),
        expected={"outcome": "stands"},
        twin_until=20.0,
    )
    yield HardCase(
        "10 minutes at rest under weak shaking, isolated",
        ISOLATED.with_(name="10 minutes, isolated", motion=_sampled(weak), duration=600.0),
        expected={"outcome": "stands"},
        twin_until=20.0,
    )
    t = _times(12.0)
    gaps = 1.3 * THRESHOLD * np.sin(4 * np.pi * t) * (np.sin(0.4 * np.pi * t) > 0.3)
    yield HardCase(
        "record with gaps of zeros, isolated",
        ISOLATED.with_(name="gaps, isolated", motion=_sampled(gaps), duration=14.0),
    )
    yield HardCase(
        "record with gaps of zeros, rocking",
        Scene(name="gaps, rocking", block=BLOCK, motion=_sampled(gaps), duration=14.0),
    )
    t = _times(100.0, 1e-3)[:100_000]
    many = 0.4 * (1 + np.sin(0.2 * t)) * np.sin(np.pi * t) + 0.3 * np.sin(37.0 * t)
    yield HardCase(
        "record of 1e5 samples",
        ISOLATED.with_(name="1e5 samples", motion=SampledMotion(1e-3, many), duration=100.0),
        twin_until=10.0,
    )
    for dt in (1e-4, 0.05):
        t = _times(4.0, dt)
        ground = 1.5 * THRESHOLD * np.sin(2 * np.pi * t) * np.exp(-0.5 * t)
        yield HardCase(
            f"sampling interval of {dt:g} s",
            Scene(name=f"sampled at {dt:g} s", block=BLOCK, motion=SampledMotion(dt, ground), duration=6.0),
            twin_until=1.0 if dt < 1e-3 else math.inf,
            quick=dt == 0.05,
        )
    t = _times(100.0)
    pulses = 1.3 * THRESHOLD * np.sin(4 * np.pi * t) * (t % 10 < 1)
    yield HardCase(
        "10 pulses in 100 s",
        Scene(name="pulses in a row", block=BLOCK, motion=_sampled(pulses), duration=105.0),
        twin_until=25.0,
    )
