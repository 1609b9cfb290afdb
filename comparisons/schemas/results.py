"""What `rocking new`, `record`, `verify`, `sheet` and `report` write."""

from typing import Any, Literal

from pydantic import Field

from .form import Form, Part
from .runs import COMPARABLE, Difference, Warned


class Tolerance(Part):
    """A row of the tolerance table. bound, measured, holds: None of an engine that states no tolerances. found: None
    where it could not be measured; failure: why, in words."""

    quantity: str
    engine: str
    variant: str
    scenes: str
    bound: float | None
    unit: str
    measured: float | None
    source: str
    found: float | None
    holds: bool | None
    failure: str | None


class Verification(Form):
    """Engines compared with the tolerance table. versions: {engine: its own}."""

    schema_: str = Field(default="rocking verify 3", serialization_alias="schema")
    versions: dict[str, Any]
    rows: list[Tolerance]


class Asked(Part):
    """A quantity asked for; scale: by what its error is divided, in its unit; 1 for a word."""

    quantity: str
    unit: str
    meaning: str
    scale: float


class Problem(Part):
    """A page of the sheet."""

    scene: str
    title: str
    quantities: list[Asked]


class Sheet(Form):
    """A problem sheet written. sheet: its version."""

    schema_: str = Field(default="rocking sheet 1", serialization_alias="schema")
    sheet: int
    files: list[str]
    problems: list[Problem]


class Reported(Part):
    """A scene in one solver, as the page shows it; null: not known, as where a run failed. Errors against the analytic
    model: overturning_time_error [s], peak errors relative, impact_time_error [s]."""

    scene: str
    engine: str
    variant: str | None
    outcome: Literal["stands", "rocks", "overturns", "failed"]
    decided: bool | None
    peak_tilt_ratio: float | None
    peak_base_displacement: float | None = Field(description="m")
    impact_count: int | None
    same_outcome: bool | None
    overturning_time_error: float | None
    peak_tilt_error: float | None
    peak_displacement_error: float | None
    impact_time_error: float | None
    cpu_seconds: float | None
    failure: str | None
    warnings: list[Warned]
    differences: list[Difference]
    comparable: str = Field(description=COMPARABLE)


class Report(Form):
    """A page written, and the rows behind its first table. results: the result files it is made from."""

    schema_: str = Field(default="rocking report 4", serialization_alias="schema")
    page: str
    results: list[str]
    missing: dict[str, str]
    rows: list[Reported]


class Derived(Part):
    """A number that follows from the scene; unit "-" where it has none. asked: what was asked for, in its sense."""

    name: str
    value: float
    unit: str
    asked: float | None


class New(Form):
    """A scene file written."""

    schema_: str = Field(default="rocking new 1", serialization_alias="schema")
    file: str
    scene: str
    derived: list[Derived]


class Channel(Part):
    """A channel as it was read; its number and direction in the file's own words."""

    channel: str | None
    direction: str | None
    units: str
    units_from: str = Field(description="who said so")
    dt: float = Field(description="s")
    samples: int
    duration: float = Field(description="s")
    peak: float = Field(description="m/s2")
    peak_time: float = Field(description="s")
    note: str | None
    warnings: list[str]


class Record(Form):
    """A record file as it was read."""

    schema_: str = Field(default="rocking record 1", serialization_alias="schema")
    file: str
    format: str
    channels: list[Channel]
