"""One step of the kernel, part by part: stretch of ground motion, series, first event, end of step (compiled).

All parts are inlined where the kernel calls them (by numba; by LLVM alone the kernel is slower by up to a third): the
split costs nothing.
"""

import math

from numba import njit

from . import layout as L
from .events import (
    direction_from_rest,
    find_corner,
    find_exceedance,
    find_impact,
    find_reversal,
    find_uplift,
    hop_deceleration,
    upper_bound,
)
from .laws import chosen
from .polynomial import bound, bracketed_root, derivative, largest, value
from .readings import read_contact, read_energy, read_lifting, write_history
from .taylor import (
    HARMONIC,
    LINEAR_GROUND,
    QUIET,
    SHORT_ORDER,
    allowed_step,
    base_series,
    contact_series,
    ground_series,
    hop_order,
    rigid_series,
)

# No step of a rocking block reaches this far [1/omega_r] at a useful tolerance: from here its length is soon found.
FARTHEST = 4.0

# The bearings' law, see `laws.Law`.
mark, begin_step, reached = chosen("mark"), chosen("begin"), chosen("reached")


@njit(inline="always")
def stretch_of_ground(ground, vertical, segment, begin, options, duration):
    """The next stretch of ground motion without a corner: (kind, a0, slope, of a_v too, end [s], order of the series).

    Between samples a_g is a0 + slope t; a pulse has the scale a0, with nothing before and after it. So has a_v.
    """
    kind, a0, slope, end, order = QUIET, 0.0, 0.0, duration, options.order
    lift, rise = 0.0, 0.0
    if ground.kind == LINEAR_GROUND:
        if segment < ground.samples.shape[0] - 1:
            a0 = ground.scale * ground.samples[segment]
            slope = (ground.scale * ground.samples[segment + 1] - a0) / ground.dt
            end = min((segment + 1) * ground.dt, duration)
            order = SHORT_ORDER
            if vertical is not None:
                lift = vertical.scale * vertical.samples[segment]
                rise = (vertical.scale * vertical.samples[segment + 1] - lift) / ground.dt
            if a0 != 0 or slope != 0 or lift != 0 or rise != 0:
                kind = LINEAR_GROUND
    elif ground.kind != QUIET:
        if segment == 0:
            end = min(ground.start, duration)
        elif segment == 1:
            kind, a0, end = ground.kind, ground.scale, min(ground.end, duration)
            if vertical is not None:
                lift = vertical.scale
    return kind, a0, slope, lift, rise, end, order


@njit(inline="always")
def ground_of_step(ground, kind, a0, slope, tau, order, h, A):
    """Series of the ground acceleration `tau` into the stretch: (its highest order, step)."""
    if kind == HARMONIC and ground.frequency == 0:
        return ground_series(order, LINEAR_GROUND, a0, 0.0, 0.0, 0.0, A), h
    phase = ground.phase + ground.frequency * tau  # not by t: late pulses are as exact as early ones
    if kind > LINEAR_GROUND:
        h = min(h, 1.0 / ground.frequency)
    return ground_series(order, kind, a0 + slope * tau, slope, ground.frequency, phase, A), h


@njit(inline="always")
def gravity_of_step(ground, vertical, g, kind, lift, rise, tau, order, G):
    """Series of g + a_v, as `ground_of_step`."""
    G[0], G[1] = 0.0, 0.0
    if kind == HARMONIC and ground.frequency == 0:
        kind = LINEAR_GROUND
    phase = vertical.phase + ground.frequency * tau
    ground_series(order, kind, lift + rise * tau, rise, ground.frequency, phase, G)
    G[0] += g


@njit(inline="always")
def bearing_of_step(par, gravity, rocking, s, tilt, rate, base, branch, highest, P):
    """Base and bearing at the start of a step; fills x, v, q and F of order 0.

    gravity : g + a_v [m/s2]. base : (x, v, z). branch : (direction of travel, x_c and D_c of the last reversal).
    Returns (branch, factors of the bearing's series, the bearing's next corner).
    """
    (x, v, z), (direction, x_c, mark_c) = base, branch
    P[L.X, 0], P[L.V, 0] = x, v
    P[L.F, 0] = par.count * (par.kb * x + z + par.damping * v)
    moving = math.copysign(1.0, v)
    if v == 0:
        moving = direction_from_rest(par, gravity, rocking, s, tilt, rate, highest, P, P[L.F, 0])
    if moving != direction and moving != 0:
        direction, x_c = moving, x
        mark_c = mark(par.law, direction, z, par.dk, par.alpha, par.d0, par.f0)
    travel = mark_c + direction * (x - x_c)
    P[L.Q, 0], factors, corner = begin_step(par.law, direction, z, travel, par.dk, par.alpha, par.d0, par.f0)
    return (direction, x_c, mark_c), factors, corner


@njit(inline="always")
def contact_of_step(par, factors, highest, order, tolerance, h, P):
    """Series in full contact; returns the step they allow [s]."""
    A, v, F = P[L.GROUND], P[L.V], P[L.F]
    if not par.on_base:
        for k in range(highest + 1, order + 1):
            A[k] = 0.0
        return h
    contact_series(order, par, factors, highest, A, P[L.X], v, P[L.Q], F, P[L.ABSOLUTE])
    # the force too: where ka is close to kb it varies faster than the velocity shows
    return allowed_step(F, order, tolerance, allowed_step(v, order, tolerance, h))


@njit(inline="always")
def rocking_of_step(par, vertical, gravity, kind, s, tilt, rate, fresh, factors, highest, order, tolerance, h, P):
    """Series while rocking; returns (order used, step [s]). gravity : g + a_v [m/s2] at its start."""
    phi, w, S, C, A, v, F = P[L.PHI], P[L.W], P[L.S], P[L.C], P[L.GROUND], P[L.V], P[L.F]
    h = min(h, FARTHEST / math.sqrt(par.p2))
    angle, used, reach = s * par.gamma - tilt, order, h
    phi[0], w[0], S[0], C[0] = tilt, rate, math.sin(angle), math.cos(angle)
    if tilt == 0 and rate != 0 and kind != LINEAR_GROUND:  # a hop: its length tells the order it needs
        back = hop_deceleration(par, s, gravity, A[0] if highest >= 0 else 0.0, F[0])
        if back > 0:
            hop = 2 * abs(rate) / back
            used = hop_order(math.sqrt(par.p2) * hop, order, tolerance)
            if used < order:
                reach = min(h, 1.2 * hop)
    while True:
        good = reach
        if par.on_base:
            if vertical is None:
                base_series(used, par, factors, highest, A, phi, w, S, C, P[L.X], v, P[L.Q], F, P[L.ABSOLUTE])
            else:
                base_series(
                    used, par, factors, highest, A, phi, w, S, C, P[L.X], v, P[L.Q], F, P[L.ABSOLUTE], P[L.GRAVITY]
                )
            good = allowed_step(F, used, tolerance, allowed_step(v, used, tolerance, good))
        elif vertical is None:
            rigid_series(used, par.p2, par.g, highest, A, phi, w, S, C)
        else:
            rigid_series(used, par.p2, par.g, highest, A, phi, w, S, C, P[L.GRAVITY])
        if fresh:
            phi[2], w[1] = 0.0, 0.0
        good = allowed_step(w, used, tolerance, good)
        if used == order or good == reach:
            return used, good
        used, reach = order, h  # the hop was longer than it looked


@njit(inline="always")
def first_event(
    par, vertical, gravity, rocking, s, tilt, slope, refused, direction, corner, order, highest, h, P, work
):
    """(kind of the first event in the step, its time since the start; NONE and h without one).

    gravity : g + a_v [m/s2] at the start; slope : tan(gamma), whose product with gravity is the uplift threshold.
    """
    found, event, phi = L.NONE, P[L.EVENT], P[L.PHI]
    if not rocking:
        row, threshold = (L.ABSOLUTE if par.on_base else L.GROUND), gravity * slope
        if abs(P[row, 0]) > threshold and not refused:
            found, h = L.UPLIFT, 0.0
        else:
            if vertical is None:
                root = find_uplift(P, row, order, threshold, refused, h, event, work)
            else:
                root = find_uplift(P, row, order, threshold, refused, h, event, work, slope, highest, P[L.GRAVITY])
            if root >= 0:
                found, h = L.UPLIFT, root
    else:
        root = find_impact(phi, s, order, h, event, work)
        if root >= 0:
            found, h = L.IMPACT, root
        top = upper_bound(phi, s, order, h)
        if top > par.gamma > s * tilt:
            root = find_exceedance(phi, s, par.gamma, order, h, event, work)
            if root >= 0:
                found, h = L.PASSAGE, root
        if top > 0.5 * math.pi:
            root = find_exceedance(phi, s, 0.5 * math.pi, order, h, event, work)
            if root >= 0:
                found, h = L.OVERTURNING, root
    if direction != 0:
        root = find_reversal(P[L.V], direction, order, h, event, work)
        if root > 0:
            found, h = L.REVERSAL, root
        if corner < math.inf:
            root = find_corner(P[L.Q], direction, corner, order, h, event, work)
            if root >= 0:
                found, h = L.CORNER, root
    return found, h


@njit(inline="always")
def read_step(par, vertical, rocking, s, order, highest, t, h, P, options, history, written, totals, work):
    """History, diagnostics and ledger of the step; returns the rows of the history written."""
    if history.shape[0] > 0 and (h > 0 or t == 0):
        written = write_history(history, written, options.output_step, t, h, P, order, par.on_base, rocking)
    if options.record and h > 0:
        read_contact(par, vertical, s, rocking, P, order, highest, h, totals, work)
        if rocking or par.on_base:
            read_energy(par, rocking, P, order, highest, h, totals)
        if vertical is not None and rocking:
            read_lifting(par, P, order, highest, h, totals)
    return written


@njit(inline="always")
def end_of_block(s, rate, order, h, P, peak_tilt, work):
    """(tilt, rate, peak tilt) at the end of the step; a peak inside it is a root of the rate."""
    phi, w, event = P[L.PHI], P[L.W], P[L.EVENT]
    tilt_end, rate_end = value(phi, order, h), value(w, order, h)
    if s * rate >= 0 and s * rate_end < 0:
        for k in range(order + 1):
            event[k] = s * w[k]
        peak_tilt = max(peak_tilt, abs(value(phi, order, bracketed_root(event, 0, order, 0.0, h))))
    elif w[1] * rate < 0 and w[1] * derivative(w, order, h) < 0 and bound(phi, order, h) > peak_tilt:
        # the rate may have changed its sign twice
        peak_tilt = largest(phi, s, order, h, peak_tilt, event, work)
    return tilt_end, rate_end, max(peak_tilt, abs(tilt_end))


@njit(inline="always")
def end_of_base(par, found, base, branch, corner, order, h, P):
    """(x, v, z) at the end of the step."""
    (_, _, z), (direction, x_c, mark_c) = base, branch
    x, v = value(P[L.X], order, h), value(P[L.V], order, h)
    if found == L.REVERSAL:
        v = 0.0
    travel = mark_c + direction * (x - x_c)
    z = reached(par.law, direction, z, P[L.Q], order, h, travel, par.dk, par.alpha, par.d0, par.f0)
    if found == L.CORNER:
        z = direction * corner
    return x, v, z
