"""Hard cases without friction of one extreme quantity: of the start, the motion, the bearings or the block."""

import math

import numpy as np

from analytic import Bearings, PulseMotion, Scene, Start
from analytic.caryatid import BEARINGS

from .basis import BLOCK, GAMMA, ISOLATED, THRESHOLD, HardCase, sampled

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
    return [*_starts(), *_pulses(), *_samples(), *_vertical(), *_bearings(), *_inertias()]


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


def _bearings():
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
