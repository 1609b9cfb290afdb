"""One run of a study: scene, solver, variant and settings, and everything that its result depends on."""

import functools
import hashlib
import json
import math
import pkgutil
import platform
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from analytic import Block, Response, Scene, Start
from engines import ENGINES, get_engine

from .code_digests import source_digests, today, version_of
from .progress import compile_kernels

# any other name is that of an engine, or itself a "module:function"
SOLVERS = {
    "analytic": "analytic:simulate",
    "twin": "analytic.checks.twin:simulate_twin",
    "time-stepping": "analytic.checks.time_stepping:simulate_time_stepping",
}


@dataclass(frozen=True, eq=False)
class Case:
    """One run: ``solver(scene, variant=variant, **settings)``.

    scene: what is simulated. solver: "analytic", "twin", "time-stepping", the name of an engine, or
    "module:function". variant: None takes the solver's default. settings: keyword arguments, JSON values
    only; {"history": False} saves time if the measure uses no history. tag: further JSON values for the
    measure and the study.
    """

    scene: Scene
    solver: str = "analytic"
    variant: str | None = None
    settings: dict = field(default_factory=dict)
    tag: dict = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "settings", dict(self.settings))
        object.__setattr__(self, "tag", dict(self.tag))

    def key(self, measure: Callable[..., Any]) -> str:
        """Return a hash of all that the row depends on: the case, the measure, versions and source code."""
        content = (
            self.scene.digest(),
            self.solver,
            self.variant,
            self.settings,
            self.tag,
            name_of(measure),
            fingerprint(self.solver, name_of(measure)),
        )
        return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()[:32]

    def run(self) -> Response:
        """Simulate the case in this process and return the `Response`."""
        options: dict[str, Any] = {} if self.variant is None else {"variant": self.variant}
        if self.solver in ENGINES:
            options["compare"] = False  # a study measures by itself, unless its settings say otherwise
        return solver(self.solver)(self.scene, **{**options, **self.settings})


def solver(name: str) -> Callable:
    """Return the function of the solver `name`, which takes a scene and returns a `Response`.

    Raises
    ------
    KeyError
        No such solver; the message lists the known ones.
    EngineNotInstalled
        An engine that cannot be imported here.
    """
    if name in ENGINES:
        return get_engine(name).simulate
    return pkgutil.resolve_name(_place(name))


def compile_for(names: Iterable[str]) -> None:
    """Compile what the solvers `names` need into the cache on disk.

    Otherwise every worker process would compile it again, within its time limit.
    """
    compile_kernels()
    if "time-stepping" in names:
        scene = Scene(block=Block(mass=1.0, radius=1.0, slenderness=0.3), start=Start(tilt=0.1), duration=0.1)
        solver("time-stepping")(scene, step=0.01)


def root_of(name: str) -> str:
    """Return where the code of the solver `name` begins: the module of the adapter, or "module:function"."""
    return ENGINES[name].adapter if name in ENGINES else _place(name)


def versions(name: str) -> dict[str, str | None]:
    """Return the versions of Python and of the packages that the solver `name` uses."""
    packages = ["numpy", "scipy", "numba"] + ([ENGINES[name].package] if name in ENGINES else [])
    return {"python": platform.python_version(), **{package: version_of(package) for package in packages}}


def name_of(function: Callable[..., Any]) -> str:
    """Return ``module:function`` of a module-level function, or ``module:class`` of a callable object."""
    name = f"{function.__module__}:{getattr(function, '__qualname__', type(function).__qualname__)}"
    if "<" in name:
        raise ValueError(f"measure {name} cannot travel to a worker process; make it a module-level function")
    return name


@functools.cache  # the code that this process has loaded does not change
def fingerprint(name: str, measuring: str) -> str:
    """Return a digest of the versions and of the project's code behind a solver and a measure."""
    sources = source_digests([root_of(name), measuring])
    return hashlib.sha256(json.dumps([versions(name), sorted(sources.values())]).encode()).hexdigest()


def _place(name):
    place = today(SOLVERS.get(name, name))
    if ":" not in place:
        raise KeyError(f"unknown solver {name!r}: choose one of {', '.join([*SOLVERS, *ENGINES])}")
    return place


def refined(levels: Sequence[float]) -> list[float]:
    """Return levels with the geometric means of their neighbours between them."""
    means = (math.sqrt(a * b) for a, b in zip(levels, levels[1:], strict=False))
    return sorted({*levels, *means}, reverse=levels[0] > levels[-1])


def variant_settings(engine: str, variant: str, levels: Iterable[float] | None = None) -> dict[str, Any]:
    """Return a variant as the settings of a result list it. levels: the levels that are run; None: all.

    Stored results and JSON call the kind of a variant "tier".
    """
    spec = get_engine(engine).variants[variant]
    return {
        "engine": engine,
        "variant": variant,
        "tier": spec.kind,
        "parameter": spec.accuracy_parameter,
        "default": spec.default,
        "levels": sorted(spec.levels) if levels is None else levels,
        "applies_impact": spec.applies_impact,
    }
