"""A run of an engine's script with a mistake, in a process of its own, as who wrote it would run it."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from analytic import Scene
from engines.contract import Engine
from engines.guard import end_with_parent
from engines.mistakes import Mistake
from engines.scripting import write_script
from engines.swings import Trace

from ...running.files import TemporaryFolder
from ...running.provenance import scrub

NAME = "script"
RUN = """
import runpy, sys
import numpy
numbers = runpy.run_path(sys.argv[1])
rows, _ = numbers["simulate"]()
numpy.savez(sys.argv[2], rows=rows, contact=numbers["contact"], settle=numbers.get("settle", 0.0))
"""


class ScriptFailed(RuntimeError):
    """A script has not come to its end; the message says why."""


def with_mistake(engine: Engine, scene: Scene, mistake: Mistake | None) -> dict[str, str]:
    """{file name: text} of the scene's script and the record that it reads, if any; None: without a mistake.

    Raises
    ------
    ValueError
        The mistake cannot be made in it.
    """
    files = write_script(engine, scene, NAME)
    script = f"{NAME}.py"
    return files if mistake is None else {**files, script: mistake.made(files[script])}


def run_script(files: Mapping[str, str], time_limit: float) -> Trace:
    """The steps of a script; time_limit [s].

    Raises
    ------
    ScriptFailed
        It raised an error, crashed, took too long, or returned what are no steps.
    """
    with TemporaryFolder("script-") as folder:
        for name, text in files.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        found = Path(folder, "found.npz")
        command = [sys.executable, "-I", "-c", RUN, str(Path(folder, f"{NAME}.py")), str(found)]
        alike = end_with_parent if os.name == "posix" else None  # an interrupted study leaves no script behind
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, timeout=time_limit, preexec_fn=alike)
        except subprocess.TimeoutExpired:
            raise ScriptFailed(f"no end within {time_limit:g} s") from None
        if done.returncode < 0:
            raise ScriptFailed(f"killed by signal {-done.returncode}")
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {done.returncode}"]
            raise ScriptFailed(scrub(said[-1]))
        with np.load(found) as numbers:
            rows, contact, settle = (numbers[name] for name in ("rows", "contact", "settle"))
    try:
        columns = dict(zip(Trace.COLUMNS, rows.T, strict=True))
        return Trace(**columns, contact_tilt=float(contact), settle=float(settle), first_script=True)
    except ValueError as error:
        raise ScriptFailed(f"its rows are no steps ({error})") from None
