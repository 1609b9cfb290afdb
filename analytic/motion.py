"""Ground acceleration: sampled records and analytic pulses. SI units, zero outside their duration.

A motion is horizontal. Its vertical component `vertical`, if any, is a motion of the same kind.

A pulse is f(u) with u = frequency (t - start), plus a phase where the pulse has one; each f is an entry of `PULSES`. A
new pulse is one entry, and a function for its Taylor series unless one here gives it.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from .errors import SceneError
from .kernel.compiled import inner
from .kernel.polynomial import INVERSE

if TYPE_CHECKING:
    from .errors import GroundFunction, Values

# A Ricker wavelet is unbounded; cut to four periods around its centre it has a jump below 1e-15 of the amplitude.
RICKER_PERIODS = 4.0
_CENTRE = RICKER_PERIODS * math.pi


@inner
def harmonic_series(order: int, a: float, frequency: float, u: float, A: np.ndarray) -> None:
    """Fill the coefficients of a sin(u + frequency t)."""
    A[0], A[1] = a * math.sin(u), a * frequency * math.cos(u)
    for k in range(order - 1):
        A[k + 2] = -frequency * frequency * A[k] * INVERSE[k + 1] * INVERSE[k + 2]


@inner
def ricker_series(order: int, a: float, frequency: float, u: float, A: np.ndarray) -> None:
    """Fill the coefficients of a (1 - 2 b) exp(-b), b = (u + frequency t)^2/4."""
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
    """Return the integral, with y = u/2 - 2 pi: d(2 y exp(-y^2))/du = (1 - 2 y^2) exp(-y^2)."""
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

MOST_SAMPLES = 10_000_000  # of a component: a day at 100 Hz
SAME_STEP = 1e-9  # relative difference of two equal steps that are printed with different precision


def _positive(key: str, value: object, unit: str) -> None:
    if not (isinstance(value, (int, float)) and math.isfinite(value) and value > 0):
        raise SceneError(key, value, "not a positive number", f"give a finite value above 0 [{unit}]")


def slowest_key(motion: Motion) -> str:
    """Return the key of a scene file that determines the length of a motion."""
    if isinstance(motion, SampledMotion):
        return "motion.dt"
    return "motion.start" if motion.start > motion.length else "motion.frequency"


def vertical_acceleration(motion: Motion | None, t: Values) -> Values:
    """Return the vertical ground acceleration a_v [m/s2], upward, at time(s) t [s]; 0 without a vertical motion."""
    return motion.vertical.acceleration(t) if motion is not None and motion.vertical is not None else 0.0 * t


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """Ground acceleration at equal intervals, linear in between, zero after the last sample.

    Parameters
    ----------
    dt : float
        Sampling interval [s].
    samples : array, shape (n,)
        Accelerations [m/s2], the first at t = 0; n >= 2. Kept read-only.
    label : str
        What the motion is, for plots and tables.
    warnings : tuple of str
        Sentences on unusual properties (a peak above 3 g, ...), which every response repeats.
    vertical : SampledMotion or None
        The vertical ground acceleration a_v, upward: as many samples at the same interval (`paired`). Gravity
        is then g + a_v. Bearings are vertically rigid.
    """

    dt: float
    samples: np.ndarray = field(repr=False)
    label: str = "sampled motion"
    warnings: tuple[str, ...] = ()
    vertical: SampledMotion | None = None

    def __post_init__(self) -> None:
        _positive("motion.dt", self.dt, "s")
        samples = np.array(self.samples, dtype=np.float64)
        if samples.ndim != 1 or len(samples) < 2:
            raise SceneError(
                "motion.record",
                f"shape {samples.shape}",
                "holds fewer than two samples",
                "give at least two accelerations",
            )
        if not np.isfinite(samples).all():
            first = int(np.flatnonzero(~np.isfinite(samples))[0])
            raise SceneError(
                "motion.record", float(samples[first]), f"sample {first} is not finite", "mend or remove it"
            )
        samples.flags.writeable = False
        object.__setattr__(self, "samples", samples)
        object.__setattr__(self, "dt", float(self.dt))
        up = self.vertical
        if up is not None and (up.dt, len(up.samples), up.vertical) != (self.dt, len(samples), None):
            raise SceneError(
                "motion.vertical",
                f"{len(up.samples)} samples at {up.dt:.6g} s",
                f"not {len(samples)} samples at {self.dt:.6g} s as the horizontal motion",
                "resample and pad it",
            )

    def __reduce__(self) -> tuple[type[Self], tuple[float, np.ndarray, str, tuple[str, ...], SampledMotion | None]]:
        """Rebuild in another process: a plain copy would be writable, for which the kernel is compiled again."""
        return type(self), (self.dt, self.samples, self.label, self.warnings, self.vertical)

    @property
    def start(self) -> float:
        return 0.0

    @property
    def end(self) -> float:
        """Return the time of the last sample [s]."""
        return (len(self.samples) - 1) * self.dt

    @property
    def peak(self) -> float:
        """Return the peak ground acceleration [m/s2] (absolute)."""
        return float(np.abs(self.samples).max())

    @property
    def peak_time(self) -> float:
        """Return the time of the peak [s]."""
        return float(np.abs(self.samples).argmax() * self.dt)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Return the times above 0 at which the acceleration jumps [s]."""
        return (self.end,) if self.samples[-1] or self.vertical and self.vertical.samples[-1] else ()

    def acceleration(self, t: Values) -> Values:
        """Return the acceleration [m/s2] at time(s) t [s]; zero before 0 and after the last sample."""
        times = np.arange(len(self.samples)) * self.dt
        return np.interp(t, times, self.samples, left=0.0, right=0.0)

    def scaled(self, factor: float) -> SampledMotion:
        """Return the same motion times `factor`, the vertical one too."""
        up = self.vertical and self.vertical.scaled(factor)
        return SampledMotion(self.dt, self.samples * factor, self.label, self.warnings, up)

    def digest(self) -> str:
        """Return the content of the motion as a hash: equal motions have equal digests."""
        content = np.float64(self.dt).tobytes() + self.samples.tobytes()
        return hashlib.sha256(content + (self.vertical.digest().encode() if self.vertical else b"")).hexdigest()


@dataclass(frozen=True)
class PulseMotion:
    """A pulse given by a formula in u = frequency (t - start).

    one-sine: a sin u, 0 <= u <= 2 pi; one-cosine: a cos u, 0 <= u <= 2 pi; half-sine: a sin u, 0 <= u <= pi;
    rectangular: a, 0 <= u <= pi; ricker: a (1 - 2 b) exp(-b), b = (u - 4 pi)^2/4, 0 <= u <= 8 pi.

    Parameters
    ----------
    shape : str
        One of `PULSES`.
    amplitude : float
        a [m/s2]; may be negative.
    frequency : float
        [rad/s], above 0.
    start : float
        [s], not negative.
    phase : float
        [rad], added to u in sines and cosines, at the same start and end.
    vertical : PulseMotion or None
        The vertical ground acceleration a_v, upward: a pulse of the same shape, frequency and start, with its own
        amplitude and phase. Gravity is then g + a_v. Bearings are vertically rigid.
    """

    shape: str
    amplitude: float
    frequency: float
    start: float = 0.0
    phase: float = 0.0
    vertical: PulseMotion | None = None

    def __post_init__(self) -> None:
        if self.shape not in PULSES:
            raise SceneError("motion.pulse", self.shape, "not a known pulse", "choose one of " + ", ".join(PULSES))
        for name in ("amplitude", "frequency", "start", "phase"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
                raise SceneError(f"motion.{name}", value, "not a finite number", "give a finite number")
            object.__setattr__(self, name, float(value))
        _positive("motion.frequency", self.frequency, "rad/s")
        if self.start < 0:
            raise SceneError("motion.start", self.start, "negative", "start the pulse at 0 or later [s]")
        if self.phase and not self.form.phased:
            raise SceneError(
                "motion.phase", self.phase, f"a {self.shape} pulse has none", "leave it out, or choose a sine or cosine"
            )
        up, same = self.vertical, (self.shape, self.frequency, self.start, None)
        if up is not None and (up.shape, up.frequency, up.start, up.vertical) != same:
            raise SceneError(
                "motion.vertical",
                up.label,
                "not the same pulse but for its amplitude and phase",
                "give it the shape, frequency and start of the horizontal motion",
            )

    @property
    def label(self) -> str:
        up = f", vertical {self.vertical.amplitude:.4g} m/s2" if self.vertical else ""
        return f"{self.shape} pulse, {self.amplitude:.4g} m/s2, {self.frequency:.4g} rad/s{up}"

    @property
    def form(self) -> Pulse:
        """Return the entry of `PULSES`."""
        return PULSES[self.shape]

    @property
    def length(self) -> float:
        """Return the duration of the pulse [s]."""
        return self.form.length / self.frequency

    @property
    def end(self) -> float:
        """Return the time at which the pulse is over [s]."""
        return self.start + self.length

    @property
    def peak(self) -> float:
        """Return the peak ground acceleration [m/s2] (absolute)."""
        return abs(self.amplitude)

    @property
    def peak_time(self) -> float:
        """Return the first time of the peak [s]."""
        return self.start + self.form.first_peak(self.phase) / self.frequency

    @property
    def jumps(self) -> tuple[float, ...]:
        """Return the times above 0 at which the acceleration jumps [s]."""
        if self.form.jumps or self.phase or self.vertical and self.vertical.phase:
            return tuple(t for t in (self.start, self.end) if t > 0)
        return ()

    def acceleration(self, t: Values) -> Values:
        """Return the acceleration [m/s2] at time(s) t [s]; zero outside the pulse."""
        t = np.asarray(t, dtype=float)  # type: ignore[assignment]  # a number as well, see the return
        u = self.frequency * (t - self.start)
        inside = (t >= self.start) & (t <= self.end)
        return np.where(inside, self.amplitude * self.form.value(np, u + self.phase), 0.0)[()]  # type: ignore[return-value]  # [()]: a number for a number

    def scaled(self, factor: float) -> PulseMotion:
        """Return the same pulse times `factor`, the vertical one too."""
        up = self.vertical and self.vertical.scaled(factor)
        return replace(self, amplitude=self.amplitude * factor, vertical=up)

    def digest(self) -> str:
        """Return the content of the motion as a hash: equal motions have equal digests."""
        content: tuple[str, ...] = (self.shape, self.amplitude.hex(), self.frequency.hex(), self.start.hex())
        if self.phase or self.vertical:  # otherwise keeps the digests in stored results
            content += (self.phase.hex(), self.vertical.digest() if self.vertical else "")
        return hashlib.sha256(repr(content).encode()).hexdigest()


Motion = SampledMotion | PulseMotion


def paired(level: SampledMotion, upright: SampledMotion) -> SampledMotion:
    """Return the motion `level` with `upright` as its vertical component; both start at their first sample.

    The coarser one is resampled linearly to the step of the other, and the shorter one is padded with zeros. Warnings
    say so, after those of `upright`.

    Raises
    ------
    SceneError
        The two together would hold more than `MOST_SAMPLES`.
    """
    notes: list[str] = []
    step = min(level.dt, upright.dt)
    samples = max(level.end, upright.end) / step
    if samples > MOST_SAMPLES:
        raise SceneError(
            "motion.vertical",
            f"{upright.end:.4g} s at {upright.dt:.4g} s",
            f"beside {level.end:.4g} s at {level.dt:.4g} s they are {samples:.3g} samples together",
            f"resample the finer one, to at most {MOST_SAMPLES:.0e} in the longer one's time",
        )
    first, second = (_resampled(motion, step, notes) for motion in (level, upright))
    count = max(len(first), len(second))
    first, second = (
        _padded(samples, count, step, motion.label, notes) for samples, motion in ((first, level), (second, upright))
    )
    warnings = tuple(dict.fromkeys((*level.warnings, *upright.warnings, *notes)))
    vertical = replace(upright, dt=step, samples=second, warnings=())
    return SampledMotion(step, first, f"{level.label}, vertical {upright.label}", warnings, vertical)


def _resampled(motion: SampledMotion, step: float, notes: list[str]) -> np.ndarray:
    """Return the samples at the step [s]; the last one at the motion's end, or the first after it."""
    if math.isclose(motion.dt, step, rel_tol=SAME_STEP):
        return motion.samples
    notes.append(f"{motion.label}: resampled from {motion.dt:.6g} s to the {step:.6g} s of the other component")
    times = step * np.arange(math.ceil(motion.end / step * (1 - SAME_STEP)) + 1)
    last = times[-1] <= motion.end * (1 + SAME_STEP)
    return motion.acceleration(np.append(times[:-1], motion.end) if last else times)


def _padded(samples: np.ndarray, count: int, step: float, label: str, notes: list[str]) -> np.ndarray:
    missing = count - len(samples)
    if missing:
        notes.append(f"{label}: {missing * step:.6g} s of zeros put at its end, as the other component is longer")
    return np.append(samples, np.zeros(missing))


def shared_segments(
    motion: Motion | None, duration: float
) -> list[tuple[float, float, GroundFunction, GroundFunction]]:
    """Return [(start, end, a_g(t), a_v(t)), ...] as `segments` does: both are smooth and monotone on each."""
    level = segments(motion, duration)
    if motion is None or motion.vertical is None:
        return [(*piece, _line(0.0, 0.0, 0.0)) for piece in level]
    upright = segments(motion.vertical, duration)
    cuts = sorted({end for pieces in (level, upright) for _, end, _ in pieces})
    shared, start, i, j = [], 0.0, 0, 0
    for end in cuts:
        shared.append((start, end, level[i][2], upright[j][2]))
        start, i, j = end, i + (level[i][1] == end), j + (upright[j][1] == end)
    return shared


def segments(motion: Motion | None, duration: float) -> list[tuple[float, float, GroundFunction]]:
    """Return [(start, end, a_g(t)), ...] from 0 to duration [s]: on each, a_g is smooth, and monotone inside.

    A record has one per interval; pulses are cut at their zeros and extremes. a_g takes floats.
    """
    if isinstance(motion, SampledMotion):
        dt, samples = motion.dt, motion.samples.tolist()
        pieces = [
            (i * dt, (i + 1) * dt, _line(i * dt, a, (b - a) / dt))
            for i, (a, b) in enumerate(zip(samples[:-1], samples[1:], strict=True))
        ]
    elif motion is not None:
        turns = motion.form.turns(motion.form.length, motion.phase)
        cuts = [motion.start + u / motion.frequency for u in turns[:-1]] + [motion.end]
        pieces = [(0.0, motion.start, _line(0.0, 0.0, 0.0))]
        pieces += [(a, b, _pulse(motion)) for a, b in zip(cuts[:-1], cuts[1:], strict=True)]
    else:
        pieces = []
    pieces.append((pieces[-1][1] if pieces else 0.0, math.inf, _line(0.0, 0.0, 0.0)))
    return [(a, min(b, duration), ground) for a, b, ground in pieces if a < min(b, duration)]


def _line(start: float, value: float, slope: float) -> GroundFunction:
    return lambda t: value + slope * (t - start)


def _pulse(motion: PulseMotion) -> GroundFunction:
    a, w, start, phase, value = motion.amplitude, motion.frequency, motion.start, motion.phase, motion.form.value
    return lambda t: a * value(math, w * (t - start) + phase)
