"""No import of an engine prints, in this process or in a worker; and nothing else is kept from standard error."""

import os
import subprocess
import sys
import threading

import pytest

from engines import get_engine, installed_engines
from engines.greeting import without

PROGRAM = """
from analytic import Block, Scene, Start
from comparisons.running.cases import Case
from comparisons.running.executors import Processes
from comparisons.running.sweep import run_sweep
from comparisons.report.runs import impacts_only
from engines import installed_engines

if __name__ == "__main__":
    scene = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.2), start=Start(tilt=0.1), duration=0.1)
    names = installed_engines()
    with Processes(1, names) as pool:
        run_sweep([Case(scene, name) for name in names], measure=impacts_only, executor=pool, store={store!r},
                  progress=False)
"""


def printed(program):
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


@pytest.mark.parametrize("name", installed_engines())
def test_importing_an_engine_prints_nothing(tmp_path, name):
    module = get_engine(name).adapter
    for text in (f"from engines import get_engine\nget_engine({name!r})\n", f"import {module}\n"):
        (tmp_path / "program.py").write_text(text)
        assert printed(tmp_path / "program.py") == ""


def test_no_worker_prints_a_greeting(tmp_path):
    (tmp_path / "program.py").write_text(PROGRAM.format(store=str(tmp_path / "runs.jsonl")))
    assert "build time" not in printed(tmp_path / "program.py")


def test_what_else_is_printed_comes_whole(capfd):
    def speak():
        for number in range(500):
            os.write(2, b"line %d\n" % number)

    speaker = threading.Thread(target=speak)
    with without(b"hello "):
        speaker.start()
        os.write(2, b"hello world\nhelp\n")
        speaker.join()
        print("from Python", file=sys.stderr, flush=True)
    out, err = capfd.readouterr()
    assert out == "" and sorted(err.splitlines()) == sorted(
        ["help", "from Python", *(f"line {number}" for number in range(500))]
    )


def test_an_error_inside_passes_with_what_was_said(capfd):
    with pytest.raises(ImportError), without(b"hello "):
        os.write(2, b"hello\nno such symbol\n")
        raise ImportError
    os.write(2, b"after\n")
    assert capfd.readouterr().err == "hello\nno such symbol\nafter\n"


def test_without_a_standard_error_it_is_as_usual():
    program = "import os\nfrom engines.greeting import without\nos.close(2)\nwith without(b'x'):\n    y = 1\nassert y"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0
