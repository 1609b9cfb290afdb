"""Words that several pages share."""

# Root mean square error of restitution: measured restitution of stone scatters by some per cent.
TRUSTED, USABLE = 1e-3, 1e-2


def solver_name(solver: str, variant: str | None = None) -> str:
    """A solver as tables and plots call it."""
    return solver if variant is None else f"{solver}, {variant}"


def trust(rms: float | None, failed: int) -> str:
    """May restitution be trusted at this root mean square error, None for none, and number of failed runs? In words."""
    if rms is not None and not failed:
        if rms <= TRUSTED:
            return "may be trusted"
        if rms <= USABLE:
            return "is usable where a per cent does not matter"
    return "is not to be trusted"
