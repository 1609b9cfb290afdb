"""What the report's first page takes of the studies: each number from the stored rows, no lucky setting, no silence."""

import re

import pytest
from page_numbers import number_in

from comparisons.report.write import SHORT
from comparisons.running.provenance import RESULTS, Result, read_result
from comparisons.showing.parts import Head
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.overturning.finding import judgement as boundaries
from comparisons.studies.speed_error.finding import passing
from comparisons.studies.stability.finding import judgement as hard_cases


def stored(name):
    return read_result(RESULTS / f"{name}.json")


@pytest.mark.parametrize("name", SHORT)
def test_a_finding_is_one_sentence_one_figure_and_short_tables(name):
    found = get_study(name).finding(stored(name))
    assert 20 < len(found.title) < 200 and len(found.figures) == 1 and found.measured
    assert sum(len(paragraph.split()) for paragraph in found.text) < 200
    for table in found.tables:
        assert table.rows and all(len(row) == len(table.columns) for row in table.rows)


@pytest.mark.parametrize(
    "name, file",
    [(name, file.stem) for name in BUILT_IN for file in sorted(RESULTS.glob(f"{name}*.json")) if get_study(name).page],
)
def test_a_page_writes_numbers_and_symbols_as_a_reader_does(name, file):
    whole = get_study(name).page(stored(file)).whole()
    words = [whole.title, *whole.text, *whole.measured, *(part for part in whole.shown if isinstance(part, str))]
    words += [part.words for part in whole.shown if isinstance(part, Head)]
    words += [
        text
        for figure in whole.figures
        for text in (figure.alt, figure.caption, re.sub("<[^>]*>", " ", figure.svg.decode()))
    ]
    words += [cell for table in whole.tables for row in ([table.caption], table.columns, *table.rows) for cell in row]
    assert not [text for text in words if re.search(r"\d[eE][-+]?\d|\b[a-zA-Z]_[a-zA-Z]\b|\bNone\b|\bnan\b", text)]


def test_the_errors_of_restitution_are_the_worse_of_both_grounds():
    result = stored("restitution")
    (table,) = get_study("restitution").finding(result).tables
    rows = [row for row in result.rows if row["part"] == "summary" and row["scope"] == "all" and row["rms"] is not None]
    checked = 0
    for name, _, error, worst, _, _ in table.rows:
        mine = [row for row in rows if f"{row['engine']}, {row['variant']}" == name]
        assert number_in(error) == pytest.approx(max(row["rms"] for row in mine), rel=0.06)
        assert number_in(worst) == pytest.approx(max(row["worst"] for row in mine), rel=0.06)
        checked += 1
    assert checked >= 8


def test_the_boundaries_judged_are_those_where_the_block_stays_pressed():
    result = stored("overturning")
    pressed = {
        (row["ground"], row["shape"], row["frequency"], row["amplitude"])
        for row in result.rows
        if row["part"] == "edge" and row["min_normal"] >= 0
    }
    for solver in result.settings["solvers"]:
        shifts = [
            row["shift"]
            for row in result.rows
            if row["part"] == "shift"
            and row["solver"] == solver
            and (row["ground"], row["shape"], row["frequency"], row["amplitude"]) in pressed
        ]
        mark = boundaries(result).marks[tuple(solver.split(", "))]
        assert mark.note == f"{sum(shift is not None for shift in shifts)} of {len(shifts)} boundaries found"
        assert number_in(mark.words) == pytest.approx(
            100 * max(abs(shift) for shift in shifts if shift is not None), rel=0.06
        )


def test_hard_cases_are_counted_as_the_settings_come():
    result = stored("stability")
    for (name, variant), mark in hard_cases(result).marks.items():
        label = f"{name}, {variant}" if variant else name
        verdicts = [row["verdict"] for row in result.rows if row["solver"] == label and row["cure"] is None]
        assert mark.words == f"{verdicts.count('right')} of {len(verdicts)}"
        spared = 0 if result.settings["solvers"][label]["default_variant"] else 2  # scenes of ten minutes
        assert len(verdicts) == len(result.settings["cases"]) - spared


def ladder(errors, failed=()):
    """A ladder of one engine from coarse to fine with these errors, the finer the dearer."""
    rows = [
        {
            "table": "ladder",
            "scene": "s",
            "family": "one, fine",
            "model": "as needed",
            "law": None,
            "solver": "one",
            "value": 10.0**-k,
            "knob": "step",
            "failure": {"reason": "NaN"} if k in failed else None,
            "errors": {"impact_time": error},
            "lost_impacts": 0,
            "cpu_seconds": 1.0 + k,
        }
        for k, error in enumerate(errors)
    ]
    return Result("speed-error", {"scenes": {"s": {"measures": ["impact_time"]}}}, rows, {})


@pytest.mark.parametrize(
    "errors, failed, chosen",
    [
        ([1e-1, 1e-2, 1e-4, 1e-5], (), 2),
        ([1e-5, 1e-2, 1e-4, 1e-5], (), 2),  # the first passes by luck: a finer one does not
        ([1e-1, 1e-5, 1e-2], (), None),  # the finest does not pass: nothing may be recommended
        ([1e-1, 1e-5, 1e-5, 1e-5], (2,), 3),  # one that failed parts the ladder
    ],
)
def test_the_cheapest_setting_is_one_that_no_finer_one_contradicts(errors, failed, chosen):
    found = passing(ladder(errors, failed), "s", 1e-3)
    assert {family: row["value"] for family, row in found.items()} == (
        {} if chosen is None else {"one, fine": 10.0**-chosen}
    )
