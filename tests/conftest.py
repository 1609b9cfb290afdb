"""What all tests share."""

import os
from pathlib import Path

from hypothesis import settings

# In CI the same scenes every time: a new counterexample is found where somebody can look at it.
settings.register_profile("ci", derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")

PROJECT = Path(__file__).parents[1]


def pytest_configure():
    """New processes that tests start find the project too, wherever pytest was started."""
    others = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(PROJECT), *([others] if others else [])])
