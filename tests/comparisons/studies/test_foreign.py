"""A study of another package, found by its entry point: command, resumption, section; broken ones are named."""

import os
import subprocess
import sys

import pytest

from comparisons import studies
from comparisons.running.provenance import PROJECT_FOLDER

SOURCE = '''
"""How high does a released block swing back after one impact?"""
from analytic import Block, Scene, Start
from comparisons.running.cases import Case
from comparisons.running.study import Batch, Found, Study
from comparisons.showing.parts import Page
from comparisons.showing.rows import Column, table


def measure(case, response):
    return {"start": case.tag["start"], "rest": response.end.tilt, "engine": case.solver}


def plan(ask, *, mass: float = 1.0):
    starts = (0.1, 0.2) if ask.quick else (0.1, 0.15, 0.2, 0.25)
    cases = [Case(Scene(block=Block(mass=mass, radius=1.0, slenderness=0.3), start=Start(tilt=tilt), duration=1.0),
                  "analytic", tag={"start": tilt}) for tilt in starts]
    rows = yield Batch(cases, measure, "swings")
    return Found({"mass": mass, "quick": ask.quick}, [row.values for row in rows])


def page(result):
    return Page("Swings: how high they go", (f"{len(result.rows)} swings of {result.settings['mass']:g} kg.",),
                more=(table("Swings", result.rows, Column("start [rad]", "start"), Column("tilt [rad]", "rest")),))


STUDY = Study("swings", "How high does a released block swing?", plan, __name__)
'''


def install(folder, source, name="swings", value="swing_study:STUDY"):
    """A package as pip leaves it: a module and its metadata."""
    (folder / "swing_study.py").write_text(source)
    info = folder / "swing_study-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: swing-study\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[rocking.studies]\n{name} = {value}\n")


def rocking(folder, *arguments):
    """(status, output, errors) of the command in `folder`, with what is installed there."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), str(PROJECT_FOLDER)))}
    run = subprocess.run(
        [sys.executable, "-m", "comparisons", *arguments],
        cwd=folder,
        env=environment,
        text=True,
        capture_output=True,
        timeout=300,
    )
    return run.returncode, run.stdout, run.stderr


def test_a_study_of_another_package_gets_command_resumption_and_section(tmp_path):
    assert len(SOURCE.strip().splitlines()) <= 60
    install(tmp_path, SOURCE)
    status, out, err = rocking(tmp_path, "study", "swings", "--quick", "--mass", "2", "--workers", "1")
    assert status == 0, err
    assert (tmp_path / "swings-study" / "swings.json").exists() and (tmp_path / "swings-study" / "swings.html").exists()
    assert "2 swings of 2 kg." in err and "2 runs done, 0 found" in err and "swings.html" in out
    status, _, err = rocking(tmp_path, "study", "swings", "--mass", "2", "--workers", "1")
    assert status == 0 and "2 runs done, 2 found" in err
    page = (
        "import sys; from pathlib import Path; from comparisons.report.studies import stored_studies\n"
        "[one] = [one.section for one in stored_studies(Path(sys.argv[1]))]\n"
        "print(one.title, one.age, len(one.tables[0].rows))"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(tmp_path), str(PROJECT_FOLDER)))}
    shown = subprocess.run(
        [sys.executable, "-c", page, str(tmp_path / "swings-study")],
        env=environment,
        text=True,
        capture_output=True,
        timeout=120,
    )
    assert shown.stdout.split() == ["Swings:", "how", "high", "they", "go", "None", "4"], shown.stderr
    assert "swings" in rocking(tmp_path, "study", "--help")[1]


@pytest.mark.parametrize(
    "source, words",
    [
        ("raise ValueError('no licence')", "it cannot be imported (ValueError: no licence)"),
        ("STUDY = 3", "it is no comparisons.running.study.Study called 'swings'"),
    ],
)
def test_a_broken_one_is_one_message_that_names_who_declares_it(tmp_path, source, words):
    install(tmp_path, source)
    status, _, err = rocking(tmp_path, "study", "swings")
    assert status == 2 and words in err and "swing-study 1.0" in err and "Traceback" not in err
    status, out, _ = rocking(tmp_path, "study", "--help")
    assert status == 0 and "restitution" in out


def test_names_of_this_project_are_its_own():
    assert studies.study_names()[: len(studies.BUILT_IN)] == studies.BUILT_IN
    for name in studies.BUILT_IN:
        assert studies.get_study(name).name == name
    with pytest.raises(KeyError, match="unknown study 'none': choose one of restitution, "):
        studies.get_study("none")
