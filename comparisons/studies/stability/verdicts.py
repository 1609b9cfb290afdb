"""Solvers, tolerances and verdicts of the stability study."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from engines import ENGINES, get_engine

from ...running.cases import Case
from ...running.provenance import scrub
from ...running.study import Batch, Found
from .cases import hard_cases
from .measure import measure, twin_step

if TYPE_CHECKING:
    from ...running.study import Ask, Plan
    from ...running.sweep import Row
    from .cases import HardCase

QUICK_LIMIT, TIME_LIMIT = 60.0, 300.0  # s, of one run; of those that end the longest takes 75 s of CPU time
# s; scenes longer than the first are cured, longer than the second run at all, in the default variants only: an
# expert's ten minutes take 45 to 300 s of CPU time
LONG, LONGEST = 60.0, 300.0
RIGHT, DEGRADED, FAILED = "right", "degraded", "failed"
EVIDENCE_CHARACTERS = 600

# measure: unit, what it is
MEASURES = {
    "outcome": ("", "1 where the outcome is not the oracle's"),
    "tilt": ("of the slenderness", "largest difference of the tilt up to the horizon"),
    "displacement": ("of its peak", "largest difference of the base displacement up to the horizon"),
    "overturning time": ("s", "difference"),
    "uplift time": ("s", "difference of the first one"),
    "lost uplifts": ("", "of the oracle's"),
    "rest time": ("of the time", "largest difference"),
    "lost rests": ("", "of the oracle's"),
    "lost impacts": ("", "of the oracle's with 5 % or more of its largest rate"),
    "tilt at rest": ("of the slenderness", "where the oracle rests or stands: rattling and drift"),
    "energy drift": ("of m g R (1 - cos gamma)", "change between events beyond what the measure shows on the oracle"),
    "energy gain": ("of the energy scale", "rise from nowhere, beyond what the measure shows on the oracle"),
    "energy imbalance": ("of the largest entry", "of the solver's own energy ledger"),
}

# class of solver: measure: (tolerance, reason)
TOLERANCES = {
    "event-driven": {
        "outcome": (0, "a decision"),
        "tilt": (
            1e-6,
            "steps are good to 1e-10; up to the horizon a difference grows a hundredfold; the rest is reserve",
        ),
        "displacement": (1e-6, "as the tilt"),
        "overturning time": (1e-4, "as the tilt, and falling begins exponentially slowly"),
        "uplift time": (1e-8, "a root of a known function"),
        "lost uplifts": (0, "a count"),
        "rest time": (1e-6, "the limit of a geometric series; rest itself is defined to 1e-8 omega_r"),
        "lost rests": (0, "a count"),
        "lost impacts": (0, "a count"),
        "tilt at rest": (0, "at rest the model's tilt is 0"),
        "energy imbalance": (1e-8, "quadrature beside steps good to 1e-10"),
    },
    "stepping": {
        "outcome": (0, "a decision"),
        "tilt": (0.02, "up to the horizon 1e-4 in restitution make 0.01; as much again for the solver"),
        "displacement": (0.02, "the 2 % to which bearing displacements are designed"),
        "overturning time": (0.05, "ten samples of a usual record"),
        "uplift time": (0.01, "two samples of a usual record"),
        "lost uplifts": (0, "a count"),
        "rest time": (0.02, "as the tilt; the last impacts are below every contact's resolution"),
        "lost rests": (0, "a count"),
        "lost impacts": (0, "a count"),
        "tilt at rest": (1e-3, "a hundredth of a swing that anyone would notice"),
        "energy drift": (0.02, "as the tilt: the energy of a swing to 2 %"),
        "energy gain": (0.02, "energy from nowhere has no excuse but the measure's error"),
    },
}


@dataclasses.dataclass(frozen=True)
class Solver:
    """A column of the matrix: solver and variant, its class, what to set, and settings that may cure it, in turn."""

    name: str
    variant: str | None
    kind: str
    settings: dict
    step: str | None  # the setting that is a step [s]
    cures: tuple
    default: bool = False  # the engine's best effort

    @property
    def label(self) -> str:
        return self.name if self.variant is None else f"{self.name}, {self.variant}"

    def case(self, hard: HardCase, cure: int | None = None) -> Case:
        """The run of a hard case; `cure`: which of the cures, None for the settings as they come."""
        settings = dict(self.settings)
        if self.name == "twin":
            settings["max_step"] = twin_step(hard.scene)
        if hard.step is not None and self.step:
            settings[self.step] = hard.step
        if cure is not None:
            settings.update(self.cures[cure])
        tag = {"case": hard.name, "solver": self.label, "cure": cure}
        return Case(hard.scene, self.name, self.variant, settings, tag)


TIME_STEPPING = Solver(
    "time-stepping", None, "stepping", {"step": 1e-3}, "step", ({"step": 1e-4}, {"step": 1e-5}), True
)


def solvers(engines: Iterable[str]) -> list[Solver]:
    """The columns: kernel, twin, time stepping, and every variant of the engines."""
    columns = [Solver(name, None, "event-driven", {}, None, (), True) for name in ("analytic", "twin")]
    columns.append(TIME_STEPPING)
    for name in engines:
        default = get_engine(name).default_variant
        columns += [
            Solver(name, variant, "stepping", {}, kind.step, kind.finer, variant == default)
            for variant, kind in get_engine(name).variants.items()
        ]
    return columns


def tolerances(hard: HardCase, kind: str) -> dict[str, tuple[float, str]]:
    """measure -> (tolerance, reason) of a hard case for a class of solvers."""
    return {**TOLERANCES[kind], **hard.tolerances.get(kind, {})}


def entry(hard: HardCase, solver: Solver, row: Row) -> dict[str, Any]:
    """The result file's row of one run: verdict, every measure beside its tolerance, or the evidence of failure."""
    content = {
        "case": hard.name,
        "solver": solver.label,
        "cure": row.case.tag["cure"],
        "set": row.case.settings,
        "cpu_seconds": row.cost.get("cpu_seconds"),
    }
    if row.failed:
        failure = {key: _evidence(value) if isinstance(value, str) else value for key, value in row.failure.items()}
        return {
            **content,
            "verdict": FAILED,
            "failure": failure,
            "settings": row.values.get("settings"),
            "last_state": failure.pop("last_state", None) or row.values.get("end"),
        }
    limits = tolerances(hard, solver.kind)
    errors = {name: [_short(value), limits[name][0]] for name, value in row.values["errors"].items()}
    outside = [name for name, (value, limit) in errors.items() if not (value is not None and value <= limit)]
    return {
        **content,
        "verdict": DEGRADED if outside else RIGHT,
        "outside": outside,
        "errors": errors,
        "outcome": row.values["outcome"],
        "until": _short(row.values["until"]),
        "impacts": row.values["impacts"],
        "steps": row.values["steps"],
    }


def _evidence(text):
    """Both ends of a long message: one names the error, the other the place."""
    text, half = scrub(text), EVIDENCE_CHARACTERS // 2
    return text if len(text) <= 2 * half else f"{text[:half]} [...] {text[-half:]}"


def _short(value):
    return value if value is None or not math.isfinite(value) else float(f"{value:.3g}")


def worst(content: Mapping[str, Any]) -> tuple[str, float | None, float, float]:
    """(measure, value, tolerance, value over tolerance) of the measure farthest outside its tolerance, or closest."""

    def ratio(name):
        value, limit = content["errors"][name]
        if value is None:
            return math.inf
        return value / limit if limit else (math.inf if value else 0.0)

    name = max(content["errors"], key=ratio)
    return (name, *content["errors"][name], ratio(name))


def plan(ask: Ask, names: Iterable[str] | None = None, columns: Sequence[Solver] | None = None) -> Plan:
    """The plan of the study: all cells, then the cures tried in turn where the verdict was not "right".

    Scenes longer than `LONGEST` are not asked of variants that are no default; their cells are missing.

    Parameters
    ----------
    ask : Ask
        quick: the quick cases only, and cures of the engines' default variants only.
    names : iterable of str or None
        Only these cases.
    columns : sequence of Solver or None
        None: `solvers`.
    """
    cases = [
        case for case in hard_cases().values() if (case.quick or not ask.quick) and (not names or case.name in names)
    ]
    columns = solvers(ask.engines) if columns is None else columns
    limit = QUICK_LIMIT if ask.quick else TIME_LIMIT
    ill = [(case, column) for case in cases for column in columns if column.default or case.scene.duration <= LONGEST]
    cure, rows = None, []
    while ill:
        label = "hard cases" if cure is None else f"cures, round {cure + 1}"
        done = yield Batch([column.case(case, cure) for case, column in ill], measure, label, limit)
        entries = [entry(case, column, row) for (case, column), row in zip(ill, done, strict=True)]
        rows += entries
        cure = 0 if cure is None else cure + 1
        ill = [
            (case, column)
            for (case, column), content in zip(ill, entries, strict=True)
            if content["verdict"] != RIGHT
            and cure < len(column.cures)
            and (column.default or not (ask.quick or case.scene.duration > LONG))
        ]
    return Found(_settings(cases, columns, ask.quick, limit), rows)


def _settings(cases, columns, quick, limit):
    """What the study was asked, as its result file keeps it: cases, oracles, tolerances and their reasons, solvers."""
    return {
        "quick": quick,
        "time_limit": limit,
        "cases": {
            case.name: {
                "title": case.title,
                "oracle": case.oracle,
                "duration": case.scene.duration,
                "twin_until": case.twin_until,
                "tolerances": case.tolerances,
            }
            for case in cases
        },
        "measures": MEASURES,
        "tolerances": TOLERANCES,
        "solvers": {
            column.label: {
                "kind": column.kind,
                "default_variant": column.default,
                "settings": _set(column),
                "cures": column.cures,
            }
            for column in columns
        },
    }


def _set(column):
    """Settings of a column where nothing is changed."""
    if column.name not in ENGINES:
        return column.settings
    return {**dataclasses.asdict(get_engine(column.name).variants[column.variant].settings), **column.settings}
