"""The reference that pdoc makes of the docstrings: without a warning, and the same bytes each time."""

import dataclasses
import importlib
import re
import subprocess
import sys
from typing import get_type_hints

import pytest
from test_readme import blocks

from analytic.part import Part
from engines import ENGINES, get_engine

ADDRESS, PRIVATE = " at 0x", "FieldInfo"  # of an object of this process; how pydantic keeps a constraint
PARTS = [part for part in Part.__subclasses__() if not part.__name__.startswith("_")]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.__name__)
def test_types_of_a_scene_read_as_they_are_written(part):
    hints = repr(get_type_hints(part, include_extras=True))
    assert ADDRESS not in hints and PRIVATE not in hints


def test_the_reference_has_the_values_of_each_variant():
    pdoc = pytest.importorskip("pdoc", reason="the extra docs is not installed")
    page = pdoc.doc.Module(importlib.import_module("comparisons.showing.variants")).docstring
    names = [name for name, engine in ENGINES.items() if engine.subject and engine.installed]
    assert names and page.count("\n## ") == len(names)
    for name in names:
        section = page.split(f"\n## {name}\n")[1].split("\n## ")[0]
        for own, variant in get_engine(name).variants.items():
            described = section.split(f"--variant {own} (")[1].split("--variant ")[0]
            for field, value in dataclasses.asdict(variant.settings).items():
                assert re.search(rf" {field}={re.escape(f'{value:.6g}')}\b", described), (name, own, field)
            assert f"levels, coarse to fine: {', '.join(f'{level:.4g}' for level in variant.levels)}\n" in described
            settings = type(variant.settings)
            assert f"{own} `{settings.__module__}.{settings.__qualname__}`" in section  # a link to what they mean


@pytest.mark.long
@pytest.mark.timeout(1400)
def test_the_reference_is_made_without_a_word_and_the_same_each_time(tmp_path):
    pytest.importorskip("pdoc", reason="the extra docs is not installed")
    (line,) = (line for block in blocks("sh") for line in block.replace("\\\n", " ").splitlines() if "/pdoc" in line)
    command = line.partition(".venv/bin/pdoc")[2].replace("'", "").split()
    assert "reference" in command
    pages = []
    for name in ("first", "second"):
        words = [str(tmp_path / name) if word == "reference" else word for word in command]
        done = subprocess.run([sys.executable, "-m", "pdoc", *words], capture_output=True, text=True, timeout=600)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        files = sorted(path for path in (tmp_path / name).rglob("*") if path.is_file())
        pages.append({str(path.relative_to(tmp_path / name)): path.read_text(encoding="utf-8") for path in files})
    assert pages[0] == pages[1] and len(pages[0]) > 100
    assert not any(ADDRESS in page or PRIVATE in page for page in pages[0].values())
