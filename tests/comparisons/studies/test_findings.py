"""What the report's first page takes of the studies: each number from the stored rows, no lucky setting, no silence."""

import re
from collections import Counter
from operator import itemgetter
from xml.etree import ElementTree

import pytest
from page_numbers import number_in

from comparisons.report.write import SHORT
from comparisons.running.by_solver import read, results_in
from comparisons.running.cases import name_of
from comparisons.running.provenance import RESULTS
from comparisons.running.sources import source_digests
from comparisons.showing.parts import NAME, Head, where
from comparisons.showing.wording import ENDS, FALL, TURNED
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.stability.page import judgements as hard_cases
from engines import ENGINES, get_engine


def stored(name):
    return read(RESULTS / name)


SUBJECTS = [name for name, engine in ENGINES.items() if engine.subject]


def panels(name):
    """The panels of a study's figures on the report's first page."""
    svg = "".join(figure.svg.decode() for figure in get_study(name).page(stored(name)).opening().figures)
    return list(ElementTree.fromstring(f"<all>{svg}</all>"))


def told(name):
    """What the marks of these figures tell under the pointer."""
    return [part.get("data-says") for panel in panels(name) for part in panel.iter() if part.get("data-says")]


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


def test_the_coarse_scan_has_its_failed_runs_and_those_that_are_left_out():
    result, study = stored("overturning"), get_study("overturning")
    rated, scan = study.page(result).opening().tables
    assert not any(cell == "0 of 0" for row in rated.rows for cell in row)
    points = 2 * 3 * 4 * 11  # grounds, shapes, frequencies, amplitudes
    rows = where(result.rows, part="scan")
    assert len(scan.rows) == len(rows) > 5
    for (name, *counts, share), row in zip(scan.rows, rows, strict=True):
        runs, left, missed, added, failed = map(int, counts)
        assert (name, runs, left) == (NAME.of(row), row["runs"], points - row["runs"])
        assert (missed, added, failed) == (row["only_a"], row["only_b"], row["failed"])
        assert number_in(share) == pytest.approx(100 * (missed + added + failed) / runs, rel=0.06)


@pytest.mark.parametrize("name", ["recorded", "fragility", "statues"])
def test_falls_at_another_time_have_a_column_apart_from_overturnings_missed_or_added(name):
    """And no title rests on a rule that so few motions cannot meet."""
    opening = get_study(name).page(stored(name)).opening()
    heads = [head for table in opening.tables for head in table.columns]
    for way in (TURNED, FALL, "failed", "edge"):
        assert heads.count(ENDS[way]) == 1
    words = " ".join((opening.title, *opening.text, *heads))
    assert not re.search(r"\bequal\b|inconclusive|at most 5 %", words)


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


def test_no_two_panels_of_the_first_page_have_one_title():
    found = [text.text for name in SHORT for panel in panels(name) for text in panel.iter("text")
             if text.get("class") == "title"]  # fmt: skip
    assert len(found) > 15 and not [title for title, count in Counter(found).items() if count > 1]


@pytest.mark.parametrize("name, part", [("overturning", "shift"), ("statues", "drawn shift")])
def test_every_boundary_of_a_variant_that_is_drawn_stands_at_its_shift_or_is_counted_at_the_frame(name, part):
    result, says = stored(name), told(name)
    own, drawn = result.settings["default_variants"], 0
    for one in result.settings["variants"]:
        rows = where(result.rows, part=part, engine=one["engine"], variant=one["variant"])
        found = sum(row["shift"] is not None for row in rows)
        if rows and (one["tier"] == "defaults" or own[one["engine"]] == one["variant"]):
            drawn += 1
            assert sum(words.startswith(f"{NAME.of(one)}: ") and " on " in words for words in says) == found
            lost = f"{one['engine']}, {one['tier']}: {len(rows) - found} not found"
            assert (lost in says) == (found < len(rows))
    assert drawn == 2 * len(own) - 1  # one engine has a variant as it comes alone


def drawn_as(row):
    """Whose marks a row's are: of the tuned variants, the main one's have the name of their kind."""
    other = row["tier"] == "tuned" and get_engine(row["engine"]).default_variant != row["variant"]
    return NAME.of(row) if other else f"{row['engine']}, {row['tier']}"


def test_every_judged_run_under_a_record_is_a_mark_and_a_failed_one_stands_at_the_frame():
    marks, heights = Counter(), {}
    for panel in panels("recorded"):
        for group in panel.iter("g"):
            places = [part.get("transform") for part in group if (part.get("class") or "").startswith("dot")]
            marks[group.get("data-who")] += len(places)
            heights.setdefault(group.get("data-who"), []).extend(float(re.findall(r"[\d.]+", one)[1]) for one in places)
    runs = [
        row for row in where(stored("recorded").rows, part="run", engine=set(SUBJECTS)) if row["class"] != "left out"
    ]
    judged = Counter(map(drawn_as, runs))
    assert {who: marks[who] for who in judged} == judged
    assert len([who for who in judged if who.endswith((", tuned", ", defaults"))]) == 2 * len(SUBJECTS)
    failed = Counter(map(drawn_as, where(runs, **{"class": "failed"})))
    top = min(min(places) for places in heights.values() if places)
    assert {who: places.count(top) for who, places in heights.items() if places.count(top)} == failed and failed


def test_hard_cases_have_a_column_for_the_engines_in_question_as_they_come():
    result, says = stored("stability"), told("stability")
    within = [case for case in result.settings["cases"].values() if not case.get("outside")]
    shown = [one for one in result.settings["variants"] if one["best"] or one["tier"] == "defaults"]
    shown = [one for one in shown if one["engine"] != "analytic"]  # the reference judges
    assert len(says) == 2 * len(within) * len(shown)  # on a wide page, and on a phone
    assert {one["tier"] for one in shown} > {"tuned", "defaults"}


def test_names_of_hard_cases_are_whole_on_a_phone():
    (figure,) = get_study("stability").page(stored("stability")).opening().figures
    narrow = figure.svg.decode().split('class="narrow"')[-1]
    names = re.findall(r'<text class="soft" x="([\d.]+)" y="[^"]*" text-anchor="end">([^<]+)</text>', narrow)
    assert len(names) > 50 and all(float(x) > 6.8 * len(words) for x, words in names)  # a letter is 7 wide


@pytest.mark.parametrize("what", ["Error of restitution by states, rms;", "First impact on rigid ground."])
def test_the_legend_names_the_engines_in_question_tuned_and_as_they_come(what):
    figures = get_study("restitution").page(stored("restitution")).whole().figures
    (figure,) = [one for one in figures if one.caption.startswith(what)]
    assert {f"{engine}, {kind}" for engine in SUBJECTS for kind in ("tuned", "defaults")} < set(figure.solvers)
    for who, key in figure.keys.items():
        assert ('class="dot open"' in key) == who.endswith(", defaults"), who
    others = {who for who in figure.solvers if who.endswith(", defaults")} - {f"{one}, defaults" for one in SUBJECTS}
    assert len(others) == 1  # an engine that has no other variant
