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
        pytest.param("comparisons.advice.choose", marks=pytest.mark.long),
        pytest.param("comparisons.measuring.tolerances", marks=pytest.mark.long),
        pytest.param("comparisons.report.study", marks=pytest.mark.long),
    ],
)
def test_examples(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted and not found.failed
