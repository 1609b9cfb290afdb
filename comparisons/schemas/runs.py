"""What commands write of runs, records, scenes, tolerances, sheets and reports. Null: not known, or none.

What a study's result file holds; its columns are explained in `comparisons.studies.rows`.
"""

from typing import Annotated, Any, Literal

from pydantic import Field

from analytic.response import DIFFERENCES, KINDS, OUTCOMES

from . import Form, Part


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
    friction: float | None = 0.0


class Sliding(Part):
    """Slip of a block that slides: largest and last [m], whole way [m], friction work [J], and (time [s], mode) of each
    change: stick, slide, rock, slide-rock, flight."""

    peak: float | None
    end: float | None
    path: float | None
    work: float | None
    modes: list[tuple[float, str]]


class Failure(Part):
    """Why a run failed: in plain words, the engine's own message, the last finite state."""

    reason: str
    message: str
    last_state: State | None


class Warned(Part):
    """A warning. kind: record, model, limit, motion or engine; quantity, value, limit: what is beyond which limit."""

    kind: Literal[*KINDS]  # type: ignore[valid-type]  # the words of `Caution`
    text: str
    quantity: str | None
    value: float | None
    limit: float | None


class MotionRead(Part):
    """One of many motions, as it was read."""

    record: str = Field(description="its motions count as one; of the scene's own outside the folder, words")
    motion: str
    peak: float = Field(description="m/s2")
    warnings: list[Warned]


class MotionRun(MotionRead):
    """A scene under one of many motions: the outcome, why a run failed, and the peaks; tilt over slenderness, stroke
    null without a base, slip null where none is modelled. The warnings are those of the run, too."""

    outcome: Literal[*OUTCOMES]  # type: ignore[valid-type]  # the words of `Response`
    failure: str | None
    tilt: float | None
    stroke: float | None = Field(description="m")
    slip: float | None = Field(description="m")


class Difference(Part):
    """What an engine's run has other than the analytic model, and the difference tolerated: of peaks and losses
    relative, of the restitution, of times [s] and of numbers of impacts absolute."""

    quantity: Literal[*DIFFERENCES]  # type: ignore[valid-type]  # the words of `analytic.Difference`
    here: str | float | None
    model: str | float | None
    limit: float | None
    near: tuple[float, float] | None = Field(description="ends of it in the model within 1e-4 of the scene")


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
        description="where the scene gives a friction that is used up; all 0 of an engine that does not slip",
    )


class Run(_Values):
    """A scene in one solver. headline: under how many motions what must be known happens."""

    schema_: str = Field(default="rocking run 4", serialization_alias="schema")
    motions: list[MotionRun] = Field(default=[], description="where --records, --both-signs or --directions are given")
    left_out: list[str] = Field(default=[], description="files and channels of the folder, and why")
    headline: str | None = None


class Sensitivity(Part):
    """Of a solver: the change of the start that was followed, and the time [s] up to which it stays small."""

    perturbation: float | None
    horizon: float | None


class Comparison(Form):
    """A scene in all solvers. sensitivity_horizon: time [s] up to which point-wise agreement is asked for."""

    schema_: str = Field(default="rocking compare 4", serialization_alias="schema")
    scene: str
    sensitivity_horizon: float | None
    sensitivity: dict[str, Sensitivity]
    responses: list[Run]


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
    """A quantity asked for, and the reference answer. tolerance: by how much another code's answer may differ, in the
    unit; null for a word, which must be the same."""

    quantity: str
    unit: str
    meaning: str
    answer: float | str
    tolerance: float | None


class Problem(Part):
    """A page of the sheet."""

    scene: str
    title: str
    quantities: list[Asked]


class Sheet(Form):
    """A problem sheet written. sheet: its version."""

    schema_: str = Field(default="rocking sheet 2", serialization_alias="schema")
    sheet: int
    files: list[str]
    problems: list[Problem]


class Reported(Part):
    """A scene in one solver, as the page shows it; null: not known, as where a run failed. Errors against the analytic
    model: overturning_time_error [s], peak errors relative, impact_time_error [s]."""

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
    """A page written, and the rows behind its first table. results: the result files it is made from. motions: of each
    scene of one's own, what each of many motions does; left_out: files and channels of the folder, and why; headlines:
    under how many of the motions what must be known happens."""

    schema_: str = Field(default="rocking report 5", serialization_alias="schema")
    page: str
    results: list[str]
    missing: dict[str, str]
    rows: list[Reported]
    motions: dict[str, list[MotionRun]] = {}
    left_out: dict[str, list[str]] = {}
    headlines: dict[str, str | None] = {}


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
