"""What each study gives to the report's first screen, counted by hand from small made-up rows."""

import pytest

from comparisons.execution.results import Result
from comparisons.studies import get_study
from comparisons.studies.shake_table.campaign import ALL
from comparisons.studies.shake_table.judging import BY_RECORD, CURVE, FREQUENT, IN_SAMPLE, MODEL, ONE, THRESHOLD

ENGINE = {"part": "run", "engine": "e", "variant": "v", "tier": "tuned"}
VARIANT = {"engine": "e", "variant": "v", "tier": "tuned", "parameter": "step", "default": 1e-3}


def glance(study, rows, **settings):
    return get_study(study).glance(Result(study, {"variants": [VARIANT], **settings}, rows, {}))


def ends(study, rows, **settings):
    """(all judged, missed, added, other, late, failed), (differing among those left out, left out) of one variant."""
    (one,) = glance(study, rows, **settings).endings
    counts = one.runs, one.missed, one.added, one.other, one.late, one.failed
    return counts, (one.left_differing, one.left_out)


def run(kind, model, own, *quantities, **more):
    return {**ENGINE, "class": kind, "model_outcome": model, "outcome": own, "quantities": list(quantities), **more}


RUNS = (
    run("right", "rocks", "rocks"),
    run("differs", "overturns", "overturns", "fall_time"),
    run("differs", "overturns", "rocks", "outcome"),
    run("differs", "rocks", "overturns", "outcome"),
    run("differs", "rocks", "stands", "outcome"),
    run("failed", "rocks", "failed"),
    run("left out", "overturns", "overturns"),
    run("left out", "rocks", "overturns"),
    run("left out", "rocks", "failed"),
)
COUNTED = (6, 1, 1, 1, 1, 1), (2, 3)


def test_recorded_motions_keep_a_fall_at_another_time_apart_from_another_outcome():
    rows = [{**one, "record": str(k), "model_tilt": 0.5, "own_tilt_error": None} for k, one in enumerate(RUNS)]
    assert ends("recorded", rows) == COUNTED


def test_synthetic_motions_count_alike():
    falls = {"overturns": True, "failed": None}
    rows = [
        {key: value for key, value in one.items() if "outcome" not in key}
        | {"seed": k, "model_overturns": one["model_outcome"] == "overturns"}
        | {"overturns": falls.get(one["outcome"], False), "quantities": one["quantities"] or None}
        for k, one in enumerate(RUNS)
    ]
    assert ends("fragility", rows) == COUNTED


def test_sliding_blocks_count_alike_and_a_slip_that_differs_is_the_same_end():
    runs = (*RUNS, run("differs", "slides", "slides", "peak_slip"))
    more = {"friction": 0.3, "differences": [], "comparable": "yes", "lost": 0}
    rows = [{**one, **more, "index": k} for k, one in enumerate(runs)]
    scenes = [{"part": "scene", "index": row["index"], "outcome": row["model_outcome"]} for row in rows]
    free = [{**one, "friction": None} for one in rows]  # which do not count there
    (first, *counts), left_out = ends("statues", [*scenes, *rows, *free], variants=[])
    assert (first, left_out) == (7, COUNTED[1]) and tuple(counts) == COUNTED[0][1:]


def test_pulses_leave_out_what_is_within_the_band_of_a_boundary():
    """Of four points one is .5 % off a boundary; the other that was not judged would jump."""
    scan = {key: value for key, value in ENGINE.items() if key != "tier"} | {"part": "scan", "level": 1e-3}
    scan |= {"runs": 2, "failed": 1, "only_a": 1, "only_b": 0, "interval": [0.0, 0.9]}
    edge = {"part": "edge", "ground": "a", "shape": "sine", "frequency": 2.0, "amplitude": 3.0}
    settings = {"grounds": {"a": {}}, "shapes": ["sine"], "frequencies": [2.0], "scan": [1.0, 2.0, 3.015, 4.0]}
    assert ends("overturning", [scan, edge], **settings, band=0.01) == ((2, 1, 0, 0, None, 1), (None, 1))


def table_row(**more):
    """An engine's row of a shake table: of 100 tests it differs in 6 and fails in 2; 5 of these are among 20 near."""
    row = {**ENGINE, "part": "engine", "specimen": ALL, "size": 100, "failed": 2, "only_a": 4, "only_b": 2, "near": 20}
    row |= {"near_missed": 3, "near_added": 1, "near_failed": 1, "right": None, "equal": "no", "records_a": 1}
    return row | {"interval": [0.0, 0.5]} | more


def shaken(*engines, more=(3, -1.0, 7.0)):
    """A result of two blocks in 50 tests each, all of which the rivals predict less well."""
    rights = {MODEL: (46, 45), CURVE: (44, 44), THRESHOLD: (43, 42), FREQUENT: (30, 35)}
    scores = [
        {"part": "score", "forecast": name, "judged": BY_RECORD, "specimen": specimen, "right": right, "size": 50}
        for name, both in rights.items()
        for specimen, right in zip(("one", "two"), both, strict=True)
    ]
    alike = [row | {"forecast": ONE, "judged": IN_SAMPLE, "right": row["right"] - 1} for row in scores[:2]]
    pair = {"part": "paired", "forecast": MODEL, "beside": CURVE, "specimen": ALL}
    pair |= {"more_right": more[0], "more_interval": list(more[1:])}
    settings = {
        "records": 10,
        "missing": {"tests": 3},
        "tests": ["t"] * 50,
        "specimens": [{"name": "one"}, {"name": "two"}],
    }
    return glance("shake-table", [*scores, *alike, pair, *engines], **settings)


def test_a_shake_table_is_counted_away_from_boundaries_too():
    (one,) = shaken(table_row()).endings
    assert (one.runs, one.missed, one.added, one.failed, one.late) == (80, 1, 1, 1, None)
    assert (one.differing, one.left_differing, one.left_out, one.interval) == (3, 5, 20, (0.0, 0.5))


@pytest.mark.parametrize(
    "more, words",
    [
        ((3, 0.0, 7.0), "not shown to be better than"),
        ((8, 1.0, 15.0), "shown to be better than"),
        ((-8, -15.0, -1.0), "shown to be worse than"),
    ],
)
def test_the_model_is_better_than_the_curve_only_where_the_interval_says_so(more, words):
    assert (
        f"It is {words} the curve ({more[0]} more, 95 % interval".replace("-", "−") in shaken(more=more).says["real"][0]
    )
