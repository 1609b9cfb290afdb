"""What is drawn: which lines, in which units, how told apart."""

from dataclasses import replace

import numpy as np
import pytest
from sliding_scenes import SAVED

from analytic import Start, load_scene, simulate
from comparisons.showing.plots import draw_histories, style
from engines import ENGINES

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


def test_rigid_ground_without_motion_shows_the_tilt_alone():
    scene, response, axes = drawn("free-rocking-rigid")
    (tilt,) = axes.values()
    np.testing.assert_allclose(tilt.lines[1].get_ydata(), response.history.tilt / scene.block.slenderness)


@pytest.mark.parametrize("horizon", [3.0, None])
def test_what_lies_beyond_the_horizon_is_shaded_and_overturning_does_not_flatten_the_rest(horizon):
    axis = drawn("caryatid-rigid", horizon, count=2)[2]["tilt / slenderness [-]"]
    labels = [text.get_text() for text in axis.get_legend().get_texts()]
    assert ("beyond the sensitivity horizon" in labels) == (horizon is not None)
    assert "analytic, kernel: overturns" in labels and axis.get_ylim()[1] == 2.0


def test_solvers_differ_in_colour_and_in_dashes():
    """Those of the model's second implementations too, which stand beside the engines."""
    looks = [style(solver) for solver in ("analytic", *ENGINES, "time-stepping")]
    assert len({look["color"] for look in looks}) == len({look["linestyle"] for look in looks}) == len(looks)


def test_slip_has_a_panel_of_its_own_where_the_block_slides_and_when_is_shaded():
    response = simulate(SAVED)
    told = [response, replace(response, engine="pybullet", sliding=replace(response.sliding, modes=()))]
    axes = {axis.get_ylabel().split("\n")[0]: axis for axis in draw_histories(SAVED, told).axes}
    slip = axes["slip of the block"]
    assert len(slip.lines) == 1 + len(told)
    np.testing.assert_array_equal(slip.lines[1].get_ydata(), response.history.slip)
    (shaded,) = slip.patches
    begin, end = (time for time, mode in response.sliding.modes[2:4])
    assert [shaded.get_x(), shaded.get_x() + shaded.get_width()] == pytest.approx([begin, end])
    assert [text.get_text() for text in slip.get_legend().get_texts()] == ["slides"]
    still = SAVED.with_(motion=None, start=Start(tilt=0.1))
    assert len(draw_histories(still, [simulate(still)]).axes) == 1
