"""Advice on a scene: the variant and level that are accurate enough, and what need not be modelled."""

from .answer import Choice
from .choose import choose

__all__ = ["Choice", "choose"]
