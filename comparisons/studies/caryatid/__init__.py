"""The Caryatid paper: every equation, figure and table of it reproduced or corrected, and what it leaves out.

`command` is ``rocking study caryatid``. It writes three result files, all of kind "caryatid": ``caryatid-paper`` (what
needs no motion: bearing law, Table 1, misprints), ``caryatid-under-<motion>`` (what does, without a single value of the
motion itself) and ``caryatid-under-<motion>-histories`` (Figs 4 and 6 over time: not to be passed on where the record
may not be).
"""

from .command import command


def section(result):
    """The `Section` of the report that shows a result file of this study."""
    from .sections import section as show

    return show(result)


__all__ = ["command", "section"]
