"""What all tests share."""

import os
from pathlib import Path

PROJECT = Path(__file__).parents[1]


def pytest_configure():
    """New processes that tests start find the project too, wherever pytest was started."""
    others = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(PROJECT), *([others] if others else [])])
