"""Types of what the commands write about runs, records, scenes, tolerances, sheets and reports, and of result files.

Null means not known, or none. `comparisons.studies.rows` explains the columns of a study's result.
"""

from dataclasses import asdict
from typing import Annotated, Any, Literal, Self

from pydantic import Field

from analytic.advice.bearing_sizes import SORTS, bearing_sizes
from analytic.response import DIFFERENCES, KINDS, OUTCOMES
from analytic.scene import Bearings

from . import Form, Part


class Impact(Part):
    """An impact: time [s], tilt rate before and after [rad/s], jump of the base velocity [m/s]."""

    time: float | None
    rate_before: float | None
    rate_after: float | None
    base_velocity_jump: float | None


class State(Part):
    """A state: time [s], tilt [rad], its rate [rad/s], base displacement [m] and velocity [m/s], bearing force [N]."""

    time: float | None
    tilt: float | None
    tilt_rate: float | None
    base_displacement: float | None
    base_velocity: float | None
    bearing_force: float | None


class Energy(Part):
    """The energy balance [J] in the ground's frame: changes, input and losses."""

    kinetic: float | None
    potential: float | None
    input: float | None
    hysteretic: float | None
    viscous: float | None
    impact_loss: float | None
    friction: float | None = 0.0


class Stack(Part):
    """A free pedestal under the block: which of both lifted ("pedestal", "statue"), largest absolute tilts of pedestal
    and block [rad], impacts, uplifts and rests [s], friction demand and least normal force over the weight of both, on
    its support. impulses: largest ratio along and off the contact, of pedestal and block. closest: time between two
    landings in a row, one of each, over the block's rocking period. null: not read of an engine."""

    rocked: list[str]
    peak_tilt: float | None
    statue_tilt: float | None
    impacts: list[Impact]
    uplifts: list[float]
    rests: list[float]
    friction_demand: float | None
    min_normal_ratio: float | None
    impulses: list[float | None]
    closest: float | None


class Sliding(Part):
    """Slip of a block that slides: largest and last [m], whole way [m] and friction work [J].

    modes: (time [s], mode) of each change of mode: stick, slide, rock, slide-rock, flight."""

    peak: float | None
    end: float | None
    path: float | None
    work: float | None
    modes: list[tuple[float, str]]


class Pedestal(Part):
    """Whether the pedestal stays on what carries it (`analytic.advice.pedestal`), by the analytic model's run.

    share, landing: largest distance of the centre of pressure under it from its middle, over its half width; landing:
    of the impulses of landings, 0 without any. Up to 1 it stays. uplift: acceleration above which block and pedestal
    lift together. width: on which it stays, null where none was found. text: the verdict."""

    share: float
    landing: float
    uplift: float = Field(description="m/s2")
    width: float | None = Field(description="m")
    text: str


class Failure(Part):
    """A failure of a run: the reason in plain words, the engine's own message, the last finite state."""

    reason: str
    message: str
    last_state: State | None


class Warned(Part):
    """A warning. quantity, value, limit: what is beyond which limit."""

    kind: Literal[*KINDS]  # type: ignore[valid-type]  # the words of `Caution`
    text: str
    quantity: str | None
    value: float | None
    limit: float | None


class MotionRead(Part):
    """One of many motions, as it was read."""

    record: str = Field(description="its motions count as one; words for the scene's own motion")
    motion: str
    peak: float = Field(description="m/s2")
    warnings: list[Warned]


class MotionRun(MotionRead):
    """A scene under one of many motions: the outcome, the reason of a failure, and the peaks.

    tilt: over the slenderness. stroke: null without a base. slip: null if none is modelled. warnings: on the motion and
    on the run."""

    outcome: Literal[*OUTCOMES]  # type: ignore[valid-type]  # the words of `Response`
    failure: str | None
    tilt: float | None
    stroke: float | None = Field(description="m")
    slip: float | None = Field(description="m")


class Difference(Part):
    """A quantity in which an engine's run differs from the analytic model by more than the limit.

    The limit is relative for peaks and losses; absolute for the restitution, times [s] and numbers of impacts."""

    quantity: Literal[*DIFFERENCES]  # type: ignore[valid-type]  # the words of `analytic.Difference`
    here: str | float | None
    model: str | float | None
    limit: float | None
    near: tuple[float, float] | None = Field(description="its range in the model for scenes within 1e-4 of this one")


class Sizes(Part):
    """Sizes of one bearing under its share of the weight, as `analytic.advice.bearing_sizes` has them.

    radius, friction: of a pendulum; for other bearings of one with their period and damping at x_max. reasons: why no
    such bearing is made; none if such bearings are made. sentences: the same in words. assumed: by what."""

    kind: Literal[*SORTS]  # type: ignore[valid-type]  # the words of `BearingSizes`
    core: float | None = Field(description="m, diameter of the lead core")
    diameter: float | None = Field(description="m, of the rubber")
    height: float | None = Field(description="m, of the rubber")
    overlap: float | None = Field(description="share of the rubber's area that overlaps at x_max")
    pressure: float | None = Field(description="Pa")
    overlap_pressure: float | None = Field(description="Pa, on the overlap at x_max")
    radius: float | None = Field(description="m, of curvature")
    friction: float | None
    reasons: list[str]
    sentences: list[str]
    assumed: str

    @classmethod
    def of(cls, bearings: Bearings | None, mass: float, gravity: float = 9.81) -> Self | None:
        """Return the sizes of bearings under a mass [kg], see `bearing_sizes`; None without bearings or sizes."""
        sizes = None if bearings is None else bearing_sizes(bearings, mass, gravity)
        if sizes is None:
            return None
        words = {"reasons": list(sizes.reasons), "sentences": list(sizes.sentences), "assumed": sizes.assumed}
        return cls(**asdict(sizes) | words)


COMPARABLE = 'compared with the analytic model: "yes", "no" (not asked for), "on an edge", else the reason why not'


class _Values(Form):
    engine: str
    variant: str
    scene: str
    outcome: Literal[*OUTCOMES]  # type: ignore[valid-type]  # as above
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
    sliding: Sliding | None = Field(
        default=None,
        description="if the scene gives a friction that is exhausted; all 0 for an engine that does not slip",
    )
    stack: Stack | None = Field(default=None, description="if the pedestal is free")


class Run(_Values):
    """A scene in one solver. headline: under how many records runs fail or warn, and the block lifts or overturns."""

    schema_: str = Field(default="rocking run 5", serialization_alias="schema")
    motions: list[MotionRun] = Field(default=[], description="if --records, --both-signs or --directions is given")
    left_out: list[str] = Field(default=[], description="files and channels of the folder, and why")
    headline: str | None = None
    pedestal: Pedestal | None = Field(default=None, description="if the scene gives its mass and height")


class Sensitivity(Part):
    """Sensitivity of a solver: the change of the start, and the time [s] up to which its effect stays small."""

    perturbation: float | None
    horizon: float | None


class Comparison(Form):
    """A scene in all solvers. sensitivity_horizon: time [s] up to which motions are compared point by point."""

    schema_: str = Field(default="rocking compare 5", serialization_alias="schema")
    scene: str
    sensitivity_horizon: float | None
    sensitivity: dict[str, Sensitivity]
    responses: list[Run]
    pedestal: Pedestal | None = Field(default=None, description="if the scene gives its mass and height")


class Tolerance(Part):
    """A row of the tolerance table.

    bound, measured, holds: null for an engine that states no tolerances. found: null if it could not be measured;
    failure: the reason in words."""

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
    """Engines compared with the tolerance table. versions: {engine: versions of its packages}."""

    schema_: str = Field(default="rocking verify 3", serialization_alias="schema")
    versions: dict[str, Any]
    rows: list[Tolerance]


class Asked(Part):
    """A quantity of a problem, and the reference answer.

    tolerance: by how much the answer of another code may differ, in the unit; null for a word, which must be equal."""

    quantity: str
    unit: str
    meaning: str
    answer: float | str
    tolerance: float | None


class Problem(Part):
    """A problem of the sheet."""

    scene: str
    title: str
    quantities: list[Asked]


class Sheet(Form):
    """The problem sheet that was written. sheet: its version."""

    schema_: str = Field(default="rocking sheet 2", serialization_alias="schema")
    sheet: int
    files: list[str]
    problems: list[Problem]


class Reported(Part):
    """A scene in one solver, as the page shows it; null: not known, for example because the run failed.

    Errors are those against the analytic model: overturning_time_error [s], impact_time_error [s], peak errors
    relative."""

    scene: str
    engine: str
    variant: str | None
    outcome: Literal[*OUTCOMES]  # type: ignore[valid-type]  # as above
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
    """The page that was written, and the rows behind its first table.

    results: the result files it is made from. motions: {scene: a row for each of many motions}. left_out: files and
    channels of the folder, and why. headlines: under how many records runs fail or warn, and the block lifts or
    overturns. sizes: of the bearings of each scene. pedestals: {scene: whether its pedestal stays}."""

    schema_: str = Field(default="rocking report 6", serialization_alias="schema")
    page: str
    results: list[str]
    missing: dict[str, str]
    rows: list[Reported]
    motions: dict[str, list[MotionRun]] = {}
    left_out: dict[str, list[str]] = {}
    headlines: dict[str, str | None] = {}
    sizes: dict[str, Sizes | None] = {}
    pedestals: dict[str, Pedestal | None] = {}


class Derived(Part):
    """A quantity derived from the scene; the unit is "-" if it has none. asked: the target, as the row defines it."""

    name: str
    value: float
    unit: str
    asked: float | None


class New(Form):
    """The scene file that was written. sizes: of its bearings."""

    schema_: str = Field(default="rocking new 2", serialization_alias="schema")
    file: str
    scene: str
    derived: list[Derived]
    sizes: Sizes | None


class Channel(Part):
    """A channel as it was read. channel, direction: as the file names them."""

    channel: str | None
    direction: str | None
    units: str
    units_from: str = Field(description="what states the units")
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


Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Machine(Part):
    """A machine. cores: physical ones; null: not known."""

    processor: str
    cores: int | None
    logical_cores: int | None
    memory_gib: float
    system: str


class Checked(Part):
    """A check that repeated stored runs: date, commit, seed of the random choice, number of runs, how many held."""

    date: str
    commit: str | None
    dirty: bool | None
    seed: int
    runs: int
    held: int


class Origin(Part):
    """Where numbers come from.

    commit: of the checkout. dirty: whether tracked files differed from it. Both are null outside a checkout."""

    time: str = Field(description="UTC, ISO 8601")
    machine: Machine
    python: str
    packages: dict[str, str | None] = Field(description="versions; null: not installed")
    commit: str | None
    dirty: bool | None
    sources: dict[str, str] = Field(
        description="digests of the definitions behind the numbers: for each root those that it adds"
    )


class Provenance(Origin):
    """Where a result comes from."""

    seed: int | list[int] | None = Field(description="of the random numbers used; null if none are")
    check: Checked | None = None


class Arrays(Part):
    """The file of arrays beside this one, and its SHA-256."""

    file: str
    digest: Digest


class Runs(Part):
    """How many single runs there were, and how many, drawn at random, are stored among the arrays (`runs.json`).

    An engine computed again counts as when it was first computed."""

    stored: int
    total: int | None = Field(description="null: counted with those of analytic.json")


class StudyResult(Form):
    """The result file of a study. A row is one object; a column means the same in all rows of a study."""

    schema_: Literal["rocking study 3"] = Field(default="rocking study 3", alias="schema")
    digest: Digest = Field(description="SHA-256 of all else in this file, as JSON with sorted keys and without spaces")
    kind: str = Field(description="which study")
    provenance: Provenance
    settings: dict[str, Any] = Field(description="what the study was asked")
    arrays: Arrays | None
    runs: Runs | None = None
    rows: list[dict[str, Any]]
