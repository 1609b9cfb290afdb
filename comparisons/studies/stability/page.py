"""The stability study as a picture and as a section of the report."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.colors import to_rgb
from matplotlib.figure import Figure as Canvas
from matplotlib.patches import Rectangle

from ...showing.parts import Section, Table, figure_of, number
from .verdicts import DEGRADED, FAILED, MEASURES, RIGHT, worst

if TYPE_CHECKING:
    from ...running.provenance import Result

# Okabe and Ito; told apart by lightness and by the words in the cells, too
COLOURS = {RIGHT: "#B5DDF2", DEGRADED: "#E69F00", FAILED: "#882200"}
CURED = "cured"
WRAP = 14  # characters that a cell holds
FINDINGS = "Case", "Solver", "Verdict", "Measure", "Value", "Tolerance", "Cure"
CAPTIONS = (
    "Verdicts. In the cells: the measure that is farthest outside its tolerance (tol.), and by how many times, or the "
    "count lost; “cured”: a setting tried makes it right.",
    "The same of the engines' other variants.",
)
CLASSES = {"event-driven": "event-driven solvers", "stepping": "solvers that step"}


def matrix(result: Result) -> dict[tuple[str, str], tuple[dict[str, Any], dict[str, Any] | None]]:
    """(case, solver) -> (its row as the settings come, the row of the last cure tried or None).

    Cures are tried in turn until one is right. What was not asked is missing.
    """
    cells = {}
    for row in result.rows:
        key = row["case"], row["solver"]
        cells[key] = (row, None) if row["cure"] is None else (cells[key][0], row)
    return cells


def _cured(cure):
    return cure is not None and cure["verdict"] == RIGHT


def pictures(result: Result) -> dict[str, Canvas]:
    """The matrix of verdicts in two: the references and the engines' best, and all other variants."""
    cases, cells = list(result.settings["cases"]), matrix(result)
    return {name: draw(cases, half, cells) for name, half in zip(("", "others"), halves(result), strict=True) if half}


def halves(result: Result) -> tuple[list[str], list[str]]:
    """(references and default variants, all others) of a result."""
    solvers = result.settings["solvers"]
    best = [name for name, solver in solvers.items() if solver["default_variant"]]
    return best, [name for name in solvers if name not in best]


def draw(cases: Sequence[str], solvers: Sequence[str], cells: Mapping[tuple[str, str], Any]) -> Canvas:
    """The matrix of verdicts: a line per case, a column per solver; a matplotlib Figure. cells: of `matrix`."""
    canvas = Canvas(figsize=(2.2 + 0.76 * len(solvers), 1.4 + 0.39 * len(cases)), layout="constrained")
    axes = canvas.add_subplot()
    for j, case in enumerate(cases):
        for i, solver in enumerate(solvers):
            if (case, solver) not in cells:
                axes.text(i, j, "not\ntested", ha="center", va="center", fontsize=6.5, color="grey", linespacing=0.95)
                continue
            row, cure = cells[case, solver]
            colour = COLOURS[row["verdict"]]
            axes.add_patch(Rectangle((i - 0.5, j - 0.5), 1, 1, facecolor=colour, edgecolor="white", linewidth=1.5))
            dark = sum(to_rgb(colour)) < 1.2
            axes.text(
                i,
                j,
                _word(row) + ("\n" + CURED if _cured(cure) else ""),
                ha="center",
                va="center",
                fontsize=6.5,
                color="white" if dark else "black",
                linespacing=0.95,
            )
    axes.set(xlim=(-0.5, len(solvers) - 0.5), ylim=(len(cases) - 0.5, -0.5))
    axes.set_xticks(
        range(len(solvers)), [solver.replace(", ", "\n").replace("-", "-\n") for solver in solvers], fontsize=7
    )
    axes.set_yticks(range(len(cases)), cases, fontsize=7.5)
    axes.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
    for spine in axes.spines.values():
        spine.set_visible(False)
    return canvas


def _word(row):
    """What a cell says: the verdict, and by how much or in what it misses."""
    if row["verdict"] == RIGHT:
        return RIGHT
    if row["verdict"] == FAILED:
        return f"{FAILED}:\n" + "\n".join(textwrap.wrap(_reason(row), WRAP)[:3])
    name, value, limit, ratio = worst(row)
    if name == "outcome":
        return f"wrong:\n{row['outcome']}"
    amount = f"{number(ratio, 2)} × tol." if math.isfinite(ratio) else f"{value:g}" if value else "none"
    return "\n".join([*textwrap.wrap(name, WRAP), amount])


def _reason(row):
    return "time limit" if row["failure"]["kind"] == "time limit" else row["failure"]["reason"]


def section(result: Result) -> Section:
    """The study's section of the report."""
    cells, (best, _) = matrix(result), halves(result)
    counts = _counts(result, cells)
    drawn = [
        figure_of(picture, _spoken([row for row in counts if row[0] in half]), caption)
        for picture, half, caption in zip(pictures(result).values(), halves(result), CAPTIONS, strict=False)
    ]
    ill = [(row, cure) for row, cure in cells.values() if row["verdict"] != RIGHT]
    others = "\n".join(
        "; ".join(f"{head}: {cell}" for head, cell in zip(FINDINGS, _line(row, cure), strict=True))
        for row, cure in ill
        if row["solver"] not in best
    )
    evidence = (
        ("Where the other variants are not right", others or "nowhere"),
        *((f"{row['case']}: {row['solver']}", _evidence(row)) for row, _ in ill if row["verdict"] == FAILED),
    )
    tables = (
        Table("Verdicts by solver", ("Solver", "right", "degraded", "failed", "of these cured"), counts),
        Table(
            "Where the default variants are not right, and what was measured there",
            FINDINGS,
            [_line(row, cure) for row, cure in ill if row["solver"] in best],
        ),
        *_rules(result),
    )
    return Section(
        "Numerical stability on hard cases", _text(result, cells, ill), tables, tuple(drawn), evidence=evidence
    )


def _counts(result, cells):
    """Of each solver: its name, right, degraded and failed cells, and the cured ones of these, as words."""
    return [
        [
            solver,
            *(
                str(sum(row["verdict"] == verdict for (_, name), (row, _) in cells.items() if name == solver))
                for verdict in (RIGHT, DEGRADED, FAILED)
            ),
            str(sum(_cured(cure) for (_, name), (_, cure) in cells.items() if name == solver)),
        ]
        for solver in result.settings["solvers"]
    ]


def _rules(result):
    """Tables of the tolerances and of the cases."""
    for kind, limits in result.settings["tolerances"].items():
        yield Table(
            f"Tolerances of {CLASSES[kind]}",
            ("Measure", "Tolerance", "Unit", "Reason"),
            [[name, number(limit), MEASURES[name][0], reason] for name, (limit, reason) in limits.items()],
        )
    yield Table(
        "The cases",
        ("Case", "What is hard", "Judged by, and tolerances of its own", "Duration [s]"),
        [
            [name, case["title"], _oracle(case), number(case["duration"])]
            for name, case in result.settings["cases"].items()
        ],
    )


def _text(result, cells, ill):
    event = [name for name, solver in result.settings["solvers"].items() if solver["kind"] == "event-driven"]
    steppers = [name for name in result.settings["solvers"] if name not in event]
    engine = [row for (_, name), (row, _) in cells.items() if name in steppers]
    first = (
        f"{len(result.settings['cases'])} scenes that have broken real integrators, each run by "
        f"{len(result.settings['solvers'])} solvers and variants as they come. A run is right if every measure is "
        "within its tolerance, degraded if it ends but is not right, failed if the solver says so, crashes or "
        "takes more than the time limit, or if what it did is no motion of the scene: states not finite, energy "
        "from nowhere, the block off its place. Scenes of ten minutes are run by the default variants alone."
    )
    own = [row for row, _ in ill if row["solver"] in event]
    right = {
        name: sum(row["verdict"] == RIGHT for (_, solver), (row, _) in cells.items() if solver == name)
        for name in steppers
    }
    trusted = [name for name, count in right.items() if count == len(result.settings["cases"])]
    best = [name for name, count in right.items() if count == max(right.values())]
    answer = (
        "Which solver that steps may be trusted in all cases as hard as these? "
        f"{', '.join(trusted) or 'None'}; the most, {max(right.values(), default=0)} of "
        f"{len(result.settings['cases'])}, in {' and '.join(best) or 'none'}. The tables say what was wrong in the "
        "others, by how much, and which setting cures it."
    )
    of_events = sum(name in event for _, name in cells)
    second = (
        f"The event-driven solvers (the analytic kernel, and its twin in plain scipy) are right in "
        f"{of_events - len(own)} of {of_events} cells; "
        f"the solvers that step in {sum(row['verdict'] == RIGHT for row in engine)} of {len(engine)}, degraded "
        f"in {sum(row['verdict'] == DEGRADED for row in engine)}, failed in "
        f"{sum(row['verdict'] == FAILED for row in engine)}."
    )
    stepped = [(row, cure) for row, cure in ill if row["solver"] in steppers]
    cured, vain = (sum(cure is not None and _cured(cure) == good for _, cure in stepped) for good in (True, False))
    third = (
        f"Of the {len(stepped)} cells of theirs that are not right, a finer setting cures {cured}; {vain} stay "
        f"wrong with every setting tried, and in {len(stepped) - cured - vain} none was tried."
    )
    fourth = (
        "Trajectories are compared up to the sensitivity horizon of each scene, and up to the unstable point; "
        "beyond, only outcomes that a change of 1e-4 does not alter. Drift and gained energy are what a "
        "solver shows beyond what the same measure shows on the reference."
    )
    return first, second, answer, third, fourth


def _spoken(counts):
    return "Matrix of verdicts. " + "; ".join(
        f"{name}: {right} right, {degraded} degraded, {failed} failed" for name, right, degraded, failed, _ in counts
    )


def _line(row, cure):
    return [row["case"], row["solver"], row["verdict"], *_findings(row), _cure(row, cure)]


def _findings(row):
    if row["verdict"] == FAILED:
        return row["failure"]["reason"], "–", "–"
    name, value, limit, _ = worst(row)
    others = [other for other in row["outside"] if other != name]
    return name + (f" (also {', '.join(others)})" if others else ""), number(value), number(limit)


def _cure(row, cure):
    if cure is None:
        return "not tried"
    if not _cured(cure):
        return "none found"
    changed = {key: value for key, value in cure["set"].items() if row["set"].get(key) != value}
    return ", ".join(f"{key} = {value:g}" for key, value in changed.items())


def _oracle(case):
    if case["oracle"] == "free rocking":
        return "closed form of free rocking"
    until = case["twin_until"]
    text = case["oracle"] + ("" if until is None else f" (the twin up to {until:g} s; beyond, the energy ledger)")
    own = [
        f"{name} {limit:g} for {CLASSES[kind]}: {reason}"
        for kind, limits in case["tolerances"].items()
        for name, (limit, reason) in limits.items()
    ]
    return "; ".join([text, *own])


def _evidence(row):
    failure, lines = row["failure"], []
    for key, value in {**failure, "last state": row["last_state"], "settings": row["settings"] or row["set"]}.items():
        lines.append(f"{key}: {value}")
    return "\n".join(lines)
