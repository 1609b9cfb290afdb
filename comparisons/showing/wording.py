"""Words that several pages share."""

from collections.abc import Iterable

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference

# Root mean square error of restitution: measured restitution of stone scatters by some per cent.
TRUSTED, USABLE = 1e-3, 1e-2


RATINGS = {
    "good": "may be trusted",
    "fair": "is usable where a per cent does not matter",
    "bad": "is not to be trusted",
}


def rating(rms: float | None, failed: int) -> str:
    """The level, a key of `RATINGS`, of a root mean square error of restitution, None for none, and of failed runs."""
    if rms is None or failed:
        return "bad"
    return "good" if rms <= TRUSTED else "fair" if rms <= USABLE else "bad"


def trust(rms: float | None, failed: int) -> str:
    """The `rating` in words."""
    return RATINGS[rating(rms, failed)]


def differing(comparable: str, differences: Iterable[Difference]) -> list[str]:
    """In what a run differs from the analytic model, or why it cannot be compared: the end of a sentence, or none."""
    found = "; ".join(map(str, differences))
    if comparable == COMPARED:
        return [f"differs from the analytic model: {found}"] if found else []
    if comparable == EDGE:
        return [f"is {EDGE}, where a change of the scene by 1e-4 makes such a difference: {found}"]
    return [] if comparable == UNCOMPARED else [f"cannot be compared with the analytic model: {comparable}"]
