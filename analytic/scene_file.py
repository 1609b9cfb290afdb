"""Scenes from scene files (TOML); all mistakes in a file are reported in one `SceneError`.

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

Under a vertical motion a_v, gravity is g + a_v(t) for the block. The bearings are vertically rigid in the model, while
real ones vibrate vertically at some 10 to 20 Hz; a warning says so. Components with different steps or lengths are
resampled and padded, and ``warnings`` say how. Where the normal force reaches zero and no friction is given, the
outcome is outside the model.

With ``friction``, Coulomb's coefficient between the block and its support, the block slides where it is used up, and
flies where the normal force vanishes, in the analytic model and, in place of its own setting, in an engine
(`analytic.sliding.equations`). Without it the block does not slide, and the friction demand says what that takes. Two
bounds, which an error names: a block released by hand needs a friction at which its impacts do not slip, and none may
be so large that a block that slides has no motion (4/3 for a rectangle).

``rocking run`` also runs the analytic model with start, motion and restitution (or friction) changed by a millionth. It
warns if the outcome changes: so near an outcome boundary no solver can be trusted.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationError

from .errors import SceneError
from .files import read_plain
from .motion import PulseMotion, SampledMotion, paired
from .part import Part, missing, scene_error
from .pulses import PULSES
from .records import UNITS, fema, read_record
from .scene import Base, Bearings, Block, NotNegative, Number, Positive, Scene, Start
from .synthetic import DEFAULT_SEED, STYLES, synthetic_motion

LARGEST, DEEPEST = 100_000, 100  # bytes of a scene file and dots in a line, far more than its keys need
SHIPPED = Path(__file__).parent / "scenes"

MOTIONS = {
    "record": ("units", "dt", "column", "channel", "vertical", "vertical_column", "vertical_channel"),
    "pulse": ("amplitude", "frequency", "start", "vertical_ratio", "vertical_phase"),
    "synthetic": ("seed", "vertical_ratio", "vertical_seed"),
}


def _as_text(found: object) -> object:
    """The number of a channel as text."""
    return str(found) if type(found) is int else found


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
        """The ground motion; paths of records are relative to `folder`."""
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
        other = (seed + 1) % 2**64 if self.vertical_seed is None else self.vertical_seed
        return paired(level, synthetic_motion(style, other).scaled(self.vertical_ratio))

    def _pulsed(self) -> PulseMotion:
        for key in ("amplitude", "frequency"):
            if getattr(self, key) is None:
                raise missing(f"motion.{key}")
        level = PulseMotion(self.pulse, self.amplitude, self.frequency, self.start or 0.0)  # type: ignore[arg-type]  # checked above
        if not self.vertical_ratio:
            return level
        try:
            phase = self.vertical_phase or 0.0
            return replace(level, vertical=replace(level, amplitude=level.amplitude * self.vertical_ratio, phase=phase))
        except SceneError as error:
            raise SceneError("motion.vertical_phase", error.value, error.problem, error.remedy) from None

    def _read(self, path: Path, key: Literal["record", "vertical"]) -> SampledMotion:
        if key == "record":
            said: dict[str, Any] = {"column": self.column, "channel": self.channel}
            return read_record(path, self.units, self.scale, dt=self.dt, **said)
        said = {"column": self.vertical_column, "channel": self.vertical_channel}
        try:
            return read_record(path, None, self.scale, dt=self.dt, **said)
        except SceneError as error:
            if error.key != "motion.units":
                raise
        return read_record(path, self.units, self.scale, dt=self.dt, **said)  # it does not say its unit

    def _recorded(self, folder: Path, key: Literal["record", "vertical"]) -> SampledMotion:
        """The component that `key` names; a vertical one without a file is another channel of the record."""
        name = self.vertical or self.record if key == "vertical" else self.record
        assert name is not None  # checked
        path = Path(name) if fema.is_one(name) else folder / name
        try:
            return self._read(path, key)
        except SceneError as error:
            if error.key.startswith("motion.") and error.key != "motion.record":
                own, remedy = error.key, error.remedy
                word = own.removeprefix("motion.")
                if word in ("column", "channel") and key == "vertical":
                    own, remedy = f"motion.vertical_{word}", remedy.replace(word, f"vertical_{word}")
                raise SceneError(own, error.value, f"{error.problem} ({path.name})", remedy) from None
            found = "" if error.value is None else f" = {error.value!r}"
            where = "" if error.key in ("record", "motion.record") else f"{error.key}{found}: "
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
    bearings: Bearings | None = None
    motion: _Motion | None = None
    start: Start = Start()
    run: _Run = _Run()


def shipped_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package: ``load_scene("caryatid-isolated")``."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def load_scene(path: str | PathLike[str]) -> Scene:
    """The scene in a TOML file, or a shipped scene by its name.

    Raises
    ------
    SceneError
        The message names the file, the key, the value and the remedy. It lists all mistakes in keys, in values and in
        the motion. The consistency of the parts is checked after each of them is correct.
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
                raise SceneError(
                    "scene", None, f"line {number} is nested too deeply", "write the tables of a scene file, one level"
                )
        return tomllib.loads(text)
    except OSError as error:
        raise SceneError(
            "scene",
            None,
            f"cannot be read ({error.strerror})",
            "give a scene file or one of " + ", ".join(shipped_scenes()),
        ) from error
    except RecursionError:
        raise SceneError("scene", None, "is nested too deeply", "write the tables of a scene file, one level") from None
    except SceneError:
        raise
    except ValueError as error:  # TOML and its encoding, and integers of thousands of digits
        raise SceneError("scene", None, f"is not valid TOML ({error})", "mend the line named") from error


def _scene(table: Mapping[str, Any], path: Path) -> Scene:
    """The scene from the tables of a file; raises all mistakes of tables, motion and consistency together."""
    mistakes: list[SceneError] = []
    file = motion = None
    scene: Scene | None = None
    try:
        file = _SceneFile.model_validate(table)  # not **table: a key may be called self
        said = file.motion
    except ValidationError as error:
        mistakes.append(scene_error(error, _SceneFile))
        said = _motion_alone(table)
    try:
        motion = said.motion(path.parent) if said else None
    except SceneError as error:
        mistakes.append(error)
    try:
        if file is not None:
            scene = Scene(
                block=file.block,
                base=file.base,
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
    """The table [motion] of a file with mistakes elsewhere; None if it is missing or has mistakes itself."""
    try:
        return _Motion.model_validate(table.get("motion"))
    except ValidationError:
        return None
