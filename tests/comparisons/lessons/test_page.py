"""The playground in a browser, opened from a file: it asks for nothing, and its sliders give the kernel's numbers."""

import math

import pytest
from javascript import quiet_page

from analytic import PulseMotion, load_scene, simulate
from comparisons.lessons.playground import PAGE, playground_page


@pytest.fixture
def opened(browser, tmp_path):
    """opened(address behind #, **context) -> the page; at the end: no request, no error."""
    (tmp_path / PAGE).write_text(playground_page(), encoding="utf-8")
    pages = []

    def open_(hash_="", **context):
        pages.append(quiet_page(browser.new_context(**{"reduced_motion": "reduce", **context})))
        page = pages[-1][0]
        page.goto((tmp_path / PAGE).as_uri() + hash_)
        return page

    yield open_
    for page, wrong in pages:
        page.context.close()
        assert not wrong


def value(page, name):
    return float(page.get_attribute(f"#{name}", "data-value"))


def test_a_moved_slider_gives_the_kernels_number(opened):
    page = opened("#amplitude=0.35&period=0.5")
    page.fill("#s-slenderness", "0.2")
    scene = load_scene("caryatid-rigid").with_(block={"slenderness": 0.2})
    scene = scene.with_(motion=PulseMotion("one-sine", 0.35 * 9.81, 2 * math.pi / 0.5), duration=10.0)
    response = simulate(scene)
    assert value(page, "peak") == pytest.approx(response.peak_tilt, rel=1e-9)
    assert value(page, "impacts") == len(response.impacts)
    assert page.inner_text("#verdict") == response.outcome


def test_the_isolated_caryatid_stands_and_a_phone_does_not_scroll_sideways(opened):
    page = opened("#motion=synthetic&base=true&engine=soft", viewport={"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    response = simulate(load_scene("caryatid-isolated"))
    assert page.inner_text("#verdict") == response.outcome == "stands"
    assert value(page, "displacement") == pytest.approx(response.peak_base_displacement, rel=1e-9)
    page.uncheck("#base")
    assert page.inner_text("#verdict") == simulate(load_scene("caryatid-rigid")).outcome == "overturns"
    assert page.is_hidden("#loop")
    page.evaluate("Playground.set({ motion: 'pulse' })")
    assert page.evaluate("document.documentElement.scrollWidth") == 390


def test_an_engine_with_long_steps_errs_as_the_preset_says(opened):
    page = opened()
    page.click("text=An engine errs")
    page.wait_for_selector("#ghost-verdict[data-wrong=true]")
    assert page.inner_text("#verdict") == "rocks" and "overturns" in page.inner_text("#ghost-verdict")


def test_keys_and_clicks_move_slider_map_and_time(opened):
    page = opened("#amplitude=0.35", viewport={"width": 1280, "height": 1100})
    before = page.evaluate("Playground.state.period")
    page.press("#s-slenderness", "ArrowRight")
    assert page.evaluate("Playground.state.slenderness") == pytest.approx(0.285)
    page.wait_for_function("Playground.painted()")
    page.press("#map", "ArrowRight")
    assert page.evaluate("Playground.state.period") > before
    page.press("#tilt", "ArrowRight")
    assert page.get_attribute("#tilt", "aria-valuenow") is not None
    page.wait_for_function("Playground.painted()")
    box = page.locator("#map").bounding_box()
    page.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 0.2 * box["height"])
    state = page.evaluate("Playground.state")
    assert state["period"] > 1.7 and state["amplitude"] > 1.3
    assert page.inner_text("#verdict") == "overturns"


def test_reduced_motion_stands_still(opened):
    assert opened().inner_text("#play") == "Play"
    page = opened(reduced_motion="no-preference")
    assert page.inner_text("#play") == "Pause"
    page.wait_for_function("parseFloat(document.getElementById('clock').textContent) > 0.1")


def test_a_view_out_of_sight_is_painted_when_it_is_seen(opened):
    page = opened("#amplitude=0.35", viewport={"width": 390, "height": 844})
    picture = "document.getElementById('phase').toDataURL()"
    page.wait_for_selector("body[data-map=done]")
    before = page.evaluate(picture)
    page.fill("#s-slenderness", "0.2")
    page.wait_for_selector("body[data-map=done]")
    assert page.evaluate(picture) == before  # nobody sees it: no time is spent on it
    page.locator("#phase").scroll_into_view_if_needed()
    page.wait_for_function(f"{picture} !== '{before}'")
