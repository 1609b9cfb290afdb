"""Every kind of scene with every command: an answer, or a refusal that says what to do; nothing is lost or hidden.

Engines that lie take the place of slow ones (`lying_engine`). The scans of margins and bearings are coarse here; that a
user's are not is a test of its own. The slow form has the real engines, and `choose`.
"""

import itertools
import json
import re
import shutil
from dataclasses import replace
from functools import cache, partial
from importlib import import_module

import numpy as np
import pytest
from answered import Here
from jsonschema.validators import validator_for
from lying_engine import FAULTS, LIES, SHARE, liars
from roads import KINDS, REFUSED, STACKS, write_records
from scipy.integrate import cumulative_trapezoid

from analytic import Base, Bearings, load_scene, simulate, synthetic_motion
from analytic.advice import bearing_scan, margins
from analytic.response import DIFFERENCES, FALLS, JUDGED, Difference, Failure
from analytic.rocking import properties, restitution
from comparisons.commands import advice as margin
from comparisons.commands import risk
from comparisons.execution import command_runs
from comparisons.execution.command_runs import OWN
from comparisons.execution.results import RESULTS
from comparisons.report import statue
from comparisons.schemas.__main__ import schemas
from engines import BUILT_IN, ENGINES, get_engine, guard

USUAL = {
    "margin": (margin.STEPS, margins.BISECTIONS),
    "design": (bearing_scan.PERIOD_STEP, bearing_scan.DAMPING_STEP),
    "report": (statue.STEP, statue.PLATE_STEP, margins.STEP),
}
ERROR = re.compile(r"^Error: (?P<file>\S+): (?P<field>[\w.]+)(?: = (?P<value>.+?))?: (?P<problem>.+); (?P<remedy>.+)$")
RECORDS = 3  # of the folder that are earthquakes
LEFT_OUT = ["gal.txt", "notes.txt", "spectrum.txt", "same.csv", "strong.csv, column 3 (Up)"]
LEFT = len(LEFT_OUT)
APART = guard.run_apart
SOON = [*LIES, *(name for name in FAULTS if name not in ("raises", "hangs"))]
SOUND = ("honest", "close", "nan")  # of the faults, the engines that claim an outcome


def here(function, *arguments, **_):
    """In place of `run_apart`: in this process, which a test of runs that fail does not ask for."""
    return function(*arguments), None


# what is coarse here, done in this process (so that it finds these engines), or no road: what the code is
HERE = {
    "engines.guard.run_apart": here,
    "comparisons.execution.command_runs.compile_kernels": lambda *_: None,
    "comparisons.commands.advice.STEPS": 6,
    "analytic.advice.margins.BISECTIONS": 3,
    "analytic.advice.margins.STEP": 0.0125,
    "analytic.advice.margins.STACK_STEP": 0.2,
    "analytic.advice.margins.STACK_BISECTIONS": 3,
    "analytic.advice.bearing_scan.PERIOD_STEP": 0.4,
    "analytic.advice.bearing_scan.DAMPING_STEP": 0.05,
    "comparisons.report.statue.STEP": 0.1,
    "comparisons.report.statue.PLATE_STEP": 0.2,
    **dict.fromkeys(
        ("comparisons.execution.runner.Processes", "comparisons.advice.choose.Processes"), lambda *_: Here()
    ),
    **{
        f"comparisons.execution.{place}": lambda *_: {}
        for place in ("runner.source_digests", "cases.source_digests", "results.kept_digests", "runner.digests_of_all")
    },
    **dict.fromkeys(("comparisons.report.answer.age", "comparisons.report.write.age"), lambda *_: None),
    "comparisons.execution.cases.version_of": lambda _: "1",
}


@pytest.fixture
def road(rocking, tmp_path, monkeypatch):
    """Runs a command on a kind of scene, in its folder; (status, JSON or None, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)
    for place, made_up in HERE.items():
        module, _, name = place.rpartition(".")
        monkeypatch.setattr(import_module(module), name, made_up)
    known = dict(ENGINES)
    ENGINES.clear()
    ENGINES.update(liars())
    write_records(tmp_path / "records")

    def call(command, kind, *words):
        text = (KINDS | REFUSED | STACKS)[kind][0]
        (tmp_path / "scene.toml").write_text(text)
        (tmp_path / "out.json").unlink(missing_ok=True)
        status, out, err = rocking(command, "scene.toml", *words, "--json", "out.json")
        assert "Traceback" not in out + err
        answer = checked(tmp_path / "out.json") if (tmp_path / "out.json").exists() else None
        return status, answer, " ".join(out.split()), err

    yield call
    ENGINES.clear()
    ENGINES.update(known)  # in their order


@cache
def valid(schema):
    known = schemas()[schema.replace(" ", "-")]
    return validator_for(known)(known)


def checked(file):
    """The JSON of a file, which is valid by the schema that it names."""

    def refuse(word):
        raise AssertionError(f"{word} is no JSON")

    answer = json.loads(file.read_text(), parse_constant=refuse)
    valid(answer["schema"]).validate(answer)
    return answer


def half(first, kinds=KINDS, later=pytest.mark.slow):
    """All kinds; every other one is run later, so that each is run by two commands in the first tests."""
    return [pytest.param(kind, marks=[later] * (k % 2 != first)) for k, kind in enumerate(kinds)]


def shown(words, out):
    """Whether a sentence is printed, however its lines are broken."""
    return " ".join(words.split()) in out


def all_is_told(warnings, out):
    """Of each quantity that is warned of, one sentence is printed."""
    by_name = {}
    for warning in warnings:
        about = warning["kind"], warning["quantity"] or warning["text"]
        by_name[about] = by_name.get(about, False) or shown(warning["text"], out)
    assert all(by_name.values()), by_name


def pedestal_is_told(kind, answer, words):
    """The verdict stands in JSON and is printed; one that may lift is also warned of, beside each motion."""
    check = answer["pedestal"]
    assert (check is not None) == ("mass = 300.0" in KINDS[kind][0])
    if check is None:
        return
    lifts = kind == "pedestal that may lift"
    assert shown(check["text"], words) and check["text"].startswith(f"The pedestal {'may lift' if lifts else 'stays'}")
    assert (max(check["share"], check["landing"]) > 1) == lifts
    warned = [[each["quantity"] for each in row["warnings"]] for row in (answer, *answer.get("motions", ()))]
    assert not lifts or "pedestal" in warned[0] and any("pedestal" in names for names in warned[1:])


def differences_are_told(response, out):
    assert all(shown(str(Difference(**difference)), out) for difference in response["differences"]), response[
        "differences"
    ]


def engine_options(names):
    return [word for name in names for word in ("--engine", name)]


def motions_are_told(answer, out, count):
    """Each motion has its row, its warnings, and the headline what they come to."""
    rows = answer["motions"]
    assert len({row["record"] for row in rows}) == count
    all_is_told([warning for row in rows for warning in row["warnings"]], out)
    assert shown(answer["headline"], out)
    assert (f"Left out of the folder: {LEFT} files or channels." in out) == bool(LEFT)
    beyond = {
        row["record"]
        for row in rows
        if "peak_base_displacement" in [warning["quantity"] for warning in row["warnings"]]
    }
    unit = "motion" if OWN in {row["record"] for row in rows} else "record"
    assert (f"the base exceeds x_max under {len(beyond)} of {count} {unit}" in answer["headline"]) == bool(beyond)
    for row in rows:
        assert (row["outcome"] == "failed") == bool(row["failure"])
        assert row["failure"] is None or shown(row["failure"], out)


def some_failed(rows):
    """The status that tells it."""
    return int(any(row["failure"] for row in rows))


def counted(kind):
    """Records of a scene under the folder's: its own motion is one more, unless it is among them."""
    return RECORDS + ("[motion]" in KINDS[kind][0] and kind != "record")


@pytest.mark.parametrize("kind", half(0))
def test_run(road, kind):
    status, answer, out, _ = road("run", kind, "--records", "records", "--units", "m/s2")
    assert status == some_failed(answer["motions"]) and answer["outcome"] == KINDS[kind][1]
    assert answer["decided"] == (kind != "undecided")
    assert [line.partition(":")[0] for line in answer["left_out"]] == LEFT_OUT
    pedestal_is_told(kind, answer, out)
    all_is_told(answer["warnings"], out)
    motions_are_told(answer, out, counted(kind))


@pytest.mark.parametrize("kind", KINDS)
def test_compare(road, kind):
    """Each lie is found wherever the scene lets it show, and printed."""
    status, answer, out, _ = road("compare", kind, *engine_options([*LIES, "close"]))
    assert status == 0
    assert [response["engine"] for response in answer["responses"]] == ["analytic", *LIES, "close"]
    assert answer["pedestal"] is None or shown(answer["pedestal"]["text"], out)
    for response in answer["responses"]:
        all_is_told(response["warnings"], out)
        differences_are_told(response, out)
    by_name = {
        response["engine"]: {each["quantity"] for each in response["differences"]} for response in answer["responses"]
    }
    model = answer["responses"][0]
    judged = answer["responses"][1]["comparable"] in JUDGED
    falls = KINDS[kind][1] == "overturns"
    where = {
        "analytic": False,
        "close": False,
        "outcome": model["decided"],
        "tilt": not falls,
        "stroke": True,
        "slip": "friction" in KINDS[kind][0] and not falls,
        "fall": falls,
        "lying": falls,
        "restitution": model["impact_count"] > 0,
    }
    assert {name: bool(by_name[name]) for name in where} == {name: judged and shows for name, shows in where.items()}


@pytest.mark.parametrize("kind", [pytest.param("overturns", marks=pytest.mark.slow), "slides on bearings"])
def test_compare_with_engines_that_fail(road, monkeypatch, kind):
    """Each failure costs its row: the others stand, and the reason is said."""
    monkeypatch.setattr(guard, "run_apart", APART)
    status, answer, out, err = road("compare", kind, *engine_options(FAULTS), "--time-limit", 3)
    assert status == 0
    by_name = {response["engine"]: response for response in answer["responses"]}
    assert [name for name, response in by_name.items() if response["failure"]] == [
        name for name in FAULTS if name not in SOUND
    ]
    for name, response in by_name.items():
        assert not response["failure"] or f"{name} failed: {response['failure']['reason']}" in err
        differences_are_told(response, out)
    assert not by_name["honest"]["differences"] and by_name["nan"]["differences"]
    assert "Newton did not converge" in err and "--time-limit allows more" in err and "not in this engine" in err


@pytest.mark.parametrize("engine", ["honest", "fails", "refuses"])
@pytest.mark.parametrize("fails", [False, True])
def test_the_status_of_compare_is_that_of_the_model(road, monkeypatch, fails, engine):
    if fails:
        failed = partial(
            replace, outcome="failed", decided=False, failure=Failure("it gave up", "at 1 s"), history=None
        )
        monkeypatch.setattr(command_runs, "_analytic", lambda scene, *_: failed(simulate(scene, history=False)))
    status, answer, _, err = road("compare", "rocks", *engine_options([engine]))
    assert status == int(fails) and [bool(response["failure"]) for response in answer["responses"]] == [
        fails,
        engine != "honest",
    ]
    assert ("analytic failed: it gave up" in err) == fails


@pytest.mark.parametrize("words, compared", [(["close", "analytic", "tilt", "close"], ["close", "tilt"]), ([], SOON)])
def test_compare_runs_the_model_first_and_each_engine_once_or_all_that_are_installed(road, words, compared):
    del ENGINES["hangs"]
    ENGINES["raises"] = replace(ENGINES["raises"], package="no_such_package", adapter="no_such_package")
    status, answer, _, _ = road("compare", "stands", *engine_options(words))
    assert status == 0 and [response["engine"] for response in answer["responses"]] == ["analytic", *compared]


def test_every_kind_of_difference_occurs(road):
    names = set()
    for kind in ("slender", "slides", "overturns after an impact", "stack rocks"):
        _, answer, _, _ = road("compare", kind, *engine_options(LIES))
        names.update(
            difference["quantity"] for response in answer["responses"] for difference in response["differences"]
        )
    assert names == set(DIFFERENCES)


@pytest.mark.parametrize("kind", half(1))
def test_margin(road, kind):
    status, answer, out, _ = road("margin", kind, "--records", "records", "--units", "m/s2")
    assert status == some_failed(answer["motions"])
    assert answer["outcome"] == KINDS[kind][1] or kind == "undecided"
    pedestal_is_told(kind, answer, out)
    for each in answer["margins"]:
        for way in ("ends_down", "ends_up"):
            assert shown(each[way], out)
        lows, highs = [band["low"] for band in each["bands"]], [band["high"] for band in each["bands"]]
        assert lows[1:] == highs[:-1] and (lows[0] <= 0 <= highs[-1])
    all_is_told(answer["warnings"], out)
    motions_are_told(answer, out, counted(kind))


@pytest.mark.parametrize("kind", half(0))
def test_risk(road, kind):
    """Each limit state has odds, each record and failed run is counted, and a single motion is the scene's own."""
    status, answer, out, _ = road("risk", kind, "--records", "records", "--units", "m/s2", "--draws", 2)
    assert status == some_failed(answer["motions"])
    rows = answer["motions"]
    assert {row["record"] for row in rows} == set(answer["records"]) and len(answer["records"]) == counted(kind)
    all_is_told([warning for row in rows for warning in row["warnings"]] + answer["warnings"], out)
    odds_are_told(answer, out)
    assert [line.partition(":")[0] for line in answer["left_out"]] == LEFT_OUT


@pytest.mark.parametrize("kind", half(1))
def test_risk_under_one_motion(road, kind):
    """With nothing drawn, the odds are those of the scene as it is: 0 or 1."""
    nothing = [f"--spread={name}=0" for name in drawn_in(kind)]
    status, answer, out, _ = road("risk", kind, "--motions", 0, "--draws", 2, *nothing)
    assert status == 0 and answer["drawn"] == [] and answer["motions"] == [] and answer["failed"] == 0
    all_is_told(answer["warnings"], out)
    odds_are_told(answer, out)
    by_state = {each["state"]: each["probability"] for each in answer["odds"]}
    outcome = simulate(load_scene("scene.toml").with_(duration=None), history=False).outcome
    assert by_state["overturns"] == (outcome == "overturns")
    assert by_state["lifts"] == (outcome in ("rocks", "overturns"))
    assert set(by_state.values()) <= {0.0, 1.0}


def test_risk_draws_a_thousand_times_under_one_motion(road):
    status, answer, out, _ = road("risk", "stands")
    assert status == 0 and answer["draws"] == 1000 and [*answer["records"]] == [OWN] and answer["motions"] == []
    assert "of 1000 draws of its values under the scene's own motion" in out


def test_risk_under_synthetic_motions_of_a_seed(road, monkeypatch):
    monkeypatch.setattr(risk, "MOTIONS", 3)
    words = ("risk", "record", "--draws", 3, "--pgv", 0.3)
    (_, first, out, _), (_, again, _, _), (_, other, _, _) = (road(*words, "--seed", seed) for seed in (4, 4, 5))
    assert first == again and len(first["records"]) == 3 and not set(first["records"]) & set(other["records"])
    assert "under each of 3 synthetic motions, scaled to 0.3 m/s" in out
    for row in first["motions"]:
        motion = synthetic_motion(seed=int(row["motion"].split()[-1]))
        velocity = np.abs(cumulative_trapezoid(motion.samples, dx=motion.dt)).max()
        assert row["peak"] == pytest.approx(0.3 / velocity * motion.peak, rel=1e-9)


def drawn_in(kind):
    """The quantities that are drawn of a kind of scene."""
    text = KINDS[kind][0]
    yield "slenderness"
    if "friction" not in text or "restitution" in text:
        yield "restitution"
    yield from (name for name in ("friction", "ka", "kb") if f"{name} = " in text)


def odds_are_told(answer, out):
    """Their sentences are printed; an interval holds its probability; failed runs are counted."""
    assert shown(answer["headline"], out) and (f"do not count: {answer['failed']}." in out) == bool(answer["failed"])
    assert all(0 <= each["low"] <= each["probability"] <= each["high"] <= 1 for each in answer["odds"])
    states = [each["state"] for each in answer["odds"]]
    assert all(list(shares) == states for shares in answer["records"].values())


def design(road, kind, *words):
    """The answer of the command and what it prints, the same in JSON."""
    added = () if "[base]" in KINDS[kind][0] else ("--base-mass", 200)
    status, answer, out, _ = road("design", kind, "--stroke", 0.3, *added, *words)
    assert status == some_failed(row for proposal in answer["chosen"].values() for row in proposal["motions"])
    all_is_told([warning for row in answer["motions"] for warning in row["warnings"]] + answer["warnings"], out)
    held = [cell for row in answer["holds"] for cell in row]
    assert bool(answer["chosen"]) == any(held) and ("bearings of" in out)
    assert any(held) or "no bearings" in out
    scene = load_scene("scene.toml")
    for proposal in answer["chosen"].values():
        bearings = Bearings(**{name: value for name, value in proposal["bearings"].items() if value is not None})
        isolated = scene.with_(base=Base(mass=answer["base_mass"]), bearings=bearings)
        result = properties(bearings, isolated.total_mass, answer["stroke"])
        wanted = [proposal["period"], proposal["damping"]]
        assert [result.period, result.damping_equivalent] == pytest.approx(wanted, rel=1e-3)
        if scene.motion:  # as a run on these bearings has it
            moved = simulate(isolated, history=False).peak_base_displacement
            assert min(abs(row["stroke"] / moved - 1) for row in proposal["motions"]) < 1e-9
    return answer, out


@pytest.mark.parametrize("kind", ["quiet", "quiet on bearings", "loud", "stands", "overturns"])
def test_design_for_one_motion(road, kind):
    answer, _ = design(road, kind)
    assert len(answer["motions"]) == 1 and not answer["left_out"]
    assert bool(answer["chosen"]) == (kind not in ("loud", "overturns"))


@pytest.mark.parametrize("kind", half(0))
def test_design(road, kind):
    answer, out = design(road, kind, "--records", "records", "--units", "m/s2")
    assert len(answer["motions"]) == counted(kind) and len(answer["left_out"]) == LEFT
    for proposal in answer["chosen"].values():
        motions_are_told(proposal, out, counted(kind))
        assert proposal["stroke"] == max(row["stroke"] for row in proposal["motions"])


AGAIN = ("slide-rocks", "on linear bearings", "given restitution", "slides")  # of a criterion that another shows
# {kind: (the criterion chosen by default, the engine that lies about it)}
CHOSEN = {
    "rocks": ("restitution", "restitution"),
    "on linear bearings": ("restitution", "restitution"),
    "vertical motion": ("restitution", "restitution"),
    "slide-rocks": ("tilt", "tilt"),
    "given restitution": ("tilt", "tilt"),
    "slides": ("slip", "slip"),
    "slides on bearings": ("slip", "slip"),
    "quiet on bearings": ("displacement", "stroke"),
    "a copy is refused": ("tilt", "tilt"),
}


@pytest.mark.parametrize("kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind in AGAIN)) for kind in CHOSEN])
def test_choose(road, kind):
    """The honest engine has no error and is chosen; the error of the other is that of its lie."""
    criterion, liar = CHOSEN[kind]
    status, answer, out, _ = road("choose", kind, *engine_options(["honest", liar]))
    assert status == 0 and answer["criterion"] == criterion
    all_is_told(answer["warnings"], out)
    assert (answer["chosen"]["engine"], answer["chosen"]["value"]) == ("honest", 1e-2)  # its coarsest level
    assert answer["command"] in out and answer["command"].endswith("--variant lies --set step=0.01")
    honest, lying = answer["variants"]
    assert all(
        level["error"] < 1e-12 and level["passes"] and level["runs"] == len(answer["neighbours"])
        for level in honest["levels"]
    )
    assert not any(level["passes"] for level in lying["levels"]) and [level["value"] for level in lying["levels"]] == [
        1e-2,
        1e-3,
    ]
    factors = {0.95, 0.975, 1.0, 1.025, 1.05}
    refused = {float(factor) for factor in answer["left_out"]}
    assert set(answer["neighbours"]) == factors - refused and bool(refused) == (kind == "a copy is refused")
    assert answer["neighbours"][0] == 1.0
    scene = load_scene("scene.toml")
    result, model = lying["levels"][0]["error"], simulate(scene, history=False)
    if criterion == "restitution":
        assert result == pytest.approx(0.02 * restitution(scene), rel=1e-6)
    elif criterion == "tilt":
        assert 0 < result <= SHARE * model.peak_tilt_ratio * (1 + 1e-9)
        assert KINDS[kind][1] == "overturns" or result > 0.99 * SHARE * model.peak_tilt_ratio
    else:
        assert result == pytest.approx(SHARE, rel=1e-5)  # the peak lies between two samples of the history
    needed = {part["part"]: part["needed"] for part in answer["parts"]}
    assert needed["base"] == ("[base]" in KINDS[kind][0]) and not needed["third dimension"]
    assert needed["rocking"] == (criterion not in ("slip", "displacement"))
    assert needed.get("sliding") == (None if scene.friction is None else bool(model.sliding and model.sliding.peak))


def test_choose_by_outcomes_counts_the_neighbours_that_differ(road):
    status, answer, _, _ = road(
        "choose", "rocks", "--for", "outcome", "--error", 0.3, *engine_options(["honest", "outcome"])
    )
    assert status == 0 and answer["chosen"]["engine"] == "honest" and len(answer["neighbours"]) == 9
    honest, lying = answer["variants"]
    assert [level["error"] for level in honest["levels"]] == [0.0, 0.0] and lying["levels"][0]["error"] == 1.0
    status, answer, out, _ = road("choose", "rocks", "--for", "outcome", *engine_options(["outcome"]))
    assert status == 1 and answer["chosen"] is None and "No level passes 0.001 for outcome" in out


def test_choose_names_the_model_where_the_block_never_lifts(road):
    status, answer, out, _ = road("choose", "stands")
    assert status == 0 and answer["chosen"]["engine"] == "analytic" and not answer["variants"]
    assert answer["command"] == "rocking run scene.toml" and "the block never lifts on" in out


@pytest.mark.parametrize(
    "words, message", [(("--error", 2), "below 1"), (("--for", "speed"), "choose one of restitution")]
)
def test_choose_refuses_what_it_cannot_choose_by(road, words, message):
    status, answer, _, err = road("choose", "rocks", *words)
    assert status == 2 and answer is None and message in err


@pytest.mark.parametrize(
    "first, step", [(0, 4), pytest.param(2, 4, marks=pytest.mark.slow), pytest.param(1, 2, marks=pytest.mark.slow)]
)
def test_report(road, rocking, tmp_path, first, step):
    """All kinds, in three reports: of the model, an engine that lies, one that fails, and one that gives no numbers."""
    road("run", "stands")
    shutil.copytree(RESULTS / "tolerances", tmp_path / "studies" / "tolerances")
    kinds, files = [*KINDS][first::step], []
    for kind in kinds:
        files.append(tmp_path / f"{kind.replace(' ', '-')}.toml")
        files[-1].write_text(KINDS[kind][0])
    words = "--records records --units m/s2 --studies studies --output page --json page.json".split()
    engines = ("lying", "fails", "nan")
    status, out, err = rocking("report", *files, *words, *engine_options(engines))
    assert status == 0 and "Traceback" not in out + err
    answer = checked(tmp_path / "page.json")
    assert len(answer["rows"]) == len(kinds) * (1 + len(engines))
    assert {row["scene"]: row["outcome"] for row in answer["rows"] if row["engine"] == "analytic"} == {
        file.stem: KINDS[kind][1] for kind, file in zip(kinds, files, strict=True)
    }
    page = " ".join(re.sub("<[^>]+>", " ", (tmp_path / "page" / "report.html").read_text()).split())
    for kind, file in zip(kinds, files, strict=True):
        assert len({row["record"] for row in answer["motions"][file.stem]}) == counted(kind)
        check = answer["pedestals"][file.stem]
        assert (check is not None) == ("mass = 300.0" in KINDS[kind][0])
        assert check is None or plain(check["text"]) in plain(page)
        headline, left = answer["headlines"][file.stem], answer["left_out"][file.stem]
        assert plain(headline) in plain(page) and f"Left out of the folder: {LEFT} files or channels." in headline
        assert len(left) == LEFT and all(plain(line) in plain(page) for line in left)


def plain(words):
    """Words without what a page marks up."""
    return re.sub(r"[\s_]|&#39;|'|’", "", words)


@pytest.mark.parametrize("kind", half(1))
def test_run_in_an_engine(road, kind):
    engine = ("lying", "nan", "fails")[[*KINDS].index(kind) % 3]
    status, answer, out, err = road("run", kind, "--engine", engine, "--records", "records", "--units", "m/s2")
    assert status == some_failed([answer, *answer["motions"]]) and answer["engine"] == engine
    assert bool(answer["failure"]) == (engine == "fails")
    differences_are_told(answer, out)
    all_is_told(answer["warnings"], out)
    motions_are_told(answer, out, counted(kind))
    assert engine != "fails" or "it blew up" in err


@pytest.mark.parametrize("kind", KINDS)
def test_script(rocking, tmp_path, monkeypatch, kind):
    name = ("exudyn", "pybullet")[[*KINDS].index(kind) % 2]
    monkeypatch.chdir(tmp_path)
    write_records(tmp_path / "records")
    (tmp_path / "scene.toml").write_text(KINDS[kind][0])
    status, out, err = rocking("script", name, "scene.toml", "--output", "own.py")
    assert status == 0, err
    compile((tmp_path / "own.py").read_text(), "own.py", "exec")


@pytest.mark.parametrize(
    "command", ["run", "compare", "margin", "risk", "report"]
)  # a design is of the block, not the scene
@pytest.mark.parametrize("kind", REFUSED)
def test_a_scene_that_the_model_refuses_is_named_with_its_remedy(road, kind, command):
    status, answer, _, err = road(command, kind)
    assert status == 2 and answer is None
    match = ERROR.match(err.strip().splitlines()[-1])
    assert match and match["file"] == "scene.toml" and match["field"] == REFUSED[kind][1], err
    assert float(match["value"]) and match["remedy"].startswith(("give", "leave"))


@pytest.mark.parametrize("kind", half(0, STACKS))
def test_run_and_compare_of_a_free_pedestal(road, kind):
    outcome = STACKS[kind][1]
    status, answer, out, _ = road("run", kind, "--records", "records", "--units", "m/s2")
    assert status == some_failed([*answer["motions"], answer]) and answer["outcome"] == outcome
    rocked = answer["stack"]["rocked"]
    assert shown(f"what rocks {' and '.join(rocked) or 'nothing'}", out) and bool(rocked) == (outcome != "stands")
    assert shown(answer["headline"], out) and len({row["record"] for row in answer["motions"]}) >= RECORDS
    status, answer, out, _ = road("compare", kind, *engine_options(["close", "tilt", "stroke", "pedestal", "outcome"]))
    assert status == int(outcome == "failed") and answer["sensitivity_horizon"] is None
    model, close, *lies = answer["responses"]
    assert model["outcome"] == close["outcome"] == outcome and "lower: peak tilt" in out
    told = {lie["engine"]: {each["quantity"] for each in lie["differences"]} for lie in (close, *lies)}
    falls, known = outcome in FALLS, outcome != "failed"
    assert told == {
        "close": set(),
        "tilt": {"peak_tilt"} if known and not falls else set(),
        "stroke": {"peak_base_displacement"} if known else set(),
        "pedestal": {"pedestal_tilt"} if known and not falls else set(),
        "outcome": {"outcome"} if known and model["decided"] else set(),
    }
    for lie in lies:
        differences_are_told(lie, out)


@pytest.mark.parametrize("kind", half(1, STACKS, pytest.mark.long))
def test_margin_of_a_free_pedestal(road, tmp_path, kind):
    """What changes at a boundary differs in two runs beside it."""
    status, answer, out, _ = road("margin", kind, "--span", 60)
    stack, (margin,) = load_scene(tmp_path / "scene.toml").with_(duration=None), answer["margins"]
    assert status == int(STACKS[kind][1] == "failed") and margin["quantity"] == ("motion" if stack.motion else "start")
    for below, above in itertools.pairwise(margin["bands"]):
        for band, side in ((below, -1), (above, 1)):
            factor = 1 + below["high"] + 0.013 * side
            changed = {"motion": stack.motion.scaled(factor)} if stack.motion else {"start": {"tilt": 0.15 * factor}}
            falls = {*FALLS} & ({*below["reached"]} ^ {*above["reached"]})
            assert falls & {simulate(stack.with_(**changed), history=False).outcome} == falls & {*band["reached"]}


@pytest.mark.parametrize("command", ["design", "risk", "choose", "report"])
def test_what_knows_one_block_refuses_a_free_pedestal_in_a_line(road, command):
    options = {"design": ("--stroke", 0.2, "--base-mass", 100)}.get(command, ())
    status, _, _, err = road(command, "stack stands", *options)
    error = ERROR.match(err.splitlines()[-1])
    assert status == 2 and error and error["field"] == "pedestal.free" and "Traceback" not in err


def test_a_script_of_a_free_pedestal_is_refused(rocking, tmp_path):
    (tmp_path / "scene.toml").write_text(STACKS["stack stands"][0])
    status, _, err = rocking("script", "pybullet", tmp_path / "scene.toml")
    assert status == 2 and ERROR.match(err)["field"] == "pedestal.free"


def test_the_scans_of_a_user_are_fine():
    assert USUAL == {"margin": (400, 14), "design": (0.01, 0.005), "report": (margins.STEP, 0.01, margins.STEP)}
    assert (margins.SPAN, margins.STEP) == (0.2, 5e-4)
    assert (bearing_scan.PERIODS, bearing_scan.DAMPINGS, bearing_scan.COARSE) == ((0.3, 5.0), (0.02, 0.5), 4)


def test_a_friction_beside_that_of_the_scene_is_refused(rocking, tmp_path):
    (tmp_path / "scene.toml").write_text(KINDS["slides"][0])
    status, _, err = rocking("run", tmp_path / "scene.toml", "--engine", "exudyn", "--set", "friction=0.01")
    assert status == 2 and "friction = 0.01: the scene's, 0.15, is used in its place; leave it out" in err


@pytest.mark.long
@pytest.mark.parametrize("engine", BUILT_IN)
@pytest.mark.parametrize("kind", KINDS)
def test_real_engines_answer(rocking, tmp_path, monkeypatch, kind, engine):
    """Each variant of each engine that is installed."""
    monkeypatch.chdir(tmp_path)
    write_records(tmp_path / "records")
    (tmp_path / "scene.toml").write_text(KINDS[kind][0])
    for variant in get_engine(engine).variants:
        words = ("--engine", engine, "--variant", variant, "--json", "out.json", "--time-limit", 300)
        status, out, err = rocking("run", "scene.toml", *words)
        if status != 2 or "block.restitution" not in err:
            answer = checked(tmp_path / "out.json")
            assert status == (answer["outcome"] == "failed"), (variant, err)
            differences_are_told(answer, " ".join(out.split()))
