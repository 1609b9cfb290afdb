"""The linear oscillator x'' + 2 zeta omega x' + omega^2 x = -a_g under a record, and its displacement spectrum."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numba
import numpy as np
from numba import njit

from .compiled import inlined, inner
from .errors import SettingError
from .motion import SampledMotion

if TYPE_CHECKING:
    import numpy.typing as npt

    from .motion import Motion

PULSE_INTERVALS = 4000  # of a pulse; its interpolation error is then below 1e-6 of the amplitude


def displacement_spectrum(
    motion: Motion, periods: npt.ArrayLike, damping_ratios: npt.ArrayLike, *, scale: float = 1.0
) -> np.ndarray:
    """Largest |x| [m] of linear oscillators that start at rest, including the free vibration after the motion.

    Exact for acceleration that is linear between samples (N. C. Nigam and P. C. Jennings 1969, Bull. Seismol. Soc.
    Am. 59(2), 909-922); maxima between samples are located. A pulse is sampled at `PULSE_INTERVALS` intervals.

    Parameters
    ----------
    motion : SampledMotion or PulseMotion
    periods : array, shape (n,)
        Undamped natural periods [s], above 0.
    damping_ratios : array, shape (k,)
        Damping over critical damping, in [0, 1).
    scale : float
        Factor on the acceleration.

    Returns
    -------
    array, shape (k, n)
        [m].

    Raises
    ------
    SettingError
        A period or a damping ratio is out of range.
    """
    periods = np.atleast_1d(np.asarray(periods, dtype=float))
    ratios = np.atleast_1d(np.asarray(damping_ratios, dtype=float))
    if not (np.isfinite(periods).all() and (periods > 0).all()):
        raise SettingError("periods must be finite and above 0 s")
    if not ((ratios >= 0) & (ratios < 1)).all():
        raise SettingError("damping ratios must be in [0, 1): only oscillators that oscillate are covered")
    if isinstance(motion, SampledMotion):
        dt, samples = motion.dt, motion.samples
    else:
        dt = motion.length / PULSE_INTERVALS
        inside = np.clip(motion.start + dt * np.arange(PULSE_INTERVALS + 1), motion.start, motion.end)
        samples = motion.acceleration(inside)
    return _spectrum(dt, samples * scale, 2 * math.pi / periods, ratios)


@inlined
def _advance(state, load, oscillator, over):
    """State (x, v) after h under the acceleration a + slope tau. over : exp(-zeta w h), cos and sin of wd h, h."""
    (x, v), (a, slope), (w, zeta, wd), (decay, c, s, h) = state, load, oscillator, over
    drift = -slope / (w * w)  # particular solution: offset + drift tau
    offset = -a / (w * w) + 2 * zeta * slope / (w * w * w)
    x, v = x - offset, v - drift
    return (
        decay * (x * c + (v + zeta * w * x) / wd * s) + offset + drift * h,
        decay * (v * c - (zeta * w * v + w * w * x) / wd * s) + drift,
    )


@inner
def _largest_inside(state, load, oscillator, h):
    """|x| where the velocity changes sign between 0 and h, by bisection of the exact solution."""
    w, zeta, wd = oscillator
    low, high, found = 0.0, h, state[0]
    for _ in range(50):
        middle = 0.5 * (low + high)
        over = math.exp(-zeta * w * middle), math.cos(wd * middle), math.sin(wd * middle), middle
        found, speed = _advance(state, load, oscillator, over)
        if speed * state[1] > 0:
            low = middle
        else:
            high = middle
    return abs(found)


@inner
def _peak(dt, samples, w, zeta):
    wd = w * math.sqrt(1 - zeta * zeta)
    oscillator, over = (w, zeta, wd), (math.exp(-zeta * w * dt), math.cos(wd * dt), math.sin(wd * dt), dt)
    x, v, peak = 0.0, 0.0, 0.0
    for i in range(len(samples) - 1):
        load = samples[i], (samples[i + 1] - samples[i]) / dt
        x1, v1 = _advance((x, v), load, oscillator, over)
        if v * v1 < 0 and max(abs(x), abs(x1)) + dt * max(abs(v), abs(v1)) > peak:
            peak = max(peak, _largest_inside((x, v), load, oscillator, dt))
        x, v = x1, v1
        peak = max(peak, abs(x))
    if v != 0:  # free vibration: its first extreme, within half a damped period, is the largest
        peak = max(peak, _largest_inside((x, v), (0.0, 0.0), oscillator, math.pi / wd))
    return peak


@njit(cache=True, parallel=True)
def _spectrum(dt: float, samples: np.ndarray, frequencies: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    n = len(frequencies)
    peaks = np.empty((len(ratios), n))
    for k in numba.prange(len(ratios) * n):
        peaks[k // n, k % n] = _peak(dt, samples, frequencies[k % n], ratios[k // n])
    return peaks
