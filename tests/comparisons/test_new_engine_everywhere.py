"""An engine of another package in the real commands: the report, every study's first look, one page of them all."""

import json
import os
import re
import subprocess
import sys
from shutil import copytree, ignore_patterns

import pytest
from installed_package import install_fake_engine

from comparisons.report.write import write_page
from comparisons.running.provenance import PROJECT_FOLDER
from comparisons.studies import BUILT_IN

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1400), pytest.mark.xdist_group("new engine")]
# Studies that answer in several files
STEMS = {"caryatid": ("caryatid-paper", "caryatid-under-synthetic", "caryatid-under-synthetic-histories")}
WITHOUT = ("caryatid-paper", "kernel")  # what runs no engine
SILENT = ("equations",)  # sections of the first page that need no run


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Where the fake is installed and all results go."""
    folder = tmp_path_factory.mktemp("everywhere")
    (folder / "packages").mkdir()
    (folder / "results").mkdir()
    install_fake_engine(folder / "packages")
    return folder


def rocking(place, *arguments):
    path = os.pathsep.join([str(place / "packages"), str(PROJECT_FOLDER)])
    done = subprocess.run(
        [sys.executable, "-m", "comparisons", *arguments],
        cwd=place,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_study_takes_it_as_it_comes(place, name):
    rocking(place, "study", name, "--quick", "--engine", "crude", "--output", name)
    for stem in STEMS.get(name, (name,)):
        result = place / name / f"{stem}.json"
        assert stem in WITHOUT or "crude" in result.read_text()
        for file in (result, result.with_suffix(".npz")):
            if file.exists():
                file.rename(place / "results" / file.name)


def test_the_report_and_all_studies_on_one_page(place):
    rocking(place, "report", "--output", "report")
    rows = json.loads((place / "report" / "caryatid.json").read_text())["rows"]
    assert [row["outcome"] for row in rows if row["solver"] == "crude"] == ["overturns", "stands"]
    # a folder of its own: the first one holds pages of the stored studies
    copytree(place / "report", place / "page", ignore=ignore_patterns("*.html"))
    page = write_page(place / "page", studies=place / "results")
    pages = {file.stem: file.read_text() for file in (page.parent / "pages").glob("*.html")}
    assert not [name for name, text in pages.items() if "cannot be shown" in text]
    assert {name for name, text in pages.items() if not re.search(r">[^<]*\bcrude\b", text)} == set(WITHOUT)
    first = page.read_text()
    sections = dict(re.findall(r'<section id="([^"]+)"(.*?)</section>', first, flags=re.DOTALL))
    assert len(sections) > 6
    assert {name for name, text in sections.items() if not re.search(r"\bcrude\b", text)} == set(SILENT)
