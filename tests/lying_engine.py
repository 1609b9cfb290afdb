"""Engines that lie: the analytic model's run of a scene, in which one thing is wrong; or that fail in one of the ways
in which engines do. They take the place of slow ones.
"""

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from analytic import simulate
from analytic.errors import SceneError
from analytic.response import Failure, Impact, Response, Sliding
from engines.comparison import Reference
from engines.comparison import compare as compared
from engines.contract import Engine, Variant
from engines.simulating import Simulator


@dataclass(frozen=True)
class Settings:
    """step [s] is the accuracy parameter, and changes nothing."""

    step: float = 1e-3


LEAST = 1e-3  # of R, and of the slenderness: what a peak is off by where the model has none
SHARE = 0.01  # by which a lie's history is off
VARIANTS = {
    "lies": Variant(Settings(), kind="tuned", levels=(1e-2, 1e-3), takes_restitution=True, computes="all", imposes="-")
}


def versions():
    return {"lying-engine": "0.1"}


def _outcome(scene, run):
    if run.failure:
        return run
    if run.outcome == "overturns":
        return replace(run, outcome="rocks", overturning_time=None, fall_time=None)
    return replace(run, outcome="overturns", overturning_time=run.end.time, fall_time=0.8 * run.end.time)


def _history(run, **factors):
    """The run with columns of its history times factors, where it has a history and these columns."""
    known = run.history and {name: getattr(run.history, name) for name in factors}
    if not known or any(column is None for column in known.values()):
        return run
    return replace(run, history=replace(run.history, **{name: factors[name] * known[name] for name in factors}))


def _tilt(scene, run):
    lie = replace(run, peak_tilt=1.03 * run.peak_tilt + LEAST * scene.block.slenderness)
    return _history(lie, tilt=1 + SHARE)


def _stroke(scene, run):
    lie = replace(run, peak_base_displacement=1.03 * run.peak_base_displacement + LEAST * scene.block.radius)
    return _history(lie, base_displacement=1 + SHARE)


def _slip(scene, run):
    slid = run.sliding or Sliding(0.0, 0.0, 0.0, 0.0, ())
    lie = replace(run, sliding=replace(slid, peak=1.03 * slid.peak + LEAST * scene.block.radius))
    return _history(lie, slip=1 + SHARE)


def _pedestal(scene, run):
    if run.stack is None:
        return run
    return replace(run, stack=replace(run.stack, peak_tilt=1.03 * run.stack.peak_tilt + LEAST))


def _later(name, periods):
    def lie(scene, run):
        late = periods * 2 * math.pi / scene.rocking_frequency
        return run if run.outcome != "overturns" else replace(run, **{name: getattr(run, name) + late})

    return lie


def _rates(factor):
    def lie(scene, run):
        return replace(
            run, impacts=tuple(replace(impact, rate_after=factor * impact.rate_after) for impact in run.impacts)
        )

    return lie


def _extra(scene, run):
    more = Impact(0.7 * run.end.time, 0.3 * scene.rocking_frequency, 0.2 * scene.rocking_frequency, 0.0)
    return replace(run, impacts=(*run.impacts, more))


def _close(scene, run):
    """Off by half of what counts, in all that is compared."""
    off = {name: 1.01 * getattr(run, name) for name in ("peak_tilt", "peak_base_displacement")}
    late = {} if run.fall_time is None else {"fall_time": _later("fall_time", 0.01)(scene, run).fall_time}
    slid = run.sliding and replace(run.sliding, peak=1.01 * run.sliding.peak)
    return replace(_rates(0.9995)(scene, run), sliding=slid, **off, **late)


def _nan(scene, run):
    numbers = ("peak_tilt", "peak_tilt_ratio", "peak_base_displacement", "friction_demand", "min_normal_ratio")
    return replace(run, **dict.fromkeys(numbers, math.nan), peak_base_acceleration=math.inf)


def _fails(scene, run):
    return replace(run, outcome="failed", decided=False, failure=Failure("it blew up", "12 J at .5 s", run.end))


def _nothing(scene, run):
    known = dict(engine=run.engine, variant=run.variant, settings={}, versions={}, scene=scene.name)
    return Response.unmeasured(outcome="failed", decided=False, failure=Failure("it never stepped"), **known)


def _raises(scene, run):
    raise ValueError("Newton did not converge\nat all")


def _refuses(scene, run):
    raise SceneError("block.radius", scene.block.radius, "not in this engine", "give another")


def _hangs(scene, run):
    time.sleep(600)


# {engine: what it does to the model's response}; every quantity of a difference is wrong in one of them
LIES = {
    "outcome": _outcome,
    "tilt": _tilt,
    "stroke": _stroke,
    "pedestal": _pedestal,
    "slip": _slip,
    "fall": _later("fall_time", 0.03),
    "lying": _later("overturning_time", 2.0),
    "count": lambda scene, run: replace(run, impacts=run.impacts[2:]),
    "restitution": _rates(0.98),
    "loss": _rates(0.996),
    "extra": _extra,
}
FAULTS = {
    "honest": lambda scene, run: run,
    "close": _close,
    "nan": _nan,
    "fails": _fails,
    "nothing": _nothing,
    "raises": _raises,
    "refuses": _refuses,
    "hangs": _hangs,
}


class Liar(Simulator):
    """An engine of `LIES` or `FAULTS`."""

    def simulate(self, scene, *, variant=None, history=True, compare=True, **settings):
        model = simulate(scene, history=history)
        lie = (LIES | FAULTS)[self.name]
        versions, settings_used = {"lying-engine": "0.1"}, {"step": 1e-3, **settings}
        known = replace(model, engine=self.name, variant="lies", settings=settings_used, versions=versions, warnings=())
        response = lie(scene, replace(known, cpu_seconds=0.01, energy=None))
        return compared(scene, response, Reference.of(scene, model)) if compare else response


def liars():
    """{name: the engine} of all."""
    style = dict(package="lying_engine", install="", colour="black", marker="o", adapter="lying_engine")
    return {name: Liar.of(Engine(name=name, **style)) for name in (*LIES, *FAULTS)}


def noise(count, seed):
    """Accelerations of a made-up record, at most 1."""
    values = np.random.default_rng(seed).normal(size=count)
    return values / np.abs(values).max()
