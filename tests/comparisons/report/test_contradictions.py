"""No two places contradict each other: one rating of a variant everywhere, titles as tables, the README as results."""

import itertools
import json
import re
from xml.etree import ElementTree

import pytest

from analytic import EngineNotInstalled
from comparisons.report.answer import judgements_of, setups_of, stored_studies, variants_of
from comparisons.report.gallery import (
    GALLERY,
    README,
    RESULTS_README,
    first_screen,
    gallery,
    headlines,
    origins,
    with_findings,
)
from comparisons.running.by_solver import read, results_in
from comparisons.running.provenance import RESULTS
from comparisons.showing.parts import NAME, RESTITUTION, number, percent, where
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.restitution.columns import STATE
from comparisons.studies.restitution.page import rated
from engines import ENGINES
from engines.contract import Engine

pytestmark = pytest.mark.xdist_group("contradictions")  # the stored studies are shown once
STORED = [name for name in BUILT_IN if (RESULTS / name).exists()]
NUMBER = re.compile(r"(?<![\w.,−·])\d+(?:\.\d+)?(?![\w.])")


@pytest.fixture(scope="module")
def studies():
    """The stored studies as they are shown where no engine is installed."""

    def missing(self):
        raise EngineNotInstalled(f"{self.name} is not installed")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Engine, "load", missing)
        return stored_studies()


@pytest.fixture(scope="module")
def decision(studies):
    """The setups of the first screen from the stored results."""
    setups = setups_of(variants_of(studies), judgements_of(studies))
    return {(one.engine, one.variant): one for one in setups}


def shown(name):
    """(page, judgements) of a study's stored result."""
    study, result = get_study(name), read(RESULTS / name)
    return study.page(result).whole(), study.judgements(result)


def numbers_of(tables):
    """Numbers that the cells hold, the number of rows, and of rows whose cells begin alike."""
    found = set()
    for table in tables:
        found |= {number for row in table.rows for cell in row for number in NUMBER.findall(cell)}
        found.add(str(len(table.rows)))
        for column in zip(*table.rows, strict=True):
            found |= {str(column.count(cell)) for cell in set(column)}
            words = {cell.partition(" of ")[0] for cell in column}
            found |= {str(sum(cell.startswith(word) for cell in column)) for word in words if word}
    return found


def test_every_stored_result_can_be_shown_without_any_engine(studies):
    assert {one.name for one in studies} >= set(STORED) and not [one.wrong for one in studies if one.wrong]


@pytest.mark.parametrize("name", STORED)
def test_every_number_of_a_title_is_one_of_its_tables(name):
    page, _ = shown(name)
    known = numbers_of(page.tables)
    if name == "statues":  # its title adds up the tuned engines
        for scenes in dict.fromkeys(row[2] for row in page.tables[0].rows):
            tuned = [row for row in page.tables[0].rows if row[1:3] == ["tuned", scenes]]
            judged = page.tables[0].columns[3 : page.tables[0].columns.index("left out near an outcome boundary [-]")]
            sums = {head: sum(int(row[page.tables[0].columns.index(head)]) for row in tuned) for head in judged}
            known |= {str(sums["right [-]"]), str(sum(sums.values()))}
    heads = " ".join(text for table in page.tables for text in (table.caption, *table.columns))
    assert not set(NUMBER.findall(page.title)) - known - set(NUMBER.findall(heads))


def test_the_rating_of_restitution_is_the_same_on_the_first_screen_and_on_its_page(decision):
    words = {"good": "may be trusted", "fair": "is usable", "bad": "is not to be trusted"}
    rows = rated(read(RESULTS / "restitution"))
    page, judgements = shown("restitution")
    (heading,) = (one.heading for one in judgements if one.key == RESTITUTION)
    table = page.tables[0]
    told = {line[0]: line[table.columns.index(STATE.head)] for line in table.rows}
    assert len(rows) >= 8
    for row in rows:
        mark = decision[row["engine"], row["variant"]].marks[heading]
        assert row["rating"] == words[mark.level]
        if not row["applies_impact"]:  # the number of the first screen, of the same errors
            assert told[NAME.of(row)] == STATE.text({"rms_state": mark.value})


@pytest.mark.parametrize("name", STORED)
def test_what_a_study_says_on_the_first_screen_stands_in_its_own_tables(name):
    page, judgements = shown(name)
    for judgement in judgements:
        marks = {", ".join(filter(None, key)): mark for key, mark in judgement.marks.items() if key[0] in ENGINES}
        assert marks
        for who, mark in marks.items():
            rows = [row for table in page.tables for row in table.rows if row[0] == who]
            first = NUMBER.findall(mark.words)[:1]  # of "36 of 41": the cases are counted elsewhere
            assert rows and set(first) <= set(NUMBER.findall(" ".join(itertools.chain.from_iterable(rows))))


def test_cost_is_one_number_in_title_table_and_first_screen(studies, decision):
    (study,) = (one for one in studies if one.name == "speed-error")
    heading = study.judgements[0].heading
    ratios = [
        one.marks[heading].words.removesuffix(" ×") for one in decision.values() if one.in_first_table and one.best
    ]
    page, says = shown("speed-error")[0], study.glance.says["cost"]
    assert len(ratios) == 2 and all(ratio in page.title and ratio in says for ratio in ratios)
    words, script = says.split(" A script")
    noise = number(study.glance.alike, 2)
    known = numbers_of(page.tables) | set(NUMBER.findall(page.tables[0].caption))
    assert set(NUMBER.findall(words)) <= known | {noise} and f"factor of {noise} are not distinguished" in page.text[0]
    advised = [one for one in study.glance.advice if one.engine]
    costs = {f"{number(1e3 * one.cost, 2)} ms ({one.engine})" for one in advised if one.accuracy == 1e-3}
    assert len(costs) == 2 and all(cost in words for cost in costs)  # one number in the line and in the recommendation
    rows = where(read(RESULTS / "speed-error").rows, scene="isolated-rocking", variant="script")
    assert len(rows) == 2 == len(re.findall(r" ms with an error of ", script))
    for row in rows:
        cost = number(1e3 * row["cpu_per_second"] * row["cpu_low"] / row["cpu_seconds"], 2)
        assert f"{cost} ms with an error of {percent(row['errors']['peak_tilt'])} ({row['engine']})" in script
    levels = {decision[one.engine, one.variant].rating.level for one in advised}
    assert levels <= {"good", "part", "fair"}  # with care: hard cases


def test_the_chart_of_outcomes_counts_what_the_table_of_all_tests_does(studies):
    """Of a study that rates outcomes alone, all that differ; of one that rates more, no more than are not right."""
    compared = 0
    for study in (one for one in studies if one.glance and one.glance.endings):
        for judgement, ending in itertools.product(study.judgements, study.glance.endings):
            mark = judgement.marks.get((ending.engine, ending.variant))
            count = mark and re.match(r"(\d+) of (\d+)\b", mark.words)
            if count and judgement.heading.startswith("outcomes"):
                near = judgement.heading.endswith("near outcome boundaries too")
                there = (ending.left_differing, ending.left_out) if near else (0, 0)
                found = ending.differing + there[0], ending.runs + there[1]
                assert found == tuple(map(int, count.groups()))
            elif count and judgement.heading == "sliding scenes right":
                assert ending.differing <= ending.runs - int(count[1]) and ending.runs == int(count[2])
            compared += bool(count)
    assert compared > 20


def test_the_readme_shows_and_says_what_the_stored_results_do(studies):
    first, readme = first_screen(studies), README.read_text(encoding="utf-8")
    made, words = gallery(first), headlines(first)
    assert {file.name: file.read_text(encoding="utf-8") for file in GALLERY.iterdir()} == made and len(made) == 2
    for name, svg in made.items():
        root = ElementTree.fromstring(svg)
        assert f"comparisons/report/gallery/{name}" in readme
        assert root.tag == "{http://www.w3.org/2000/svg}svg" and root.get("aria-label")
        assert "prefers-color-scheme" in svg and "http://" not in svg.replace("http://www.w3.org", "")
    assert words in readme and len(first["lines"]) == 5
    assert with_findings(readme, words) == readme != with_findings(readme, "- something else")


def test_the_readme_of_the_results_says_where_each_of_them_comes_from():
    folders = results_in(RESULTS)
    readme, table = RESULTS_README.read_text(encoding="utf-8"), origins({path.name: read(path) for path in folders})
    assert readme == with_findings(readme, table)
    lines = {line.split("`")[1]: line for line in table.splitlines()[2:]}
    assert list(lines) == [path.name for path in folders]
    for path in folders:  # as the files themselves have it
        line, contents = lines[path.name], [json.loads(file.read_text()) for file in path.glob("*.json")]
        engines = {str(row.get("engine")) for content in contents for row in content["rows"]}
        assert {name for name in ENGINES if name in line} == ENGINES.keys() & engines
        origins_here = [content["provenance"] for content in contents]
        for origin in origins_here:
            assert all(words in line for words in (origin["time"][:10], origin["machine"]["processor"]))
            assert origin["commit"][:12] + ", with uncommitted changes" * origin["dirty"] in line
        if checks := [origin["check"] for origin in origins_here if origin.get("check")]:
            held, runs = (sum(check[name] for check in checks) for name in ("held", "runs"))
            assert f"| {held} of {runs}, {min(check['date'] for check in checks)} |" in line
