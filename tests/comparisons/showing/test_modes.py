"""The drawing of the modes: every mode of the march, what ends each, and nothing outside of it."""

import re
from xml.etree import ElementTree

from analytic.layout import MODES
from comparisons.showing import modes

SVG = ElementTree.fromstring(str(modes.modes()))
WORDS = [text.text for text in SVG.iter("text")]
WIDTH, HEIGHT = modes.SIZE
LETTER = 7.0  # of 13 px, on the average


def test_every_mode_of_the_march_is_there_once_and_what_ends_it():
    assert [word for word in WORDS if word in (*MODES, modes.FALLEN)] == [*MODES, modes.FALLEN]
    ends = "".join(words for _, _, told in modes.CHANGES for words, _ in told)
    for end in ("|H| = μ N", "|H| = N tan γ", "slip stops", "impact", "N = 0", "|φ| = π/2"):
        assert end in ends and end in " ".join(WORDS) and (end in modes.SAYS or end == "slip stops")
    assert SVG.get("aria-label") == modes.SAYS


def test_nothing_is_outside_of_it():
    for text in SVG.iter("text"):
        x, y, half = float(text.get("x")), float(text.get("y")), LETTER * len(text.text) / 2
        assert half <= x <= WIDTH - half and 13 <= y <= HEIGHT, text.text
    for polygon in SVG.iter("polygon"):
        places = [float(number) for number in re.findall(r"-?[\d.]+", polygon.get("points"))]
        assert min(places) >= 0 and max(places[::2]) <= WIDTH and max(places[1::2]) <= HEIGHT


def test_blocks_are_as_their_mode_is():
    sliding = [mode for mode, (_, _, slides) in modes.LOOKS.items() if slides]
    assert sliding == [mode for mode in MODES if "slide" in mode]
    assert [mode for mode, (tilt, _, _) in modes.LOOKS.items() if tilt == 0] == ["stick", "slide"]
