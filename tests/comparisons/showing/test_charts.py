"""Charts: what is drawn lies where its axes say, names and hides solvers alike, and can be read back."""

import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from page_numbers import number_in

from comparisons.showing.charts import SHAPES, Axis, Chart, key_of, log_axis, marker
from engines import ENGINES

LINEAR, LOG = Axis("x [m]", -2.0, 6.0), Axis("error [-]", 1e-6, 1e2, "log")


def value(read, place):
    """What the page's script makes of a place."""
    share = (place - read["at"][0]) / (read["at"][1] - read["at"][0])
    return (
        read["low"] * (read["high"] / read["low"]) ** share
        if read["log"]
        else read["low"] + share * (read["high"] - read["low"])
    )


def element(chart):
    return ElementTree.fromstring(chart.svg())


def places(root, kind):
    (path,) = [part for part in root.iter("path") if part.get("class") == kind]
    return [tuple(map(float, pair.split())) for pair in re.split("[ML]", path.get("d"))[1:]]


def test_a_line_read_back_from_its_path_is_the_data():
    xs, ys = np.linspace(-1.5, 5.5, 40), np.geomspace(1e-5, 10, 40)
    chart = Chart(LINEAR, LOG, "A line.")
    chart.line(xs, ys, "exudyn")
    root = element(chart)
    read = json.loads(root.get("data-read"))
    found = np.array([(value(read["x"], x), value(read["y"], y)) for x, y in places(root, "line")])
    np.testing.assert_allclose(found[:, 0], xs, atol=8.0 / 300)  # a tenth of a unit of some 330
    np.testing.assert_allclose(np.log10(found[:, 1]), np.log10(ys), atol=8.0 / 200)


def test_a_line_is_parted_where_there_is_no_number_and_says_equal_points_once():
    chart = Chart(LINEAR, LINEAR, "A gap.")
    chart.line([0, 1, 1, 2, 3, 4], [0, 1, 1, np.nan, 1, 0])
    chart.line([], [])
    assert [
        re.sub("[^ML]", "", part.get("d")) for part in element(chart).iter("path") if part.get("class") == "line"
    ] == ["MLML", ""]


def test_ticks_lie_between_the_ends_and_say_their_values():
    for axis in (LINEAR, LOG, Axis("t", 0.0, 32.2), log_axis("e", [3e-9, 0.0, 2e-4])):
        marks = axis.marks()
        assert len(marks) >= 3
        for place, word in marks:
            assert -1e-9 <= axis.share([place])[0] <= 1 + 1e-9
            number = number_in(f"1·{word}") if axis.scale == "log" else number_in(word)
            assert number == pytest.approx(place, rel=1e-9, abs=1e-12)
    assert log_axis("e", [3e-9, 0.0, 2e-4]).low == 1e-9


def test_every_solver_has_a_marker_of_its_own_and_its_name_on_what_it_drew():
    assert {marker(name) for name in ENGINES} <= set(SHAPES) and len({marker(name) for name in ENGINES}) == len(ENGINES)
    chart = Chart(LINEAR, LINEAR, "Two.")
    for name in ("exudyn", "analytic"):
        chart.line([0, 1], [0, 1], name)
        chart.dots([0, 1], [0, 1], name, says=["first", "second < third"])
    root = element(chart)
    assert {part.get("data-who") for part in root.iter("g")} - {None} == {"exudyn", "analytic"}
    told = [part.get("data-says") for part in root.iter("path") if part.get("data-says")]
    assert told == 2 * ["first", "second < third"]
    assert ENGINES["exudyn"].colour in chart.svg() and ENGINES["exudyn"].colour in key_of("exudyn")


def test_scipy_and_time_stepping_are_told_apart_in_one_ink():
    scipy, stepping = key_of("scipy, DOP853"), key_of("time-stepping")
    assert all("--c:var(--soft)" in key for key in (scipy, stepping))
    assert SHAPES[marker("scipy")] in scipy and SHAPES[marker("time-stepping")] in stepping
    assert "--d:7 4" in scipy and "--d:2 3.5" in stepping and "--d:none" in key_of("analytic")


def test_labels_are_pushed_apart_and_stay_inside():
    chart = Chart(LINEAR, LINEAR, "Labels.", right=80)
    for k in range(8):
        chart.label(-1.9 + 0.01 * k, f"line {k}")
    tops = sorted(float(text.get("y")) for text in element(chart).iter("text") if (text.text or "").startswith("line"))
    assert len(tops) == 8 and min(np.diff(tops)) >= 13 and tops[-1] <= chart.bottom + 5
