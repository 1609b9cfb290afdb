"""The tests themselves: none of them can hang, and workers keep groups together."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]
# As the command `pytest` in an environment where the project's folder is not on the path.
PLAIN = f"""
import sys
sys.path = [folder for folder in sys.path if folder not in ("", {str(PROJECT)!r})]
import pytest
sys.exit(pytest.main())
"""


def plain_pytest(folder, *arguments):
    """The process of pytest, started in a folder."""
    environment = {
        name: value for name, value in os.environ.items() if name != "PYTHONPATH" and not name.startswith("PYTEST_")
    }
    return subprocess.Popen(
        [sys.executable, "-P", "-c", PLAIN, "-p", "no:cacheprovider", "-q", *arguments],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def said(process):
    """(status, words) of a process."""
    out, _ = process.communicate(timeout=240)
    return process.returncode, out


@pytest.mark.xdist_group("shared")
def test_workers_keep_groups_together(request):
    """Else what a group shares is made on every worker, in silence."""
    if not getattr(request.config.option, "loadgroup", False):
        pytest.skip("not run with --dist loadgroup")
    assert request.node.nodeid.endswith("@shared")


def test_every_test_has_a_time_limit(request):
    limit = float(request.config.getini("timeout"))
    assert 0 < limit < float(request.config.getini("faulthandler_timeout"))
    assert request.config.getini("faulthandler_exit_on_timeout")


HANGS = {
    "Python": "import time\ndef test_hangs():\n    while True:\n        time.sleep(.01)\n",
    # signals wait for the end of compiled code
    "compiled": (
        "import numba\n@numba.njit('i8(i8)')\ndef count(n):\n    while n > 0:\n        n = n % 7 + 1\n"
        "    return n\ndef test_hangs():\n    count(3)\n"
    ),
}


@pytest.mark.parametrize("where", HANGS)
def test_a_test_that_hangs_fails(tmp_path, where):
    (tmp_path / "test_hanging.py").write_text(HANGS[where])
    status, words = said(
        plain_pytest(
            tmp_path,
            "-c",
            str(PROJECT / "pyproject.toml"),
            "--rootdir",
            str(tmp_path),
            "-o",
            "timeout=1",
            "-o",
            "faulthandler_timeout=4",
            str(tmp_path),
        )
    )
    assert status == 1 and "Timeout" in words
