"""Compiled functions of inner loops, which have no wrapper for Python, called from it."""

from numba import njit


def from_python(function):
    """The compiled `function` as Python can call it."""

    @njit
    def call(*arguments):
        return function(*arguments)

    return call
