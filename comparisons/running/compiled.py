"""How far the compiling of the analytic model has come."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager

from numba.core.dispatcher import Dispatcher
from numba.core.event import Event, Listener, register, unregister

PACKAGE, COMPILE = "analytic", "numba:compile"  # whose functions are counted; as numba calls the event


class Counted(Listener, AbstractContextManager["Counted"]):
    """Counts functions of the model that are compiled in a `with` statement, and tells (how many, of about how many).

    known: how many there are and are not compiled yet; a few are compiled twice, for other types, and some may not be
    needed, or are on the disk.
    """

    def __init__(self) -> None:
        self.done, self.known = 0, _known()
        self._tell: Callable[[int, int], object] = lambda done, known: None

    def __enter__(self) -> Counted:
        register(COMPILE, self)
        return self

    def __exit__(self, *_: object) -> None:
        unregister(COMPILE, self)

    def on_start(self, event: Event) -> None:
        """Nothing to say yet."""

    def on_end(self, event: Event) -> None:
        """A function is compiled, by numba, the model's or what that calls."""
        if _own(event.data["dispatcher"].py_func.__module__):
            self.done += 1
            self._tell(self.done, max(self.done, self.known))

    def show(self, tell: Callable[[int, int], object]) -> None:
        """From now on tell how far it is."""
        self._tell = tell
        tell(self.done, max(self.done, self.known))


def _own(module):
    return module.partition(".")[0] == PACKAGE


def _known():
    """Functions not yet compiled of the modules that are loaded, and that these hold (`analytic.compiled.chosen`)."""
    waiting = [one for name, module in sys.modules.copy().items() if _own(name) for one in vars(module).values()]
    found = set()
    while waiting:
        one = waiting.pop()
        if isinstance(one, Dispatcher) and one not in found:
            found.add(one)
            waiting += [cell.cell_contents for cell in one.py_func.__closure__ or ()]
    return sum(not one.overloads for one in found)
