"""A copy of this process that ends by a signal, and takes nothing of this process with it."""

import multiprocessing.process
import os
import sys


def fork():
    """As `os.fork`; the copy leaves multiprocessing's folder alone, and says nothing of studies computed here."""
    child = os.fork()
    if child == 0:
        multiprocessing.process.current_process()._config.pop("tempdir", None)
        sys.modules.pop("comparisons.execution.runner", None)
    return child
