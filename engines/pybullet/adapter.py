"""PyBullet's variants: Bullet decides contact and impact."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
import pybullet

from analytic.response import Caution, Failure

from ..checks import GAIN_LIMIT, HEIGHT_TOLERANCE, energy_gain, pivoting_centre
from ..contract import Mismatch, Run, Variant
from ..leapfrog import MOST_ROWS, failure_of, raw_trace_of, trace_of
from ..pace import FLAT
from ..vibration import longest_step
from . import first_script, stepping
from .scene import MOST_FRICTION, MOST_VELOCITY, Units, assemble

if TYPE_CHECKING:
    from analytic import Scene

    from ..swings import Trace

DECIDES = (
    "Bullet's contact solver decides when a corner lands, sticks or lifts and what an impact does to the tilt rate "
    "and the base velocity; no restitution is given to it. The adapter gives it the bearings' force and the "
    "ground's acceleration, and chooses the length of the steps."
)


@dataclass(frozen=True)
class ImpactAware:
    """Large steps in flight and at rest, small ones on the way to an impact.

    accuracy is the one knob: the share of its speed at the impact that the block may gain in one step there. The
    error of e is about twice that. largest_step [s] is that of flight and rest for R of .5 to 2 m; a block 4 times as
    large or as small takes 2 times the step or half of it, and so on. Stiff bearings may ask for less.
    """

    # Free rocking, slenderness .1 to .45, rigid ground and m_b = 212 kg, 8 starts, 3 impacts each: e within 2.2e-5,
    # base velocity jump within 4.1e-4 (rms), at 1040 to 1390 steps a second; 5e-5: e within 1e-4, 1e-4: 2e-4.
    accuracy: float = 1e-5
    # The peak displacement of the isolated Caryatid (Duzce) is off by 2e-6 at 1 ms, 5e-6 at 2.5 ms; rocking on
    # bearings it is off by 1.2e-3 at 1 ms, 2.3e-3 at 2 ms.
    largest_step: float = 1e-3


@dataclass(frozen=True)
class FixedStep:
    """The same chain at one step: `step` [s] is the one knob, and goes with R and bearings as `largest_step` does."""

    # e within 6e-4 (slenderness .2, rigid ground) to 3e-3 (.45, m_b = 212 kg), rms; in proportion to the step.
    step: float = 1e-4


@dataclass(frozen=True)
class FirstScript:
    """A free 3-D box with all defaults of the API: `step` [s] is the one knob, and hardly matters."""

    step: float = 1 / 240  # Bullet's own default


# verified: random scenes against the analytic model, default settings.
VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        tier="tuned",
        ladder=(1e-3, 1e-4, 1e-5, 1e-6),
        finer=({"largest_step": 1e-4}, {"largest_step": 1e-4, "accuracy": 1e-6}),
        varied={"largest_step": (5e-4, 1e-3, 2e-3, 4e-3)},
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "fixed-step": Variant(
        FixedStep(),
        tier="tuned",
        ladder=(4e-3, 1e-3, 2.5e-4, 1e-4),
        finer=({"step": 2e-5},),
        free_block="engines.pybullet.free_block:simulate",
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
    ),
    "first-script": Variant(  # damping that no one asked for: e off by .01 to .5 at every step
        FirstScript(),
        tier="defaults",
        ladder=(1 / 60, 1 / 240, 1 / 1000),
        finer=({"step": 2e-4},),
        computes="motion, contact, impact, sliding and rest",
        imposes="nothing",
        friction=0.5 * 0.5,  # the default on either body, which Bullet multiplies
        flight_damping=0.04,  # the default of a multibody
    ),
}


def versions() -> dict[str, str]:
    """Versions of what computes: {package: version}."""
    return {"pybullet": version("pybullet"), "bullet-api": str(pybullet.getAPIVersion())}


class TooManySteps(RuntimeError):
    """A run would take more than `MOST_ROWS` steps."""


def run(scene: Scene, variant: str, settings: ImpactAware | FixedStep | FirstScript) -> Run:
    """The `Run` of a scene."""
    trace, steps, cpu, ended, place, failure = _attempt(scene, settings)
    if failure is None and place is not None and _may_have_left(scene, trace, ended, place):
        # The same run again, with all places of the block: to read them each time costs up to a tenth more.
        trace = _attempt(scene, settings, places=True)[0]
    return Run(trace, steps, cpu, failure, ended if ended == "overturned" else None, _beyond(scene, variant))


def _attempt(scene, chosen, places=False):
    """(trace or None, steps, CPU seconds, how it ended, place of the block at the end or None, failure or None)."""
    failure, ended, rows, place, cpu = None, None, [], None, math.nan
    client = pybullet.connect(pybullet.DIRECT)
    try:
        rows, ended, place, cpu = _run(client, scene, chosen, places)
    except Mismatch as error:
        failure = Failure("Bullet does not use what it was given", str(error))
    except TooManySteps as error:
        failure = Failure("too many steps", str(error))
    except pybullet.error as error:
        failure = Failure("Bullet raised an error", str(error))
    finally:
        pybullet.disconnect(client)
    if len(rows) < 2:
        return None, 0, cpu, ended, place, failure
    if isinstance(chosen, FirstScript):
        trace = raw_trace_of(rows, scene, 1e-3 * scene.block.slenderness)
    else:
        trace = trace_of(rows, scene, FLAT * scene.block.slenderness, smeared=3)
    return (
        trace,
        len(rows) - 1,
        cpu,
        ended,
        place,
        failure or _failure(scene, rows, ended, trace, isinstance(chosen, FirstScript)),
    )


def _run(client, scene, chosen, places):
    """(rows, how it ended, place of the block at the end or None, CPU seconds of the stepping)."""
    rows: Sequence[Sequence[float]] | np.ndarray
    if isinstance(chosen, FirstScript):
        handles = first_script.build(client, scene, chosen.step)
        clock = time.process_time()
        rows, ended = first_script.run(handles, client, scene, chosen.step)
        return rows, ended, None, time.process_time() - clock
    units = Units.of(scene)
    sized, largest = units.scale(scene), _largest(scene, chosen) / units.time
    accuracy = chosen.accuracy if isinstance(chosen, ImpactAware) else None
    if sized.duration / largest > MOST_ROWS:
        raise TooManySteps(
            f"steps of {largest * units.time:.3g} s that follow the bearings: "
            f"{sized.duration / largest:.3g} for {scene.duration:.6g} s; at most {MOST_ROWS}"
        )
    assembly = assemble(client, sized, largest)
    clock = time.process_time()
    rows, ended = stepping.run(assembly, sized, units, largest, accuracy, places)
    cpu = time.process_time() - clock
    place = [
        units.length * state[0]
        for state in pybullet.getJointStates(assembly.body, (assembly.slide, assembly.lift), client)
    ]
    return rows, ended, place, cpu


def _largest(scene: Scene, chosen: ImpactAware | FixedStep | FirstScript) -> float:
    """Longest step [s] of a variant's settings for a scene."""
    if isinstance(chosen, FirstScript):
        return chosen.step
    units = Units.of(scene)
    longest = chosen.largest_step if isinstance(chosen, ImpactAware) else chosen.step
    return longest_step(scene, units.time * longest)


def _beyond(scene: Scene, variant: str) -> tuple[Caution, ...]:
    """What Bullet cannot take as it is given."""
    if variant == "first-script" or scene.friction is None or scene.friction <= MOST_FRICTION:
        return ()
    words = f"friction = {scene.friction:.4g} is above {MOST_FRICTION:g}: Bullet takes it as {MOST_FRICTION:g}"
    return (Caution("engine", words, "friction", scene.friction, MOST_FRICTION),)


def _may_have_left(scene: Scene, trace: Trace, ended: str | None, place: np.ndarray) -> bool:
    """Whether the block cannot have turned about its corner all the time: by its energy, or by where it ended."""
    if not energy_gain(scene, trace) <= GAIN_LIMIT:
        return True
    off = np.abs(pivoting_centre(scene, trace)[-1, :2] - place).max()
    return ended == "done" and off > HEIGHT_TOLERANCE * scene.block.radius


def _failure(
    scene: Scene,
    rows: Sequence[Sequence[float]] | np.ndarray,
    ended: str | None,
    trace: Trace | None,
    first: bool = False,
) -> Failure | None:
    """What went wrong in a finished run, or None."""
    failure = failure_of(scene, rows, ended)
    if failure:
        return failure
    fastest = max(np.abs(trace.tilt_rate).max(), np.abs(trace.base_velocity).max())
    limit = first_script.MOST_VELOCITY if first else MOST_VELOCITY
    if fastest > 0.1 * limit:
        return Failure("Bullet cuts velocities", f"{fastest:.3g} m/s or rad/s; its limit: {limit:g}")
    return None
