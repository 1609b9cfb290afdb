"""The pulses, one entry of `PULSES` each: f(u) with u = frequency (t - start), plus a phase where the pulse has one.

A new pulse is one entry, and a function for its Taylor series unless one here gives it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .compiled import inner
from .polynomial import INVERSE

# A Ricker wavelet is unbounded; cut to four periods around its centre it has a jump below 1e-15 of the amplitude.
RICKER_PERIODS = 4.0
_CENTRE = RICKER_PERIODS * math.pi


@inner
def harmonic_series(order: int, a: float, frequency: float, u: float, A: np.ndarray) -> None:
    """Coefficients of a sin(u + frequency t)."""
    A[0], A[1] = a * math.sin(u), a * frequency * math.cos(u)
    for k in range(order - 1):
        A[k + 2] = -frequency * frequency * A[k] * INVERSE[k + 1] * INVERSE[k + 2]


@inner
def ricker_series(order: int, a: float, frequency: float, u: float, A: np.ndarray) -> None:
    """Coefficients of a (1 - 2 b) exp(-b), b = (u + frequency t)^2/4."""
    b0, b1, b2 = 0.25 * u * u, 0.5 * u * frequency, 0.25 * frequency * frequency
    e2, e1, e0 = 0.0, 0.0, math.exp(-b0)  # coefficients k-2, k-1, k of exp(-b)
    for k in range(order + 1):
        A[k] = a * (e0 - 2 * (b0 * e0 + b1 * e1 + b2 * e2))
        e2, e1, e0 = e1, e0, -(b1 * e0 + 2 * b2 * e1) * INVERSE[k + 1]


def _quarter_turns(length: float, phase: float) -> list[float]:
    turns: list[float] = np.arange(0, length + 0.1, math.pi / 2).tolist()
    return [0.0, *(u + -phase % (math.pi / 2) for u in turns[:-1]), turns[-1]] if phase else turns


def _ricker_turns(length: float, phase: float) -> list[float]:
    return [0.0, *(_CENTRE + u for u in (-(6**0.5), -(2**0.5), 0.0, 2**0.5, 6**0.5)), length]


def _sine_integral(ops: Any, u: Any, phase: float) -> Any:
    return ops.cos(phase) - ops.cos(u + phase)


def _ricker(ops: Any, u: Any) -> Any:
    b = 0.25 * (u - _CENTRE) * (u - _CENTRE)
    return (1.0 - 2.0 * b) * ops.exp(-b)


def _ricker_integral(ops: Any, u: Any, phase: float) -> Any:
    """With y = u/2 - 2 pi: d(2 y exp(-y^2))/du = (1 - 2 y^2) exp(-y^2)."""
    y, half = 0.5 * u - 0.5 * _CENTRE, 0.5 * _CENTRE
    return 2 * y * ops.exp(-(y**2)) + 2 * half * ops.exp(-half * half)


@dataclass(frozen=True)
class Pulse:
    """One shape of a pulse.

    length : of the pulse [rad].
    value(ops, u) : f, with sin, cos and exp of `ops`: math or numpy.
    integral(ops, u, phase) : of f(u + phase) from 0 to u.
    first_peak(phase) : u of the first maximum of |f|.
    turns(length, phase) : u of ends, zeros and extremes, ascending.
    series : Taylor series of f(u + shift) in the kernel, see `harmonic_series`; None: f = 1.
    jumps : whether f begins and ends with a jump at phase 0. phased : whether it has a phase.
    """

    length: float
    value: Callable[[Any, Any], Any]
    integral: Callable[[Any, Any, float], Any]
    first_peak: Callable[[float], float]
    turns: Callable[[float, float], list[float]] = _quarter_turns
    series: Callable[..., None] | None = harmonic_series
    shift: float = 0.0
    jumps: bool = False
    phased: bool = True


PULSES = {
    "one-sine": Pulse(
        2 * math.pi, lambda ops, u: ops.sin(u), _sine_integral, lambda phase: (math.pi / 2 - phase) % math.pi
    ),
    "one-cosine": Pulse(
        2 * math.pi,
        lambda ops, u: ops.cos(u),
        lambda ops, u, phase: ops.sin(u + phase) - ops.sin(phase),
        lambda phase: -phase % math.pi,
        shift=0.5 * math.pi,
        jumps=True,
    ),
    "half-sine": Pulse(
        math.pi, lambda ops, u: ops.sin(u), _sine_integral, lambda phase: (math.pi / 2 - phase) % math.pi
    ),
    "rectangular": Pulse(
        math.pi, lambda ops, u: 1.0, lambda ops, u, phase: u, lambda phase: 0.0, series=None, jumps=True, phased=False
    ),
    "ricker": Pulse(
        2 * _CENTRE,
        _ricker,
        _ricker_integral,
        lambda phase: _CENTRE,
        _ricker_turns,
        ricker_series,
        -_CENTRE,
        phased=False,
    ),
}
SERIES = tuple(dict.fromkeys(pulse.series for pulse in PULSES.values() if pulse.series))
