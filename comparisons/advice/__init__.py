"""Advice on one's own scene: which setting of which engine suffices, and what need not be modelled."""

from .choose import choose
from .criteria import Choice

__all__ = ["Choice", "choose"]
