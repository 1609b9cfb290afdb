"""Types used in signatures, for a type checker."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

GroundFunction = Callable[[float], float]  # a_g(t) [m/s2] of one time [s]
Values = TypeVar("Values", float, np.ndarray)  # a number or an array; the result has the type of the argument
