"""Numbers as the pages write them, read back."""

import re

PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")


def number_in(cell):
    """The number that a cell begins with: 1.5, −3 or 1.5·10⁻⁵."""
    found = re.match(r"([−\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?", cell)
    return float(f"{found[1]}e{found[2] or 0}".translate(PLAIN))
