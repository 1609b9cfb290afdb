"""What is said while something runs: lines where nobody sees a bar; of the model's compiling, how many functions so
far, of about how many."""

import contextlib
import os
import re
import subprocess
import sys
import time

import pytest
from numba import njit

from comparisons.execution import progress
from comparisons.execution.progress import Counted
from comparisons.execution.results import PROJECT_FOLDER

COUNTED = re.compile(r"(\d+) of about (\d+) functions")


def compiled(name, module):
    """Compile a function of this name and module, and return what it gives."""

    def function(x):
        return x + 1

    function.__name__, function.__module__ = name, module
    return njit(function)(1)


def test_functions_of_the_model_are_counted_as_they_are_compiled(monkeypatch):
    shown, known = [], Counted().known

    @contextlib.contextmanager
    def bar(text, functions):
        shown.append((text, functions))
        yield lambda done, known: shown.append((done, known))

    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    monkeypatch.setattr(progress, "bar", bar)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with progress.compiling():
        while not shown:
            time.sleep(0.01)  # the bar is shown from another thread
        for name, module in (("first", "analytic.made"), ("other", "somewhere.analytic"), ("second", "analytic.made")):
            compiled(name, module)
    compiled("third", "analytic.made")  # nobody listens any more
    assert shown == [(progress.COMPILING, known), (0, known), *((k, max(k, known)) for k in (1, 2))]


def test_the_bar_shows_the_count_and_goes_beyond_what_was_known(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich takes standard error for a terminal
    with progress.bar(progress.COMPILING, 3) as tell:
        tell(2, 3)
    assert "2 of about 3 functions" in capsys.readouterr().err


@pytest.mark.parametrize("patience, end", [(0.0, "records\x1b[0m: done in 0 s\n"), (100.0, "")])
def test_a_bar_where_no_terminal_is_is_a_line_and_one_at_its_end_if_that_takes_long(capsys, monkeypatch, patience, end):
    monkeypatch.setattr(progress, "PATIENCE", patience)
    with progress.bar("records\x1b[0m") as tell:
        begun = capsys.readouterr().err
        tell(1, 2)
    assert (begun, capsys.readouterr().err) == ("records\\x1b[0m\n", end.replace("\x1b", "\\x1b"))
    with pytest.raises(KeyboardInterrupt), progress.bar("records"):
        raise KeyboardInterrupt
    assert capsys.readouterr().err == "records\n"  # it is not done


@pytest.mark.parametrize("patience, line", [(0.0, "one scene\n"), (100.0, "")])
def test_a_spinner_where_no_terminal_is_is_a_line_if_it_takes_long(capsys, monkeypatch, patience, line):
    monkeypatch.setattr(progress, "PATIENCE", patience)
    with progress.spinner("one scene") as tell:
        tell("its margin")
        time.sleep(0.2)  # the line is said from another thread
    assert capsys.readouterr().err == line


@pytest.mark.long
@pytest.mark.timeout(600)
def test_the_first_run_on_a_machine_counts_what_it_compiles(tmp_path):
    pty = pytest.importorskip("pty")
    whole, terminal = pty.openpty()
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "TERM": "xterm", "COLUMNS": "120"}
    words = [sys.executable, "-m", "comparisons", "run", "free-rocking-rigid"]
    with subprocess.Popen(words, cwd=PROJECT_FOLDER, env=environment, stdout=terminal, stderr=terminal) as run:
        os.close(terminal)
        text = ""
        with contextlib.suppress(OSError):  # the terminal ends with the run
            while data := os.read(whole, 65536):
                text += data.decode(errors="replace")
    assert run.returncode == 0
    results = [(int(done), int(known)) for done, known in COUNTED.findall(re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", text))]
    counts = [done for done, _ in results]
    assert len(set(counts)) > 20 and counts == sorted(counts)
    assert abs(results[0][1] / counts[-1] - 1) < 0.1  # about
