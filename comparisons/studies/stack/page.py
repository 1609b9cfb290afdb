"""The page."""

from ...plotting.parts import Page


def page(result) -> Page:
    return Page("x", ("y",))
