"""``rocking engines``: the engines that can be used here, and their variants."""

from typing import Annotated

import typer


def command(name: Annotated[str | None, typer.Argument(help="Engine to describe in full.")] = None) -> None:
    """List the engines and their variants: kind, what the engine computes, and what our adapter imposes on it.

    With a name: its versions, and the settings, the levels and the engine's own calls of each variant, too.

    Example: rocking engines exudyn
    """
    from engines import BROKEN, available_engines, get_engine, missing_words

    from ..running.progress import stdout_to_stderr
    from ..running.solving import named_engines
    from ..showing.terminal import echo, engine_text, engines_table

    with stdout_to_stderr():  # engines print on import
        names, missing = ((), {}) if name else available_engines()
        shown = [get_engine(one) for one in (named_engines([name]) if name else names)]
        for engine in shown:
            engine.load()
    if name:
        return echo(engine_text(shown[0]))
    broken = [f"{name}: cannot be used. {error}" for name, error in BROKEN.items()]
    echo(engines_table(shown), *missing_words(missing), *broken)
