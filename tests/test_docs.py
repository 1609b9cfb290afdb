"""The reference that pdoc makes of the docstrings, and the examples in them."""

import doctest
import importlib
import re
import shlex
import subprocess
import sys
from typing import get_type_hints

import pytest
from test_readme import CONTRIBUTING, blocks

from analytic import scene as part

ADDRESS, PRIVATE = " at 0x", "FieldInfo"  # of an object of this process; how pydantic keeps a constraint
SCENE_PARTS = [one for one in part.Part.__subclasses__() if not one.__name__.startswith("_")]
QUICK = (
    "analytic",
    "analytic.batch",
    "analytic.scene_file",
    "analytic.records",
    "engines",
    "comparisons.plotting.plots",
)
LONGER = ("comparisons.advice.choose", "comparisons.metrics.agreement", "comparisons.report.runs")


@pytest.mark.parametrize("module", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in LONGER)])
def test_examples(module):
    found = doctest.testmod(importlib.import_module(module))
    assert found.attempted and not found.failed


@pytest.mark.parametrize("one", SCENE_PARTS, ids=lambda one: one.__name__)
def test_types_of_a_scene_read_as_they_are_written(one):
    hints = repr(get_type_hints(one, include_extras=True))
    assert ADDRESS not in hints and PRIVATE not in hints


@pytest.mark.long
@pytest.mark.timeout(1400)
def test_the_reference_is_made_without_a_word_and_the_same_each_time(tmp_path):
    pytest.importorskip("pdoc", reason="the extra docs is not installed")
    (block,) = (block for block in blocks("sh", CONTRIBUTING) if "/pdoc" in block)
    command = shlex.split(block.partition("/pdoc ")[2].replace("\\\n", " "))
    pages = []
    for name in ("first", "second"):
        words = [str(tmp_path / name) if word == "reference" else word for word in command]
        done = subprocess.run([sys.executable, "-m", "pdoc", *words], capture_output=True, text=True, timeout=600)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        files = [path for path in (tmp_path / name).rglob("*") if path.is_file()]
        pages.append({path.relative_to(tmp_path / name): path.read_text(encoding="utf-8") for path in files})
    assert pages[0] == pages[1] and len(pages[0]) > 100
    assert not any(re.search(f"{ADDRESS}|{PRIVATE}", page) for page in pages[0].values())
