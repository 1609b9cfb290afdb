"""The kernel of the analytic model against other integrators, and what it costs at its work."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "kernel",
    "The analytic model's kernel against other integrators: error and CPU time of the same runs.",
    plan,
    f"{__name__}.page",
    all_engines=False,
    whole="its CPU times are compared with each other, so they have to be measured together",
)
