"""The command line in bad places and with bad words: one message, a status, never a traceback; and when it is stopped.

A record of what once broke: names of others are printed as they are, results are not lost to a full disk.
"""

import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from bad_scenes import SCENE

from comparisons.running.files import check_writable
from comparisons.running.readable import readable
from comparisons.running.store import Store
from comparisons.showing.plots import draw_histories, save
from engines import get_engine, installed_engines

QUICK = ("run", "free-rocking-rigid")
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


def started(*arguments, **options):
    return subprocess.Popen(
        [sys.executable, "-m", "comparisons", *map(str, arguments)],
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        **options,
    )


ENDLESS = """
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[base]
mass = 212.0
[bearings]
law = "linear"
count = 4
ka = 2e4
[start]
base_displacement = 0.2
[run]
duration = 1e7
"""


def scene_file(folder, name="scene", change=lambda text: text):
    path = folder / "scene.toml"
    text = re.sub(r"(?m)^name = .*\n", "", SCENE).replace("20.0", "0.5")
    path.write_text(f"name = {json.dumps(name, ensure_ascii=False)}\n" + change(text), errors="replace")
    return path


def endless(folder):
    """A scene that takes minutes: on bearings without loss the block lifts again and again."""
    path = folder / "scene.toml"
    path.write_text(ENDLESS)
    return path


def told(status, out, err):
    """One message of a mistake and nothing else."""
    return status == 2 and out == "" and err.startswith("Error: ") and err.count("\n") == 1 and len(err) < 800


@pytest.mark.parametrize("name", ODD_NAMES)
def test_names_are_printed_and_drawn_as_they_are(rocking, tmp_path, name):
    files = [tmp_path / "r.json", tmp_path / "r.png"]
    status, out, err = rocking("run", scene_file(tmp_path, name), "--json", files[0], "--plot", files[1])
    assert (status, err) == (0, "")
    assert readable(name.encode(errors="replace").decode(), 100)[:30].strip() in out and "\x1b" not in out
    assert files[1].stat().st_size > 1000


def test_the_file_of_a_figure_bears_the_name_literally(tmp_path):
    from analytic import load_scene, simulate

    scene = load_scene("caryatid-rigid").with_(name="$m_b$ [x]", duration=0.5)
    figure = draw_histories(scene, [simulate(scene)])
    save(figure, tmp_path / "x.svg")
    assert figure._suptitle.get_text() == "$m_b$ [x]" and not figure._suptitle.get_parse_math()


@pytest.mark.parametrize("option", ["--json", "--csv"])
def test_places_where_nothing_can_be_written_are_refused_before_the_run(rocking, tmp_path, monkeypatch, option):
    monkeypatch.setattr("comparisons.commands.run.simulate", lambda *_, **__: pytest.fail("it ran"))
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "file").write_text("")
    for place in (
        tmp_path,
        tmp_path / "fifo",
        "/dev/full",
        "/dev/null",
        "/dev/tty",
        "/proc/x.json",
        "a\0b",
        tmp_path / ("x" * 300),
        tmp_path / "file" / "x.json",
        tmp_path / "none" / "x.json",
        "",
    ):
        assert told(*rocking(*QUICK, option, place)), place
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fifo", "file"]  # nothing left of the trials


def test_a_result_does_not_overwrite_what_is_read_nor_another_result(rocking, tmp_path):
    scene = scene_file(tmp_path)
    before = scene.read_text()
    assert told(*rocking("run", scene, "--json", scene))
    assert told(*rocking("run", scene, "--json", tmp_path / "a", "--csv", tmp_path / "." / "a"))
    assert scene.read_text() == before


@pytest.mark.parametrize(
    "command", [("report",), ("study", "fragility"), ("study", "restitution"), ("study", "kernel")]
)
def test_folders_where_nothing_can_be_written_are_refused_before_the_work(rocking, tmp_path, command):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "file").write_text("")
    for place in ("/proc/x", "/dev/full", tmp_path / "fifo", tmp_path / "file" / "x", "a\0b", tmp_path / ("x" * 300)):
        assert told(*rocking(*command, "--output", place)), place


def test_a_disk_that_is_full_after_the_run_costs_no_result(rocking, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    check_writable([str(tmp_path / "r.json")])
    monkeypatch.setattr("comparisons.running.files.os.replace", full)
    status, out, err = rocking(*QUICK, "--json", tmp_path / "r.json", "--csv", tmp_path / "r.csv")
    assert status == 2 and "outcome" in out  # the table is printed all the same
    kept = [Path(part.split("the result is in ")[1]) for part in err.strip().split("; ") if "the result is in" in part]
    assert [path.suffix for path in kept] == [".json", ".csv"] and list(tmp_path.iterdir()) == []
    assert json.loads(kept[0].read_text())["outcome"] == "rocks"
    for path in kept:
        path.unlink()


def test_standard_output_that_is_full_closed_or_not_read(tmp_path):
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "comparisons", *QUICK, "--json", "-"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
    (kept,) = tmp_path.glob("*.json")
    assert told(done.returncode, "", done.stderr) and str(kept) in done.stderr
    assert json.loads(kept.read_text())["outcome"] == "rocks"
    for shell, status, words in ((">&-", 2, "standard output"), ("| true", 1, ""), (">&- 2>&-", 2, "")):
        command = f"{sys.executable} -m comparisons {' '.join(QUICK)} --json - {shell}; exit ${{PIPESTATUS[0]}}"
        done = subprocess.run(["bash", "-c", command], stderr=subprocess.PIPE, text=True, env=environment)
        assert done.returncode == status and words in done.stderr and "Traceback" not in done.stderr
        assert words or not done.stderr


def test_names_the_terminal_cannot_show(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "comparisons", "run", str(scene_file(tmp_path, "石"))],
        text=True,
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert done.returncode == 0 and "\\u77f3" in done.stdout


@pytest.mark.parametrize(
    "value", ["1e400", "-1e400", "NaN", "nan", "1" * 400, "1" * 5000, "[" * 50000, "{}", "null", '"1"', "", "1e-400"]
)
def test_absurd_settings(rocking, value):
    for solver, name in (("analytic", "tolerance"), ("exudyn", ""), ("pybullet", "")):
        if solver != "analytic":
            if solver not in installed_engines():  # also loads them, once
                continue
            name = next(iter(vars(get_engine(solver).variants[get_engine(solver).default_variant].settings)))
        assert told(*rocking(*QUICK, "--engine", solver, "--set", f"{name}={value}")), (solver, name)


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "inf", "1e400", "1e300"])
def test_absurd_time_limits(rocking, seconds):
    assert told(*rocking(*QUICK, "--time-limit", seconds))


def test_the_time_limit_costs_the_run_alone(rocking, tmp_path):
    scene = endless(tmp_path)
    status, out, err = rocking("run", scene, "--time-limit", "1", "--json", "-")
    assert status == 1 and json.loads(out)["failure"]["reason"] == "the run did not end in time"
    assert "killed after the time limit of 1 s; --time-limit allows more" in err and err.count("\n") == 1


def crash(*_, **__):
    os.abort()


def test_an_engine_that_crashes_costs_its_own_row(rocking, monkeypatch):
    pytest.importorskip("pybullet")
    monkeypatch.setattr("engines.pybullet.adapter.run", crash)
    status, out, err = rocking("compare", "free-rocking-rigid", "--engine", "pybullet", "--json", "-")
    first, second = json.loads(out)["responses"]
    assert status == 0 and first["outcome"] == "rocks" and second["outcome"] == "failed"
    assert "SIGABRT" in second["failure"]["message"] and "pybullet failed" in err
    status, out, _ = rocking("compare", "free-rocking-rigid", "--engine", "pybullet")
    assert status == 0 and "failed" in out


def test_warnings_and_undecided_outcomes_are_shown(rocking, monkeypatch, tmp_path):
    import dataclasses

    from analytic import Caution, simulate

    odder = Caution("model", "N <= 0 [at 1 s].")

    def odd(scene, **_):
        return dataclasses.replace(simulate(scene, history=False), warnings=(odder,), decided=False)

    monkeypatch.setattr("comparisons.running.solving._analytic", lambda scene, *_: odd(scene))
    _, out, _ = rocking(*QUICK)
    assert "undecided (rocks so far)" in out and "Warning, analytic: N <= 0 [at 1 s]." in out
    _, out, _ = rocking("compare", "free-rocking-rigid", "--engine", "analytic")
    assert "undecided" in out and "(rocks so far)" in out and "Warning, analytic: N <= 0 [at 1 s]." in out
    result = json.loads(rocking(*QUICK, "--json", "-")[1])
    assert [one["text"] for one in result["warnings"]] == ["N <= 0 [at 1 s]."] and result["decided"] is False


def test_a_store_that_is_damaged_in_use_or_no_file(rocking, tmp_path):
    def study():
        return rocking("study", "fragility", "--quick", "--output", tmp_path)

    path = tmp_path / "runs.jsonl"
    for damage in (b"not json\n", b"[]\n", b"\xff\xfe\n", b"[" * 100000 + b"\n", b'{"key": []}\n'):
        path.write_bytes(damage)
        assert told(*study()), damage[:20]
    path.unlink()
    with Store(path):
        assert told(*study())
    path.unlink()
    path.mkdir()
    assert told(*study())
    path.rmdir()
    os.mkfifo(path)
    assert told(*study())
    for wrong in (["--workers", "1000000"], ["--engine", "nope"], ["--engine", "analytic"]):
        assert told(*rocking("study", "fragility", "--quick", "--output", tmp_path / "new", *wrong)), wrong
    assert not (tmp_path / "new").exists()


def hears(process, seconds=60):
    """Seconds until a process that was told to stop has ended, and those it had started that live on."""
    family = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all of them
    began = time.monotonic()
    process.wait(seconds)
    return time.monotonic() - began, psutil.wait_procs(family, timeout=5)[1]


@pytest.mark.parametrize("command", ["run", "compare"])
def test_ctrl_c_in_the_kernel(tmp_path, command):
    scene = endless(tmp_path)
    process = started(command, scene, "--json", tmp_path / "r.json")
    deadline = time.monotonic() + 100
    while not psutil.Process(process.pid).children() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(1.0)
    seconds, alive = hears(process)
    out, err = process.communicate()
    assert (process.returncode, out, err) == (130, "", "Interrupted.\n")
    assert seconds < 3 and not alive  # 0.2 s where the machine has nothing else to do
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


KERNEL_HERE = """
import sys
from comparisons import cli
from analytic import Block, Scene, Start, simulate
import comparisons.commands.engines as stand_in
def command():
    print("begins", flush=True)
    simulate(Scene(block=Block(mass=3172.05, radius=1.0884, slenderness=0.28), base={"mass": 212.0},
                   bearings={"law": "linear", "count": 4, "ka": 2e4}, start=Start(base_displacement=0.2), duration=1e7))
stand_in.command = command
cli.main(["engines"])
"""


@pytest.mark.parametrize(
    "number, status, words", [(signal.SIGINT, 130, "Interrupted.\n"), (signal.SIGTERM, 143, "Ended by SIGTERM.\n")]
)
def test_signals_while_this_process_itself_is_in_the_kernel(number, status, words):
    process = subprocess.Popen(
        [sys.executable, "-c", KERNEL_HERE], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begins\n"
    time.sleep(5.0)
    assert process.poll() is None
    process.send_signal(number)
    began = time.monotonic()
    process.wait(60)
    assert time.monotonic() - began < 3
    assert (process.returncode, process.stderr.read()) == (status, words)


def test_an_interrupted_study_resumes(tmp_path):
    process = started("study", "restitution", "--quick", "--output", tmp_path)
    store, deadline = tmp_path / "runs.jsonl", time.monotonic() + 120
    while time.monotonic() < deadline and not (store.exists() and store.read_bytes().count(b"\n") > 5):
        time.sleep(0.05)
    seconds, alive = hears(process)
    assert process.returncode == 130 and seconds < 3 and not alive
    assert "Traceback" not in process.stderr.read()
    with Store(store) as opened:
        assert len(opened) > 5 and not opened.torn
        assert not any("Interrupt" in json.dumps(row["failure"]) for row in opened.rows.values())


WORDS = (
    "",
    "-",
    "--",
    "x",
    "run",
    "[/b]",
    "$x$",
    "é",
    "\0",
    "nan",
    "1e400",
    "-1",
    "9" * 5000,
    "a" * 300,
    "a/" * 3000,
    "--json",
    "--csv",
    "--plot",
    "--set",
    "--engine",
    "--time-limit",
    "--output",
    "--record",
    "--units",
    "--variant",
    "step=1e400",
    "tolerance=nan",
    "=",
    "tolerance=1e-3",
    "exudyn",
    "analytic",
    ".",
    "/",
    "/dev/full",
    "/dev/tty",
    "/proc/self/mem",
    "/proc/x.png",
    "x.png",
    "no/x.json",
    "--help",
    "\udcff",
    "--quick",
)
COMMANDS = (
    ["run"],
    ["run", "free-rocking-rigid"],
    ["compare"],
    ["compare", "free-rocking-rigid"],
    ["design"],
    ["design", "--period", "2", "--damping", "0.3", "--xmax", "0.3"],
    ["engines", "x"],
    ["report", "--output"],
    ["report", "--record"],
    ["study"],
    ["study", "fragility", "--workers"],
    ["study", "overturning", "--output"],
    ["study", "kernel", "--output"],
    [],
)
DESIGN = ("--period", "--damping", "--xmax", "--mass", "--count", "--ratio", "--definition")


def test_no_combination_of_bad_words_and_places_ends_in_a_traceback(rocking, tmp_path, monkeypatch):
    """Seeded. What would start real work is cut short: the words are under test here."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("comparisons.report.study.make_results", lambda *_, **__: None)
    monkeypatch.setattr("engines.ENGINES", {})  # runs of the analytic model alone
    draw, seen = random.Random(20261121), set()
    for _ in range(300):
        command = draw.choice(COMMANDS)
        words = WORDS + DESIGN if command[:1] == ["design"] else WORDS
        if command[:2] == ["report", "--output"] or command[:1] == ["study"]:
            arguments = [*command, draw.choice(["/proc/x", "/dev/full", "\0", "a" * 300, "a/" * 3000, ""])]
        else:
            arguments = [*command, *draw.choices(words, k=draw.randrange(1, 4))]
        status, out, err = rocking(*arguments)
        assert status in (0, 1, 2), arguments
        assert "Traceback" not in out + err and len(err) < 3000, arguments
        assert status != 2 or err, arguments
        seen.add(status)
    assert seen >= {0, 2}
