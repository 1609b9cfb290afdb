"""The same scene in multibody engines: ``get_engine("exudyn").simulate(scene)``.

An engine is a package with an `engines.contract.Engine` called ``ENGINE``. The folders here are this project's own;
other packages declare theirs (`engines.contract`).

Each engine has one or more variants, of three kinds. ``defaults``: the engine as it comes, used as in a first script.
``tuned``: only the engine moves a body or sets a velocity; the adapter chooses what a skilled user could choose in any
scene. ``assisted``: the adapter sets a velocity, a position or a constraint by the model's event. No tuned variant uses
the formula of the restitution: with another formula every trace stays the same, bit for bit
(``tests/engines/test_contract.py``).

Examples
--------
>>> from analytic import load_scene, simulate
>>> scene = load_scene("free-rocking-rigid")
>>> engine = get_engine("exudyn")
>>> response = engine.simulate(scene)  # in its main variant; engine.variants lists all
>>> abs(response.impacts[0].rate_after / simulate(scene).impacts[0].rate_after - 1) < 1e-5
True
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib import import_module
from pkgutil import iter_modules

from analytic.errors import EngineNotInstalled

from .contract import EXTRA, Engine, find_engines
from .simulating import Simulator

# Engines are imported by name, not by statement, so that a result of one engine does not depend on the other engines.
# The subject engines come first.
_records: list[Engine] = [
    import_module(f"{__name__}.{package.name}").ENGINE for package in iter_modules(__path__) if package.ispkg
]
_declared = {engine.name: engine for engine in sorted(_records, key=lambda engine: (not engine.subject, engine.name))}
BUILT_IN = tuple(_declared)
_found, BROKEN = find_engines(_declared)  # BROKEN: the errors of entries that hold no engine, by name
ENGINES = {name: Simulator.of(engine) for name, engine in (_declared | _found).items()}
Simulator.known = ENGINES


def get_engine(name: str) -> Simulator:
    """The engine called `name`, with its adapter loaded.

    Raises
    ------
    KeyError
        The name is unknown; the message lists the known ones.
    EngineNotInstalled
        The engine's package cannot be imported; the message says how to install it.
    EngineBroken
        Another package declares it, and it cannot be used; the message names who declares it.
    """
    if name in BROKEN:
        raise BROKEN[name]
    if name not in ENGINES:
        raise KeyError(f"unknown engine {name!r}: choose one of {', '.join(ENGINES)}")
    ENGINES[name].load()
    return ENGINES[name]


def available_engines(names: Iterable[str] | None = None) -> tuple[tuple[str, ...], dict[str, str]]:
    """Sort engines: (those of `names` that can be used, {name: why not} for the others); None: all that are declared.

    Raises
    ------
    ImportError
        An adapter of this project is broken, which must not be mistaken for an absent package.
    """
    present, missing = [], {}
    for name in (*ENGINES, *BROKEN) if names is None else names:
        try:
            get_engine(name)
        except EngineNotInstalled as error:
            missing[name] = str(error)
        else:
            present.append(name)
    return tuple(present), missing


def missing_words(missing: Mapping[str, str]) -> list[str]:
    """Sentences on the `missing` engines of `available_engines`, with all extras of this project in one line."""
    extras = [name for name in missing if name in ENGINES and ENGINES[name].install == EXTRA.format(name)]
    words = [why for name, why in missing.items() if name not in extras]
    if extras:
        words.append(f"not installed: {', '.join(extras)}; {EXTRA.format(','.join(extras))}")
    return words


def installed_engines() -> tuple[str, ...]:
    """Names of the engines that can be used here."""
    return available_engines()[0]
