"""External text (names, paths, values, messages) made printable, on one line and of readable length."""

MOST_CHARACTERS = 600


class Mendable(RuntimeError):
    """An error that a user can correct with its message; shown without a traceback."""


def readable(text: object, most: int = MOST_CHARACTERS) -> str:
    """`text` with its middle left out beyond `most` characters; what is not printable is shown as its code."""
    text = str(text)
    if len(text) > most:  # both ends matter: what it is about, and what to do
        tail = most // 3
        text = text[: most - tail] + " [...] " + text[-tail:]
    return "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in text)
