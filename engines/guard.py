"""An engine's run in a process of its own, so that a hang or a crash costs that run only."""

import math
import multiprocessing
import signal
from concurrent.futures import TimeoutError

from pebble import ProcessExpired, ProcessPool

from analytic.errors import SceneError, SettingError
from analytic.response import Failure

from . import get_engine
from .observe import failed_response


def _simulate(engine_name, scene, settings):
    return get_engine(engine_name).simulate(scene, **settings)


def guarded_simulate(engine_name, scene, *, time_limit, **settings):
    """The response of ``get_engine(engine_name).simulate(scene, **settings)``, run in its own process.

    Parameters
    ----------
    engine_name : str
    scene : Scene
    time_limit : float
        Wall-clock time [s] after which the run is killed, start of the process and import of the engine included.
    **settings
        Passed to the engine.

    Returns
    -------
    Response
        Of outcome "failed", with the evidence in its failure, where the process was killed, crashed, ran into
        the time limit or raised an error while simulating.

    Raises
    ------
    KeyError, EngineNotInstalled
        As `get_engine`, before any process is started.
    SettingError, SceneError
        The run cannot be asked for; this is the caller's mistake and no failure of the engine.
    ValueError
        `time_limit` is not positive.
    """
    if not (math.isfinite(time_limit) and time_limit > 0):
        raise ValueError(f"time_limit = {time_limit!r}: give a time above 0 [s]")
    versions = get_engine(engine_name).versions()
    return guarded(_simulate, engine_name, scene, settings, time_limit, versions)


def guarded(run, engine_name, scene, settings, time_limit, versions=None):
    """``run(engine_name, scene, settings)`` in a process of its own; see `guarded_simulate`.

    `run` is a function at the top of a module, so that the process can import it.
    """
    # Spawned, not forked: the engine starts from nothing, with no thread or engine state of this process.
    context = multiprocessing.get_context("spawn")
    with ProcessPool(max_workers=1, max_tasks=1, context=context) as pool:
        try:
            return pool.schedule(run, args=(engine_name, scene, settings), timeout=time_limit).result()
        except TimeoutError:
            failure = Failure("the run did not end in time", f"killed after the time limit of {time_limit:g} s")
        except ProcessExpired as error:
            failure = Failure("the engine's process died", _last_words(error.exitcode))
        except (SettingError, SceneError):
            raise
        except Exception as error:  # whatever an engine raises, its message is the evidence
            trace = getattr(error, "traceback", "")
            failure = Failure("the run raised an error", f"{type(error).__name__}: {error}\n{trace}".strip())
    return failed_response(scene, failure, engine=engine_name, variant=str(settings.get("variant") or ""),
                           settings=dict(settings), versions=versions or {})


def _last_words(code):
    """An exit code in words; a negative one is the signal that killed the process."""
    if code is not None and code < 0:
        try:
            return f"killed by signal {-code} ({signal.Signals(-code).name})"
        except ValueError:
            return f"killed by signal {-code}"
    return f"exit code {code}"
