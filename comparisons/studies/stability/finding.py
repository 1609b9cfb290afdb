"""What the report shows of the hard cases: one sentence, one matrix, one short table, a column of verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Judgement, Mark, Section, Table, number
from .page import _cured, _reason, matrix
from .verdicts import DEGRADED, FAILED, RIGHT, worst

if TYPE_CHECKING:
    from ...running.provenance import Result

WRONG = "wrong"  # a degraded run whose outcome is another: never the colour of a small error
SIGNS = {RIGHT: "✓", DEGRADED: "~", WRONG: "≠", FAILED: "✗"}
MOST, SOME = 0.85, 0.6  # shares of cases from which a solver may be trusted, and is usable with care


def finding(result: Result) -> Section:
    """The `Section` of the report about hard cases."""
    cells, cases = matrix(result), list(result.settings["cases"])
    best = [name for name, solver in result.settings["solvers"].items() if solver["default_variant"]]
    engines = [name for name in best if result.settings["solvers"][name]["kind"] == "stepping"]
    ill = [
        case
        for case in cases
        if all(cells[case, name][0]["verdict"] != RIGHT for name in engines if (case, name) in cells)
    ]
    are = "is" if len(ill) == 1 else "are"
    where = "right in no engine" if len(engines) > 2 else f"not right in {' and '.join(engines)}"
    title = f"Where all fail: {len(ill)} of {len(cases)} hard cases {are} {where}" + (
        f" ({', '.join(ill[:3])}{' …' if len(ill) > 3 else ''})" if ill else ""
    )
    text = (
        "Scenes that have broken real integrators: pulses at the boundary, grazing corners, bases of a hundredth of "
        "the block, bearings a thousand times too stiff, ten minutes of shaking. A run is right if every measure is "
        "within its tolerance, degraded if it ends but is not right, failed if the solver says so or what it did is no "
        "motion of the scene.",
    )
    table = Table(
        "Verdicts, every solver and variant as it comes",
        ("solver", "right", "degraded", "failed", "cured by a finer setting"),
        [
            [
                name.replace("twin", "second implementation"),
                *(
                    str(sum(row["verdict"] == verdict for row, _ in _of(cells, name)))
                    for verdict in (RIGHT, DEGRADED, FAILED)
                ),
                str(sum(_cured(cure) for _, cure in _of(cells, name))),
            ]
            for name in sorted(result.settings["solvers"], key=lambda name: -_right(cells, name))
        ],
    )
    caption = (
        "✓ right, ~ degraded, ≠ another outcome, ✗ failed; under the pointer: the measure farthest outside its "
        "tolerance. 2nd code: the independent second implementation; steps: plain time stepping of the equations."
    )
    return Section(
        title,
        text,
        (table,),
        (figure([_matrix(cells, part, best) for part in _halves(cases)], caption),),
        measured=(
            "Judged by the kernel, its independent second implementation and, for free rocking, the closed form; "
            "trajectories up to each scene's sensitivity horizon; beyond it only outcomes that a change of 1e-4 does "
            "not alter. Ten minutes are run by the default variants alone. All measures, tolerances with their "
            "reasons, cures and evidence are on the study's page.",
        ),
    )


def judgement(result: Result) -> Judgement:
    """Hard cases right of all, by (engine, variant)."""
    cells, marks = matrix(result), {}
    for label in result.settings["solvers"]:
        name, _, variant = label.partition(", ")
        right, asked = _right(cells, label), len(_of(cells, label))
        level = "good" if right >= MOST * asked else "fair" if right >= SOME * asked else "bad"
        marks[name, variant] = Mark(f"{right} of {asked}", level)
    return Judgement("hard cases right", marks)


def _of(cells, name):
    """(row, cure) of every case that was asked of a solver."""
    return [cell for (_, solver), cell in cells.items() if solver == name]


def _right(cells, name):
    return sum(row["verdict"] == RIGHT for row, _ in _of(cells, name))


def _halves(cases):
    middle = (len(cases) + 1) // 2
    return cases[:middle], cases[middle:]


def _matrix(cells, cases, solvers):
    """A line per case, a column per solver."""
    chart = Chart(
        Axis("", -0.5, len(solvers) - 0.5, ticks=tuple((k, _short(name)) for k, name in enumerate(solvers))),
        Axis("", len(cases) - 0.5, -0.5, ticks=tuple(enumerate(cases))),
        "Verdicts: "
        + "; ".join(
            f"{name} right in {sum(cells[case, name][0]['verdict'] == RIGHT for case in cases)} of {len(cases)}"
            for name in solvers
        )
        + ".",
        left=168,
        right=4,
        foot=58,
        height=74 + 19 * len(cases),
    )
    for j, case in enumerate(cases):
        for i, name in enumerate(solvers):
            row, cure = cells[case, name]
            wrong = row["verdict"] == DEGRADED and worst(row)[0] == "outcome"
            kind = WRONG if wrong else row["verdict"]
            chart.cell(i, j, kind, SIGNS[kind], f"{case}, {name}: {_said(row, cure)}")
    return chart


def _short(name):
    return {"twin": "2nd code", "time-stepping": "steps"}.get(name, name.split(",")[0])


def _said(row, cure):
    if row["verdict"] == RIGHT:
        return RIGHT
    if row["verdict"] == FAILED:
        words = f"failed, {_reason(row)}"
    else:
        name, value, limit, _ = worst(row)
        words = (
            f"outcome {row['outcome']}" if name == "outcome" else f"{name} {number(value)}, tolerance {number(limit)}"
        )
    return words + ("; cured by a finer setting" if _cured(cure) else "")
