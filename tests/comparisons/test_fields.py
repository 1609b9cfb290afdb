"""Each field of what the commands write as JSON: a wrong value in it is seen here.

A document is made by its command. What is known of it comes from elsewhere: the scene, a closed form, the attributes of
what Python returns, the factor of a lie, a digest or a count made here. The fields are those of the schemas, so that
one which no document shows is named.
"""

import hashlib
import json
import math
import platform
import re
import subprocess
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import fake_solvers
import lying_engine
import numpy as np
import pytest
from answered import Here
from fake_study import MADE, STARTS
from lying_engine import Liar, liars, noise
from made_up_records import knet_csv
from pytest import approx
from roads import BASE, BEARINGS, KINDS, LINEAR, TALL, G, pulse, scene, start
from scipy.optimize import brentq
from scipy.stats import norm
from scipy.stats import t as student

from analytic import Caution, SceneError, load_scene, read_record, simulate
from analytic.advice import margins
from analytic.advice.bearing_scan import scan_bearings
from analytic.advice.pedestal import check_pedestal
from analytic.rocking import design_bearings
from comparisons import cli
from comparisons.advice import criteria
from comparisons.execution import runner
from comparisons.execution import runner as check
from comparisons.metrics import agreement
from comparisons.metrics import agreement as tolerances
from comparisons.metrics import errors as horizon
from comparisons.schemas.__main__ import schemas
from engines import ENGINES
from engines.comparison import near_copies
from engines.contract import Engine

pytestmark = pytest.mark.xdist_group("fields")  # the documents are made once
FORMS = {schema["title"]: schema for schema in schemas().values()}
PARTS = {name: part for form in FORMS.values() for name, part in (FORMS | form.get("$defs", {})).items()}
PACKAGES = {"numpy", "scipy", "numba", *(engine.package for engine in ENGINES.values())}

TAN, KEPT = math.tan(0.25), 1 - 1.5 * math.sin(0.25) ** 2  # of the slenderness of the scenes; restitution, eq. (7)
SCENES = {
    "stands.toml": scene(motion=pulse(1.0, vertical=4.0)),
    "released.toml": scene(more=start(0.15) + "[run]\nduration = 12.0\n"),
    "yields.toml": scene(
        BASE + BEARINGS.format(law="bouc-wen", ka=5500.0) + "kb = 5e3\nalpha = 40.0\ndamping = 50.0\nx_max = 0.02\n",
        pulse(3.5, 9.0),
        more="[run]\nduration = 1.7\n",
    ),
    "slides.toml": KINDS["slides"][0],
    "creeps.toml": scene(motion=pulse(1.6, 30.0), friction=0.15),
    "rocks.toml": KINDS["rocks"][0],
    "tall.toml": KINDS["pedestal that may lift"][0],
    "free.toml": scene(TALL.replace("0.5", "0.6") + "free = true\n", pulse(3.6, 8.0)),
    "falls.toml": KINDS["overturns after an impact"][0],
    "flies.toml": scene(motion=pulse(0.5, 9.0, vertical=18 * 0.981)),
    "refused.toml": scene(motion=pulse(1.0, 8.0), block="restitution = 0.5\n", friction=0.3),
    "quiet.toml": "friction = 0.3\n" + KINDS["quiet on bearings"][0],
    "past.toml": scene(LINEAR, pulse(0.1), more=start(0.26)),
    "near.toml": KINDS["a copy is refused"][0],
    "rough.toml": KINDS["free-standing it is refused"][0],
    "bears.toml": scene(LINEAR + "x_max = 0.02\n", pulse(4.0, 9.0)),
}
MANY = ("--records", "records")  # of which one is there: two horizontal components and a vertical one, cut off
CUT = "quake.csv: the header states 4 s, the data have 2 s: check that the file is whole"
CHANNELS = [f"quake.csv, channel {number} (offset subtracted)" for number in ("1 (N-S)", "2 (E-W)", "3 (U-D)")]
LEFT_OUT = [
    f"{CHANNELS[2]}: left out, a vertical motion; a scene whose [motion] names it as vertical beside its record runs it"
]
COUNTED = "Components, directions and signs count as one motion. Left out of the folder: 1 file or channel."
NEVER, ONCE = "under 0 of 2 motions (0 to 66 % at 95 %)", "under 1 of 2 motions (9.5 to 91 % at 95 %)"  # Wilson's
ODD = "Warning: the record is unusual under 1 of 2 motions."
PAST = "The block starts at a tilt of 0.26 rad, past its balance at 0.25 rad: it falls unless something brings it back."
BEYOND = (
    "the base moves by 0.108 m, beyond the x_max = 0.02 m of its bearings: they may tear or hit a stop, and the "
    "outcome is outside the model"
)
REFUSED = (
    r"it cannot run this scene: refused: block\.restitution = 0\.5: needs, at the impact at 0\.\d+ s, a friction of "
    r"1\.\d+ \(it is 0\.3\); leave it out, or give a friction of 1\.\d+ or more"
)
MISSING = {"absent": "engine 'absent' needs the package no_such_package: buy it"}
SPENT = approx(0.05, abs=0.04999)  # s, of a run of the model
LATE, LATER = 0.002, 0.25  # s, of impacts and of overturning in a lie


def leaves(part, result, wanted, field=None):
    """((part, field), value in the document, value known) of what is known of `result`, which is, or holds, a part.

    wanted : dict, or object with attributes, of some of the fields; of a list also {"of": its length, index: entry}.
    """
    if part is None or result is None or wanted is None:
        yield field, result, wanted
    elif isinstance(result, list):
        known = wanted if isinstance(wanted, dict) else {"of": len(wanted), **dict(enumerate(wanted))}
        yield field, [0] * len(result), [0] * known["of"]
        for at, element in enumerate(result):
            yield from leaves(part, element, known.get(at, {}), field)
    elif result.keys() == PARTS[part]["properties"].keys():
        yield field, [part], [part]
        for name, kind in PARTS[part]["properties"].items():
            inner = re.search(r"#/\$defs/(\w+)", json.dumps(kind))
            inner_wanted = wanted.get(name, ...) if isinstance(wanted, dict) else getattr(wanted, name, ...)
            if inner_wanted is not ...:
                yield from leaves(inner and inner[1], result[name], inner_wanted, (part, name))
    else:
        yield field, sorted(result), sorted(wanted)
        for name, element in result.items():
            yield from leaves(part, element, wanted.get(name), field)


def agrees(result, wanted):
    """Whether a value of a document is the one known: numbers within rounding; a function tells of what it is given."""
    if callable(wanted):
        return wanted(result)
    if isinstance(wanted, dict):
        return result.keys() == wanted.keys() and all(agrees(result[name], wanted[name]) for name in wanted)
    if isinstance(wanted, list | tuple) and isinstance(result, list):
        return len(result) == len(wanted) and all(map(agrees, result, wanted))
    return result == (approx(wanted) if isinstance(wanted, float) else wanted)


WRONG = {
    bool: lambda value: not value,
    int: lambda value: 2 * value + 1,
    float: lambda value: 1.5 * value + 1,
    str: lambda value: value + "x",
    list: lambda value: value[:-1],
    dict: lambda value: dict([*value.items()][:-1]),
}


# What takes the place of what runs elsewhere, of what the code is and of what the machine has; and coarser scans.
REPLACED = {
    "engines.guard.run_apart": lambda function, *arguments, **_: (function(*arguments), None),
    "comparisons.execution.runner.Processes": lambda *_: Here(),
    "comparisons.execution.runner.source_digests": lambda *_: {},
    "comparisons.execution.cases.source_digests": lambda *_: {},
    "comparisons.execution.runner.digests_of_all": lambda *_: {},
    "comparisons.execution.results.kept_digests": lambda *_: {},
    "comparisons.execution.by_solver.kept_digests": lambda roots: {root: root[::-1] for root in roots},
    "comparisons.execution.cases.version_of": lambda _: "1",
    "comparisons.execution.runner.SIZE": 1,
    "comparisons.report.write.write_page": lambda folder, *_: Path(folder) / "report.html",
    "comparisons.report.statue.STEP": 0.1,
    "comparisons.report.statue.PLATE_STEP": 0.2,
    "comparisons.commands.advice.STEPS": 20,
    "analytic.advice.margins.STEP": 0.0125,
    "analytic.advice.bearing_scan.PERIOD_STEP": 0.4,
    "analytic.advice.bearing_scan.DAMPING_STEP": 0.05,
    "psutil.virtual_memory": lambda: type("Memory", (), {"total": 48 * 2**30}),
    "psutil.cpu_count": lambda logical=True: 6 if logical else 3,
}
LIARS = ("coarse", "off", "loss", "restitution", "honest", "fails")


def off(scene, run):
    """Peaks too large, impacts and the end too late."""
    late = tuple(replace(impact, time=impact.time + LATE) for impact in run.impacts)
    peaks = {"peak_tilt": 1.05, "peak_tilt_ratio": 1.05, "peak_base_displacement": 1.07}
    known = {name: factor * getattr(run, name) for name, factor in peaks.items()}
    return replace(run, impacts=late, overturning_time=run.overturning_time and run.overturning_time + LATER, **known)


# Lies of which the errors are known: the first errs by its step.
OWN = {"coarse": lambda scene, run: lying_engine._rates(1 - run.settings["step"])(scene, run), "off": off}


@pytest.fixture(scope="module")
def ask(tmp_path_factory):
    """Runs a command in a folder of its own and reads its JSON; engines that lie take the place of all others."""
    folder, known = tmp_path_factory.mktemp("fields"), dict(ENGINES)
    (folder / "records").mkdir()
    for name, text in {**SCENES, "records/quake.csv": knet_csv(300 * noise(100, 1), seconds=4)}.items():
        (folder / name).write_text(text)

    def call(*words):
        with pytest.raises(SystemExit):
            cli.main([*map(str, words), "--json", "out.json"])
        return json.loads(Path("out.json").read_text())

    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for target, value in REPLACED.items():
            patch.setattr(target, value)
        for module in (import_module("comparisons.advice.choose"), criteria):  # the package has a function so called
            patch.setattr(module, "cpu_seconds", lambda scene: 0.003 if scene.base is None else 0.015)
            patch.setattr(module, "Processes", lambda *_: Here(), raising=False)
        patch.setattr(lying_engine, "LIES", {**OWN, **lying_engine.LIES})
        levels = {"lies": replace(lying_engine.VARIANTS["lies"], levels=(1e-2, 3e-3, 1e-3))}
        patch.setattr(lying_engine, "VARIANTS", levels)
        absent = Engine("absent", "no_such_package", "buy it", "black", "o", adapter="")
        ENGINES.clear()
        ENGINES.update({name: liar for name, liar in liars().items() if name in LIARS}, absent=Liar.of(absent))
        yield call
        ENGINES.clear()
        ENGINES.update(known)


def model(name, **more):
    """(a scene, its run in the model)."""
    what = load_scene(f"{name}.toml").with_(**more)
    return what, simulate(what, history=False)


def under(what, label):
    """What is known of a scene under its own motion, called so, and the two of the record."""
    peaks = {label: float(label.split()[2]), CHANNELS[0]: 3.0, CHANNELS[1]: 6.0}
    for at, (name, peak) in enumerate(peaks.items()):
        motion = read_record("records/quake.csv", channel=at) if at else what.motion
        run = simulate(what.with_(motion=motion, duration=None), history=False)
        yield {
            "record": "quake.csv" if at else "the scene's own motion",
            "motion": name,
            "peak": peak,
            "warnings": [Caution("record", CUT)] * bool(at)
            + [warning for warning in run.warnings if warning.kind != "record"],
            "outcome": run.outcome,
            "failure": None,
            "tilt": run.peak_tilt_ratio,
            "stroke": run.peak_base_displacement if what.base else None,
            "slip": run.sliding and run.sliding.peak,
        }


# What is known of documents: each yields (name of the form, document, what is known of it).


def runs(ask):
    """What Python returns; and contact forces, Housner's block and Coulomb's in closed form."""
    documents = {
        name: ask("run", f"{name}.toml", *MANY) for name in ("stands", "released", "yields", "slides", "falls")
    }
    for name, document in documents.items():
        yield "Run", document, replace(model(name)[1], cpu_seconds=SPENT)
    yield (
        "Run",
        documents["stands"],
        {
            "schema": "rocking run 5",
            "engine": "analytic",
            "variant": "kernel",
            "scene": "stands",
            "outcome": "stands",
            "decided": True,
            "peak_base_acceleration": 1.0,
            "friction_demand": approx(1.0 / (G - 4.0), rel=1e-3),
            "min_normal_ratio": approx(1 - 4.0 / G, rel=1e-3),
            "settings": {"tolerance": 1e-11, "rest_rate": 1e-8, "order": 18, "short_order": 8},
            "versions": {name: version(name) for name in ("numpy", "numba")},
            "comparable": "no",
        },
    )
    height = math.cos(0.1) - math.cos(0.25)  # by which the block falls, over R
    rate = math.sqrt(1.5 * G * height)
    yield (
        "Run",
        documents["released"],
        {
            "outcome": "rocks",
            "peak_tilt": 0.15,
            "peak_tilt_ratio": 0.6,
            "impacts": {"of": model("released")[1].impact_count, 0: {"rate_before": -rate, "rate_after": -KEPT * rate}},
            "energy": {"kinetic": 0.0, "potential": -400.0 * G * height, "impact_loss": 400.0 * G * height},
        },
    )
    yield (
        "Run",
        documents["yields"],
        {
            "decided": False,
            "warnings": {"of": 1, 0: {"kind": "limit", "text": BEYOND}},
            "motions": [*under(model("yields")[0], "one-sine pulse, 3.5 m/s2, 9 rad/s")],
            "left_out": LEFT_OUT,
            "headline": "Warning: the base exceeds x_max under 2 of 2 motions. "
            f"{ODD} The block lifts {ONCE}, and overturns {ONCE}. {COUNTED}",
        },
    )
    yield (
        "Run",
        documents["slides"],
        {
            "energy": {"friction": 0.15 * 400.0 * G * documents["slides"]["sliding"]["path"]},
            "motions": [*under(model("slides")[0], "one-sine pulse, 3 m/s2, 6 rad/s")],
        },
    )
    known = {"outcome": "overturns", "peak_tilt": math.pi / 2, "uplifts": [math.asin(G * TAN / 4.0) / 6.0]}
    yield "Run", documents["falls"], known
    yield "Run", ask("run", "tall.toml"), {"outcome": "rocks", "pedestal": tall()}
    stack = {"rocked": ["pedestal", "statue"]}
    free = ask("run", "free.toml")
    yield "Run", free, {"variant": "stack", "outcome": "overturns", "stack": stack}
    yield "Run", free, {"stack": model("free")[1].stack, "impacts": model("free")[1].impacts}
    blown = {"outcome": "failed", "failure": "it blew up: 12 J at .5 s"}
    yield "Run", ask("run", "rocks.toml", "--engine", "fails", *MANY), {"motions": [blown] * 3}


def tall():
    """The check of a pedestal .5 m wide and 1 m high under the block that rocks; most of it in closed form."""
    e, b, h = 1 - 1.5 * math.sin(0.25) ** 2, math.sin(0.25), math.cos(0.25)
    landing = (b + h * (1 - e) / (b * (1 + e))) / 0.25
    share = check_pedestal(model("tall")[0]).share
    width = math.ceil(50 * max(share, landing)) / 100
    most = f"centre of pressure under it up to {max(share, landing):.3g} half widths from its middle"
    return {
        "share": share,
        "landing": landing,
        "uplift": G * 0.25 * 700 / (150 + 400 * (1 + h)),
        "width": width,
        "text": f"The pedestal may lift: outside this model; fix it, or widen it to {width:g} m ({most}).",
    }


def compared(ask):
    """Lies by known factors, and an engine that fails."""
    what, run = model("rocks")
    yield "Comparison", ask("compare", "tall.toml", "--engine", "honest"), {"scene": "tall", "pedestal": tall()}
    ends = [horizon.sensitivity_horizon(what, perturbation=size).horizon for size in (0.004, 0.02)]
    peaks = [simulate(copy, history=False).peak_tilt for copy in near_copies(what)] + [run.peak_tilt]
    engines = [word for name in ("loss", "restitution", "off", "fails") for word in ("--engine", name)]
    yield (
        "Comparison",
        ask("compare", "rocks.toml", *engines),
        {
            "schema": "rocking compare 5",
            "scene": "rocks",
            "sensitivity_horizon": min(ends),
            "sensitivity": {
                "loss": {"perturbation": 0.004, "horizon": ends[0]},
                "restitution": {"perturbation": 0.02, "horizon": ends[1]},
                "off": {},
            },
            "responses": [
                {"engine": "analytic"},
                {"engine": "loss", "variant": "lies", "comparable": "yes", "differences": []},
                {
                    "engine": "restitution",
                    "settings": {"step": 0.001},
                    "versions": {"lying-engine": "0.1"},
                    "cpu_seconds": 0.01,
                    "differences": [{"quantity": "restitution", "here": 0.98 * KEPT, "model": KEPT, "limit": 0.01}],
                },
                {
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
                {
                    "outcome": "failed",
                    "failure": {"reason": "it blew up", "message": "12 J at .5 s", "last_state": run.end},
                },
            ],
        },
    )


def changed(ask):
    """What Python returns; and blocks that just slide, at a/g, just lift, and just leave their ground."""
    labels = {
        "creeps": "one-sine pulse, 1.6 m/s2, 30 rad/s",
        "flies": "one-sine pulse, 0.5 m/s2, 9 rad/s, vertical 8.829 m/s2",
        "yields": "one-sine pulse, 3.5 m/s2, 9 rad/s",
    }
    documents = {name: ask("margin", f"{name}.toml", "--tilt", 0.4, *MANY) for name in labels}
    for name, label in labels.items():
        what, run = model(name, duration=None)
        margins_ = margins.margins(what, tilt=0.4, step=0.01)
        known = {
            "margins": margins_,
            "outcome": run.outcome,
            "warnings": run.warnings,
            "motions": [*under(what, label)],
        }
        yield "Margins", documents[name], known
    slower, rougher = approx(0.15 * G / 1.6 - 1, rel=1e-4), approx(1.6 / (0.15 * G) - 1, rel=1e-4)
    changes = {"slides": slower, "lifts": None, "tilt": None, "overturns": None}
    moved = {"reached": ["slides"], "changes": changes, "interleaved": False}
    motion = {
        "quantity": "motion",
        "value": 1.6,
        "unit": "m/s2",
        "bands": [
            {"low": -0.2, "high": slower, "reached": [], "outcome": "stands", "holds": True},
            {"low": slower, "high": 0.2, "reached": ["slides"], "outcome": "slides"},
        ],
        "changes": changes,
        "down": slower,
        "up": None,
        "nearest": slower,
    }
    friction = {"quantity": "friction", "value": 0.15, "unit": "-", "down": None, "up": rougher, "nearest": rougher}
    yield (
        "Margins",
        documents["creeps"],
        {
            "schema": "rocking margin 5",
            "scene": "creeps",
            "outcome": "slides",
            "tilt": 0.4,
            "span": 0.2,
            "reached": ["slides"],
            "margins": {"of": 4, 0: motion, 1: friction},
            "contact": {"least_normal": 1.0, "friction_demand": 0.15, "friction": 0.15, "slides": True},
            "motions": {"of": 3, 0: moved},
            "left_out": LEFT_OUT,
            "headline": f"{ODD} The block lifts {NEVER}, and overturns {NEVER}. {COUNTED}",
        },
    )
    yield "Margins", ask("margin", "tall.toml"), {"outcome": "rocks", "pedestal": tall()}
    light, lifts = model("flies")[0].motion, G * TAN / (0.5 + 0.9 * G * TAN) - 1
    flies = brentq(lambda change: model("flies", motion=light.scaled(1 + change))[1].min_normal_ratio, 0.0, 0.2)
    left = {"leaves_model": approx(flies, rel=1e-3), "down": approx(lifts, rel=1e-3)}
    yield "Margins", documents["flies"], {"margins": {"of": 4, 0: left}}
    failed = {"outcome": "failed", "failure": re.compile(REFUSED).fullmatch, "reached": [], "changes": {}}
    yield "Margins", ask("margin", "refused.toml", *MANY), {"motions": {"of": 3, 2: failed}}


def risked(ask):
    """Friction drawn about the acceleration at which a block slides; draws that are refused; scaled motions."""
    raw = np.random.PCG64([5, 0]).random_raw(200).reshape(40, 5)[:, 2]  # friction is the third quantity
    score = norm.ppf(((raw >> np.uint64(11)) + 0.5) / 2**53)
    drawn = 0.15 * np.exp(math.sqrt(math.log1p(0.15**2)) * score)
    quantile = float(student.ppf(0.975, 39))

    def odds(peak):
        slides = drawn < peak / G
        share, product = slides.mean(), 40 / 39 * score * (slides - slides.mean())
        middle, spread = share + quantile**2 / 80, quantile * math.sqrt(share * (1 - share) / 40 + (quantile / 80) ** 2)
        low, high = (float(middle + side * spread) / (1 + quantile**2 / 40) for side in (-1, 1))
        effect = [float(product.mean()), float(3 * product.std() / math.sqrt(40))]
        known = {"state": "slides", "probability": float(share), "low": approx(max(low, 0.0), abs=1e-12), "high": high}
        none = {"probability": 0.0, "low": 0.0, "high": quantile**2 / (40 + quantile**2)}
        still = {name: [0.0, 0.0] for name in ("slenderness", "friction")}
        return [
            {"state": "overturns", **none, "effects": still},
            {"state": "lifts", **none, "effects": still},
            {**known, "effects": lambda effects: agrees(effects.get("friction"), effect)},
        ]

    share, creeps = float((drawn < 1.6 / G).mean()), load_scene("creeps.toml").with_(duration=None)
    runs_ = [simulate(creeps.with_(friction=friction), history=False) for friction in drawn.tolist()]
    slips = [run.sliding.peak if run.sliding else 0.0 for run in runs_]
    yield (
        "Risk",
        ask("risk", "creeps.toml", "--draws", 40, "--seed", 5, "--spread", "friction=0.15"),
        {
            "schema": "rocking risk 1",
            "scene": "creeps",
            "draws": 40,
            "seed": 5,
            "drawn": {
                "of": 2,
                0: {"quantity": "slenderness", "value": 0.25, "unit": "rad", "spread": 0.03},
                1: {"quantity": "friction", "value": 0.15, "unit": "-", "spread": 0.15, "source": "given"},
            },
            "odds": odds(1.6),
            "travel": {"slip": approx([np.quantile(slips, part) for part in (0.5, 0.95, 1.0)], rel=1e-9)},
            "records": {"the scene's own motion": {"overturns": 0.0, "lifts": 0.0, "slides": share}},
            "failed": 0,
            "why": "",
            "headline": re.compile(
                r"The block overturns in 0 % \(0 to 9\.3 % at 95 %\) of 40 draws of its values under the scene's own "
                rf"motion\. The block lifts in 0 % .* The block slides in {100 * share:.0f} % \([\d.]+ to [\d.]+ % at "
                r"95 %\)\."
            ).fullmatch,
        },
    )
    scales = [0.25, 0.5, 0.75, 1.25, 1.5, 1.75, 2.0]  # with a quarter of the draws
    plotted = ask("risk", "creeps.toml", "--draws", 160, "--seed", 5, "--plot", "odds.svg")
    yield "Risk", plotted, {"intensities": {"1.0": {"of": 3}, **{str(scale): odds(1.6 * scale) for scale in scales}}}
    raw = np.random.PCG64([0, 0]).random_raw(150).reshape(30, 5)[:, 2]
    reasons = []
    for score in norm.ppf(((raw >> np.uint64(11)) + 0.5) / 2**53):
        rough = {"friction": 0.185 * math.exp(math.sqrt(math.log1p(0.3**2)) * score)}
        try:
            simulate(load_scene("rough.toml").with_(**rough, duration=None), history=False)
        except SceneError as error:
            reasons.append(f"friction = {error.value:.5g}: {error.problem}")
    spreads = [word for each in ("slenderness=0", "ka=0", "friction=0.3") for word in ("--spread", each)]
    yield ("Risk", ask("risk", "rough.toml", "--draws", 30, *spreads), {"failed": len(reasons), "why": reasons[0]})
    past = {"of": 1, 0: {"kind": "limit", "text": PAST}}
    yield "Risk", ask("risk", "near.toml", "--draws", 2), {"warnings": past}
    what, peak = load_scene("yields.toml"), 0.1 * G
    document = ask("risk", "yields.toml", *MANY, "--draws", 2, "--pga", 0.1)
    rows = []
    for row, motion in zip(under(what, "one-sine pulse, 3.5 m/s2, 9 rad/s"), motions_of(what), strict=True):
        scaled = motion.scaled(peak / motion.peak)
        run = simulate(what.with_(motion=scaled, duration=None), history=False)
        peaks = {"tilt": run.peak_tilt_ratio, "stroke": run.peak_base_displacement, "slip": None}
        rows.append({**row, **peaks, "motion": scaled.label, "peak": peak, "outcome": run.outcome})
        rows[-1]["warnings"] = [Caution("record", CUT)] * (row["record"] == "quake.csv") + [
            warning for warning in run.warnings if warning.kind != "record"
        ]
    yield (
        "Risk",
        document,
        {
            "pga": 0.1,
            "drawn": {"of": 4, 3: {"quantity": "kb", "source": "as that of ka"}},
            "motions": rows,
            "left_out": LEFT_OUT,
        },
    )
    yield "Risk", ask("risk", "bears.toml", "--motions", 2, "--draws", 2, "--pgv", 0.5), {"pgv": 0.5}


def motions_of(what):
    """The motion of a scene, and the two of the record."""
    return [what.motion, *(read_record("records/quake.csv", channel=at) for at in (1, 2))]


def designed(ask):
    """Constants from Python, and what they give back by the definitions of period and damping."""
    bearings, secant = design_bearings(3000.0, 2.0, 0.15, 0.2), 3000.0 * math.pi**2 / 4
    yield (
        "Design",
        ask("design", "--period", 2, "--damping", 0.15, "--xmax", 0.2, "--mass", 3000),
        {
            "schema": "rocking design 2",
            "bearings": {**bearings.model_dump(), "law": "algebraic", "count": 4, "ka": 10 * bearings.kb, "x_max": 0.2},
            "properties": {
                "period": 2.0,
                "period_kb": math.pi * math.sqrt(3000.0 / bearings.kb),
                "damping_paper": 0.3,
                "damping_equivalent": 0.15,
                "secant_stiffness": secant,
                "force": secant * 0.2,
                "cycle_loss": 2 * math.pi * 0.15 * secant * 0.2**2,
            },
            "sizes": {"kind": "lead-rubber", "overlap": 0.0, "overlap_pressure": None},
        },
    )
    yield (
        "Design",
        ask("design", "--period", 2, "--damping", 0.15, "--xmax", 0.2, "--mass", 3e6),
        {"sizes": sizes_of(3e6, bearings.kb * 1000, 0.2)},
    )
    weight = 3000.0 * G / 4
    yield (
        "Design",
        ask("design", "--pendulum-radius", 7, "--pendulum-friction", 0.05, "--xmax", 0.2, "--mass", 3000),
        {
            "bearings": {
                "law": "bilinear",
                "ka": weight / 7 + 50 * weight,
                "kb": weight / 7,
                "alpha": None,
                "yield_force": (0.05 + 0.001 / 7) * weight,
                "x_max": 0.2,
            },
            "properties": {"period_kb": 2 * math.pi * math.sqrt(7 / G), "cycle_loss": 0.2 * weight * 0.199},
            "sizes": {
                "kind": "pendulum",
                "core": None,
                "radius": 7.0,
                "friction": 0.05,
                "reasons": lambda reasons: len(reasons) == 1 and reasons[0].startswith("radius 7 m, above 6.2 m"),
            },
        },
    )


def sizes_of(mass, kb, x_max):
    """The sizes of four bearings of 2 s and 15 % at x_max by lead of 10 MPa, G of .4 MPa and a shear of 150 %."""
    secant, area = mass * math.pi**2 / 4, kb * x_max / 1.5 / 0.4e6
    radius, pressure = math.sqrt(area / math.pi), mass * G / 4 / area
    half = math.acos(x_max / 2 / radius)  # of the angle of the segments that overlap
    overlap = (2 * half - math.sin(2 * half)) / math.pi
    friction = 0.15 * math.pi / 2 * secant * x_max**2 / (x_max - 0.001) / (mass * G / 4)
    return {
        "kind": "lead-rubber",
        "core": math.sqrt(4 * (secant - kb) * x_max / (math.pi * 10e6)),
        "diameter": 2 * radius,
        "height": x_max / 1.5,
        "overlap": overlap,
        "pressure": pressure,
        "overlap_pressure": pressure / overlap,
        "radius": 1 / (secant / (mass * G / 4) - friction / x_max),
        "friction": friction,
        "reasons": lambda reasons: len(reasons) == 1 and reasons[0].startswith("rubber diameter"),
        "sentences": lambda sentences: len(sentences) == 3 and "No such bearing is made" in sentences[1],
        "assumed": lambda words: "lead yields at 10 MPa" in words and words.endswith("x_max."),
    }


def searched(ask):
    """The scan that Python returns; and runs on the bearings chosen."""
    what = model("quiet")[0]
    motions = [what.motion, *(read_record("records/quake.csv", channel=number) for number in (1, 2))]
    scan = scan_bearings(what, motions, 0.3, tilt=0.4)
    period, damping = scan.least_stroke
    exact = design_bearings(600.0, period, damping, 0.3)
    rounded = {name: float(f"{getattr(exact, name):.6g}") for name in ("ka", "kb", "alpha")}
    on = what.with_(bearings=exact.model_copy(update=rounded))
    rows = [*under(on, "one-sine pulse, 0.1 m/s2, 6 rad/s")]
    demand = simulate(on.with_(friction=None, motion=motions[2]), history=False).friction_demand
    yield (
        "BearingSearch",
        ask("design", "quiet.toml", "--stroke", 0.3, "--tilt", 0.4, *MANY),
        {
            "schema": "rocking bearings 3",
            "scene": "quiet",
            "base_mass": 200.0,
            "stroke": 0.3,
            "tilt": 0.4,
            "motions": [{name: row[name] for name in ("record", "motion", "peak", "warnings")} for row in rows],
            "left_out": LEFT_OUT,
            "periods": np.geomspace(0.3, 5.0, 9).tolist(),
            "dampings": [0.02, 0.07, 0.12, 0.17, 0.22],
            "holds": [[bool(demand <= 1) for demand in row] for row in scan.demand],
            "chosen": {
                "least-stroke": {
                    "period": period,
                    "damping": damping,
                    "bearings": {**rounded, "law": "algebraic", "count": 4, "x_max": 0.3},
                    "sizes": {"kind": "lead-rubber", "height": 0.2},
                    "stroke": rows[2]["stroke"],
                    "lifts": 1,
                    "uplift": approx(demand / TAN),
                    "tilt": rows[2]["tilt"],
                    "slides": 0,
                    "friction": approx(demand / 0.3),
                    "worst": CHANNELS[1],
                    "motions": rows,
                    "headline": f"{ODD} The block lifts {ONCE}, and overturns {NEVER}. {COUNTED}",
                },
                "softest": {"period": 5.0},
            },
        },
    )
    past = {"kind": "limit", "text": PAST, "quantity": "start.tilt", "value": 0.26, "limit": 0.25}
    yield "BearingSearch", ask("design", "past.toml", "--stroke", 0.3), {"warnings": [past], "chosen": {}}


def chosen(ask):
    """An engine whose error is its step is accurate enough at the finest; one that errs by 2 % never is."""
    what = model("rocks")[0]
    factors = [1.0, 0.95, 0.975, 1.025, 1.05]
    times = [criteria.until(what.with_(motion=what.motion.scaled(factor)), "restitution") for factor in factors]
    best = {
        "engine": "coarse",
        "variant": "lies",
        "parameter": "step",
        "value": 0.001,
        "default": True,
        "runs": 5,
        "error": 0.001 * KEPT,
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
        "error": 0.01 * KEPT,
        "passes": False,
        "why": "error 9.1e-03",
        "cpu_per_second": 0.01 / times[0],
    }
    snippet = (
        "from analytic import load_scene\nfrom engines import get_engine\n\n"
        'response = get_engine("coarse").simulate(load_scene("rocks.toml"), variant="lies")\n'
        "print(response.outcome_text, response.peak_tilt_ratio, response.peak_base_displacement)\n"
    )
    yield (
        "Choice",
        ask("choose", "rocks.toml", "--error", 0.003),
        {
            "schema": "rocking choose 4",
            "scene": "rocks",
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
            "command": "rocking run rocks.toml --engine coarse --variant lies",
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
    worse = {"chosen": None, "best": {"engine": "restitution", "error": 0.02 * KEPT}, "command": None}
    yield "Choice", ask("choose", "rocks.toml", "--engine", "restitution"), worse
    refusal = "below 0.1884, where an impact of a block released by hand depends on the law of friction in it"
    yield (
        "Choice",
        ask("choose", "near.toml", "--engine", "honest"),
        {"criterion": "tilt", "left_out": {"0.95": refusal}, "warnings": {"of": 1, 0: {"kind": "limit", "text": PAST}}},
    )


def reported(ask):
    """Two scenes in the model, in an engine that lies by known factors, and in one that fails."""
    (_, bears), (falls, other) = model("bears"), model("falls")
    yield (
        "Report",
        ask("report", "tall.toml", "--engine", "honest", "--output", "page"),
        {"pedestals": {"tall": tall()}},
    )
    late = {"quantity": "overturning_time", "here": other.overturning_time + LATER, "model": other.overturning_time}
    yield (
        "Report",
        ask("report", "bears.toml", "falls.toml", *MANY, "--engine", "off", "--engine", "fails", "--output", "page"),
        {
            "schema": "rocking report 6",
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
                    "peak_tilt_ratio": bears.peak_tilt_ratio,
                    "peak_base_displacement": bears.peak_base_displacement,
                    "impact_count": bears.impact_count,
                    "same_outcome": None,
                    "warnings": bears.warnings,
                    "comparable": "no",
                },
                {
                    "engine": "off",
                    "variant": "lies",
                    "same_outcome": True,
                    "overturning_time_error": None,
                    "peak_tilt_error": 0.05 * bears.peak_tilt_ratio,
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
            "motions": {"bears": {"of": 3}, "falls": [*under(falls, "one-sine pulse, 4 m/s2, 6 rad/s")]},
            "left_out": {"bears": LEFT_OUT, "falls": LEFT_OUT},
            "sizes": {"bears": {"kind": "rubber", "height": approx(0.02 / 1.5)}, "falls": None},
            "headlines": {
                "bears": "Warning: the base exceeds x_max under 2 of 2 motions. "
                f"{ODD} Warning: the outcome is sensitive to small changes under 1 of 2 motions. "
                f"The block lifts {ONCE}, and overturns {NEVER}. {COUNTED}",
                "falls": f"{ODD} The block lifts under 2 of 2 motions (34 to 100 % at 95 %), "
                f"and overturns {ONCE}. {COUNTED}",
            },
        },
    )


def fails(*_):
    raise agreement.Unmeasurable("the run failed")


def verified(ask):
    """Made-up rows of the tolerance table: one is measured, of the other the run fails."""
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
    rows = [tolerances.Tolerance(**known, measure=measure) for measure in (lambda *_: 3e-4, fails)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tolerances, "rows", lambda *_: rows)
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


def sheet_written(ask):
    """A record, a new scene and the sheet: what went in, and the geometry and the equations that follow from it."""
    channel = {
        "units": "gal",
        "units_from": "the titles",
        "dt": 0.02,
        "samples": 100,
        "duration": 1.98,
        "peak_time": 0.02 * float(np.abs(noise(100, 1)).argmax()),
        "note": "offset subtracted",
        "warnings": [CUT],
    }
    yield (
        "Record",
        ask("record", "records/quake.csv"),
        {
            "schema": "rocking record 1",
            "file": "quake.csv",
            "format": "K-NET CSV",
            "channels": [
                {"channel": "1", "direction": "N-S", "peak": 3.0, **channel},
                {"channel": "2", "direction": "E-W", "peak": 6.0, **channel},
                {"channel": "3", "direction": "U-D", "peak": 9.0, **channel},
            ],
        },
    )
    size = {"height": 1.9, "width": 0.55, "mass": 1500, "base-mass": 400, "period": 2.5, "xmax": 0.2, "damping": 0.12}
    options = [word for name, value in size.items() for word in (f"--{name}", value)]
    yield (
        "New",
        ask("new", "new.toml", "--name", "bust", *options),
        {
            "schema": "rocking new 2",
            "file": "new.toml",
            "scene": "bust",
            "derived": {
                "of": 12,
                0: {
                    "name": "slenderness",
                    "value": approx(math.atan(0.55 / 1.9), rel=1e-5),
                    "unit": "rad",
                    "asked": None,
                },
                1: {"value": approx(math.hypot(0.95, 0.275), rel=1e-5), "unit": "m"},
                3: {"value": approx(2000.0 * (0.95**2 + 0.275**2), rel=1e-5), "unit": "kg m2"},
                7: {"name": "secant period at x_max", "value": approx(2.5, rel=1e-4), "unit": "s", "asked": 2.5},
                8: {"name": "equivalent damping at x_max", "value": approx(0.12, rel=1e-4), "unit": "-", "asked": 0.12},
            },
            "sizes": {"kind": "lead-rubber", "height": approx(0.2 / 1.5)},
        },
    )
    rate = math.sqrt(1.5 * G / 1.2 * (math.cos(0.05) - math.cos(0.25)))
    yield (
        "Sheet",
        ask("sheet"),
        {
            "schema": "rocking sheet 2",
            "sheet": 1,
            "files": lambda files: (
                sorted(files) == sorted(str(path) for path in Path("sheet").rglob("*") if path.is_file())
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
                            "quantity": "rate_after_1",
                            "unit": "rad/s",
                            "answer": -KEPT * rate,
                            "meaning": "φ′ just after impact 1",
                            "tolerance": 1e-3 * 0.25 * math.sqrt(0.75 * G / 1.2),
                        },
                    },
                },
            },
        },
    )


def studied(ask):
    """A made-up study of two runs, of which one is kept; a check finds that one changed."""
    began = datetime.now(UTC).replace(microsecond=0)
    (path,) = runner.compute(MADE, "studies", engines=(), workers=1, progress=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fake_solvers, "tilt", fake_solvers.place)
        check.check(path, 60, 11, record=True, workers=1, progress=False)
    document = json.loads((path / "analytic.json").read_text())
    text = json.dumps({**document, "digest": None}, sort_keys=True, separators=(",", ":")).replace('"digest":null,', "")
    git = ["git", "-C", Path(__file__).parent]
    checkout = {
        "commit": subprocess.check_output([*git, "rev-parse", "HEAD"], text=True).strip(),
        "dirty": bool(subprocess.check_output([*git, "status", "--porcelain", "-uno"])),
    }
    times = [(began + timedelta(seconds=second)).isoformat() for second in range(100)]
    cpu_info = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else platform.processor()
    swing = {"part": "swing", "engine": "analytic", "cpu_seconds": SPENT}
    yield (
        "StudyResult",
        document,
        {
            "schema": "rocking study 3",
            "digest": hashlib.sha256(text.encode()).hexdigest(),
            "kind": "made",
            "provenance": {
                "time": times.__contains__,
                "machine": {
                    "processor": {line.partition(": ")[2] or line for line in cpu_info.splitlines()}.__contains__,
                    "cores": 3,
                    "logical_cores": 6,
                    "memory_gib": 48.0,
                    "system": f"{platform.system()} {platform.machine()}",
                },
                "packages": {
                    **dict.fromkeys(PACKAGES, lambda version: version is None or version[0].isdigit()),
                    **{name: version(name) for name in ("numpy", "scipy", "numba", "exudyn")},
                },
                "python": platform.python_version(),
                "sources": {root: root[::-1] for root in ("fake_study:plan", "analytic:simulate")},
                "seed": 3,
                "check": {
                    "date": {time_[:10] for time_ in times}.__contains__,
                    **checkout,
                    "seed": 11,
                    "runs": 1,
                    "held": 0,
                },
                **checkout,
            },
            "settings": {
                "mass": 1.0,
                "quick": False,
                "engines": [],
                "best": {},
                "variants": [{"engine": "twin"}],
                "changed_while_running": [],
            },
            "arrays": {
                "file": "analytic.npz",
                "digest": hashlib.sha256((path / "analytic.npz").read_bytes()).hexdigest(),
            },
            "runs": {"stored": 1, "total": 2},
            "rows": [
                {"part": "starts", "starts": [*STARTS]},
                *({**swing, "start": each, "tilt": each} for each in STARTS),
            ],
        },
    )


DOCUMENTS = (runs, compared, changed, risked, designed, searched, chosen, reported, verified, sheet_written, studied)
EMPTY = (None, "", [], {})  # what shows nothing of a field


@pytest.fixture(scope="module")
def known(ask):
    """[((part, field), value in a document, value known)] of all documents."""
    return [leaf for made in DOCUMENTS for document in made(ask) for leaf in leaves(*document)]


def test_values_are_the_known_ones(known):
    assert [leaf for leaf in known if not agrees(*leaf[1:])] == []


def test_a_wrong_value_is_seen(known):
    assert [leaf for leaf in known if leaf[1] not in EMPTY and agrees(WRONG[type(leaf[1])](leaf[1]), leaf[2])] == []


def test_each_field_of_each_form_is_looked_at(known):
    fields = {(name, field) for name, part in PARTS.items() for field in part["properties"]}
    assert fields == {pair for pair, result, _ in known if pair and result not in EMPTY}
