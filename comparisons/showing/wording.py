"""Text of others (names, paths, values, messages) as it may be shown: printable, on one line, of readable length."""

MOST_CHARACTERS = 600
# Root mean square error of restitution: measured restitution of stone scatters by some per cent.
TRUSTED, USABLE = 1e-3, 1e-2


def readable(text, most=MOST_CHARACTERS):
    """`text` with its middle left out beyond `most` characters; what is not printable is shown as its code."""
    text = str(text)
    if len(text) > most:  # both ends matter: what it is about, and what to do
        tail = most // 3
        text = text[:most - tail] + " [...] " + text[-tail:]
    return "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in text)


def solver_name(solver, variant=None):
    """A solver as tables and plots call it."""
    return solver if variant is None else f"{solver}, {variant}"


def trust(rms, failed):
    """May restitution be trusted at this root mean square error, None for none, and number of failed runs? In words."""
    if rms is not None and not failed:
        if rms <= TRUSTED:
            return "may be trusted"
        if rms <= USABLE:
            return "is usable where a per cent does not matter"
    return "is not to be trusted"
