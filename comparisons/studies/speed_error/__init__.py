"""Speed against error: what each solver costs at what error, on five scenes; and how the cost grows."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "speed-error",
    "Error and CPU time of the same runs: kernel, scipy, time stepping, Bouc-Wen, engines and variants.",
    plan,
    f"{__name__}.page",
    whole="its CPU times are compared with each other, so they have to be measured together",
)
