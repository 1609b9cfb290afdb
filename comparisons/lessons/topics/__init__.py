"""The lessons, one module each, with a `lesson.Lesson` called LESSON and the functions it needs."""

from importlib import import_module

from analytic.errors import SettingError

from ..lesson import Lesson

NAMES = ("tipping", "impacts", "bearing", "caryatid", "corner", "chaos", "cost", "checks")  # in their order


def lesson(name: str) -> Lesson:
    """Return the lesson called `name`.

    Raises
    ------
    SettingError
        There is no such lesson; the message lists all.
    """
    if name not in NAMES:
        raise SettingError(f"unknown lesson {name!r}: choose one of {', '.join(NAMES)}")
    return import_module(f"{__name__}.{name}").LESSON


def lessons() -> tuple[Lesson, ...]:
    """Return all lessons in order."""
    return tuple(lesson(name) for name in NAMES)
