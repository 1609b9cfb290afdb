"""``rocking engines``: what can be used here, and how it can be set."""


def command() -> None:
    """List the engines: version, variants with rung and settings, where each is verified, and who decides what.

    Example: rocking engines
    """
    from rich.console import Console

    from analytic.errors import EngineBroken, EngineNotInstalled
    from engines import BROKEN, ENGINES, get_engine, missing_words

    from ..running.solving import stdout_to_stderr
    from ..showing.tables import engine_text

    console = Console(highlight=False, soft_wrap=True)
    missing: dict[str, str] = {}
    for name in (*ENGINES, *BROKEN):
        try:
            with stdout_to_stderr():  # engines greet on standard output
                text = engine_text(get_engine(name))
        except EngineBroken as error:
            text = f"{name}: cannot be used. {error}\n"
        except EngineNotInstalled as error:
            missing[name] = str(error)
            continue
        console.print(text, markup=False)
    for words in missing_words(missing):
        console.print(f"{words}", markup=False)
