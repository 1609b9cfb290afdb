"""Values, roots and bounds of the Taylor polynomials of a step, for event location (compiled).

A polynomial is an array of coefficients, lowest first; `order` is the highest power used.
"""

import numpy as np

from .compiled import inner

MAX_ORDER = 24
# Order of the series between the samples of a record, where steps end anyway (`rocking study speed-error`).
SHORT_ORDER = 8
BISECTIONS = 60
SCRATCH = (BISECTIONS + 2, MAX_ORDER + 3)  # of `first_root`: a row for each halving
INVERSE = np.array([0.0] + [1.0 / k for k in range(1, 64)])


@inner
def value(f, order, t):
    """Return f(t) by Horner's rule."""
    total = f[order]
    for k in range(order - 1, -1, -1):
        total = total * t + f[k]
    return total


@inner
def bracketed_root(f, first, order, low, high):
    """Return the root of f(t)/t^first in (low, high], where it falls from + to -: Newton's method, bracketed.

    Just after an impact f is concave, so that Newton's method from the far end does not converge to the root at 0.
    """
    t = high
    for _ in range(BISECTIONS):
        total, slope = f[order], 0.0
        for k in range(order - 1, first - 1, -1):
            slope = slope * t + total
            total = total * t + f[k]
        if total > 0:
            low = t
        elif total < 0:
            high = t
        else:
            return t
        step = total / slope if slope < 0 else 0.0
        following = t - step
        if slope >= 0 or following <= low or following >= high:
            # a Newton step ends at the bracket only if it has converged there
            if slope < 0 and abs(step) <= 4e-16 * t:
                return t
            following = 0.5 * (low + high)
        if abs(following - t) <= 2e-16 * t:
            return following
        t = following
    return t


@inner
def first_root(f, order, h, work):
    """Return the first t in [0, h] at which f falls below 0, or -1; 0 if it falls at once.

    Leading zero coefficients are a root at 0 and are divided out (just after an impact, or at the third-order onset of
    uplift). Bernstein coefficients bound the polynomial, so that no crossing is missed, whatever their number.

    work : scratch array, shape SCRATCH
    """
    first = 0
    while first <= order and f[first] == 0.0:
        first += 1
    if first > order:
        return -1.0
    if f[first] < 0:
        return 0.0
    lowest, power = f[first], 1.0
    for k in range(first + 1, order + 1):
        power *= h
        if f[k] < 0:
            lowest += f[k] * power
    if lowest > 0:
        return -1.0
    steepest, power, end = 0.0, 1.0, 0.0
    for k in range(first + 1, order + 1):
        if k == first + 1 or f[k] > 0:
            steepest += (k - first) * f[k] * power
        power *= h
    end = f[order]
    for k in range(order - 1, first - 1, -1):
        end = end * h + f[k]
    if steepest < 0:  # monotone: at most one root
        return bracketed_root(f, first, order, 0.0, h) if end < 0 else -1.0
    return _isolated_root(f, first, order, h, work)


@inner
def shifted(f, order, t):
    """Shift the origin of f to t, in place."""
    for i in range(order):
        for k in range(order - 1, i - 1, -1):
            f[k] += t * f[k + 1]


@inner
def derivative(f, order, t):
    """Return f'(t)."""
    total = 0.0
    for k in range(order, 0, -1):
        total = total * t + k * f[k]
    return total


@inner
def bound(f, order, h):
    """Return a bound on |f| over [0, h]."""
    total, power = abs(f[0]), 1.0
    for k in range(1, order + 1):
        power *= h
        total += abs(f[k]) * power
    return total


@inner
def largest(f, sign, order, h, best, rate, work):
    """Return the larger of `best` and the maximum of sign f over [0, h]. rate : scratch for f'."""
    best = max(best, sign * f[0], sign * value(f, order, h))
    for k in range(order):
        rate[k] = sign * (k + 1) * f[k + 1]
    t, rising = 0.0, True
    for _ in range(order):
        root = first_root(rate, order - 1, h - t, work)  # the next maximum, then the next minimum
        if root < 0:
            break
        if rising and root > 0:
            best = max(best, sign * value(f, order, t + root))
        if root > 0:
            shifted(rate, order - 1, root)
            t, rate[0] = t + root, 0.0
        for k in range(order):
            rate[k] = -rate[k]
        rising = not rising
    return best


@inner
def _isolated_root(f, first, order, h, work):
    """Return the `first_root` of a polynomial that is not monotone.

    Sign changes of its Bernstein coefficients count the roots in an interval, which is bisected.
    """
    n = order - first
    starts, widths = work[:, MAX_ORDER + 1], work[:, MAX_ORDER + 2]
    coefficients, power, binomial = work[0], 1.0, 1.0
    for k in range(n + 1):
        coefficients[k] = f[first + k] * power / binomial
        power *= h
        binomial *= (n - k) / (k + 1)
    for j in range(1, n + 1):
        for i in range(n, j - 1, -1):
            coefficients[i] += coefficients[i - 1]
    starts[0], widths[0] = 0.0, h
    top = 0
    while top >= 0:
        low, width, b = starts[top], widths[top], work[top]
        sign, changes = 0.0, 0
        for i in range(n + 1):
            if b[i] != 0:
                this_sign = 1.0 if b[i] > 0 else -1.0
                if sign == 0 and this_sign < 0:
                    return low
                if sign != 0 and this_sign != sign:
                    changes += 1
                sign = this_sign
        if changes == 1:
            return bracketed_root(f, first, order, low, low + width)
        if changes == 0 or top >= BISECTIONS:
            top -= 1  # no crossing, or a double root that bisection cannot separate
            continue
        left = work[top + 1]
        for i in range(n + 1):  # de Casteljau at the middle: left half on the stack, right half below it
            left[i] = b[0]
            for j in range(n - i):
                b[j] = 0.5 * (b[j] + b[j + 1])
        # b now holds the right half: its last entries are the right-hand ends
        width *= 0.5
        starts[top], widths[top] = low + width, width
        starts[top + 1], widths[top + 1] = low, width
        top += 1
    return -1.0
