"""The lessons, one module each: its content as a `lesson.Lesson` called LESSON, and what it computes."""

from importlib import import_module

from analytic.errors import SettingError

from ..lesson import Lesson

NAMES = ("tipping", "impacts", "bearing", "caryatid", "corner", "chaos", "cost", "checks")  # in their order


def lesson(name: str) -> Lesson:
    """The lesson called `name`.

    Raises
    ------
    SettingError
        There is none; the message lists them.
    """
    if name not in NAMES:
        raise SettingError(f"unknown lesson {name!r}: choose one of {', '.join(NAMES)}")
    return import_module(f"{__name__}.{name}").LESSON


def lessons() -> tuple[Lesson, ...]:
    return tuple(lesson(name) for name in NAMES)
