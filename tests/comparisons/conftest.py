"""What the tests of pages share."""

import os
from pathlib import Path

import pytest
from javascript import NEEDED, chromium


@pytest.fixture(scope="module")
def browser():
    if chromium() is None:
        pytest.skip(NEEDED)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        found = play.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(scope="session", autouse=True)
def nothing_kept():
    """Each test draws its pages itself (tests/comparisons/report/test_kept.py has a folder of its own)."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("comparisons.report.kept.FOLDER", Path(os.devnull, "pages"))
        yield
