"""The stability study: each hard case in each variant, measure by measure, then at finer levels."""

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from analytic import Response
from engines import get_engine
from engines.comparison import outcome_of

from ...execution.cases import Case
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.results import scrub
from ...execution.sweep import Row
from ...metrics.errors import energy_errors
from ...schemas.columns import declared, list_of, number_of, table_of, whole_of, word_of
from ..rows import SHARED
from .cases import SLIDING, HardCase, hard_cases
from .oracle import (
    LAST_PART,
    Oracle,
    beyond_range,
    column_at,
    comparable_until,
    oracle,
    slip_errors,
    slip_unit,
    stepping_errors,
    twin_step,
)

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("case", "case", "name of the hard case"),
    table_of("set", "set", "settings that differ from the default"),
    word_of("result", "result", '"right", "differs" or "failed"'),
    list_of("outside", "outside", "measures that are outside their tolerance"),
    table_of("errors", "errors", "[error, tolerance] of each measure, in the measure's unit"),
    number_of("until", "until", "time up to which the motion is compared", "s"),
    whole_of("impacts", "impacts", "impacts of the run"),
)
CASE = "case engine variant level? set cpu_seconds? result outcome | outside errors until? impacts steps"
PARTS = {"default settings": CASE, "finer settings": CASE}

QUICK_LIMIT, TIME_LIMIT = 60.0, 300.0  # s, of one run; the longest that ends takes 75 s of CPU time
# s. Only the engines' main variants run scenes longer than the first at finer levels, and scenes longer than the second
# at all: in other variants ten minutes take 45 to 300 s of CPU time.
LONG, LONGEST = 60.0, 300.0
RIGHT, DIFFERS, FAILED = "right", "differs", "failed"
DEFAULT, FINER = "default settings", "finer settings"  # parts of the rows
EVIDENCE_CHARACTERS = 600
# Impacts are counted down to this share of the strongest one's rate, but not below 1e-3 omega_r slenderness, which
# moves nothing: engines rest earlier than the model. A run's own impacts count from OWN of that, as their rates
# err. They are not matched in time, as `lost_impacts` does: the last ones before rest are closer together than times
# are right.
LEAST_RATE, LEAST_SHARE, OWN = 0.05, 1e-3, 0.95

# {measure: (unit, what it is)}
MEASURES = {
    "outcome": ("", "1 where the outcome is not the oracle's; a tilt too small to count in comparisons is none"),
    "tilt": ("of the slenderness", "largest difference of the tilt up to the horizon"),
    "displacement": ("of its peak", "largest difference of the base displacement up to the horizon"),
    "overturning time": ("s", "difference"),
    "uplift time": ("s", "difference of the first one"),
    "lost uplifts": ("", "of the oracle's"),
    "rest time": ("of the time", "largest difference"),
    "lost rests": ("", "of the oracle's"),
    "impacts too few": ("", "than the oracle's with 5 % or more of its largest rate; not whether their times match"),
    "peak slip": ("of its peak, of half the width without any", "difference"),
    "end slip": ("of its peak, of half the width without any", "difference at the end"),
    "judge's doubt": (
        "of the measures' units",
        "error of Moreau's time stepping, where it judges, at 8 times its step",
    ),
    "tilt at rest": ("of the slenderness", "where the oracle rests or stands: rattling and drift"),
    "energy drift": ("of m g R (1 − cos γ)", "change between events beyond what the measure shows on the oracle"),
    "energy gain": ("of the energy scale", "rise without a source, beyond what the measure shows on the oracle"),
    "energy imbalance": ("of the largest entry", "of the solver's own energy ledger"),
}

# {kind of solver: {measure: (tolerance, reason)}}
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
        "rest time": (1e-6, "the limit of a geometric series; rest itself is defined to 1e-8 of the rocking frequency"),
        "lost rests": (0, "a count"),
        "impacts too few": (0, "a count"),
        "peak slip": (1e-6, "as the tilt"),
        "end slip": (1e-6, "as the tilt"),
        "judge's doubt": (1e-3, "an eighth of it is left in the run that judges: 1e-4, a change that outcomes survive"),
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
        "impacts too few": (0, "a count"),
        "peak slip": (0.02, "as the displacement"),
        "end slip": (0.02, "as the displacement"),
        "tilt at rest": (1e-3, "a hundredth of a swing that anyone would notice"),
        "energy drift": (0.02, "as the tilt: the energy of a swing to 2 %"),
        "energy gain": (0.02, "no physical source; the tolerance is the measure's own error"),
    },
}


@dataclasses.dataclass(frozen=True)
class Solver:
    """A solver of the cases: an engine's variant, or a code of ours.

    Parameters
    ----------
    engine, variant, tier : str
        `tier` is the variant's kind. Of a code of ours both are "".
    kind : str
        Key of its tolerances in `TOLERANCES`.
    parameter, default, levels
        The accuracy parameter (None: it has none), its default and its levels.
    applies_impact : bool
        Whether it is given eqs (7) and (8).
    settings : dict
        Settings at the default level.
    step : str or None
        The setting that is a step [s].
    finer : tuple of dict
        Settings of finer levels, to run in turn where the result is not right.
    best : bool
        Whether it is the engine's main variant, or a code of ours.
    """

    engine: str
    variant: str = ""
    tier: str = ""
    kind: str = "event-driven"
    parameter: str | None = None
    default: float | None = None
    levels: tuple[float, ...] = ()
    applies_impact: bool = True
    settings: dict = dataclasses.field(default_factory=dict)
    step: str | None = None
    finer: tuple = ()
    best: bool = True

    def runs(self, hard: HardCase) -> bool:
        """Return whether this solver runs the case."""
        models = hard.oracle != SLIDING or may_slide(self.engine, self.applies_impact)
        return models and (self.best or hard.scene.duration <= LONGEST)

    def case(self, hard: HardCase, finer: int | None = None) -> Case:
        """Return the run of a hard case.

        finer: index of the finer level; None: the default level.
        """
        settings = {} if self.variant else dict(self.settings)
        if self.engine == "twin":
            settings["max_step"] = twin_step(hard.scene)
        if hard.step is not None and self.step:
            settings[self.step] = hard.step
        if finer is not None:
            settings |= self.finer[finer]
        tag = {"case": hard.name, "part": DEFAULT if finer is None else FINER}
        return Case(hard.scene, self.engine, self.variant or None, settings, tag)


def may_slide(engine: str, applies_impact: bool) -> bool:
    """Return whether a solver models a block that slides.

    The analytic model and the engines do, except where the adapter imposes eqs (7) and (8).
    """
    return engine == "analytic" or not applies_impact


TIME_STEPPING = Solver(
    "time-stepping",
    kind="stepping",
    parameter="step",
    default=1e-3,
    levels=(1e-3, 1e-4, 1e-5),
    settings={"step": 1e-3},
    step="step",
    finer=({"step": 1e-4}, {"step": 1e-5}),
)


def solvers(engines: Iterable[str]) -> list[Solver]:
    """Return the kernel, the twin, time stepping, and every variant of the engines."""
    return [
        Solver("analytic"),
        Solver("twin"),
        TIME_STEPPING,
        *(
            Solver(
                name,
                variant,
                spec.kind,
                "stepping",
                spec.accuracy_parameter,
                spec.default,
                tuple(sorted(spec.levels)),
                spec.applies_impact,
                dataclasses.asdict(spec.settings),
                spec.step,
                spec.finer,
                variant == get_engine(name).default_variant,
            )
            for name in engines
            for variant, spec in get_engine(name).variants.items()
        ),
    ]


def measure(case: Case, response: Response) -> dict[str, Any]:
    """Return the errors of one run, name -> number or None, its outcome and its counts.

    `MEASURES` gives the units.

    Measures that do not apply are left out. The tag of `case` names the hard case.
    """
    hard = hard_cases()[case.tag["case"]]
    if hard.oracle == SLIDING and response.engine == "analytic":
        errors, until = stepping_errors(hard, response), response.end.time
    else:
        truth = oracle(hard.name, response.engine == "analytic")
        errors, until = _errors(hard, response, truth), truth.until
    if response.energy is not None:
        largest = max(map(abs, dataclasses.astuple(response.energy)))
        errors["energy imbalance"] = abs(response.energy.imbalance) / largest if largest > 0 else 0.0
    return {
        "outcome": response.outcome,
        "errors": errors,
        "until": until,
        "impacts": response.impact_count,
        "steps": response.steps,
    }


def _errors(hard: HardCase, response: Response, truth: Oracle) -> dict[str, float]:
    errors: dict[str, float] = {}
    if truth.outcome is not None:
        errors["outcome"] = float(outcome_of(hard.scene, response) != truth.outcome)
    errors |= _trajectory_errors(hard, response, truth) | _event_errors(hard, response, truth)
    if truth.settled:
        history = response.history
        late = history.time >= hard.scene.duration * (1 - LAST_PART)
        still = history.tilt if hard.expected.get("outcome") == "stands" else history.tilt[late]
        errors["tilt at rest"] = float(np.abs(still).max(initial=0.0)) / hard.scene.block.slenderness
    if hard.oracle == SLIDING and truth.response.overturning_time is None and truth.until >= truth.response.end.time:
        errors |= slip_errors(hard, response, truth.response, slip_unit(hard.scene, truth.response))
    if response.energy is None and truth.noise is not None:
        energy = energy_errors(hard.scene, response, until=comparable_until(hard.name)[0], step=hard.step or 0.0)
        errors["energy drift"], errors["energy gain"] = (
            max(0.0, error - noise) for error, noise in zip(energy, truth.noise, strict=True)
        )
    return errors


def _trajectory_errors(hard: HardCase, response: Response, truth: Oracle) -> dict[str, float]:
    """Largest differences of tilt and displacement up to the horizon, at the samples of the kernel's history."""
    kernel = response if response.engine == "analytic" else truth.response
    times, tilt = truth.tilt(kernel.history.time)
    errors = {"tilt": float(np.abs(column_at(response, times, "tilt") - tilt).max()) / hard.scene.block.slenderness}
    if hard.scene.base is not None:
        displacement, x = (column_at(run, times, "base_displacement") for run in (response, truth.response))
        errors["displacement"] = float(np.abs(displacement - x).max() / np.abs(x).max())
    return errors


def _event_errors(hard: HardCase, response: Response, truth: Oracle) -> dict[str, float]:
    errors = {}
    if truth.uplifts:
        errors["lost uplifts"] = float(max(0, len(truth.uplifts) - len(response.uplifts)))
        if response.uplifts:
            errors["uplift time"] = abs(response.uplifts[0] - truth.uplifts[0])
    if truth.rests:
        errors["lost rests"] = float(max(0, len(truth.rests) - len(response.rests)))
        if response.rests:
            rests = np.array(response.rests)
            errors["rest time"] = max(float(np.abs(rests / time - 1).min()) for time in truth.rests)
    over = hard.expected.get("overturning time", truth.response.overturning_time)
    if over is not None and response.overturning_time is not None:
        errors["overturning time"] = abs(response.overturning_time - over)
    wanted = [abs(impact.rate_before) for impact in truth.response.impacts if impact.time <= truth.until]
    scene = truth.case.scene
    least = max(LEAST_RATE * max(wanted, default=0.0), LEAST_SHARE * scene.rocking_frequency * scene.block.slenderness)
    if count := sum(rate >= least for rate in wanted):
        fast = sum(abs(impact.rate_before) >= OWN * least for impact in response.impacts)
        errors["impacts too few"] = float(max(0, count - fast))
    return errors


def row_of(hard: HardCase, solver: Solver, run: Row) -> dict[str, Any]:
    """Return the stored row of one run: its result, and its measures beside their tolerances or why it failed."""
    case = run.case
    row = {
        "part": case.tag["part"],
        "case": hard.name,
        "engine": solver.engine,
        "variant": solver.variant,
        "level": case.settings.get(solver.parameter, solver.default),
        "set": case.settings,
        "cpu_seconds": run.cost.get("cpu_seconds"),
    }
    if run.failed:
        failure = {key: _evidence(value) if isinstance(value, str) else value for key, value in run.failure.items()}
        state = failure.pop("last_state", None) or run.values.get("end")
        ended = {"failure": failure, "settings": run.values.get("settings"), "last_state": state}
        return {**row, "result": FAILED, "outcome": "failed", **ended}
    limits = TOLERANCES[solver.kind] | hard.tolerances.get(solver.kind, {})
    errors = {name: (_rounded(value), limits[name][0]) for name, value in run.values["errors"].items()}
    outside = [name for name, (value, limit) in errors.items() if not (value is not None and value <= limit)]
    return {
        **row,
        "result": DIFFERS if outside else RIGHT,
        "outcome": run.values["outcome"],
        "outside": outside,
        "errors": errors,
        "until": _rounded(run.values["until"]),
        "impacts": run.values["impacts"],
        "steps": run.values["steps"],
    }


def _evidence(text):
    """Cut a long message to its two ends: one names the error, the other the place."""
    text, half = scrub(text), EVIDENCE_CHARACTERS // 2
    return text if len(text) <= 2 * half else f"{text[:half]} [...] {text[-half:]}"


def _rounded(value):
    return value if value is None or not math.isfinite(value) else float(f"{value:.3g}")


def worst(row: Mapping[str, Any]) -> tuple[str, float | None, float]:
    """Return (measure, value, tolerance) of the measure farthest outside its tolerance, or closest to it."""

    def share(name):
        value, limit = row["errors"][name]
        return math.inf if value is None or (value and not limit) else value / (limit or 1.0)

    name = max(row["errors"], key=share)
    return name, *row["errors"][name]


def plan(request: Request, names: Iterable[str] | None = None, columns: Sequence[Solver] | None = None) -> Plan:
    """Plan all cases at the default level, then finer levels in turn where the result was not "right".

    Scenes longer than `LONGEST` are run in the engines' main variants only.

    Parameters
    ----------
    request : Request
        quick: the quick cases only, and finer levels of the engines' main variants only.
    names : iterable of str or None
        Only these cases.
    columns : sequence of Solver or None
        None: `solvers`.
    """
    cases = [
        case
        for case in hard_cases().values()
        if (case.quick or not request.quick) and (not names or case.name in names)
    ]
    columns = solvers(request.engines) if columns is None else columns
    limit = QUICK_LIMIT if request.quick else TIME_LIMIT
    left = [(case, column) for case in cases for column in columns if column.runs(case)]
    finer, rows = None, []
    while left:
        label = "hard cases" if finer is None else f"finer levels, round {finer + 1}"
        runs = yield Batch([column.case(case, finer) for case, column in left], measure, label, limit)
        new_rows = [row_of(case, column, run) for (case, column), run in zip(left, runs, strict=True)]
        rows += new_rows
        finer = 0 if finer is None else finer + 1
        left = [
            (case, column)
            for (case, column), row in zip(left, new_rows, strict=True)
            if row["result"] != RIGHT
            and finer < len(column.finer)
            and (column.best or not (request.quick or case.scene.duration > LONG))
        ]
    settings = {
        "quick": request.quick,
        "time_limit": limit,
        "cases": {
            case.name: {
                "title": case.title,
                "oracle": case.oracle,
                "duration": case.scene.duration,
                "twin_until": case.twin_until,
                "outside": beyond_range(case.name),
                "tolerances": case.tolerances,
            }
            for case in cases
        },
        "measures": MEASURES,
        "tolerances": TOLERANCES,
        "variants": [dataclasses.asdict(column) for column in columns],
    }
    return Computed(settings, rows)
