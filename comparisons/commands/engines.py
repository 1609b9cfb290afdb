"""``rocking engines``: what can be used here, and how it can be set."""

from typing import Annotated

import typer


def command(name: Annotated[str | None, typer.Argument(help="Tell all of this engine.")] = None) -> None:
    """List the engines and their variants: tier, what the engine computes, and what our adapter imposes on it.

    With a name: its versions, settings and refinement levels, too.

    Example: rocking engines exudyn
    """
    from rich.console import Console

    from engines import BROKEN, available_engines, get_engine, missing_words

    from ..running.solving import named_engines, stdout_to_stderr
    from ..showing.tables import engine_text, engines_table

    console = Console(highlight=False)
    with stdout_to_stderr():  # engines greet on standard output
        names, missing = ((), {}) if name else available_engines()
        shown = [get_engine(one) for one in (named_engines([name]) if name else names)]
        for engine in shown:
            engine.load()
    if name:
        console.print(engine_text(shown[0]), markup=False, soft_wrap=True)
        return
    console.print(engines_table(shown))
    for words in missing_words(missing):
        console.print(words, markup=False, soft_wrap=True)
    for broken, error in BROKEN.items():
        console.print(f"{broken}: cannot be used. {error}", markup=False, soft_wrap=True)
