"""A study and an engine of other packages, found by their entry points: commands, resumption, sections, the report.

Broken studies are named. Every study with such an engine, in this process: test_new_engine.py.
"""

import os
import re
import subprocess
import sys

import pytest
from installed_package import install, install_fake_engine

from comparisons import studies
from comparisons.execution.results import PROJECT_FOLDER

SOURCE = '''
"""How high does a released block swing back after one impact?"""
from analytic import Block, Scene, Start
from comparisons.execution.cases import Case
from comparisons.execution.plan import Batch, Computed, Study
from comparisons.plotting.parts import Page
from comparisons.plotting.parts import Column, table


def measure(case, response):
    return {"start": case.tag["start"], "rest": response.end.tilt, "engine": case.solver}


def plan(ask, *, mass: float = 1.0):
    starts = (0.1, 0.2) if ask.quick else (0.1, 0.15, 0.2, 0.25)
    cases = [Case(Scene(block=Block(mass=mass, radius=1.0, slenderness=0.3), start=Start(tilt=tilt), duration=1.0),
                  "analytic", tag={"start": tilt}) for tilt in starts]
    rows = yield Batch(cases, measure, "swings")
    return Computed({"mass": mass, "quick": ask.quick}, [row.values for row in rows])


def page(result):
    return Page("Swings: how high they go", (f"{len(result.rows)} swings of {result.settings['mass']:g} kg.",),
                more=(table("Swings", result.rows, Column("start [rad]", "start"), Column("tilt [rad]", "rest")),))


STUDY = Study("swings", "How high does a released block swing?", plan, __name__)
'''


def install_study(folder, source):
    install(folder, "swing-study", {"swings": "swing_study:STUDY"}, group="rocking.studies", swing_study=source)


def python(folder, *arguments):
    """(status, output, errors) of Python in `folder`, with what is installed there."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), str(PROJECT_FOLDER)))}
    run = subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, text=True, capture_output=True)
    return run.returncode, run.stdout, run.stderr


def study(folder, *arguments):
    return python(folder, "-m", "comparisons", "study", *arguments)


PAGE = """
import sys; from pathlib import Path; from comparisons.report.answer import stored_studies
[one] = [one.section for one in stored_studies(Path(sys.argv[1]))]
print(one.title, one.age, len(one.tables[0].rows))
"""


@pytest.mark.slow
def test_a_study_of_another_package_gets_command_resumption_and_section(tmp_path):
    assert len(SOURCE.strip().splitlines()) <= 60
    install_study(tmp_path, SOURCE)
    status, out, err = study(tmp_path, "swings", "--quick", "--mass", "2", "--workers", "1")
    assert status == 0 and (tmp_path / "swings-study" / "swings" / "analytic.json").exists(), err
    assert "2 swings of 2 kg." in err and "2 runs done, 0 found" in err and "swings.html" in out
    status, _, err = study(tmp_path, "swings", "--mass", "2", "--workers", "1")
    assert status == 0 and "2 runs done, 2 found" in err
    _, out, err = python(tmp_path, "-c", PAGE, str(tmp_path / "swings-study"))
    assert out.split() == ["Swings:", "how", "high", "they", "go", "None", "4"], err
    assert "swings" in study(tmp_path, "--help")[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    "source, words",
    [
        ("raise ValueError('no licence')", "it cannot be imported (ValueError: no licence)"),
        ("STUDY = 3", "it is no comparisons.execution.plan.Study called 'swings'"),
    ],
)
def test_a_broken_one_is_one_message_that_names_who_declares_it(tmp_path, source, words):
    install_study(tmp_path, source)
    status, _, err = study(tmp_path, "swings")
    assert status == 2 and words in err and "swing-study 0.1" in err and "Traceback" not in err
    status, out, _ = study(tmp_path, "--help")
    assert status == 0 and "restitution" in out


def test_names_of_this_project_are_its_own():
    assert studies.study_names()[: len(studies.BUILT_IN)] == studies.BUILT_IN
    assert tuple(studies.get_study(name).name for name in studies.BUILT_IN) == studies.BUILT_IN
    with pytest.raises(KeyError, match="unknown study 'none': choose one of restitution, "):
        studies.get_study("none")


CRUDE = re.compile(r">[^<]*\bcrude\b")


@pytest.mark.long
@pytest.mark.timeout(1400)
def test_a_study_and_the_report_take_an_engine_as_it_comes(tmp_path):
    """Every page names it."""
    install_fake_engine(tmp_path)
    status, _, err = study(tmp_path, *"statues --quick --engine crude --output studies".split())
    assert status == 0, err
    report = "report --engine crude --studies studies --output report"
    status, _, err = python(tmp_path, "-m", "comparisons", *report.split())
    assert status == 0, err
    pages = {file.stem: file.read_text() for file in (tmp_path / "report").rglob("*.html")}
    assert {"statues", "report"} <= pages.keys()
    assert not [name for name, text in pages.items() if "cannot be shown" in text or not CRUDE.search(text)]
