"""The tests themselves: none of them can hang, and workers keep groups together."""

import subprocess
import sys
from pathlib import Path

import pytest

# signals wait for the end of compiled code
HANGS = """
import numba

@numba.njit('i8(i8)')
def count(n):
    while n > 0:
        n = n % 7 + 1
    return n

def test_hangs():
    count(3)
"""


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


@pytest.mark.slow
def test_a_test_that_hangs_in_compiled_code_fails(tmp_path):
    (tmp_path / "test_hanging.py").write_text(HANGS)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", tmp_path]
    options = ["-c", Path(__file__).parents[2] / "pyproject.toml", "-o", "timeout=1", "-o", "faulthandler_timeout=4"]
    done = subprocess.run([*command, *options, tmp_path], capture_output=True, text=True, timeout=240)
    assert done.returncode == 1 and "Timeout" in done.stderr
