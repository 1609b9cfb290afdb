"""Drawings and formulas of pages: free-body diagrams, modes of a sliding block, TeX as MathML.

Drawings are inline SVG in the page's colours, drawn to their angles. Formulas are in the small part of TeX that the
pages use; browsers draw MathML without a script.
"""

import math
import re
from collections.abc import Iterator
from functools import partial
from html import escape
from pathlib import Path

from markupsafe import Markup

from analytic.kernel.layout import FLIGHT, MODES, ROCK, SLIDE, SLIDE_ROCK, STICK

STYLE = Path(__file__).with_suffix(".css")  # rules of the drawings, in the colours of the page that shows them
GAMMA, PHI, R = 0.36, 0.17, 118.0  # rad, rad, pixels: stockier than a statue, so that angles can be read
B, H = R * math.sin(GAMMA), R * math.cos(GAMMA)
ARROW = 46.0  # length of a force
SLAB = 62.0  # top of the base over the floor
Place = tuple[float, float]


class Drawing:
    """Builder of an SVG of a given size; its methods return parts. y counts upward from the floor."""

    def __init__(self, width: float, height: float, floor: float, says: str) -> None:
        self.width, self.height, self.floor, self.says = width, height, floor, says

    def at(self, x: float, y: float) -> Place:
        return round(x, 1), round(self.floor - y, 1)

    def polygon(self, points: list[Place], kind: str) -> str:
        places = " ".join("{},{}".format(*self.at(*point)) for point in points)
        return f'<polygon class="{kind}" points="{places}"/>'

    def line(self, start: Place, end: Place, kind: str = "line") -> str:
        (x0, y0), (x1, y1) = self.at(*start), self.at(*end)
        return f'<line class="{kind}" x1="{x0}" y1="{y0}" x2="{x1}" y2="{y1}"/>'

    def shaft(self, start: Place, by: Place, size: float, kind: str, tip: str) -> str:
        """Return an arrow from `start` by a vector; size: length of its tip; kind, tip: classes of line and tip."""
        (x, y), length = (start[0] + by[0], start[1] + by[1]), math.hypot(*by)
        u, v = by[0] / length, by[1] / length
        (a, b), half = (x - size * u, y - size * v), size / 2
        corners = [(x, y), (a - half * v, b + half * u), (a + half * v, b - half * u)]
        return self.line(start, (a, b), kind) + self.polygon(corners, tip)

    def arrow(self, start: Place, by: Place, label: str, aside: Place) -> str:
        """Return the arrow of a force or motion, with a label at `aside` from its tip."""
        place = start[0] + by[0] + aside[0], start[1] + by[1] + aside[1]
        return self.shaft(start, by, 9, "force", "tip") + self.text(place, label, "f")

    def text(self, place: Place, words: str, kind: str = "") -> str:
        x, y = self.at(*place)
        base, _, below = words.partition("_")
        below, _, rest = below.partition(" ")
        sub = (
            f'<tspan dy="4" font-size="11">{escape(below)}</tspan><tspan dy="-4"> {escape(rest)}</tspan>'
            if below
            else ""
        )
        return f'<text class="{kind}" x="{x}" y="{y}">{escape(base)}{sub}</text>'

    def arc(self, middle: Place, radius: float, begin: float, end: float) -> str:
        """Return an arc from the angle `begin` to `end`, both from the vertical, clockwise [rad]."""
        ends = [(middle[0] + radius * math.sin(a), middle[1] + radius * math.cos(a)) for a in (begin, end)]
        (x0, y0), (x1, y1) = self.at(*ends[0]), self.at(*ends[1])
        return f'<path class="line" d="M{x0} {y0}A{radius} {radius} 0 0 {int(end > begin)} {x1} {y1}"/>'

    def block(self, pivot: Place, tilt: float, half: float, height: float, side: int = 1) -> str:
        """Return a block turned clockwise by `tilt` [rad] about its right corner (side 1) or its left one (-1)."""
        corners = [(x - side * half, y) for x, y in ((-half, 0), (half, 0), (half, height), (-half, height))]
        return self.polygon([_turned(pivot, corner, tilt) for corner in corners], "stone")

    def centred(self, corner: Place, tilt: float) -> str:
        """Return the block with its centre, turned clockwise by `tilt` [rad] about its right corner."""
        x, y = self.at(*_centre(corner, tilt))
        return f'{self.block(corner, tilt, B, 2 * H)}<circle cx="{x}" cy="{y}" r="3.5" fill="var(--ink)"/>'

    def base(self, ends: Place, shift: float) -> Iterator[str]:
        """Yield a slab between `ends` on two bearings, sheared by `shift` per layer."""
        for left in (ends[0] + 8 - 4 * shift, ends[1] - 50 - 4 * shift):
            for layer in range(4):
                x, y = left + shift * layer, 9.0 * layer
                corners = [(x, y), (x + 30, y), (x + 30, y + 9), (x, y + 9)]
                yield self.polygon(corners, "steel" if layer % 2 else "stone")
        yield self.polygon([(ends[0], 36), (ends[1], 36), (ends[1], SLAB), (ends[0], SLAB)], "steel")

    def svg(self, *parts: str) -> Markup:
        return Markup(
            f'<svg viewBox="0 0 {self.width:g} {self.height:g}" role="img" aria-label="{escape(self.says)}" '
            f'stroke-width="1.6">{"".join(parts)}</svg>'
        )


def _turned(pivot: Place, by: Place, tilt: float) -> Place:
    """Return the place at `by` from a pivot after a clockwise turn about it."""
    c, s = math.cos(tilt), math.sin(tilt)
    return pivot[0] + by[0] * c + by[1] * s, pivot[1] - by[0] * s + by[1] * c


def _centre(corner: Place, tilt: float) -> Place:
    """Return the block's centre, half-way between its left foot and its right shoulder."""
    left, above = _turned(corner, (-2 * B, 0), tilt), _turned(corner, (0, 2 * H), tilt)
    return (left[0] + above[0]) / 2, (left[1] + above[1]) / 2


def labelled(on_bearings: bool = False) -> Markup:
    """Draw the block upright with its sizes, and tilted: the meaning of each symbol."""
    where = "on a base with bearings, displaced by x" if on_bearings else "on the ground"
    drawing = Drawing(
        520,
        370 if on_bearings else 310,
        330 if on_bearings else 270,
        f"A block of width 2b and height 2h {where}, upright and tilted by φ about its corner O: its centre of mass is "
        "R from O, at the angle γ to its side",
    )
    floor = SLAB if on_bearings else 0.0
    upright, tilted = (130.0 + B, floor), (420.0, floor)
    (x, y), (u, v), (right, _) = upright, _centre(upright, 0.0), tilted
    bearings = (
        *drawing.base((70, 224), 0.0),
        *drawing.base((330, 484), 4.0),
        drawing.text((196, 45), "m_b"),
        drawing.arrow((484, 48), (22, 0), "x", (-8, 8)),
        drawing.text((376, 14), "n_d , f"),
    )
    return drawing.svg(
        drawing.line((10, 0), (510, 0)),
        *(bearings if on_bearings else ()),
        drawing.centred(upright, 0.0),
        drawing.line(upright, (u, v), "thin"),
        drawing.arc(upright, 74, 0, -GAMMA),
        drawing.text((x - 18, y + 80), "γ"),
        drawing.text((x - 38, y + 50), "R"),
        drawing.text((u - 22, v + 4), "m"),
        drawing.text((x + 5, y + 5), "O"),
        drawing.line((u, y - 9), (x, y - 9), "size"),
        drawing.text((u + B / 2 - 4, y - 25), "b"),
        drawing.line((x + 24, y), (x + 24, y + H), "size"),
        drawing.text((x + 30, y + H / 2), "h"),
        drawing.line((u, v), (x + 28, v), "thin"),
        drawing.centred(tilted, PHI),
        drawing.line(tilted, (right, y + 2 * H), "thin"),
        drawing.arc(tilted, 180, 0, PHI),
        drawing.text((right + 10, y + 190), "φ"),
        drawing.text((right + 5, y + 5), "O"),
        drawing.text((right + 26, y + 22), "J_O"),
        drawing.arrow((10, 22), (42, 0), "a_g", (-22, 8)),
    )


labelled_on_bearings = partial(labelled, on_bearings=True)


def rocking() -> Markup:
    """Draw the block tilted about its right corner, with all forces on it."""
    drawing = Drawing(
        400, 330, 285, "A block tilted about its right corner: weight, inertia force and the corner’s forces"
    )
    corner = (220.0, 0.0)
    x, centre = corner[0], _centre(corner, PHI)
    return drawing.svg(
        drawing.line((30, 0), (370, 0)),
        drawing.centred(corner, PHI),
        drawing.line(corner, centre, "thin"),
        drawing.line(corner, (x, 175), "thin"),
        drawing.arc(corner, 96, 0, PHI - GAMMA),
        drawing.text((x + 21, 90), "γ − φ"),
        drawing.text((x - 24, 40), "R"),
        drawing.arrow(centre, (0, -ARROW), "mg", (-26, 4)),
        drawing.arrow(centre, (-ARROW, 0), "m a_g", (-34, 8)),
        drawing.arrow((x + 26, -32), (0, 30), "N", (6, -16)),
        drawing.arrow((x + 46, 0), (-42, 0), "H", (46, 7)),
        drawing.text((x + 4, -18), "O"),
    )


def impact() -> Markup:
    """Draw the impact: the old corner lifts, the impulse acts at the new one."""
    drawing = Drawing(400, 330, 275, "The block upright at the impact: the impulse acts at the new corner on the left")
    corner, new = (200 + B, 0.0), (200 - B, 0.0)
    old, left, centre = corner[0], new[0], _centre(corner, 0.0)
    u = R * 0.42  # the centre's velocity before: about the old corner
    return drawing.svg(
        drawing.line((30, 0), (370, 0)),
        drawing.centred(corner, 0.0),
        drawing.line(new, centre, "thin"),
        drawing.arrow((left, -48), (0, 44), "P_N", (8, -24)),
        drawing.arrow((left - 52, 0), (48, 0), "P_H", (-48, 8)),
        drawing.text((left + 6, 8), "O′"),
        drawing.text((old + 6, 8), "O"),
        drawing.arrow(centre, (-u * math.cos(GAMMA), -u * math.sin(GAMMA)), "R ω_−", (-30, -16)),
        drawing.line((200, -10), (old, -10), "thin"),
        drawing.text(((200 + old) / 2 - 3, -26), "b"),
        drawing.line((old + 34, 0), (old + 34, H), "thin"),
        drawing.text((old + 40, H / 2), "h"),
    )


def isolated() -> Markup:
    """Draw the block on its base, with the forces between them and of the bearings."""
    drawing = Drawing(400, 370, 330, "The block on a base that moves by x; the bearings push back")
    corner = (232.0, SLAB)
    centre = _centre(corner, PHI)
    return drawing.svg(
        *drawing.base((104, 312), 4.0),
        drawing.line((30, 0), (370, 0)),
        drawing.centred(corner, PHI),
        drawing.line(corner, centre, "thin"),
        drawing.arrow(centre, (0, -ARROW), "mg", (-26, 4)),
        drawing.arrow((104, 48), (-54, 0), "n_d f", (-12, 12)),
        drawing.arrow((312, 48), (40, 0), "x", (5, -5)),
        drawing.text((286, 45), "m_b"),
        drawing.text((corner[0] + 6, SLAB + 6), "O"),
    )


SIZE = 400, 448
HALF, HIGH = 11.0, 42.0  # half width and height of a block
WIDE, TALL = 96.0, 78.0  # width and height of the room of a mode
LEFT, RIGHT = 92.0, 308.0  # middles of the two columns
FULL, CORNER, OFF = 340.0, 190.0, 12.0  # feet of the rows
SLANT = 0.3  # rad
FALLEN = "fallen"  # no mode of contact
PLACES: dict[str, Place] = {
    MODES[STICK]: (LEFT, FULL),
    MODES[SLIDE]: (RIGHT, FULL),
    MODES[ROCK]: (LEFT, CORNER),
    MODES[SLIDE_ROCK]: (RIGHT, CORNER),
    MODES[FLIGHT]: (LEFT, OFF),
    FALLEN: (RIGHT, OFF),
}
# Tilt [rad] and height over the support of the block drawn, and whether it slides.
LOOKS = {
    MODES[STICK]: (0.0, 0.0, False),
    MODES[SLIDE]: (0.0, 0.0, True),
    MODES[ROCK]: (SLANT, 0.0, False),
    MODES[SLIDE_ROCK]: (SLANT, 0.0, True),
    MODES[FLIGHT]: (-SLANT, 5.0, False),
    FALLEN: (math.pi / 2, 0.0, False),
}
UPPER, LOWER = 30.0, 12.0  # over the feet of a row: arrows to the right, and back
# (begin of an arrow, its vector, words and their places from the begin). A change ends a mode, or all in a frame.
CHANGES: tuple[tuple[Place, Place, tuple[tuple[str, Place], ...]], ...] = tuple(
    change
    for foot in (FULL, CORNER)
    for change in (
        ((LEFT + WIDE / 2, foot + UPPER + 10), (RIGHT - LEFT - WIDE, 0.0), (("|H| = μ N", (60.0, 6.0)),)),
        ((RIGHT - WIDE / 2, foot + LOWER), (LEFT - RIGHT + WIDE, 0.0), (("slip stops", (-60.0, 6.0)),)),
    )
) + (
    ((LEFT + 8, FULL - 18), (0.0, CORNER + TALL - FULL + 18), (("|H| = N tan γ", (-52.0, -24.0)),)),
    ((RIGHT, CORNER + TALL + 10), (0.0, FULL - CORNER - TALL - 20), (("impact: it stays down", (-76.0, 18.0)),)),
    ((LEFT - 24, CORNER - 18), (0.0, OFF + TALL - CORNER + 18), (("N = 0", (-26.0, -40.0)),)),
    ((LEFT + 24, OFF + TALL), (0.0, CORNER - OFF - TALL - 18), (("impact: a corner lands", (82.0, 42.0)),)),
    ((RIGHT, CORNER - 18), (0.0, OFF + TALL - CORNER + 18), (("|φ| = π/2", (38.0, -62.0)),)),
)
FRAMES = (("both corners rest on the support", FULL), ("on one corner; an impact changes it", CORNER))
SAYS = (
    "Modes of a block that may slide. Full contact: stick until |H| = μ N (then slide) or |H| = N tan γ (then rock); "
    "slide until the slip stops. On one corner: rock until |H| = μ N (then slide-rock), slide-rock until the slip "
    "stops; both until an impact, or N = 0 (then flight, until a corner lands), or |φ| = π/2 (then fallen)."
)
CAPTION = (
    "Modes of a block with the friction μ, and what ends each. A block at rest slides if |H| = μ N comes first, and "
    "rocks if |H| = N tan γ does. Where the ground’s acceleration jumps, where slip stops and after an impact, the "
    "mode with admissible accelerations follows. Without a friction there are stick and rock alone."
)


def modes() -> Markup:
    """Draw the modes of a block that may slide, and what ends each."""
    drawing = Drawing(*SIZE, SIZE[1] - 14, SAYS)
    frames = "".join(_frame(drawing, *frame) for frame in FRAMES)
    shown = "".join(_mode(drawing, mode) for mode in PLACES)
    changes = "".join(_change(drawing, *change) for change in CHANGES)
    return Markup(str(drawing.svg(frames, shown, changes)).replace("<svg ", '<svg class="modes" ', 1))  # own markup


def _frame(drawing, words, foot):
    low, high, left, right = foot - 18, foot + TALL + 10, 14.0, 386.0
    corners = [(left, low), (right, low), (right, high), (left, high)]
    return drawing.polygon(corners, "frame") + _words(drawing, ((left + right) / 2 - 20, low + 5), words, "soft")


def _mode(drawing, mode):
    (x, foot), (tilt, height, slides) = PLACES[mode], LOOKS[mode]
    pivot = x + (HALF if tilt >= 0 else -HALF) - (HIGH / 2 if mode == FALLEN else 0)
    slip = drawing.shaft((x - 34, foot + 18), (17.0, 0.0), 8, "slip", "slip full") if slides else ""
    parts = [
        drawing.line((x - 36, foot + 8), (x + 36, foot + 8)),
        drawing.block((pivot, foot + 8 + height), tilt, HALF, HIGH, 1 if tilt >= 0 else -1),
        _words(drawing, (x, foot + TALL - 12), mode, "name"),
    ]
    return "".join(parts) + slip


def _change(drawing, begin, by, words):
    labels = (_words(drawing, (begin[0] + x, begin[1] + y), text) for text, (x, y) in words)
    return drawing.shaft(begin, by, 8, "line", "line full") + "".join(labels)


def _words(drawing, place, words, kind=""):
    return drawing.text(place, words, kind).replace("<text ", '<text text-anchor="middle" ', 1)


SYMBOLS = {
    "alpha": "α", "gamma": "γ", "delta": "δ", "Delta": "Δ", "xi": "ξ", "pi": "π", "phi": "φ", "omega": "ω",
    "varphi": "φ", "lambda": "λ", "mu": "μ", "eta": "η", "sigma": "σ",
}  # fmt: skip
OPERATORS = {
    "cdot": "·", "times": "×", "le": "≤", "ge": "≥", "ne": "≠", "approx": "≈", "pm": "±", "to": "→", "int": "∫",
    "oint": "∮", "infty": "∞", "ll": "≪", "sum": "∑", "Rightarrow": "⇒", "propto": "∝", "lt": "<", "gt": ">",
}  # fmt: skip
FUNCTIONS = {"sin", "cos", "tan", "ln", "log", "exp", "sgn", "max", "min"}
SPACES = {",": "0.17em", ";": "0.28em", "quad": "1em", "qquad": "2em", "!": "-0.1em"}
THIN = "<mspace width='0.17em'/>"
# {command: (number of its arguments, MathML)}. Accents are full stops, which fonts without mathematics draw clear of
# the letter.
COMMANDS = {
    **{name: (0, f"<mi>{letter}</mi>") for name, letter in SYMBOLS.items()},
    **{name: (0, f"<mo>{escape(sign)}</mo>") for name, sign in OPERATORS.items()},
    **{name: (0, f"<mi>{name}</mi>") for name in FUNCTIONS},
    **{name: (0, f"<mspace width='{width}'/>") for name, width in SPACES.items()},
    **{
        name: (1, f"<mover>{{}}<mo>{sign}</mo></mover>")
        for name, sign in (("dot", "."), ("ddot", ".."), ("tilde", "~"))
    },
    "left": (1, "{}"),
    "right": (1, "{}"),
    "sqrt": (1, "<msqrt>{}</msqrt>"),
    "frac": (2, "<mfrac>{}{}</mfrac>"),
}
NAMES = {"_": "sub", "^": "sup"}  # of scripts: msub, msup, msubsup
TOKEN = re.compile(r"\\text\{[^}]*\}|\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\s+|.", re.DOTALL)


def mathml(tex: str, display: bool = False) -> str:
    """Return the ``<math>`` element of a formula.

    Raises
    ------
    ValueError
        The formula has an unknown command, or its braces do not match.
    """
    tokens = [token for token in TOKEN.findall(tex) if not token.isspace()]
    try:
        body = _row(tokens)
    except IndexError:
        raise ValueError(f"{tex!r}: something is missing at the end") from None
    except ValueError as error:
        raise ValueError(f"{tex!r}: {error}") from None
    block = ' display="block"' if display else ""
    return f"<math{block}>{body}</math>"


def _row(tokens: list[str], closing: str | None = None) -> str:
    """Return MathML of the tokens up to `closing`, and remove them from the list."""
    parts: list[str] = []
    function = False
    while tokens and tokens[0] != closing:
        if tokens[0] in "^_" and parts:
            base, scripts = parts.pop(), {}
            while tokens and tokens[0] in "^_":
                kind = tokens.pop(0)
                scripts[kind] = _argument(tokens)
            name = "".join(NAMES[kind] for kind in "_^" if kind in scripts)
            parts.append(f"<m{name}>{base}{scripts.get('_', '')}{scripts.get('^', '')}</m{name}>")
            continue
        if function and tokens[0] not in ("(", "\\left"):
            parts.append(THIN)  # between a function, or its power, and its argument
        function = tokens[0][1:] in FUNCTIONS
        if function and parts and not parts[-1].startswith("<mo"):
            parts.append(THIN)
        parts.append(_argument(tokens))
    if closing and not tokens:
        raise ValueError("a brace is not closed")
    return "".join(parts)


def _argument(tokens: list[str]) -> str:
    """Return MathML of the first token and its arguments, and remove them from the list."""
    token = tokens.pop(0)
    if token == "{":
        body = _row(tokens, "}")
        tokens.pop(0)
        return f"<mrow>{body}</mrow>"
    if token.startswith("\\text{"):
        return f"<mi mathvariant='normal'>{escape(token[6:-1])}</mi>"
    if token.startswith("\\"):
        if token[1:] not in COMMANDS:
            raise ValueError(f"{token} is not among the commands that the pages use")
        count, form = COMMANDS[token[1:]]
        return form.format(*(_argument(tokens) for _ in range(count)))
    if token == "}":
        raise ValueError("a brace too many")
    return _letter(token)


def _letter(token):
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if token.isalpha():
        return f"<mi>{token}</mi>"
    if token in "|()[]":
        return f"<mo stretchy='false' lspace='0' rspace='0'>{token}</mo>"
    return f"<mo>{escape({'-': '−', chr(39): '′', '*': '·'}.get(token, token))}</mo>"


def prose(text: str) -> str:
    """Return the HTML of a paragraph with ``$formulas$``, `code` and *emphasis*."""
    parts = text.split("$")
    parts[1::2] = map(mathml, parts[1::2])
    for i in range(0, len(parts), 2):
        words = re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(parts[i], quote=False))
        parts[i] = re.sub(r"\*([^*]+)\*", r"<em>\1</em>", words)
    return "".join(parts)
