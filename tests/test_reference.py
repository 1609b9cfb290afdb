"""The reference that pdoc makes of the docstrings: without a warning, and the same bytes each time."""

import subprocess
import sys
from typing import get_type_hints

import pytest
from test_readme import blocks

from analytic.part import Part

ADDRESS, PRIVATE = " at 0x", "FieldInfo"  # of an object of this process; how pydantic keeps a constraint
PARTS = [part for part in Part.__subclasses__() if not part.__name__.startswith("_")]


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.__name__)
def test_types_of_a_scene_read_as_they_are_written(part):
    hints = repr(get_type_hints(part, include_extras=True))
    assert ADDRESS not in hints and PRIVATE not in hints


@pytest.mark.slow
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
