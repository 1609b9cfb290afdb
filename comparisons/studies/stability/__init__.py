"""Numerical stability: hard cases in all solvers, whether they are right, and whether finer levels are."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "stability",
    "Named hard cases in every solver and variant: right, differs or failed, with measures, evidence, finer levels.",
    plan,
    f"{__name__}.page",
)
