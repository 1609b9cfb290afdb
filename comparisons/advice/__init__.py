"""Advice on one's own scene: which setting of which engine suffices, and what need not be modelled."""

from .answer import Choice
from .choose import choose

__all__ = ["Choice", "choose"]
