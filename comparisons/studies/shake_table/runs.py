"""Rows of the solvers that ran a campaign's tests, beside the model's and beside what was measured."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from engines import get_engine

from ...measuring.forecasts import FEWEST, clustered
from ...measuring.statistics import confusion, equality, mcnemar
from ...running.sweep import Row
from .campaign import Campaign, outcomes_of
from .shaking import OVERTURNS, STANDS
from .telling import NOT_RUN, array_of, may_be_told, text_of

MODEL = "analytic"


def run_row(campaign: Campaign, k: int, rows: Iterable[Row], slenderness: float) -> dict[str, Any]:
    """The row of a solver's outcomes by test, of specimen number k."""
    name = campaign.specimens[k].name
    own = {row.case.tag["test"]: row for row in rows if row.case.tag["specimen"] == name}
    first = next(iter(own.values())).case
    said = [own[test.name].values["outcome"] if test.name in own else None for test in campaign.tests]
    seconds = [row.cost["cpu_seconds"] for row in own.values() if row.cost]
    return {
        "part": "run",
        "engine": first.solver,
        "variant": first.variant or "",
        "specimen": name,
        "slenderness": slenderness,
        "outcomes": text_of(said),
        "failed": sum(row.failed for row in own.values()),
        "cpu_seconds": float(np.median(seconds)) if seconds else None,
    }


def engine_row(
    campaign: Campaign,
    k: int,
    run: dict[str, Any],
    rows: Sequence[dict[str, Any]],
    own: Sequence[Row],
    found: Sequence[Row],
) -> dict[str, Any]:
    """The row of an engine's run beside the model: the sign of its differences, and its right answers where they are
    told. rows: those before it; own, found: runs of the model and of the engine."""
    runs = [row for row in rows if row["part"] == "run" and row["specimen"] == run["specimen"]]
    theirs, ours = array_of(run["outcomes"]), array_of(runs[0]["outcomes"])
    sound, asked = np.isin(theirs, [STANDS, OVERTURNS]), theirs != NOT_RUN
    records = np.array([test.record for test in campaign.tests])[asked].tolist()
    pair = confusion(ours[sound] == OVERTURNS, theirs[sound] == OVERTURNS) if sound.any() else None
    equal, interval = equality((theirs != ours)[asked], records)
    counts = {key: asdict(pair)[key] if pair else 0 for key in ("both_stand", "both_overturn", "only_a", "only_b")}
    return {
        "part": "engine",
        **{key: run[key] for key in ("engine", "variant", "specimen", "failed")},
        "tier": get_engine(run["engine"]).variants[run["variant"]].kind,
        "size": int(asked.sum()),
        **counts,
        "p_value": mcnemar(pair) if pair else None,
        "equal": equal,
        "interval": list(interval),
        **answers(run["outcomes"], runs, rows, outcomes_of(campaign.tests, k), records),
        "tilt": _tilts(run["specimen"], own, found),
    }


def answers(
    text: str,
    runs: Sequence[dict[str, Any]],
    rows: Sequence[dict[str, Any]],
    measured: np.ndarray,
    records: Sequence[str],
) -> dict[str, Any]:
    """Right answers of a solver, and of the model on the same tests, with the interval of their share; a failed run is
    not right. None where they are not told; with few failed runs misses and false alarms are not told apart."""
    keys = ("right", "low", "high", "misses", "false_alarms", "model_right")
    told = [row["outcomes"] for row in runs if _told(row, rows)]
    if not may_be_told(text, told):
        return dict.fromkeys(keys)
    digits = array_of(text)
    asked = digits != NOT_RUN
    hit = (np.where(measured, OVERTURNS, STANDS) == digits)[asked]
    model = (np.where(measured, OVERTURNS, STANDS) == array_of(runs[0]["outcomes"]))[asked]
    low, high = clustered(hit, records)
    failed = int((asked & ~np.isin(digits, [STANDS, OVERTURNS])).sum())
    apart = failed == 0 or failed >= FEWEST
    counts = [int((measured & (digits == STANDS)).sum()), int((~measured & (digits == OVERTURNS)).sum())]
    said = (int(hit.sum()), low, high, *(counts if apart else (None, None)), int(model.sum()))
    return dict(zip(keys, said, strict=True))


def _told(run, rows):
    """Whether the right answers of a run are told: the model's are, as it is scored on all tests."""
    if run["engine"] == MODEL:
        return True
    key = {name: run[name] for name in ("engine", "variant", "specimen")}
    return any(row["part"] == "engine" and key.items() <= row.items() and row["right"] is not None for row in rows)


def _tilts(name, own, found):
    """Median of the peak tilts of an engine over the model's, where both rock and stay upright; None: nowhere."""
    model = {row.case.tag["test"]: row.values for row in own if row.case.tag["specimen"] == name}
    pairs = [
        (row.values["tilt"], model[row.case.tag["test"]]["tilt"])
        for row in found
        if row.case.tag["specimen"] == name and not row.failed
        if row.values["outcome"] == model[row.case.tag["test"]]["outcome"] == "rocks"
    ]
    return float(np.median([one / other for one, other in pairs])) if pairs else None
