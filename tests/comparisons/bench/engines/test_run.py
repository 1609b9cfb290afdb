"""The wide box: its scenes fill it, every one gets its class, tables and figure count them all."""

import json
import math
from functools import partial

import numpy as np
import pytest
from kept_runs import FREE, kept

from analytic import Block, PulseMotion, Scene
from comparisons.bench.engines import tables, wide_box
from comparisons.bench.engines.figure import draw
from comparisons.bench.engines.run import bench_engines, examine, judged
from comparisons.measuring import verdicts
from comparisons.measuring.verdicts import findings, rule
from comparisons.running.provenance import json_ready
from comparisons.running.sweep import Row


@pytest.fixture(scope="module")
def ensemble():
    return [wide_box.wide_scene(1, index) for index in range(600)]


def test_scenes_lie_in_the_box_and_fill_it(ensemble):
    assert wide_box.wide_scene(1, 7).digest() == ensemble[7].digest() != wide_box.wide_scene(2, 7).digest()
    places = [wide_box.place(scene) for scene in ensemble]
    box = {
        "slenderness": (0.03, 1.2),
        "inertia": (1.01, 3.0),
        "base": (1e-5, 100.0),
        "radius": (1e-3, 30.0),
        "mass": (1e-3, 1e6),
        "tilt": (1e-4, 0.99),
        "stiffness": (0.0, 1e9),
    }
    for name, (low, high) in box.items():
        values = np.array([place[name] for place in places if place[name] is not None])
        assert low * (1 - 1e-9) <= values.min() and values.max() <= high * (1 + 1e-9), name
        if low:
            spread = np.log(values / low) / math.log(high / low)
            assert spread.min() < 0.1 and spread.max() > 0.95, name
    assert all(scene.bearings.damping <= 1e6 for scene in ensemble if scene.bearings)
    core = np.mean([place["core"] for place in places])
    assert 1 / 3 <= core <= 0.5
    assert {place["law"] for place in places} == {None, "algebraic", "linear", "bouc-wen"}
    assert sum(scene.base is None for scene in ensemble) > 100
    assert sum(scene.base is not None and scene.bearings is None for scene in ensemble) > 50


def test_the_model_itself_is_right(ensemble):
    for scene in ensemble[:40]:
        if scene.bearings is None:
            run = kept(scene)
            assert findings(scene, run, kept(scene, tolerance=1e-13)) == []


def rows_of(cases, changes=None, failure=None):
    """What a sweep would hand back, run here with the analytic model and changed."""
    rows = []
    for case in cases:
        values = {**kept(case.scene), **(changes or {})}
        rows.append(Row(case, values, failure, {"cpu_seconds": 1e-3}, False))
    return rows


@pytest.mark.parametrize(
    "changes, failure, expected",
    [
        ({}, None, "right"),
        ({"warnings": ["w"]}, None, "right but warned"),
        ({"tilt": 0.2}, None, "off and silent"),
        ({"tilt": 0.2, "warnings": ["w"]}, None, "off and warned"),
        ({}, {"kind": "time limit", "reason": "no result", "message": "m"}, "failed and said"),
    ],
)
def test_classes(changes, failure, expected):
    (row,) = judged(
        [FREE], "exudyn", lambda cases, label: rows_of(cases), lambda cases: rows_of(cases, changes, failure)
    )
    assert row["class"] == expected
    assert row["cause"] == ("no result" if failure else None)
    assert json.loads(json.dumps(json_ready(row)))["place"]["slenderness"] == 0.25


def test_overturning_is_judged_up_to_the_unstable_point_and_by_its_outcome():
    scene = Scene(
        block=Block(mass=1.0, radius=1.0, slenderness=0.25), duration=4.0, motion=PulseMotion("one-sine", 8.0, 6.0)
    )
    run = kept(scene)
    assert run["outcome"] == "overturns" and rule(scene, run) is None
    for changes, expected in (
        ({}, "right"),
        ({"tilt": 9.9, "displacement": 9.9}, "right"),
        ({"outcome": "rocks"}, "off and silent"),
        ({"tilts": [9.9] * 50}, "off and silent"),
        ({"outcome": "rocks", "decided": False}, "right"),
    ):
        (row,) = judged([scene], "exudyn", lambda cases, label: rows_of(cases), partial(rows_of, changes=changes))
        assert row["class"] == expected and row["judged_until"] == run["unstable"]
    thrown = scene.with_(motion=None, start={"tilt": 0.1, "tilt_rate": 2.0})
    cut = thrown.with_(duration=kept(thrown)["unstable"] * 1.05)
    assert kept(cut)["outcome"] == "overturns"  # the model follows a certain fall to its end, an engine may not
    short = {"outcome": "rocks", "decided": False, "tilt": 1.2 * 0.25}
    (row,) = judged([cut], "exudyn", lambda cases, label: rows_of(cases), partial(rows_of, changes=short))
    assert row["class"] == "right"


def test_what_the_model_leaves_out_the_engine_is_not_asked():
    scene = FREE.with_(base={"mass": 5e-3}, start={"tilt": 0.0, "tilt_rate": 4.0})  # thrown off its corner at once
    assert rule(scene, kept(scene)) is not None
    (row,) = judged([scene], "exudyn", lambda cases, label: rows_of(cases), lambda cases: rows_of(cases) * len(cases))
    assert row["class"] == "left out" and row["cause"] == rule(scene, kept(scene)) and row["outcome"] is None


def test_bench_from_scenes_to_figure(tmp_path):
    pytest.importorskip("pybullet", reason="PyBullet's wheels end at CPython 3.11")
    rows = bench_engines("pybullet", tmp_path, scenes=3, seed=10, workers=1, progress=False)
    again = bench_engines("pybullet", tmp_path, scenes=3, seed=10, workers=1, progress=False)
    assert json.dumps(rows) == json.dumps(again)  # nothing was run twice: CPU seconds are the same
    assert [row["index"] for row in rows] == list(range(3))
    assert {row["class"] for row in rows} <= set(verdicts.CLASSES)
    right = next(row["index"] for row in rows if row["class"] == "right")
    assert examine("pybullet", right, seed=10)[3]["class"] == "right"
    stored = json.loads((tmp_path / "bench-engines-pybullet.json").read_text())
    assert stored["rows"] == json_ready(rows) and stored["provenance"]["seed"] == 10
    draw(rows, "test", tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 20_000


def test_tables_count_every_scene_and_name_every_cause():
    place = wide_box.place(FREE)
    common = {
        "notes": [],
        "judged_until": None,
        "place": place,
        "cause": None,
        "findings": [],
        "warnings": [],
        "outcome": "rocks",
        "expected": "rocks",
    }
    warning = "radius R [m] = 0.001 is below 0.01, the limit of the range verified"
    off = [{"quantity": "tilt", "error": 0.03, "limit": 0.02}]
    changes = [
        {"class": "right"},
        {"class": "right but warned", "warnings": [warning]},
        {"class": "off and silent", "findings": off},
        {"class": "left out", "cause": "N <= 0"},
        {"class": "failed and said", "cause": "no result within the time limit of 60 s"},
    ]
    rows = [{**common, **change, "index": k} for k, change in enumerate(changes)]
    one, other = ({**rows[1], "warnings": [f"the base vibrates at {rate} times, of m R^2"]} for rate in ("42", "2e3"))
    assert tables.causes(one) == tables.causes(other) == ["warned: the base vibrates at # times, of m R^2"]
    assert [tables.causes(row) for row in rows[1:]] == [
        ["warned: radius R [m]"],
        ["off: tilt"],
        ["N <= 0"],
        ["no result within the time limit of # s"],
    ]
    table = tables.class_table(rows, "five")
    assert list(table.columns[1].cells)[:6] == ["1", "1", "0", "1", "1", "1"]
    assert list(table.columns[2].cells)[0] == "25.0%"  # of the four that are not left out
    assert tables.cause_table(rows).row_count == 4 and tables.off_table(rows).row_count == 1
