"""What a study's result file holds; its columns are explained in `comparisons.studies.vocabulary`."""

from typing import Annotated, Any, Literal

from pydantic import Field

from .form import Form, Part

Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Machine(Part):
    """Cores are physical ones; null: not known."""

    processor: str
    cores: int | None
    logical_cores: int | None
    memory_gib: float
    system: str


class Checked(Part):
    """Stored runs done again: when, with which commit, drawn with which seed, how many, and how many held."""

    date: str
    commit: str | None
    dirty: bool | None
    seed: int
    runs: int
    held: int


class Origin(Part):
    """Where numbers come from. commit, dirty: of the checkout, and whether tracked files differed from it; null outside
    one."""

    time: str = Field(description="UTC, ISO 8601")
    machine: Machine
    python: str
    packages: dict[str, str | None] = Field(description="versions; null: not installed")
    commit: str | None
    dirty: bool | None
    sources: dict[str, str] = Field(description="digests of the definitions behind the numbers, by root: those it adds")


class Provenance(Origin):
    """Where a result comes from."""

    seed: int | list[int] | None = Field(description="of the random numbers used; null where none are")
    check: Checked | None = None


class Arrays(Part):
    """The file of arrays beside this one, and the SHA-256 of it."""

    file: str
    digest: Digest


class Runs(Part):
    """How many single runs there were, and how many, drawn at random, are stored among the arrays (`runs.json`). An
    engine run again counts as when it was first run."""

    stored: int
    total: int | None = Field(description="null: counted with those of analytic.json")


class StudyResult(Form):
    """The result file of a study: a row is one object; equal columns mean the same in all rows of a study."""

    schema_: Literal["rocking study 3"] = Field(default="rocking study 3", alias="schema")
    digest: Digest = Field(description="SHA-256 of all else in this file, as JSON with sorted keys and without spaces")
    kind: str = Field(description="which study")
    provenance: Provenance
    settings: dict[str, Any] = Field(description="what the study was asked")
    arrays: Arrays | None
    runs: Runs | None = None
    rows: list[dict[str, Any]]
