"""What is simulated: a rigid block, its base, the bearings, the ground motion. Frozen, SI units.

`Part` is the base class of the parts of a scene. pydantic checks them, and all mistakes are reported in one
`SceneError`. Two sets of shipped parts stand here, too: the Caryatid, its base and its bearings (text and Table 1 of
the paper), used in most studies; and problems A and B, two scenes with reference solutions, for timing and comparing
solvers.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from annotated_types import Ge, Gt, Le, Lt
from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError, model_validator
from pydantic_core import ErrorDetails, PydanticCustomError
from typing_extensions import TypeAliasType

from .errors import SceneError
from .laws import LAWS, NUMBERS
from .motion import PulseMotion, SampledMotion, slowest_key

SCENE_UNITS = {
    "gravity": "m/s2",
    "block.mass": "kg",
    "block.radius": "m",
    "block.slenderness": "rad",
    "block.corner_inertia": "kg m2",
    "base.mass": "kg",
    "pedestal.width": "m",
    "pedestal.mass": "kg",
    "pedestal.height": "m",
    "bearings.ka": "N/m",
    "bearings.kb": "N/m",
    "bearings.delta_k": "N/m",
    "bearings.yield_force": "N",
    "bearings.damping": "N s/m",
    "bearings.x_max": "m",
    "motion.amplitude": "m/s2",
    "motion.frequency": "rad/s",
    "motion.start": "s",
    "motion.dt": "s",
    "motion.vertical_phase": "rad",
    "start.tilt": "rad",
    "start.tilt_rate": "rad/s",
    "start.base_displacement": "m",
    "start.base_velocity": "m/s",
    "run.duration": "s",
}
LIMITS = {
    "greater_than": "above {:.6g}",
    "greater_than_equal": "from {:.6g} on",
    "less_than": "below {:.6g}",
    "less_than_equal": "up to {:.6g}",
}
WANTED = {"string_type": 'text in "quotes"', "int_type": "a whole number", "int_from_float": "a whole number"}
# Measured or target quantities that are not keys of a scene; `rocking new` computes the keys from them.
MEASURED = {
    **dict.fromkeys(("block.height", "block.width"), ("radius and slenderness", "--height ... --width ...")),
    **dict.fromkeys(
        ("block.depth", "block.density", "block.material"),
        ("mass", "--height ... --width ... --depth ... --material ... (or --density ...)"),
    ),
    **dict.fromkeys(
        ("bearings.period", "bearings.damping_ratio", "bearings.eta", "bearings.xi", "bearings.zeta"),
        (
            "ka, kb and alpha",
            "--height ... --width ... --mass ... --base-mass ... --period ... --damping ... --xmax ...",
        ),
    ),
}


class Part(BaseModel):
    """A part of a scene. `table` is its name in a scene file. Mistakes raise `SceneError`."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, arbitrary_types_allowed=True
    )
    table: ClassVar[str] = ""

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise scene_error(error, type(self)) from None

    # pydantic builds nested parts without it, so that their mistakes keep their full location
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]


def scene_error(error: ValidationError, part: type[Part]) -> SceneError:
    """Return all mistakes that pydantic found in a `part` as one error, one per key.

    Unknown keys come first, as they explain missing ones.
    """
    by_key: dict[str, SceneError] = {}
    for problem in sorted(error.errors(), key=lambda problem: problem["type"] != "extra_forbidden"):
        mistake = _mistake(problem, part)
        by_key.setdefault(mistake.key, mistake)
    first, *further = by_key.values()
    return first.with_others(*further)


def _mistake(problem: ErrorDetails, part: type[Part]) -> SceneError:
    """Return the error for one of the problems that pydantic found."""
    kind, value, context = problem["type"], problem["input"], problem.get("ctx", {})
    loc = [str(name) for name in problem["loc"]]
    if kind.startswith("dataclass"):  # one of several classes; its name is last in the location
        loc, kind = loc[:-1], "model_type"
    key = ".".join([part.table, *loc] if part.table else loc)
    unit = f" [{SCENE_UNITS[key]}]" if key in SCENE_UNITS else ""
    if kind == "value_error":
        raised = context["error"]
        return raised if isinstance(raised, SceneError) else SceneError(key, None, str(raised), "change it")
    if kind == "missing":
        return missing(key)
    if kind == "extra_forbidden":
        return _unknown(key, loc, value, part)
    if kind == "finite_number":
        return SceneError(key, value, "not finite", f"give a finite number{unit}")
    if kind == "literal_error":
        return SceneError(key, value, "not known", f"choose {context['expected']}")
    if kind in LIMITS:
        words = LIMITS[kind].format(*context.values())
        return SceneError(key, value, "out of range", f"give a number {words}{unit}")
    expected = f"a table: write [{key}]" if kind == "model_type" else WANTED.get(kind, "a number")
    return SceneError(key, value, f"wrong type ({type(value).__name__})", f"give {expected}{unit}")


def missing(key: str) -> SceneError:
    """Return the error for a missing table or key."""
    if key in {table.table for table in Part.__subclasses__() if table.table}:
        return SceneError(key, None, "missing", f"add a table [{key}]")
    unit = f" [{SCENE_UNITS[key]}]" if key in SCENE_UNITS else ""
    return SceneError(key, None, "missing", f"add {key.split('.')[-1]} = ...{unit}")


def _unknown(key: str, loc: Sequence[str], value: object, part: type[Part]) -> SceneError:
    if key in MEASURED:
        instead, options = MEASURED[key]
        return SceneError(key, value, "unknown key", f"give {instead}, which `rocking new FILE {options}` computes")
    *tables, name = loc
    for table in tables:
        kinds = part.model_fields[table].annotation
        part = next(kind for kind in (kinds, *get_args(kinds)) if isinstance(kind, type) and issubclass(kind, Part))
    close = difflib.get_close_matches(name, part.model_fields, 1)  # a similar name, possibly of another quantity
    hint = f"write {close[0]} if that is meant, else remove it" if close else "remove it"
    hint += f", known are {', '.join(part.model_fields)}"
    return SceneError(key, value, "unknown key", hint)


# Largest phase [rad] between two adjacent doubles of the time; 1e7 s give 1/50 of it for the smallest blocks.
RESOLUTION = 1e-4
# Limits of all quantities of a scene in SI units, within which products neither overflow nor vanish.
LEAST, MOST = 1e-20, 1e20
# Keys of [bearings] that only some laws use.
KEYS = tuple(dict.fromkeys(name for law in LAWS for name in law.needs + law.ignores))


def _not_vanishing(value: float) -> float:
    if value < LEAST:
        raise PydanticCustomError("greater_than_equal", "vanishes in products", {"ge": LEAST})
    return value


# Named types, which the reference shows by name.
Positive = TypeAliasType("Positive", Annotated[float, Gt(0), Le(MOST), AfterValidator(_not_vanishing)])
Slenderness = TypeAliasType("Slenderness", Annotated[float, Gt(0), Lt(math.pi / 2), AfterValidator(_not_vanishing)])
NotNegative = Annotated[float, Ge(0), Le(MOST)]
Number = Annotated[float, Ge(-MOST), Le(MOST)]


class Block(Part):
    """The rigid block.

    mass m [kg]; radius R [m], base corner to centre of mass; slenderness gamma [rad], angle of R to the vertical;
    corner_inertia J_O [kg m2] about a base corner, default 4/3 m R^2 (rectangle); restitution e_phi, default that of
    eq. (7).
    """

    table: ClassVar[str] = "block"

    mass: Positive
    radius: Positive
    slenderness: Slenderness
    corner_inertia: Positive | None = None
    restitution: Annotated[float, Ge(0), Le(1)] | None = None

    @model_validator(mode="after")
    def _inertia_is_possible(self) -> Self:
        least = self.mass * self.radius**2
        if self.corner_inertia is not None and self.corner_inertia <= least:
            raise SceneError(
                "block.corner_inertia",
                self.corner_inertia,
                "less than a point mass would have",
                f"give more than mass radius^2 = {least:.6g} kg m2, or leave it out",
            )
        return self

    @property
    def inertia(self) -> float:
        """Return J_O [kg m2] about a base corner."""
        return 4 / 3 * self.mass * self.radius**2 if self.corner_inertia is None else self.corner_inertia

    @property
    def centre_inertia(self) -> float:
        """Return the moment of inertia about the centre of mass [kg m2]."""
        return self.inertia - self.mass * self.radius**2

    @property
    def half_width(self) -> float:
        """Return b = R sin(gamma) [m]."""
        return self.radius * math.sin(self.slenderness)

    @property
    def half_height(self) -> float:
        """Return h = R cos(gamma) [m]."""
        return self.radius * math.cos(self.slenderness)


class Base(Part):
    """The isolated base under the block: mass m_b [kg]."""

    table: ClassVar[str] = "base"

    mass: Positive


# A pedestal is as wide as its block if it is narrower by less than this share: scene files have six digits.
AS_WIDE = 1e-4


class Pedestal(Part):
    """The pedestal that the block stands on, centred at the start.

    width [m], along the motion: a block that slides beyond it falls off. mass [kg] and height [m], of a homogeneous
    rectangle: with both, `analytic.advice.pedestal` says whether the pedestal stays on what carries it. free: it is not
    fixed to what carries it, and may lift and rock (`analytic.stack`).
    """

    table: ClassVar[str] = "pedestal"

    width: Positive
    mass: Positive | None = None
    height: Positive | None = None
    free: bool = False

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if self.free and self.mass is None and self.height is None:
            raise SceneError("pedestal.mass", None, "missing", "a free pedestal needs a mass and a height")
        if (self.mass is None) != (self.height is None):
            name = "mass" if self.mass is None else "height"
            raise SceneError(f"pedestal.{name}", None, "missing", "give mass and height, or neither")
        return self


class Bearings(Part):
    """The bearings under the base; all stiffnesses and forces per bearing.

    algebraic: the hysteretic law of eqs (9)-(14). linear: f = ka x; kb, alpha and delta_k are not used.
    bouc-wen: the Bouc-Wen law with the f0, ka and kb of the algebraic one. bilinear: ka up to the yield force F_y [N],
    kb after it; its characteristic strength is Q_d = F_y (1 - kb/ka). damping [N s/m] adds a viscous force to any of
    them. x_max [m]: design displacement; it is no stop, but a peak beyond it gives a warning.
    """

    table: ClassVar[str] = "bearings"

    law: Literal[*NUMBERS] = "algebraic"  # type: ignore[valid-type]  # the names in `LAWS`
    count: Annotated[int, Ge(1), Le(10**6)] = 1
    ka: Positive
    kb: NotNegative | None = None
    alpha: Annotated[float, Gt(1), Le(MOST)] | None = None
    delta_k: Annotated[float, Ge(1e-100), Le(MOST)] = 1e-20
    yield_force: Positive | None = None
    damping: NotNegative = 0.0
    x_max: Positive | None = None

    @model_validator(mode="after")
    def _law_is_complete(self) -> Self:
        law = LAWS[NUMBERS[self.law]]
        for name in KEYS:
            given = getattr(self, name)
            if given is None and name in law.needs:
                raise SceneError(f"bearings.{name}", None, "missing", f"add it: the {self.law} law needs it")
            if given is not None and name not in law.needs + law.ignores:
                raise SceneError(f"bearings.{name}", given, f"not used by the {self.law} law", "remove it")
        if "kb" in law.needs and self.ka <= self.given("kb"):
            raise SceneError(
                "bearings.ka",
                self.ka,
                f"not above kb = {self.kb:.6g} N/m",
                "give the initial stiffness as ka, the smaller one after yielding as kb [N/m]",
            )
        if "alpha" in law.needs and self.delta_k >= self.ka - self.given("kb"):
            raise SceneError(
                "bearings.delta_k",
                self.delta_k,
                "not below ka - kb",
                "give a small stiffness difference [N/m] such as 1e-20, or leave it out",
            )
        if "alpha" in law.needs and not law.constants(self)["f0"] > 0:
            raise SceneError("bearings.alpha", self.alpha, "leaves no hysteretic force, in rounding", "give less")
        return self

    def given(self, name: str) -> float:
        """Return the number called `name`, which this law needs."""
        return float(getattr(self, name))


class Start(Part):
    """Initial state: tilt [rad], tilt_rate [rad/s], base_displacement [m], base_velocity [m/s].

    An initial base displacement is reached by loading the virgin bearing monotonically to it.
    """

    table: ClassVar[str] = "start"

    tilt: Annotated[float, Gt(-math.pi / 2), Lt(math.pi / 2)] = 0.0
    tilt_rate: Number = 0.0
    base_displacement: Number = 0.0
    base_velocity: Number = 0.0


class Scene(Part):
    """All that is simulated; a part that is None is not modelled.

    Without a base the block stands on rigid ground; without bearings the base slides without friction; without a motion
    the block moves freely. A pedestal is fixed to the ground or the base, and moves with it; without one the block's
    support has no edge. Without a duration [s] a run continues until its outcome is decided. friction: Coulomb's
    coefficient between the block and its support; without one the block does not slide.
    """

    block: Block
    base: Base | None = None
    pedestal: Pedestal | None = None
    bearings: Bearings | None = None
    motion: SampledMotion | PulseMotion | None = None
    start: Start = Start()
    duration: Positive | None = None
    friction: Positive | None = None
    gravity: Positive = 9.81
    name: str = ""

    @property
    def end(self) -> float:
        """Return the end of a run [s]: the duration, which every scene passed to a solver has; see `until_decided`."""
        assert self.duration is not None
        return self.duration

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        if self.base is None:
            if self.bearings is not None:
                raise SceneError("bearings", None, "need a base to carry", "add a table [base] with its mass")
            for name in ("base_displacement", "base_velocity"):
                if getattr(self.start, name) != 0:
                    raise SceneError(
                        f"start.{name}",
                        getattr(self.start, name),
                        "needs a base",
                        "add a table [base] with its mass, or remove it",
                    )
        wide = 2 * self.block.half_width
        if self.pedestal and self.pedestal.width < wide * (1 - AS_WIDE):
            raise SceneError(
                "pedestal.width", self.pedestal.width, "narrower than the block", f"give at least {wide:.6g} m"
            )
        for key, value, problem in (
            ("friction", self.friction, "on a free pedestal nothing slides"),
            ("block.restitution", self.block.restitution, "on a free pedestal the law of impact gives it"),
            ("start.tilt_rate", self.start.tilt_rate or None, "a stack starts without a velocity"),
            ("start.base_velocity", self.start.base_velocity or None, "a stack starts without a velocity"),
        ):
            if self.is_stack and value is not None:
                raise SceneError(key, value, problem, "remove it, or the line free = true")
        return self

    @model_validator(mode="after")
    def _times_are_resolved(self) -> Self:
        """Refuse times at which adjacent doubles are too far apart to resolve the block or the motion."""
        ends = {"run.duration": (self.duration or 0.0, self.rocking_frequency)}
        if self.motion is not None:
            fastest = max(self.rocking_frequency, getattr(self.motion, "frequency", 0.0))
            ends[slowest_key(self.motion)] = (self.motion.end, fastest)
        for key, (end, rate) in ends.items():
            if math.ulp(end) * rate > RESOLUTION:
                raise SceneError(
                    key,
                    self.duration if key == "run.duration" else getattr(self.motion, key.partition(".")[2]),
                    f"times up to {end:.3g} s are known to {math.ulp(end):.1g} s only, too little for {rate:.3g} rad/s",
                    "give an earlier end" if key != "motion.frequency" else "give a higher one",
                )
        return self

    @property
    def rocking_frequency(self) -> float:
        """Return omega_r = sqrt(m g R/J_O) [rad/s], eq. (1)."""
        block = self.block
        return math.sqrt(block.mass * self.gravity * block.radius / block.inertia)

    @property
    def base_mass(self) -> float:
        """Return m_b [kg], the mass of the base and of a pedestal on it; 0 on rigid ground."""
        return 0.0 if self.base is None else self.base.mass + ((self.pedestal and self.pedestal.mass) or 0.0)

    @property
    def is_stack(self) -> bool:
        """Return whether the pedestal is free, so that there are two blocks on each other."""
        return self.pedestal is not None and self.pedestal.free

    @property
    def edge(self) -> float:
        """Return the half width of the pedestal [m]; inf without one."""
        # on one as wide as the block, rounding is no fall
        return max(0.5 * self.pedestal.width, self.block.half_width * (1 + 1e-9)) if self.pedestal else math.inf

    @property
    def total_mass(self) -> float:
        """Return m + m_b [kg]."""
        return self.block.mass + self.base_mass

    @property
    def mass_share(self) -> float:
        """Return m/(m + m_b), the paper's m-tilde; 0 on rigid ground."""
        return self.block.mass / self.total_mass if self.base else 0.0

    def with_(self, **changes: Any) -> Self:
        """Return a copy with fields replaced, validated again; ``block={"slenderness": 0.2}`` changes one part."""
        values = {name: getattr(self, name) for name in type(self).model_fields}
        for name, change in changes.items():
            part = values.get(name)
            if isinstance(change, dict) and isinstance(part, Part):
                change = type(part)(**{**part.model_dump(), **change})
            values[name] = change
        return type(self)(**values)

    def digest(self) -> str:
        """Return a hash of the scene without its name: equal for scenes with the same simulation."""
        content = self.model_dump(mode="python", exclude={"name", "motion"})
        content["motion"] = self.motion.digest() if self.motion else None
        if self.pedestal is None:  # keeps the digests in stored results
            del content["pedestal"]
        elif not self.pedestal.free:  # as above
            del content["pedestal"]["free"]
        if self.bearings:  # keeps the digests in stored results
            content["bearings"] = {
                name: value
                for name, value in content["bearings"].items()
                if value is not None or name in ("kb", "alpha")
            }
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def refuse_free(scene: Scene, what: str) -> None:
    """Raise `SceneError` where the pedestal is free; what : that does not know it, in words."""
    if scene.is_stack:
        remedy = "leave the line free = true out: the pedestal is then fixed"
        raise SceneError("pedestal.free", True, f"not supported by {what}", remedy, scene.name or None)


MASS, RADIUS = 3172.05, 1.0884  # kg, m
BASE = Base(mass=212.0)
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


def caryatid_block(slenderness: float) -> Block:
    """Return a block of the Caryatid's mass and radius; slenderness [rad]."""
    return Block(mass=MASS, radius=RADIUS, slenderness=slenderness)


def benchmark_block() -> Block:
    """Return the block of problems A and B: omega_r = 2.60 rad/s with g = 9.81 m/s2, slenderness 0.25, Housner's e."""
    return Block(mass=1000.0, radius=0.75 * 9.81 / 2.60**2, slenderness=0.25)


def problem_a(duration: float = 7.0) -> Scene:
    """Return problem A: free rocking on rigid ground from 0.9 slenderness."""
    return Scene(name="problem A", block=benchmark_block(), start=Start(tilt=0.9 * 0.25), duration=duration)


def problem_b(duration: float = 6.0) -> Scene:
    """Return problem B: the block at rest under one full sine of 1.2 g tan(slenderness) at 5.2 rad/s."""
    block = benchmark_block()
    pulse = PulseMotion("one-sine", 1.2 * 9.81 * math.tan(block.slenderness), 5.2)
    return Scene(name="problem B", block=block, motion=pulse, duration=duration)
