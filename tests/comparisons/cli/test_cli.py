"""The command line, called as a user calls it: in this process where that is enough, else in a new one."""

import csv
import dataclasses
import functools
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from bad_scenes import SCENE, write_scene
from engine_cases import accurate, needs

from analytic import Caution, Failure, load_scene, simulate, solver
from comparisons import cli
from comparisons.running import solving
from comparisons.running.readable import readable
from comparisons.showing.plots import draw_histories, save
from engines import ENGINES, get_engine, installed_engines

PNG = b"\x89PNG\r\n"


def test_run_writes_json_csv_and_plot(rocking, tmp_path):
    files = [tmp_path / name for name in ("r.json", "r.csv", "r.png")]
    status, out, _ = rocking("run", "free-rocking-isolated", "--json", files[0], "--csv", files[1], "--plot", files[2])
    assert status == 0
    assert "Free rocking on the isolated base" in out and "peak base displacement [m]" in out
    result = json.loads(files[0].read_text())
    expected = simulate(load_scene("free-rocking-isolated"))
    assert result["outcome"] == "rocks"
    assert result["impact_count"] == len(result["impacts"]) == expected.impact_count
    assert result["peak_base_displacement"] == expected.peak_base_displacement
    with files[1].open() as file:
        rows = list(csv.reader(file))
    assert ",".join(rows[0]) == (
        "time,tilt,tilt_rate,base_displacement,base_velocity,bearing_force,ground_acceleration"
    )
    assert len(rows) - 1 == len(expected.history.time)
    assert float(rows[-1][3]) == expected.history.base_displacement[-1]
    assert files[2].read_bytes().startswith(PNG)


@pytest.mark.parametrize("engine", ENGINES)
def test_json_of_an_engine_is_alone_too(engine):
    """In a new process: an engine may greet when it is loaded, or when C flushes its buffers at exit."""
    if engine not in installed_engines():
        pytest.skip(f"{engine} is not installed")
    done = subprocess.run(
        [sys.executable, "-m", "comparisons", "run", "free-rocking-rigid", "--engine", engine, "--json", "-"],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert json.loads(done.stdout)["engine"] == engine
    assert done.returncode == 0, done.stderr


def test_module_and_status_in_a_new_process(tmp_path):
    path = write_scene(tmp_path, SCENE.replace("3172.05", "-1"))
    done = subprocess.run(
        [sys.executable, "-m", "comparisons", "run", str(path)], capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"Error: {path}: block.mass = -1: out of range; give a number above 0 [kg]\n"


def test_all_mistakes_of_a_scene_are_told_one_a_line(rocking, tmp_path):
    path = write_scene(tmp_path, SCENE.replace("3172.05", "-1").replace("212.0", "0").replace("20.0", "nan"))
    status, out, err = rocking("run", path)
    assert status == 2 and out == "" and len(err.splitlines()) == 3
    for key in ("block.mass = -1", "base.mass = 0", "run.duration = nan"):
        assert f"{path}: {key}: " in err


def test_compiling_is_said_and_is_not_on_the_clock_of_the_run(rocking, monkeypatch):
    @functools.cache
    def slowly(vertical=False):
        time.sleep(2.0)

    monkeypatch.setattr(solving, "PATIENCE", 0.1)
    monkeypatch.setattr(solver, "compile_kernels", slowly)
    status, out, err = rocking("run", "free-rocking-rigid", "--time-limit", "2", "--json", "-")
    assert status == 0 and json.loads(out)["cpu_seconds"] < 1.0
    assert err == "compiling the analytic model: half a minute, once on this machine\n"


def test_setting_reaches_the_solver(rocking):
    _, out, _ = rocking("run", "free-rocking-rigid", "--set", "tolerance=1e-6", "--json", "-")
    assert json.loads(out)["settings"]["tolerance"] == 1e-6


@pytest.mark.parametrize(
    "command", [["run", "caryatid-rigid", "--engine", "mujoco"], ["compare", "caryatid-rigid", "--engine", "mujoco"]]
)
def test_engine_that_is_not_installed(rocking, monkeypatch, command):
    monkeypatch.setitem(sys.modules, "mujoco", None)  # what Python does for a package that cannot be imported
    status, out, err = rocking(*command)
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
    assert max(map(len, out.splitlines()[:-1])) <= 80 and "slenderness 0.1 to 0.5 rad" in " ".join(out.split())
    for name in installed_engines():
        assert name in out and all(f" {variant} " in out for variant in get_engine(name).variants)


@pytest.mark.parametrize("name", installed_engines())
def test_engines_with_a_name_tells_all_of_it(rocking, name):
    engine, (status, out, _) = get_engine(name), rocking("engines", name)
    assert status == 0 and f"{name} (" in out and f"--variant {engine.default_variant} (default, " in out
    for variant, one in engine.variants.items():
        assert f"--variant {variant} (" in out and one.tier in out
        assert f"the engine computes: {one.computes}" in out and f"the adapter imposes: {one.imposes}" in out
        assert all(f"{setting}=" in out for setting in vars(one.settings))
        assert f"{one.knob}={one.default:g} (accuracy parameter)" in out
        assert f"fine: {', '.join(f'{value:.4g}' for value in one.ladder)}\n" in out


def test_compare(rocking, tmp_path):
    picture, result = tmp_path / "c.png", tmp_path / "c.json"
    status, out, _ = rocking("compare", "free-rocking-rigid", "--plot", picture, "--json", result)
    assert status == 0
    content = json.loads(result.read_text())
    names = [response["engine"] for response in content["responses"]]
    tuned = [name for name in installed_engines() if accurate(name, get_engine(name).default_variant)]
    told = [content["sensitivity"][name] for name in tuned]  # free rocking forgets its past
    assert all(one["horizon"] is None and 0 < one["perturbation"] < 1e-2 for one in told)
    assert tuple(content["sensitivity"]) == tuple(installed_engines())
    assert names == ["analytic", *installed_engines()]
    assert all(name in out for name in names)
    assert picture.read_bytes().startswith(PNG)


def test_comparison_table_fits_a_terminal(rocking):
    _, out, _ = rocking("compare", "caryatid-rigid")
    table = out.partition("differs from the analytic model")[0]
    assert max(len(line) for line in table.splitlines()) <= 80
    assert "…" not in out


def test_an_outcome_that_hangs_on_the_last_digits_is_said(rocking, tmp_path):
    block = "[block]\nmass = 3172.05\nradius = 1.0884\nslenderness = 0.2\n[start]\ntilt = "
    for tilt, hangs in (("0.1999999999", True), ("0.199", False)):
        _, out, _ = rocking("run", write_scene(tmp_path, block + tilt), "--json", "-")
        assert hangs == any(one["quantity"] == "outcome" for one in json.loads(out)["warnings"])


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
@pytest.mark.parametrize("variant, said", [("first-script", True), ("impact-aware", False)])
def test_a_run_that_is_off_the_analytic_model_says_so(rocking, engine, variant, said):
    needs(engine)
    _, out, _ = rocking("run", "free-rocking-rigid", "--engine", engine, "--variant", variant, "--json", "-")
    told = json.loads(out)
    assert told["comparable"] == "yes" and bool(told["differences"]) == said
    if said:
        assert {one["quantity"] for one in told["differences"]} & {"restitution", "missing_impacts"}
        _, out, _ = rocking("run", "free-rocking-rigid", "--engine", engine, "--variant", variant)
        assert f"{engine} differs from the analytic model" in out


def test_failed_run_is_told_and_has_a_status_of_its_own(rocking, monkeypatch, tmp_path):
    failure = Failure("Newton gave up", "SolverError: no convergence")
    failed = dataclasses.replace(
        simulate(load_scene("free-rocking-rigid"), history=False), engine="exudyn", outcome="failed", failure=failure
    )
    broken = SimpleNamespace(variants={}, default_variant=None, simulate=lambda scene, **_: failed)
    monkeypatch.setattr("engines.get_engine", lambda name: broken)
    status, out, err = rocking("run", "free-rocking-rigid", "--engine", "exudyn", "--json", "-")
    assert status == 1
    assert json.loads(out)["failure"]["reason"] == "Newton gave up"
    assert "exudyn failed: Newton gave up. SolverError: no convergence" in err
    status, _, err = rocking("run", "free-rocking-rigid", "--engine", "exudyn", "--plot", tmp_path / "x.png")
    assert status == 1 and "there is no history to write" in err and not (tmp_path / "x.png").exists()


def test_other_errors_are_not_hidden(rocking, monkeypatch):
    monkeypatch.setattr("analytic.simulate", lambda scene, *, history: 1 / 0)
    status, out, err = rocking("run", "free-rocking-rigid", "--json", "-")  # in the solver: evidence
    assert status == 1 and "ZeroDivisionError: division by zero" in err
    assert "Traceback" in json.loads(out)["failure"]["message"]
    monkeypatch.setattr("analytic.scene_file.load_scene", lambda path: 1 / 0)
    with pytest.raises(ZeroDivisionError):  # in the command: as it is
        cli.main(["run", "free-rocking-rigid"])


def test_parse_settings():
    assert solving.parse_settings(["a=1e-4", "b=true", "c=word", "d=x=y", 'e="1"']) == {
        "a": 1e-4,
        "b": True,
        "c": "word",
        "d": "x=y",
        "e": "1",
    }


def test_help_loads_no_engine_and_no_plots():
    code = (
        "import sys; from comparisons import cli\n"
        "try: cli.main(['--help'])\n"
        "except SystemExit: pass\n"
        "names = ('exudyn', 'pybullet', 'mujoco', 'pymunk', 'dartpy', 'pydrake', 'matplotlib')\n"
        "heavy = [name for name in names if name in sys.modules]\n"
        "sys.exit(f'loaded: {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    for name in ("run", "compare", "engines"):
        assert f"  {name} " in done.stdout


def test_entry_point_is_the_one_installed():
    assert 'rocking = "comparisons.cli:main"' in (Path(__file__).parents[3] / "pyproject.toml").read_text()


ODD_NAMES = (
    "$x_$",
    "$\\frac{1$",
    "[/red]",
    "[bold]b[/bold]",
    "a\nb\x1b[31mc",
    "é 石 \udcff",
    "%s {0} \\",
    "x" * 5000,
    "",
)


def named(folder, name):
    path = folder / "scene.toml"
    block = "[block]\nmass = 3172.05\nradius = 1.0884\nslenderness = 0.28\n[start]\ntilt = 0.1\n[run]\nduration = 0.5\n"
    path.write_text(f"name = {json.dumps(name, ensure_ascii=False)}\n" + block, errors="replace")
    return path


@pytest.mark.parametrize("name", ODD_NAMES)
def test_names_are_printed_and_drawn_as_they_are(rocking, tmp_path, name):
    files = [tmp_path / "r.json", tmp_path / "r.png"]
    status, out, err = rocking("run", named(tmp_path, name), "--json", files[0], "--plot", files[1])
    assert (status, err) == (0, "")
    assert readable(name.encode(errors="replace").decode(), 100)[:30].strip() in out and "\x1b" not in out
    assert files[1].stat().st_size > 1000


def test_the_file_of_a_figure_bears_the_name_literally(tmp_path):
    scene = load_scene("caryatid-rigid").with_(name="$m_b$ [x]", duration=0.5)
    figure = draw_histories(scene, [simulate(scene)])
    save(figure, tmp_path / "x.svg")
    assert figure._suptitle.get_text() == "$m_b$ [x]" and not figure._suptitle.get_parse_math()


def test_names_the_terminal_cannot_show(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "comparisons", "run", str(named(tmp_path, "石"))],
        text=True,
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert done.returncode == 0 and "\\u77f3" in done.stdout


def test_an_engine_that_crashes_costs_its_own_row(rocking, monkeypatch):
    pytest.importorskip("pybullet")
    monkeypatch.setattr("engines.pybullet.adapter.run", lambda *_, **__: os.abort())
    status, out, err = rocking("compare", "free-rocking-rigid", "--engine", "pybullet", "--json", "-")
    first, second = json.loads(out)["responses"]
    assert status == 0 and first["outcome"] == "rocks" and second["outcome"] == "failed"
    assert "SIGABRT" in second["failure"]["message"] and "pybullet failed" in err
    status, out, _ = rocking("compare", "free-rocking-rigid", "--engine", "pybullet")
    assert status == 0 and "failed" in out


def test_warnings_and_undecided_outcomes_are_shown(rocking, monkeypatch, tmp_path):
    odder = Caution("model", "N <= 0 [at 1 s].")

    def odd(scene, **_):
        return dataclasses.replace(simulate(scene, history=False), warnings=(odder,), decided=False)

    monkeypatch.setattr("comparisons.running.solving._analytic", lambda scene, *_: odd(scene))
    _, out, _ = rocking("run", "free-rocking-rigid")
    assert "undecided (rocks so far)" in out and "Warning, analytic: N <= 0 [at 1 s]." in out
    _, out, _ = rocking("compare", "free-rocking-rigid", "--engine", "analytic")
    assert "undecided" in out and "(rocks so far)" in out and "Warning, analytic: N <= 0 [at 1 s]." in out
    result = json.loads(rocking("run", "free-rocking-rigid", "--json", "-")[1])
    assert [one["text"] for one in result["warnings"]] == ["N <= 0 [at 1 s]."] and result["decided"] is False
