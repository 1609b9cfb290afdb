"""The answer of `choose` as typed values for JSON; ``Choice.model_json_schema()`` is its schema."""

from __future__ import annotations

from pydantic import Field

from ..schemas.form import Form, Part


class Level(Part):
    """One value of a variant's accuracy parameter. error: the worst over the scene and its neighbours, for outcomes the
    share that differs; None if unknown. untried: it passes the scene, but was not run on the neighbours, as a cheaper
    one passes there. why: the reason why it does not pass. cpu_per_second: CPU seconds per simulated second."""

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
    """A variant's levels from coarse to fine. `tier`: the kind of the variant. order: the error is proportional to the
    parameter to this power, if it can be determined. applies_impact: the adapter, not the engine, applies eqs (7) and
    (8)."""

    engine: str
    variant: str
    tier: str
    applies_impact: bool
    order: float | None
    levels: list[Level]

    def cheapest(self) -> Level:
        """The cheapest level that passes; else the cheapest untried one; else the finest."""
        for kind in ("passes", "untried"):
            if own := [one for one in self.levels if getattr(one, kind)]:
                return min(own, key=lambda one: one.cpu_per_second or 0.0)
        return self.levels[-1]


class ModelPart(Part):
    """A part of a model. needed: whether this scene needs it. cost: factor on the CPU time if it is modelled
    nevertheless, measured on this scene; None if not measured."""

    part: str
    needed: bool
    why: str
    cost: float | None


class Choice(Form):
    """The answer. chosen: the cheapest level that passes with all finer ones; None if there is none, and `best` is then
    the level with the least error. safety_factor: the error asked for over the largest one that passes. neighbours:
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
