"""The problem sheet solved on its own: classical Runge-Kutta steps and bisection, from the pages' equations alone.

Nothing of the project is imported. `solve(name, **faults)` returns {quantity: value}; a fault is one line marked so.
"""

import math

import numpy as np

STEP = 1e-3
G = 9.81
RUBBER = dict(n=4, ka=2.4e4, kb=2.4e3, alpha=40.0, delta=1e-20)
PAGES = {  # their numbers
    "free-rigid": dict(gamma=0.25, phi0=0.2, end=4.0),
    "free-sliding": dict(gamma=0.2, phi0=0.15, mb=300.0, end=4.0),
    "isolated-standing": dict(gamma=0.35, mb=300.0, rubber=RUBBER, A=-3.0, w=6.0, end=4.0),
    "isolated-rocking": dict(gamma=0.17, mb=300.0, rubber=RUBBER, A=-3.0, w=8.0, end=4.0),
    "pulse-below": dict(gamma=0.25, A=3.14, w=6.0, end=4.0),
    "pulse-above": dict(gamma=0.25, A=3.3, w=6.0, end=4.0),
    "record": dict(gamma=0.18, mb=300.0, T=2.0, xi=0.15, n=4, end=6.0),
    "hard": dict(gamma=0.45, phi0=0.1, A=6.0, w=6.5, t0=2.0, end=6.0),
}
OTHERS = dict(m=1000.0, R=1.2, mb=None, phi0=0.0, A=0.0, w=1.0, t0=0.0)  # where a page says nothing else
IMPACT = "impact_time", "rate_before", "rate_after", "base_velocity_jump"
STATE = "tilt", "tilt_rate", "displacement", "force"


class Rubber:
    """Eqs (4) to (6) of the pages with hysteretic bearings, the force of all together."""

    def __init__(self, n, ka, kb, alpha, delta, printed=False):
        self.n, self.kb, self.dk, self.p, self.printed = n, kb, ka - kb, 1 - alpha, printed
        self.full = (delta / self.dk) ** (-1 / alpha)  # 1 + 2 x0
        self.D0 = self.full**self.p
        self.f0 = self.dk * (self.D0 - 1) / (2 * self.p)
        self.xc = self.zc = 0.0

    def z(self, x, sigma):
        Dc = max(self.D0, self.D0 + self.p * (sigma * self.zc - self.f0) / self.dk) ** (1 / self.p)
        bracket = Dc + sigma * (x - self.xc)
        if self.printed and sigma < 0:  # fault: eq. (12) as printed
            bracket = 2 * self.full - Dc + (x - self.xc)
        return sigma * (self.dk * (bracket**self.p - self.D0) / self.p + self.f0)

    def force(self, x, sigma):
        return self.n * (self.kb * x + self.z(x, sigma))

    def turn(self, x, sigma):
        self.zc, self.xc = self.z(x, sigma), x


def solve(name, times, record=None, **fault):
    """The answers to one page; times: those at which states are asked for. record: path of record.csv.

    fault: printed8, printed12, lost (number of an impact), late (impacts at the end of the step, "held" or "smeared"),
    J, e, g, A, R, mb, gamma, phi0, w, c, n, ka, kb, alpha (factors).
    """
    d = OTHERS | PAGES[name]
    d |= {key: value * fault.get(key, 1.0) for key, value in d.items() if isinstance(value, float)}
    m, R, gamma, mb, g = d["m"], d["R"], d["gamma"], d["mb"], G * fault.get("g", 1.0)
    J, M = 4 / 3 * m * R * R * fault.get("J", 1.0), m + (mb or 0.0)
    mu = m / M if mb else 0.0
    b, h = R * math.sin(gamma), R * math.cos(gamma)
    e = (1 - 2 * m * b * b / (J - mu * m * h * h)) * fault.get("e", 1.0)
    rubber, spring, damper, table = None, 0.0, 0.0, None
    if "rubber" in d:
        numbers = {key: value * fault.get(key, 1) for key, value in d["rubber"].items()}
        rubber = Rubber(**numbers, printed="printed12" in fault)
    elif "T" in d:  # eq. (4) of this page
        omega, mass = 2 * math.pi / d["T"], M * fault.get("n", 1.0)
        spring, damper = mass * omega * omega, 2 * mass * d["xi"] * omega * fault.get("c", 1.0)
        table = np.loadtxt(record, delimiter=",", skiprows=1, unpack=True)

    def ground(t):
        if table is not None:
            return fault.get("A", 1.0) * float(np.interp(t, *table))
        tau = t - d["t0"]
        return d["A"] * math.sin(d["w"] * tau) if 0 <= tau <= 2 * math.pi / d["w"] else 0.0

    def force(y):
        return rubber.force(y[2], now["sigma"] or 1.0) if rubber else spring * y[2] + damper * y[3]

    def slope(t, y):
        phi, w, x, v = y
        s, a, F = now["side"], ground(t), force(y)
        if late == "smeared" and s:
            s = math.copysign(1, phi) if phi else s
        if not s:
            return (0.0, 0.0, v, (-F / M - a) if mb else 0.0)
        c, n = R * math.cos(s * gamma - phi), R * math.sin(s * gamma - phi)
        if not mb:
            return (w, -m * (c * a + g * n) / J, 0.0, 0.0)
        p, q = -m * n * w * w - F, -m * g * n
        D = M * J - (m * c) ** 2
        return (w, (M * q - m * c * p) / D, v, (J * p - m * c * q) / D - a)

    def rk(t, y, H):
        k1 = slope(t, y)
        k2 = slope(t + H / 2, [u + H / 2 * k for u, k in zip(y, k1, strict=True)])
        k3 = slope(t + H / 2, [u + H / 2 * k for u, k in zip(y, k2, strict=True)])
        k4 = slope(t + H, [u + H * k for u, k in zip(y, k3, strict=True)])
        return [u + H / 6 * (a + 2 * b + 2 * c + f) for u, a, b, c, f in zip(y, k1, k2, k3, k4, strict=True)]

    def excess(t, y):
        a = -force(y) / M if mb else ground(t)
        return abs(a) - g * math.tan(gamma), a

    late, now = fault.get("late"), dict(side=math.copysign(1, d["phi0"]) if d["phi0"] else 0.0, sigma=0.0)
    out = dict(outcome="rocks" if now["side"] else "stands", peak_tilt=abs(d["phi0"]), peak_displacement=0.0)
    impacts = {}
    y, t = [d["phi0"], 0.0, 0.0, 0.0], 0.0
    grid = STEP if table is None else table[0, 1] / 4
    stops = sorted({*times, d["end"], d["t0"], d["t0"] + 2 * math.pi / d["w"]})
    while t < d["end"] - 1e-12:
        if mb and y[3] == 0:
            now["sigma"] = math.copysign(1, slope(t + 1e-9, y)[3])
        if not now["side"]:
            over, a = excess(t, y)
            if over > 1e-12 or (over > -1e-12 and excess(t + 1e-7, rk(t, y, 1e-7))[0] > over):
                now["side"] = -math.copysign(1, a)
                out["outcome"] = "rocks"
                out.setdefault("uplift_time", t)
        s = now["side"]
        H = min((math.floor(t / grid + 1e-9) + 1) * grid, next(u for u in stops if u > t + 1e-12)) - t
        if s and y[1] and y[0] == 0 and not late:
            H = min(H, 0.5 * abs(y[1] / (slope(t, y)[1] or 1.0)))
        tests = {
            "impact": lambda z, at, s=s: s * z[0] < 0,
            "over": lambda z, at: abs(z[0]) > math.pi / 2,
            "turn": lambda z, at: now["sigma"] * z[3] < 0,
            "uplift": lambda z, at: excess(at, z)[0] > 0,
        }
        new, first, kind = rk(t, y, H), H, None
        for each in (*(("impact", "over") if s else ("uplift",)), *(("turn",) if mb else ())):
            if tests[each](new, t + H):
                at = H
                if each != "impact" or not late:
                    at = bisect(lambda u, f=tests[each], y=y, t=t: f(rk(t, y, u), t + u), H)
                if at <= first:
                    first, kind = at, each
        new = rk(t, y, first)
        if s and y[1] * new[1] < 0:  # a peak of the tilt within the step
            top = rk(t, y, bisect(lambda u, y=y, t=t: rk(t, y, u)[1] * y[1] < 0, first))
            out["peak_tilt"] = max(out["peak_tilt"], abs(top[0]))
        y, t = new, t + first
        out["peak_tilt"] = max(out["peak_tilt"], abs(y[0]))
        out["peak_displacement"] = max(out["peak_displacement"], abs(y[2]))
        if kind == "over":
            return out | impacts | dict(outcome="overturns", overturning_time=t)
        if rubber and kind in ("turn", "impact"):
            rubber.turn(y[2], now["sigma"])
        if kind == "turn":
            y[3] = 0.0
        elif kind == "impact":
            before = y[1]
            k = len(impacts) // len(IMPACT) + 1
            after = before if k == fault.get("lost") else e * before
            jump = mu * h * (before - after) * (h if "printed8" in fault else 1.0)
            y[0] = y[0] if late else 0.0
            y[1] = after
            if mb:
                y[3] += jump
                now["sigma"] = math.copysign(1, y[3])
            now["side"] = math.copysign(1, after)
            impacts |= {f"{IMPACT[i]}_{k}": value for i, value in enumerate((t, before, after, jump))}
            back = -now["side"] * slope(t, y)[1]
            if abs(after) < 1e-7 and back > 0:
                out.setdefault("rest_time", t + 2 * abs(after) / back / (1 - e))
                y[0] = y[1] = now["side"] = 0.0
        for stop in [stop for stop in times if abs(stop - t) < 1e-11]:
            out |= {f"{name}_at_{stop:g}": value for name, value in zip(STATE, (*y[:3], force(y)), strict=True)}
    return out | impacts


def bisect(happens, high):
    """The end of the span in which it first happens, which it does at `high`."""
    low = 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if happens(middle) else (middle, high)
    return high
