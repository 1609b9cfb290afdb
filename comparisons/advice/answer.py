"""What `choose` answers, as typed values that become JSON; ``Choice.model_json_schema()`` is its schema."""

from pydantic import Field

from ..schemas.form import Form, Part


class Level(Part):
    """One value of a variant's accuracy parameter. error: the worst over the scene and its neighbours, of outcomes the
    share that differs; None if unknown. untried: it passes the scene, but was not run on the neighbours,
    as a cheaper one passes there. why: in words, why it does not pass. cpu_per_second: CPU seconds for a simulated
    second."""

    engine: str
    variant: str
    parameter: str
    value: float
    default: bool
    runs: int
    error: float | None
    cpu_per_second: float | None
    passes: bool
    untried: bool
    why: str | None


class VariantLevels(Part):
    """A variant's levels from coarse to fine. order: the error goes as the parameter to this power, where that shows.
    applies_impact: the adapter, not the engine, applies eqs (7) and (8)."""

    engine: str
    variant: str
    tier: str
    applies_impact: bool
    order: float | None
    levels: list[Level]

    def cheapest(self) -> Level:
        """The cheapest level that passes; else of those untried; else the finest."""
        for kind in ("passes", "untried"):
            if own := [one for one in self.levels if getattr(one, kind)]:
                return min(own, key=lambda one: one.cpu_per_second or 0.0)
        return self.levels[-1]


class ModelPart(Part):
    """A part of a model. needed: whether this scene asks for it; cost: times the CPU time that modelling it all the
    same takes, as measured on this scene; None where that was not measured."""

    part: str
    needed: bool
    why: str
    cost: float | None


class Choice(Form):
    """The answer. chosen: the cheapest level at which it and all finer ones pass; None where none does, and `best` is
    then the one of least error of all. safety_factor: of the error asked for over the largest that passes. neighbours:
    factors of start and motion. until: time [s] up to which histories were compared, or were run for their impacts.
    cpu_seconds: of the chosen level on the whole scene; of the analytic model."""

    schema_: str = Field(default="rocking choose 3", serialization_alias="schema")
    scene: str
    criterion: str
    error: float
    safety_factor: float
    neighbours: list[float]
    until: float
    chosen: Level | None
    best: Level | None
    cpu_seconds: float | None
    analytic_cpu_seconds: float
    command: str | None
    snippet: str | None
    variants: list[VariantLevels]
    parts: list[ModelPart]
    missing: dict[str, str]
