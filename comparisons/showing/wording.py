"""Words that several pages share."""

from collections.abc import Iterable

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference

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


def differing(comparable: str, differences: Iterable[Difference]) -> list[str]:
    """In what a run differs from the analytic model, or why it cannot be compared: the end of a sentence, or none."""
    found = "; ".join(map(str, differences))
    if comparable == COMPARED:
        return [f"differs from the analytic model: {found}"] if found else []
    if comparable == EDGE:
        return [f"is {EDGE}, where a change of the scene by 1e-4 makes such a difference: {found}"]
    return [] if comparable == UNCOMPARED else [f"cannot be compared with the analytic model: {comparable}"]
