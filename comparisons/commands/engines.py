"""``rocking engines``: what can be used here, and how it can be set."""


def command():
    """List the engines: version, what each decides by itself, variants with their settings (the knob first)."""
    from rich.console import Console

    from analytic.errors import EngineNotInstalled
    from engines import ENGINES, get_engine

    from ..solving import stdout_to_stderr
    from ..tables import engine_text

    console = Console(highlight=False, soft_wrap=True)
    for name in ENGINES:
        try:
            with stdout_to_stderr():
                engine = get_engine(name)
        except EngineNotInstalled as error:
            console.print(f"{name}: not installed. {error}\n", markup=False)
            continue
        console.print(engine_text(name, engine), markup=False)
