"""The response of a simulation, the same for every solver.

An outcome is “stands” (never lifted), “slides” (slid on its support, never lifted), “rocks” (lifted, stayed upright),
“falls off”, “overturns”, “pedestal overturns” (a free one) or “failed” (with the reason). A block that slides falls off
its pedestal when its centre of pressure leaves the width or, where it is tilted, its pivot corner does; the run ends
there. A block past its balance overturns wherever its corner is. A run continues until its outcome is *decided*: the
remaining energy can no longer overturn the block, or the block is certain to overturn
(``analytic/kernel/decision.py`` says when), and the peaks are final. A run that a ``duration`` ends earlier is
**undecided**: tables say “undecided (rocks so far)”, JSON has ``"decided": false``. A longer duration would not change
a decided outcome. A base that oscillates below a block that will not lift again is followed for a hundred periods.

If the block overturns, base peaks and contact forces are those up to the last passage of |tilt| = slenderness. During
the fall that follows a real block slides.

An engine's run is compared with the analytic model of the same scene. ``differences`` give the quantity, its value in
the run and in the model, and the limit:

- the outcome;
- a peak tilt, peak base displacement or largest slip that is off by more than 2 %;
- for a block that overturns: the time of its last passage of the slenderness, off by more than 2 % of a rocking period,
  the time of overturning, and the number of impacts before;
- the restitution of an impact, off by more than 0.01, or its loss 1 - e^2, by more than 10 %;
- missing or extra impacts.

``comparable`` is "yes", or says why not: without a friction in the scene, the normal force reaches 0, or no contact
provides the friction demanded; or the model does not reach an end. Near an outcome boundary it is "on an edge": a
change of the scene by 1e-4 makes such a difference in the model itself, and values between those of the changed scenes
are no difference. In Python, ``simulate(scene, compare=False)`` skips the comparison.

``warnings`` (kind, quantity, value, limit, text) say that a result is outside the model (the block would jump, and the
scene gives no ``friction``; the base exceeds ``x_max``), or that the record is unusual. Do not rely on an outcome with
such a warning.
"""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any, Self, TextIO

import numpy as np

if TYPE_CHECKING:
    from .scene import Scene

# the worse, the later
OUTCOMES = ("stands", "slides", "rocks", "falls off", "overturns", "pedestal overturns", "failed")
LEVEL = OUTCOMES[:2]  # of a block that never lifted
FALLS = OUTCOMES[3:6]
# Quantities of a `Difference`, in words. Restitution: at the matched impact with the largest error. Missing and extra
# impacts: numbers of impacts that count, with and without a match. Loss: 1 - e^2. Times: of a block that overturns; a
# fall begins at the last passage of the slenderness.
DIFFERENCES = {
    "outcome": "the block {here}, in the analytic model it {model}",
    "peak_tilt": "peak tilt {here:.4g} rad, in the analytic model {model:.4g}",
    "pedestal_tilt": "peak tilt of the pedestal {here:.4g} rad, in the analytic model {model:.4g}",
    "peak_base_displacement": "peak base displacement {here:.4g} m, in the analytic model {model:.4g}",
    "peak_slip": "the block slips by up to {here:.4g} m, in the analytic model {model:.4g}",
    "fall_time": "falls from {here:.6g} s on, in the analytic model from {model:.6g} s",
    "overturning_time": "has overturned at {here:.6g} s, in the analytic model at {model:.6g} s",
    "impacts_before_fall": "falls after {here:.0f} impacts, in the analytic model after {model:.0f}",
    "restitution": "restitution {here:.4g} at an impact, in the analytic model {model:.4g}",
    "impact_loss": "loss 1 - e² of {here:.3g} at an impact, in the analytic model {model:.3g}",
    "missing_impacts": "{here:.0f} of {model:.0f} impacts of the analytic model are found",
    "extra_impacts": "{here:.0f} impacts, {model:.0f} of them in the analytic model",
}
# Whether a run can be compared: "yes"; "no" (not asked for, or failed); "on an edge" (near an outcome boundary: a
# change of the scene by 1e-4 makes such a difference in the model, and values between those are no difference); else
# why not.
COMPARED, UNCOMPARED, EDGE = "yes", "no", "on an edge"
JUDGED = (COMPARED, EDGE)  # values with which differences are determined


@dataclass(frozen=True)
class Impact:
    """One impact: time [s], tilt rate before and after [rad/s], jump of the base velocity [m/s]."""

    time: float
    rate_before: float
    rate_after: float
    base_velocity_jump: float


@dataclass(frozen=True)
class State:
    """Time [s], tilt [rad], tilt rate [rad/s], base displacement [m] and velocity [m/s], bearing force [N].

    The bearing force is that of all bearings together, viscous part included.
    """

    time: float
    tilt: float
    tilt_rate: float
    base_displacement: float
    base_velocity: float
    bearing_force: float


@dataclass(frozen=True, eq=False)
class History:
    """Arrays of shape (n,): the fields of `State` over time, and the ground acceleration [m/s2]."""

    time: np.ndarray
    tilt: np.ndarray
    tilt_rate: np.ndarray
    base_displacement: np.ndarray
    base_velocity: np.ndarray
    bearing_force: np.ndarray
    ground_acceleration: np.ndarray
    slip: np.ndarray | None = None  # m, of the block on its support; None of a block that does not slide
    pedestal_tilt: np.ndarray | None = None  # rad, of a free pedestal; the block's tilt is that from the pedestal

    COLUMNS = (*(column.name for column in dataclasses.fields(State)), "ground_acceleration")

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the names of its columns: `COLUMNS`, the slip where the block slides, the tilt of a free pedestal."""
        return (*self.COLUMNS, *(name for name in ("slip", "pedestal_tilt") if getattr(self, name) is not None))

    def to_csv(self, path: str | PathLike[str] | TextIO) -> None:
        """Write the columns with a header line; `path` is a file name or an open text file."""
        table = np.column_stack([getattr(self, name) for name in self.columns])
        np.savetxt(path, table, delimiter=",", header=",".join(self.columns), comments="", fmt="%.17g")


@dataclass(frozen=True)
class Energy:
    """Energy balance [J] of a run, in the ground's frame.

    kinetic and potential (gravity and the bearings' elastic part kb x) are changes from start to end; input is the work
    of the inertial load; hysteretic, viscous, impact_loss and friction are dissipated energies.
    """

    kinetic: float
    potential: float
    input: float
    hysteretic: float
    viscous: float
    impact_loss: float
    friction: float = 0.0

    @property
    def imbalance(self) -> float:
        """Return input - (changes + losses) [J]; zero for an exact solution."""
        losses = self.hysteretic + self.viscous + self.impact_loss + self.friction
        return self.input - (self.kinetic + self.potential + losses)


@dataclass(frozen=True)
class Sliding:
    """Slip of the block's corner along its support: largest and last [m], path length [m], friction work [J], modes.

    modes: (time [s], mode) of each change: "stick", "slide" (both corners), "rock", "slide-rock", "flight". The slip is
    positive toward +x, and goes on in the last fall.
    """

    peak: float
    end: float
    path: float
    work: float
    modes: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class Stack:
    """The free pedestal under a block, whose own tilts, impacts and forces are then those on the pedestal.

    rocked: which of "pedestal" and "statue" lifted. peak_tilt, statue_tilt: largest absolute tilts of pedestal and
    block [rad]. impacts, uplifts, rests: of the pedestal on its support. friction_demand, min_normal_ratio: largest
    |H|/N, and least N over the weight of both, of the support on the pedestal, up to a fall. impulses: largest ratio of
    the impulses along and off the contact at an impact, of pedestal and block. closest: least time between two landings
    in a row, one of each, as a share of the block's rocking period: the order of landings at once is undetermined; None
    without such landings.
    """

    rocked: tuple[str, ...]
    peak_tilt: float
    statue_tilt: float
    impacts: tuple[Impact, ...]
    uplifts: tuple[float, ...]
    rests: tuple[float, ...]
    friction_demand: float
    min_normal_ratio: float
    impulses: tuple[float, float]
    closest: float | None


STACKED = ("rocked", "uplifts", "rests", "impulses")  # fields that are tuples of words or numbers
ROUNDING, NO_EDGE = 1e-6, "Without a friction the block does not slide: the edge of its pedestal plays no part."
KINDS = ("record", "model", "limit", "motion", "engine")


@dataclass(frozen=True)
class Caution:
    """A warning of a run.

    kind: one of KINDS: "record" (the record is unusual), "model" (outside the model), "limit" (beyond the design value
    of a part), "motion" (the result is sensitive to small changes of the motion) or "engine" (from an engine or its
    adapter). quantity, value, limit: the quantity with its value and limit [SI units], if it is a number. text: a
    sentence.
    """

    kind: str
    text: str
    quantity: str | None = None
    value: float | None = None
    limit: float | None = None

    def __str__(self) -> str:
        return self.text


def about_record(motion: Any) -> tuple[Caution, ...]:
    """Return the warnings on an unusual record of a motion; none for pulses or None."""
    return tuple(Caution("record", text) for text in getattr(motion, "warnings", ()))


@dataclass(frozen=True)
class Difference:
    """A difference of an engine's run from the analytic model: both values, and the limit that is exceeded.

    quantity: one of `DIFFERENCES`. here, model: an outcome or a number; model is None if the block's end differs in the
    model, but not in a near copy of the scene. limit: relative to the model's value for peaks and losses, absolute for
    restitution [-], times [s] and numbers of impacts; None for an outcome. near: range of the number in the model under
    changes of the scene by up to 1e-4; None if not determined.
    """

    quantity: str
    here: str | float
    model: str | float | None
    limit: float | None
    near: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.here is None:
            object.__setattr__(self, "here", math.nan)  # null, from JSON
        if self.near is not None:
            object.__setattr__(self, "near", tuple(self.near))  # a list, from JSON

    def __str__(self) -> str:
        words = DIFFERENCES[self.quantity]
        if self.model is None:
            words = words.partition(", in the analytic model")[0]
        words = words.format(here=self.here, model=self.model)
        if self.near is None or self.model is not None and f"{self.near[0]:.3g}" == f"{self.near[1]:.3g}":
            return words
        return f"{words} ({self.near[0]:.3g} to {self.near[1]:.3g} in the analytic model within 0.01 % of the scene)"


@dataclass(frozen=True)
class Failure:
    """Why a run failed: the reason, the engine's own message, and the last finite state."""

    reason: str
    message: str = ""
    last_state: State | None = None


@dataclass(frozen=True, eq=False)
class Response:
    """Result of ``simulate(scene, ...)``; see the field comments for units."""

    engine: str
    variant: str
    outcome: str  # one of OUTCOMES; "stands": the block never lifted
    overturning_time: float | None  # s, |tilt| = pi/2
    unstable_time: float | None  # s, first |tilt| = slenderness: a diagnostic, no proof of overturning
    peak_tilt: float  # rad
    peak_tilt_ratio: float  # peak tilt / slenderness
    # if the block overturns, base peaks and contact forces are taken up to the last passage of the slenderness; after
    # it the model's block falls about its corner, where a real block would slide and jump
    peak_base_displacement: float  # m
    peak_base_acceleration: float  # m/s2, absolute
    impacts: tuple[Impact, ...]
    uplifts: tuple[float, ...]  # s
    rests: tuple[float, ...]  # s, limit times of accumulating impacts
    friction_demand: float  # max |H|/N at the contact
    min_normal_ratio: float  # min N/(m g) at the contact
    end: State
    cpu_seconds: float  # of the simulation, without import and compilation
    steps: int
    settings: dict
    versions: dict
    scene: str = ""  # name
    decided: bool = True  # False: it ended before the outcome was certain; see analytic/kernel/decision.py
    fall_time: float | None = None  # s, last passage of |tilt| = slenderness of a block that overturns; 0 without one
    warnings: tuple[Caution, ...] = ()  # the result is outside the model, or the record is unusual
    differences: tuple[Difference, ...] = ()  # of an engine's run from the analytic model
    comparable: str = UNCOMPARED  # whether it was compared with the model; see `COMPARED`
    failure: Failure | None = None
    energy: Energy | None = None
    sliding: Sliding | None = None  # of a block that slides, or may: the scene gives a friction that is exhausted
    stack: Stack | None = None  # of a block on a free pedestal
    history: History | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if self.outcome not in OUTCOMES:
            raise ValueError(f"outcome {self.outcome!r} is none of {OUTCOMES}")
        if (self.outcome == "failed") != (self.failure is not None):
            raise ValueError("a failed response carries a failure, and no other does")

    @property
    def outcome_text(self) -> str:
        """Return the outcome as shown: the outcome, or "undecided (rocks so far)"."""
        return self.outcome if self.decided or self.outcome == "failed" else f"undecided ({self.outcome} so far)"

    @property
    def impact_count(self) -> int:
        return len(self.impacts)

    def to_json(self) -> dict[str, Any]:
        """Return the response without its history as a JSON-ready dict; non-finite numbers become None."""
        values = {}
        for part in dataclasses.fields(self):
            if part.name == "history":
                continue
            value = getattr(self, part.name)
            if dataclasses.is_dataclass(value):
                value = dataclasses.asdict(value)  # type: ignore[arg-type]  # no class is a field's value
            elif isinstance(value, tuple):
                value = [dataclasses.asdict(entry) if dataclasses.is_dataclass(entry) else entry for entry in value]  # type: ignore[arg-type]  # as above
            values[part.name] = value
        values["impact_count"] = len(self.impacts)
        return _finite(values)

    @classmethod
    def unmeasured(cls, **known: Any) -> Self:
        """Return a response with the `known` fields only: other numbers are NaN, and there are no events."""
        numbers = {part.name: math.nan for part in dataclasses.fields(cls) if part.type is float}
        nothing = dict(overturning_time=None, unstable_time=None, impacts=(), uplifts=(), rests=(), steps=0)
        return cls(**{**numbers, **nothing, "end": State(*[math.nan] * 6), **known})

    @classmethod
    def from_json(cls, values: Mapping[str, Any], history: History | None = None) -> Self:
        """Return the response from the values of `to_json`; numbers that were not finite are NaN.

        values may lack cpu_seconds. history: the `History` of the response.
        """
        values = {name: value for name, value in values.items() if name != "impact_count"}
        failure, energy, sliding, stack = (values.get(name) for name in ("failure", "energy", "sliding", "stack"))
        if failure is not None:
            failure = Failure(**{**failure, "last_state": failure["last_state"] and _of(State, failure["last_state"])})
        numbers = {part.name: _number(values.get(part.name)) for part in dataclasses.fields(cls) if part.type is float}
        series = {name: tuple(values[name]) for name in ("uplifts", "rests")}
        series |= {
            name: tuple(kind(**entry) for entry in values.get(name, ()))
            for name, kind in (("warnings", Caution), ("differences", Difference))
        }
        landings = tuple(_of(Impact, impact) for impact in (stack or values)["impacts"])
        return cls(
            **{
                **values,
                **numbers,
                **series,
                "impacts": tuple(_of(Impact, impact) for impact in values["impacts"]),
                "end": _of(State, values["end"]),
                "failure": failure,
                "energy": energy and Energy(**energy),
                "sliding": sliding
                and Sliding(**{**sliding, "modes": tuple((t, mode) for t, mode in sliding["modes"])}),
                "stack": stack
                and Stack(**{**stack, **{name: tuple(stack[name]) for name in STACKED}, "impacts": landings}),
                "history": history,
            }
        )


def _of(kind: type[Any], values: Mapping[str, Any]) -> Any:
    return kind(**{name: _number(value) for name, value in values.items()})


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def scene_warnings(scene: "Scene") -> tuple[Caution, ...]:
    """Return the warnings that precede any outcome of a scene: a base that nothing holds, a start beyond balance."""
    warnings, tilt, gamma = [], scene.start.tilt, scene.block.slenderness
    if scene.base is not None and scene.bearings is None:
        text = (
            "No friction is modelled under the base, and it has no bearings: such a base exists in thought experiments "
            "only. Leave it out if the pedestal is fixed to the ground."
        )
        warnings.append(Caution("model", text))
    if abs(tilt) >= gamma:
        words = (
            f"The block starts at a tilt of {tilt:.4g} rad, past its balance at {gamma:.4g} rad: it falls unless "
            "something brings it back."
        )
        warnings.append(Caution("limit", words, "start.tilt", tilt, gamma))
    if scene.pedestal is not None and scene.pedestal.mass is None and scene.friction is None:
        warnings.append(Caution("model", NO_EDGE))
    return tuple(warnings)


def limit_warnings(scene: "Scene", peak_base_displacement: float, peak_slip: float = 0.0) -> tuple[Caution, ...]:
    """Warn if the peak base displacement [m] exceeds the bearings' x_max, or the block overhangs by its peak slip [m].

    It overhangs where a corner is beyond the pedestal's edge. Without a pedestal the slip may be up to the half width.
    peak_slip : 0 for a block that falls, whose slip goes on in its fall.
    """
    warnings = []
    limit = None if scene.bearings is None else scene.bearings.x_max
    if limit is not None and peak_base_displacement > limit:
        words = (
            f"the base moves by {peak_base_displacement:.3g} m, beyond the x_max = {limit:.3g} m of its bearings: they "
            "may tear or hit a stop, and the outcome is outside the model"
        )
        warnings.append(Caution("limit", words, "peak_base_displacement", peak_base_displacement, limit))
    b, name, end = (
        scene.block.half_width,
        "overhang",
        "and overhangs its pedestal: tipping about the edge is not modelled",
    )
    room = (scene.edge - b) * (1 + ROUNDING) + ROUNDING * b  # rounding is no overhang
    if scene.pedestal is None:
        end = (
            f"beyond its half width of {b:.3g} m: the model's support has no edge, and from one as wide as the block it"
        )
        room, name, end = b, "peak_slip", f"{end} would fall"
    if peak_slip > room:
        warnings.append(Caution("limit", f"the block slips by {peak_slip:.3g} m, {end}", name, peak_slip, room))
    return tuple(warnings)
