"""Types that signatures share; a type checker reads them, nothing runs them."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

GroundFunction = Callable[[float], float]  # a_g(t) [m/s2] of one time [s]
Values = TypeVar("Values", float, np.ndarray)  # one value, or an array of them: what goes in comes out
