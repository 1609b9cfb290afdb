"""What the tests of the command line share."""

import pytest
from javascript import NEEDED, chromium

from comparisons import cli


@pytest.fixture
def rocking(capfd):
    """Runs ``rocking ARGUMENTS`` in this process; returns (exit status, standard output, standard error)."""

    def call(*arguments):
        capfd.readouterr()
        with pytest.raises(SystemExit) as end:
            cli.main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        return end.value.code or 0, out, err

    return call


@pytest.fixture(scope="module")
def browser():
    if chromium() is None:
        pytest.skip(NEEDED)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        found = play.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        yield found
        found.close()
