"""What the tests of the command line share."""

import pytest

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
