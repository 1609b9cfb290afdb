"""What is drawn: which lines, in which units, how told apart."""

import numpy as np
import pytest

from analytic import load_scene, simulate
from comparisons.showing.plots import draw_histories, style
from engines import ENGINES


def drawn(name, horizon=None, count=1):
    scene = load_scene(name)
    response = simulate(scene)
    figure = draw_histories(scene, [response] * count, horizon)
    return scene, response, {axis.get_ylabel().split("\n")[-1]: axis for axis in figure.axes}


def test_isolated_scene_has_ground_tilt_displacement_and_loop():
    _, response, axes = drawn("caryatid-isolated")
    assert set(axes) == {
        "acceleration [m/s²]",
        "tilt / slenderness [-]",
        "base displacement [m]",
        "force of all bearings [kN]",
    }
    loop = axes["force of all bearings [kN]"].lines[0]
    np.testing.assert_array_equal(loop.get_ydata(), response.history.bearing_force / 1e3)
    assert loop.axes.get_xlabel() == "base displacement [m]"
    assert "synthetic" in axes["acceleration [m/s²]"].get_title()


def test_rigid_ground_without_motion_shows_the_tilt_alone():
    scene, response, axes = drawn("free-rocking-rigid")
    assert set(axes) == {"tilt / slenderness [-]"}
    line = axes["tilt / slenderness [-]"].lines[1]  # after the zero line
    np.testing.assert_allclose(line.get_ydata(), response.history.tilt / scene.block.slenderness)


def test_tiny_tilts_are_not_blown_up_and_overturning_does_not_flatten_the_rest():
    low, high = drawn("caryatid-isolated")[2]["tilt / slenderness [-]"].get_ylim()
    assert 0.05 <= high == -low < 0.06
    assert drawn("caryatid-rigid")[2]["tilt / slenderness [-]"].get_ylim()[1] == 2.0


@pytest.mark.parametrize("horizon, shown", [(3.0, True), (None, False)])
def test_what_lies_beyond_the_horizon_is_shaded(horizon, shown):
    axis = drawn("caryatid-rigid", horizon, count=2)[2]["tilt / slenderness [-]"]
    labels = [text.get_text() for text in axis.get_legend().get_texts()]
    assert ("beyond the sensitivity horizon" in labels) == shown
    assert "analytic, kernel: overturns" in labels


def test_solvers_differ_in_colour_and_in_dashes():
    """Those of the model's second implementations too, which stand beside the engines."""
    solvers = ("analytic", *ENGINES, "time-stepping")
    looks = [style(solver) for solver in solvers]
    assert len({look["color"] for look in looks}) == len({look["linestyle"] for look in looks}) == len(solvers)
