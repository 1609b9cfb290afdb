"""The Caryatid paper: every equation, figure and table of it reproduced or corrected, and what it leaves out.

`command` is ``rocking study caryatid``, `section` shows a result file in the report. There are three result files, all
of kind "caryatid": ``caryatid-paper`` (what needs no motion: bearing law, Table 1, misprints),
``caryatid-under-<motion>`` (what does, without a single value of the motion itself) and
``caryatid-under-<motion>-histories`` (Figs 4 and 6 over time: not to be passed on where the record may not be).
"""

import importlib

_PLACES = {"command": ".cli", "section": ".sections"}


def __getattr__(name):
    """`command` and `section`, imported when asked for: no result depends on how it is asked for or shown."""
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_PLACES[name], __name__), name)
