"""``rocking engines``: what can be used here, and how it can be set."""


def command():
    """List the engines: version, what each decides by itself, variants with their settings (the knob first)."""
    from rich.console import Console

    from engines import ENGINES, available_engines, get_engine

    from ..running.solving import stdout_to_stderr
    from ..showing.tables import engine_text

    console = Console(highlight=False, soft_wrap=True)
    with stdout_to_stderr():  # engines greet on standard output
        _, missing = available_engines()
    for name in ENGINES:
        text = f"{name}: not installed. {missing[name]}\n" if name in missing else engine_text(name, get_engine(name))
        console.print(text, markup=False)
