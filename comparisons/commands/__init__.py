"""The commands of ``rocking``, one file each: a function ``command``, or a Typer ``app`` with sub-commands.

Heavy modules (engines, scipy, matplotlib) are imported inside the functions, so that ``rocking --help`` is quick.
"""
