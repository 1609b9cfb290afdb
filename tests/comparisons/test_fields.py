"""Each field of what the commands write as JSON: a wrong value in it is seen here.

A document is made by its command. What is known of it comes from elsewhere: the scene file, a closed form, the history
of the run, the factor of a lie, a digest or a count made here. Fields are listed from the types, so that one which no
document here shows is named.
"""

import contextlib
import hashlib
import io
import json
import math
import os
import platform
import subprocess
import sys
import types
import typing
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import fake_solvers
import lying_engine
import numpy as np
import psutil
import pytest
from lying_engine import Liar, liars, noise
from made_up_records import knet_csv
from pydantic import BaseModel
from pytest import approx
from roads import BASE, BEARINGS, KINDS, LINEAR, G, pulse, scene, start
from scipy.integrate import quad, trapezoid
from scipy.optimize import brentq

from analytic import SceneError, bearing_scan, load_scene, margins, read_record, simulate
from analytic.design import design_bearings
from comparisons import cli
from comparisons.advice.criteria import until
from comparisons.commands import margin
from comparisons.measuring import tolerances
from comparisons.measuring.agreement import Unmeasurable
from comparisons.measuring.horizon import sensitivity_horizon
from comparisons.report import next_step, statue
from comparisons.running.check import check
from comparisons.running.executors import Done, Executor, lines_of
from comparisons.running.plan import Batch, Computed, Study
from comparisons.running.study import compute
from comparisons.schemas.__main__ import FORMS
from engines import ENGINES, guard
from engines.contract import Engine
from engines.copies import near_copies

TILT = fake_solvers.tilt
PACKAGES = {engine.package for engine in ENGINES.values()}
FORM = {form.__name__: form for form in FORMS}
EMPTY = (None, "", [], {})  # what shows nothing of a field
GAMMA, MASS, RADIUS = 0.25, 400.0, 1.0  # of `roads.scene`
TAN = math.tan(GAMMA)
# A record of two horizontal components and a vertical one [gal], cut off after half the time that it states.
QUAKE = knet_csv(300 * noise(100, 1), seconds=4)
PEAK_TIME = 0.02 * float(np.abs(noise(100, 1)).argmax())
CUT = "quake.csv: the header states 4 s, the data have 2 s: check that the file is whole"
CHANNELS = {
    number: f"quake.csv, channel {number} ({direction}) (offset subtracted)"
    for number, direction in {1: "N-S", 2: "E-W", 3: "U-D"}.items()
}
LEFT_OUT = [
    f"{CHANNELS[3]}: left out, a vertical motion; a scene whose [motion] names it as vertical beside its record runs it"
]
MISSING = {"absent": "engine 'absent' needs the package no_such_package: buy it"}
PAST = {
    "kind": "limit",
    "text": "The block starts at a tilt of 0.26 rad, past its balance at 0.25 rad: it falls unless something brings it back.",
    "quantity": "start.tilt",
    "value": 0.26,
    "limit": 0.25,
}
OWN = "the scene's own motion"
UNUSUAL = {"kind": "record", "text": CUT, "quantity": None, "value": None, "limit": None}
COUNTED = "Components, directions and signs count as one motion. Left out of the folder: 1 file or channel."
NEVER = "under 0 of 2 motions (0 to 66 % at 95 %)"  # Wilson's interval of 0 of 2
ONCE = "under 1 of 2 motions (9.5 to 91 % at 95 %)"
ODD = "Warning: the record is unusual under 1 of 2 motions."

SLIDES = scene(motion=pulse(1.6, 30.0), friction=0.15)
FALLS = KINDS["overturns after an impact"][0]
BEARS = scene(LINEAR + "x_max = 0.02\n", pulse(4.0, 9.0))
YIELDS = scene(
    BASE + BEARINGS.format(law="bouc-wen", ka=5500.0) + "kb = 5000.0\nalpha = 40.0\ndamping = 50.0\nx_max = 0.02\n",
    pulse(3.5, 9.0),
    more="[run]\nduration = 1.7\n",
)


# The walk along the types.


def model_in(kind):
    """The form that a type holds, or None."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    return next(filter(None, map(model_in, typing.get_args(kind))), None)


# Fields that no command fills: designed bearings are of the algebraic law.
NULL = {("Constants", "yield_force")}


def fields_of(form, seen):
    """{(class, field)} of a form and all its parts."""
    if form is None or form in seen:
        return set()
    seen.add(form)
    inner = set().union(*(fields_of(model_in(field.annotation), seen) for field in form.model_fields.values()))
    return inner | {(form.__name__, name.rstrip("_")) for name in form.model_fields}


def leaves(kind, found, wanted, pair=None):
    """((class, field), value in the document, value known) of what is known of a document, a dict of some of its
    fields. Of a list {"of": its length, index: what is known of that entry} will do."""
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        kind = next((one for one in typing.get_args(kind) if model_in(one)), None)
    form, inner = model_in(kind), (typing.get_args(kind) or [None])[-1]
    if form is None or found is None or wanted is None:
        yield pair, found, wanted
    elif kind is form:
        names = {name.rstrip("_"): field.annotation for name, field in form.model_fields.items()}
        yield pair, sorted(found), sorted(names)
        for name, one in wanted.items():
            yield from leaves(names[name], found.get(name), one, (form.__name__, name))
    elif isinstance(found, list):
        known = wanted if isinstance(wanted, dict) else {"of": len(wanted), **dict(enumerate(wanted))}
        yield pair, [0] * len(found), [0] * known["of"]
        for at, one in zip(range(len(found)), found, strict=True):
            yield from leaves(inner, one, known.get(at, {}), pair)
    else:
        yield pair, sorted(found), sorted(wanted)
        for name in found.keys() & wanted.keys():
            yield from leaves(inner, found[name], wanted[name], pair)


def agrees(found, wanted):
    """Whether a value of a document is the one known: numbers within rounding; a function tells of what it is given."""
    if callable(wanted):
        return wanted(found)
    if isinstance(wanted, dict):
        return found.keys() == wanted.keys() and all(agrees(found[name], wanted[name]) for name in wanted)
    if isinstance(wanted, list | tuple) and isinstance(found, list):
        return len(found) == len(wanted) and all(map(agrees, found, wanted))
    return found == (approx(wanted) if isinstance(wanted, float) else wanted)


def wrong(value):
    """Another value of the same kind."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return 1.5 * value + 1
    if isinstance(value, str):
        return value + "x"
    return value[:-1] if isinstance(value, list) else dict([*value.items()][:-1])


# Engines, and where they run.


class Here(Executor):
    """Runs in this process, so that they find its engines."""

    slots = 1

    def __init__(self, *_):
        self.done = []

    def submit(self, task):
        self.done.append(Done(task.ticket, lines_of(task)))

    def next(self):
        return self.done.pop()

    def __exit__(self, *_):
        pass


LATE, LATER = 0.002, 0.25  # s


def off(scene, run):
    """Peaks too large, impacts too late, and the end too late."""
    late = tuple(replace(one, time=one.time + LATE) for one in run.impacts)
    over = run.overturning_time and run.overturning_time + LATER
    tilts = {name: 1.05 * getattr(run, name) for name in ("peak_tilt", "peak_tilt_ratio")}
    stroke = 1.07 * run.peak_base_displacement
    return replace(run, impacts=late, overturning_time=over, peak_base_displacement=stroke, **tilts)


def coarse(scene, run):
    """Rates after impacts too small by the step."""
    return lying_engine._rates(1 - run.settings["step"])(scene, run)


@pytest.fixture(scope="module")
def ask(tmp_path_factory):
    """Runs a command in a folder of its own and reads its JSON; engines that lie take the place of all others."""
    folder = tmp_path_factory.mktemp("fields")
    (folder / "records").mkdir()
    (folder / "records" / "quake.csv").write_text(QUAKE)
    known = dict(ENGINES)

    def call(*words):
        Path("out.json").unlink(missing_ok=True)
        with contextlib.redirect_stdout(io.StringIO()), pytest.raises(SystemExit):
            cli.main([*map(str, words), "--json", "out.json"])
        return json.loads(Path("out.json").read_text())

    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for lie in (coarse, off):
            patch.setitem(lying_engine.LIES, lie.__name__, lie)
        variant = replace(lying_engine.VARIANTS["lies"], levels=(1e-2, 3e-3, 1e-3))
        patch.setitem(lying_engine.VARIANTS, "lies", variant)
        style = dict(install="buy it", colour="black", marker="o", adapter="lying_engine")
        packages = {"coarse": "lying_engine", "off": "lying_engine", "absent": "no_such_package"}
        own = {name: Liar.of(Engine(name=name, package=package, **style)) for name, package in packages.items()}
        lied = {name: one for name, one in liars().items() if name in ("loss", "restitution", "honest", "fails")}
        patch.setattr(guard, "run_apart", lambda function, *arguments, **_: (function(*arguments), None))
        choosing = import_module("comparisons.advice.choose")  # the package has a function so called
        for place in (choosing, import_module("comparisons.running.study"), import_module("comparisons.running.check")):
            patch.setattr(place, "Processes", Here)
        for place in (choosing, import_module("comparisons.advice.criteria")):
            patch.setattr(place, "cpu_seconds", lambda scene: 0.003 if scene.base is None else 0.015)
        for place in ("study.source_digests", "cases.source_digests", "study.digests_of_all"):
            patch.setattr(f"comparisons.running.{place}", lambda *_: {})
        for place in ("provenance", "by_solver"):
            patch.setattr(f"comparisons.running.{place}.kept_digests", lambda roots: {one: one[::-1] for one in roots})
        patch.setattr("comparisons.running.cases.version_of", lambda _: "1")
        patch.setattr("comparisons.report.write.write_page", lambda folder, *_: Path(folder) / "report.html")
        patch.setattr(psutil, "cpu_count", lambda logical=True: 6 if logical else 3)
        patch.setattr(margin, "STEPS", 20)
        patch.setattr(margins, "STEP", 0.0125)
        patch.setattr(bearing_scan, "PERIOD_STEP", 0.4)
        patch.setattr(bearing_scan, "DAMPING_STEP", 0.05)
        patch.setattr(statue, "STEP", 0.1)
        patch.setattr(next_step, "STEP", 0.2)
        ENGINES.clear()
        ENGINES.update({**own, **lied})
        yield call
        ENGINES.clear()
        ENGINES.update(known)


# What is known of documents: each function yields (name of the form, document, what is known of it).


def written(text, name="s"):
    """The scene of a text, written down as NAME.toml."""
    Path(f"{name}.toml").write_text(text)
    return load_scene(f"{name}.toml")


def last(history):
    """The state at the end of a history."""
    names = ("time", "tilt", "tilt_rate", "base_displacement", "base_velocity", "bearing_force")
    return {name: getattr(history, name)[-1] for name in names}


def beyond(stroke):
    """The warning of a base beyond an x_max of 0.02 m."""
    text = (
        f"the base moves by {stroke:.3g} m, beyond the x_max = 0.02 m of its bearings: they may tear or hit a stop, "
        "and the outcome is outside the model"
    )
    value = approx(stroke, rel=1e-5)
    return {"kind": "limit", "text": text, "quantity": "peak_base_displacement", "value": value, "limit": 0.02}


def under(scene, motion):
    """The history of a scene under a motion, until its outcome is decided."""
    return simulate(scene.with_(motion=motion, duration=None), output_step=1e-4).history


def motions(scene, label, *outcomes):
    """What is known of a scene under its own motion and the two of the record."""
    own = [(OWN, label, float(label.split()[2]), scene.motion, [])]
    for number, peak in ((1, 3.0), (2, 6.0)):
        motion = read_record("records/quake.csv", channel=number)
        own.append(("quake.csv", CHANNELS[number], peak, motion, [UNUSUAL]))
    rows = []
    for (record, name, peak, motion, warnings), outcome in zip(own, outcomes, strict=True):
        history = under(scene, motion)
        stroke = float(np.abs(history.base_displacement).max())
        more = [beyond(stroke)] if scene.bearings and stroke > (scene.bearings.x_max or math.inf) else []
        rows.append(
            {
                "record": record,
                "motion": name,
                "peak": peak,
                "warnings": warnings + more,
                "outcome": outcome,
                "failure": None,
                "tilt": approx(np.abs(history.tilt).max() / scene.block.slenderness, rel=1e-5),
                "stroke": approx(stroke, rel=1e-5) if scene.base else None,
                "slip": None if history.slip is None else approx(np.abs(history.slip).max(), rel=1e-3),
            }
        )
    return rows


def standing(ask):
    """On ground that moves up and down: the contact forces are those of the moving mass."""
    written(scene(motion=pulse(1.0, vertical=4.0)))
    contact = {"friction_demand": approx(1.0 / (G - 4.0), rel=1e-3), "min_normal_ratio": approx(1 - 4.0 / G, rel=1e-3)}
    known = {"outcome": "stands", "decided": True, "impact_count": 0, "peak_base_acceleration": 1.0, **contact}
    yield "Run", ask("run", "s.toml"), known


def released(ask):
    """Housner's block, exactly: each impact keeps 1 - 3/2 sin2(gamma) of the rate, until it rests."""
    text = scene(more=start(0.15) + "[run]\nduration = 12.0\n")
    run, square, kept = simulate(written(text), history=False), 0.75 * G / RADIUS, 1 - 1.5 * math.sin(GAMMA) ** 2
    rates = math.sqrt(2 * square * (math.cos(GAMMA - 0.15) - math.cos(GAMMA))) * kept ** np.arange(150)
    turns = GAMMA - np.arccos(math.cos(GAMMA) + rates**2 / (2 * square))
    falls = np.array([quad(_falling, 0, 1, args=(turn, square))[0] for turn in turns])
    times = falls[0] + 2 * np.concatenate([[0.0], np.cumsum(falls[1:])])
    lost = MASS * G * RADIUS * (math.cos(GAMMA - 0.15) - math.cos(GAMMA))
    hits = {
        at: {
            "time": times[at],
            "rate_before": -((-1) ** at) * rates[at],
            "rate_after": -((-1) ** at) * kept * rates[at],
            "base_velocity_jump": 0.0,
        }
        for at in range(4)
    }
    yield (
        "Run",
        ask("run", "s.toml"),
        {
            "schema": "rocking run 4",
            "engine": "analytic",
            "variant": "kernel",
            "scene": "s",
            "outcome": "rocks",
            "peak_tilt": 0.15,
            "peak_tilt_ratio": 0.6,
            "impact_count": run.impact_count,
            "impacts": {"of": run.impact_count, **hits},
            "rests": [approx(times[-1], rel=1e-4)],
            "cpu_seconds": lambda spent: 0 < spent < 0.5,
            "steps": run.steps,
            "settings": {"tolerance": 1e-11, "rest_rate": 1e-8, "order": 18, "short_order": 8},
            "versions": {name: version(name) for name in ("numpy", "numba")},
            "comparable": "no",
            "energy": {"kinetic": 0.0, "potential": -lost, "impact_loss": lost},
        },
    )


def _falling(part, turn, square):
    """Seconds a unit of `part`, of a block that falls from `turn` to turn (1 - part^2)."""
    tilt = turn * (1 - part**2)
    gained = 2 * math.sin(GAMMA - (turn + tilt) / 2) * math.sin((turn - tilt) / 2)
    return (
        2 * turn * part / math.sqrt(2 * square * gained)
        if part
        else 2 * math.sqrt(turn / (2 * square * math.sin(GAMMA - turn)))
    )


def yielding(ask):
    """A block that rocks on bearings beyond their x_max: all of its energies, from its history."""
    what = written(YIELDS)
    history = simulate(what, output_step=2e-5).history
    time, tilt, rate, x, v = (
        getattr(history, name) for name in ("time", "tilt", "tilt_rate", "base_displacement", "base_velocity")
    )
    (hit,) = np.flatnonzero(tilt[1:] * tilt[:-1] < 0)
    arm = MASS * RADIUS * np.cos(GAMMA - np.abs(tilt))
    moving = 300.0 * v**2 + arm * rate * v + MASS * RADIUS**2 * rate**2 * 2 / 3
    spring = 4 * 5000.0 * x[-1] ** 2 / 2
    viscous = 4 * 50.0 * trapezoid(v**2, time)
    stroke, peak = float(np.abs(x).max()), float(np.abs(tilt).max())
    yield (
        "Run",
        ask("run", "s.toml", "--records", "records"),
        {
            "decided": False,
            "unstable_time": approx(time[np.abs(tilt) > GAMMA][0], abs=1e-4),
            "peak_tilt": approx(peak, rel=1e-6),
            "peak_tilt_ratio": approx(peak / GAMMA, rel=1e-6),
            "peak_base_displacement": approx(stroke, rel=1e-5),
            "peak_base_acceleration": approx(
                np.abs(np.gradient(v, time) + history.ground_acceleration)[: hit - 5].max(), rel=1e-3
            ),
            "impact_count": 1,
            "impacts": [
                {
                    "time": approx(time[hit], abs=1e-4),
                    "rate_before": approx(rate[hit], rel=1e-3),
                    "rate_after": approx(rate[hit + 1], rel=1e-3),
                    "base_velocity_jump": approx(arm[hit] * (rate[hit] - rate[hit + 1]) / 600.0, rel=1e-2),
                }
            ],
            "uplifts": [approx(time[np.flatnonzero(tilt)[0]], abs=1e-3)],
            "end": last(history),
            "warnings": [beyond(stroke)],
            "energy": {
                "kinetic": approx(moving[-1], rel=1e-6),
                "potential": approx(
                    RADIUS * MASS * G * (math.cos(GAMMA - tilt[-1]) - math.cos(GAMMA)) + spring, rel=1e-6
                ),
                "input": approx(-trapezoid(history.ground_acceleration * (600.0 * v + arm * rate), time), rel=1e-4),
                "hysteretic": approx(trapezoid(history.bearing_force * v, time) - spring - viscous, rel=1e-3),
                "viscous": approx(viscous, rel=1e-4),
                "impact_loss": approx(moving[hit] - moving[hit + 1], rel=1e-2),
            },
            "motions": motions(what, "one-sine pulse, 3.5 m/s2, 9 rad/s", "overturns", "stands", "stands"),
            "left_out": LEFT_OUT,
            "headline": f"Warning: the base exceeds x_max under 2 of 2 motions. {ODD} The block lifts {ONCE}, and overturns "
            f"{ONCE}. {COUNTED}",
        },
    )


def sliding(ask):
    """Coulomb's block, which slides where the ground is faster than the friction allows."""
    what = written(KINDS["slides"][0])
    history = simulate(what, output_step=1e-4).history
    way = approx(np.abs(np.diff(history.slip)).sum(), rel=1e-4)
    work = approx(0.15 * MASS * G * np.abs(np.diff(history.slip)).sum(), rel=1e-4)
    begins, ends = math.asin(0.15 * G / 3.0) / 6.0, history.time[np.flatnonzero(np.diff(history.slip))[-1]]
    yield (
        "Run",
        ask("run", "s.toml", "--records", "records"),
        {
            "outcome": "slides",
            "motions": motions(what, "one-sine pulse, 3 m/s2, 6 rad/s", "slides", "slides", "slides"),
            "energy": {"friction": work},
            "sliding": {
                "peak": approx(np.abs(history.slip).max(), rel=1e-4),
                "end": approx(history.slip[-1], rel=1e-4),
                "path": way,
                "work": work,
                "modes": [[0.0, "stick"], [begins, "slide"], [approx(ends, abs=1e-3), "stick"]],
            },
        },
    )


def falling(ask):
    history = simulate(written(FALLS), output_step=1e-4).history
    rises = history.time[np.abs(history.tilt) > GAMMA][0]
    known = {
        "overturning_time": history.time[-1],
        "unstable_time": approx(rises, abs=1e-4),
        "fall_time": approx(rises, abs=1e-4),
    }
    lifts = math.asin(G * TAN / 4.0) / 6.0
    yield "Run", ask("run", "s.toml"), {**known, "outcome": "overturns", "peak_tilt": math.pi / 2, "uplifts": [lifts]}


def compared(ask):
    """Lies by known factors, and an engine that fails."""
    what = written(KINDS["rocks"][0])
    run, history = simulate(what, history=False), simulate(what).history
    kept = 1 - 1.5 * math.sin(GAMMA) ** 2
    ends = [sensitivity_horizon(what, perturbation=one).horizon for one in (0.004, 0.02)]
    peaks = [simulate(copy, history=False).peak_tilt for copy in near_copies(what)] + [run.peak_tilt]
    engines = [word for name in ("loss", "restitution", "off", "fails") for word in ("--engine", name)]
    yield (
        "Comparison",
        ask("compare", "s.toml", *engines),
        {
            "schema": "rocking compare 4",
            "scene": "s",
            "sensitivity_horizon": min(ends),
            "sensitivity": {
                "loss": {"perturbation": 0.004, "horizon": ends[0]},
                "restitution": {"perturbation": 0.02, "horizon": ends[1]},
                "off": {},
            },
            "responses": {
                "of": 5,
                0: {"engine": "analytic"},
                1: {"engine": "loss", "variant": "lies", "comparable": "yes", "differences": []},
                2: {
                    "engine": "restitution",
                    "settings": {"step": 0.001},
                    "versions": {"lying-engine": "0.1"},
                    "cpu_seconds": 0.01,
                    "differences": [{"quantity": "restitution", "here": 0.98 * kept, "model": kept, "limit": 0.01}],
                },
                3: {
                    "differences": [
                        {
                            "quantity": "peak_tilt",
                            "here": 1.05 * run.peak_tilt,
                            "model": run.peak_tilt,
                            "limit": 0.02,
                            "near": [min(peaks), max(peaks)],
                        }
                    ]
                },
                4: {
                    "outcome": "failed",
                    "failure": {"reason": "it blew up", "message": "12 J at .5 s", "last_state": last(history)},
                },
            },
        },
    )


def changed(ask):
    """Blocks at their limits: the friction needed is a/g, the block lifts at g tan(gamma), it flies at g."""
    what = written(SLIDES)
    states = ("slides", "lifts", "tilt", "overturns")
    none = dict.fromkeys(states)
    slower, rougher = approx(0.15 * G / 1.6 - 1, rel=1e-4), approx(1.6 / (0.15 * G) - 1, rel=1e-4)
    rows = motions(what, "one-sine pulse, 1.6 m/s2, 30 rad/s", "slides", "slides", "slides")
    own = {"reached": ["slides"], "interleaved": False}
    more = [{**own, "changes": {**none, "slides": found}} for found in (slower, None, None)]
    yield (
        "Margins",
        ask("margin", "s.toml", "--tilt", 0.4, "--records", "records"),
        {
            "schema": "rocking margin 4",
            "scene": "s",
            "outcome": "slides",
            "tilt": 0.4,
            "span": 0.2,
            "reached": ["slides"],
            "margins": {
                "of": 4,
                0: {
                    "quantity": "motion",
                    "value": 1.6,
                    "unit": "m/s2",
                    "bands": [
                        {"low": -0.2, "high": slower, "reached": [], "outcome": "stands", "holds": True},
                        {"low": slower, "high": 0.2, "reached": ["slides"], "outcome": "slides"},
                    ],
                    "changes": {**none, "slides": slower},
                    "down": slower,
                    "up": None,
                    "nearest": slower,
                    "interleaved": False,
                },
                1: {
                    "quantity": "friction",
                    "value": 0.15,
                    "unit": "-",
                    "down": None,
                    "up": rougher,
                    "nearest": rougher,
                },
            },
            "contact": {"least_normal": 1.0, "friction_demand": 0.15, "friction": 0.15, "slides": True},
            "motions": [{**row, **one} for row, one in zip(rows, more, strict=True)],
            "left_out": LEFT_OUT,
            "headline": f"{ODD} The block lifts {NEVER}, and overturns {NEVER}. {COUNTED}",
        },
    )
    light = written(scene(motion=pulse(0.5, 9.0, vertical=18 * 0.981)))
    flies = brentq(lambda one: simulate(light.with_(motion=light.motion.scaled(1 + one))).min_normal_ratio, 0.0, 0.2)
    lifts = G * TAN / (0.5 + 0.9 * G * TAN) - 1
    yield (
        "Margins",
        ask("margin", "s.toml"),
        {
            "margins": {
                "of": 4,
                0: {
                    "bands": {"of": 3, 0: {"high": approx(lifts, rel=1e-3)}, 2: {"holds": False}},
                    "leaves_model": approx(flies, rel=1e-3),
                },
                2: {"quantity": "restitution", "ends_up": "block.restitution = 1.0081: out of range"},
            }
        },
    )


def refused(ask):
    """Under the stronger motions the block needs more friction in its impacts than there is; an engine fails anyway."""
    what = written(scene(motion=pulse(1.0, 8.0), block="restitution = 0.5\n", friction=0.3))
    with pytest.raises(SceneError) as error:
        under(what, read_record("records/quake.csv", channel=2))
    text = f"it cannot run this scene: {error.value}"
    failed = {"outcome": "failed", "failure": text, "tilt": None, "slip": None, "reached": [], "changes": {}}
    yield "Margins", ask("margin", "s.toml", "--records", "records"), {"motions": {"of": 3, 2: failed}}
    blown = {"outcome": "failed", "failure": "it blew up: 12 J at .5 s"}
    written(KINDS["rocks"][0])
    document = ask("run", "s.toml", "--engine", "fails", "--records", "records")
    yield "Run", document, {"engine": "fails", "motions": [blown] * 3}


def borne(ask):
    """On bearings whose ka must stay above kb."""
    what = written(YIELDS)
    rows = motions(what, "one-sine pulse, 3.5 m/s2, 9 rad/s", "overturns", "stands", "stands")
    states = (["lifts", "tilt", "stroke", "overturns"], [], ["stroke"])
    yield (
        "Margins",
        ask("margin", "s.toml", "--records", "records"),
        {
            "outcome": "overturns",
            "reached": states[0],
            "margins": {"of": 8, 5: {"quantity": "ka", "ends_down": "bearings.ka = 4950: not above kb = 5000 N/m"}},
            "warnings": rows[0]["warnings"],
            "motions": [{**row, "reached": own} for row, own in zip(rows, states, strict=True)],
        },
    )


def designed(ask):
    """The algebraic law with its equations at the design displacement."""
    period, damping, far, mass = 2.0, 0.15, 0.2, 3000.0
    secant = mass * (2 * math.pi / period) ** 2 / 4
    bearings = design_bearings(mass, period, damping, far)
    yield (
        "Design",
        ask("design", "--period", period, "--damping", damping, "--xmax", far, "--mass", mass),
        {
            "schema": "rocking design 1",
            "bearings": {**bearings.model_dump(), "law": "algebraic", "count": 4, "ka": 10 * bearings.kb, "x_max": far},
            "properties": {
                "period": period,
                "period_kb": 2 * math.pi * math.sqrt(mass / (4 * bearings.kb)),
                "damping_paper": 2 * damping,
                "damping_equivalent": damping,
                "secant_stiffness": secant,
                "force": secant * far,
                "cycle_loss": 2 * math.pi * damping * secant * far**2,
            },
        },
    )


def searched(ask):
    """Bearings of each period and damping, run here one by one: those hold on which the block does not slide, does not
    tilt by more than asked, and its base stays within the stroke."""
    what = written("friction = 0.3\n" + KINDS["quiet on bearings"][0])
    free = what.with_(friction=None)  # the demand is that of a block that does not slide
    told = [what.motion, *(read_record("records/quake.csv", channel=number) for number in (1, 2))]
    periods, dampings = np.geomspace(0.3, 5.0, 9), np.arange(0.02, 0.25, 0.05)
    holds, strokes = np.zeros((5, 9), bool), np.full((5, 9), np.inf)
    for place in np.ndindex(5, 9):
        bearings = design_bearings(600.0, periods[place[1]], dampings[place[0]], 0.3)
        runs = [simulate(what.with_(bearings=bearings, motion=motion), history=False) for motion in told]
        stroke, tilt = (
            max(getattr(run, name) for run in runs) for name in ("peak_base_displacement", "peak_tilt_ratio")
        )
        holds[place] = stroke <= 0.3 and tilt <= 0.4 and not any(run.sliding and run.sliding.path for run in runs)
        strokes[place] = stroke if holds[place] else np.inf
    at, to = np.unravel_index(strokes.argmin(), strokes.shape)
    exact = design_bearings(600.0, periods[to], dampings[at], 0.3)
    rounded = {name: float(f"{getattr(exact, name):.6g}") for name in ("ka", "kb", "alpha")}
    on = what.with_(bearings={**exact.model_dump(), **rounded})
    rows = motions(on, "one-sine pulse, 0.1 m/s2, 6 rad/s", "stands", "stands", "rocks")
    demand = simulate(free.with_(bearings=on.bearings, motion=told[2]), history=False).friction_demand
    words = ["design", "s.toml", "--stroke", 0.3]
    yield (
        "BearingSearch",
        ask(*words, "--tilt", 0.4, "--records", "records"),
        {
            "schema": "rocking bearings 2",
            "scene": "s",
            "base_mass": 200.0,
            "stroke": 0.3,
            "tilt": 0.4,
            "motions": [{name: row[name] for name in ("record", "motion", "peak", "warnings")} for row in rows],
            "left_out": LEFT_OUT,
            "periods": periods.tolist(),
            "dampings": dampings.tolist(),
            "holds": holds.tolist(),
            "chosen": {
                "least-stroke": {
                    "period": periods[to],
                    "damping": dampings[at],
                    "bearings": {**rounded, "law": "algebraic", "count": 4, "x_max": 0.3},
                    "stroke": rows[2]["stroke"],
                    "lifts": 1,
                    "uplift": approx(demand / TAN, rel=1e-5),
                    "tilt": rows[2]["tilt"],
                    "slides": 0,
                    "friction": approx(demand / 0.3, rel=1e-5),
                    "worst": CHANNELS[2],
                    "motions": rows,
                    "headline": f"{ODD} The block lifts {ONCE}, and overturns {NEVER}. {COUNTED}",
                },
                "softest": {"period": 5.0},
            },
        },
    )
    written(scene(LINEAR, pulse(0.1), more=start(0.26)))
    yield "BearingSearch", ask(*words), {"warnings": [PAST], "chosen": {}}


def chosen(ask):
    """An engine whose error is its step is accurate enough at the finest; one that errs by 2 % never is."""
    what, kept = written(KINDS["rocks"][0]), 1 - 1.5 * math.sin(GAMMA) ** 2
    factors = [1.0, 0.95, 0.975, 1.025, 1.05]
    times = [until(what.with_(motion=what.motion.scaled(factor)), "restitution") for factor in factors]
    best = {
        "engine": "coarse",
        "variant": "lies",
        "parameter": "step",
        "value": 0.001,
        "default": True,
        "runs": 5,
        "error": 0.001 * kept,
        "cpu_per_second": 5 * 0.01 / sum(times),
        "passes": True,
        "untried": False,
        "why": None,
    }
    poor = {
        **best,
        "value": 0.01,
        "default": False,
        "runs": 1,
        "error": 0.01 * kept,
        "passes": False,
        "why": "error 9.1e-03",
    }
    poor["cpu_per_second"] = 0.01 / times[0]
    snippet = (
        "from analytic import load_scene\nfrom engines import get_engine\n\n"
        'response = get_engine("coarse").simulate(load_scene("s.toml"), variant="lies")\n'
        "print(response.outcome_text, response.peak_tilt_ratio, response.peak_base_displacement)\n"
    )
    yield (
        "Choice",
        ask("choose", "s.toml", "--error", 0.003),
        {
            "schema": "rocking choose 4",
            "scene": "s",
            "criterion": "restitution",
            "error": 0.003,
            "safety_factor": 2.0,
            "neighbours": factors,
            "left_out": {},
            "until": times[0],
            "chosen": best,
            "best": None,
            "cpu_seconds": 0.01,
            "analytic_cpu_seconds": 0.003,
            "command": "rocking run s.toml --engine coarse --variant lies",
            "snippet": snippet,
            "variants": {
                "of": 6,
                0: {
                    "engine": "coarse",
                    "variant": "lies",
                    "tier": "tuned",
                    "applies_impact": False,
                    "order": 1.0,
                    "levels": {"of": 3, 0: poor, 2: best},
                },
                1: {"levels": {"of": 3, 1: {"untried": True, "why": "passes the scene; neighbours not run"}}},
            },
            "parts": {
                "of": 4,
                0: {"part": "rocking", "needed": True, "why": "the block lifts in 5 of 5 scenes"},
                1: {"part": "base", "needed": False, "cost": 5.0},
            },
            "missing": MISSING,
        },
    )
    worse = {"engine": "restitution", "error": 0.02 * kept}
    document = ask("choose", "s.toml", "--engine", "restitution")
    yield "Choice", document, {"chosen": None, "best": worse, "cpu_seconds": None, "command": None, "snippet": None}
    written(KINDS["a copy is refused"][0])
    refusal = "below 0.1884, where an impact of a block released by hand depends on the law of friction in it"
    document = ask("choose", "s.toml", "--engine", "honest")
    yield "Choice", document, {"criterion": "tilt", "left_out": {"0.95": refusal}, "warnings": [PAST]}


def reported(ask):
    """Two scenes in the model, in an engine that lies by known factors, and in one that fails."""
    bears, falls = written(BEARS, "bears"), written(FALLS, "falls")
    one, other = (simulate(what, history=False) for what in (bears, falls))
    words = ["--records", "records", "--engine", "off", "--engine", "fails", "--output", "page"]
    late = {"quantity": "overturning_time", "here": other.overturning_time + LATER, "model": other.overturning_time}
    yield (
        "Report",
        ask("report", "bears.toml", "falls.toml", *words),
        {
            "schema": "rocking report 5",
            "page": str(Path("page", "report.html")),
            "results": [str(Path("page", f"{name}.json")) for name in ("scenes", "restitution")],
            "missing": MISSING,
            "rows": [
                {
                    "scene": "bears",
                    "engine": "analytic",
                    "variant": "kernel",
                    "outcome": "rocks",
                    "decided": True,
                    "peak_tilt_ratio": one.peak_tilt_ratio,
                    "peak_base_displacement": one.peak_base_displacement,
                    "impact_count": one.impact_count,
                    "same_outcome": None,
                    "warnings": [beyond(one.peak_base_displacement)],
                    "comparable": "no",
                },
                {
                    "engine": "off",
                    "variant": "lies",
                    "same_outcome": True,
                    "overturning_time_error": None,
                    "peak_tilt_error": 0.05 * one.peak_tilt_ratio,
                    "peak_displacement_error": 0.07,
                    "impact_time_error": LATE,
                    "cpu_seconds": 0.01,
                    "comparable": "yes",
                },
                {"outcome": "failed", "decided": False, "failure": "it blew up", "comparable": "no"},
                {"scene": "falls", "engine": "analytic", "outcome": "overturns"},
                {
                    "engine": "off",
                    "overturning_time_error": LATER,
                    "peak_displacement_error": None,
                    "differences": [late],
                },
                {"scene": "falls", "engine": "fails", "failure": "it blew up"},
            ],
            "motions": {
                "bears": {"of": 3},
                "falls": motions(falls, "one-sine pulse, 4 m/s2, 6 rad/s", "overturns", "rocks", "rocks"),
            },
            "left_out": {"bears": LEFT_OUT, "falls": LEFT_OUT},
            "headlines": {
                "bears": "Warning: the base exceeds x_max under 2 of 2 motions. "
                f"{ODD} Warning: the outcome is sensitive to small changes under 1 of 2 motions. "
                f"The block lifts {ONCE}, and overturns {NEVER}. {COUNTED}",
                "falls": f"{ODD} The block lifts under 2 of 2 motions (34 to 100 % at 95 %), and overturns {ONCE}. {COUNTED}",
            },
        },
    )


def verified(ask):
    """Made-up rows of the tolerance table: one is measured, of the other the run fails."""

    def fails(*_):
        raise Unmeasurable("the run failed")

    row = tolerances.Tolerance("impact times", lambda *_: 3e-4, "honest", "lies", "pulses", 2e-4, "s", 1e-4, "steps")
    known = {
        "quantity": "impact times",
        "engine": "honest",
        "variant": "lies",
        "scenes": "pulses",
        "bound": 2e-4,
        "unit": "s",
        "measured": 1e-4,
        "source": "steps",
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tolerances, "rows", lambda *_: (row, replace(row, measure=fails)))
        yield (
            "Verification",
            ask("verify", "--engine", "honest"),
            {
                "schema": "rocking verify 3",
                "versions": {"honest": {"lying-engine": "0.1"}},
                "rows": [
                    {**known, "found": 3e-4, "holds": False, "failure": None},
                    {**known, "found": None, "failure": "the run failed"},
                ],
            },
        )


def told(ask):
    """A record, a new scene and the sheet: what went in, and the geometry and the equations that follow from it."""
    channel = {
        "units": "gal",
        "units_from": "the titles",
        "dt": 0.02,
        "samples": 100,
        "duration": 1.98,
        "peak_time": PEAK_TIME,
        "note": "offset subtracted",
        "warnings": [CUT],
    }
    axes = [("1", "N-S", 3.0), ("2", "E-W", 6.0), ("3", "U-D", 9.0)]
    yield (
        "Record",
        ask("record", "records/quake.csv"),
        {
            "schema": "rocking record 1",
            "file": "quake.csv",
            "format": "K-NET CSV",
            "channels": [{"channel": one, "direction": way, "peak": peak, **channel} for one, way, peak in axes],
        },
    )
    wide, mass = math.atan2(0.55, 1.9), 1500.0
    radius = math.hypot(1.9, 0.55) / 2
    size = {"height": 1.9, "width": 0.55, "mass": mass, "base-mass": 400, "period": 2.5, "xmax": 0.2, "damping": 0.12}
    options = [word for name, value in size.items() for word in (f"--{name}", value)]
    yield (
        "New",
        ask("new", "new.toml", "--name", "bust", *options),
        {
            "schema": "rocking new 1",
            "file": "new.toml",
            "scene": "bust",
            "derived": {
                "of": 12,
                0: {"name": "slenderness", "value": approx(wide, rel=1e-5), "unit": "rad", "asked": None},
                1: {"value": approx(radius, rel=1e-5), "unit": "m"},
                3: {"value": approx(mass * radius**2 * 4 / 3, rel=1e-5), "unit": "kg m2"},
                7: {"name": "secant period at x_max", "value": approx(2.5, rel=1e-4), "unit": "s", "asked": 2.5},
                8: {"name": "equivalent damping at x_max", "value": approx(0.12, rel=1e-4), "unit": "-", "asked": 0.12},
            },
        },
    )
    rate = math.sqrt(1.5 * G / 1.2 * (math.cos(GAMMA - 0.2) - math.cos(GAMMA)))
    after = {"quantity": "rate_after_1", "unit": "rad/s", "answer": -rate * (1 - 1.5 * math.sin(GAMMA) ** 2)}
    document = ask("sheet")
    yield (
        "Sheet",
        document,
        {
            "schema": "rocking sheet 2",
            "sheet": 1,
            "files": lambda files: (
                sorted(files) == sorted(str(one) for one in Path("sheet").rglob("*") if one.is_file())
            ),
            "problems": {
                "of": 8,
                0: {
                    "scene": "free-rigid",
                    "title": "Free rocking on rigid ground",
                    "quantities": {
                        "of": 16,
                        0: {"quantity": "outcome", "unit": "a word", "answer": "rocks", "tolerance": None},
                        3: {
                            **after,
                            "meaning": "φ′ just after impact 1",
                            "tolerance": 1e-3 * GAMMA * math.sqrt(0.75 * G / 1.2),
                        },
                    },
                },
            },
        },
    )


def _swings(request):
    """Plan of a made-up study of 70 runs."""
    runs = yield Batch(fake_solvers.cases(count=70), fake_solvers.tilt, "swings")
    rows = [{"part": "swing", "tilt": run.values["peak"]} for run in runs]
    return Computed({"quick": request.quick}, rows, {"tilts": np.array([row["tilt"] for row in rows])}, seed=3)


def _other(case, response):
    """A measure that differs in the first half of the runs of the study."""
    found = TILT(case, response)
    return {**found, "peak": found["peak"] + (case.tag["i"] < 35)}


def _packages(found):
    """Whether these are the versions of what is always installed, beside those of the engines."""
    usual = ("numpy", "scipy", "numba", "exudyn")
    return found.keys() == {*usual, *PACKAGES} and all(found[name] == version(name) for name in usual)


def _processor():
    """Its name, as the system has it."""
    told = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    named = [line.partition(":")[2].strip() for line in told if line.startswith("model name")]
    return named[0] if named else platform.processor() or platform.machine()


def studied(ask):
    """A study of made-up runs; a check finds half of them changed."""
    began = datetime.now(UTC).replace(microsecond=0)
    (path,) = compute(Study("made", "How far?", _swings), "studies", engines=(), workers=1, progress=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fake_solvers, "tilt", _other)
        check(path, 60, 11, record=True, workers=1, progress=False)
    document = json.loads((path / "analytic.json").read_text())
    content = json.dumps(
        {name: one for name, one in document.items() if name != "digest"}, sort_keys=True, separators=(",", ":")
    )
    arrays = (path / "analytic.npz").read_bytes()
    stored = json.loads(np.load(io.BytesIO(arrays))["runs.json"].tobytes())
    git = [
        subprocess.run(["git", *words], capture_output=True, text=True, cwd=Path(__file__).parent).stdout.strip()
        for words in (["rev-parse", "HEAD"], ["status", "--porcelain", "-uno"])
    ]
    checkout = {"commit": git[0], "dirty": bool(git[1])}
    times = [(began + timedelta(seconds=one)).isoformat() for one in range(100)]
    yield (
        "StudyResult",
        document,
        {
            "schema": "rocking study 3",
            "digest": hashlib.sha256(content.encode()).hexdigest(),
            "kind": "made",
            "provenance": {
                "time": times.__contains__,
                "machine": {
                    "processor": _processor(),
                    "cores": 3,
                    "logical_cores": 6,
                    "memory_gib": approx(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30, abs=0.06),
                    "system": f"{os.uname().sysname} {os.uname().machine}",
                },
                "packages": _packages,
                "python": sys.version.split()[0],
                "sources": {
                    one: one[::-1] for one in (f"{__name__}:_swings", "analytic:simulate", "fake_solvers:sound")
                },
                "seed": 3,
                "check": {
                    "date": {one[:10] for one in times}.__contains__,
                    **checkout,
                    "seed": 11,
                    "runs": 60,
                    "held": sum(run["tag"]["i"] >= 35 for run in stored),
                },
                **checkout,
            },
            "settings": {"quick": False, "changed_while_running": []},
            "arrays": {"file": "analytic.npz", "digest": hashlib.sha256(arrays).hexdigest()},
            "runs": {"stored": 60, "total": 70},
            "rows": [{"part": "swing", "tilt": (0.01 * number) ** 2} for number in range(70)],
        },
    )


DOCUMENTS = (
    standing,
    released,
    yielding,
    sliding,
    falling,
    compared,
    changed,
    refused,
    borne,
    designed,
    searched,
    chosen,
    reported,
    verified,
    told,
    studied,
)


@pytest.fixture(scope="module")
def known(ask):
    """[((class, field), value in a document, value known)] of all documents."""
    documents = [document for made in DOCUMENTS for document in made(ask)]
    return [leaf for form, found, wanted in documents for leaf in leaves(FORM[form], found, wanted)]


def test_values_are_the_known_ones(known):
    assert [leaf for leaf in known if not agrees(*leaf[1:])] == []


def test_a_wrong_value_is_seen(known):
    assert [leaf for leaf in known if leaf[1] not in EMPTY and agrees(wrong(leaf[1]), leaf[2])] == []


def test_each_field_of_each_form_is_looked_at(known):
    seen: set = set()
    fields = set().union(*(fields_of(form, seen) for form in FORMS))
    assert fields - {pair for pair, found, _ in known if found not in EMPTY} == NULL
