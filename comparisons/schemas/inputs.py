"""What `rocking new` and `rocking record` write: what was made, what was read."""

from pydantic import Field

from .form import Form, Part


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
