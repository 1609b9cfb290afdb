"""What the tests of the report share: its runs are made once."""

import shutil

import pytest

from analytic import synthetic_motion
from comparisons.report.study import make_results
from comparisons.running.provenance import RESULTS


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """Result files of a report on the synthetic motion, with every engine installed here; not to be changed."""
    folder = tmp_path_factory.mktemp("results")
    make_results(folder, synthetic_motion())
    return folder


@pytest.fixture(scope="session")
def copy_of(results):
    """Copies the result files into a folder."""
    return lambda folder: shutil.copytree(results, folder, dirs_exist_ok=True)


@pytest.fixture(scope="session")
def studies(tmp_path_factory):
    """Stored results of three studies: one that judges engines, one ranked, one a matrix."""
    folder = tmp_path_factory.mktemp("studies")
    for name in ("restitution", "sensitivity", "stability"):
        shutil.copytree(RESULTS / name, folder / name)
    return folder
