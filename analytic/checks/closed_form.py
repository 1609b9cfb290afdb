"""Closed-form solutions of a rocking block on rigid ground, for verification of the numerical models.

Free rocking obeys phi'' = -omega_r^2 sin(s gamma - phi). The solutions use the pendulum's elliptic integral in the form
of B. C. Carlson (1995), Numer. Algorithms 10, 13-26.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj, elliprf


def swing_energy(slenderness: float, peak: float) -> float:
    """Return (cos(gamma - |peak|) - cos gamma)/2: energy above the upright position over 2 m g R, no units."""
    peak = abs(peak)
    return math.sin(slenderness - peak / 2) * math.sin(peak / 2)


def quarter_period(omega_r: float, slenderness: float, energy: float) -> float:
    """Return the time from the peak of a swing, at rest, to the impact [s].

    [K(k) - F(psi, k)]/omega_r with k = cos(u0/2), sin psi = cos(gamma/2)/k and u0 = gamma - |peak|, written
    as one integral F(theta, k), tan theta = 1/(k' tan psi), that loses no digits for small swings or near
    the unstable point. `energy` is the `swing_energy`.

    Raises
    ------
    ValueError
        The swing reaches the unstable point |phi| = gamma and never returns.
    """
    s2 = math.sin(slenderness / 2) ** 2
    complement = s2 - energy  # k'^2 = sin^2(u0/2)
    if complement <= 0:
        raise ValueError(f"swing energy {energy:.6g} reaches the unstable point ({s2:.6g}): no impact")
    modulus = 1 - complement  # k^2
    sine2 = energy / (s2 * modulus)
    cosine2 = complement * (1 - s2) / (s2 * modulus)
    return math.sqrt(sine2) * float(elliprf(cosine2, cosine2 + complement * sine2, 1.0)) / omega_r


@dataclass(frozen=True, eq=False)
class FreeRocking:
    """Free rocking on rigid ground: arrays of shape (n,), one entry per impact.

    times [s]; rates_before, rates_after: |tilt rate| [rad/s].
    """

    times: np.ndarray
    rates_before: np.ndarray
    rates_after: np.ndarray


def free_rocking(omega_r: float, slenderness: float, restitution: float, tilt: float, count: int) -> FreeRocking:
    """Return the first `count` impacts of a block released at rest from `tilt` [rad], 0 < |tilt| < slenderness.

    Successive peaks obey cos(u') - cos(gamma) = e^2 (cos(u) - cos(gamma)), u = gamma - |phi|.

    Raises
    ------
    ValueError
        The tilt is 0 or not below the slenderness.
    """
    if not 0 < abs(tilt) < slenderness:
        raise ValueError(f"tilt = {tilt!r}: free rocking needs 0 < |tilt| < slenderness = {slenderness!r}")
    energies = swing_energy(slenderness, tilt) * restitution ** (2.0 * np.arange(count + 1))
    quarters = np.array([quarter_period(omega_r, slenderness, energy) for energy in energies[:-1]])
    flights = np.concatenate([quarters[:1], 2 * quarters[1:]])
    rates = 2 * omega_r * np.sqrt(energies)
    return FreeRocking(np.cumsum(flights), rates[:-1], rates[1:])


def impacts_to_rest(omega_r: float, slenderness: float, restitution: float, tilt: float, rest_rate: float) -> int:
    """Return the number of impacts until |phi'+| < rest_rate [rad/s], of a block released at rest from `tilt` [rad]."""
    first = 2 * omega_r * math.sqrt(swing_energy(slenderness, tilt))
    count = max(0, math.floor(math.log(rest_rate / first) / math.log(restitution)))
    while first * restitution**count >= rest_rate:
        count += 1
    return count


def remaining_time(rate_after: float, restitution: float, deceleration: float) -> float:
    """Return the time [s] from an impact with a small rate after it [rad/s] to the limit of all further impacts.

    Each swing lasts 2 |phi'+|/deceleration and is followed by e times the rate: a geometric series. `deceleration` is
    |phi''| at phi = 0 [rad/s2]; corrections are of the order of rate_after^2.
    """
    return 2 * abs(rate_after) / (deceleration * (1 - restitution))


def rest_time(omega_r: float, slenderness: float, restitution: float, tilt: float) -> float:
    """Return the time [s] at which the impacts accumulate; released at rest from `tilt` [rad], restitution < 1."""
    count = max(1, impacts_to_rest(omega_r, slenderness, restitution, tilt, 1e-9 * omega_r))
    run = free_rocking(omega_r, slenderness, restitution, tilt, count)
    deceleration = omega_r**2 * math.sin(slenderness)
    return run.times[-1] + remaining_time(run.rates_after[-1], restitution, deceleration)


def free_rocking_tilt(omega_r: float, slenderness: float, restitution: float, tilt: float, t: float) -> float:
    """Return the tilt [rad] at t [s] of a block released at rest from `tilt` [rad]; 0 after the last impact.

    Within a swing sin(u/2) = sin(u0/2)/dn(omega_r (t - t_peak), cos(u0/2)), u = gamma - |phi|.
    """
    if t >= rest_time(omega_r, slenderness, restitution, tilt):
        return 0.0
    energy, peak_time, side = swing_energy(slenderness, tilt), 0.0, math.copysign(1.0, tilt)
    while t > peak_time + (quarter := quarter_period(omega_r, slenderness, energy)):
        energy *= restitution**2
        peak_time += quarter + quarter_period(omega_r, slenderness, energy)
        side = -side
    complement = math.sin(slenderness / 2) ** 2 - energy
    dn = float(ellipj(omega_r * (t - peak_time), 1 - complement)[2])
    return side * (slenderness - 2 * math.asin(math.sqrt(complement) / dn))
