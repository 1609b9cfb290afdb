"""What the studies share: a place to run cases that outlives an interruption, and the outcome a row keeps."""

import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from analytic import SettingError

from ..running.cases import module_of
from ..running.executors import Processes
from ..running.files import check_folder
from ..running.store import Store
from ..running.sweep import run_sweep

STORE = ".sweep"  # folder of the rows of single runs, beside the result
TIME_LIMIT = 300.0  # s, of one run
SHOWN = 30  # runs from which on a batch shows its progress; a bisection has many small ones
DEFAULTS = (("exudyn", None), ("pybullet", None))  # solver, variant: the engines at default settings

FIRST_SCRIPT_FRICTION = 0.5 * 0.5  # of PyBullet's first-script: its default on either body, which it multiplies


def outcome(response):
    """What the overturning studies keep of a run (a sweep's reducer)."""
    return {"outcome": response.outcome, "time": response.overturning_time, "impacts": response.impact_count,
            "end_tilt": response.end.tilt, "decided": response.decided}


@dataclass(frozen=True)
class Workshop:
    """Where a study runs its cases: one store, one set of workers. See `workshop`."""

    store: Store
    executor: Processes
    progress: bool

    def run(self, cases, label, reduce=outcome):
        """Rows of the cases, in their order; those in the store are not run again."""
        return run_sweep(cases, store=self.store, executor=self.executor, reduce=reduce, time_limit=TIME_LIMIT,
                         progress=self.progress and len(cases) >= SHOWN, label=label)


@contextmanager
def workshop(output, solvers, workers=None, progress=True):
    """A `Workshop` whose runs are kept under `output`, for the named solvers.

    Raises
    ------
    SettingError
        `output` is a file, or the number of workers is below one.
    StoreError
        Another study is writing there.
    """
    check_folder(output)
    if workers is not None and workers < 1:
        raise SettingError(f"--workers {workers}: give at least 1")
    with Store(Path(output) / STORE / "runs.jsonl") as store, Processes(workers, solvers) as executor:
        yield Workshop(store, executor, progress)


def code_of(module, solvers):
    """The modules on whose code a result depends: the study's own and those of its solvers."""
    return [module, "analytic", *dict.fromkeys(module_of(name) for name in solvers)]


def say(text):
    """A line of progress on standard error, with the time."""
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


def name_of(solver, variant=None):
    """A solver as tables and plots call it."""
    return solver if variant is None else f"{solver}, {variant}"
