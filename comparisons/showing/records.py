"""What was read of a record file, as a table for the terminal and as a picture."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from rich.text import Text

from analytic.linear_oscillator import displacement_spectrum
from analytic.motion import SampledMotion
from analytic.records import Channel, G

from ..running.readable import readable
from ..schemas import inputs
from .plots import TITLE_CHARACTERS
from .terminal import echo, grid

DAMPING = 0.05  # of the spectrum, as codes and catalogues have it
PERIODS = np.geomspace(0.05, 10.0, 150)  # s


def channel_words(channel: Channel) -> str:
    """Number and direction of a channel, 3 (Up), as far as its file names them."""
    number, direction = channel.number, channel.direction
    return f"{number} ({direction})" if number and direction else number or direction


def described(channel: Channel) -> inputs.Channel:
    """What was read of a channel, as it stands in JSON; peak and step in SI units."""
    motion = channel.motion
    return inputs.Channel(
        channel=channel.number,
        direction=channel.direction,
        units=channel.unit.word,
        units_from=channel.unit.where,
        dt=motion.dt,
        samples=len(motion.samples),
        duration=motion.end,
        peak=motion.peak,
        peak_time=motion.peak_time,
        note=channel.note,
        warnings=list(motion.warnings),
    )


def print_channels(name: str, channels: Sequence[Channel]) -> None:
    """Print a row for each channel of the file `name`, and what is odd about them."""
    rows = []
    kind = "column" if channels[0].format == "columns" else "channel"
    heads = [kind, "units", "dt [s]", "samples", "end [s]", "peak [m/s2]", "peak [g]", "at [s]"]
    for channel in channels:
        motion = channel.motion
        words = [channel_words(channel), channel.unit.word, f"{motion.dt:.9g}", str(len(motion.samples))]
        words += [f"{number:.5g}" for number in (motion.end, motion.peak, motion.peak / G, motion.peak_time)]
        rows.append([readable(word, 40) for word in words])
    title = Text(f"{readable(name, TITLE_CHARACTERS)}: {channels[0].format}")
    notes = dict.fromkeys(f"{channel.note[0].upper()}{channel.note[1:]}." for channel in channels if channel.note)
    warnings = dict.fromkeys(warning for channel in channels for warning in channel.motion.warnings)
    echo(grid(heads, rows, left=["units"], title=title), *notes, *(f"Warning: {readable(one)}." for one in warnings))


def spectrum(motion: SampledMotion) -> np.ndarray:
    """Pseudo-acceleration omega^2 x [m/s2] at `PERIODS` of oscillators damped by `DAMPING`."""
    return (2 * np.pi / PERIODS) ** 2 * displacement_spectrum(motion, PERIODS, [DAMPING])[0]


def draw_channels(name: str, channels: Sequence[Channel]) -> Figure:
    """The acceleration of each channel over time and its spectrum over the period, a row each: a matplotlib Figure."""
    figure = Figure(figsize=(11, 0.8 + 2.2 * len(channels)), layout="constrained")
    axes = figure.subplots(len(channels), 2, squeeze=False, width_ratios=[2, 1])
    for (left, right), channel in zip(axes, channels, strict=True):
        motion = channel.motion
        left.plot(motion.dt * np.arange(len(motion.samples)), motion.samples, color="black", linewidth=0.6)
        left.plot(motion.peak_time, motion.acceleration(motion.peak_time), "o", color="#D55E00", markersize=5)
        left.margins(x=0)
        label = f"{readable(channel_words(channel), 40)}: " if channel_words(channel) else ""
        left.set_title(f"{label}{motion.peak:.4g} m/s² at {motion.peak_time:.5g} s", loc="left")
        left.set_ylabel("acceleration [m/s2]")
        right.semilogx(PERIODS, spectrum(motion), color="black", linewidth=1.2)
        right.axhline(motion.peak, color="0.6", linewidth=0.8, linestyle="--")
        right.set_ylim(bottom=0)
        right.set_ylabel("S_a [m/s2]")
    axes[-1][0].set_xlabel("time [s]")
    axes[-1][1].set_xlabel("period [s]")
    axes[0][1].set_title(f"response spectrum, {DAMPING:.0%} (dashed: ground)", loc="left")
    figure.suptitle(f"{readable(name, TITLE_CHARACTERS)}: {channels[0].format}")
    return figure
