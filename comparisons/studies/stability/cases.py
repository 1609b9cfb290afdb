"""The named hard cases: a scene each, and what is known about it."""

import functools
import math
from typing import Any

import numpy as np

from analytic import Base, Block, PulseMotion, SampledMotion, Scene, Start
from analytic.caryatid import BEARINGS

from .basis import BLOCK, GAMMA, ISOLATED, STATUE, THRESHOLD, HardCase, sampled, times
from .extremes import extremes
from .sliding import sliding

# One sine of 7.8 rad/s on BLOCK: amplitudes over THRESHOLD at which the outcome changes, from bisection with the kernel
# (the tests bisect again).
OVERTURNS_FROM = 1.401851713752694
GAP = 3.62  # between overturning with and without an impact


@functools.cache
def hard_cases() -> dict[str, HardCase]:
    """Name -> `HardCase`, in the order of the report."""
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
                tolerances=own,
            )
            for amplitude, own in ((1e-3, {}), (1e-9, {"event-driven": {"displacement": (1e-3, reason)}}))
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
        # other scenes by the step, that no two are one: shorter, or of another motion
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
