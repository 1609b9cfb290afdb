"""The page."""

from ...plotting.parts import Page


def page(result):
    return Page("x", ("y",))
