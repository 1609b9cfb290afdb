"""Charts as inline SVG, in the page's colours, with text elements and values that a script can read.

A solver keeps its colour, dashes and marker in all charts (`engines.ENGINES`). The page hides a group of the class
"who" by its ``data-who``, which begins with the engine's name: "exudyn" or "exudyn, native-contact". Figures of a
study's rows are made in `comparisons.plotting.figures`. The unit of sizes is 1/`WIDTH` of a phone's width: lettering of
13 is 11.6 px at 390 px.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup
from matplotlib.ticker import LogLocator, MaxNLocator

from engines import ENGINES

from ..schemas.columns import power_of_ten
from .parts import Figure, templates
from .plots import OTHERS, marker

DRAWN = templates(Path(__file__).parent).get_template("chart.html")
STYLE = Path(__file__).with_name("charts.css")  # colours of pages, light and dark, and the rules of charts
WIDTH = 400
LETTER = 13
REFERENCE = "analytic"
INK = 25  # % of the page's ink in a solver's colour: so much gives each a contrast of 3.4 or more, light and dark
HAIR = 0.5  # overlap of neighbouring cells of a map, so that rounding leaves no gap between them
DASHES = {"-": "", "--": "7 4", ":": "2 3.5", "-.": "8 3 2 3"}
SHAPES = {
    "o": "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z",
    "s": "M-3.7-3.7h7.4v7.4h-7.4z",
    "D": "M0-5L5 0 0 5-5 0z",
    "^": "M0-5L4.6 3.6h-9.2z",
    "v": "M0 5L4.6-3.6h-9.2z",
    "P": "M-1.6-4.6h3.2v3h3v3.2h-3v3h-3.2v-3h-3v-3.2h3z",
    "x": "M-4-4L4 4M4-4L-4 4",
    "X": "M-4.5-2.5l2-2 2.5 2.5 2.5-2.5 2 2-2.5 2.5 2.5 2.5-2 2-2.5-2.5-2.5 2.5-2-2 2.5-2.5z",
    "|": "M0-6V6",
}
OUTWARD = "M6.5-3.5L10 0 6.5 3.5"  # arrowhead of a mark at the frame whose value lies beyond it


class Look(NamedTuple):
    """Colour (`tone`), dashes and mark of one of several curves of a solver."""

    tone: str
    dashes: str
    mark: str


# Tol's "bright", which colour-blind readers tell apart, with yellow and cyan darkened; none is an engine's colour. In
# print dashes and marks tell curves apart. Twelve curves differ; no chart can show more.
TONES = ("#4477AA", "#EE6677", "#228833", "#AA3377", "#B8A42E", "#3FA7C4")


def curve(rank: int) -> Look:
    """Return the look of the first, second, ... curve of a solver that is alone in its chart."""
    dashes, marks = list(DASHES.values()), [mark for mark in SHAPES if mark != "x"]
    turn, place = divmod(rank, len(TONES))
    return Look(_inked(TONES[place]), dashes[(turn + rank) % len(dashes)], marks[rank % len(marks)])


@dataclass(frozen=True)
class Axis:
    """label: with unit. low, high: ends. scale: "linear" or "log". ticks: (value, word) in place of round values."""

    label: str
    low: float
    high: float
    scale: str = "linear"
    ticks: tuple[tuple[float, str], ...] | None = None

    def share(self, values: Iterable[float]) -> np.ndarray:
        """Return where values lie between the ends, 0 to 1; shape as the values."""
        transform = np.log10 if self.scale == "log" else np.asarray
        low, high = (float(transform(end)) for end in (self.low, self.high))
        with np.errstate(divide="ignore"):
            return (transform(np.asarray(values, dtype=float)) - low) / (high - low)

    def marks(self) -> tuple[tuple[float, str], ...]:
        """Return (value, word) of its ticks."""
        if self.ticks is not None:
            return self.ticks
        if self.scale == "log":
            values = LogLocator(numticks=7).tick_values(self.low, self.high)
            words = [power_of_ten(value) for value in values]
        else:
            values = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]).tick_values(self.low, self.high)
            words = [f"{round(value, 12):g}".replace("-", "−") for value in values]
        within = (-1e-9, 1 + 1e-9)
        return tuple(
            (float(value), word)
            for value, word in zip(values, words, strict=True)
            if within[0] <= self.share([value])[0] <= within[1]
        )


def log_axis(label: str, values: Iterable[float]) -> Axis:
    """Return an axis of whole decades about the positive ones of these values."""
    positive = [value for value in values if value and value > 0]
    low, high = math.floor(math.log10(min(positive))), math.ceil(math.log10(max(positive)))
    return Axis(label, 10.0**low, 10.0 ** max(high, low + 1), "log")


class Chart:
    """One panel. says: a description for readers who cannot see it. left, right, head, foot: margins.

    width: `WIDTH`, or more for a panel that no phone shows. turned: whether words below the axis stand upright.
    """

    def __init__(
        self,
        x: Axis,
        y: Axis,
        says: str,
        *,
        height: int = 270,
        left: int = 64,
        right: int = 14,
        foot: int | None = None,
        head: int = 0,
        title: str = "",
        width: int = WIDTH,
        turned: bool = False,
    ) -> None:
        self.x, self.y, self.says, self.title, self.width, self.turned = x, y, says, title, width, turned
        self.left, self.right = left, width - right
        self.top, self.bottom = (30 if title else 12) + head, height - (foot or (46 if x.label else 28))
        self.height, self.parts, self.over = height, list[str](), list[str]()
        self.ends: list[tuple[float, str, str]] = []

    def at(self, xs: Sequence[float] | np.ndarray, ys: Sequence[float] | np.ndarray) -> np.ndarray:
        """Return the places of values in the drawing, shape (points, 2)."""
        across = self.left + self.x.share(xs) * (self.right - self.left)
        return np.column_stack([across, self.bottom - self.y.share(ys) * (self.bottom - self.top)])

    def line(
        self,
        xs: Sequence[float] | np.ndarray,
        ys: Sequence[float] | np.ndarray,
        who: str = "",
        *,
        grey: bool = False,
        tone: str = "",
        look: Look | None = None,
        thin: bool = False,
    ) -> None:
        """Draw a line of a solver, or in a colour `tone`; look: for one of several curves. It breaks at nan and inf."""
        places = self.at(xs, ys).round(1)
        moved = np.append(True, (np.diff(places, axis=0) != 0).any(axis=1))[: len(places)]
        places = places[moved]
        sound = np.isfinite(places).all(axis=1)
        begins = sound & ~np.append(False, sound)[:-1]
        pairs = zip(places[sound], begins[sound], strict=True)
        path = "".join(f"{'M' if begin else 'L'}{x:g} {y:g}" for (x, y), begin in pairs)
        self.parts.append(f'{_group(who, grey, tone, look)}<path class="line{" thin" * thin}" d="{path}"/></g>')

    def dots(
        self,
        xs: Sequence[float] | np.ndarray,
        ys: Sequence[float] | np.ndarray,
        who: str = "",
        *,
        filled: bool = True,
        small: bool = False,
        grey: bool = False,
        says: Sequence[str] | None = None,
        mark: str | None = None,
        tone: str = "",
        beyond: bool = False,
        look: Look | None = None,
    ) -> None:
        """Draw marks of a solver; says: the words of each under the pointer. look: for one of several curves.

        beyond: whether values outside the panel stand at its frame, with an arrowhead; else they are left out.
        """
        shape, kind = _mark(who, filled, look.mark if look else mark), "dot" if filled else "dot open"
        texts = says or [""] * len(xs)
        marks = []
        for (x, y), words in zip(self.at(xs, ys), texts, strict=True):
            at = min(max(x, self.left), self.right), min(max(y, self.top), self.bottom)
            outside = math.hypot(x - at[0], y - at[1]) > 1
            if outside and beyond:
                angle = math.degrees(math.atan2(np.sign(round(y - at[1], 1)), np.sign(round(x - at[0], 1))))
                arrow = f'<path class="beyond" transform="{_translation(*at, False)}rotate({angle:g})" d="{OUTWARD}"/>'
                marks.append(arrow)
            if beyond or not outside:
                marks.append(
                    f'<path class="{kind}" transform="{_translation(*at, small)}" d="{shape}"{_pointer_words(words)}/>'
                )
        self.over.append(f"{_group(who, grey, tone, look)}{''.join(marks)}</g>")

    def reach(self, xs: Sequence[float], ys: Sequence[float], lows: Sequence[float], highs: Sequence[float],
              who: str = "", *, along: str = "y", grey: bool = False, tone: str = "", look: Look | None = None
              ) -> None:  # fmt: skip
        """Draw intervals from `lows` to `highs` along an axis; look: for one of several curves."""
        begins, ends = (self.at(xs, values) if along == "y" else self.at(values, ys) for values in (lows, highs))
        path = "".join(f"M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" for a, b in zip(begins, ends, strict=True))
        self.parts.append(f'{_group(who, grey, tone, look)}<path class="reach" d="{path}"/></g>')

    def area(self, xs: Sequence[float], ys: Sequence[float], kind: str) -> None:
        """Draw a filled polygon below all lines; kind: its class."""
        places = " ".join(f"{x:.1f},{y:.1f}" for x, y in self.at(xs, ys))
        self.parts.insert(0, f'<polygon class="{kind}" points="{places}"/>')

    def rule(self, value: float, along: str = "x") -> None:
        """Draw a dashed line across at a value of x or y; `heading` and `label` name it outside the panel."""
        upright = along == "x"
        x, y = self.at([value if upright else self.x.low], [self.y.low if upright else value])[0]
        path = f"M{x:.1f} {self.top}V{self.bottom}" if upright else f"M{self.left} {y:.1f}H{self.right}"
        self.parts.append(f'<path class="rule" d="{path}"/>')

    def heading(self, x: float, words: str, line: int = 0) -> None:
        """Write words above the panel at a value of x, `line` lines up; they need room there (head)."""
        place, height = self.at([x], [self.y.low])[0][0], self.top - 5 - line * (LETTER + 3)
        anchor = "middle" if self.left + 60 < place < self.right - 60 else "start" if place < self.right - 60 else "end"
        self.over.append(
            f'<text x="{place:.1f}" y="{height}" class="soft" text-anchor="{anchor}">{escape(words)}</text>'
        )

    def beside(self, x: float, y: float, words: str, **how: Any) -> None:
        """Write words beside a point; how: keywords of `named`."""
        self.named(self.at([x], [y])[0], words, **how)

    def named(self, place: Sequence[float], words: str, who: str = "", *, aside: tuple[float, float] = (6, 4.5),
              anchor: str = "start", kind: str = "soft") -> None:  # fmt: skip
        """Write words beside a place, in a solver's colour; aside: offset of their begin, end or middle (`anchor`)."""
        x, y = place[0] + aside[0], place[1] + aside[1]
        text = f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{kind}">{escape(words)}</text>'
        self.over.append(f"{_group(who, False)}{text}</g>" if who else text)

    def lead(self, begin: Sequence[float], end: Sequence[float], who: str) -> None:
        """Draw a thin line from a name to what it names, in a solver's colour."""
        path = f"M{begin[0]:.1f} {begin[1]:.1f}L{end[0]:.1f} {end[1]:.1f}"
        self.over.append(f'{_group(who, False)}<path class="lead" d="{path}"/></g>')

    def bar(self, low: float, high: float, place: float, who: str, kind: str, says: str = "") -> None:
        """Draw a bar along x at a place on y; kind: its class."""
        (x0, y), (x1, _) = self.at([low, high], [place, place])
        box = f'x="{x0:.1f}" y="{y - 5.5:.1f}" width="{x1 - x0:.1f}" height="11"'
        self.parts.append(f'{_group(who, False)}<rect class="{kind}" {box}{_pointer_words(says)}/></g>')

    def label(self, y: float, text: str, who: str = "", tone: str = "", look: Look | None = None) -> None:
        """Write the name of a line in the right margin, at the height where the line ends."""
        self.ends.append((float(self.at([self.x.low], [y])[0][1]), text, _group(who, False, tone, look)))

    def legend(self, keys: Sequence[tuple[str, str]]) -> None:
        """Write (picture, words) above the panel, which needs `legend_height` more room there (head).

        A picture is drawn about (0, 0), at most 24 wide.
        """
        for line, row in enumerate(_legend_rows(keys, self.width), start=bool(self.title)):
            y = 14 + 20 * line
            for x, picture, words in row:
                self.over.append(f'<g transform="translate({x + 14} {y - 4.5})" style="--c:var(--soft)">{picture}</g>')
                self.over.append(f'<text x="{x + 30}" y="{y}" class="soft">{escape(words)}</text>')

    def cell(self, x: float, y: float, kind: str, sign: str, says: str) -> None:
        """Draw a cell of a matrix about (x, y), cells one apart, with a sign in it; kind: its class."""
        (x0, y0), (x1, y1) = self.at([x - 0.46, x + 0.46], [y - 0.44, y + 0.44])
        self.parts.append(
            f'<rect class="{kind}" x="{min(x0, x1):.1f}" y="{min(y0, y1):.1f}" width="{abs(x1 - x0):.1f}" '
            f'height="{abs(y1 - y0):.1f}"{_pointer_words(says)}/>'
        )
        self.over.append(
            f'<text class="sign {kind}" x="{(x0 + x1) / 2:.1f}" y="{(y0 + y1) / 2 + 4.5:.1f}" '
            f'text-anchor="middle">{escape(sign)}</text>'
        )

    def cells(self, xs: np.ndarray, ys: np.ndarray, chosen: np.ndarray, kind: str, who: str) -> None:
        """Draw the chosen cells of a map, a rectangle for each run along y. kind: their class.

        xs, ys: centres, evenly spaced. chosen: bool, shape (xs, ys). who: the name by which a reader hides them.
        """
        half = np.array([xs[1] - xs[0], ys[1] - ys[0]]) / 2
        turns = np.diff(np.pad(chosen.astype(int), ((0, 0), (1, 1))))
        begins, ends = np.argwhere(turns == 1), np.argwhere(turns == -1) - [0, 1]
        low = self.at(xs[begins[:, 0]] - half[0], ys[begins[:, 1]] - half[1])
        high = self.at(xs[ends[:, 0]] + half[0], ys[ends[:, 1]] + half[1])
        rectangles = "".join(
            f'<rect class="{kind}" x="{a[0]:.1f}" y="{b[1]:.1f}" width="{b[0] - a[0] + HAIR:.1f}" '
            f'height="{a[1] - b[1] + HAIR:.1f}"/>'
            for a, b in zip(low, high, strict=True)
        )
        self.parts.append(f'<g class="who" data-who="{escape(who)}" shape-rendering="crispEdges">{rectangles}</g>')

    def svg(self) -> str:
        """Return the panel as an SVG element."""
        read = {"x": _scale_of(self.x, self.left, self.right), "y": _scale_of(self.y, self.bottom, self.top)}
        across, up = self.x.marks(), self.y.marks()
        xs = self.at([value for value, _ in across], [self.y.low] * len(across))[:, 0].round(1).tolist()
        ys = self.at([self.x.low] * len(up), [value for value, _ in up])[:, 1].round(1).tolist()
        return DRAWN.render(
            chart=self,
            read=json.dumps(read, ensure_ascii=False),
            across=[(x, word) for x, (_, word) in zip(xs, across, strict=True)],
            up=[(y, word) for y, (_, word) in zip(ys, up, strict=True)],
            slanted=slanting([word for _, word in across], self.right - self.left),
            labels=self._labels(),
            begin=max(0, min(self.left, self.width - round(0.64 * LETTER * len(self.title)))),  # of the title
        )

    def _labels(self):
        """Return (height, name, opening of its group) of the names of lines, pushed apart."""
        placed, last = [], -math.inf
        for y, text, opening in sorted(self.ends):
            last = max(y, last + LETTER + 2)
            placed.append((last, text, opening))
        lowest: float = self.bottom  # names that are then below the panel are pushed back, as little as needed
        for place, (y, text, opening) in reversed(list(enumerate(placed))):
            placed[place] = min(y, lowest), text, opening
            lowest = placed[place][0] - LETTER - 2
        return placed


def _legend_rows(keys: Sequence[tuple[str, str]], width: int) -> list[list[tuple[int, str, str]]]:
    """Return rows of (x, picture, words) that fit into a chart's width."""
    rows, end = list[list[tuple[int, str, str]]](), width
    for picture, words in keys:
        long = 40 + round(LETTER * 0.57 * len(words))
        if end + long > width:
            rows, end = [*rows, []], 0
        rows[-1].append((end, picture, words))
        end += long
    return rows


def legend_height(keys: Sequence[tuple[str, str]], width: int) -> int:
    """Return the height of a legend above a panel."""
    return 20 * len(_legend_rows(keys, width))


def slanting(words: Sequence[str], width: float) -> bool:
    """Return whether words below an axis of this width must slant."""
    return LETTER * 0.55 * sum(len(word) + 1 for word in words) > width


def room(words: Iterable[str], least: float = 0) -> int:
    """Return the width that the longest of these words takes beside an axis; at least `least`."""
    return round(max(12 + LETTER * 0.55 * max(map(len, words), default=0), least))


def colour(who: str) -> str:
    """Return the colour of a solver as CSS; the model's is the page's ink."""
    others = "var(--ink)" if engine_of(who) == REFERENCE else "var(--soft)"
    return _inked(ENGINES[engine_of(who)].colour) if engine_of(who) in ENGINES else others


def _inked(tone):
    return f"color-mix(in srgb, {tone} {100 - INK}%, var(--ink))"


def engine_of(who: str) -> str:
    """Return the engine of a name like "exudyn, native-contact"."""
    return who.partition(", ")[0]


def key_of(who: str, *, filled: bool = True, small: bool = False, joined: bool = True, look: Look | None = None) -> str:
    """Return a small picture of a solver's line and marker, for a legend."""
    kind = "dot" if filled else "dot open"
    shape = _mark(who, filled, look and look.mark)
    mark = f'<path class="{kind}" transform="{_translation(16, 7, small)}" d="{shape}"/>'
    line = '<path class="line" d="M1 7H31"/>' if joined else ""
    return (
        f'<svg class="chart mini" viewBox="0 0 32 14" aria-hidden="true">{_group(who, False, look=look)}'
        f"{line}{'' if engine_of(who) == REFERENCE and not look else mark}</g></svg>"
    )


def figure(
    charts: Sequence[Chart], caption: str, solvers: Iterable[str] = (), keys: Mapping[str, str] | None = None
) -> Figure:
    """Return the `Figure` of one or more panels. solvers: in its legend. keys: their pictures, if not of `key_of`."""
    return Figure(
        "".join(chart.svg() for chart in charts).encode(),
        " ".join(chart.says for chart in charts),
        caption,
        solvers=tuple(dict.fromkeys(solvers)),
        keys={name: Markup(key) for name, key in (keys or {}).items()},
    )


def broad(wide: Chart, narrow: Sequence[Chart], caption: str) -> Figure:
    """Return the `Figure` of a chart that takes the width of a page, and of the charts that replace it on a phone."""
    small = "".join(chart.svg() for chart in narrow)
    svg = f'<div class="wide">{wide.svg()}</div><div class="narrow">{small}</div>'
    return Figure(svg.encode(), wide.says, caption, broad=True)


def alone(svg: str) -> str:
    """Return a chart's element as a file of its own, light or dark by the reader's choice."""
    named = svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)
    opening, rest = named[: named.index(">") + 1], named[named.index(">") + 1 :]
    paper = ":root { background: var(--paper); }"  # readable on any page
    return f"{opening}<style>{STYLE.read_text(encoding='utf-8')}{paper}</style>{rest}\n"


def _scale_of(axis, begin, end):
    """Return what the page's script needs to turn a place into a value."""
    return {"label": axis.label, "low": axis.low, "high": axis.high, "log": axis.scale == "log", "at": [begin, end]}


def _pointer_words(words):
    return f' data-says="{escape(words)}"' if words else ""


def _mark(who, filled, mark=None):
    """Return the shape of a solver's mark; an open cross becomes a disc, as a cross has no inside."""
    shape = mark or marker(engine_of(who))
    return SHAPES["o" if shape == "x" and not filled else shape] if shape in SHAPES else SHAPES["o"]


def _translation(x, y, small):
    return f"translate({x:.1f} {y:.1f})" + ("scale(.55)" if small else "")


def _group(who, grey, tone="", look=None):
    """Return the opening tag of a group in a solver's colour and dashes, or in another colour, or look."""
    if not who:
        return f'<g class="who" style="--c:{tone}">' if tone else '<g class="who">'
    drawn, dashes = (look.tone, look.dashes) if look else (colour(who), _dashes(engine_of(who)))
    drawn = "var(--faint)" if grey else drawn
    return f'<g class="who" data-who="{escape(who)}" style="--c:{drawn};--d:{dashes or "none"}">'


def _dashes(who):
    dashes = ENGINES[who].dashes if who in ENGINES else OTHERS.get(who, ("-", ""))[0]
    return DASHES.get(dashes, "") if isinstance(dashes, str) else " ".join(f"{part:g}" for part in dashes[1])
