"""The exported pages in a browser: no request, no script error, and a moved slider shows the kernel's number."""

import dataclasses
import math

import pytest
from javascript import quiet_page

from comparisons.lessons import export
from comparisons.lessons.topics import lesson, lessons


def visit(browser, path):
    """The page on a phone; it asks for nothing, has no error, and does not scroll sideways."""
    page, wrong = quiet_page(browser.new_context(reduced_motion="reduce", viewport={"width": 390, "height": 844}))
    page.goto(path.as_uri())
    assert wrong == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    return page


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Pages with one lesson at three places of its slider."""
    chosen = lesson("impacts")
    short = dataclasses.replace(chosen, controls=(dataclasses.replace(chosen.controls[0], values=(0.2, 0.28, 0.4)),))
    folder = tmp_path_factory.mktemp("pages")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "lessons", lambda: [short])
        export.export_pages(folder)
    return folder


def test_a_moved_slider_shows_the_kernels_number(browser, pages):
    page = visit(browser, pages / "lesson-2.html")
    before = page.inner_html("#picture")
    page.press("#c-0", "ArrowRight")
    shown = page.get_attribute('[data-name="rate after / before, simulated"]', "data-value")
    assert float(shown) == pytest.approx(1 - 1.5 * math.sin(0.4) ** 2, rel=1e-9)
    assert page.inner_html("#picture") != before
    assert page.inner_text("#o-0") == "0.40 rad"


def test_the_other_pages(browser, pages):
    for name in ("index", "derivations", "teacher"):
        page = visit(browser, pages / f"{name}.html")
        for image in page.query_selector_all("img"):
            image.scroll_into_view_if_needed()
            page.wait_for_function("image => image.complete && image.naturalWidth > 0", arg=image)
    assert (pages / "figures/lesson-2.png").read_bytes()[16:24] == (1920).to_bytes(4, "big") + (1080).to_bytes(4, "big")
    assert export.LICENCE in (pages / "figures/lesson-2.svg").read_text()


@pytest.mark.long
def test_every_lesson(browser, tmp_path):
    export.export_pages(tmp_path)
    for one in lessons():
        page = visit(browser, tmp_path / f"lesson-{one.number}.html")
        for k, control in enumerate(one.controls):
            if control.in_words:
                page.check(f'[name="c-{k}"][value="{len(control.values) - 1}"]')
            else:
                page.press(f"#c-{k}", "End")
        for label, (value, _) in one.view(*one.places()[-1]).numbers.items():
            shown = page.get_attribute(f'[data-name="{label}"]', "data-value")
            if not isinstance(value, str) and "CPU" not in label:
                assert float(shown) == pytest.approx(float(value), rel=1e-12, abs=1e-300), (one.name, label)
