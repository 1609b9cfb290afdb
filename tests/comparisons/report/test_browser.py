"""The report in a real browser: it moves as the histories say, sorts, folds, and can be read by everybody."""

import json
import math
import re
import time
from pathlib import Path

import pytest
from contrast import contrast
from javascript import NEEDED, chromium, quiet_page
from page_numbers import number_in

from comparisons.report.write import write_page
from engines import installed_engines

pytestmark = [pytest.mark.xdist_group("report"), pytest.mark.skipif(chromium() is None, reason=NEEDED)]
PHONE, DESKTOP = {"width": 390, "height": 844}, {"width": 1280, "height": 800}
FIRST, PAPER = 900, 696  # pixels: of the first screen; between the margins of A4
LEAST_LETTER = 11  # pixels
CONTRAST = 4.5
# Of every text in a picture: its colour, what is painted behind it, how high a letter is.
TEXTS = """() => {
  const rgb = (words) => (words.match(/[\\d.]+/g) ?? []).map(Number);
  const paper = rgb(getComputedStyle(document.body).backgroundColor);
  const covers = (a, b) => a.left < b.x && a.right > b.x && a.top < b.y && a.bottom > b.y;
  const seen = (text) => text.textContent.trim() && text.getClientRects().length;
  return [...document.querySelectorAll("main svg text")].filter(seen).map((text) => {
    const style = getComputedStyle(text), box = text.getBoundingClientRect();
    const middle = { x: box.left + box.width / 2, y: box.top + box.height / 2 };
    const painted = [...text.ownerSVGElement.querySelectorAll("rect, polygon")]
      .filter((shape) => covers(shape.getBoundingClientRect(), middle))
      .map((shape) => rgb(getComputedStyle(shape).fill)).filter((colour) => colour.length > 2);
    const scale = text.getScreenCTM(), size = parseFloat(style.fontSize) * Math.hypot(scale.a, scale.b);
    return { words: text.textContent, colour: rgb(style.fill), behind: painted.pop() ?? paper, size };
  });
}"""


@pytest.fixture(scope="module")
def folder(copy_of, studies, tmp_path_factory):
    """A report with some stored studies."""
    folder = copy_of(tmp_path_factory.mktemp("browser"))
    write_page(folder, studies)
    return folder


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield browser
        browser.close()


def opened(browser, file, size=DESKTOP, scheme="light"):
    """(page, what it did wrong) of a file at a size; nothing moves by itself."""
    context = browser.new_context(viewport=size, color_scheme=scheme, reduced_motion="reduce")
    page, wrong = quiet_page(context)
    page.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
    page.goto(Path(file).as_uri())
    return page, wrong


def test_contrast_is_that_of_the_guidelines():
    assert contrast((0, 0, 0), (255, 255, 255)) == pytest.approx(21)
    assert contrast((119, 119, 119), (255, 255, 255)) == pytest.approx(4.48, abs=0.01)


def test_the_block_is_where_the_history_says(folder, browser):
    page, wrong = opened(browser, folder / "report.html")
    data = json.loads(page.locator("#histories").text_content())
    tracks = data["scenes"][0]["tracks"]
    assert [track["who"] for track in tracks] == ["analytic", *installed_engines()]
    for frame in (10, 120, 140):
        page.locator("#stage input").fill(f"{frame * data['step']:.10g}")
        for which, track in enumerate(tracks):
            moved = page.locator(f'svg[data-scene="0"] [data-track="{which}"]').get_attribute("transform")
            tilt = track["tilt"][min(frame, len(track["tilt"]) - 1)]
            corner = data["scenes"][0]["size"][0] * (-1 if tilt < 0 else 1)
            found = list(map(float, re.search(r"rotate\(([-\d.]+) ([-\d.]+)", moved).groups()))
            assert found == [pytest.approx(math.degrees(tilt), abs=2e-3), corner]
    x = data["scenes"][1]["tracks"][0]["x"][140]
    assert f"translate({x:.4f} 0)" in page.locator('svg[data-scene="1"] .moves').get_attribute("transform")
    assert not wrong


def test_it_plays_where_motion_is_wanted_and_the_slider_takes_keys(folder, browser):
    page, wrong = opened(browser, folder / "report.html")
    slider = page.locator("#stage input")
    still = float(slider.input_value())
    slider.focus()
    page.keyboard.press("ArrowRight")
    assert float(slider.input_value()) > still and page.locator("#stage output").text_content() != f"{still:.2f} s"
    page.keyboard.press("Home")
    assert float(slider.input_value()) == 0
    page.get_by_role("button", name="Play").click()
    begun = time.monotonic()  # the page's policy forbids what `wait_for_function` does
    while float(slider.input_value()) <= 0.2:
        assert time.monotonic() - begun < 20
        page.wait_for_timeout(50)
    page.get_by_role("button", name="Pause").click()
    assert not wrong


def test_tables_sort_rows_unfold_and_solvers_hide(folder, browser):
    page, wrong = opened(browser, folder / "report.html")
    page.locator("#impact details").first.locator("summary").first.click()
    table = page.locator("#impact table").first
    column = table.locator("thead th").nth(2)
    for order, turned in (("ascending", False), ("descending", True)):
        column.get_by_role("button").click()
        cells = [number_in(one) for one in table.locator("tbody tr td:nth-child(3)").all_text_contents()]
        assert cells == sorted(cells, reverse=turned) and column.get_attribute("aria-sort") == order
    folded = page.locator("details").first
    folded.locator("summary").first.click()
    assert folded.get_attribute("open") is not None
    who = installed_engines()[0]
    key = page.locator(f"#earthquake button[data-hides={who}]")
    line = page.locator(f"#earthquake .panels [data-who={who}]").first
    assert line.is_visible()
    key.click()
    assert not line.is_visible() and key.get_attribute("aria-pressed") == "false"
    assert not wrong


@pytest.mark.parametrize("file", ["report.html", "pages/restitution.html"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_lettering_in_pictures_can_be_read(folder, browser, scheme, file):
    page, wrong = opened(browser, folder / file, PHONE, scheme)
    texts = page.evaluate(TEXTS)
    assert len(texts) > 100
    assert not [text for text in texts if contrast(text["colour"], text["behind"]) < CONTRAST]
    assert not [text for text in texts if text["size"] < LEAST_LETTER]
    assert not wrong


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(folder, browser, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    for file in (folder / "report.html", folder / "pages/runs.html", folder / "pages/restitution.html"):
        page, _ = opened(browser, file, DESKTOP, scheme)
        found = axe.Axe().run(page).response["violations"]
        serious = [one for one in found if one["impact"] in ("serious", "critical")]
        assert not [(one["id"], node["html"][:120]) for one in serious for node in one["nodes"]]


def test_every_page_opens_without_errors_and_without_a_wide_scroll(folder, browser):
    for file in folder.rglob("*.html"):
        page, wrong = opened(browser, file, PHONE)
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"], file.name
        assert not wrong, file.name
        page.context.close()


def test_the_first_table_is_on_the_first_screen(folder, browser):
    page, _ = opened(browser, folder / "report.html")
    assert page.evaluate("document.querySelector('table.answers').getBoundingClientRect().bottom") < FIRST


def test_nothing_is_wider_than_the_paper(folder, browser):
    for file in folder.rglob("*.html"):
        page, _ = opened(browser, file, {"width": PAPER, "height": 1000})
        page.emulate_media(media="print")
        wide = (
            f"[...document.querySelectorAll('table, .chart')].map(one => one.getBoundingClientRect().right - {PAPER})"
        )
        assert max(page.evaluate(wide), default=0) < 1, file.name
        page.context.close()


def test_without_scripts_there_is_a_frame_to_see(folder, browser):
    context = browser.new_context(java_script_enabled=False, viewport=DESKTOP)
    page = context.new_page()
    page.goto((folder / "report.html").as_uri())
    moved = page.locator('svg[data-scene="0"] [data-track="0"]').get_attribute("transform")
    assert abs(float(re.search(r"rotate\(([-\d.]+)", moved)[1])) > 20  # tipping, not yet down
