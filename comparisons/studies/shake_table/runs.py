"""Rows of the engines that ran a campaign's tests, beside the model's and beside what was measured."""

import time
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy.stats import binomtest

from analytic import Response, Scene, simulate_many
from analytic.rocking import RockingModel
from engines import get_engine
from engines.comparison import Reference

from ...measuring.forecasts import clustered
from ...measuring.statistics import Confusion, confusion, equality, mcnemar
from ...running.cases import Case
from ...running.sweep import Row
from .campaign import ALL, Campaign, outcomes_of, told

OVERTURNS, STANDS, FAILED = "1", "0", "x"


def leaning(
    scene: Scene, slenderness: float, *, restitution: float = 1, inertia: float = 1, friction: float | None = None
) -> Scene:
    """A scene whose block has another slenderness [rad], its centre of mass as high as before.

    restitution: factor on that of the block. inertia: factor on the moment about the centre of mass. friction: in place
    of the scene's.
    """
    block = scene.block
    radius = float(block.half_height / np.cos(slenderness))
    corner = float(inertia * block.centre_inertia + block.mass * radius**2)
    changed = scene.with_(block={"radius": radius, "slenderness": float(slenderness), "corner_inertia": corner})
    if restitution != 1:
        changed = changed.with_(block={"restitution": restitution * RockingModel.of(changed).restitution})
    return changed if friction is None else changed.with_(friction=friction)


def over_slendernesses(case: Case, response: Response) -> dict[str, Any]:
    """Measure: a digit for each slenderness, for each kind of model."""
    kinds, grid = case.tag["kinds"], case.tag["slendernesses"]
    scenes = [leaning(case.scene, slenderness, **kind) for kind in kinds for slenderness in grid]
    began = time.process_time()
    found = simulate_many(scenes, workers=1)
    seconds = time.process_time() - began
    digits = np.where(found.failed, FAILED, np.where(found.overturns, OVERTURNS, STANDS))
    return {
        "outcomes": ["".join(one) for one in digits.reshape(len(kinds), -1).tolist()],
        "cost": {"grid_seconds": seconds},
    }


def ended(case: Case, response: Response) -> dict[str, Any]:
    """Measure: how a run ended, and its peak tilt over the slenderness."""
    return {"outcome": response.outcome, "tilt": response.peak_tilt_ratio}


def ended_near(case: Case, response: Response) -> dict[str, Any]:
    """Measure of the model's run: `ended`, and whether a change of the scene by 1e-4 changes the outcome."""
    return {**ended(case, response), "near": "outcome" in Reference.of(case.scene).near}


NOT_RUN = "-"


def engine_rows(campaign: Campaign, own: Sequence[Row], found: Sequence[Row]) -> list[dict[str, Any]]:
    """Rows of an engine beside the model, of each specimen and of all together: in what their outcomes differ, and
    right answers where they are told. own, found: runs of the model and of the engine."""
    case, records, rows = found[0].case, [test.record for test in campaign.tests], []
    variant = case.variant or ""
    first = {"part": "engine", "engine": case.solver, "variant": variant}
    first["tier"] = get_engine(case.solver).variants[variant].kind
    sides = []
    for k, specimen in enumerate(campaign.specimens):
        ours, theirs = ([row for row in some if row.case.tag["specimen"] == specimen.name] for some in (own, found))
        near = np.array([row.values["near"] for row in ours])
        sides.append((_outcomes(campaign, theirs), _outcomes(campaign, ours), near))
        said = answers(*sides[-1][:2], outcomes_of(campaign.tests, k), records)
        differing = differences(*sides[-1], records)
        rows.append({**first, "specimen": specimen.name, **differing, **said, "tilt": _tilts(ours, theirs)})
    if len(sides) > 1:
        engine, model, near = (np.concatenate(part) for part in zip(*sides, strict=True))
        together = differences(engine, model, near, records * len(sides))
        rows.append({**first, "specimen": ALL, **together, **dict.fromkeys((*said, "tilt"))})
    return rows


def _outcomes(campaign, rows):
    """A digit for each test."""
    digits = {"failed": FAILED, "overturns": OVERTURNS}
    found = {row.case.tag["test"]: digits.get(row.values["outcome"], STANDS) for row in rows}
    return np.array([found.get(test.name, NOT_RUN) for test in campaign.tests])


def differences(engine: np.ndarray, model: np.ndarray, near: np.ndarray, records: Sequence[str]) -> dict[str, Any]:
    """In what an engine's outcomes differ from the model's, which way, and whether the two are equal.

    p_value: of a sign test over tests. records_a, records_b, p_records: of one over records, each by what most of its
    differences say, as those under one record are alike. A failed run is no difference of a sign, but differs. near: of
    each test, whether the model's own end is sensitive, see `ended_near`; on_edge: differences there.
    """
    sound, asked = np.isin(engine, [STANDS, OVERTURNS]), engine != NOT_RUN
    names = np.array(records)
    pair = confusion(model[sound] == OVERTURNS, engine[sound] == OVERTURNS) if sound.any() else Confusion(0, 0, 0, 0)
    equal, interval = equality((engine != model)[asked], names[asked].tolist())
    sign = np.where(sound, (model == OVERTURNS).astype(int) - (engine == OVERTURNS), 0)
    by_record = [int(np.sign(sign[names == name].sum())) for name in dict.fromkeys(records)]
    one, other = by_record.count(1), by_record.count(-1)
    return {
        "size": int(asked.sum()),
        "failed": int((engine == FAILED).sum()),
        **asdict(pair),
        "p_value": mcnemar(pair) if sound.any() else None,
        "records_a": one,
        "records_b": other,
        "p_records": float(binomtest(one, one + other).pvalue) if one + other else None,
        "near": int((asked & near).sum()),
        "on_edge": int((asked & near & (engine != model)).sum()),
        "equal": equal,
        "interval": list(interval),
    }


def answers(engine: np.ndarray, model: np.ndarray, measured: np.ndarray, records: Sequence[str]) -> dict[str, Any]:
    """Right answers of an engine, and of the model on the same tests, with the interval of their share; a failed run is
    not right. Their difference is a sum over the tests that differ; misses and false alarms say how failed ones ended.
    """
    truth, asked = np.where(measured, OVERTURNS, STANDS), engine != NOT_RUN
    hit = (truth == engine)[asked]
    low, high = clustered(hit, np.array(records)[asked].tolist())
    right = {"right": int(hit.sum()), "low": low, "high": high, "model_right": int((truth == model)[asked].sum())}
    wrong = {
        "misses": int((measured & (engine == STANDS)).sum()),
        "false_alarms": int((~measured & (engine == OVERTURNS)).sum()),
    }
    sizes = len(hit), int((engine != model)[asked].sum())
    return told(right, *sizes) | told(wrong, *sizes, int((engine == FAILED).sum()))


def _tilts(own, found):
    """Median of the peak tilts of an engine over the model's, where both rock and stay upright; None: nowhere."""
    model = {row.case.tag["test"]: row.values for row in own}
    pairs = ((row.values, model[row.case.tag["test"]]) for row in found if not row.failed)
    ratios = [a["tilt"] / b["tilt"] for a, b in pairs if a["outcome"] == b["outcome"] == "rocks"]
    return float(np.median(ratios)) if ratios else None
