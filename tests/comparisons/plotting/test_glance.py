"""The two charts of the report's first screen can be read: no word is crossed, and each curve has its name."""

import math
import re
from collections import defaultdict
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from comparisons.execution.results import RESULTS
from comparisons.plotting.charts import SHAPES
from comparisons.plotting.glance import Curve, Endings, costs, endings
from comparisons.schemas.columns import spelled, spelled_page
from comparisons.studies import get_study
from comparisons.studies.rows import read_study

FORMS = {"wide": 0, "phone": 1}
LETTERING = 13


def chart(picture, form):
    """A figure's chart as it is shown, on a wide page or on a phone."""
    return ElementTree.fromstring(f"<both>{spelled_page(picture.element)}</both>")[FORMS[form]][0]


def numbers(text):
    return [float(number) for number in re.findall(r"-?[\d.]+", text)]


def box(text):
    """(left, top, right, bottom) of the ink of a text, in DejaVu Sans, which is wider than most system fonts."""
    kinds = text.get("class", "").split()
    bold = "title" in kinds or ("who" in kinds and "plain" not in kinds)
    size = 12.5 if "plain" in kinds else LETTERING
    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")
    ink = TextPath((0, 0), text.text, size=size, prop=font).get_extents()
    begin = (
        numbers(text.get("x"))[0] - {"start": 0, "middle": ink.x1 / 2, "end": ink.x1}[text.get("text-anchor", "start")]
    )
    y = numbers(text.get("y"))[0]
    return begin + ink.x0, y - ink.y1, begin + ink.x1, y - ink.y0


def texts(svg):
    """[(solver or "", words, box)] of all words of a chart but its axes'."""
    found = []
    for group in svg:
        who = group.get("data-who") or ""
        for text in [group] if group.tag == "text" and not group.get("transform") else group.findall("text"):
            if text.get("transform") is None and text.get("x") is not None:
                text.set("class", text.get("class", "") + " who" * bool(who))
                found.append((who, text.text, box(text)))
    return found


def crosses(begin, end, words):
    """Whether a straight line passes through a box (Liang and Barsky's clipping)."""
    low, high = 0.0, 1.0
    for k in (0, 1):
        way = end[k] - begin[k]
        if way == 0:
            if not words[k] < begin[k] < words[k + 2]:
                return False
            continue
        enters, leaves = sorted(((words[k] - begin[k]) / way, (words[k + 2] - begin[k]) / way))
        low, high = max(low, enters), min(high, leaves)
    return low < high


def lines(svg):
    """[(solver, begin, end)] of all straight pieces of curves and of lines from names to curves."""
    pieces = []
    for group in svg.iter("g"):
        for path in group.findall("path"):
            if {"line", "lead"} & set(path.get("class", "").split()) and not path.get("transform"):
                for part in path.get("d").split("M")[1:]:
                    places = np.reshape(numbers(part.replace("L", " ")), (-1, 2)).tolist()
                    pieces += [(group.get("data-who"), *pair) for pair in zip(places, places[1:], strict=False)]
    return pieces


def marks(svg):
    """[(solver, place, shape, words under the pointer, whether open)] of a chart."""
    return [
        (
            group.get("data-who"),
            numbers(path.get("transform"))[:2],
            path.get("d"),
            path.get("data-says"),
            "open" in kind,
        )
        for group in svg.iter("g")
        if group.get("data-who")
        for path in group.findall("path")
        if "dot" in (kind := path.get("class", ""))
    ]


@pytest.fixture(scope="module")
def curves():
    return get_study("speed-error").glance(read_study(RESULTS / "speed-error")).curves


@pytest.mark.parametrize("form", FORMS)
def test_no_name_of_a_curve_is_crossed(curves, form):
    svg = chart(costs(curves), form)
    names = [(words, place) for who, words, place in texts(svg) if who]
    pieces, dots = lines(svg), marks(svg)
    assert names and len(pieces) > 20 < len(dots)
    assert [(words, who) for words, place in names for who, *ends in pieces if crosses(*ends, place)] == []
    assert [
        (words, who) for words, place in names for who, at, *_ in dots if crosses(at, np.add(at, 1e-3), place)
    ] == []


@pytest.mark.parametrize("form", FORMS)
def test_every_curve_that_is_drawn_has_its_name(curves, form):
    svg = chart(costs(curves), form)
    named = defaultdict(list)
    for who, words, _ in texts(svg):
        named[who].append(words)
    written = {" ".join(words) for who, words in named.items() if who}
    drawn = {who for who, *_ in marks(svg)} | {who for who, *_ in lines(svg)}
    assert {spelled(curve.name) for curve in curves if curve.who in drawn} == written
    missing = {curve.who.split(",")[0] for curve in curves if curve.points and curve.who not in drawn}
    shown = " ".join("".join(svg.itertext()).split())
    assert all(spelled(engine) in shown for engine in missing) and (form == "phone" or not missing)


@pytest.mark.parametrize("form", FORMS)
def test_one_mark_says_that_impacts_were_missed_whatever_the_curve(curves, form):
    svg = chart(costs(curves), form)
    dots = marks(svg)
    missed = [shape for *_, shape, words, _ in dots if "missed" in words]
    assert missed and set(missed) == {SHAPES["x"]}
    assert SHAPES["x"] not in {shape for *_, shape, words, _ in dots if "missed" not in words}
    legend = "".join(svg.itertext())
    assert "impacts missed" in legend and ("no impact missed" in legend) == any(opened for *_, opened in dots)


@pytest.mark.parametrize("form", FORMS)
def test_words_of_both_charts_are_apart_and_inside(curves, form):
    """Heads of groups are farther from the row above than rows are from each other."""
    ways = {"failed": 11, "missed": 12, "added": 13, "other": 14, "late": 15}
    row = Endings("recorded earthquakes", "pybullet", "first-script", "defaults", 243, **ways, interval=(0.2, 0.4))
    rows = [
        row,
        replace(row, kind="tuned", failed=0, missed=0, added=0, other=0, late=None, left_out=12, left_differing=12),
        replace(row, motions="pulses", runs=896, left_out=84, left_differing=40),
        replace(row, **{**dict.fromkeys(ways, 0), "other": 343}, motions="shake-table motions", runs=896, left_out=84),
    ]
    for svg in (chart(endings(rows), form), chart(costs(curves), form)):
        width, height = numbers(svg.get("viewBox"))[2:]
        found = texts(svg)
        assert [words for _, words, (x0, y0, x1, y1) in found if min(x0, y0, width - x1, height - y1) < 0] == []
        assert [
            (first, second)
            for (_, first, a), (_, second, b) in combinations(found, 2)
            if min(a[2], b[2]) > max(a[0], b[0]) - 3 and min(a[3], b[3]) > max(a[1], b[1])
        ] == []
    heads = [
        place for _, words, place in texts(chart(endings(rows), form)) if words in {"pulses", "shake-table motions"}
    ]
    others = [place for _, words, place in texts(chart(endings(rows), form))]
    for head in heads:
        assert min(head[1] - other[3] for other in others if other[3] < head[1]) > 8


def test_a_phone_says_in_words_how_runs_end():
    row = Endings("pulses", "exudyn", "v", "tuned", 100, 1, 2, 3, 4, (0.0, 0.1), late=5, left_out=9, left_differing=8)
    words = [words for _, words, _ in texts(chart(endings([row]), "phone"))]
    assert {"10 of 100", "8 of 9", "2 missed, 3 added, 4 other, 1 failed, 5 time"} <= {*words}


def test_a_chart_with_no_room_for_a_name_is_drawn_all_the_same():
    long = Curve("exudyn, v", "x" * 80, "tuned", True, ((0.01, 1e-3, True, "fine"), (0.1, math.pi, False, "missed")))
    assert "x" * 80 in costs([long]).element
