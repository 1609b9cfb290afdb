"""What an engine holds is compared with what it was given; the message names all that differs."""

import math

import numpy as np
import pytest

from engines.contract import Mismatch
from engines.readback import require


def test_round_off_and_one_number_for_all_pass():
    require(
        [
            ("mass", 3172.05 * (1 + 5e-13), 3172.05),
            ("damping", np.zeros(4), 0.0),
            ("gravity", [0, 0, -9.81], np.array([0.0, 0.0, -9.81])),
            ("contact", [1.0, 1.0], [1.0]),
        ]
    )


@pytest.mark.parametrize(
    "used, wanted, words",
    [
        (3172.05 * (1 + 3e-12), 3172.05, "mass is 3172.05"),
        (math.nan, 1.0, "mass is nan, not 1.0"),
        (0, 1, "mass is 0, not 1"),
        ([1.0, 2.0], [1.0, 3.0], r"mass is \[1.0, 2.0\], not \[1.0, 3.0\]"),
        ([1.0, 2.0], [1.0, 2.0, 3.0], "mass is"),
        (np.zeros(3), 1e-13, "mass is"),
    ],
)
def test_what_differs_is_named(used, wanted, words):
    values = [("step", 1.0, 1.0), ("mass", used, wanted), ("friction", 0.5, 0.7)]
    with pytest.raises(Mismatch, match=f"^{words}.*; friction is 0.5, not 0.7$"):
        require(values)
