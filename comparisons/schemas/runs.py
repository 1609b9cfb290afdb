"""What `rocking run` and `rocking compare` write: responses without their histories. Null: not known, or none."""

from typing import Any, Literal

from pydantic import Field

from .form import Form, Part


class Impact(Part):
    """Time [s], tilt rate before and after [rad/s], jump of the base velocity [m/s]."""

    time: float | None
    rate_before: float | None
    rate_after: float | None
    base_velocity_jump: float | None


class State(Part):
    """Time [s], tilt [rad], its rate [rad/s], base displacement [m] and velocity [m/s], force of all bearings [N]."""

    time: float | None
    tilt: float | None
    tilt_rate: float | None
    base_displacement: float | None
    base_velocity: float | None
    bearing_force: float | None


class Energy(Part):
    """Energy ledger [J] in the ground's frame: changes, what went in, and what left."""

    kinetic: float | None
    potential: float | None
    input: float | None
    hysteretic: float | None
    viscous: float | None
    impact_loss: float | None


class MotionRun(Part):
    """Under one of many motions: the outcome and the peaks; tilt over slenderness, displacement null without a base."""

    record: str
    motion: str
    peak: float = Field(description="m/s2")
    outcome: str
    tilt: float | None
    stroke: float | None = Field(description="m")


class Failure(Part):
    """Why a run failed: in plain words, the engine's own message, the last finite state."""

    reason: str
    message: str
    last_state: State | None


class Warned(Part):
    """A warning. kind: record, model, limit, motion or engine; quantity, value, limit: what is beyond which limit."""

    kind: Literal["record", "model", "limit", "motion", "engine"]
    text: str
    quantity: str | None
    value: float | None
    limit: float | None


class Difference(Part):
    """What an engine's run has other than the analytic model, and the difference tolerated: of peaks and losses
    relative, of the restitution, of times [s] and of numbers of impacts absolute."""

    quantity: Literal[
        "outcome",
        "peak_tilt",
        "peak_base_displacement",
        "fall_time",
        "overturning_time",
        "impacts_before_fall",
        "restitution",
        "impact_loss",
        "missing_impacts",
        "extra_impacts",
    ]
    here: str | float | None
    model: str | float | None
    limit: float | None
    near: tuple[float, float] | None = Field(description="ends of it in the model within 1e-4 of the scene")


COMPARABLE = 'compared with the analytic model: "yes", "no" (not asked for), "on an edge", else the reason why not'


class _Values(Form):
    engine: str
    variant: str
    scene: str
    outcome: Literal["stands", "rocks", "overturns", "failed"]
    decided: bool = Field(description="False: it ended before the outcome was certain.")
    overturning_time: float | None = Field(description="s, |tilt| = pi/2")
    unstable_time: float | None = Field(description="s, first |tilt| = slenderness; no proof of overturning")
    fall_time: float | None = Field(description="s, last passage of |tilt| = slenderness of a block that overturns")
    peak_tilt: float | None = Field(description="rad")
    peak_tilt_ratio: float | None = Field(description="peak tilt over slenderness")
    peak_base_displacement: float | None = Field(description="m")
    peak_base_acceleration: float | None = Field(description="m/s2, absolute")
    impact_count: int
    impacts: list[Impact]
    uplifts: list[float] = Field(description="s")
    rests: list[float] = Field(description="s, limit times of accumulating impacts")
    friction_demand: float | None = Field(description="max |H|/N at the contact")
    min_normal_ratio: float | None = Field(description="min N/(m g) at the contact")
    end: State
    cpu_seconds: float | None = Field(description="of the simulation alone")
    steps: int
    settings: dict[str, Any]
    versions: dict[str, Any]
    warnings: list[Warned]
    differences: list[Difference]
    comparable: str = Field(description=COMPARABLE)
    failure: Failure | None
    energy: Energy | None


class Run(_Values):
    """A scene in one solver."""

    schema_: str = Field(default="rocking run 3", serialization_alias="schema")
    motions: list[MotionRun] = Field(default=[], description="where --records, --both-signs or --directions are given")


class Sensitivity(Part):
    """Of a solver: the change of the start that was followed, and the time [s] up to which it stays small."""

    perturbation: float | None
    horizon: float | None


class Comparison(Form):
    """A scene in all solvers. sensitivity_horizon: time [s] up to which point-wise agreement is asked for."""

    schema_: str = Field(default="rocking compare 3", serialization_alias="schema")
    scene: str
    sensitivity_horizon: float | None
    sensitivity: dict[str, Sensitivity]
    responses: list[Run]
