"""Levels of the tuned variants on statues drawn in the promised range: the rule by which a level is advised.

Half of the statues stand under recorded motions (synthetic ones where none are at hand), half under pulses; half have a
friction. Every statue lifts, and the analytic model holds. There are two draws: the first chooses, the second judges.

The rule, fixed before a draw was run. A level misses the accuracy A on a statue if its run fails, overturns where the
model does not or the other way round, or is off by more than A: in the peak tilt, over the slenderness, or in the peak
base displacement, over the model's. On a draw a level holds if it misses A on at most `FIRST` of the statues that stay
upright in the model, near an outcome boundary or not, if of all statues it changes no outcome away from an outcome
boundary by the model's word (`Reference`), and if all finer levels of its variant that were run hold, too. Advised for
A is the coarsest level of a variant that holds on the first draw. It passes if on the second draw it misses A on at
most `SECOND` of the statues that stay upright and changes no outcome away from a boundary. A level that does not pass
is shown, if at all, with its share and the upper end of its 95 % Wilson interval. Where no level holds on the first
draw, the finest is judged in its place.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from analytic import Response, SampledMotion, Scene, simulate
from analytic.response import EDGE, JUDGED
from engines import get_engine
from engines.comparison import LEAST_DISPLACEMENT, Reference, is_too_coarse
from engines.simulating import RANGE

from ...ensembles import PULSE, RECORDED, SYNTHETIC, random_slider
from ...execution.cases import Case, refined
from ...execution.sweep import Row
from ...metrics.boundaries import Setting

ACCURACIES = (1e-2, 1e-3, 1e-4)
FIRST, SECOND = 0.02, 0.05  # largest share of statues on which a level misses, on the two draws
SEEDS = (7001, 7002)  # of the draws
FALLS = "overturns"
FINEST = 5  # levels of a main variant that are run, the finest ones, with those between its own levels


def draw(records: Sequence[SampledMotion], number: int, count: int) -> list[Case]:
    """Return `count` statues of the draw `number`, 1 or 2, as cases of the analytic model."""
    cases: list[Case] = []
    index = 0
    while len(cases) < count:
        scene, kind = random_slider(records, SEEDS[number - 1], index)
        scene = scene if index % 2 else scene.with_(friction=None)
        wanted = PULSE if len(cases) % 2 else RECORDED if records else SYNTHETIC
        if kind == wanted and (model := _model(scene)):
            tag = {"draw": number, "index": index, "motion": kind, "friction": scene.friction, **model}
            cases.append(Case(scene, settings={"history": False}, tag=tag))
        index += 1
    return cases


def _model(scene: Scene) -> dict[str, Any] | None:
    """Return what a run is compared with; None outside the promised range, or where the model does not hold."""
    model = simulate(scene, history=False)
    if not model.decided or model.outcome not in ("rocks", FALLS) or model.peak_tilt_ratio < RANGE["tilt"][0]:
        return None
    comparable = Reference.of(scene, model).comparable
    peaks = {"tilt": model.peak_tilt_ratio, "displacement": model.peak_base_displacement}
    return {"model_outcome": model.outcome, "comparable": comparable, **peaks} if comparable in JUDGED else None


def level_settings(engines: Sequence[str]) -> list[Setting]:
    """Return the `FINEST` levels of the main variants of subject engines, from coarse to fine."""
    return [
        Setting(engine.name, engine.default_variant, level, {kind.accuracy_parameter: level})
        for engine in map(get_engine, engines)
        if engine.subject
        for kind in (engine.variants[engine.default_variant],)
        for level in refined(kind.levels)[-FINEST:]
    ]


def level_cases(engines: Sequence[str], statues: Sequence[Case]) -> Iterator[Case]:
    """Yield the runs of statues at `level_settings`."""
    for case, setting in itertools.product(statues, level_settings(engines)):
        yield Case(case.scene, setting.engine, setting.variant, {"history": False, **setting.settings}, case.tag)


def of_level(case: Case, response: Response) -> dict[str, Any]:
    """Measure a run at a level: its outcome and errors; None where an error does not exist."""
    scene, model = case.scene, case.tag
    falls = FALLS in (response.outcome, model["model_outcome"])
    least = LEAST_DISPLACEMENT * scene.block.radius * scene.block.slenderness
    moved = abs(response.peak_base_displacement - model["displacement"]) / max(model["displacement"], least)
    return {
        "outcome": response.outcome,
        "peak_error": None if falls else abs(response.peak_tilt_ratio - model["tilt"]),
        "displacement_error": moved if scene.bearings else None,
        "warned": is_too_coarse(response),
        "simulated": response.end.time,
    }


def level_row(row: Row) -> dict[str, Any]:
    """Return the stored row of a run at a level."""
    case = row.case
    spec = get_engine(case.solver).variants[case.variant or ""]
    shown = {
        "part": "level",
        "engine": case.solver,
        "variant": case.variant,
        "level": case.settings[spec.accuracy_parameter],
        **case.tag,
    }
    if row.failed:
        return {**shown, "outcome": "failed", "failure": row.failure}
    values = dict(row.values)
    return {**shown, "cpu_per_second": row.cost["cpu_seconds"] / values.pop("simulated"), **values}


def changed(row: Mapping[str, Any]) -> bool:
    """Return whether a run fails, or overturns where the model does not, or the other way round."""
    return row["outcome"] == "failed" or (row["outcome"] == FALLS) != (row["model_outcome"] == FALLS)


def misses(row: Mapping[str, Any], accuracy: float) -> bool:
    """Return whether a run misses an accuracy."""
    return changed(row) or any((row[name] or 0.0) > accuracy for name in ("peak_error", "displacement_error"))


def tally(rows: Sequence[Mapping[str, Any]], accuracy: float) -> dict[str, Any]:
    """Count the runs of a level on a draw.

    statues; upright: those that stay upright in the model; missed: of these, runs that miss the accuracy; missed_near:
    of these, near an outcome boundary; changed: runs of all statues with another outcome or none; away: of these, away
    from a boundary.
    """
    upright = [row for row in rows if row["model_outcome"] != FALLS]
    missed = [row for row in upright if misses(row, accuracy)]
    other = [row for row in rows if changed(row)]
    return {
        "statues": len(rows),
        "upright": len(upright),
        "missed": len(missed),
        "missed_near": sum(row["comparable"] == EDGE for row in missed),
        "changed": len(other),
        "away": sum(row["comparable"] != EDGE for row in other),
    }


def holds(counts: Mapping[str, Any], share: float) -> bool:
    """Return whether a level misses on at most a share of statues, and changes no outcome away from a boundary."""
    return counts["statues"] > 0 and counts["missed"] <= share * counts["upright"] and not counts["away"]


def advised(rows: Sequence[Mapping[str, Any]], levels: Sequence[float], accuracy: float) -> tuple[float, bool]:
    """Return (the level of a variant that the first draw chooses, whether it holds there); see the rule above.

    rows: of the variant on the first draw. levels: from coarse to fine.
    """
    chosen = None
    for level in reversed(levels):
        if not holds(tally([row for row in rows if row["level"] == level], accuracy), FIRST):
            break
        chosen = level
    return (levels[-1], False) if chosen is None else (chosen, True)
