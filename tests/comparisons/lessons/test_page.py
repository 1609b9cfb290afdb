"""The playground and the exported pages in a browser: they ask for nothing, and sliders give the kernel's numbers."""

import math

import pytest
from javascript import quiet_page

from analytic import PulseMotion, load_scene, simulate
from comparisons.lessons import export
from comparisons.lessons.export import PAGE, playground_page
from comparisons.lessons.topics import lessons

pytestmark = pytest.mark.xdist_group("lessons in a browser")


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


@pytest.mark.slow
def test_a_moved_slider_gives_the_kernels_number(opened):
    page = opened("#amplitude=0.35&period=0.5")
    page.fill("#s-slenderness", "0.2")
    scene = load_scene("caryatid-rigid").with_(block={"slenderness": 0.2})
    scene = scene.with_(motion=PulseMotion("one-sine", 0.35 * 9.81, 2 * math.pi / 0.5), duration=10.0)
    response = simulate(scene)
    assert value(page, "peak") == pytest.approx(response.peak_tilt, rel=1e-9)
    assert value(page, "impacts") == len(response.impacts)
    assert page.inner_text("#verdict") == response.outcome


@pytest.mark.slow
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


@pytest.mark.slow
def test_presets_keys_and_clicks_move_slider_map_and_time(opened):
    page = opened("#amplitude=0.35", viewport={"width": 1280, "height": 1100})
    assert page.inner_text("#play") == "Play"  # reduced motion stands still
    page.press("#s-slenderness", "ArrowRight")
    assert page.evaluate("Playground.state.slenderness") == pytest.approx(0.285)
    page.wait_for_function("Playground.painted()")
    box = page.locator("#map").bounding_box()
    page.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 0.2 * box["height"])
    state = page.evaluate("Playground.state")
    assert state["period"] > 1.7 and state["amplitude"] > 1.3
    assert page.inner_text("#verdict") == "overturns"
    page.click("text=An engine errs")
    page.wait_for_selector("#ghost-verdict[data-wrong=true]")
    assert page.inner_text("#verdict") == "rocks" and "overturns" in page.inner_text("#ghost-verdict")


def visit(browser, path):
    """The page on a phone; it asks for nothing, has no error, and does not scroll sideways."""
    page, wrong = quiet_page(browser.new_context(reduced_motion="reduce", viewport={"width": 390, "height": 844}))
    page.goto(path.as_uri())
    assert wrong == [] and page.evaluate("document.documentElement.scrollWidth") <= 390
    return page


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    export.export_pages(folder)
    return folder


@pytest.mark.long  # the export runs all lessons
def test_the_other_pages(browser, pages):
    for name in ("index", "derivations", "teacher"):
        for image in visit(browser, pages / f"{name}.html").query_selector_all("img"):
            image.scroll_into_view_if_needed()
            assert (pages / image.get_attribute("src")).is_file()
    assert (pages / "figures/lesson-2.png").read_bytes()[16:24] == (1920).to_bytes(4, "big") + (1080).to_bytes(4, "big")
    assert export.LICENCE in (pages / "figures/lesson-2.svg").read_text()


@pytest.mark.long  # the export runs all lessons
def test_a_moved_slider_of_every_lesson_shows_the_kernels_number(browser, pages):
    for lesson in lessons():
        page = visit(browser, pages / f"lesson-{lesson.number}.html")
        before = page.inner_html("#picture")
        for k, control in enumerate(lesson.controls):
            if control.in_words:
                page.check(f'[name="c-{k}"][value="{len(control.values) - 1}"]')
            else:
                page.press(f"#c-{k}", "End")
        assert page.inner_html("#picture") != before
        numbers = {
            name: value for name, (value, _) in lesson.view(*lesson.places()[-1]).numbers.items() if "CPU" not in name
        }
        for label, number in numbers.items():
            shown = page.get_attribute(f'[data-name="{label}"]', "data-value")
            assert isinstance(number, str) or float(shown) == pytest.approx(float(number), rel=1e-12, abs=1e-300), label
