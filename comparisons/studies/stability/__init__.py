"""Numerical stability: which solver gets which hard case right, where it does not, and which finer settings do."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "stability",
    "Named hard cases in every solver and variant: right, differs or failed, with measures, evidence, finer settings.",
    plan,
    f"{__name__}.page",
)
