"""A second reader of scene files, written for tests alone: sign by sign, for the part of TOML that scenes need.

It shares no code with the reader of the project. A file outside that part (lists, dates, tables in a line, text over
lines) is `Refused`, which is right for scenes: no key of theirs takes such a value.
"""

import math

LAWS = ("algebraic", "linear", "bouc-wen", "bilinear")
PULSES = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
MOST, LEAST = 1e20, 1e-20
BARE = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-"
ESCAPES = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r", '"': '"', "\\": "\\"}


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
        if line[:1] == "[":
            name, i = _key(line, _blank(line, 1))
            i = _blank(line, i)
            if line[i : i + 1] != "]" or name in tables or name not in KEYS or name == "":
                raise Refused("table")
            _end(line, i + 1)
            tables[name] = {}
            table = name
        elif line[:1] not in ("", "#"):
            name, i = _key(line, 0)
            i = _blank(line, i)
            if line[i : i + 1] != "=" or name in tables[table] or name not in KEYS[table]:
                raise Refused("key")
            value, i = _value(line, _blank(line, i + 1))
            _end(line, i)
            if not KEYS[table][name](value):
                raise Refused(f"{name} = {str(value)[:40]}")
            tables[table][name] = value
    _check(tables)
    return tables


def _blank(line, i):
    while line[i : i + 1] in (" ", "\t") and i < len(line):
        i += 1
    return i


def _end(line, i):
    i = _blank(line, i)
    if line[i : i + 1] not in ("", "#"):
        raise Refused("behind the value")


def _key(line, i):
    if line[i : i + 1] in ('"', "'"):
        return _text(line, i)
    begin = i
    while i < len(line) and line[i] in BARE:
        i += 1
    if i == begin:
        raise Refused("key")
    return line[begin:i], i


def _text(line, i):
    quote, text = line[i], ""
    if line[i : i + 3] == 3 * quote:
        raise Refused("text over lines")
    i += 1
    while line[i : i + 1] != quote:
        if i >= len(line):
            raise Refused("open text")
        if quote == '"' and line[i] == "\\":
            if line[i + 1 : i + 2] not in ESCAPES:
                raise Refused("escape")
            text, i = text + ESCAPES[line[i + 1]], i + 2
        else:
            text, i = text + line[i], i + 1
    return text, i + 1


def _value(line, i):
    if line[i : i + 1] in ('"', "'"):
        return _text(line, i)
    begin = i
    while i < len(line) and line[i] in BARE + "+.":
        i += 1
    word = line[begin:i]
    if word in ("true", "false"):
        return word == "true", i
    sign, digits = (word[0], word[1:]) if word[:1] in ("+", "-") else ("", word)
    if digits in ("inf", "nan"):
        return float(word), i
    if digits[:2] in ("0x", "0o", "0b") and not sign:
        base, figures = {"x": 16, "o": 8, "b": 2}[digits[1]], digits[2:]
        allowed = "0123456789abcdefABCDEF" if base == 16 else "01234567"[:base]
        _grouped(figures, allowed)
        return int(figures.replace("_", ""), base), i
    whole, point, rest = digits.partition(".")
    if point:
        decimals, mark, exponent = rest.replace("E", "e").partition("e")
    else:
        (whole, mark, exponent), decimals = whole.replace("E", "e").partition("e"), ""
    _grouped(whole, "0123456789")
    if len(whole) > 1 and whole[0] == "0":
        raise Refused("leading zero")
    if point:
        _grouped(decimals, "0123456789")
    if mark:
        _grouped(exponent[1:] if exponent[:1] in ("+", "-") else exponent, "0123456789")
    plain = word.replace("_", "")
    if not point and not mark and len(plain) > 4000:
        raise Refused("long")
    return (float(plain) if point or mark else int(plain)), i


def _grouped(figures, allowed):
    """Refuse what is no digits with single underscores between them."""
    if not figures or any(sign not in allowed + "_" for sign in figures):
        raise Refused("number")
    if figures[0] == "_" or figures[-1] == "_" or "__" in figures:
        raise Refused("underscore")


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
