"""Rows of the solvers that ran a campaign's tests, beside the model's and beside what was measured."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy.stats import binomtest

from engines import get_engine

from ...measuring.forecasts import FEWEST, clustered
from ...measuring.statistics import confusion, equality, mcnemar
from ...running.sweep import Row
from .campaign import Campaign, outcomes_of
from .shaking import OVERTURNS, STANDS
from .telling import NOT_RUN, array_of, may_be_told, text_of

MODEL = "analytic"
ALL = "all"  # specimens together
COUNTS = ("both_stand", "both_overturn", "only_a", "only_b")
ANSWERS = ("right", "low", "high", "misses", "false_alarms", "model_right")


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


def engine_rows(
    campaign: Campaign,
    own: Sequence[dict[str, Any]],
    rows: Sequence[dict[str, Any]],
    runs: tuple[Sequence[Row], Sequence[Row]],
) -> list[dict[str, Any]]:
    """Rows of an engine beside the model, of each specimen and of all together: the sign of its differences, and its
    right answers where they are told.

    own: its `run_row` of each specimen. rows: those of the answer before. runs: of the model and of the engine.
    """
    records = [test.record for test in campaign.tests]
    first = {"part": "engine", **{key: own[0][key] for key in ("engine", "variant")}}
    first["tier"] = get_engine(own[0]["engine"]).variants[own[0]["variant"]].kind
    found, texts, near = [], [], []
    for k, run in enumerate(own):
        others = [row for row in rows if row["part"] == "run" and row["specimen"] == run["specimen"]]
        texts.append((run["outcomes"], others[0]["outcomes"]))
        said = answers(run["outcomes"], others, rows, outcomes_of(campaign.tests, k), records)
        tilt = _tilts(run["specimen"], *runs)
        near.append(_near(campaign, run["specimen"], runs[0]))
        found.append(
            {**first, "specimen": run["specimen"], **differences(*texts[-1], records, near[-1]), **said, "tilt": tilt}
        )
    if len(own) > 1:
        theirs, ours = ("".join(pair[side] for pair in texts) for side in (0, 1))
        together = differences(theirs, ours, records * len(own), np.concatenate(near))
        found.append({**first, "specimen": ALL, **together, **dict.fromkeys((*ANSWERS, "tilt"))})
    return found


def differences(theirs: str, ours: str, records: Sequence[str], near: np.ndarray) -> dict[str, Any]:
    """In what an engine's outcomes differ from the model's, which way, and whether the two are equal.

    p_value: of a sign test over tests. records_a, records_b, p_records: of one over records, each by what most of its
    differences say, as those under one record are alike. A failed run is no difference of a sign, but differs. near: of
    each test, whether the model's own end is sensitive, see `shaking.ended_near`; on_edge: differences there.
    """
    engine, model = array_of(theirs), array_of(ours)
    sound, asked = np.isin(engine, [STANDS, OVERTURNS]), engine != NOT_RUN
    names = np.array(records)
    pair = confusion(model[sound] == OVERTURNS, engine[sound] == OVERTURNS) if sound.any() else None
    equal, interval = equality((engine != model)[asked], names[asked].tolist())
    sign = np.where(sound, (model == OVERTURNS).astype(int) - (engine == OVERTURNS), 0)
    by_record = [int(np.sign(sign[names == name].sum())) for name in dict.fromkeys(records)]
    one, other = by_record.count(1), by_record.count(-1)
    return {
        "size": int(asked.sum()),
        "failed": int((asked & ~sound).sum()),
        **{key: asdict(pair)[key] if pair else 0 for key in COUNTS},
        "p_value": mcnemar(pair) if pair else None,
        "records_a": one,
        "records_b": other,
        "p_records": float(binomtest(one, one + other).pvalue) if one + other else None,
        "near": int((asked & near).sum()),
        "on_edge": int((asked & near & (engine != model)).sum()),
        "equal": equal,
        "interval": list(interval),
    }


def _near(campaign, name, rows):
    """Whether the model's own end is sensitive, of each test."""
    known = {row.case.tag["test"]: row.values["near"] for row in rows if row.case.tag["specimen"] == name}
    return np.array([known[test.name] for test in campaign.tests])


def answers(
    text: str,
    runs: Sequence[dict[str, Any]],
    rows: Sequence[dict[str, Any]],
    measured: np.ndarray,
    records: Sequence[str],
) -> dict[str, Any]:
    """Right answers of a solver, and of the model on the same tests, with the interval of their share; a failed run is
    not right. None where they are not told; with few failed runs misses and false alarms are not told apart."""
    if not may_be_told(text, [row["outcomes"] for row in runs if _told(row, rows)]):
        return dict.fromkeys(ANSWERS)
    said = counted(text, runs[0]["outcomes"], measured, records)
    failed = said.pop("failed")
    return said if failed == 0 or failed >= FEWEST else said | {"misses": None, "false_alarms": None}


def counted(text: str, model: str, measured: np.ndarray, records: Sequence[str]) -> dict[str, Any]:
    """What `answers` counts, all of it."""
    digits, truth = array_of(text), np.where(measured, OVERTURNS, STANDS)
    asked = digits != NOT_RUN
    hit = (truth == digits)[asked]
    low, high = clustered(hit, np.array(records)[asked].tolist())
    return {
        "right": int(hit.sum()),
        "low": low,
        "high": high,
        "misses": int((measured & (digits == STANDS)).sum()),
        "false_alarms": int((~measured & (digits == OVERTURNS)).sum()),
        "model_right": int((truth == array_of(model))[asked].sum()),
        "failed": int((asked & ~np.isin(digits, [STANDS, OVERTURNS])).sum()),
    }


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
