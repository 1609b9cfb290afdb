"""The kernel beside other integrators: cost at an error, error against cost, throughput; all from the result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...showing.charts import Chart, figure, log_axis
from ...showing.parts import Section, Table, number
from .throughput import WORK

if TYPE_CHECKING:
    from ...running.provenance import Result

LEVELS = (1e-6, 1e-9, 1e-12)  # of |tilt| at the horizon over the slenderness
TOLD = 1e-9
FLOOR = 1e-16  # errors below it are drawn on it
KERNEL = ("analytic", "kernel")
# (engine, variant): colour of the page, mark
LOOKS = {
    KERNEL: ("var(--ink)", "o"),
    ("scipy", "RK45"): ("var(--soft)", "D"),
    ("scipy", "DOP853"): ("var(--accent)", "P"),
    ("scipy", "LSODA"): ("var(--ghost)", "^"),
    ("scipy", "Radau"): ("var(--good)", "v"),
    ("heyoka", "Taylor"): ("var(--bad)", "s"),
    ("CVODE", "Adams"): ("var(--fair)", "D"),
    ("CyRK", "DOP853"): ("#8f63c9", "^"),
}
ASKED = (
    "Problems A (a free block, 10 impacts) and B (a block under a pulse, 81 impacts) have references of 30 digits. "
    "All integrate the same two equations, set up for speed: scipy without classes and with a first step of the length "
    "of the hop; it, CVODE and CyRK restart at each impact, heyoka's impacts are a callback in its own loop. The error "
    "is that of |tilt| at the horizon over the slenderness, of the very runs that are timed. Cheapest is the cheapest "
    "setting at which it and all finer ones keep the error and find every impact. Scenes on bearings and under a "
    "record, the growth of cost, and engines are in the study speed-error."
)


def section(result: Result) -> Section:
    """The study's `Section`."""
    rows = [row for row in result.rows if row["part"] == "work-precision"]
    scenes = list(dict.fromkeys(row["problem"] for row in rows))
    tables = [_costs(rows, scene) for scene in scenes]
    failed = tuple(
        (f"{name_of(row)} at {row['tolerance']:g}, {row['problem']}: {row['failure']['reason']}",
         row["failure"].get("message", ""))
        for row in rows if row["failure"]
    )  # fmt: skip
    return Section(
        "The kernel against other integrators",
        (ASKED, *(_words(rows, scene) for scene in scenes), *_unsound(rows)),
        (*tables, _throughput(result)),
        (_figure(rows, scenes),),
        evidence=failed,
        measured=(
            f"{result.settings['rounds']} fresh processes one after the other; in each, every setting has its turn "
            "after a first run that compiles; runs of less than 4 ms are repeated for as long. Medians over processes.",
        ),
    )


def name_of(row: dict[str, Any]) -> str:
    return f"{row['engine']}, {row['variant']}"


def sound(row: dict[str, Any]) -> bool:
    """Whether a run ended with every impact, at a tilt that is a number."""
    return not row["failure"] and row["impacts"] == row["expected_impacts"] and row["error"] is not None


def passing(rows: list[dict[str, Any]], scene: str, level: float) -> dict[tuple[str, str], dict[str, Any]]:
    """{(engine, variant): cheapest row at which it and all finer ones keep an error}, cheapest first."""
    found: dict[tuple[str, str], list] = {}
    broken = set()
    for row in sorted(rows, key=lambda row: row["tolerance"]):
        key = row["engine"], row["variant"]
        if row["problem"] == scene and key not in broken:
            if sound(row) and row["error"] <= level:
                found.setdefault(key, []).append(row)
            else:
                broken.add(key)
    cheapest = {key: min(some, key=_cost) for key, some in found.items()}
    return dict(sorted(cheapest.items(), key=lambda item: _cost(item[1])))


def _cost(row):
    return row["cpu_seconds"]


def _costs(rows, scene):
    found = {level: passing(rows, scene, level) for level in LEVELS}
    everyone = dict.fromkeys((row["engine"], row["variant"]) for row in rows)
    return Table(
        f"{scene}: CPU time of one run to keep an error [ms] (lowest – highest round; times the kernel's; tolerance)",
        ("integrator", *(f"≤ {level:g}" for level in LEVELS)),
        [[", ".join(key), *(_cell(some.get(key), some.get(KERNEL)) for some in found.values())] for key in everyone],
    )


def _cell(row, kernel):
    if row is None:
        return "–"
    cpu, low, high = (number(1e3 * row[name], 3) for name in ("cpu_seconds", "cpu_low", "cpu_high"))
    ratio = f"{number(_cost(row) / _cost(kernel), 3)} ×; " if kernel else ""
    return f"{cpu} ({low} – {high}; {ratio}{row['tolerance']:g})"


def _words(rows, scene):
    found = passing(rows, scene, TOLD)
    kernel = found.pop(KERNEL, None)
    if kernel is None:
        return f"{scene}: no setting of the kernel keeps {TOLD:g}."
    others = [
        f"{', '.join(key)} {number(_cost(row) / _cost(kernel), 3)} times as much (error {number(row['error'], 2)})"
        for key, row in found.items()
    ]
    return (
        f"{scene}, to {TOLD:g}: the kernel takes {number(1e6 * _cost(kernel), 3)} µs (error "
        f"{number(kernel['error'], 2)}); {'; '.join(others) or 'no other keeps it'}."
    )


def _unsound(rows):
    """A sentence on the runs that missed impacts and on those that are not the same in every round, if any."""
    for words, chosen in (
        ("With a wrong number of impacts", [row for row in rows if not row["failure"] and not sound(row)]),
        ("Not the same bit for bit in every round", [row for row in rows if not row.get("repeatable", True)]),
    ):
        if chosen:
            told = [f"{name_of(row)} at {row['tolerance']:g} ({row['problem']})" for row in chosen]
            yield f"{words}: {'; '.join(told)}."


def _throughput(result):
    rows = [row for row in result.rows if row["part"] == "throughput" and not row["failure"]]
    return Table(
        "The kernel at its work, at its default tolerance: time per run [ms]",
        ("work", "runs", "CPU", "elapsed (lowest – highest round)", "overturn"),
        [
            [
                WORK[row["problem"]][1],
                str(row["runs"]),
                number(1e3 * row["cpu_seconds"]) if row["overturned"] is not None else "–",
                "{} ({} – {})".format(*(number(1e3 * row[f"elapsed_{name}"]) for name in ("seconds", "low", "high"))),
                "–" if row["overturned"] is None else f"{100 * row['overturned']:.0f} %",
            ]
            for row in rows
        ],
    )


def _figure(rows, scenes):
    charts = [
        _panel([row for row in rows if row["problem"] == scene and not row["failure"]], scene) for scene in scenes
    ]
    caption = (
        "Error against CPU time of the very same runs; left and low is better. Crosses: a wrong number of impacts."
    )
    return figure(charts, caption)


def _panel(rows, scene):
    rows = [row for row in rows if row["error"] is not None]
    chart = Chart(
        log_axis("CPU time of a run [s]", [_cost(row) for row in rows]),
        log_axis("error / slenderness [-]", [max(row["error"], FLOOR) for row in rows]),
        f"Error against CPU time of each integrator, {scene}.",
        title=scene,
        height=330,
        right=128,
    )
    for key in dict.fromkeys((row["engine"], row["variant"]) for row in rows):
        mine = [row for row in rows if (row["engine"], row["variant"]) == key]
        tone, mark = LOOKS[key]
        for good, shape in ((True, mark), (False, "x")):
            some = [row for row in mine if sound(row) == good]
            xs, ys = [_cost(row) for row in some], [max(row["error"], FLOOR) for row in some]
            says = [
                f"{name_of(row)} at {row['tolerance']:g}: {number(row['error'], 2)} in {number(1e3 * _cost(row))} ms, "
                f"{row['impacts']} of {row['expected_impacts']} impacts"
                for row in some
            ]
            chart.dots(xs, ys, says=says, mark=shape, tone=tone)
            if good and some:
                chart.line(xs, ys, tone=tone)
                chart.label(ys[-1], " ".join(key), tone=tone)
    return chart
