"""Types of what `rocking choose`, `rocking margin`, `rocking risk` and `rocking design` write."""

from collections.abc import Sequence
from typing import Any, Literal, Self

from pydantic import Field, create_model
from pydantic.fields import FieldInfo

from analytic.advice import margins
from analytic.scene import SCENE_UNITS, Bearings

from . import Form, Part
from .runs import MotionRead, MotionRun, Pedestal, Sizes, Warned

LimitState = Literal[*margins.LIMIT_STATES]  # type: ignore[valid-type]  # the words of `analytic.advice.margins`


class Band(Part):
    """A band of relative changes from low to high.

    reached: the limit states there, of "slides", "lifts", "tilt" (the peak tilt exceeds its share of the slenderness),
    "stroke" (the base goes beyond x_max), "falls off" (its pedestal) and "overturns". holds: the contact holds as the
    model assumes."""

    low: float
    high: float
    reached: list[LimitState]
    outcome: str
    holds: bool


class Margin(Part):
    """The margins of one quantity, whose value in the scene is `value`.

    changes: for each limit state the nearest change at which it becomes reached or, if the scene reaches it, is no
    longer reached. down, up: nearest changes with another outcome. leaves_model: nearest change at which the model no
    longer holds. All are null if there is none in the range scanned. interleaved: the outcome changes and changes back
    within two steps of the scan; it may change nearer, in a narrower band. ends_down, ends_up: why the bands end before
    the span, if no scene or no run lies beyond."""

    quantity: str
    value: float
    unit: str
    bands: list[Band]
    changes: dict[str, float | None]
    down: float | None
    up: float | None
    nearest: float | None
    leaves_model: float | None
    interleaved: bool
    ends_down: str
    ends_up: str

    @classmethod
    def of(cls, margin: margins.Margin, states: Sequence[str]) -> Self:
        """Return the part for an `analytic.advice.margins.Margin`, with its changes for these limit states."""
        fields = {name: getattr(margin, name) for name in cls.model_fields if name != "changes"}
        changes = {state: margin.change(state) for state in states}
        return cls.model_validate({**fields, "changes": changes}, from_attributes=True)


class Contact(Part):
    """Reserves of the contact: min N/(m g), friction demand max |H|/N, coefficient of the scene, whether it slides."""

    least_normal: float
    friction_demand: float
    friction: float | None
    slides: bool = False


class MotionMargin(MotionRun):
    """A scene under one of many motions, with limit states.

    reached: those reached. changes: the nearest relative change of the motion at which each limit state becomes
    reached or, if it is reached, no longer is; none for a run that failed. interleaved: as in a `Margin`."""

    reached: list[LimitState] = []
    changes: dict[LimitState, float | None] = {}
    interleaved: bool = False


class Margins(Form):
    """How far a scene is from its limit states.

    reached: the limit states that the scene reaches. tilt: the limit of the tilt, a share of the slenderness. span:
    largest relative change scanned, up and (above -1) down. warnings: of the unchanged scene. headline: under how
    many records runs fail or warn, and the block lifts or overturns."""

    schema_: str = Field(default="rocking margin 5", serialization_alias="schema")
    scene: str
    outcome: str
    tilt: float
    span: float
    reached: list[LimitState]
    margins: list[Margin]
    contact: Contact
    warnings: list[Warned]
    motions: list[MotionMargin]
    left_out: list[str] = Field(description="files and channels of the folder, and why")
    headline: str | None
    pedestal: Pedestal | None = Field(default=None, description="if the scene gives its mass and height")


class Drawn(Part):
    """A quantity that is drawn about its value in the scene."""

    quantity: str
    value: float = Field(description="in the scene")
    unit: str
    spread: float = Field(description="coefficient of variation")
    source: str = Field(description='of the spread; "given" if an option states it')


class Odds(Part):
    """The probability of a limit state, the mean over records, and its 95 % interval.

    effects: for each quantity drawn, the change of the probability for a value higher by one spread, and its noise; a
    smaller change may be chance."""

    state: LimitState
    probability: float
    low: float
    high: float
    effects: dict[str, tuple[float, float]]


class Risk(Form):
    """The odds of a scene whose values are drawn, under many motions.

    draws: for each record. pga [g], pgv [m/s]: to which each motion is scaled; null if it is not. records: {record:
    {limit state: its probability}}, null where all runs failed; the interval counts records or, of one, draws. failed:
    runs that count neither way. why: the reason of the first, or "". intensities: {scale of the motions: odds}, as
    --plot draws them. warnings: of the unchanged scene. motions: what it does under each, if they are several."""

    schema_: str = Field(default="rocking risk 1", serialization_alias="schema")
    scene: str
    draws: int
    seed: int
    pga: float | None
    pgv: float | None
    drawn: list[Drawn]
    odds: list[Odds]
    records: dict[str, dict[LimitState, float | None]]
    travel: dict[str, tuple[float, float, float]] = Field(
        description="m; slip of the block and displacement of the base, where it stays upright: median, 95 % and most"
    )
    failed: int
    why: str
    intensities: dict[float, list[Odds]]
    warnings: list[Warned]
    motions: list[MotionRun]
    left_out: list[str] = Field(description="files and channels of the folder, and why")
    headline: str


def _constant(name: str, given: FieldInfo) -> tuple[Any, Any]:
    """A key of a scene's bearings as a field: (type, description)."""
    plain = {"law": str, "count": int}.get(name, float)
    unit = SCENE_UNITS.get(f"{Bearings.table}.{name}")
    return (plain if given.default is not None else plain | None), Field(description=unit)


_Keys: Any = create_model(
    "Constants",
    __base__=Part,
    **{name: _constant(name, given) for name, given in Bearings.model_fields.items()},  # type: ignore[call-overload]  # by name
)


class Constants(_Keys):
    """Constants of one bearing, as in a scene file."""


class Properties(Part):
    """Properties of the bearings at the design displacement, computed back from the constants."""

    period: float = Field(description="s, of the secant")
    period_kb: float = Field(description="s")
    damping_paper: float = Field(description="W_D/(2 pi E_s)")
    damping_equivalent: float = Field(description="W_D/(4 pi E_s)")
    secant_stiffness: float = Field(description="N/m, of one bearing")
    force: float = Field(description="N, of one bearing")
    cycle_loss: float = Field(description="J, of one bearing")


class Design(Form):
    """Bearings designed."""

    schema_: str = Field(default="rocking design 2", serialization_alias="schema")
    bearings: Constants
    properties: Properties
    sizes: Sizes | None


class BearingProposal(Part):
    """Bearings that hold under all motions, and what the worst motion does.

    period [s] and equivalent damping: at the stroke."""

    period: float = Field(description="s, secant at the stroke")
    damping: float = Field(description="share of critical at the stroke")
    bearings: Constants
    sizes: Sizes | None
    stroke: float = Field(description="m, peak base displacement")
    lifts: int = Field(description="motions under which the block lifts")
    uplift: float = Field(description="acceleration at the block's foot over that of uplift; at least 1 where it lifts")
    tilt: float = Field(description="peak tilt over the slenderness")
    slides: int = Field(default=0, description="motions under which the block slides")
    friction: float | None = Field(
        default=None, description="friction demand over the scene's friction, if it gives one"
    )
    worst: str = Field(description="motion of the largest displacement")
    motions: list[MotionRun] = Field(description="what happens under each on these bearings")
    headline: str = Field(description="under how many records runs fail or warn, and the block lifts or overturns")


class BearingSearch(Form):
    """Bearings that keep a scene's block from lifting (or its tilt within a limit) and its base within a stroke.

    If the scene gives a friction, the block must not slide either. holds: a row for each damping, a column for each
    period [s]. chosen: "least-stroke" and "softest"; none if nothing holds."""

    schema_: str = Field(default="rocking bearings 3", serialization_alias="schema")
    scene: str
    base_mass: float = Field(description="kg, of the scene's base or as given")
    stroke: float = Field(description="m, allowed")
    tilt: float = Field(description="allowed, over the slenderness; 0: no lift")
    motions: list[MotionRead]
    left_out: list[str] = Field(description="files and channels of the folder, and why")
    warnings: list[Warned] = Field(description="of the scene")
    periods: list[float]
    dampings: list[float]
    holds: list[list[bool]]
    chosen: dict[str, BearingProposal]


class Level(Part):
    """A value of a variant's accuracy parameter.

    error: the worst over the scene and its neighbours, for outcomes the share that differs; None if unknown. untried:
    the level passes on the scene and was not run on the neighbours, because a cheaper one passes there. why: the reason
    why it does not pass. cpu_per_second: CPU seconds per simulated second."""

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
    """The levels of a variant from coarse to fine.

    `tier`: the kind of the variant. order: the error is proportional to the parameter to this power, if it can be
    determined. applies_impact: the adapter, not the engine, applies eqs (7) and (8)."""

    engine: str
    variant: str
    tier: str
    applies_impact: bool
    order: float | None
    levels: list[Level]

    def cheapest(self) -> Level:
        """Return the cheapest level that passes; without one the cheapest untried level; without one the finest."""
        for kind in ("passes", "untried"):
            if candidates := [level for level in self.levels if getattr(level, kind)]:
                return min(candidates, key=lambda level: level.cpu_per_second or 0.0)
        return self.levels[-1]


class ModelPart(Part):
    """A part of a model.

    needed: whether this scene needs it. cost: factor on the CPU time if it is modelled nevertheless, measured on this
    scene; None if not measured."""

    part: str
    needed: bool
    why: str
    cost: float | None


class Choice(Form):
    """The answer of `choose`.

    chosen: the cheapest level that passes with all finer ones; None if there is none, and `best` is then the level with
    the least error. safety_factor: the permissible error over the largest one that passes. neighbours: factors of start
    and motion. left_out: {factor: why} of neighbours that the model refuses. until: time [s] up to which histories were
    compared, or were run for their impacts. cpu_seconds, analytic_cpu_seconds: of the chosen level and of the analytic
    model on the whole scene. warnings: on the scene in the model."""

    schema_: str = Field(default="rocking choose 4", serialization_alias="schema")
    scene: str
    criterion: str
    error: float
    safety_factor: float
    neighbours: list[float]
    left_out: dict[str, str]
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
    warnings: list[Warned]
