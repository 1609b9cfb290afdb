"""The speed-error study in the report: words, tables and figures, all from the result."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.parts import Section, Table, figure_of, number
from .figures import draw_growth, draw_pareto
from .ladders import NEEDED
from .measure import MEASURES
from .tables import (
    LEVELS,
    cost_at_error,
    extras,
    growths,
    ladder,
    law_cost,
    orders,
    principal,
    ranking_stability,
    unrepeatable,
)

if TYPE_CHECKING:
    from ...running.provenance import Result

SHOWN = (1e-2, 1e-3, 1e-4)  # levels of which the words speak


def section(result: Result) -> Section:
    """The study's `Section` of the report."""
    failed = [row for row in ladder(result) if row["failure"]]
    figures = [
        figure_of(
            draw_pareto(result),
            "Error against CPU time of every solver, one panel per scene.",
            "Error against CPU time of the very same runs: one point per setting of the accuracy knob, "
            "down and left is better. Crosses: impacts lost. Hollow: more is modelled than the scene "
            "needs.",
        ),
        figure_of(
            draw_pareto(result, x="step"),
            "Error against mean step of every solver, one panel per scene.",
            "Error against the mean step (simulated time over steps taken).",
        ),
    ]
    if growths(result):
        figures.append(
            figure_of(
                draw_growth(result),
                "CPU time and memory against duration, sample rate and runs.",
                "How the cost of a run grows. No run keeps a history.",
            )
        )
    return Section(
        "Speed against error",
        tuple(paragraphs(result)),
        tuple(tables(result)),
        tuple(figures),
        evidence=tuple(
            (
                f"{row['family']} at {row['knob']} = {row['value']:g}, {row['scene']}: {row['failure']['reason']}",
                row["failure"].get("message", ""),
            )
            for row in failed
        ),
    )


def paragraphs(result: Result) -> list[str]:
    """Plain words with computed numbers, list of str."""
    settings = result.settings
    text = [
        "Every solver runs a ladder of its accuracy knob on five scenes. Error and CPU time come from the same "
        f"runs: {settings['rounds']} fresh processes one after the other, in each every solver has its turn after "
        "a warm-up; CPU times are medians (of the simulation alone: no import, no compilation, no building of "
        "the scene). The paragraphs that follow say which engine, at which setting (SI units), keeps an error "
        "at least cost; those that decide the impact themselves come first."
    ]
    for scene, about in settings["scenes"].items():
        text.append(_scene_words(result, scene, about))
    if settings["changed_while_running"]:
        text.append(
            "While the study ran, this code was edited; the numbers are those of the code before: "
            + ", ".join(settings["changed_while_running"])
            + "."
        )
    text += _failure_words(result) + _extra_words(result) + _law_words(result) + _growth_words(result)
    tie, pairs, changed = ranking_stability(result)
    broken = unrepeatable(result)
    text.append(
        f"Repetition: the errors of {len(ladder(result)) - len(broken)} of {len(ladder(result))} settings are "
        "the same bit for bit in every round"
        + ("" if not broken else " (not: " + ", ".join(sorted({row["family"] for row in broken})) + ")")
        + f". Of {pairs} pairs of solvers that reach the same error at CPU times more than a factor of "
        f"{number(tie, 3)} apart, {len(changed)} swap places between the odd and the even rounds"
        + (
            ""
            if not changed
            else ": "
            + "; ".join(
                f"{one} and {other} ({_title(result, scene)}, {level:g})" for scene, level, one, other in changed
            )
        )
        + ". Solvers nearer than that share a rank: the same setting differs as much between its own rounds."
    )
    return text


def _scene_words(result, scene, about):
    """Cheapest engine that decides the impact itself, and the kernel, at each level: one sentence per scene."""
    measure = MEASURES[principal(result, scene)][0]
    applied = result.settings["applied_impacts"]
    parts, given = [], {family: [] for family in applied}
    for level in SHOWN:
        best = cost_at_error(result, scene, level)
        kernel = best.get("kernel")
        engine = next((row for family, row in best.items() if row["variant"] and family not in applied), None)
        if kernel is None:
            continue
        parts.append(
            f"{level:g} by no engine"
            if engine is None
            else (
                f"{level:g} by {engine['family']} at {engine['knob']} {number(engine['value'])} in "
                f"{number(engine['cpu_seconds'], 2)} s, {number(engine['cpu_seconds'] / kernel['cpu_seconds'], 2)} "
                "times the analytic kernel"
            )
        )
        for family in applied.keys() & best.keys():
            given[family].append(f"{level:g} in {number(best[family]['cpu_seconds'], 2)} s")
    words = f"{about['title']}. An error ({measure}) of at most " + "; ".join(parts) + "."
    return words + "".join(
        f" {family}, whose impacts are the adapter's own: {'; '.join(costs)}."
        for family, costs in given.items()
        if costs
    )


def _failure_words(result):
    """Which settings failed, and which found no boundary: they have no place in the tables."""
    rows, words = ladder(result), []
    failed = _counted(result, [row for row in rows if row["failure"]], rows)
    if failed:
        words.append(f"Failed, with the solver's own message below: {failed}.")
    searched = [row for row in rows if principal(result, row["scene"]) == "boundary_shift" and not row["failure"]]
    none = _counted(result, [row for row in searched if "boundary_shift" not in row["errors"]], searched)
    if none:
        words.append(f"No overturning boundary near the reference's (the search went on moving, by 5 % a run): {none}.")
    return words


def _title(result, scene):
    return result.settings["scenes"][scene]["title"]


def _counted(result, rows, among):
    """ "solver: 2 of 5 settings (scene)" for those that occur in `rows`."""
    parts = []
    for key in dict.fromkeys((row["family"], row["model"], row["scene"]) for row in rows):
        some, every = (
            sum((row["family"], row["model"], row["scene"]) == key for row in group) for group in (rows, among)
        )
        parts.append(f"{key[0]}: {some} of {every} settings ({_title(result, key[2])})")
    return "; ".join(parts)


def _extra_words(result):
    models = extras(result)
    if not models:
        return []
    words = []
    for model in dict.fromkeys(row["model"] for row in models):
        ratios = [row["cost_ratio"] for row in models if row["model"] == model]
        low, high = number(min(ratios), 2), number(max(ratios), 2)
        words.append(f"{model}: {low if low == high else f'{low} to {high}'} times the CPU time of what is needed")
    return [
        "More modelled than the scene needs – " + "; ".join(words) + ". The table says what each does to the error."
    ]


def _law_words(result):
    ratios = [
        f"{number(middle, 3)} times in {family} ({_title(result, scene)}; {number(low, 3)} to {number(high, 3)})"
        for (scene, family), (middle, low, high) in law_cost(result).items()
    ]
    if not ratios:
        return []
    changed = "; ".join(
        f"{_title(result, scene)}: {number(100 * change['peak_displacement'], 2)} %"
        for scene, change in result.settings["laws"].items()
    )
    return [
        "A Bouc-Wen bearing costs, over the algebraic law at the same setting: "
        + ", ".join(ratios)
        + f". It changes the peak displacement, whatever the solver: {changed}."
    ]


def _growth_words(result):
    grown = growths(result)
    words = []
    for (against, family), series in grown.items():
        if "exponent" in series:
            words.append(
                f"{family} against {against}: {number(series['exponent'], 3)} ± "
                f"{number(series['exponent_error'], 1)} (last doubling: {number(series['last_exponent'], 3)})"
            )
    if not words:
        return []
    memory = grown.get(("duration", "kernel"))
    text = "CPU time grows as a power of – " + "; ".join(words) + "."
    if memory:
        traced, value = memory["traced_bytes"], memory["value"]
        text += (
            f" The kernel allocates {number(traced[0] / 2**20, 3)} MiB for {value[0]:g} s without history and "
            f"{number(traced[-1] / 2**20, 3)} MiB for {value[-1]:g} s; the engines' adapters keep every step "
            "until the run is measured, so theirs grow with the duration."
        )
    return [text]


def tables(result: Result) -> list[Table]:
    """Cost at an error for every scene; observed orders; what the scene needs; cost per second and per step."""
    costs = [_cost_table(result, scene, about) for scene, about in result.settings["scenes"].items()]
    return [*costs, _order_table(result), _extra_table(result), _unit_table(result)]


def _cost_table(result, scene, about):
    columns = {level: cost_at_error(result, scene, level) for level in LEVELS}
    families = list(dict.fromkeys(family for level in LEVELS for family in columns[level]))
    rows = [[family, *(_cell(columns[level].get(family)) for level in LEVELS)] for family in families]
    return Table(
        f"{about['title']}: CPU time [ms] of one run to reach an error (lowest – highest round; setting)",
        (MEASURES[principal(result, scene)][0], *(f"≤ {level:g}" for level in LEVELS)),
        rows,
    )


def _cell(row):
    if row is None:
        return "–"
    cpu, low, high = (number(1e3 * row[name], 3) for name in ("cpu_seconds", "cpu_low", "cpu_high"))
    return f"{cpu} ({low} – {high}; {number(row['value'])})"


def _order_table(result):
    scenes = result.settings["scenes"]
    by_scene = [orders(result, scene, "value") for scene in scenes]
    rows = []
    for family in dict.fromkeys(row["family"] for row in ladder(result)):
        fits = [by_family.get(family) for by_family in by_scene]
        if any(fits):
            rows.append(
                [family, *("–" if fit is None else f"{fit[0]:.2f} ± {fit[1]:.2f}".replace("-", "−") for fit in fits)]
            )
    return Table(
        "Observed order q: error ~ knob^q, ± standard error; the knob is a step, a tolerance, a contact "
        "stiffness or an accuracy [-]",
        ("solver", *(about["title"] for about in scenes.values())),
        rows,
    )


def _extra_table(result):
    rows = [
        [
            f"{row['model']}: {row['family']}, {row['knob']} {row['value']:.3g}",
            result.settings["scenes"][row["scene"]]["title"],
            number(row["cost_ratio"], 3),
            number(row["needed_error"], 2) + _lost(row["needed_lost"]),
            number(row["error"], 2) + _lost(row["lost_impacts"]),
        ]
        for row in extras(result)
    ]
    return Table(
        "What the scene needs, and more: cost and error (principal measure of the scene)",
        (
            "modelled beyond need",
            "scene",
            "CPU time over the needed model's [-]",
            "error as needed",
            "error with the extra",
        ),
        rows,
    )


def _lost(count):
    return f" ({count} impacts lost)" if count else ""


def _unit_table(result):
    rows = []
    for family in dict.fromkeys(row["family"] for row in ladder(result)):
        mine = [
            row for row in ladder(result) if row["family"] == family and row["model"] == NEEDED and "cpu_seconds" in row
        ]
        steps = [row["cpu_per_step"] for row in mine if row["cpu_per_step"]]
        if mine:
            rows.append([family, _range([row["cpu_per_second"] for row in mine], 1.0), _range(steps, 1e6)])
    return Table(
        "Cost over all scenes and settings, lowest to highest",
        ("solver", "CPU time per simulated second [s/s]", "CPU time per step [µs]"),
        rows,
    )


def _range(values, unit):
    return "–" if not values else f"{number(unit * min(values), 2)} – {number(unit * max(values), 2)}"
