"""What the report's first page takes of the studies: each number from the stored rows, no lucky setting, no silence."""

import re
from operator import itemgetter

import pytest
from page_numbers import number_in

from comparisons.report.write import SHORT
from comparisons.running.by_solver import read, results_in
from comparisons.running.cases import name_of
from comparisons.running.provenance import RESULTS
from comparisons.running.sources import source_digests
from comparisons.showing.parts import Head, where
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.stability.page import judgements as hard_cases


def stored(name):
    return read(RESULTS / name)


@pytest.mark.parametrize("name", BUILT_IN)
def test_what_shows_is_no_part_of_what_a_result_depends_on(name):
    behind = source_digests([name_of(get_study(name).plan)])
    assert behind and not [module for module in behind if module.endswith(".page") or ".showing" in module]


@pytest.mark.parametrize(
    "name, file", [(name, path.name) for name in BUILT_IN for path in results_in(RESULTS) if path.name.startswith(name)]
)
def test_a_page_writes_numbers_and_symbols_as_a_reader_does_and_its_finding_is_short(name, file):
    page = get_study(name).page(stored(file))
    whole, found = page.whole(), page.opening()
    assert all(len(row) == len(table.columns) for table in whole.tables for row in table.rows)
    assert name not in SHORT or len(found.figures) == 1 and sum(len(words.split()) for words in found.text) < 200
    words = [whole.title, *whole.text, *whole.measured, *(part for part in whole.shown if isinstance(part, str))]
    words += [part.words for part in whole.shown if isinstance(part, Head)]
    words += [
        text
        for figure in whole.figures
        for text in (figure.alt, figure.caption, re.sub("<[^>]*>", " ", figure.svg.decode()))
    ]
    words += [cell for table in whole.tables for row in ([table.caption], table.columns, *table.rows) for cell in row]
    assert not [text for text in words if re.search(r"\d[eE][-+]?\d|\b[a-zA-Z]_[a-zA-Z]\b|\bNone\b|\bnan\b", text)]


def test_the_boundaries_judged_are_those_where_the_block_stays_pressed():
    result, study = stored("overturning"), get_study("overturning")
    place, marks = itemgetter("ground", "shape", "frequency", "amplitude"), study.judgements(result)[0].marks
    edges = where(result.rows, part="edge")
    pressed = {place(row) for row in edges if row["min_normal"] >= 0}
    for name, _, _, _, _, largest, *_ in study.page(result).opening().tables[0].rows:
        pair = tuple(name.split(", "))
        mark, rows = marks[pair], where(result.rows, part="shift", engine=pair[0], variant=pair[1])
        shifts = [row["shift"] for row in rows if place(row) in pressed]
        found = [abs(shift) for shift in shifts if shift is not None]
        assert f"({len(found)} of {len(rows)} boundaries)" in mark.words and 0 < len(shifts) < len(rows) == len(edges)
        assert f"{len(shifts) - len(found)} not found" in mark.note
        beyond = [row["shift"] for row in rows if place(row) not in pressed]
        words = f"{len(beyond)} with N < 0 do not count, found {len(beyond) - beyond.count(None)}"
        assert words in mark.note
        assert [number_in(mark.words), number_in(largest)] == pytest.approx([100 * max(found)] * 2, rel=0.06)


def test_hard_cases_are_counted_as_the_settings_come():
    result = stored("stability")
    marks, cases = hard_cases(result)[0].marks, result.settings["cases"]
    within = {name for name, case in cases.items() if not case["outside"]}
    assert 0 < len(within) < len(cases)
    variants = {(variant["engine"], variant["variant"]): variant for variant in result.settings["variants"]}
    assert marks.keys() == variants.keys() - {("analytic", "")}  # the reference judges
    for (engine, variant), mark in marks.items():
        every = where(result.rows, engine=engine, variant=variant, part="default settings")
        rows, apart = where(every, case=within), where(every, case=cases.keys() - within)
        counts = [f"{len(where(some, result='right'))} of {len(some)}" for some in (rows, apart)]
        assert mark.words == f"{counts[0]} ({counts[1]} outside the range)"
        no_friction = variants[engine, variant]["applies_impact"]
        left = {name for name in within if no_friction and cases[name]["oracle"] == "model and Moreau"}
        left |= {name for name in within if not variants[engine, variant]["best"] and name.startswith("10 minutes")}
        assert {row["case"] for row in rows} == within - left


def test_names_of_hard_cases_are_whole_on_a_phone():
    (figure,) = get_study("stability").page(stored("stability")).opening().figures
    narrow = figure.svg.decode().split('class="narrow"')[-1]
    names = re.findall(r'<text class="soft" x="([\d.]+)" y="[^"]*" text-anchor="end">([^<]+)</text>', narrow)
    assert len(names) > 50 and all(float(x) > 6.8 * len(words) for x, words in names)  # a letter is 7 wide
