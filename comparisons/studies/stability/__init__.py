"""Numerical stability: which solver survives which hard case, with evidence and cures."""

from ...running.study import Study
from .finding import finding, judgement
from .page import pictures, section
from .verdicts import plan

STUDY = Study(
    "stability",
    "Named hard cases, every solver and variant: right, degraded or failed, with measures, evidence and cures.",
    plan,
    pictures,
    section,
    finding=finding,
    judgement=judgement,
)
