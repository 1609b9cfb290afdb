"""What is shown of recorded motions."""
from ...showing.parts import Page


def page(result):
    return Page("Recorded motions: nothing", ("nothing",))
