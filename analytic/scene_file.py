"""Scene files (TOML): read, with all mistakes in one `SceneError`, and written from measured quantities.

SI units. Only ``[block]`` is needed; a part that is left out is not modelled::

    # friction = 0.7          # of the block on its support, which it then may slide on; before the first table

    [block]
    mass = 3172.05            # kg
    radius = 1.0884           # m, base corner to centre of mass
    slenderness = 0.28        # rad, angle of that line to the vertical
    # corner_inertia          # kg m2, default 4/3 m R^2
    # restitution             # default: eq. (7) of the paper, from momentum

    [base]                    # without it the block stands on rigid ground
    mass = 212.0              # kg

    [pedestal]                # under the block, fixed to ground or base; without it the block's support has no edge
    width = 0.8               # m: a block that slides beyond it falls off
    # mass = 430.0            # kg, and height = 1.0 [m]: whether the pedestal stays where it is; on a base the mass
                              # moves with it
    # free = true             # with mass and height: it is not fixed, and may lift and rock

    [bearings]                # without them the base slides without friction; values per bearing
    law = "algebraic"         # or "bouc-wen", "bilinear", "linear"
    count = 4
    ka = 6.22e4               # N/m, initial stiffness
    kb = 6.22e3               # N/m, after yielding
    alpha = 44.69             # of algebraic and bouc-wen
    # yield_force = 700.0     # N, of bilinear: where ka ends and kb begins; in place of alpha
    # damping                 # N s/m, viscous
    # x_max = 0.30            # m, design displacement: a peak beyond it gives a warning

    [motion]                  # without it free motion; exactly one of record, pulse, synthetic
    synthetic = "duzce-like"  # with optional seed
    # record = "file"         # relative to the scene file; units = "m/s2", "cm/s2" or "g" where the file states none,
                              # dt [s] where it states no step, column = 3 or channel = 3 or "Up" where it has several
    # pulse = "one-sine"      # "one-cosine", "half-sine", "rectangular", "ricker"; amplitude [m/s2], frequency [rad/s]
    # scale = 1.0             # of all components
    # vertical = "file"       # beside a record, upward; or of the same file, without it, vertical_column = 4 or
                              # vertical_channel = 3 or "Up"
    # vertical_ratio = 0.6    # of a pulse or a synthetic motion: vertical over horizontal; with vertical_phase [rad]
                              # (sines and cosines) or vertical_seed (default seed + 1)

    [start]                   # optional: tilt [rad], tilt_rate [rad/s], base_displacement [m], base_velocity [m/s]

    [run]                     # optional: without it a run ends when its outcome is decided
    duration = 20.0           # s

Under a vertical motion a_v, gravity is g + a_v(t) for the block. Bearings are vertically rigid in the model, while real
bearings vibrate vertically at 10 to 20 Hz; a warning says so. Components with different steps or lengths are resampled
and padded, and ``warnings`` say how. Where the normal force reaches zero and no friction is given, the outcome is
outside the model.

``friction`` is Coulomb's coefficient between the block and its support. With it the block slides when friction is
exhausted, and flies where the normal force vanishes (`analytic.sliding.equations`). It holds for the analytic model
and, in place of the engine's own setting, for engines. Without it the block does not slide, and the friction demand
says which coefficient that takes. Two bounds, which an error names: a block released by hand needs a friction at which
its impacts do not slip; and no friction may be so large that a sliding block has no motion (4/3 for a rectangle).

``rocking run`` also runs the analytic model with start, motion and restitution (or friction) changed by a millionth. It
warns if the outcome changes: so near an outcome boundary no solver can be trusted.

A file is written from the height, width and mass of a block, with its base, bearings and motion:
``scene_text("bust", block_from(1.9, 0.55, density=MATERIALS["marble"]))``.
"""

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationError

from .errors import SceneError, SettingError, read_plain, require
from .motion import PULSES, PulseMotion, SampledMotion, paired
from .records import UNITS, read_record
from .records import content as fema
from .records.synthetic import DEFAULT_SEED, STYLES, synthetic_motion
from .rocking import BearingLaw, RockingModel, properties, uplift_of_both
from .scene import (
    SCENE_UNITS,
    Base,
    Bearings,
    Block,
    NotNegative,
    Number,
    Part,
    Pedestal,
    Positive,
    Scene,
    Start,
    missing,
    scene_error,
)

LARGEST, DEEPEST = 100_000, 100  # bytes of a scene file and dots in a line, far more than its keys need
FLAT = "write the tables of a scene file, one level"
SHIPPED = Path(__file__).parent / "scenes"

MOTIONS = {
    "record": ("units", "dt", "column", "channel", "vertical", "vertical_column", "vertical_channel"),
    "pulse": ("amplitude", "frequency", "start", "vertical_ratio", "vertical_phase"),
    "synthetic": ("seed", "vertical_ratio", "vertical_seed"),
}


def _as_text(value: object) -> object:
    """Return the number of a channel as text."""
    return str(value) if type(value) is int else value


class _Motion(Part):
    """The [motion] table: exactly one of record, pulse and synthetic, with the keys that belong to it."""

    table: ClassVar[str] = "motion"

    record: str | None = None
    units: Literal[*UNITS] | None = None  # type: ignore[valid-type]  # names from the one list of them
    dt: Positive | None = None
    column: int | str | None = None
    channel: Annotated[str, BeforeValidator(_as_text)] | None = None
    pulse: Literal[*PULSES] | None = None  # type: ignore[valid-type]  # as above
    amplitude: Number | None = None
    frequency: Positive | None = None
    start: NotNegative | None = None
    synthetic: Literal[*STYLES] | None = None  # type: ignore[valid-type]  # as above
    seed: Annotated[int, Field(ge=0, lt=2**64)] | None = None
    vertical: str | None = None
    vertical_column: int | str | None = None
    vertical_channel: Annotated[str, BeforeValidator(_as_text)] | None = None
    vertical_ratio: Number | None = None
    vertical_phase: Number | None = None
    vertical_seed: Annotated[int, Field(ge=0, lt=2**64)] | None = None
    scale: Number = 1.0

    def motion(self, folder: Path) -> SampledMotion | PulseMotion:
        """Return the ground motion; paths of records are relative to `folder`."""
        kinds = [kind for kind in MOTIONS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            problem = "names several motions at once" if kinds else "names no motion"
            raise SceneError(
                "motion", ", ".join(kinds) or None, problem, "give exactly one of record, pulse and synthetic"
            )
        for key in dict.fromkeys(key for keys in MOTIONS.values() for key in keys):
            owners = [kind for kind, keys in MOTIONS.items() if key in keys]
            if kinds[0] not in owners and getattr(self, key) is not None:
                belongs = f"belongs to a {' or a '.join(owners)}, not to a {kinds[0]}"
                raise SceneError(f"motion.{key}", getattr(self, key), belongs, "remove it")
        for key in ("vertical_phase", "vertical_seed"):
            if self.vertical_ratio is None and getattr(self, key) is not None:
                raise SceneError(
                    f"motion.{key}", getattr(self, key), "without a vertical motion", "add vertical_ratio = ..."
                )
        if self.synthetic:
            return self._synthesised(self.synthetic).scaled(self.scale)
        if self.pulse:
            return self._pulsed().scaled(self.scale)
        level = self._recorded(folder, "record")
        if self.vertical is None and self.vertical_column is None and self.vertical_channel is None:
            return level
        return paired(level, self._recorded(folder, "vertical"))

    def _synthesised(self, style: str) -> SampledMotion:
        seed = DEFAULT_SEED if self.seed is None else self.seed
        level = synthetic_motion(style, seed)
        if not self.vertical_ratio:
            return level
        upright_seed = (seed + 1) % 2**64 if self.vertical_seed is None else self.vertical_seed
        return paired(level, synthetic_motion(style, upright_seed).scaled(self.vertical_ratio))

    def _pulsed(self) -> PulseMotion:
        for key in ("amplitude", "frequency"):
            if getattr(self, key) is None:
                raise missing(f"motion.{key}")
        level = PulseMotion(self.pulse, self.amplitude, self.frequency, self.start or 0.0)  # type: ignore[arg-type]  # checked above
        if not self.vertical_ratio:
            return level
        amplitude, phase = level.amplitude * self.vertical_ratio, self.vertical_phase or 0.0
        try:
            return replace(level, vertical=replace(level, amplitude=amplitude, phase=phase))
        except SceneError as error:
            raise SceneError("motion.vertical_phase", error.value, error.problem, error.remedy) from None

    def _read(self, path: Path, key: Literal["record", "vertical"]) -> SampledMotion:
        prefix = "" if key == "record" else "vertical_"
        choice: dict[str, Any] = {name: getattr(self, prefix + name) for name in ("column", "channel")}
        try:
            return read_record(path, self.units if key == "record" else None, self.scale, dt=self.dt, **choice)
        except SceneError as error:
            if key == "record" or error.key != "motion.units":
                raise
        return read_record(path, self.units, self.scale, dt=self.dt, **choice)  # it does not state its unit

    def _recorded(self, folder: Path, key: Literal["record", "vertical"]) -> SampledMotion:
        """Return the component that `key` names; a vertical one without a file is another channel of the record."""
        name = self.vertical or self.record if key == "vertical" else self.record
        assert name is not None  # checked
        path = Path(name) if fema.is_one(name) else folder / name
        try:
            return self._read(path, key)
        except SceneError as error:
            if error.key.startswith("motion.") and error.key != "motion.record":
                full_key, remedy = error.key, error.remedy
                word = full_key.removeprefix("motion.")
                if word in ("column", "channel") and key == "vertical":
                    full_key, remedy = f"motion.vertical_{word}", remedy.replace(word, f"vertical_{word}")
                raise SceneError(full_key, error.value, f"{error.problem} ({path.name})", remedy) from None
            value_text = "" if error.value is None else f" = {error.value!r}"
            where = "" if error.key in ("record", "motion.record") else f"{error.key}{value_text}: "
            raise SceneError(f"motion.{key}", name, where + error.problem, error.remedy) from None


class _Run(Part):
    table: ClassVar[str] = "run"

    duration: Positive | None = None


class _SceneFile(Part):
    """A scene file with the keys of the file."""

    name: str = ""
    gravity: Positive = 9.81
    friction: Positive | None = None
    block: Block
    base: Base | None = None
    pedestal: Pedestal | None = None
    bearings: Bearings | None = None
    motion: _Motion | None = None
    start: Start = Start()
    run: _Run = _Run()


def shipped_scenes() -> tuple[str, ...]:
    """Return the names of the scenes that come with the package: ``load_scene("caryatid-isolated")``."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def load_scene(path: str | PathLike[str]) -> Scene:
    """Return the scene in a TOML file, or a shipped scene by its name.

    Raises
    ------
    SceneError
        The message names the file, the key, the value and the remedy. It lists all mistakes in keys, in values and in
        the motion. The consistency of the parts is checked once each of them is correct.
    """
    path = Path(path)
    if str(path) in shipped_scenes() and not path.exists():
        path = SHIPPED / f"{path}.toml"
    try:
        return _scene(_parse(path), path)
    except SceneError as error:
        raise error.in_file(path) from None


def _parse(path: Path) -> dict[str, Any]:
    try:
        text = read_plain(path, LARGEST).decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
        for number, line in enumerate(text.split("\n"), 1):
            if line.split("#")[0].count(".") > DEEPEST:  # the parser takes quadratic time in the parts of a key
                raise SceneError("scene", None, f"line {number} is nested too deeply", FLAT)
        return tomllib.loads(text)
    except OSError as error:
        raise SceneError(
            "scene",
            None,
            f"cannot be read ({error.strerror})",
            "give a scene file or one of " + ", ".join(shipped_scenes()),
        ) from error
    except RecursionError:
        raise SceneError("scene", None, "is nested too deeply", FLAT) from None
    except SceneError:
        raise
    except ValueError as error:  # TOML and its encoding, and integers of thousands of digits
        raise SceneError("scene", None, f"is not valid TOML ({error})", "mend the line named") from error


def _scene(table: Mapping[str, Any], path: Path) -> Scene:
    """Return the scene from the tables of a file; raise all mistakes of tables, motion and consistency together."""
    mistakes: list[SceneError] = []
    file = motion = None
    scene: Scene | None = None
    try:
        file = _SceneFile.model_validate(table)  # not **table: a key may be called self
        motion_table = file.motion
    except ValidationError as error:
        mistakes.append(scene_error(error, _SceneFile))
        motion_table = _motion_alone(table)
    try:
        motion = motion_table.motion(path.parent) if motion_table else None
    except SceneError as error:
        mistakes.append(error)
    try:
        if file is not None:
            scene = Scene(
                block=file.block,
                base=file.base,
                pedestal=file.pedestal,
                bearings=file.bearings,
                motion=motion,
                start=file.start,
                duration=file.run.duration,
                gravity=file.gravity,
                friction=file.friction,
                name=file.name or path.stem,
            )
    except SceneError as error:
        mistakes.append(error)
    if mistakes or scene is None:
        raise mistakes[0].with_others(*mistakes[1:])
    return scene


def _motion_alone(table: Mapping[str, Any]) -> _Motion | None:
    """Return the table [motion] of a file with mistakes elsewhere; None if it is missing or has mistakes itself."""
    try:
        return _Motion.model_validate(table.get("motion"))
    except ValidationError:
        return None


# Typical densities [kg/m3]; a measured mass is better.
MATERIALS = {
    "marble": 2700.0,
    "granite": 2650.0,
    "limestone": 2400.0,
    "sandstone": 2300.0,
    "concrete": 2400.0,
    "terracotta": 1900.0,
    "bronze": 8800.0,
    "wood": 600.0,
}

# Rows of `derived` that are compared with the targets and with each other.
PERIOD, DAMPING = "secant period at x_max", "equivalent damping at x_max"
TOGETHER = "uplift acceleration of block and pedestal together"
UPLIFT, YIELD = "uplift acceleration g tan(slenderness)", "acceleration at which the bearings yield"


def block_from(
    height: float, width: float, *, depth: float | None = None, density: float | None = None, mass: float | None = None
) -> Block:
    """Return the homogeneous rectangular `Block` of height and width [m], width along the motion.

    Give its mass [kg], or its density [kg/m3] and depth [m] across the motion (default: the width).
    R = sqrt(h^2 + b^2) and gamma = atan(b/h), with half height h and half width b.

    Raises
    ------
    SettingError
        A length or the mass is not above 0, or both or none of mass and density are given.

    Examples
    --------
    >>> bust = block_from(1.9, 0.55, density=MATERIALS["marble"])
    >>> round(bust.mass), round(bust.slenderness, 4)
    (1552, 0.2818)
    >>> "mass = 1551.83" in scene_text("bust", bust)
    True
    """
    given = {"height": height, "width": width, "depth": depth, "density": density, "mass": mass}
    for name, value in given.items():
        require(value is None or (value > 0 and math.isfinite(value)), f"{name} = {value!r}: give a number above 0")
    if density is not None and mass is None:
        mass = density * height * width * (depth or width)
    elif mass is None or density is not None:
        raise SettingError("give the block's mass [kg], or its density [kg/m3] or material, and not both")
    return Block(mass=mass, radius=0.5 * math.hypot(height, width), slenderness=math.atan2(width, height))


def derived(scene: Scene) -> list[tuple[str, float, str]]:
    """Return the derived quantities of a scene: rows of (name, value, unit).

    Secant period and equivalent damping, W_D/(4 pi E_s) of the hysteresis only, are given if the bearings yield at
    x_max: below yield the loss is smaller than rounding errors.
    """
    block, model = scene.block, RockingModel.of(scene)
    uplift = scene.gravity * math.tan(block.slenderness)
    rows = [
        ("slenderness", block.slenderness, "rad"),
        ("radius R, base corner to centre of mass", block.radius, "m"),
        ("mass", block.mass, "kg"),
        ("moment of inertia J_O about a corner", block.inertia, "kg m2"),
        ("rocking frequency omega_r, eq. (1)", scene.rocking_frequency, "rad/s"),
        (f"restitution e_phi, {'eq. (7)' if block.restitution is None else 'given'}", model.restitution, "-"),
        (UPLIFT, uplift, "m/s2"),
    ]
    if scene.pedestal is not None and scene.pedestal.mass is not None:
        rows.append((TOGETHER, uplift_of_both(scene), "m/s2"))
    if scene.bearings is not None:
        law, x_max = BearingLaw.of(scene.bearings), scene.bearings.x_max
        if x_max is not None and law.dk * x_max >= law.f0:
            at_x_max = properties(scene.bearings, scene.total_mass, x_max)
            rows += [(PERIOD, at_x_max.period, "s"), (DAMPING, at_x_max.damping_equivalent, "-")]
        for name, stiffness in (("before yielding", law.kb + law.dk), ("after yielding", law.kb)):
            if stiffness > 0:
                period = 2 * math.pi * math.sqrt(scene.total_mass / (law.count * stiffness))
                rows.append((f"isolation period {name}", period, "s"))
        if law.f0 > 0:
            rows.append((YIELD, law.count * law.f0 / scene.total_mass, "m/s2"))
    return rows


def scene_text(
    name: str,
    block: Block,
    *,
    base: Base | None = None,
    pedestal: Pedestal | None = None,
    bearings: Bearings | None = None,
    motion: Mapping[str, Any] | None = None,
    tilt: float | None = None,
    friction: float | None = None,
    about: Sequence[str] = (),
    note: Sequence[str] = (),
) -> str:
    """Return a commented scene file (TOML) that `load_scene` reads.

    Parameters
    ----------
    name : str
    block, base, pedestal, bearings : parts of the scene
    motion : dict or None
        Keys of the table [motion].
    tilt : float or None
        Tilt at the start [rad].
    friction : float or None
        Coefficient between the block and its support; None: it does not slide.
    about, note : sequence of str
        Comment lines at the top, and on the bearings.
    """
    slides = "# friction = 0.6  # of the block on its support; without it the block does not slide"
    if friction is not None:
        slides = f"friction = {_toml(friction)}  # of the block on its support: it slides when friction is exhausted"
    degrees = f"{math.degrees(block.slenderness):.4g} degrees"
    rows = {
        "mass": (block.mass, "kg"),
        "radius": (block.radius, "m; base corner to centre of mass"),
        "slenderness": (block.slenderness, f"rad, {degrees}; atan(width/height)"),
    }
    lines = [
        *(f"# {line}" for line in about),
        f"name = {_toml(name)}",
        slides,
        "",
        "[block]",
        *_rows(rows),
        f"# corner_inertia = {block.inertia:.6g}  # kg m2; 4/3 m R^2 of a homogeneous rectangle, unless given",
        "# restitution = 0.9  # default: eq. (7); give a measured one",
    ]
    if base is not None:
        lines += ["", *_base(base)]
    if pedestal is not None:
        sizes = pedestal.model_dump(exclude_defaults=True)
        lines += [
            "",
            "[pedestal]",
            *_rows({name: (sizes[name], SCENE_UNITS.get(f"pedestal.{name}", "")) for name in sizes}),
            *(["# free = true  # not fixed: it may lift and rock"] if pedestal.mass and not pedestal.free else ()),
        ]
    if bearings is not None:
        lines += ["", *_bearings(bearings, note)]
    if motion:
        lines += ["", "[motion]", *(f"{key} = {_toml(value)}" for key, value in motion.items())]
    if tilt is not None:
        lines += ["", "[start]", *_rows({"tilt": (tilt, "rad")})]
    return "\n".join(lines) + "\n"


def with_bearings(text: str, bearings: Bearings, base: Base | None = None, note: Sequence[str] = ()) -> str:
    """Return the text of a scene file with other bearings: the table [bearings] is replaced, or added at the end.

    base : for a scene without one; its table is added before that of the bearings. note : comment lines on the
    bearings.

    Examples
    --------
    >>> softer = Bearings(law="linear", ka=1e4)
    >>> "ka = 10000.0" in with_bearings("[base]\\nmass = 400.0\\n", softer)
    True
    """
    lines = text.rstrip().split("\n")
    heads = [number for number, line in enumerate(lines) if line.lstrip().startswith("[")] + [len(lines)]
    begin = next((number for number in heads[:-1] if lines[number].split("#")[0].strip() == "[bearings]"), len(lines))
    following = next((number for number in heads if number > begin), len(lines))
    before = lines[:begin] if begin < len(lines) else [*lines, ""]
    after = ["", *lines[following:]] if following < len(lines) else []
    under = [] if base is None else [*_base(base), ""]
    return "\n".join([*before, *under, *_bearings(bearings, note), *after]) + "\n"


def _base(base):
    return ["[base]", *_rows({"mass": (base.mass, "kg")})]


def _bearings(bearings, note):
    values = {key: (value, SCENE_UNITS.get(f"bearings.{key}", "")) for key, value in _given(bearings).items()}
    if bearings.x_max is not None:
        values["x_max"] = bearings.x_max, "m; design displacement: a run beyond it has a warning"
    comments = [f"# {line}" for line in note]
    return ["[bearings]  # per bearing", *comments, *_rows({"law": (bearings.law, ""), **values})]


def _given(bearings):
    return {key: value for key, value in bearings.model_dump(exclude_defaults=True).items() if key != "law"}


def _rows(values):
    return [f"{key} = {_toml(value)}" + (f"  # {unit}" if unit else "") for key, (value, unit) in values.items()]


def _toml(value):
    """Return a value as TOML writes it, numbers to six digits; JSON's strings and numbers are TOML's."""
    return json.dumps(float(f"{value:.6g}") if isinstance(value, float) else value, ensure_ascii=False)
