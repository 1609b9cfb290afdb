"""From a scene and an engine to a response: the code that all engines share.

The variant and its settings are checked first (`choose`), and a given restitution is refused where the engine computes
the impact itself. Tuned variants are tested in the range of statues `RANGE`; a response outside it carries a warning.
"""

from __future__ import annotations

import dataclasses
import math
import traceback
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

import analytic
from analytic import solver as termination
from analytic.errors import SceneError, SettingError
from analytic.response import LEVEL, Caution, Failure
from analytic.rocking import BearingLaw
from analytic.solver import compile_kernels

from .comparison import Reference, too_coarse
from .comparison import compare as compared
from .contract import Engine, Run
from .loads import ALONE, holding, reached
from .swings import find_swings

if TYPE_CHECKING:
    from types import ModuleType

    from analytic import Response, Scene

    from .swings import Trace


def choose(engine: Engine, variant: str | None, changes: Mapping[str, Any]) -> tuple[str, Any]:
    """Choose an engine's variant: (name, settings with fields replaced).

    Parameters
    ----------
    engine : Engine
    variant : str or None
        None: the main one.
    changes : dict
        {field: number}

    Raises
    ------
    SettingError
        The variant or the setting is unknown, or a value is not a finite number above 0.
    """
    name, variants = engine.default_variant if variant is None else variant, engine.variants
    if name not in variants:
        raise SettingError(f"{engine.name} has no variant {name!r}: choose one of {', '.join(variants)}")
    settings = variants[name].settings
    known = [field.name for field in fields(settings)]
    for key, value in changes.items():
        if key not in known:
            raise SettingError(f"{engine.name} {name} has no setting {key!r}: its settings are {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
            raise SettingError(f"{engine.name} {name}: {key} = {value!r} is not a positive number")
    return name, replace(settings, **{key: float(value) for key, value in changes.items()})


def refuse_restitution(engine: Engine, scene: Scene) -> None:
    """Raise `SceneError` where a scene gives the restitution and the engine computes the impact itself."""
    if scene.block.restitution is not None:
        able = [
            name
            for name, variant in engine.variants.items()
            if variant.takes_restitution and (variant.applies_impact or reached(scene))
        ]
        raise SceneError(
            "block.restitution",
            scene.block.restitution,
            "a contact engine computes the impact itself",
            f"leave it out, use the variant {able[0]}, {ALONE}" if able else f"leave it out, {ALONE}",
        )


ROUNDING = 1e-9  # tolerance of a computed value at a limit
# {quantity: (lowest value, highest value, in words)}
RANGE = {
    "slenderness": (0.1, 0.5, "slenderness {low:g} to {high:g} rad"),
    "inertia": (1.2, 2.0, "inertia about a corner {low:g} to {high:g} m R²"),
    "radius": (0.1, 10.0, "R {low:g} to {high:g} m"),
    "base_mass": (0.05, math.inf, "rigid ground or a base of at least {low:g} block masses"),
    "period": (0.3, 5.0, "bearings of {low:g} to {high:g} s"),
    "damping": (0.0, 1.0, "damping up to critical"),
    "tilt": (0.01, math.inf, "a peak tilt of at least {low:g} slendernesses"),
}
NAMES = {"base_mass": "base mass over block mass", "tilt": "peak tilt over slenderness"}  # where not the key


def in_words() -> str:
    """The range of statues in one line."""
    return ", ".join(map(_limits_in_words, RANGE))


def outside(scene: Scene, response: Response) -> tuple[Caution, ...]:
    """Warnings: one for each quantity of the scene, and for the run's peak tilt, that lies outside the range."""
    cautions = []
    for name, value in _values(scene, response).items():
        low, high, _ = RANGE[name]
        if not low * (1 - ROUNDING) <= value <= high * (1 + ROUNDING):
            words = (
                f"{NAMES.get(name, name)} {value:.3g} is outside the range in which engines are tested "
                f"({_limits_in_words(name)}): nothing is promised there"
            )
            cautions.append(Caution("engine", words, name, value, low if value < low else high))
    return tuple(cautions)


def _limits_in_words(name: str) -> str:
    """The limits of a quantity in words."""
    low, high, words = RANGE[name]
    return words.format(low=low, high=high)


def _values(scene: Scene, response: Response) -> dict[str, float]:
    """Return {quantity of `RANGE`: its value} for the quantities that the scene has.

    A block that never lifts has no tilt. Period and viscous damping are those of block and base on the stiffness after
    yielding.
    """
    block, base = scene.block, scene.base
    inertia = block.inertia / (block.mass * block.radius**2)
    values = {"slenderness": block.slenderness, "inertia": inertia, "radius": block.radius}
    if base is not None:
        values["base_mass"] = scene.base_mass / block.mass
    if scene.bearings is not None:
        law = BearingLaw.of(scene.bearings)
        omega = math.sqrt(law.count * law.kb / scene.total_mass)
        values["period"] = 2 * math.pi / omega if omega else math.inf
        values["damping"] = law.count * law.damping / (2 * omega * scene.total_mass) if omega else 0.0
    if response.outcome not in (*LEVEL, "falls off", "failed"):  # an engine that stands has a tilt of rounding
        values["tilt"] = response.peak_tilt_ratio
    return values


# A run that ends within this many settling times of the contact, or this many steps, after a landing or an uplift ends
# during the impact. With an engine that switches corners within a step, as MuJoCo does, the block is then on both
# corners, and e would be read as 0.
SETTLED, STEPS = 2.0, 4
SLIPS = "with less the block slips under the couple before each landing"


class Simulator(Engine):
    """An `Engine` that simulates scenes; known: all of them, by name."""

    known: ClassVar[Mapping[str, Simulator]] = {}

    @classmethod
    def of(cls, engine: Engine) -> Self:
        """The simulator of an engine's record."""
        return cls(**{part.name: getattr(engine, part.name) for part in dataclasses.fields(engine)})

    def run(self, scene: Scene, variant: str, settings: object) -> Run:
        """The adapter's run of a scene that has a duration; settings: of the variant's dataclass, not checked again.

        An error of the adapter gets a note with the place where it was raised.
        """
        adapter = self.load()
        try:
            result = self._builder(scene)(self._as_run(scene, variant), variant, settings)
            if not isinstance(result, Run):
                raise TypeError(f"{self.adapter}.run returned a {type(result).__name__}, no engines.contract.Run")
        except Exception as error:
            error.add_note(f"in {_place(error, adapter)}")
            raise
        return result

    def _builder(self, scene: Scene) -> Callable[..., Run]:
        """The adapter's function that runs such a scene.

        Raises
        ------
        SceneError
            The pedestal is free, and the adapter does not build it; the message names engines that do.
        """
        adapter = self.load()
        if not scene.is_stack:
            return adapter.run
        if hasattr(adapter, "run_stack"):
            return adapter.run_stack
        able = [name for name, other in self.known.items() if other.installed and hasattr(other.load(), "run_stack")]
        raise SceneError(
            "pedestal.free",
            True,
            f"not supported by {self.name}{getattr(adapter, 'NO_STACK', '')}",
            f"remove it, or run it without an engine{' or with ' if able else ''}{', '.join(able)}",
        )

    def simulate(
        self, scene: Scene, *, variant: str | None = None, history: bool = True, compare: bool = True, **settings: float
    ) -> Response:
        """The response of a scene; a run that fails has the outcome "failed" and says why.

        Parameters
        ----------
        scene : Scene
            A scene without a duration runs until its outcome is decided.
        variant : str or None
            One of `variants`; None: the main one.
        history : bool
            Keep the history in the response.
        compare : bool
            Run the analytic model, too, and keep the differences (`engines.comparison`). This is not part of
            ``cpu_seconds``.
        **settings
            Fields of the variant's settings, in place of their defaults.

        Raises
        ------
        SettingError
            The variant or the setting is unknown, or a setting is not a positive number.
        SceneError
            The scene gives the restitution, but the variant computes it, or a free pedestal, which the adapter does not
            build.
        Mismatch
            Of exudyn only: it holds other values than the scene asks for; nothing was run.
        """
        model = self._model(scene)
        response, _ = self._traced(scene, variant, history, settings, model)
        more = (*outside(scene, response), *self._restitution_warning(scene, response))
        if not response.failure:
            more += too_coarse(scene, response, self.variants[response.variant])
        response = replace(response, warnings=(*response.warnings, *more))
        if response.failure or not compare:
            return response
        if (held := self._as_run(scene, response.variant).friction) != scene.friction and scene.friction is not None:
            words = f"the contact's friction is {held:.3g}, not the scene's {scene.friction:.3g}"
            return replace(response, comparable=f"{words}: {SLIPS}")
        return compared(scene, response, Reference.of(scene, model))

    def traced(
        self, scene: Scene, *, variant: str | None = None, history: bool = True, **settings: float
    ) -> tuple[Response, Trace | None]:
        """Simulate without the comparison: (response, trace or None).

        A scene without a duration is first run to the end of the analytic model's run, where most engines end, too. If
        the engine's own end state is not decided there, it runs longer (`analytic.solver.until_decided`).
        """
        return self._traced(scene, variant, history, settings, self._model(scene))

    def _model(self, scene: Scene) -> Response | None:
        """The analytic model's run of a scene without a duration, whose end is needed; else None."""
        compile_kernels()
        return analytic.simulate(scene, history=False) if scene.duration is None else None

    def _traced(
        self, scene: Scene, variant: str | None, history: bool, settings: Mapping[str, float], model: Response | None
    ) -> tuple[Response, Trace | None]:
        """Do `traced`, given the analytic model's run."""
        self._builder(scene)
        name, chosen = choose(self, variant, settings)
        if not self.variants[name].takes_restitution:
            refuse_restitution(self, scene)
        if (friction := self._as_run(scene, name).friction) is not None and hasattr(chosen, "friction"):
            chosen = replace(chosen, friction=friction)
        if model is None:
            return self._observed(scene, name, chosen, history)
        traces: list[Trace | None] = []

        def attempt(cut):
            response, trace = self._observed(cut, name, chosen, history)
            traces[:] = [trace]  # of the last attempt
            return response

        response = termination.until_decided(
            attempt, scene, at_least=model.end.time, finished=lambda _, response: response.decided
        )
        return response, traces[0]

    def _as_run(self, scene: Scene, variant: str) -> Scene:
        """The scene as it is run: with more friction where a couple needs it."""
        return scene if self.variants[variant].applies_impact else holding(scene)

    def _restitution_warning(self, scene: Scene, response: Response) -> tuple[Caution, ...]:
        """The warning that a scene gives the restitution, so that its runs rate no engine; () where it does not."""
        if (e := scene.block.restitution) is None:
            return ()
        words = f"restitution given, {e:.4g}: it is the scene's, and says nothing of the engine's own impact"
        if (friction := self._as_run(scene, response.variant).friction) != scene.friction:
            words += f"; the contact's friction is {friction:.3g}: {SLIPS}"
        return (Caution("engine", words, "restitution", e),)

    def _observed(self, scene: Scene, name: str, chosen: Any, history: bool) -> tuple[Response, Trace | None]:
        """Run a scene that has a duration: (response, trace or None)."""
        from .observe import failed_response, observe

        run = self.run(scene, name, chosen)
        longer = self._longer_run(scene, name, chosen, run)
        beyond, warnings = _beyond(scene, longer) if longer else (None, ())
        labels: dict[str, Any] = dict(
            engine=self.name,
            variant=name,
            settings=asdict(chosen),
            versions=self.versions(),
            cpu_seconds=run.cpu_seconds + (longer.cpu_seconds if longer else 0.0),
            steps=run.steps + (longer.steps if longer else 0),
            warnings=(*run.warnings, *warnings),
        )
        if run.trace is None:
            failure = run.failure or Failure("the run ended before its first step")
            return failed_response(scene, failure, **labels), None
        if scene.is_stack:
            from .stack import observe_stack  # which needs this module

            return observe_stack(scene, run, history=history, **labels), run.trace
        response = observe(
            scene, run.trace, beyond=beyond, history=history, failure=run.failure, ended=run.ended, **labels
        )
        return response, run.trace

    def _longer_run(self, scene: Scene, name: str, chosen: Any, run: Run) -> Run | None:
        """The same run of a longer scene, if the scene ends during a change of contact; else None."""
        if run.trace is None or run.failure or run.ended or scene.is_stack:
            return None
        time, swings = run.trace.time, find_swings(run.trace)
        changes = np.append(swings.first[1:], swings.last)
        changes = changes[changes < len(time) - 1]  # without a landing to come
        after = max(SETTLED * run.trace.settle, STEPS * float(np.diff(time).max()))
        if not len(changes) or time[-1] - time[changes.max()] >= after:
            return None
        longer = scene.with_(duration=scene.end + after)
        return self.run(longer, name, chosen)


def _place(error: Exception, adapter: ModuleType) -> str:
    """Where an adapter raised an error: the innermost line of its package, else the first line of its `run`."""
    package = adapter.__name__.partition(".")[0]
    passed = [(frame.f_globals.get("__name__", ""), line) for frame, line in traceback.walk_tb(error.__traceback__)]
    frames = [place for place in passed[1:] if place[0].partition(".")[0] == package]
    begins = getattr(getattr(adapter.run, "__code__", None), "co_firstlineno", 1)
    return "{}, line {}".format(*frames[-1] if frames else (adapter.__name__, begins))


def _beyond(scene: Scene, on: Run) -> tuple[Trace | None, tuple[Caution, ...]]:
    """Read a run that went on beyond the scene's end: (its trace, or None if it fails there; warnings)."""
    from .events import finite_part

    trace, failure = finite_part(on.trace, on.failure) if on.trace else (None, on.failure)
    if trace is not None and failure is None:
        return trace, ()
    words = (
        f"the run ends at {scene.duration:.6g} s during an impact, and fails if it goes on: the end of the impact is "
        "not known, do not trust its restitution"
    )
    return None, (Caution("engine", words),)
