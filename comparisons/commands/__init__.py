"""The commands of ``rocking``, one file each: a function ``command``, or a Typer ``app`` with sub-commands.

Heavy modules (engines, scipy, matplotlib) are imported inside the functions, so that ``rocking --help`` is quick.
"""

# Groups of commands in the order of ``rocking --help``; each command is in one group.
GROUPS = {
    "To run and compare": ("run", "compare", "engines", "script"),
    "To read and learn": ("report", "lessons"),
    "For advice on a scene": ("choose", "margin", "design"),
    "For makers of engines and codes": ("verify", "sheet"),
    "For research": ("study",),
    "Input": ("record", "new"),
}
