"""The modes of a block that may slide, as a drawing: what each looks like, and what ends it."""

import math

from markupsafe import Markup

from analytic.layout import FLIGHT, MODES, ROCK, SLIDE, SLIDE_ROCK, STICK

from .diagrams import Drawing, Place

SIZE = 400, 448
HALF, HIGH = 11.0, 42.0  # half width and height of a block
WIDE, TALL = 96.0, 78.0  # of the room of a mode
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
# (begin, direction, words and their places from the begin): each ends a mode, or all within a frame.
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
    "Modes of a block with the friction μ, and what ends each. A block at rest slides or rocks by which of |H| = μ N "
    "and |H| = N tan γ comes first. Where the ground’s acceleration jumps, where slip stops and after an impact, the "
    "mode follows whose accelerations are admissible. Without a friction: stick and rock alone."
)


def modes() -> Markup:
    """The drawing."""
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
    parts = [
        drawing.line((x - 36, foot + 8), (x + 36, foot + 8)),
        drawing.block((pivot, foot + 8 + height), tilt, HALF, HIGH, 1 if tilt >= 0 else -1),
        _words(drawing, (x, foot + TALL - 12), mode, "name"),
    ]
    return "".join([*parts, _arrow(drawing, (x - 34, foot + 18), (17.0, 0.0), "slip")] if slides else parts)


def _change(drawing, begin, by, words):
    told = (_words(drawing, (begin[0] + x, begin[1] + y), text) for text, (x, y) in words)
    return _arrow(drawing, begin, by) + "".join(told)


def _arrow(drawing, begin, by, kind="line"):
    (x, y), length = (begin[0] + by[0], begin[1] + by[1]), math.hypot(*by)
    u, v = by[0] / length, by[1] / length
    a, b = x - 8 * u, y - 8 * v
    tip = [(x, y), (a - 4 * v, b + 4 * u), (a + 4 * v, b - 4 * u)]
    return drawing.line(begin, (a, b), kind) + drawing.polygon(tip, f"{kind} full")


def _words(drawing, place, words, kind=""):
    return drawing.text(place, words, kind).replace("<text ", '<text text-anchor="middle" ', 1)
