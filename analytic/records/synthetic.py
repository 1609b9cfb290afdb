"""The shipped synthetic ground motion: a near-fault velocity pulse plus band-limited noise, by seed."""

import math

import numpy as np

from ..errors import SceneError
from ..motion import SampledMotion
from . import G

STYLES = ("duzce-like",)
# A seed with PGV 0.80 m/s that shows the paper's three outcomes (a third of all seeds do) with the widest margins.
DEFAULT_SEED = 620

PEAK = 0.515 * G  # m/s2
DT, COUNT = 0.005, 5000
PULSE = (
    (0.75, 0.92),  # acceleration amplitude of the pulse, over PEAK
    (0.70, 0.82),  # velocity amplitude, m/s
    (2.0, 3.5),  # cycles in the pulse
    (0.0, 2 * math.pi),  # phase, rad
    (3.5, 4.5),
)  # time of its centre, s
BAND = (1.0, 10.0)  # Hz, band of the noise
DECIMALS = 9  # samples are rounded to 1e-9 m/s2, so that every FFT and libm gives the same motion


def synthetic_motion(style: str = "duzce-like", seed: int = DEFAULT_SEED) -> SampledMotion:
    """Return a synthetic near-fault ground motion; equal seeds give equal motions.

    A velocity pulse (Mavroeidis and Papageorgiou 2003, eq. 3) of 0.70 to 0.82 m/s and period 0.95 to 1.36 s, with
    random length, phase and time, plus noise of random phases between 1 and 10 Hz under a gamma envelope. The noise is
    scaled so that the peak acceleration is 0.515 g. The final ground velocity is zero.

    Only the raw 64-bit stream of PCG64 is used, which numpy guarantees not to change between versions.

    Parameters
    ----------
    style : str
        "duzce-like": PGA 0.515 g and PGV of about 0.8 m/s, as the 1999 Duzce record has; no recorded value is used.
    seed : int
        Not negative.

    Returns
    -------
    SampledMotion
        5000 samples at 0.005 s; its label says that it is synthetic.

    Raises
    ------
    SceneError
        Unknown style or a seed that is not a whole number from 0 on.
    """
    if style not in STYLES:
        raise SceneError("motion.synthetic", style, "not a known synthetic motion", "choose " + ", ".join(STYLES))
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise SceneError("motion.seed", seed, "not a whole number from 0 on", "give an integer seed")
    frequencies = np.fft.rfftfreq(COUNT, DT)
    stream = np.random.PCG64(int(seed)).random_raw(5 + len(frequencies))
    uniform = (stream >> np.uint64(11)) * 2.0**-53
    share, speed, cycles, phase, centre = (
        low + (high - low) * u for (low, high), u in zip(PULSE, uniform, strict=False)
    )
    frequency = share * PEAK / (2 * math.pi * speed)

    time = np.arange(COUNT) * DT
    pulse = pulse_acceleration(time - centre, speed, frequency, cycles, phase)
    envelope = (time / centre * np.exp(1 - time / centre)) ** 2
    noise = envelope * _band_noise(frequencies, uniform[5:])
    noise -= envelope * (noise.sum() / envelope.sum())  # no residual velocity
    # The largest factor at which every |pulse + factor noise| is at most the peak; it is reached at one sample.
    heard = np.abs(noise) > 1e-12 * np.abs(noise).max()
    factor = ((PEAK - np.sign(noise[heard]) * pulse[heard]) / np.abs(noise[heard])).min()
    samples = np.round(pulse + factor * noise, DECIMALS)
    return SampledMotion(DT, samples, f"synthetic {style} motion, seed {seed}")


def pulse_acceleration(
    t: np.ndarray | float, speed: float, frequency: float, cycles: float, phase: float
) -> np.ndarray:
    """Return the acceleration [m/s2] at time(s) t [s] from the centre of a velocity pulse, zero outside it.

    v = speed/2 (1 + cos(2 pi f t/cycles)) cos(2 pi f t + phase) for |t| <= cycles/(2 f): Mavroeidis and
    Papageorgiou (2003), Bull. Seismol. Soc. Am. 93(3), eq. (3); speed [m/s], frequency f [Hz].
    """
    turn = 2 * math.pi * frequency
    bell, carrier = turn * t / cycles, turn * t + phase
    slope = np.sin(bell) / cycles * np.cos(carrier) + (1 + np.cos(bell)) * np.sin(carrier)
    return np.where(np.abs(bell) <= math.pi, -0.5 * speed * turn * slope, 0.0)


def _band_noise(frequencies: np.ndarray, uniform: np.ndarray) -> np.ndarray:
    """Return noise of flat spectrum between the BAND's edges, fourth-order roll-off outside, phases 2 pi uniform."""
    low, high = BAND
    inverse = np.divide(low, frequencies, out=np.full_like(frequencies, np.inf), where=frequencies > 0)
    gain = 1 / np.sqrt((1 + inverse**8) * (1 + (frequencies / high) ** 8))
    return np.fft.irfft(gain * np.exp(2j * math.pi * uniform), COUNT)
