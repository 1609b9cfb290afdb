"""The command line, called as a user calls it: in this process where that is enough, else in a new one."""

import csv
import dataclasses
import functools
import json
import os
import subprocess
import sys
import time
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from bad_scenes import SCENE, write_scene
from own_scenes import BRONZE, CLIFF

from analytic import Caution, Failure, load_scene, simulate, solver
from comparisons import cli, commands
from comparisons.commands import app
from comparisons.execution import command_runs, progress
from comparisons.execution.results import PROJECT_FOLDER
from comparisons.execution.writing import readable
from engines import ENGINES, get_engine, guard, installed_engines

PNG = b"\x89PNG\r\n"


def in_a_new_process(*arguments, **environment):
    return subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "comparisons", *arguments],
        capture_output=True,
        text=True,
        timeout=120,
        env=os.environ | environment,
    )


def test_run_writes_csv_and_a_plot(rocking, tmp_path):
    files = [tmp_path / name for name in ("r.csv", "r.png")]
    status, out, _ = rocking("run", "free-rocking-isolated", "--csv", files[0], "--plot", files[1])
    assert status == 0 and "Free rocking on the isolated base" in out and "peak base displacement [m]" in out
    expected = simulate(load_scene("free-rocking-isolated")).history
    head, *rows = csv.reader(files[0].read_text().splitlines())
    assert rocking("run", "free-rocking-isolated", "--csv", "-")[1].splitlines()[0] == ",".join(head)  # no file "-"
    assert head == [
        *("time", "tilt", "tilt_rate", "base_displacement", "base_velocity", "bearing_force", "ground_acceleration")
    ]
    assert len(rows) == len(expected.time) and float(rows[-1][3]) == expected.base_displacement[-1]
    assert files[1].read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    "engine", [pytest.param(name, marks=pytest.mark.slow if name == "exudyn" else pytest.mark.long) for name in ENGINES]
)
def test_json_of_an_engine_is_alone_too(engine):
    """In a new process: an engine may greet when it is loaded, or when C flushes its buffers at exit."""
    done = in_a_new_process("run", "free-rocking-rigid", "--engine", engine, "--json", "-")
    assert done.returncode == 0 and json.loads(done.stdout)["engine"] == engine, done.stderr


def test_the_variant_that_tables_name_may_be_given(rocking):
    (status, out, _), (_, plain, _) = (
        rocking("run", "free-rocking-rigid", *more, "--json", "-") for more in (("--variant", "kernel"), ())
    )
    given, default = (json.loads(text) for text in (out, plain))
    assert (status, given["variant"], given["peak_tilt"]) == (0, "kernel", default["peak_tilt"])


@pytest.mark.slow
def test_module_and_status_in_a_new_process_and_names_the_terminal_cannot_show(tmp_path):
    path = write_scene(tmp_path, SCENE.replace("3172.05", "-1"))
    done = in_a_new_process("run", path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.endswith(f"Error: {path}: block.mass = -1: out of range; give a number above 0 [kg]\n")
    done = in_a_new_process("run", named(tmp_path, "石"), PYTHONIOENCODING="ascii")
    assert done.returncode == 0 and "\\u77f3" in done.stdout


def loaded_by(*arguments):
    """The modules that a command loads."""
    done = in_a_new_process(*arguments)
    assert done.returncode == 0, done.stderr
    return {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}


def test_help_loads_no_numbers():
    loaded = loaded_by("--help")
    assert "comparisons.cli" in loaded and "analytic.errors" in loaded
    assert not loaded & {"numpy", "numba", "scipy", "pydantic", "matplotlib", "engines"}


@pytest.mark.slow
def test_a_run_loads_no_engine_no_plots_and_no_statistics():
    loaded = loaded_by("run", "free-rocking-rigid")
    assert "numba" in loaded and "comparisons.plotting.terminal" in loaded
    unused = {"matplotlib", "jinja2", "scipy.stats", "scipy.optimize", "scipy.special", "rich.progress"}
    assert not loaded & {*unused, *(engine.package for engine in ENGINES.values())}


def test_all_mistakes_of_a_scene_are_told_one_a_line(rocking, tmp_path):
    path = write_scene(tmp_path, SCENE.replace("3172.05", "-1").replace("212.0", "0").replace("20.0", "nan"))
    status, out, err = rocking("run", path)
    assert status == 2 and out == "" and len(err.splitlines()) == 3
    for key in ("block.mass = -1", "base.mass = 0", "run.duration = nan"):
        assert f"{path}: {key}: " in err


def test_compiling_is_said_and_is_not_on_the_clock_of_the_run(rocking, monkeypatch):
    done = []

    @functools.cache
    def slowly(vertical=False):
        time.sleep(0.3)
        done.append("compiled")

    def apart(function, *arguments, **how):
        done.append(how["time_limit"])
        return function(*arguments), None

    monkeypatch.setattr(progress, "PATIENCE", 0.1)
    monkeypatch.setattr(solver, "compile_kernels", slowly)
    monkeypatch.setattr(guard, "run_apart", apart)
    status, _, err = rocking("run", "free-rocking-rigid", "--time-limit", "2")
    assert status == 0 and done[:2] == ["compiled", 2.0]
    assert err.splitlines()[0] == f"{progress.COMPILING}: some ten seconds" and err.count(progress.COMPILING) == 1


@pytest.mark.parametrize("command", ["run", "compare"])
def test_engine_that_is_not_installed(rocking, monkeypatch, command):
    monkeypatch.setitem(sys.modules, "mujoco", None)  # what Python does for a package that cannot be imported
    status, out, err = rocking(command, "caryatid-rigid", "--engine", "mujoco")
    assert (status, out) == (2, "")
    assert 'pip install -e ".[mujoco]" in a checkout of this project' in err and "Traceback" not in err


def test_engines_lists_what_is_there_and_what_is_not(rocking, monkeypatch):
    for name in ("mujoco", "pymunk"):
        monkeypatch.setitem(sys.modules, name, None)
    status, out, _ = rocking("engines")
    assert status == 0
    (line,) = (line for line in out.splitlines() if "mujoco" in line)
    absent = [name for name in ("dart", "drake", "mujoco", "pymunk") if name not in installed_engines()]
    assert line.startswith(f'not installed: {", ".join(absent)}; pip install -e ".[{",".join(absent)}]" in a ')
    for name in installed_engines():
        assert name in out and all(f" {variant} " in out for variant in get_engine(name).variants)


def test_an_outcome_that_hangs_on_the_last_digits_is_said(rocking, tmp_path):
    block = "[block]\nmass = 3172.05\nradius = 1.0884\nslenderness = 0.2\n[start]\ntilt = "
    for tilt, hangs in (("0.1999999999", True), ("0.199", False)):
        _, out, _ = rocking("run", write_scene(tmp_path, block + tilt), "--json", "-")
        assert hangs == any(warning["quantity"] == "outcome" for warning in json.loads(out)["warnings"])


@pytest.mark.parametrize("variant, differs", [("first-script", True), ("impact-aware", False)])
def test_a_run_that_is_off_the_analytic_model_says_so(rocking, tmp_path, variant, differs):
    file = tmp_path / "run.json"
    _, out, _ = rocking("run", "free-rocking-rigid", "--engine", "pybullet", "--variant", variant, "--json", file)
    content = json.loads(file.read_text())
    assert content["comparable"] == "yes" and ("pybullet differs from the analytic model" in out) == differs
    quantities = {difference["quantity"] for difference in content["differences"]}
    assert bool(quantities) == bool(quantities & {"restitution", "missing_impacts"}) == differs


def test_failed_run_is_told_and_has_a_status_of_its_own(rocking, monkeypatch, tmp_path):
    failure = Failure("Newton gave up", "SolverError: no convergence")
    failed = dataclasses.replace(
        simulate(load_scene("free-rocking-rigid"), history=False), engine="exudyn", outcome="failed", failure=failure
    )
    monkeypatch.setattr(command_runs, "get_engine", lambda name: SimpleNamespace(simulate=lambda scene, **_: failed))
    picture = tmp_path / "x.png"
    status, out, err = rocking("run", "free-rocking-rigid", "--engine", "exudyn", "--json", "-", "--plot", picture)
    assert status == 1 and json.loads(out)["failure"]["reason"] == "Newton gave up"
    assert "exudyn failed: Newton gave up. SolverError: no convergence" in err
    assert "there is no history to write" in err and not picture.exists()


def test_other_errors_are_not_hidden(monkeypatch):
    """In an engine an error is evidence (`test_roads`); in the model or a command it is raised."""
    monkeypatch.setattr("analytic.simulate", lambda scene, *, history: 1 / 0)
    with pytest.raises(RuntimeError, match="the analytic model raised ZeroDivisionError: division by zero\nTraceback"):
        cli.main(["run", "free-rocking-rigid"])
    monkeypatch.setattr("comparisons.commands.runs.load_scene", lambda path: 1 / 0)
    with pytest.raises(ZeroDivisionError):  # in the command: as it is
        cli.main(["run", "free-rocking-rigid"])


def test_parse_settings():
    assert command_runs.parse_settings(["a=1e-4", "b=true", "c=word", "d=x=y", 'e="1"']) == {
        "a": 1e-4,
        "b": True,
        "c": "word",
        "d": "x=y",
        "e": "1",
    }


ODD_NAMES = ("$\\frac{1$", "[/red]", "a\nb\x1b[31mc", "é 石 \udcff", "x" * 5000, "")


def named(folder, name):
    block = "[block]\nmass = 3172.05\nradius = 1.0884\nslenderness = 0.28\n[start]\ntilt = 0.1\n[run]\nduration = 0.5\n"
    head = f"name = {json.dumps(name, ensure_ascii=False)}\n".encode(errors="replace").decode()
    return write_scene(folder, head + block)


@pytest.mark.parametrize("name", ODD_NAMES)
def test_names_are_printed_and_drawn_as_they_are(rocking, tmp_path, name):
    files = [tmp_path / "r.json", tmp_path / "r.png"]
    status, out, err = rocking("run", named(tmp_path, name), "--json", files[0], "--plot", files[1])
    assert (status, err) == (0, "")
    assert readable(name.encode(errors="replace").decode(), 100)[:30].strip() in out and "\x1b" not in out
    assert files[1].stat().st_size > 1000


def test_an_engine_that_crashes_costs_its_own_row(rocking, monkeypatch):
    pytest.importorskip("pybullet")
    monkeypatch.setattr("engines.pybullet.adapter.run", lambda *_, **__: os.abort())
    status, out, err = rocking("compare", "free-rocking-rigid", "--engine", "pybullet", "--json", "-")
    first, second = json.loads(out)["responses"]
    assert status == 0 and first["outcome"] == "rocks" and second["outcome"] == "failed"
    assert "SIGABRT" in second["failure"]["message"] and "pybullet failed" in err


def test_warnings_and_undecided_outcomes_are_shown(rocking, monkeypatch, tmp_path):
    odd = dataclasses.replace(
        simulate(load_scene("free-rocking-rigid"), history=False),
        warnings=(Caution("model", "N <= 0 [at 1 s]."),),
        decided=False,
    )
    monkeypatch.setattr("comparisons.execution.command_runs._analytic", lambda *_: odd)
    for command in (("compare", "--engine", "analytic"), ("run",)):
        _, out, _ = rocking(*command, "free-rocking-rigid", "--json", tmp_path / "r.json")
        assert "undecided" in out and "(rocks so far)" in out and "Warning, analytic: N <= 0 [at 1 s]." in out
    result = json.loads((tmp_path / "r.json").read_text())
    assert [warning["text"] for warning in result["warnings"]] == ["N <= 0 [at 1 s]."] and result["decided"] is False


FREE_BASE = "Warning: No friction is modelled under the base, and it has no bearings"
ON_BASE = """
[block]
mass = 1551.83
radius = 0.989002
slenderness = 0.281772
[base]
mass = 400.0
[start]
tilt = 0.1
"""


@pytest.mark.parametrize("bearings", ["", "[bearings]\nlaw = 'linear'\nka = 2e4\n"], ids=["free", "borne"])
@pytest.mark.parametrize("command", [("run",), ("compare", "--engine", "pybullet"), ("margin",)], ids=" ".join)
def test_a_base_that_nothing_holds_is_said_first_and_once(rocking, tmp_path, command, bearings):
    file, is_free = write_scene(tmp_path, ON_BASE + bearings), not bearings
    status, out, err = rocking(command[0], file, *command[1:])
    assert status == 0 and out.startswith(FREE_BASE) == is_free and out.count("No friction is modelled") == is_free, err


CALM = 0.27  # scale at which it peaks at six tenths of uplift
SENSITIVE = "is sensitive to changes of the motion"
SENTENCE = "The outcome is sensitive to changes of the motion below 5%: the block overturns, but at -0.90% it rocks."


@pytest.mark.parametrize("scale", [CLIFF, CALM])
@pytest.mark.parametrize("command", [("run",), ("compare", "--engine", "exudyn")])
def test_what_little_of_the_motion_changes_is_said_last_and_once_and_only_where_it_is_so(
    rocking, tmp_path, command, scale
):
    file, json_file = write_scene(tmp_path, BRONZE.format(scale=scale)), tmp_path / "found.json"
    status, out, err = rocking(command[0], file, *command[1:], "--json", json_file)
    assert status == 0, err
    *_, last = (line for line in out.splitlines() if line.strip())
    assert (SENSITIVE in out) == (last == SENTENCE) == (scale == CLIFF) and out.count(SENSITIVE) < 2
    content = json.loads(json_file.read_text())
    warnings = [
        warning for warning in content.get("responses", [content])[0]["warnings"] if warning["kind"] == "motion"
    ]
    assert [(warning["quantity"], warning["limit"]) for warning in warnings] == [("outcome", 0.05)] * (scale == CLIFF)


def test_the_version_is_that_of_the_installation(rocking):
    status, out, err = rocking("--version")
    project = tomllib.loads((PROJECT_FOLDER / "pyproject.toml").read_text())["project"]
    assert (status, out.strip(), err) == (0, project["version"], "")
    assert rocking("--version", "run")[0] == 0


def test_help_shows_every_command_in_one_group_with_a_line_and_an_example(rocking):
    group, (_, out, _) = typer.main.get_command(app), rocking("--help")
    assert sorted(name for names in commands.GROUPS.values() for name in names) == group.list_commands(None)
    places = [out.index(f"{title}:") for title in commands.GROUPS]
    assert places == sorted(places)
    for name in group.list_commands(None):
        status, out, _ = rocking(name, "--help")
        assert status == 0 and f"Example: rocking {name}" in " ".join(out.split())


@pytest.mark.parametrize("words", [(), ("study",), ("lessons",)], ids=" ".join)
def test_no_line_of_a_list_of_commands_is_cut_at_80_columns(rocking, monkeypatch, words):
    monkeypatch.setenv("COLUMNS", "80")
    group, out = typer.main.get_command(app), rocking(*words, "--help")[1]
    for word in words:
        group = group.get_command(None, word)
    for name in group.list_commands(None):
        line = group.get_command(None, name).get_short_help_str(1000)
        assert 8 < len(line) <= commands.SHORT and line.endswith("."), (name, line)
        assert any(shown.split() == [name, *line.split()] for shown in out.splitlines()), (name, out)
    assert "..." not in out.partition(":\n")[2]


BUST = ("--height", 1.9, "--width", 0.55, "--material", "marble")
DESIGN = ("--base-mass", 400, "--period", 2.5, "--xmax", 0.2)
CONSTANTS = ("--base-mass", 400, "--ka", 3e4, "--kb", 3e3, "--alpha", 50)
RECORD = ("--record", "own.csv")
NEW = {
    "rigid, synthetic": BUST,
    "by design, record": (*BUST, *DESIGN, *RECORD),
    "by constants, tilted": (*BUST, *CONSTANTS, "--xmax", 0.3, "--tilt", 0.15),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Holds a record: a second and a half of noise at 50 Hz, 0.4 g."""
    made = tmp_path_factory.mktemp("scenes")
    noise = np.random.default_rng(7).normal(size=75)
    rows = [f"{0.02 * k:.2f},{4.0 * value / np.abs(noise).max():.5f}" for k, value in enumerate(noise)]
    (made / "own.csv").write_text("time [s],acc [m/s2]\n" + "\n".join(rows) + "\n")
    return made


@pytest.mark.parametrize("words", NEW.values(), ids=NEW)
def test_what_new_writes_is_run(rocking, folder, monkeypatch, words):
    monkeypatch.chdir(folder)
    assert rocking("new", "own.toml", *words)[0] == 0
    status, out, err = rocking("run", "own.toml", "--json", "-")
    (folder / "own.toml").unlink()
    assert status == 0 and json.loads(out)["outcome"] in ("stands", "rocks", "overturns"), err


BEARINGS = "[base]\nmass = 50.0\n[bearings]\nlaw = 'linear'\nka = 2000.0\n"  # (7): .81906; on the ground .90819


@pytest.mark.parametrize(
    "engine, ground, given, kept",
    [
        ("exudyn", "", 0.9, True),
        ("exudyn", BEARINGS, 0.75, True),
        ("pybullet", "", 0.9, True),
        ("drake", "", 0.9, False),
    ],
)
def test_a_restitution_that_is_given_is_kept_by_the_engine_or_costs_its_row(
    rocking, tmp_path, engine, ground, given, kept
):
    file = tmp_path / "given.toml"
    block = f"[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\nrestitution = {given}\n"
    file.write_text(block + ground + "[start]\ntilt = 0.1\n[run]\nduration = 2.0\n")
    status, out, err = rocking("compare", file, "--engine", engine, "--json", "-", "--plot", tmp_path / "c.png")
    model, result = json.loads(out)["responses"]
    assert status == 0 and model["outcome"] == "rocks" and (tmp_path / "c.png").read_bytes().startswith(PNG)
    ratios = [impact["rate_after"] / impact["rate_before"] for impact in result["impacts"][:2]]
    if kept:
        assert ratios == pytest.approx([given] * 2, rel=1e-3)
        assert not result["differences"] and "restitution given" in result["warnings"][-1]["text"]
    else:
        assert f"block.restitution = {given}" in result["failure"]["message"] and f"{engine} failed" in err


@pytest.mark.parametrize("start, kinds", [("", []), ("base_velocity = 0.2\n", ["model"])])
def test_a_base_that_nothing_moves_slides_nowhere(rocking, tmp_path, start, kinds):
    """Review A12: it was said to slide on at -4e-15 m/s."""
    block = "[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\n[base]\nmass = 50.0\n[start]\ntilt = 0.1\n"
    (tmp_path / "base.toml").write_text(block + start)
    base, *warnings = json.loads(rocking("run", tmp_path / "base.toml", "--json", "-")[1])["warnings"]
    assert base["text"].startswith("No friction is modelled under the base")
    assert [warning["kind"] for warning in warnings] == kinds and all(
        "slides on at" in warning["text"] for warning in warnings
    )
