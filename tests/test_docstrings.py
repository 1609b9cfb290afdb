"""The examples in docstrings give what they say."""

import doctest
import importlib

import pytest


@pytest.mark.parametrize(
    "module",
    [
        "analytic",
        "analytic.batch",
        "analytic.new_scene",
        "analytic.records",
        "engines",
        "comparisons.showing.plots",
        "comparisons.sheet.pages",
        pytest.param("comparisons.advice.choose", marks=pytest.mark.slow),
        pytest.param("comparisons.measuring.tolerances", marks=pytest.mark.slow),
        pytest.param("comparisons.report.study", marks=pytest.mark.slow),
    ],
)
def test_examples(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted and not found.failed
