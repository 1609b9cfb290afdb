"""What changes the outcome more often than the engine does: each uncertainty in turn, the engine's error among them."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "sensitivity",
    "What changes the outcome more often than the choice of the engine: vertical motion, a per cent of slenderness?",
    plan,
    f"{__name__}.page",
)
