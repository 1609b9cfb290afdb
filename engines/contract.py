"""What an engine is, as data: its record, its variants, its tolerances and the mistakes in its script.

A package that offers an engine holds one `Engine`, a record that is found by its name. Other packages declare theirs by
the entry point group `rocking.engines`. The record loads the adapter when it is first needed. The adapter, a module of
its own, holds

- ``VARIANTS``: {name: `Variant`}; the first is the main variant, taken where none is named;
- ``versions()``: {package: version} of what computes;
- ``run(scene, variant, settings)``: a `Run` of a scene with a duration; `variant` is a name, `settings` an instance of
  that variant's dataclass, both checked. Where the motion has a `vertical` one, the block's weight is m (g + a_v);
- ``run_stack(scene, variant, settings)``, if it builds a free pedestal under the block: a `Run` with the trace of
  `engines.stack`. ``NO_STACK``: otherwise why not, in words that follow "not supported by NAME".

All else is the same for every engine and is done in `engines.simulating`: settings are checked, a scene without a
duration runs until its outcome is decided, events and peaks are located outside the engine, and the response is
compared with the analytic model.

Beside its adapter an engine defines the rows of its agreement tolerances (`ToleranceRow`), and the mistakes that are
easily made in a script of it (`Mistake`): each a few replacements of text. What they cost is measured by
``rocking study mistakes``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from importlib import import_module
from importlib.metadata import entry_points
from types import ModuleType
from typing import TYPE_CHECKING, Any

from analytic.errors import EngineBroken, EngineNotInstalled
from analytic.motion import SampledMotion

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from analytic import Scene
    from analytic.response import Caution, Failure

    from .swings import Trace

# Kinds of a variant. "defaults": the engine as it comes, used as in a first script. "tuned": only the engine moves a
# body or sets a velocity. "assisted": the adapter sets a velocity, a position or a constraint by the model's event.
KINDS = ("defaults", "tuned", "assisted")
EXTRA = 'pip install -e ".[{}]" in a checkout of this project'  # how to install an engine that is an extra
STEPS = ("step", "largest_step", "longest_step")  # names of the setting that bounds the step [s]


class Mismatch(RuntimeError):
    """An engine holds other values than the scene asks for."""


@dataclass(frozen=True)
class Variant:
    """One engine choice: its settings, its kind, its levels, and what is known of it.

    Parameters
    ----------
    settings : object
        Instance of a frozen dataclass of numbers above 0, the accuracy parameter first. The scene's coefficient of
        friction, where it has one, replaces a field ``friction``.
    kind : str
        One of `KINDS`: what the engine computes on its own. The key "tier" in JSON and in stored rows.
    levels : tuple of float
        Values of the accuracy parameter from coarse to fine, the default among them.
    computes, imposes : str
        What the engine computes, and what the adapter imposes beside the bearing force, the ground acceleration and
        the settings; in words.
    calls : dict
        {a call of the engine's API that the adapter makes, with its values; or an assignment that the calls need: why},
        in Python and the names of a script of `engines.scripting`, for a block on bearings.
    takes_restitution : bool
        A scene may give the restitution: the adapter applies the impact (kind assisted), or a couple before each
        landing (`engines.loads`).
    finer : tuple of dict
        Settings to try in turn where a run is not right; by default the levels finer than the default.
    varied : dict
        {setting: values}: settings, changed one at a time, on which the variant's error may depend.
    constants : dict
        {name: what it is}: numbers that were chosen and that affect a run. A name is a setting, or "module:NAME" of a
        module-level number. Numbers that follow from a formula, or that only end a failed run, are left out.
    friction : float or None
        Coefficient of friction of the contact where the scene gives none, if it is low enough for a block to slide.
    flight_damping : float or None
        Coefficient d [1/s] of a built-in damping in flight: force d m v (1 + |v|), moment d I w (1 + |w|), SI units.
    faults : str
        What the engine is known to get wrong in scenes of the studies, in words; shown where such scenes are run.
    free_block : str or None
        ``module:function``, called as a solver with ``step`` [s]: the variant with a free block of six degrees of
        freedom.

    Raises
    ------
    ValueError
        The kind is unknown, the levels lack the default, or a value is given for a setting that does not exist.
    """

    settings: Any
    kind: str
    levels: tuple[float, ...]
    computes: str
    imposes: str
    calls: dict[str, str] = field(default_factory=dict)
    takes_restitution: bool = False
    finer: tuple[dict[str, float], ...] = ()
    varied: dict[str, tuple[float, ...]] = field(default_factory=dict)
    constants: dict[str, str] = field(default_factory=dict)
    friction: float | None = None
    flight_damping: float | None = None
    faults: str = ""
    free_block: str | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind = {self.kind!r}: choose one of {', '.join(KINDS)}")
        if self.default not in self.levels:
            raise ValueError(
                f"levels = {self.levels!r}: it lacks the default, {self.accuracy_parameter} = {self.default!r}"
            )
        if not self.finer:
            beyond = self.levels[self.levels.index(self.default) + 1 :]
            object.__setattr__(self, "finer", tuple({self.accuracy_parameter: value} for value in beyond))
        known = {setting.name for setting in dataclasses.fields(self.settings)}
        settings = [name for name in self.constants if ":" not in name]
        if strange := sorted(set(self.varied).union(settings, *self.finer) - known):
            words = "no setting (named in varied, finer or constants)"
            raise ValueError(f"{strange[0]!r} is {words}: its settings are {', '.join(known)}")

    @property
    def accuracy_parameter(self) -> str:
        """Name of the accuracy parameter."""
        return dataclasses.fields(self.settings)[0].name

    @property
    def applies_impact(self) -> bool:
        """Whether the adapter, not the engine, applies every impact."""
        return self.kind == "assisted"

    @property
    def default(self) -> float:
        """Value of the accuracy parameter."""
        return getattr(self.settings, self.accuracy_parameter)

    @property
    def step(self) -> str | None:
        """Name of the setting that bounds the step [s], one of `STEPS`; None where there is none."""
        names = [setting.name for setting in dataclasses.fields(self.settings)]
        return next((name for name in STEPS if name in names), None)


@dataclass(frozen=True)
class Run:
    """The result of one run, as an adapter returns it.

    trace: the accepted steps, None if there are fewer than two. steps: their number. cpu_seconds: of the stepping
    alone. failure: what the engine or the adapter found wrong. ended: "overturned" if the run was stopped at
    overturning. warnings: `Caution` records, or sentences that are shown as they are.
    """

    trace: Trace | None
    steps: int
    cpu_seconds: float
    failure: Failure | None = None
    ended: str | None = None
    warnings: tuple[Caution | str, ...] = ()


@dataclass(frozen=True)
class Engine:
    """The record of an engine. Its package is imported only when more than the record is needed.

    Parameters
    ----------
    name : str
        The name in commands and results.
    package : str
        The Python package that must be importable.
    install : str
        How to install it.
    colour, marker : str
    dashes : str or tuple
        Style in all figures; `dashes` is a line style of matplotlib, named or as (0, (6, 1)).
    adapter : str
        Name of the module with ``VARIANTS``, ``versions`` and ``run``.
    imported : str or None
        Name of a module that imports the package, if the import needs preparation.
    tolerances : str or None
        Name of a module whose ``TOLERANCES``, {variant: tuple of `ToleranceRow`}, are the engine's rows of the
        tolerance table.
    script : str or None
        ``package:file``: the template of a script of one scene, see `engines.scripting`.
    mistakes : str or None
        Name of a module whose ``MISTAKES``, a tuple of `engines.contract.Mistake`, are made in that script.
    subject : bool
        The studies are about this engine; engines that are no subject are shown for comparison.
    title : str
        The name as its makers write it, shown on pages; "": `name`.
    origin : str
        The entry point that declared an engine of another package; "" for engines of this project.
    """

    name: str
    package: str
    install: str
    colour: str
    marker: str
    adapter: str
    dashes: str | tuple[float, tuple[float, ...]] = "-"
    imported: str | None = None
    tolerances: str | None = None
    script: str | None = None
    mistakes: str | None = None
    subject: bool = False
    title: str = ""
    origin: str = ""

    def load(self) -> ModuleType:
        """Import the adapter's module.

        Raises
        ------
        EngineNotInstalled
            The engine's package cannot be imported; the message says how to install it.
        EngineBroken
            The adapter of another package cannot be imported, or lacks what the contract asks for. An adapter of this
            project raises its own error, which must not be mistaken for an absent package.
        """
        try:
            for name in filter(None, (self.imported, self.package)):
                import_module(name)
        except ImportError as error:
            raise EngineNotInstalled(
                f"engine {self.name!r} needs the package {self.package}: {self.install}"
            ) from error
        if not self.origin:
            return import_module(self.adapter)
        for name in filter(None, (self.tolerances, self.adapter)):
            try:
                module = import_module(name)
            except Exception as error:
                raise EngineBroken(
                    self.origin, f"its module {name} cannot be imported ({type(error).__name__}: {error})"
                ) from error
        variants = getattr(module, "VARIANTS", None)
        if not (isinstance(variants, dict) and variants and all(isinstance(v, Variant) for v in variants.values())):
            raise EngineBroken(self.origin, f"{self.adapter}.VARIANTS is no dict of engines.contract.Variant")
        missing = [name for name in ("versions", "run") if not callable(getattr(module, name, None))]
        if missing:
            raise EngineBroken(self.origin, f"{self.adapter} has no function {' and no '.join(missing)}")
        return module

    def tolerance_rows(self) -> dict[str, tuple[ToleranceRow, ...]]:
        """The engine's rows of the tolerance table, by variant.

        The package need not be installed. A broken engine of another package has no rows.
        """
        if not self.tolerances or (self.origin and not self.installed):
            return {}
        return import_module(self.tolerances).TOLERANCES

    def known_mistakes(self) -> dict[str, Mistake]:
        """The engine's mistakes, {key: mistake}; its package need not be installed."""
        return {mistake.key: mistake for mistake in import_module(self.mistakes).MISTAKES} if self.mistakes else {}

    @property
    def installed(self) -> bool:
        """Whether the engine can be used here."""
        try:
            self.load()
        except EngineNotInstalled:
            return False
        return True

    @property
    def variants(self) -> dict[str, Variant]:
        """The engine's variants, {name: variant}; the first is the main one."""
        return self.load().VARIANTS

    @property
    def default_variant(self) -> str:
        """Name of the main variant, which is taken where none is named."""
        return next(iter(self.variants))

    def versions(self) -> dict[str, str]:
        """Versions that determine the result: {package: version}.

        Raises
        ------
        EngineBroken
            The function ``versions`` of another package's adapter fails.
        """
        adapter = self.load()
        if not self.origin:
            return adapter.versions()
        try:
            return {str(package): str(version) for package, version in adapter.versions().items()}
        except Exception as error:
            words = f"{self.adapter}.versions fails ({type(error).__name__}: {error})"
            raise EngineBroken(self.origin, words) from error


# Sources of error that several engines share.
STEP = "step; first order, by the phase of the impact in it"
LARGE_STEP = "steps in flight and at rest"
HELD = "what the contact gives at rest"
READING = "steps, and their force and momentum as read between them"
ROUNDING = "history committed once per accepted step; round-off"


@dataclass(frozen=True)
class ToleranceRow:
    """A row of the tolerance table: the error of `quantity` over `scenes` is at most `bound`.

    `measured`: the worst value found when the bound was set. `source`: the cause of the error. Where the source is
    `ROUNDING`, the bound is a requirement, and the measured value is far below it.
    """

    quantity: str
    scenes: str
    bound: float
    measured: float
    source: str


GROUP = "rocking.engines"
RESERVED = ("analytic",)  # the model's name among the solvers


def find_engines(taken: Collection[str]) -> tuple[dict[str, Engine], dict[str, EngineBroken]]:
    """Return the engines that other packages declare: ({name: `Engine`}, {entry: `EngineBroken`} of unusable ones).

    Parameters
    ----------
    taken : collection of str
        Names that are already in use.
    """
    engines: dict[str, Engine] = {}
    broken: dict[str, EngineBroken] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, _distribution(entry))):
        origin = f"engine {entry.name!r}, declared as {entry.value} by the distribution {_distribution(entry)}"
        try:
            engine = _resolve(entry, origin, (*RESERVED, *taken, *engines))
        except EngineBroken as error:
            key = entry.name
            if key in (*RESERVED, *taken, *engines, *broken):
                key = f"{entry.name} of {_distribution(entry)}"
            broken[key] = error
        else:
            engines[engine.name] = engine
    return engines, broken


def _resolve(entry: EntryPoint, origin: str, taken: Collection[str]) -> Engine:
    try:
        engine = entry.load()
    except Exception as error:  # any error while another package is imported
        raise EngineBroken(origin, f"it cannot be imported ({type(error).__name__}: {error})") from error
    if not isinstance(engine, Engine):
        raise EngineBroken(origin, f"it is a {type(engine).__name__}, no engines.contract.Engine")
    if engine.name != entry.name:
        raise EngineBroken(origin, f"it calls itself {engine.name!r}: entry and engine need one name")
    if engine.name in taken:
        raise EngineBroken(origin, "that name is taken")
    return replace(engine, origin=origin)


def _distribution(entry: EntryPoint) -> str:
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else "of no name"


NO_MATTER = "no matter"  # changes that look like mistakes
GROUPS = ("body", "contact", "steps", "forces", "motion", NO_MATTER)


@dataclass(frozen=True)
class Mistake:
    """A mistake that is easily made in a script, as data.

    Parameters
    ----------
    key : str
        Its name in results, a word or two.
    done : str
        What was done, as a user would say it.
    group : str
        What it concerns, one of `GROUPS`.
    replacements : dict
        {text of the script: what stands there instead}; each text occurs once.
    needs : str
        Part of a scene without which it cannot be made: "base", "bearings", "motion", or "record", a sampled motion;
        several, separated by spaces; "" for none.

    Raises
    ------
    ValueError
        The group is unknown.
    """

    key: str
    done: str
    group: str
    replacements: dict[str, str]
    needs: str = ""

    def __post_init__(self) -> None:
        if self.group not in GROUPS:
            raise ValueError(f"mistake {self.key}: group {self.group!r}; choose one of {', '.join(GROUPS)}")

    def fits(self, scene: Scene) -> bool:
        """Whether the mistake can be made in a script of the scene."""
        sampled = isinstance(scene.motion, SampledMotion) or None
        return all((sampled if part == "record" else getattr(scene, part)) is not None for part in self.needs.split())

    def made(self, script: str) -> str:
        """Return the script with the mistake.

        Raises
        ------
        ValueError
            A text to be replaced does not occur exactly once.
        """
        for old, new in self.replacements.items():
            if (count := script.count(old)) != 1:
                raise ValueError(
                    f"mistake {self.key}: its text {old!r} occurs {count} times in the script, and must occur once: "
                    "take the text from the engine's template as it is now"
                )
            script = script.replace(old, new)
        return script
