"""What is shown of the kernel beside other integrators: cost at an error, error against cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ...showing.figures import lines
from ...showing.parts import Page, number, short
from ...showing.rows import NAME, Column, cheapest, grouped, table, where

if TYPE_CHECKING:
    from ...running.provenance import Result

LEVELS = (1e-6, 1e-9, 1e-12)  # of |tilt| at the horizon over the slenderness
TOLD = 1e-9
FLOOR = 1e-16  # errors below it are drawn on it
KERNEL = "analytic, kernel"
CPU = Column("CPU time of a run [s]", "cpu_seconds")
ERROR = Column("error / slenderness [-]", lambda row: None if row["error"] is None else max(row["error"], FLOOR))


def page(result: Result) -> Page:
    """The `Page` of a `Result` of the kernel study."""
    rows = where(result.rows, part="work-precision")
    scenes = [scene for (scene,) in grouped(rows, "problem")]
    return Page(
        f"The kernel: {'; '.join(_found(rows, scene) for scene in scenes)}",
        (
            "Problems A (a free block, 10 impacts) and B (a block under a pulse, 81 impacts) have references of 30 "
            "digits. The error is that of |tilt| at the horizon over the slenderness, of the runs that are timed.",
        ),
        more=(
            lines(
                [row for row in rows if sound(row)],
                CPU,
                ERROR,
                "Error against CPU time of the same runs; left and low is better. Runs with a wrong number of impacts "
                "are left out.",
                panel="problem",
                log="xy",
                says=lambda row: f"{NAME.text(row)} at {row['tolerance']:g}: {ERROR.text(row)} in {CPU.text(row)} s",
            ),
            *(_costs(rows, scene) for scene in scenes),
            table(
                "Runs with a wrong number of impacts, or not the same bit for bit in every round",
                [row for row in rows if not row["failure"] and not (sound(row) and row.get("repeatable", True))],
                NAME,
                Column("problem", "problem"),
                Column("tolerance", "tolerance", digits=None),
                Column("impacts", "{impacts} of {expected_impacts}"),
                Column("same in every round", lambda row: "yes" if row.get("repeatable", True) else "no"),
            ),
        ),
        how=(
            "All integrate the same two equations, set up for speed: scipy without classes and with a first step of "
            "the length of the hop. scipy restarts at each impact; heyoka's impacts are a callback in its own loop. "
            "Cheapest: the cheapest level at which it and all finer ones keep the error and find every impact.",
            f"{result.settings['rounds']} fresh processes one after the other; in each, every level has its turn "
            "after a first run that compiles; runs are repeated until they take 4 ms. Medians over processes.",
            "Scenes on bearings and under a record, the growth of cost, and engines are in the study speed-error.",
        ),
        evidence=tuple(
            (f"{NAME.text(row)} at {row['tolerance']:g}, {row['problem']}: {row['failure']['reason']}",
             row["failure"].get("message", ""))
            for row in rows if row["failure"]
        ),
    )  # fmt: skip


def sound(row: Mapping[str, Any]) -> bool:
    """Whether a run ended with every impact, at a tilt that is a number."""
    return not row["failure"] and row["impacts"] == row["expected_impacts"] and row["error"] is not None


def passing(rows: list[dict[str, Any]], scene: str, level: float) -> dict[str, Any]:
    """{integrator: cheapest row at which it and all finer ones keep an error}, cheapest first."""
    of_scene = where(rows, problem=scene)
    return cheapest(of_scene, NAME.text, lambda row: sound(row) and row["error"] <= level, CPU.of)


def _costs(rows, scene):
    """Of each integrator the cheapest CPU time to keep each error."""
    found = {level: passing(rows, scene, level) for level in LEVELS}

    def cell(level):
        def of(row):
            best, kernel = found[level].get(NAME.text(row)), found[level].get(KERNEL)
            if best is None:
                return "–"
            times = f"; {number(CPU.of(best) / CPU.of(kernel), 3)} ×" if kernel else ""
            return f"{number(1e3 * CPU.of(best), 3)}{times}; {short(best['tolerance'])}"

        return of

    return table(
        f"{scene}: CPU time of one run to keep an error [ms]; times the kernel's; tolerance",
        [mine[0] for mine in grouped(where(rows, problem=scene), NAME.text).values()],
        Column("integrator", NAME.text),
        *(Column(f"≤ {number(level, 1)}", cell(level)) for level in LEVELS),
    )


def _found(rows, scene):
    found = passing(rows, scene, TOLD)
    kernel = found.pop(KERNEL, None)
    if kernel is None:
        return f"{scene}: no level keeps {number(TOLD, 1)}"
    first = f"{scene} to {number(TOLD, 1)} in {number(1e6 * CPU.of(kernel), 3)} µs"
    other = next(iter(found), None)
    return first + (f", {other} in {number(CPU.of(found[other]) / CPU.of(kernel), 3)} times as much" if other else "")
