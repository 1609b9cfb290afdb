"""The variants of the subject engines with their own values: settings with the default level, levels and calls, as
``rocking engines NAME`` prints them. The class of the settings, linked before them, has defaults, in place of which a
variant may have other values. Of engines that are extras the command prints the same."""

from __future__ import annotations

from engines import ENGINES, Engine, available_engines, get_engine

from ..running.progress import stdout_to_stderr
from .terminal import engine_text


def _section(engine: Engine) -> str:
    """Of this page, in Markdown: where the settings of each variant are explained, and their values."""
    kinds = {name: type(variant.settings) for name, variant in engine.variants.items()}
    explained = ", ".join(f"{name} `{kind.__module__}.{kind.__qualname__}`" for name, kind in kinds.items())
    return f"\n\n## {engine.name}\n\nSettings: {explained}.\n\n```text\n{engine_text(engine)}```"


with stdout_to_stderr():  # engines print on import
    _names = available_engines(name for name, engine in ENGINES.items() if engine.subject)[0]
    __doc__ += "".join(_section(get_engine(name)) for name in _names)
