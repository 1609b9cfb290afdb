"""The campaigns that this process has read: a page may draw their tests one by one, which no result holds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .campaign import Campaign


@dataclass(frozen=True, eq=False)
class AtHand:
    """probabilities: of overturning by the model, held out, shape (tests,), of each specimen."""

    campaign: Campaign
    probabilities: Sequence[np.ndarray]


_READ: dict[str, AtHand] = {}


def keep(campaign: Campaign, probabilities: Sequence[np.ndarray]) -> None:
    """Have it at hand for the page that is written next."""
    _READ[campaign.digest()] = AtHand(campaign, probabilities)


def of(settings: Mapping[str, Any]) -> AtHand | None:
    """The campaign that a result was computed with, if this process has read it."""
    return _READ.get(settings.get("digest", ""))
