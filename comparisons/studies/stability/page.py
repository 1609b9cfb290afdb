"""What is shown of the stability study."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Head, Judgement, Mark, Page, short
from ...showing.rows import NAME as ENGINE
from ...showing.rows import Column, grouped, table, where
from .study import DEFAULT, DIFFERS, FAILED, FINER, RIGHT, worst

if TYPE_CHECKING:
    from ...running.provenance import Result

WRONG = "wrong"  # a run that differs in its outcome: never the colour of a small error
# sign in a cell, its class in the style sheet
SIGNS = {
    RIGHT: ("✓", RIGHT),
    DIFFERS: ("~", "degraded"),
    WRONG: ("≠", WRONG),
    FAILED: ("✗", FAILED),
    "": ("–", "shade"),
}
NOT_RUN = {"sign": "", "told": "not run", "remedy": "not tried"}
MOST, SOME = 0.85, 0.6  # shares of cases from which a solver may be trusted, and is usable with care
SLANT = 4.1  # height of a letter of the slanted names below a matrix
TWIN = "second implementation"
SHORT = {TWIN: "2nd code", "time-stepping": "steps"}


def _readable(words):
    """Words with powers of ten as a reader writes them."""
    return re.sub(r"\d[.\d]*e[-+]?\d+", lambda found: short(float(found[0])).removeprefix("1·"), words)


NAME = Column("solver, variant", lambda row: TWIN if row["engine"] == "twin" else ENGINE.of(row))
CASE = Column("case", lambda row: _readable(row["case"]))
TOLERANCE = Column("tolerance", "tolerance", digits=None)


def page(result: Result) -> Page:
    """The `Page` of a `Result` of the stability study."""
    cases, measures = result.settings["cases"], result.settings["measures"]
    cells, variants = _cells(result), result.settings["variants"]
    counts = sorted(_counts(result, cells), key=lambda row: -row[RIGHT])
    wrong = [cell for cell in cells.values() if cell["result"] != RIGHT]
    return Page(
        _title(cells, cases, where(variants, kind="stepping", best=True)),
        (
            "Scenes that have broken real integrators: pulses at the boundary, grazing impacts, a base of a "
            "ten-thousandth of the block, ten minutes of shaking. A result is right if every measure is within its "
            "tolerance. It differs if the run ends but is not right. It failed if the solver gives up, takes too long "
            "or moves the block as no block moves.",
            _most(where(counts, kind="stepping")),
        ),
        first=(
            _matrix(
                cells,
                cases,
                where(variants, best=True),
                "Default settings. ✓ right, ~ differs, ≠ another outcome, ✗ failed; under the pointer: the measure "
                "farthest outside its tolerance. 2nd code: the independent second implementation; steps: plain time "
                "stepping of the equations.",
            ),
            table(
                "Results with default settings",
                counts,
                NAME,
                *(Column(f"{name} [-]", name) for name in (RIGHT, DIFFERS, FAILED)),
                Column("right with finer settings [-]", FINER),
            ),
        ),
        more=(
            _matrix(cells, cases, where(variants, best=False), "The engines’ other variants. –: not run."),
            table(
                "Where default settings are not right",
                wrong,
                CASE,
                NAME,
                Column("result", "result"),
                Column("measure farthest outside", "measure"),
                Column("value", "value", digits=None),
                TOLERANCE,
                Column("also outside", "others"),
                Column("finer settings that are right", "remedy"),
            ),
            Head("Measures and cases"),
            table(
                "Measures",
                [
                    {
                        "kind": kind,
                        "name": name,
                        "unit": unit or "-",
                        "what": what,
                        "tolerance": limit,
                        "reason": reason,
                    }
                    for kind, limits in result.settings["tolerances"].items()
                    for name, (limit, reason) in limits.items()
                    for unit, what in (measures[name],)
                ],
                Column("measure", "name"),
                Column("solvers", "kind"),
                Column("what it is", "what"),
                TOLERANCE,
                Column("unit", "unit"),
                Column("reason", lambda row: _readable(row["reason"])),
            ),
            table(
                "Cases",
                [{**case, "case": name} for name, case in cases.items()],
                CASE,
                Column("what is hard", lambda row: _readable(row["title"])),
                Column("judged by, and tolerances of its own", _judge),
                Column("duration [s]", "duration", digits=None),
            ),
        ),
        how=(
            "Judged by the analytic kernel, its independent second implementation and, for free rocking, the closed "
            "form. Trajectories are compared up to each scene’s sensitivity horizon and unstable point; beyond, only "
            "outcomes that a change of 10⁻⁴ does not alter. Energy drift and gain are what exceeds the same measure "
            "of the reference.",
            "Where a result is not right, finer settings are tried in turn. Scenes of ten minutes are run by default "
            f"variants alone. A run may take {result.settings['time_limit']:g} s.",
        ),
        evidence=tuple(
            (
                f"{name}: {reason} ({', '.join(map(CASE.of, rows))})",
                "\n".join(f"{key}: {value}" for key, value in rows[0]["failure"].items())
                + f"\nlast state: {rows[0]['last_state']}\nsettings: {rows[0]['settings'] or rows[0]['set']}",
            )
            for (name, reason), rows in grouped(where(wrong, result=FAILED), NAME.of, "measure").items()
        ),
    )


def judgement(result: Result) -> Judgement:
    """Hard cases right of all, by (engine, variant)."""
    marks = {}
    for row in _counts(result, _cells(result)):
        level = "good" if row[RIGHT] >= MOST * row["run"] else "fair" if row[RIGHT] >= SOME * row["run"] else "bad"
        marks[row["engine"], row["variant"]] = Mark(f"{row[RIGHT]} of {row['run']}", level)
    return Judgement("hard cases right", marks)


def _cells(result):
    """{(case, name): row with default settings, what is farthest outside in it, and what finer settings do}.

    These are tried in turn until one is right: the last one counts.
    """
    finer = {(row["case"], NAME.of(row)): row for row in where(result.rows, part=FINER)}
    cells = {}
    for row in where(result.rows, part=DEFAULT):
        key = row["case"], NAME.of(row)
        cells[key] = {**row, **_farthest(row, result.settings["measures"]), **_remedy(row, finer.get(key))}
    return cells


def _farthest(row, measures):
    if row["result"] == FAILED:
        failure = row["failure"]
        reason = failure["kind"] if failure["kind"] == "time limit" else failure["reason"]
        return {"sign": FAILED, "measure": reason, "value": None, "tolerance": None, "others": [], "told": reason}
    name, value, limit = worst(row)
    others = [other for other in row["outside"] if other != name]
    found = {"measure": f"{name} [{measures[name][0] or '-'}]", "value": value, "tolerance": limit, "others": others}
    if row["result"] == RIGHT:
        return {**found, "sign": RIGHT, "told": RIGHT}
    if name == "outcome":
        return {**found, "sign": WRONG, "told": f"outcome {row['outcome']}"}
    return {**found, "sign": DIFFERS, "told": f"{name} {short(value)}, tolerance {short(limit)}"}


def _remedy(row, finer):
    """Which finer settings are right, in words."""
    if finer is None:
        return {"tried": False, "cured": False, "remedy": "not tried"}
    if finer["result"] != RIGHT:
        return {"tried": True, "cured": False, "remedy": "none found"}
    changed = [(key, value) for key, value in finer["set"].items() if row["set"].get(key) != value]
    unit = {"stiffness": " N/m", "tolerance": ""}
    words = ", ".join(f"{key.replace('_', ' ')} = {short(value)}{unit.get(key, ' s')}" for key, value in changed)
    return {"tried": True, "cured": True, "remedy": words}


def _counts(result, cells):
    """Each variant with the numbers of its results, of runs, and of finer settings tried and right."""
    variants = {NAME.of(variant): variant for variant in result.settings["variants"]}
    for (name,), rows in grouped(cells.values(), NAME.of).items():
        found = {kind: len(where(rows, result=kind)) for kind in (RIGHT, DIFFERS, FAILED)}
        finer = {"tried": len(where(rows, tried=True)), FINER: len(where(rows, cured=True))}
        yield {**variants[name], **found, **finer, "run": len(rows)}


def _title(cells, cases, engines):
    names = [NAME.of(engine) for engine in engines]
    none = [case for case in cases if not any(_result(cells, case, name) == RIGHT for name in names)]
    listed = _readable(f" ({', '.join(none[:3])}{' …' if len(none) > 3 else ''})") if none else ""
    if len(names) > 2:
        return f"Hard cases: no engine solves {len(none)} of {len(cases)}{listed}"
    return f"Hard cases: {len(none)} of {len(cases)} are not right in {' and '.join(names)}{listed}"


def _most(counts):
    """Who solves most, and what finer settings change."""
    most = max((row[RIGHT] for row in counts), default=0)
    names = " and ".join(NAME.of(row) for row in counts if row[RIGHT] == most)
    run, right, tried, cured = (sum(row[key] for row in counts) for key in ("run", RIGHT, "tried", FINER))
    return (
        f"Of the solvers that step, most cases are right in {names}: {most}. Of their {run - right} results that are "
        f"not right, finer settings were tried for {tried} and are right in {cured}."
    )


def _result(cells, case, name):
    return cells[case, name]["result"] if (case, name) in cells else None


def _matrix(cells, cases, variants, caption):
    """A line for each case, a column for each variant, in two halves; None: no variants."""
    names, middle = [NAME.of(variant) for variant in variants], (len(cases) + 1) // 2
    if not names:
        return None
    words = [SHORT.get(name, name.partition(", ")[0] if variant["best"] else name)
             for name, variant in zip(names, variants, strict=True)]  # fmt: skip
    foot = 22 + round(SLANT * max(map(len, words)))
    charts = []
    for half in (list(cases)[:middle], list(cases)[middle:]):
        right = [f"{name} right in {[_result(cells, case, name) for case in half].count(RIGHT)}" for name in names]
        chart = Chart(
            Axis("", -0.5, len(names) - 0.5, ticks=tuple(enumerate(words))),
            Axis("", len(half) - 0.5, -0.5, ticks=tuple(enumerate(map(_readable, half)))),
            f"Results of {len(half)} cases: {'; '.join(right)}.",
            left=168,
            right=4,
            foot=foot,
            height=16 + foot + 19 * len(half),
        )
        for j, case in enumerate(half):
            for i, name in enumerate(names):
                cell = cells.get((case, name), NOT_RUN)
                sign, kind = SIGNS[cell["sign"]]
                chart.cell(
                    i, j, kind, sign, f"{_readable(case)}, {name}: {cell['told']}; finer settings: {cell['remedy']}"
                )
        charts.append(chart)
    return figure(charts, caption)


def _judge(case):
    """Who judges a case, and its own tolerances."""
    until = case["twin_until"]
    words = {"free rocking": "closed form"}.get(case["oracle"], f"kernel and {TWIN}")
    words += "" if until is None else f" (this one up to {until:g} s; beyond, the energy ledger)"
    own = [
        f"{name} {short(limit)} for {kind} solvers: {reason}"
        for kind, limits in case["tolerances"].items()
        for name, (limit, reason) in limits.items()
    ]
    return _readable("; ".join([words, *own]))
