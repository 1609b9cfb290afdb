"""A scene file from measured quantities: height, width and mass of a block, its base and bearings, a motion.

text = scene_text("bust", block_from(1.9, 0.55, density=MATERIALS["marble"]))
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from .bearing import BearingLaw
from .design import properties
from .errors import SettingError
from .part import UNITS
from .rocking import RockingModel
from .scene import Base, Bearings, Block, Scene

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
UPLIFT, YIELD = "uplift acceleration g tan(slenderness)", "acceleration at which the bearings yield"


def block_from(
    height: float, width: float, *, depth: float | None = None, density: float | None = None, mass: float | None = None
) -> Block:
    """The homogeneous rectangular `Block` of height and width [m], width along the motion.

    Given is its mass [kg], or its density [kg/m3] and depth [m] across the motion (default: the width).
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
        if value is not None and not (value > 0 and math.isfinite(value)):
            raise SettingError(f"{name} = {value!r}: give a number above 0")
    if density is not None and mass is None:
        mass = density * height * width * (depth or width)
    elif mass is None or density is not None:
        raise SettingError("give the block's mass [kg], or its density [kg/m3] or material, and not both")
    return Block(mass=mass, radius=0.5 * math.hypot(height, width), slenderness=math.atan2(width, height))


def derived(scene: Scene) -> list[tuple[str, float, str]]:
    """Derived quantities of a scene: rows of (name, value, unit).

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
            force = law.count * law.f0 / scene.total_mass
            rows.append((YIELD, force, "m/s2"))
    return rows


def scene_text(
    name: str,
    block: Block,
    *,
    base: Base | None = None,
    bearings: Bearings | None = None,
    motion: Mapping[str, Any] | None = None,
    tilt: float | None = None,
    friction: float | None = None,
    about: Sequence[str] = (),
) -> str:
    """A commented scene file (TOML) that `load_scene` reads.

    Parameters
    ----------
    name : str
    block, base, bearings : parts of the scene
    motion : dict or None
        Keys of the table [motion].
    tilt : float or None
        Of the start [rad].
    friction : float or None
        Coefficient between the block and its support; None: it does not slide.
    about : sequence of str
        Comment lines at the top.
    """
    lines = [*(f"# {line}" for line in about), f"name = {_toml(name)}"]
    if friction is not None:
        lines.append(f"friction = {_toml(friction)}  # of the block on its support: it slides where this is used up")
    else:
        lines.append("# friction = 0.6  # of the block on its support; without it the block does not slide")
    lines += ["", "[block]"]
    lines += _rows({"mass": (block.mass, "kg"), "radius": (block.radius, "m; base corner to centre of mass")})
    degrees = math.degrees(block.slenderness)
    lines += _rows({"slenderness": (block.slenderness, f"rad, {degrees:.4g} degrees; atan(width/height)")})
    lines += [
        f"# corner_inertia = {block.inertia:.6g}  # kg m2; 4/3 m R^2 of a homogeneous rectangle, unless given",
        "# restitution = 0.9  # default: eq. (7); give a measured one",
    ]
    if base is not None:
        lines += ["", *_base(base)]
    if bearings is not None:
        lines += ["", *_bearings(bearings)]
    if motion:
        lines += ["", "[motion]", *(f"{key} = {_toml(value)}" for key, value in motion.items())]
    if tilt is not None:
        lines += ["", "[start]", *_rows({"tilt": (tilt, "rad")})]
    return "\n".join(lines) + "\n"


def with_bearings(text: str, bearings: Bearings, base: Base | None = None) -> str:
    """The text of a scene file with other bearings: the table [bearings] is replaced, or added at the end.

    base : for a scene without one; its table is added before that of the bearings.

    Examples
    --------
    >>> one = Bearings(law="linear", ka=1e4)
    >>> "ka = 10000.0" in with_bearings("[base]\\nmass = 400.0\\n", one)
    True
    """
    lines = text.rstrip().split("\n")
    heads = [number for number, line in enumerate(lines) if line.lstrip().startswith("[")] + [len(lines)]
    own = next((number for number in heads[:-1] if lines[number].split("#")[0].strip() == "[bearings]"), len(lines))
    following = next((number for number in heads if number > own), len(lines))
    before = lines[:own] if own < len(lines) else [*lines, ""]
    after = ["", *lines[following:]] if following < len(lines) else []
    under = [] if base is None else [*_base(base), ""]
    return "\n".join([*before, *under, *_bearings(bearings), *after]) + "\n"


def _base(base):
    return ["[base]", *_rows({"mass": (base.mass, "kg")})]


def _bearings(bearings):
    values = {key: (value, UNITS.get(f"bearings.{key}", "")) for key, value in _given(bearings).items()}
    if bearings.x_max is not None:
        values["x_max"] = bearings.x_max, "m; design displacement: a run beyond it has a warning"
    return ["[bearings]  # per bearing", *_rows({"law": (bearings.law, ""), **values})]


def _given(bearings):
    return {key: value for key, value in bearings.model_dump(exclude_defaults=True).items() if key != "law"}


def _rows(values):
    return [f"{key} = {_toml(value)}" + (f"  # {unit}" if unit else "") for key, (value, unit) in values.items()]


def _toml(value):
    """A value as TOML writes it, numbers to six digits; JSON's strings and numbers are TOML's."""
    return json.dumps(float(f"{value:.6g}") if isinstance(value, float) else value, ensure_ascii=False)
