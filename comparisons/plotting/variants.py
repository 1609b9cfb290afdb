"""Engines and their variants in the terminal: the texts of ``rocking engines``.

The reference adds here the variants of the subject engines (`Engine.subject`: those that the studies are about), as
``rocking engines NAME`` prints them, with settings, default level, levels and calls. The linked class explains the
settings; a variant may have other values than the class's defaults. The command prints the same of all other engines.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Collection, Sequence

from rich.text import Text

from engines import ENGINES, available_engines, get_engine
from engines.contract import Engine, Variant
from engines.simulating import in_words

from ..execution.progress import stdout_to_stderr
from .terminal import Grid, grid

NAMES_OF_CALLS = "g, m, R, gamma, J, mb, b, h: as in its script; scale: sqrt(R/1.0884 m)"


def engines_table(engines: Sequence[Engine]) -> Grid:
    """Return a table of all variants: kind, what the engine computes and what the adapter imposes."""
    caption = Text(f"Tested for {in_words()}.\nrocking engines NAME: settings, levels, calls, versions.")
    heads = ["engine", "variant", "kind", "the engine computes", "the adapter imposes"]
    rows = [
        [engine.name if name == engine.default_variant else "", name, variant.kind, variant.computes, variant.imposes]
        for engine in engines
        for name, variant in engine.variants.items()
    ]
    return grid(heads, rows, left=heads, wraps=heads[3:], show_edge=False, caption=caption, caption_justify="left")


def engine_text(engine: Engine) -> str:
    """Return the description of an `Engine` in lines: its versions, and each of its variants.

    Of a variant: kind, settings (the accuracy parameter first), levels, what the engine computes, what the adapter
    imposes, known faults, and the engine's calls.
    """
    versions = ", ".join(f"{package} {version}" for package, version in engine.versions().items())
    lines, shown = [f"{engine.name} ({versions})"], set[str]()
    if engine.script:
        lines.append(f"  rocking script {engine.name} SCENE writes the main variant out, as a plain script of a scene.")
    for name, variant in engine.variants.items():
        default = "main, " if name == engine.default_variant else ""
        values = [f"{field}={value:.6g}" for field, value in dataclasses.asdict(variant.settings).items()]
        values[:1] = [f"{value} (accuracy parameter)" for value in values[:1]]
        lines += [
            f"  --variant {name} ({default}{variant.kind}){'' if variant.calls else f': {_about(variant)}'}",
            f"      settings: {', '.join(values)}",
            f"      levels, coarse to fine: {', '.join(f'{value:.4g}' for value in variant.levels)}",
            f"      the engine computes: {variant.computes}",
            f"      the adapter imposes: {variant.imposes}",
            *([f"      known faults: {variant.faults}"] if variant.faults else ()),
            *_calls(variant, shown),
        ]
        shown.update(variant.calls)
    return "\n".join(lines) + "\n"


def _calls(variant: Variant, shown: Collection[str]) -> list[str]:
    """Return the lines of a variant's calls, without those already shown."""
    if not variant.calls:
        return []
    fresh = {call: why for call, why in variant.calls.items() if call not in shown}
    beside = ", beside some of the above" if len(fresh) < len(variant.calls) else ""
    head = f"      the engine's calls{beside}, of a block on bearings ({NAMES_OF_CALLS}):"
    return [head, *(f"        {call}{f'  # {why}' if why else ''}" for call, why in fresh.items())]


def _about(variant: Variant) -> str:
    """Return the first paragraph of the docstring of a variant's settings."""
    return (inspect.getdoc(type(variant.settings)) or "").split("\n\n")[0].replace("\n", " ")


def _section(engine: Engine) -> str:
    """Return an engine's section of this module's documentation, in Markdown."""
    kinds = {name: type(variant.settings) for name, variant in engine.variants.items()}
    explained = ", ".join(f"{name} `{kind.__module__}.{kind.__qualname__}`" for name, kind in kinds.items())
    return f"\n\n## {engine.name}\n\nSettings: {explained}.\n\n```text\n{engine_text(engine)}```"


with stdout_to_stderr():  # engines print on import
    _names = available_engines(name for name, engine in ENGINES.items() if engine.subject)[0]
    __doc__ += "".join(_section(get_engine(name)) for name in _names)
