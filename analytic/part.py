"""Base class of the parts of a scene: frozen, checked by pydantic; all mistakes are reported in one `SceneError`."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any, ClassVar, get_args

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from .errors import SceneError

UNITS = {
    "gravity": "m/s2",
    "block.mass": "kg",
    "block.radius": "m",
    "block.slenderness": "rad",
    "block.corner_inertia": "kg m2",
    "base.mass": "kg",
    "bearings.ka": "N/m",
    "bearings.kb": "N/m",
    "bearings.delta_k": "N/m",
    "bearings.yield_force": "N",
    "bearings.damping": "N s/m",
    "bearings.x_max": "m",
    "motion.amplitude": "m/s2",
    "motion.frequency": "rad/s",
    "motion.start": "s",
    "motion.dt": "s",
    "motion.vertical_phase": "rad",
    "start.tilt": "rad",
    "start.tilt_rate": "rad/s",
    "start.base_displacement": "m",
    "start.base_velocity": "m/s",
    "run.duration": "s",
}
LIMITS = {
    "greater_than": "above {:.6g}",
    "greater_than_equal": "from {:.6g} on",
    "less_than": "below {:.6g}",
    "less_than_equal": "up to {:.6g}",
}
WANTED = {"string_type": 'text in "quotes"', "int_type": "a whole number", "int_from_float": "a whole number"}
# Measured or target quantities that are not keys of a scene; `rocking new` computes the keys from them.
MEASURED = {
    **dict.fromkeys(("block.height", "block.width"), ("radius and slenderness", "--height ... --width ...")),
    **dict.fromkeys(
        ("block.depth", "block.density", "block.material"),
        ("mass", "--height ... --width ... --depth ... --material ... (or --density ...)"),
    ),
    **dict.fromkeys(
        ("bearings.period", "bearings.damping_ratio", "bearings.eta", "bearings.xi", "bearings.zeta"),
        (
            "ka, kb and alpha",
            "--height ... --width ... --mass ... --base-mass ... --period ... --damping ... --xmax ...",
        ),
    ),
}


class Part(BaseModel):
    """A part of a scene. `table` is its name in a scene file. Mistakes raise `SceneError`."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, arbitrary_types_allowed=True
    )
    table: ClassVar[str] = ""

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise scene_error(error, type(self)) from None

    # pydantic builds nested parts without it, so that their mistakes keep their full location
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]


def scene_error(error: ValidationError, part: type[Part]) -> SceneError:
    """All mistakes that pydantic found in a `part`, one per key; unknown keys first, as they explain missing ones."""
    found: dict[str, SceneError] = {}
    for problem in sorted(error.errors(), key=lambda problem: problem["type"] != "extra_forbidden"):
        mistake = _mistake(problem, part)
        found.setdefault(mistake.key, mistake)
    first, *others = found.values()
    return first.with_others(*others)


def _mistake(problem: ErrorDetails, part: type[Part]) -> SceneError:
    """The error for one of the problems that pydantic found."""
    kind, value, context = problem["type"], problem["input"], problem.get("ctx", {})
    loc = [str(name) for name in problem["loc"]]
    if kind.startswith("dataclass"):  # one of several classes; its name is last in the location
        loc, kind = loc[:-1], "model_type"
    key = ".".join([part.table, *loc] if part.table else loc)
    unit = f" [{UNITS[key]}]" if key in UNITS else ""
    if kind == "value_error":
        raised = context["error"]
        return raised if isinstance(raised, SceneError) else SceneError(key, None, str(raised), "change it")
    if kind == "missing":
        return missing(key)
    if kind == "extra_forbidden":
        return _unknown(key, loc, value, part)
    if kind == "finite_number":
        return SceneError(key, value, "not finite", f"give a finite number{unit}")
    if kind == "literal_error":
        return SceneError(key, value, "not known", f"choose {context['expected']}")
    if kind in LIMITS:
        words = LIMITS[kind].format(*context.values())
        return SceneError(key, value, "out of range", f"give a number {words}{unit}")
    wanted = f"a table: write [{key}]" if kind == "model_type" else WANTED.get(kind, "a number")
    return SceneError(key, value, f"wrong type ({type(value).__name__})", f"give {wanted}{unit}")


def missing(key: str) -> SceneError:
    """The error for a missing table or key."""
    if key in {table.table for table in Part.__subclasses__() if table.table}:
        return SceneError(key, None, "missing", f"add a table [{key}]")
    unit = f" [{UNITS[key]}]" if key in UNITS else ""
    return SceneError(key, None, "missing", f"add {key.split('.')[-1]} = ...{unit}")


def _unknown(key: str, loc: Sequence[str], value: object, part: type[Part]) -> SceneError:
    if key in MEASURED:
        instead, options = MEASURED[key]
        return SceneError(key, value, "unknown key", f"give {instead}, which `rocking new FILE {options}` computes")
    *tables, name = loc
    for table in tables:
        kinds = part.model_fields[table].annotation
        part = next(kind for kind in (kinds, *get_args(kinds)) if isinstance(kind, type) and issubclass(kind, Part))
    close = difflib.get_close_matches(name, part.model_fields, 1)  # a similar name, possibly of another quantity
    hint = f"write {close[0]} if that is meant, else remove it" if close else "remove it"
    hint += f", known are {', '.join(part.model_fields)}"
    return SceneError(key, value, "unknown key", hint)
