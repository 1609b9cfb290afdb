"""A second reader of scene files, written for tests alone: Python's TOML, and a table of what each key may hold.

It shares no code with the reader of the project and refuses by `ValueError` and `KeyError`.
"""

import math
import tomllib

MOST, LEAST = 1e20, 1e-20
POSITIVE, NOT_NEGATIVE, ANY, SEED = (float, LEAST, MOST), (float, 0, MOST), (float, -MOST, MOST), (int, 0, 2**64 - 1)
UPRIGHT = math.nextafter(math.pi / 2, 0)
ABOVE_1 = math.nextafter(1, 2)
PULSES = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
# {table: {key: (type, least, largest), or the words it may be; None: any text}}
KEYS = {
    "": {"name": None, "gravity": POSITIVE, "friction": POSITIVE},
    "block": {
        "mass": POSITIVE,
        "radius": POSITIVE,
        "slenderness": (float, LEAST, UPRIGHT),
        "corner_inertia": POSITIVE,
        "restitution": (float, 0, 1),
    },
    "base": {"mass": POSITIVE},
    "pedestal": {**dict.fromkeys(("width", "mass", "height"), POSITIVE), "free": bool},
    "bearings": {
        "law": ("algebraic", "linear", "bouc-wen", "bilinear"),
        "count": (int, 1, 10**6),
        "ka": POSITIVE,
        "kb": NOT_NEGATIVE,
        "alpha": (float, ABOVE_1, MOST),
        "delta_k": POSITIVE,
        "yield_force": POSITIVE,
        "damping": NOT_NEGATIVE,
        "x_max": POSITIVE,
    },
    "motion": {
        "pulse": PULSES,
        "amplitude": ANY,
        "frequency": POSITIVE,
        "start": NOT_NEGATIVE,
        "synthetic": ("duzce-like",),
        "seed": SEED,
        "vertical_ratio": ANY,
        "vertical_phase": ANY,
        "vertical_seed": SEED,
        "scale": ANY,
    },
    "start": {"tilt": (float, -UPRIGHT, UPRIGHT), "tilt_rate": ANY, "base_displacement": ANY, "base_velocity": ANY},
    "run": {"duration": POSITIVE},
}
# {table: (keys it needs, keys it must not have)}; of bearings by their law, of motions by their kind
FITTING = {
    "block": ({"mass", "radius", "slenderness"}, set()),
    "base": ({"mass"}, set()),
    "pedestal": ({"width"}, set()),
    "algebraic": ({"ka", "kb", "alpha"}, {"yield_force"}),
    "bouc-wen": ({"ka", "kb", "alpha"}, {"yield_force"}),
    "bilinear": ({"ka", "kb", "yield_force"}, {"alpha"}),
    "linear": ({"ka"}, {"yield_force"}),
    "pulse": ({"amplitude", "frequency"}, {"synthetic", "seed", "vertical_seed"}),
    "synthetic": ({"synthetic"}, {"amplitude", "frequency", "start", "vertical_phase"}),
}


def read(content):
    """{table: {key: value}} of the scene file in the bytes `content`, "" for the keys before all tables."""
    found = tomllib.loads(content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n"))
    tables = {"": {key: value for key, value in found.items() if key not in KEYS or not key}}
    tables |= {key: found[key] for key in set(found) & set(KEYS) - {""}}
    if not all(isinstance(part, dict) and _fits(table, part) for table, part in tables.items()) or not _stands(tables):
        raise ValueError("no scene")
    return tables


def _fits(table, part):
    """Whether each key of a table holds what it may, and none is missing or too many."""
    kind = part.get("law", "algebraic") if table == "bearings" else table
    kind = ("pulse" if "pulse" in part else "synthetic") if table == "motion" else kind
    needed, barred = FITTING.get(kind, (set(), set()))
    return needed <= set(part) and not barred & set(part) and all(_may_be(KEYS[table][key], part[key]) for key in part)


def _may_be(rule, value):
    if rule is None or rule is bool:
        return isinstance(value, rule or str)
    if isinstance(rule[0], str):
        return value in rule
    return type(value) in (int, rule[0]) and rule[1] <= value <= rule[2]


def _stands(tables):
    """Whether the parts of a scene fit together."""
    block, start, bearings, motion = (tables.get(key, {}) for key in ("block", "start", "bearings", "motion"))
    stiff = bearings.get("law") == "linear" or not bearings
    room = 0 if stiff else bearings["ka"] - bearings["kb"]
    moved = bearings or start.get("base_displacement") or start.get("base_velocity")
    pedestal = tables.get("pedestal", {})
    rubs = (
        "friction" in tables.get("", {})
        or "restitution" in block
        or start.get("tilt_rate")
        or start.get("base_velocity")
    )
    wide = 2 * block["radius"] * math.sin(block["slenderness"])
    phased = motion.get("vertical_ratio") and motion.get("vertical_phase")
    return (
        block.get("corner_inertia", math.inf) > block["mass"] * block["radius"] ** 2
        and (stiff or room > (0 if bearings.get("law") == "bilinear" else bearings.get("delta_k", 1e-20)))
        and ("base" in tables or not moved)
        and ("mass" in pedestal) == ("height" in pedestal)
        and not (pedestal.get("free") and (rubs or "mass" not in pedestal))
        and pedestal.get("width", math.inf) >= wide * (1 - 1e-4)
        and ("vertical_ratio" in motion or not {"vertical_phase", "vertical_seed"} & set(motion))
        and not (phased and motion["pulse"] in PULSES[3:])
    )
