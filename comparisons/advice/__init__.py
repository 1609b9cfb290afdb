"""Advice on a scene: the variant and level that are accurate enough, and what need not be modelled."""

from .choose import choose
from .criteria import Choice

__all__ = ["Choice", "choose"]
