"""From a scene and an engine to a response: what is the same for all engines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import numpy as np

import analytic
from analytic import ending
from analytic.response import Failure
from analytic.solver import compile_kernels

from . import kicked
from .endings import finite_part
from .observe import failed_response, observe
from .settings import choose, leave_restitution
from .swings import find_swings
from .verified import outside

if TYPE_CHECKING:
    from analytic import Response, Scene

    from .contract import Engine, Run, Variant
    from .swings import Trace

# A run that ends this many times a contact's settling time, or this many steps, after a landing or a lift ends in it:
# an engine that switches within a step, as MuJoCo, has the block on both corners then, and its e would be read as 0.
SETTLED, STEPS = 2.0, 4


def traced(
    engine: Engine, scene: Scene, variant: str | None, history: bool, settings: Mapping[str, Any]
) -> tuple[Response, Trace | None]:
    """(response, trace or None) of `Engine.traced`.

    A scene without a duration is first run to where the analytic model's run ends, as engines end alike; an engine
    whose own end state is not decided there goes on for longer (`analytic.ending.until_decided`).
    """
    compile_kernels()
    name, chosen = choose(engine, variant, settings)
    if not engine.variants[name].takes_restitution:
        leave_restitution(engine, scene)
    if scene.friction is not None and hasattr(chosen, "friction"):
        chosen = replace(chosen, friction=scene.friction)
    if scene.duration is not None:
        return _once(engine, scene, name, chosen, history)
    traces: list[Trace | None] = []

    def attempt(cut):
        response, trace = _once(engine, cut, name, chosen, history)
        traces[:] = [trace]  # of the last attempt
        return response

    end = analytic.simulate(scene, history=False).end.time
    response = ending.until_decided(attempt, scene, at_least=end, finished=lambda _, response: response.decided)
    return response, traces[0]


def _once(engine: Engine, scene: Scene, name: str, chosen: Any, history: bool) -> tuple[Response, Trace | None]:
    run = engine.run(scene, name, chosen)
    on = _run_on(engine, scene, name, chosen, run)
    beyond, said = _beyond(scene, on) if on else (None, ())
    given: dict[str, Any] = dict(
        engine=engine.name,
        variant=name,
        settings=asdict(chosen),
        versions=engine.versions(),
        cpu_seconds=run.cpu_seconds + (on.cpu_seconds if on else 0.0),
        steps=run.steps + (on.steps if on else 0),
        warnings=(*_warnings(engine.variants[name], scene, run), *said),
    )
    if run.trace is None:
        failure = run.failure or Failure("the run ended before its first step")
        return failed_response(scene, failure, **given), None
    seen = observe(scene, run.trace, beyond=beyond, history=history, failure=run.failure, ended=run.ended, **given)
    return seen, run.trace


def _run_on(engine: Engine, scene: Scene, name: str, chosen: Any, run: Run) -> Run | None:
    """The same run for longer, where the scene's end cuts a change of contact short; else None."""
    if run.trace is None or run.failure or run.ended:
        return None
    time, swings = run.trace.time, find_swings(run.trace)
    changes = np.append(swings.first[1:], swings.last)
    changes = changes[changes < len(time) - 1]  # one in flight has not landed
    after = max(SETTLED * run.trace.settle, STEPS * float(np.diff(time).max()))
    if not len(changes) or time[-1] - time[changes.max()] >= after:
        return None
    longer = scene.with_(duration=scene.duration + after)  # type: ignore[operator]  # a run has one
    return engine.run(longer, name, chosen)


def _beyond(scene: Scene, on: Run) -> tuple[Trace | None, tuple[str, ...]]:
    """(its sound trace, what is to be said) of a run that went on beyond the scene's end."""
    trace, failure = finite_part(on.trace, on.failure) if on.trace else (None, on.failure)
    if trace is not None and failure is None:
        return trace, ()
    said = (
        f"the run ends at {scene.duration:.6g} s in an impact, and fails where it goes on, so that the impact's end is "
        "not seen: do not trust its restitution"
    )
    return None, (said,)


def _warnings(variant: Variant, scene: Scene, run: Run) -> tuple[str, ...]:
    """What is said of every run of a variant, what of this one is outside its verified range, what the adapter says,
    and what impacts add up."""
    beyond: tuple[str, ...]
    beyond, peak = (), None
    if run.trace is not None:
        tilt = np.abs(run.trace.tilt)
        lifted = float(tilt.max(initial=0.0, where=np.isfinite(tilt)))
        peak = lifted if lifted > run.trace.contact_tilt else None
    if variant.verified is not None and run.step is not None:
        beyond = outside(scene, variant.verified, step=run.step, peak_tilt=peak)
    return (*variant.caveats, *beyond, *run.warnings, *kicked.warnings(scene, run))
