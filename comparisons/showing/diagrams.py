"""Free-body diagrams of the derivation, drawn to their angles: inline SVG in the page's colours."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path

from markupsafe import Markup

STYLE = Path(__file__).with_suffix(".css")  # rules of the drawings, in the colours of the page that shows them
GAMMA, PHI, R = 0.36, 0.17, 118.0  # rad, rad, pixels: stockier than a statue, to be read
ARROW = 46.0  # length of a force
SLAB = 62.0  # top of the base over the floor


class Drawing:
    """Parts of an SVG of a given size; y counts upward from the floor."""

    def __init__(self, width: float, height: float, floor: float, says: str) -> None:
        self.width, self.height, self.floor, self.says = width, height, floor, says
        self.parts: list[str] = []

    def at(self, x: float, y: float) -> tuple[float, float]:
        return round(x, 1), round(self.floor - y, 1)

    def polygon(self, points: list[tuple[float, float]], kind: str) -> None:
        places = " ".join("{},{}".format(*self.at(*point)) for point in points)
        self.parts.append(f'<polygon class="{kind}" points="{places}"/>')

    def line(self, start: tuple[float, float], end: tuple[float, float], kind: str = "line") -> None:
        (x0, y0), (x1, y1) = self.at(*start), self.at(*end)
        self.parts.append(f'<line class="{kind}" x1="{x0}" y1="{y0}" x2="{x1}" y2="{y1}"/>')

    def arrow(
        self, start: tuple[float, float], by: tuple[float, float], label: str, aside: tuple[float, float]
    ) -> None:
        end = start[0] + by[0], start[1] + by[1]
        length = math.hypot(*by)
        u, v = by[0] / length, by[1] / length
        back = end[0] - 9 * u, end[1] - 9 * v
        self.line(start, back, "force")
        self.polygon([end, (back[0] - 4.5 * v, back[1] + 4.5 * u), (back[0] + 4.5 * v, back[1] - 4.5 * u)], "tip")
        self.text((end[0] + aside[0], end[1] + aside[1]), label, "f")

    def text(self, place: tuple[float, float], words: str, kind: str = "") -> None:
        x, y = self.at(*place)
        base, _, below = words.partition("_")
        below, _, rest = below.partition(" ")
        sub = (
            f'<tspan dy="4" font-size="11">{escape(below)}</tspan><tspan dy="-4"> {escape(rest)}</tspan>'
            if below
            else ""
        )
        self.parts.append(f'<text class="{kind}" x="{x}" y="{y}">{escape(base)}{sub}</text>')

    def dot(self, place: tuple[float, float]) -> None:
        x, y = self.at(*place)
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="3.5" fill="var(--ink)"/>')

    def arc(self, middle: tuple[float, float], radius: float, begin: float, end: float) -> None:
        """From the angle `begin` to `end`, both from the vertical, clockwise [rad]."""
        ends = [(middle[0] + radius * math.sin(a), middle[1] + radius * math.cos(a)) for a in (begin, end)]
        (x0, y0), (x1, y1) = self.at(*ends[0]), self.at(*ends[1])
        self.parts.append(f'<path class="line" d="M{x0} {y0}A{radius} {radius} 0 0 {int(end > begin)} {x1} {y1}"/>')

    def block(
        self, pivot: tuple[float, float], tilt: float, half: float, height: float, side: int = 1
    ) -> list[tuple[float, float]]:
        """A block turned clockwise by `tilt` [rad] about its right corner (side 1) or its left one (-1).

        Returns its corners: those of the foot from left to right, then those of the top from right to left.
        """
        c, s = math.cos(tilt), math.sin(tilt)
        corners = [(x - side * half, y) for x, y in ((-half, 0), (half, 0), (half, height), (-half, height))]
        turned = [(pivot[0] + x * c + y * s, pivot[1] - x * s + y * c) for x, y in corners]
        self.polygon(turned, "stone")
        return turned

    def svg(self) -> Markup:
        body = "".join(self.parts)
        return Markup(
            f'<svg viewBox="0 0 {self.width:g} {self.height:g}" role="img" aria-label="{escape(self.says)}" '
            f'stroke-width="1.6">{body}</svg>'
        )


def labelled() -> Markup:
    """The block upright with its sizes, and tilted: what each symbol stands for."""
    return _labelled(False)


def labelled_on_bearings() -> Markup:
    """The same on a base with its bearings."""
    return _labelled(True)


def _labelled(on_bearings: bool) -> Markup:
    where = "on a base with bearings, displaced by x" if on_bearings else "on the ground"
    drawing = Drawing(
        520,
        370 if on_bearings else 310,
        330 if on_bearings else 270,
        f"A block of width 2b and height 2h {where}, upright and tilted by φ about its corner O: its centre of mass is "
        "R from O, at the angle γ to its side",
    )
    b, h, floor = R * math.sin(GAMMA), R * math.cos(GAMMA), SLAB if on_bearings else 0.0
    drawing.line((10, 0), (510, 0))
    if on_bearings:
        _base(drawing, (70, 224), 0.0)
        _base(drawing, (330, 484), 4.0)
        drawing.text((196, 45), "m_b")
        drawing.arrow((484, 48), (22, 0), "x", (-8, 8))
        drawing.text((376, 14), "n_d , f")
    corner = (130.0 + b, floor)
    centre = _block(drawing, corner, 0.0)
    drawing.line(corner, centre, "thin")
    drawing.arc(corner, 74, 0, -GAMMA)
    drawing.text((corner[0] - 18, floor + 80), "γ")
    drawing.text((corner[0] - 38, floor + 50), "R")
    drawing.text((centre[0] - 22, centre[1] + 4), "m")
    drawing.text((corner[0] + 5, floor + 5), "O")
    drawing.line((centre[0], floor - 9), (corner[0], floor - 9), "size")
    drawing.text((centre[0] + b / 2 - 4, floor - 25), "b")
    drawing.line((corner[0] + 24, floor), (corner[0] + 24, floor + h), "size")
    drawing.text((corner[0] + 30, floor + h / 2), "h")
    drawing.line(centre, (corner[0] + 28, centre[1]), "thin")
    corner = (420.0, floor)
    centre = _block(drawing, corner, PHI)
    drawing.line(corner, (corner[0], floor + 2 * h), "thin")
    drawing.arc(corner, 180, 0, PHI)
    drawing.text((corner[0] + 10, floor + 190), "φ")
    drawing.text((corner[0] + 5, floor + 5), "O")
    drawing.text((corner[0] + 26, floor + 22), "J_O")
    drawing.arrow((10, 22), (42, 0), "a_g", (-22, 8))
    return drawing.svg()


def _base(drawing: Drawing, ends: tuple[float, float], shift: float) -> None:
    """A slab between `ends` on two bearings, sheared by `shift` per layer."""
    for left in (ends[0] + 8 - 4 * shift, ends[1] - 50 - 4 * shift):
        for layer in range(4):
            x, y = left + shift * layer, 9.0 * layer
            drawing.polygon([(x, y), (x + 30, y), (x + 30, y + 9), (x, y + 9)], "steel" if layer % 2 else "stone")
    drawing.polygon([(ends[0], 36), (ends[1], 36), (ends[1], SLAB), (ends[0], SLAB)], "steel")


def _block(drawing: Drawing, corner: tuple[float, float], tilt: float) -> tuple[float, float]:
    """The block, turned clockwise by `tilt` about its right corner; returns its centre."""
    b, h = R * math.sin(GAMMA), R * math.cos(GAMMA)
    left, _, above, _ = drawing.block(corner, tilt, b, 2 * h)
    centre = (left[0] + above[0]) / 2, (left[1] + above[1]) / 2
    drawing.dot(centre)
    return centre


def rocking() -> Markup:
    """The block about its right corner, with all that acts on it."""
    drawing = Drawing(
        400, 330, 285, "A block tilted about its right corner: weight, inertia force and the corner’s forces"
    )
    corner = (220.0, 0.0)
    drawing.line((30, 0), (370, 0))
    centre = _block(drawing, corner, PHI)
    drawing.line(corner, centre, "thin")
    drawing.line(corner, (corner[0], 175), "thin")
    drawing.arc(corner, 96, 0, PHI - GAMMA)
    drawing.text((corner[0] + 21, 90), "γ − φ")
    drawing.text((corner[0] - 24, 40), "R")
    drawing.arrow(centre, (0, -ARROW), "mg", (-26, 4))
    drawing.arrow(centre, (-ARROW, 0), "m a_g", (-34, 8))
    drawing.arrow((corner[0] + 26, -32), (0, 30), "N", (6, -16))
    drawing.arrow((corner[0] + 46, 0), (-42, 0), "H", (46, 7))
    drawing.text((corner[0] + 4, -18), "O")
    return drawing.svg()


def impact() -> Markup:
    """The impact: the old corner lifts, the impulse acts at the new one."""
    drawing = Drawing(400, 330, 275, "The block upright at the impact: the impulse acts at the new corner on the left")
    b, h = R * math.sin(GAMMA), R * math.cos(GAMMA)
    corner = (200 + b, 0.0)
    drawing.line((30, 0), (370, 0))
    centre = _block(drawing, corner, 0.0)
    new = (200 - b, 0.0)
    drawing.line(new, centre, "thin")
    drawing.arrow((new[0], -48), (0, 44), "P_N", (8, -24))
    drawing.arrow((new[0] - 52, 0), (48, 0), "P_H", (-48, 8))
    drawing.text((new[0] + 6, 8), "O′")
    drawing.text((corner[0] + 6, 8), "O")
    # the centre's velocity before: about the old corner
    u = R * 0.42
    drawing.arrow(centre, (-u * math.cos(GAMMA), -u * math.sin(GAMMA)), "R ω_−", (-30, -16))
    drawing.line((200, -10), (corner[0], -10), "thin")
    drawing.text(((200 + corner[0]) / 2 - 3, -26), "b")
    drawing.line((corner[0] + 34, 0), (corner[0] + 34, h), "thin")
    drawing.text((corner[0] + 40, h / 2), "h")
    return drawing.svg()


def isolated() -> Markup:
    """The block on its base: what passes between them, and the bearings' force."""
    drawing = Drawing(400, 370, 330, "The block on a base that moves by x; the bearings push back")
    _base(drawing, (104, 312), 4.0)
    drawing.line((30, 0), (370, 0))
    corner = (232.0, SLAB)
    centre = _block(drawing, corner, PHI)
    drawing.line(corner, centre, "thin")
    drawing.arrow(centre, (0, -ARROW), "mg", (-26, 4))
    drawing.arrow((104, 48), (-54, 0), "n_d f", (-12, 12))
    drawing.arrow((312, 48), (40, 0), "x", (5, -5))
    drawing.text((286, 45), "m_b")
    drawing.text((corner[0] + 6, SLAB + 6), "O")
    return drawing.svg()
