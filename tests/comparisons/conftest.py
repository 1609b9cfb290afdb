"""What the tests of pages share."""

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
