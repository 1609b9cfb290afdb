"""The page of a statue on a free pedestal: who is right, what falls first, and where the model has no answer."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from engines.comparison import CHANGE

from ...execution.results import Result
from ...plotting.figures import FOUND, LARGEST, MEDIAN, SHIFT, Series, beside, failures, lines, missing, strip, summary
from ...plotting.glance import Glance, counted
from ...plotting.parts import Head, Page, grouped, table, where
from ...plotting.wording import ends, ends_in_words, tally
from ...schemas.columns import NAME, Column, number, percent
from .study import BUST, COLUMNS, DESIGN, FALLS, HEIGHT, MOST, PLATE, SECONDS, STEP, STRONGER, WIDE, WIDTH

SHIFTS = {"shift", "check"}


def page(result: Result) -> Page:
    """Return the page of a result."""
    settings, counts, scenes = result.settings, tallies(result), where(result.rows, part="scene")
    setups, unique = where(result.rows, part="set-up"), where(result.rows, part="unique")
    first = {(row["way"], row["hertz"], row["width"]): row["fall"] for row in setups}
    chart = [row for row in setups if row["width"] == WIDTH and row["hertz"] in {hertz for _, hertz, _ in first if 1}]
    return Page("", ())
