"""A second reader of scene files, written for tests alone, for the part of TOML that scenes need.

It shares no code with the reader of the project. A file outside that part (lists, dates, tables in a line, text over
lines) is `Refused`, which is right for scenes: no key of theirs takes such a value.
"""

import math
import re

LAWS = ("algebraic", "linear", "bouc-wen", "bilinear")
PULSES = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
MOST, LEAST = 1e20, 1e-20
ESCAPES = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r", '"': '"', "\\": "\\"}
TEXT = r'"(?:[^"\\]|\\[btnfr"\\])*"' + "|'[^']*'"
DIGITS = "[0-9]+(?:_[0-9]+)*"
NUMBERS = (  # single underscores between digits; no zero before other digits
    rf"[+-]?(?:0|[1-9](?:_?[0-9])*)(?P<broken>[.]{DIGITS})?(?P<power>[eE][+-]?{DIGITS})?"
    "|0x[0-9a-fA-F]+(?:_[0-9a-fA-F]+)*|0o[0-7]+(?:_[0-7]+)*|0b[01]+(?:_[01]+)*"
)
BLANK, END = "[ \t]*", r"[ \t]*(?:#.*)?"
TABLE = re.compile(rf"\[{BLANK}(?P<key>{TEXT}|[A-Za-z0-9_-]+){BLANK}\]{END}")
LINE = re.compile(rf"(?P<key>{TEXT}|[A-Za-z0-9_-]+){BLANK}={BLANK}(?P<value>{TEXT}|[A-Za-z0-9_+.-]+){END}")


class Refused(Exception):
    """No scene."""


def _positive(value):
    return _number(value) and LEAST <= value <= MOST


def _not_negative(value):
    return _number(value) and 0 <= value <= MOST


def _any(value):
    return _number(value) and -MOST <= value <= MOST


def _number(value):
    return isinstance(value, int | float) and not isinstance(value, bool)


def _whole(low, high):
    return lambda value: isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def _one_of(*words):
    return lambda value: isinstance(value, str) and value in words


def _angle(value):
    return _number(value) and -math.pi / 2 < value < math.pi / 2


KEYS = {
    "": {"name": lambda value: isinstance(value, str), "gravity": _positive, "friction": _positive},
    "block": {
        "mass": _positive,
        "radius": _positive,
        "slenderness": lambda value: _angle(value) and value > 0,
        "corner_inertia": _positive,
        "restitution": lambda value: _number(value) and 0 <= value <= 1,
    },
    "base": {"mass": _positive},
    "bearings": {
        "law": _one_of(*LAWS),
        "count": _whole(1, 10**6),
        "ka": _positive,
        "kb": _not_negative,
        "alpha": lambda value: _number(value) and 1 < value <= MOST,
        "delta_k": _positive,
        "yield_force": _positive,
        "damping": _not_negative,
        "x_max": _positive,
    },
    "motion": {
        "pulse": _one_of(*PULSES),
        "amplitude": _any,
        "frequency": _positive,
        "start": _not_negative,
        "synthetic": _one_of("duzce-like"),
        "seed": _whole(0, 2**64 - 1),
        "vertical_ratio": _any,
        "vertical_phase": _any,
        "vertical_seed": _whole(0, 2**64 - 1),
        "scale": _any,
    },
    "start": {"tilt": _angle, "tilt_rate": _any, "base_displacement": _any, "base_velocity": _any},
    "run": {"duration": _positive},
}
NEEDED = {"block": ("mass", "radius", "slenderness"), "base": ("mass",), "bearings": ("ka",)}


def read(content):
    """{table: {key: value}} of the scene file in the bytes `content`, "" for the keys before all tables."""
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        raise Refused("not UTF-8") from None
    text = text[1:] if text[:1] == "\ufeff" else text
    tables = {"": {}}
    table = ""
    for line in text.replace("\r\n", "\n").replace("\r", "\n").split("\n"):
        line = line.strip(" \t")
        if any((ord(sign) < 32 and sign != "\t") or ord(sign) == 127 for sign in line):
            raise Refused("control character")
        found = (TABLE if line[:1] == "[" else LINE).fullmatch(line)
        if line[:1] in ("", "#"):
            continue
        if not found:
            raise Refused("neither a table nor a key with its value")
        name = _text(found["key"])
        if line[:1] == "[":
            if name in tables or name not in KEYS:
                raise Refused("table")
            tables[name] = {}
            table = name
        else:
            if name in tables[table] or name not in KEYS[table]:
                raise Refused("key")
            value = _value(found["value"])
            if not KEYS[table][name](value):
                raise Refused(f"{name} = {str(value)[:40]}")
            tables[table][name] = value
    _check(tables)
    return tables


def _text(word):
    """The word, or what stands between its quotes."""
    if word[0] == '"':
        return re.sub(r"\\(.)", lambda escape: ESCAPES[escape[1]], word[1:-1])
    return word[1:-1] if word[0] == "'" else word


def _value(word):
    if word[0] in "\"'":
        return _text(word)
    if word in ("true", "false"):
        return word == "true"
    if word.lstrip("+-") in ("inf", "nan") and len(word) < 5:
        return float(word)
    found = re.fullmatch(NUMBERS, word)
    if not found:
        raise Refused("number")
    if found["broken"] or found["power"]:
        return float(word)
    if len(word.replace("_", "")) > 4000:
        raise Refused("long")
    return int(word, 0)


def _check(tables):
    """Refuse a scene whose parts do not fit."""
    if "block" not in tables:
        raise Refused("no block")
    for table, keys in NEEDED.items():
        if table in tables and any(key not in tables[table] for key in keys):
            raise Refused(f"{table} lacks a key")
    block, start, bearings = tables["block"], tables.get("start", {}), tables.get("bearings")
    if block.get("corner_inertia", math.inf) <= block["mass"] * block["radius"] ** 2:
        raise Refused("inertia")
    law = bearings and bearings.get("law", "algebraic")
    if law and ("yield_force" in bearings) != (law == "bilinear"):
        raise Refused("yield_force")
    if law and law != "linear":
        if "kb" not in bearings or ("alpha" in bearings) != (law != "bilinear") or bearings["ka"] <= bearings["kb"]:
            raise Refused("law")
        if law != "bilinear" and bearings.get("delta_k", 1e-20) >= bearings["ka"] - bearings["kb"]:
            raise Refused("delta_k")
    if "base" not in tables and (bearings is not None or start.get("base_displacement") or start.get("base_velocity")):
        raise Refused("no base")
    if "motion" in tables:
        motion = tables["motion"]
        if ("pulse" in motion) == ("synthetic" in motion):
            raise Refused("motions")
        if "pulse" in motion and ("seed" in motion or "amplitude" not in motion or "frequency" not in motion):
            raise Refused("pulse")
        if "synthetic" in motion and {"amplitude", "frequency", "start"} & set(motion):
            raise Refused("synthetic")
        if "vertical_phase" in motion and "pulse" not in motion or "vertical_seed" in motion and "pulse" in motion:
            raise Refused("vertical of another motion")
        if {"vertical_phase", "vertical_seed"} & set(motion) and "vertical_ratio" not in motion:
            raise Refused("no vertical ratio")
        if motion.get("vertical_ratio") and motion.get("vertical_phase") and motion["pulse"] in PULSES[3:]:
            raise Refused("phase")
