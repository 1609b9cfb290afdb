"""Engines that other packages declare, by the entry point group `rocking.engines`; each entry is an `Engine`."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from importlib.metadata import entry_points
from typing import TYPE_CHECKING

from analytic.errors import EngineBroken

from .contract import Engine

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "rocking.engines"
RESERVED = ("analytic",)  # the model's name among the solvers


def find_engines(taken: Collection[str]) -> tuple[dict[str, Engine], dict[str, EngineBroken]]:
    """({name: `Engine`} of the engines declared here, {entry: `EngineBroken`} of those that cannot be used).

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
