"""An engine of another package in the real commands: a study and the report, every section that shows runs names it.

Every study with it, in this process: studies/test_new_engine.py.
"""

import os
import re
import subprocess
import sys

import pytest
from installed_package import install_fake_engine

from comparisons.running.provenance import PROJECT_FOLDER, read_result

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1400)]
SILENT = ("equations",)  # sections of the first page that need no run


def rocking(folder, *arguments):
    path = os.pathsep.join([str(folder), str(PROJECT_FOLDER)])
    done = subprocess.run(
        [sys.executable, "-m", "comparisons", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]


def test_a_study_and_the_report_take_it_as_it_comes(tmp_path):
    install_fake_engine(tmp_path)
    rocking(tmp_path, "study", "random-scenes", "--quick", "--engine", "crude", "--output", "studies")
    rocking(tmp_path, "report", "--engine", "crude", "--studies", "studies", "--output", "report")
    rows = read_result(tmp_path / "report" / "scenes.json").rows
    assert [row["outcome"] for row in rows if row["engine"] == "crude"] == ["overturns", "stands"]
    pages = {file.stem: file.read_text() for file in (tmp_path / "report" / "pages").glob("*.html")}
    assert "random-scenes" in pages and not [name for name, text in pages.items() if "cannot be shown" in text]
    assert not [name for name, text in pages.items() if not re.search(r">[^<]*\bcrude\b", text)]
    first = (tmp_path / "report" / "report.html").read_text()
    sections = dict(re.findall(r'<section id="([^"]+)"(.*?)</section>', first, flags=re.DOTALL))
    assert len(sections) > 4
    assert {name for name, text in sections.items() if not re.search(r"\bcrude\b", text)} == set(SILENT)
