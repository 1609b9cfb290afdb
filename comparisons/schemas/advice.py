"""What `rocking margin` and `rocking design` write."""

from collections.abc import Sequence
from typing import Any, Literal, Self

from pydantic import Field, create_model
from pydantic.fields import FieldInfo

from analytic import margins
from analytic.scene import SCENE_UNITS, Bearings

from . import Form, Part
from .runs import MotionRead, MotionRun, Warned

LimitState = Literal[*margins.LIMIT_STATES]  # type: ignore[valid-type]  # the words of `analytic.margins`


class Band(Part):
    """Relative changes from low to high. reached: the limit states there, of "slides", "lifts", "tilt" (the peak tilt
    exceeds its share of the slenderness), "stroke" (the base goes beyond x_max) and "overturns"; holds: the contact
    holds as the model has it."""

    low: float
    high: float
    reached: list[LimitState]
    outcome: str
    holds: bool


class Margin(Part):
    """Of one quantity, `value` as the scene has it. changes: for each limit state of the scene the nearest change at
    which it becomes reached, or where the scene reaches it now, is no longer; down, up: nearest change with another
    outcome; leaves_model: nearest change at which the model no longer holds; null where there is none in the range
    scanned. interleaved: the outcome changes and changes back within two steps of the scan: it may change nearer, in a
    narrower band. ends_down, ends_up: why the bands end before the span, where no scene or no run lies beyond."""

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
        """The part of an `analytic.margins.Margin` with its changes of these limit states."""
        own = {name: getattr(margin, name) for name in cls.model_fields if name != "changes"}
        changes = {state: margin.change(state) for state in states}
        return cls.model_validate({**own, "changes": changes}, from_attributes=True)


class Contact(Part):
    """What the contact has to spare: min N/(m g), the demand max |H|/N, the scene's coefficient; whether it slides."""

    least_normal: float
    friction_demand: float
    friction: float | None
    slides: bool = False


class MotionMargin(MotionRun):
    """A scene under one of many motions, the limit states reached, and the nearest relative changes of the motion at
    which each limit state becomes reached, or where it is, no longer is; none of a run that failed. interleaved: as of
    a `Margin`."""

    reached: list[LimitState] = []
    changes: dict[LimitState, float | None] = {}
    interleaved: bool = False


class Margins(Form):
    """How far a scene is from other limit states. reached: those it reaches now. tilt: the limit, a share of the
    slenderness; span: largest relative change scanned, up and, above -1, down. warnings: of the unchanged scene.
    headline: under how many motions what must be known happens."""

    schema_: str = Field(default="rocking margin 4", serialization_alias="schema")
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
    """Of one bearing, as a scene file has them."""


class Properties(Part):
    """What the constants give back at the design displacement."""

    period: float = Field(description="s, of the secant")
    period_kb: float = Field(description="s")
    damping_paper: float = Field(description="W_D/(2 pi E_s)")
    damping_equivalent: float = Field(description="W_D/(4 pi E_s)")
    secant_stiffness: float = Field(description="N/m, of one bearing")
    force: float = Field(description="N, of one bearing")
    cycle_loss: float = Field(description="J, of one bearing")


class Design(Form):
    """Bearings designed."""

    schema_: str = Field(default="rocking design 1", serialization_alias="schema")
    bearings: Constants
    properties: Properties


class BearingProposal(Part):
    """Bearings that hold under all motions: period [s] and equivalent damping at the stroke, and what the worst motion
    does."""

    period: float = Field(description="s, secant at the stroke")
    damping: float = Field(description="share of critical at the stroke")
    bearings: Constants
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
    headline: str = Field(description="under how many motions what must be known happens")


class BearingSearch(Form):
    """Which bearings keep a scene's block from lifting (or its tilt within a limit) and, where the scene gives a
    friction, from sliding, and its base within a stroke.

    holds: a row for each damping, a column for each period [s]. chosen: "least-stroke" and "softest", none where
    nothing holds."""

    schema_: str = Field(default="rocking bearings 2", serialization_alias="schema")
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
