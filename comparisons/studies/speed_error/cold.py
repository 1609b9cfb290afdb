"""What the first run of a solver costs: a process of its own that imports what it needs, and runs one scene."""

import json
import os
import pickle
import subprocess
import sys
from typing import Any

import psutil

from analytic import Response

from ...running.cases import SOLVERS, Case
from ...running.files import TemporaryFolder

SECONDS = 1.0  # over which the load of the machine is measured
STORED, ANEW = "compiled code stored", "compiled anew"
RUN = """
import json, pickle, pkgutil, sys, time
solver, scene, settings = pickle.load(sys.stdin.buffer)
if ":" in solver:
    run = pkgutil.resolve_name(solver)
else:
    from engines import get_engine
    run = get_engine(solver).simulate
response = run(scene, **settings)
print(json.dumps([time.process_time(), response.outcome]))
"""


def first_run(case: Case, response: Response) -> dict[str, Any]:
    """Measure: outcome and CPU time [s] of a process of its own, from its start to the response.

    The case's tag says whether what the analytic model has compiled is `STORED`, or compiled `ANEW`.
    """
    given = SOLVERS.get(case.solver, case.solver), case.scene, case.settings
    with TemporaryFolder("cold-") as folder:
        cache = {"NUMBA_CACHE_DIR": folder} if case.tag["code"] == ANEW else {}
        done = subprocess.run(
            [sys.executable, "-c", RUN],
            input=pickle.dumps(given),
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **cache},
            capture_output=True,
            check=True,
        )
    seconds, outcome = json.loads(done.stdout.splitlines()[-1])
    return {"outcome": outcome, "cost": {"cpu_seconds": seconds}}


def load(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the share of the machine's CPU time that other processes take meanwhile, as nothing of ours runs [-]."""
    return {"cost": {"load": psutil.cpu_percent(SECONDS) / 100}}
