"""The campaigns that this process has read: a page may draw their tests one by one, which no result holds."""

from typing import Any

from .campaign import Campaign

_READ: dict[str, Campaign] = {}


def keep(campaign: Campaign) -> None:
    """Have it at hand for the page that is written next."""
    _READ[campaign.digest()] = campaign


def of(settings: dict[str, Any]) -> Campaign | None:
    """The campaign that a result was computed with, if this process has read it."""
    return _READ.get(settings.get("digest", ""))
