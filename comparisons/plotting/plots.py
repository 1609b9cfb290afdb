"""Matplotlib figures of histories and record files, styles of solvers, table of a record file.

Colours are those of Okabe and Ito, which colour-blind readers tell apart.
"""

import io
import warnings
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rich.text import Text

from analytic import Response, SampledMotion, Scene
from analytic.advice.bearing_scan import displacement_spectrum
from analytic.records import Channel, G
from analytic.stack.equations import LOWER, StackModel
from engines import ENGINES

from ..execution.writing import readable
from ..schemas import runs
from .terminal import TITLE_CHARACTERS, echo, grid

# colour, dashes, width. The wide line of the reference lies under the others; dots need width to be seen.
REFERENCE: tuple[str, str | tuple[float, tuple[float, ...]], float] = ("#000000", "-", 2.4)
DOTS, LINES = 1.8, 1.4
TILT_RANGE = (0.05, 2.0)  # least and greatest limit of a tilt axis, over slenderness
LABELS = {
    "tilt": "tilt / slenderness [-]",
    "pedestal": "tilt of the pedestal\n/ slenderness [-]",
    "slip": "slip of the block\non its support [m]",
    "displacement": "base displacement [m]",
}
SLIDES: tuple[str, dict[str, Any]] = ("slides", {"color": "#E69F00", "alpha": 0.25, "linewidth": 0})
SHADES = {  # {mode of contact: (label, look of its span)}
    "slide": SLIDES,
    "slide-rock": SLIDES,
    "flight": ("flies", {"facecolor": "none", "edgecolor": "0.5", "hatch": "///", "linewidth": 0}),
}
SPARE: tuple[str, str | tuple[float, tuple[float, ...]], float] = ("#777777", (0, (5, 1)), 1.3)
OTHERS = {"scipy": ("--", "D"), "time-stepping": (":", "v")}  # {solver that is no engine: (dashes, marker)}


def marker(solver: str) -> str:
    """Return the marker of a solver, the same in every figure."""
    return ENGINES[solver].marker if solver in ENGINES else OTHERS.get(solver, ("", "o"))[1]


def style(solver: str) -> dict[str, Any]:
    """Return the line keywords of a solver, the same in every figure."""
    colour, dashes, width = REFERENCE if solver == "analytic" else SPARE
    if solver in ENGINES:
        colour, dashes = ENGINES[solver].colour, ENGINES[solver].dashes
        width = DOTS if dashes == ":" else LINES
    return {"color": colour, "linestyle": dashes, "linewidth": width}


def draw_histories(scene: Scene, responses: Sequence[Response], horizon: float | None = None) -> Figure:
    """Draw ground motion, tilts, slip, base displacement and hysteresis loop of responses: a matplotlib Figure.

    Quantities that a scene does not have are left out. Sliding and flight of the block are shaded if a response tells
    its modes. Each response needs its history. horizon: time [s] at which point-wise comparison ends, if any.

    Examples
    --------
    >>> from analytic import load_scene, simulate
    >>> scene = load_scene("caryatid-rigid")
    >>> figure = draw_histories(scene, [simulate(scene)])  # figure.savefig("caryatid.svg") writes it
    >>> len(figure.axes)  # ground motion and tilt
    2
    """
    slides = any(response.sliding and response.sliding.peak for response in responses)
    rows = ["ground"] * (scene.motion is not None) + ["tilt"] + ["pedestal"] * scene.is_stack + ["slip"] * slides
    rows += ["displacement"] * (scene.base is not None)
    figure, axes = _empty_axes(rows, loop=scene.bearings is not None)
    end = max(response.end.time for response in responses)
    if scene.motion is not None:
        _draw_ground(axes["ground"], scene.motion, end)
    for response in responses:
        _draw_response(axes, scene, response, alone=len(responses) == 1)
    tilt = axes["tilt"]
    _draw_unstable(tilt, responses)
    if horizon is not None:
        for row in set(rows) - {"ground"}:
            axes[row].axvspan(horizon, end, color="0.93", zorder=-1, label="beyond the sensitivity horizon")
    for axis in [axes[row] for row in ("tilt", "pedestal") if row in axes]:
        low, high = axis.get_ylim()  # neither a tilt of 1e-6 nor an overturned block sets the scale
        axis.set_ylim(min(max(low, -TILT_RANGE[1]), -TILT_RANGE[0]), max(min(high, TILT_RANGE[1]), TILT_RANGE[0]))
    tilt.legend(fontsize="small", loc="best")
    if slides:
        _draw_modes(axes["slip"], responses)
    figure.suptitle(readable(scene.name, TITLE_CHARACTERS), parse_math=False)
    return figure


def _empty_axes(rows, loop):
    """Return (figure, {row: its axes over time, "loop": axes beside them if wanted}), labelled, without curves."""
    figure = Figure(figsize=(11 if loop else 8, 0.6 + 2.1 * len(rows)), layout="constrained")
    mosaic = [[row, "loop"] if loop else [row] for row in rows]
    axes = figure.subplot_mosaic(mosaic, width_ratios=[2, 1] if loop else None)
    for row in rows:
        axes[row].axhline(0, color="0.8", linewidth=0.8, zorder=0)
        axes[row].sharex(axes[rows[0]])
        axes[row].set_ylabel(LABELS.get(row, ""))
    axes[rows[-1]].set_xlabel("time [s]")
    if loop:
        axes["loop"].set(xlabel="base displacement [m]", ylabel="force of all bearings [kN]")
    return figure, axes


def _draw_response(axes, scene, response, alone):
    """Draw the curves of a response for which there are axes."""
    history, line = response.history, style(response.engine)
    if alone:
        line["linewidth"] = 1.2  # nothing to lie underneath
    label = f"{response.engine}, {response.variant}: {response.outcome_text}"
    curves = {"tilt": history.tilt / scene.block.slenderness, "slip": history.slip}
    if history.pedestal_tilt is not None:
        curves["pedestal"] = history.pedestal_tilt / StackModel.of(scene).slabs[LOWER].slenderness
    for row, values in {**curves, "displacement": history.base_displacement}.items():
        if row in axes and values is not None:
            axes[row].plot(history.time, values, label=label, **line)
    if "loop" in axes:
        axes["loop"].plot(history.base_displacement, history.bearing_force / 1e3, label=label, **line)


def _draw_unstable(axis, responses):
    """Draw the unstable point on either side, if a block comes near it."""
    dashed = {"color": "0.6", "linewidth": 0.8, "linestyle": (0, (4, 4)), "zorder": 0}
    if max(response.peak_tilt_ratio for response in responses) > 0.8:
        axis.axhline(-1, **dashed)
        axis.axhline(1, label="unstable point", **dashed)


def _draw_modes(axis, responses):
    """Shade where the block slides or flies, in the first response that tells its modes."""
    slider = next((response for response in responses if response.sliding and response.sliding.modes), None)
    labelled = set()
    for begin, end, mode in mode_spans(slider.sliding.modes, slider.end.time) if slider else ():
        words, look = SHADES.get(mode, (None, {}))
        if words:
            axis.axvspan(begin, end, zorder=-1, label=None if words in labelled else words, **look)
            labelled.add(words)
    if labelled:
        axis.legend(
            *(entries[-len(labelled) :] for entries in axis.get_legend_handles_labels()), fontsize="small", loc="best"
        )


def mode_spans(modes: Sequence[tuple[float, str]], end: float) -> Iterator[tuple[float, float, str]]:
    """Yield (begin [s], end [s], mode) of the modes of a block that may slide, in a run up to `end` [s]."""
    for (begin, mode), (until, _) in pairwise([*modes, (end, "")]):
        yield begin, until, mode


def _draw_ground(axis, motion, end):
    times = np.arange(0, end, motion.dt) if hasattr(motion, "dt") else np.linspace(0, end, 4001)
    axis.plot(times, motion.acceleration(times), color="0.35", linewidth=0.8)
    if motion.vertical is not None:
        axis.plot(times, motion.vertical.acceleration(times), color="0.65", linewidth=0.6, zorder=1, label="vertical")
        axis.legend(fontsize="small", loc="best")
    axis.set_ylabel("ground\nacceleration [m/s²]")
    axis.set_title(readable(motion.label, TITLE_CHARACTERS), fontsize="small", parse_math=False)


def picture(figure: Figure, kind: str) -> bytes:
    """Return a figure as the content of a file; kind: its format, one of `files.PICTURES`."""
    file = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a name in letters the font lacks is shown as boxes
        figure.savefig(file, format=kind.lower().removeprefix("."), dpi=150)
    return file.getvalue()


DAMPING = 0.05  # damping ratio of the spectrum, as usual in codes and catalogues
PERIODS = np.geomspace(0.05, 10.0, 150)  # s


def channel_words(channel: Channel) -> str:
    """Return number and direction of a channel, like "3 (Up)", as far as its file names them."""
    number, direction = channel.number, channel.direction
    return f"{number} ({direction})" if number and direction else number or direction


def described(channel: Channel) -> runs.Channel:
    """Return what was read of a channel, for JSON; peak and step are in SI units."""
    motion = channel.motion
    return runs.Channel(
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
    """Print a row for each channel of the file `name`, notes on reading, and warnings."""
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
    echo(
        grid(heads, rows, left=["units"], title=title),
        *notes,
        *(f"Warning: {readable(warning)}." for warning in warnings),
    )


def spectrum(motion: SampledMotion) -> np.ndarray:
    """Return the pseudo-acceleration omega^2 x [m/s2] of oscillators with `PERIODS` and damping `DAMPING`."""
    return (2 * np.pi / PERIODS) ** 2 * displacement_spectrum(motion, PERIODS, [DAMPING])[0]


def draw_channels(name: str, channels: Sequence[Channel]) -> Figure:
    """Draw each channel's acceleration over time and its response spectrum, in a row: a matplotlib Figure."""
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
