"""What `choose` finds, as typed values that become JSON; ``Choice.model_json_schema()`` is its schema."""

from __future__ import annotations

from pydantic import Field

from ..schemas.form import Form, Part


class Setting(Part):
    """One value of a variant's accuracy knob. error: the worst over the scene and its neighbours, of outcomes the share
    that differs; None where it cannot be told. why: in words, what keeps it from passing. cpu_per_second: CPU seconds
    for a simulated second."""

    engine: str
    variant: str
    knob: str
    value: float
    default: bool
    runs: int
    error: float | None
    cpu_per_second: float | None
    passes: bool
    why: str | None


class Ladder(Part):
    """A variant's settings from coarse to fine. order: the error goes as the knob to this power, where that shows.
    applies_impact: the adapter, not the engine, applies eqs (7) and (8)."""

    engine: str
    variant: str
    tier: str
    applies_impact: bool
    order: float | None
    settings: list[Setting]


class Spared(Part):
    """A part of a model. needed: whether this scene asks for it; cost: times the CPU time that modelling it all the
    same takes, as measured on this scene; None where that was not measured."""

    part: str
    needed: bool
    why: str
    cost: float | None


class Choice(Form):
    """The answer. chosen: the cheapest setting at which it and all finer ones pass; None where none does, and `best` is
    then the one of least error of all. until: time [s] up to which histories were compared, or were
    run for their impacts. cpu_seconds: of the chosen setting on the whole scene; of the analytic model."""

    schema_: str = Field(default="rocking choose 2", serialization_alias="schema")
    scene: str
    aim: str
    error: float
    spare: float
    neighbours: list[float]
    until: float
    chosen: Setting | None
    best: Setting | None
    cpu_seconds: float | None
    analytic_cpu_seconds: float
    command: str | None
    snippet: str | None
    ladders: list[Ladder]
    spared: list[Spared]
    missing: dict[str, str]
