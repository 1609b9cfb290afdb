"""Bases on stiff or viscous bearings in a leapfrog engine."""

import math

import pytest

from engines.vibration import added_mass


def test_mass_added_for_damping_is_exact_and_bounded():
    """v' after an interval under c v alone: v exp(-c t/m)."""
    for damping in (1e-9, 1.0, 50.0, 1e9):
        added = added_mass(damping, 0.1, 2.0)
        after = 1 - damping * 0.1 / (2.0 + added)
        assert after == pytest.approx(math.exp(-damping * 0.05), abs=1e-9)
