"""Charts can be read back: figures draw every row where it belongs, tell series apart, and write numbers in cells."""

import json
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from contrast import contrast
from page_numbers import number_in
from sliding_scenes import SAVED
from stack_scenes import SIX

from analytic import Start, load_scene, simulate
from analytic.kernel.layout import MODES
from analytic.solver import simulate_stack
from comparisons.plotting import diagrams as modes
from comparisons.plotting.charts import INK, SHAPES, STYLE, TONES, Axis, Chart, log_axis, marker
from comparisons.plotting.plots import draw_histories, style
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


def drawn_lines(root):
    """The paths of the lines in a panel, those in the margin aside."""
    (inside,) = root.findall("svg")
    return [part.get("d") for part in inside.iter("path") if part.get("class") == "line"]


def points(path):
    return [tuple(map(float, pair.split())) for pair in re.split("[ML]", path)[1:]]


def test_a_line_read_back_from_its_path_is_the_data():
    xs, ys = np.linspace(-1.5, 5.5, 40), np.geomspace(1e-5, 10, 40)
    chart = Chart(LINEAR, LOG, "A line.")
    chart.line(xs, ys, "exudyn")
    root = element(chart)
    read = json.loads(root.get("data-read"))
    drawn = np.array([(value(read["x"], x), value(read["y"], y)) for x, y in points(*drawn_lines(root))])
    np.testing.assert_allclose(drawn[:, 0], xs, atol=8.0 / 300)  # a tenth of a unit of some 330
    np.testing.assert_allclose(np.log10(drawn[:, 1]), np.log10(ys), atol=8.0 / 200)


def test_a_line_is_parted_where_there_is_no_number_and_says_equal_points_once():
    chart = Chart(LINEAR, LINEAR, "A gap.")
    chart.line([0, 1, 1, 2, 3, 4], [0, 1, 1, np.nan, 1, 0])
    chart.line([], [])
    assert [re.sub("[^ML]", "", path) for path in drawn_lines(element(chart))] == ["MLML", ""]


def test_ticks_lie_between_the_ends_and_say_their_values():
    for axis in (LINEAR, LOG, Axis("t", 0.0, 32.2), log_axis("e", [3e-9, 0.0, 2e-4])):
        marks = axis.marks()
        assert len(marks) >= 3
        for place, word in marks:
            assert -1e-9 <= axis.share([place])[0] <= 1 + 1e-9
            number = number_in(f"1·{word}") if axis.scale == "log" else number_in(word)
            assert number == pytest.approx(place, rel=1e-9, abs=1e-12)
    assert log_axis("e", [3e-9, 0.0, 2e-4]).low == 1e-9


def place_of(mark):
    """(x, y) of a mark."""
    return tuple(map(float, re.findall(r"[\d.]+", mark.get("transform"))[:2]))


def test_marks_beyond_the_panel_stand_at_its_frame_with_an_arrowhead_that_points_there():
    chart = Chart(LINEAR, LOG, "Beyond.")
    values = ([0.0, 8.0, 8.0, -3.0, 0.0, 0.0], [1.0, 1.0, 1e3, 1.0, 1e3, 0.0])
    chart.dots(*values)
    assert [part.get("class") for part in element(chart).iter("path")].count("dot") == 1  # the others are not asked for
    chart.over.clear()
    chart.dots(*values, beyond=True)
    marks = [part for part in element(chart).iter("path") if part.get("class") == "dot"]
    arrows = [part.get("transform") for part in element(chart).iter("path") if part.get("class") == "beyond"]
    x, y = (round(float(at), 1) for at in chart.at([0.0], [1.0])[0])
    right, left, top, bottom = chart.right, chart.left, chart.top, chart.bottom
    assert list(map(place_of, marks)) == [(x, y), (right, y), (right, top), (left, y), (x, top), (x, bottom)]
    assert [re.search(r"rotate\((.*)\)", arrow)[1] for arrow in arrows] == ["0", "-45", "180", "-90", "90"]


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_lines_and_shades_can_be_told_from_the_page(scheme):
    def rgb(colour):
        return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)])

    style = STYLE.read_text(encoding="utf-8")
    known = [dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", part)) for part in style.split("@media")[:2]]
    colours = {name: rgb(colour) for name, colour in (known[0] | known[scheme]).items()}
    for tone in (*TONES, *(engine.colour for engine in ENGINES.values())):
        mixed = (rgb(tone) * (100 - INK) + colours["ink"] * INK) / 100
        assert contrast(mixed, colours["paper"]) >= 3, tone
    assert contrast(colours["faint"], colours["paper"]) >= 3
    assert min(contrast(colours["ink"], colours[f"s{shade}"]) for shade in range(6)) >= 4.5


def test_every_mode_of_the_march_is_there_once_and_what_ends_it():
    words = [text.text for text in ElementTree.fromstring(str(modes.modes())).iter("text")]
    assert [word for word in words if word in (*MODES, modes.FALLEN)] == [*MODES, modes.FALLEN]
    ends = "".join(words for _, _, labels in modes.CHANGES for words, _ in labels)
    for end in ("|H| = μ N", "|H| = N tan γ", "slip stops", "impact", "N = 0", "|φ| = π/2"):
        assert end in ends and end in " ".join(words) and (end in modes.SAYS or end == "slip stops")


def test_blocks_are_as_their_mode_is():
    sliding = [mode for mode, (_, _, slides) in modes.LOOKS.items() if slides]
    assert sliding == [mode for mode in MODES if "slide" in mode]
    assert [mode for mode, (tilt, _, _) in modes.LOOKS.items() if tilt == 0] == ["stick", "slide"]


LOOP = "force of all bearings [kN]"


def drawn(name, horizon=None, count=1):
    scene = load_scene(name)
    response = simulate(scene)
    figure = draw_histories(scene, [response] * count, horizon)
    return scene, response, {axis.get_ylabel().split("\n")[-1]: axis for axis in figure.axes}


def test_isolated_scene_has_ground_tilt_displacement_and_loop():
    _, response, axes = drawn("caryatid-isolated")
    tilt = axes["tilt / slenderness [-]"]
    assert set(axes) == {"acceleration [m/s²]", "tilt / slenderness [-]", "base displacement [m]", LOOP}
    np.testing.assert_array_equal(axes[LOOP].lines[0].get_ydata(), response.history.bearing_force / 1e3)
    assert axes[LOOP].get_xlabel() == "base displacement [m]"
    assert "synthetic" in axes["acceleration [m/s²]"].get_title()
    assert 0.05 <= tilt.get_ylim()[1] == -tilt.get_ylim()[0] < 0.06  # a tiny tilt is not blown up


@pytest.mark.parametrize("horizon", [3.0, None])
def test_what_lies_beyond_the_horizon_is_shaded_and_overturning_does_not_flatten_the_rest(horizon):
    axis = drawn("caryatid-rigid", horizon, count=2)[2]["tilt / slenderness [-]"]
    labels = [text.get_text() for text in axis.get_legend().get_texts()]
    assert ("beyond the sensitivity horizon" in labels) == (horizon is not None)
    assert "analytic, kernel: overturns" in labels and axis.get_ylim()[1] == 2.0


def test_solvers_differ_in_marker_colour_and_dashes():
    """Those of the model's second implementations too, which stand beside the engines."""
    assert {marker(name) for name in ENGINES} <= set(SHAPES) and len({marker(name) for name in ENGINES}) == len(ENGINES)
    looks = [style(solver) for solver in ("analytic", *ENGINES, "time-stepping")]
    assert len({look["color"] for look in looks}) == len({look["linestyle"] for look in looks}) == len(looks)


def test_slip_has_a_panel_of_its_own_where_the_block_slides_and_when_is_shaded():
    response = simulate(SAVED)
    (slip,) = (axis for axis in draw_histories(SAVED, [response]).axes if axis.get_ylabel().startswith("slip of"))
    np.testing.assert_array_equal(slip.lines[1].get_ydata(), response.history.slip)
    (shaded,) = slip.patches
    ends = [time for time, _ in response.sliding.modes[2:4]]
    assert [shaded.get_x(), shaded.get_x() + shaded.get_width()] == pytest.approx(ends)
    still = SAVED.with_(motion=None, start=Start(tilt=0.1))
    assert len(draw_histories(still, [simulate(still)]).axes) == 1


def test_a_free_pedestal_has_a_panel_over_its_own_slenderness():
    scene, tilt = SIX["leaning"]
    response = simulate_stack(scene, pedestal_tilt=tilt)
    _, pedestal = draw_histories(scene, [response]).axes
    np.testing.assert_allclose(pedestal.lines[1].get_ydata() * math.atan2(0.5, 0.8), response.history.pedestal_tilt)
    assert pedestal.get_ylabel().startswith("tilt of the pedestal") and pedestal.get_ylim()[0] <= -0.05
