"""The exported pages in a browser: no request, no script error, and a moved slider shows the kernel's number."""

import dataclasses
import math

import pytest
from javascript import quiet_page

from analytic import simulate
from comparisons.lessons import export
from comparisons.lessons.topics import NAMES, impacts, lesson


def visit(browser, path, **context):
    """The page; it asks for nothing, has no error, and does not scroll sideways."""
    page, wrong = quiet_page(browser.new_context(reduced_motion="reduce", **context))
    page.goto(path.as_uri())
    assert wrong == []
    assert page.evaluate("document.documentElement.scrollWidth") <= page.viewport_size["width"]
    return page


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Pages with one lesson at three places of its slider."""
    chosen = lesson("impacts")
    short = dataclasses.replace(chosen, controls=(dataclasses.replace(chosen.controls[0], values=(0.2, 0.28, 0.4)),))
    folder = tmp_path_factory.mktemp("pages")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "lesson", lambda name: short)
        export.export_pages(folder, ["impacts"])
    return folder


def test_a_moved_slider_shows_the_kernels_number(browser, pages):
    page = visit(browser, pages / "lesson-2.html", viewport={"width": 390, "height": 844})
    before = page.inner_html("#picture")
    page.focus("#c-0")
    page.keyboard.press("ArrowRight")
    impact = simulate(impacts.let_go(0.4), history=False).impacts[0]
    shown = page.get_attribute('[data-name="rate after / before, simulated"]', "data-value")
    assert float(shown) == pytest.approx(impact.rate_after / impact.rate_before, rel=1e-12)
    assert float(shown) == pytest.approx(1 - 1.5 * math.sin(0.4) ** 2, rel=1e-9)
    assert page.inner_html("#picture") != before
    assert page.inner_text("#o-0") == "0.40 rad"


def test_the_other_pages(browser, pages):
    for name in ("index", "derivations", "teacher"):
        page = visit(browser, pages / f"{name}.html", viewport={"width": 390, "height": 844})
        for image in page.query_selector_all("img"):
            image.scroll_into_view_if_needed()
            page.wait_for_function("image => image.complete && image.naturalWidth > 0", arg=image)
    assert (pages / "figures/lesson-2.png").read_bytes()[16:24] == (1920).to_bytes(4, "big") + (1080).to_bytes(4, "big")
    assert export.LICENCE in (pages / "figures/lesson-2.svg").read_text()


@pytest.mark.slow
def test_every_lesson(browser, tmp_path):
    export.export_pages(tmp_path)
    for name in NAMES:
        one = lesson(name)
        page = visit(browser, tmp_path / f"lesson-{one.number}.html", viewport={"width": 390, "height": 844})
        last = one.places()[-1]
        for k, control in enumerate(one.controls):
            place = len(control.values) - 1
            if control.in_words:
                page.check(f'[name="c-{k}"][value="{place}"]')
            else:
                page.focus(f"#c-{k}")
                page.keyboard.press("End")
        for label, (value, _) in one.view(*last).numbers.items():
            shown = page.get_attribute(f'[data-name="{label}"]', "data-value")
            if isinstance(value, str) or "CPU" in label:
                continue
            assert float(shown) == pytest.approx(float(value), rel=1e-12, abs=1e-300), (name, label)
