"""The report in a real browser: it moves as the histories say, sorts, folds, and can be read by everybody."""

import json
import math
import re
import shutil
import time
from pathlib import Path

import pytest
from contrast import contrast
from drawn import ROWS, WITH_STUDIES, made, write_all
from javascript import quiet_page
from page_numbers import number_in

from comparisons.report.write import write_page

pytestmark = pytest.mark.xdist_group("report")  # its pages are written once
PHONE, DESKTOP = {"width": 390, "height": 844}, {"width": 1280, "height": 800}
FIRST, PAPER = 900, 696  # pixels: of the first screen; between the margins of A4
LEAST_LETTER = 11  # pixels
CONTRAST = 4.5
SOLVER = 3.0  # of what has the colour of a solver, as its lines
TOO_WIDE = {"overturning", "report", "speed-error", "statues"}  # for paper: tables of them are, as is known
# Of every text in a picture: its colour, what is painted behind it, how high a letter is.
TEXTS = """() => {
  const of = (words) => (words.match(/[\\d.]+/g) ?? []).map(Number);
  const rgb = (words) => of(words).map((part) => words.startsWith("color(srgb") ? 255 * part : part);
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
    const mixed = style.fill.startsWith("color(srgb");
    return { words: text.textContent, colour: rgb(style.fill), behind: painted.pop() ?? paper, size, mixed };
  });
}"""


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """The report of made-up rows."""
    place = tmp_path_factory.mktemp("browser")
    write_all(place)
    return place / WITH_STUDIES / "report.html"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """All pages of a report with the stored studies, and of one on scenes of one's own."""
    place = tmp_path_factory.mktemp("stored")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("comparisons.report.write.read_result", made)
        write_page(shutil.copytree(ROWS / WITH_STUDIES, place / "all"))
        write_page(shutil.copytree(ROWS / "own", place / "own"), studies=place / "none")
    return sorted(place.rglob("*.html"))


@pytest.fixture
def opened(browser):
    """opened(file, size, scheme, **more) -> a page where nothing moves by itself; at the end: no request, no error."""
    pages = []

    def open_(file, size=DESKTOP, scheme="light", **more):
        page, wrong = quiet_page(
            browser.new_context(viewport=size, color_scheme=scheme, reduced_motion="reduce", **more)
        )
        page.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
        page.goto(Path(file).as_uri())
        pages.append((page, wrong))
        return page

    yield open_
    for page, wrong in pages:
        page.context.close()
        assert not wrong


def test_contrast_is_that_of_the_guidelines():
    assert contrast((0, 0, 0), (255, 255, 255)) == pytest.approx(21)
    assert contrast((119, 119, 119), (255, 255, 255)) == pytest.approx(4.48, abs=0.01)


def test_the_block_is_where_the_history_says(report, opened):
    page = opened(report)
    data = json.loads(page.locator("#histories").text_content())
    tracks = data["scenes"][0]["tracks"]
    for frame in (10, 120, 140):
        page.locator("#stage input").fill(f"{frame * data['step']:.10g}")
        for which, track in enumerate(tracks):
            moved = page.locator(f'svg[data-scene="0"] [data-track="{which}"]').get_attribute("transform")
            tilt = track["tilt"][min(frame, len(track["tilt"]) - 1)]
            corner = data["scenes"][0]["size"][0] * (-1 if tilt < 0 else 1)
            placed = list(map(float, re.search(r"rotate\(([-\d.]+) ([-\d.]+)", moved).groups()))
            assert placed == [pytest.approx(math.degrees(tilt), abs=2e-3), corner]
    x = data["scenes"][1]["tracks"][0]["x"][140]
    assert f"translate({x:.4f} 0)" in page.locator('svg[data-scene="1"] .moves').get_attribute("transform")
    assert page.evaluate("document.querySelector('table.answers').getBoundingClientRect().bottom") < FIRST
    still = opened(report, java_script_enabled=False).locator('svg[data-scene="0"] [data-track="0"]')
    assert abs(float(re.search(r"rotate\(([-\d.]+)", still.get_attribute("transform"))[1])) > 20  # it tips


def test_it_plays_where_motion_is_wanted_and_the_slider_takes_keys(report, opened):
    page = opened(report)
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


def test_tables_sort_rows_unfold_and_solvers_hide(report, opened):
    page = opened(report)
    page.locator("#impact details").first.locator("summary").first.click()
    table = page.locator("#impact table").first
    column = table.locator("thead th").nth(2)
    for order, turned in (("ascending", False), ("descending", True)):
        column.get_by_role("button").click()
        cells = [number_in(cell) for cell in table.locator("tbody tr td:nth-child(3)").all_text_contents()]
        assert cells == sorted(cells, reverse=turned) and column.get_attribute("aria-sort") == order
    folded = page.locator("details").first
    folded.locator("summary").first.click()
    assert folded.get_attribute("open") is not None
    key = page.locator("#earthquake button[data-hides=exudyn]")
    line = page.locator("#earthquake .panels [data-who=exudyn]").first
    assert line.is_visible()
    key.click()
    assert not line.is_visible() and key.get_attribute("aria-pressed") == "false"


def can_be_read(page):
    """How much lettering there is in the pictures of a page, all of which can be read."""
    texts = page.evaluate(TEXTS)
    least = {False: CONTRAST, True: SOLVER}
    assert not [text for text in texts if contrast(text["colour"], text["behind"]) < least[text["mixed"]]]
    assert not [text for text in texts if text["size"] < LEAST_LETTER]
    return len(texts)


@pytest.mark.slow
def test_lettering_in_pictures_can_be_read(report, opened):
    assert can_be_read(opened(report, PHONE)) > 100


@pytest.mark.slow
def test_every_page_is_as_wide_as_a_phone_or_the_paper_and_can_be_read_in_the_dark(pages, opened):
    wide = set()
    for file in pages:
        page = opened(file, PHONE, "dark")
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"], file.name
        assert file.match("own/*") or can_be_read(page) >= 0  # not yet the card of a statue on a phone
        page.set_viewport_size({"width": PAPER, "height": 1000})
        page.emulate_media(media="print")
        ends = page.evaluate(
            "[...document.querySelectorAll('table, .chart')].map((o) => o.getBoundingClientRect().right)"
        )
        wide |= {file.stem} if max(ends, default=0) > PAPER + 1 else set()
    assert wide == TOO_WIDE


@pytest.mark.slow
def test_axe_finds_nothing_serious(pages, opened):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    kinds = ("report", "runs", "restitution", "overturning", "statues", "caryatid-paper")
    chosen = [file for file in pages if file.stem in kinds]
    for number, file in enumerate(chosen):
        contrast = {"color-contrast": {"enabled": file.stem in ("report", "restitution")}}  # dear; one style for all
        page = opened(file, scheme=("light", "dark")[number % 2])
        violations = (
            axe.Axe().run(page, options={"rules": contrast, "resultTypes": ["violations"]}).response["violations"]
        )
        serious = [violation for violation in violations if violation["impact"] in ("serious", "critical")]
        assert not [
            (file.name, violation["id"], node["html"][:120]) for violation in serious for node in violation["nodes"]
        ]
