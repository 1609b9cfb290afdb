"""Runs of an engine's script, correct or with a mistake, in a separate process."""

import hashlib
import math
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from analytic import Response, Scene
from analytic.response import Failure
from engines import get_engine
from engines.contract import Engine, Mistake
from engines.guard import end_with_parent
from engines.observe import failed_response, observe
from engines.scripting import write_script
from engines.swings import Trace

from ..execution.results import scrub
from ..execution.writing import TemporaryFolder

NAME = "script"
SECONDS = 300.0  # time limit of a script; a script that ends takes 5 s of CPU time at most
RUN = """
import runpy, sys
import numpy
numbers = runpy.run_path(sys.argv[1])
rows, cpu = numbers["simulate"]()
numpy.savez(sys.argv[2], rows=rows, contact=numbers["contact"], settle=numbers.get("settle", 0.0), cpu=cpu)
"""


class ScriptFailed(RuntimeError):
    """A script did not reach its end; the message says why."""


def with_mistake(engine: Engine, scene: Scene, mistake: Mistake | None) -> dict[str, str]:
    """Return {file name: text} of a scene's script, with a mistake if given, and of the record that it reads.

    Raises
    ------
    ValueError
        The mistake cannot be made in this script.
    """
    files = write_script(engine, scene, NAME)
    script = f"{NAME}.py"
    return files if mistake is None else {**files, script: mistake.made(files[script])}


def simulate_script(scene: Scene, *, engine: str, version: Mapping[str, str], history: bool = False) -> Response:
    """Run a scene by an engine's script and return the response. A script that fails gives a failed run.

    The CPU time is that of the script's steps, without its imports. version: versions of engine and script
    (`version_of`), which identify a stored run.
    """
    record = get_engine(engine)
    about: dict[str, Any] = dict(engine=engine, variant=NAME, settings={}, versions=version)
    try:
        trace, seconds = run_script(with_mistake(record, scene, None), SECONDS)
    except ScriptFailed as failed:
        return failed_response(scene, Failure(str(failed)), cpu_seconds=0.0, steps=0, **about)
    return as_written(scene, trace, cpu_seconds=seconds, history=history, **about)


def version_of(engine: Engine, scene: Scene, mistake: Mistake | None = None) -> str:
    """Return a digest of a scene's script. The digests of source files do not include it."""
    return hashlib.sha256("".join(with_mistake(engine, scene, mistake).values()).encode()).hexdigest()[:16]


def as_written(scene: Scene, trace: Trace, **about: Any) -> Response:
    """Return the response that the steps of a script give. about: further arguments of `engines.observe.observe`."""
    over = "overturned" if abs(trace.tilt[-1]) >= math.pi / 2 else None
    return observe(scene, trace, ended=over, steps=len(trace.time) - 1, **about)


def run_script(files: Mapping[str, str], time_limit: float) -> tuple[Trace, float]:
    """Run a script and return its steps and their CPU time [s]. time_limit: [s].

    Raises
    ------
    ScriptFailed
        The script raised an error, crashed, took too long, or returned no valid steps.
    """
    with TemporaryFolder("script-") as folder:
        for name, text in files.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        output = Path(folder, "found.npz")
        command = [sys.executable, "-I", "-c", RUN, str(Path(folder, f"{NAME}.py")), str(output)]
        guard = end_with_parent if os.name == "posix" else None  # an interrupted study leaves no script running
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, timeout=time_limit, preexec_fn=guard)
        except subprocess.TimeoutExpired:
            raise ScriptFailed(f"no end within {time_limit:g} s") from None
        if done.returncode < 0:
            raise ScriptFailed(f"killed by signal {-done.returncode}")
        if done.returncode:
            lines = done.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {done.returncode}"]
            raise ScriptFailed(scrub(lines[-1]))
        with np.load(output) as numbers:
            rows, contact, settle, cpu = (numbers[name] for name in ("rows", "contact", "settle", "cpu"))
    try:
        columns = dict(zip(Trace.COLUMNS, rows.T, strict=True))
        trace = Trace(**columns, contact_tilt=float(contact), settle=float(settle), first_script=True)
    except ValueError as error:
        raise ScriptFailed(f"its rows are no steps ({error})") from None
    return trace, float(cpu)
