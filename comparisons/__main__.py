"""``python -m comparisons``: the same as ``rocking``."""

from .cli import main

main()
