"""A second reader of records, written for tests alone: by patterns of its own, in whole numbers and fractions.

It shares no code, no pattern and no floating-point step with the reader of the project, so that the two can be held
against each other on damaged files. It is slow (its test of uniform times takes every pair) and as strict as the rules:
what is not surely a record is `Refused`.
"""

import re
from fractions import Fraction

import strict_columns
import strict_formats
from strict_statements import blanked, step_of_all
from strict_words import GIVEN, KNOWN, G, Refused, fortran, step_of, unit_of, whole


def read(content, units=None, dt=None, column=None, channel=None):
    """(least step [s], largest step [s], samples [m/s2]) of the record in the bytes `content`."""
    lines = _lines(content)
    if not any(line.strip() for line in lines):
        raise Refused("empty")
    if strict_formats.by_name(lines, content):
        raise Refused("format not read")
    found = _at2(lines) or _dyna(lines) or _channel(lines, channel)
    if found and column is not None:
        raise Refused("no columns")
    step, samples, factor = found or strict_columns.columns(lines, dt is not None, column)
    if channel is not None and not (strict_formats.csmip(lines) or strict_formats.cosmos(lines)):
        raise Refused("no channels")
    if units is not None and units not in GIVEN:
        raise Refused("unit given")
    if factor is None and units is None:
        raise Refused("no unit")
    if factor is not None and units is not None and factor != GIVEN[units]:
        raise Refused("two units")
    factor = GIVEN[units] if factor is None else factor
    if len(samples) < 2:
        raise Refused("samples")
    if step is None and dt is None:
        raise Refused("no step")
    step = (Fraction(dt), Fraction(dt)) if step is None else step
    if dt is not None and abs(Fraction(dt) - sum(step) / 2) > sum(step) / 2 / 10**6:
        raise Refused("two steps")
    if not all(Fraction(1, 10**7) <= bound <= 1000 for bound in step):
        raise Refused("step")
    if max(abs(sample) for sample in samples) * factor > 10**6 * G:
        raise Refused("peak")
    return float(step[0]), float(step[1]), [float(sample * factor) for sample in samples]


def _lines(content):
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = content.decode("utf-16", errors="replace")
    else:
        try:
            text = content.decode("utf-8")
        except UnicodeDecodeError:
            text = "".join(chr(byte) for byte in content)
        text = text[1:] if text[:1] == "\ufeff" else text
    if content.startswith((b"\x1f\x8b", b"PK", b"BZh", b"\xfd7zXZ")):  # `test_packed` damages packed files
        raise Refused("packed")
    text = text.rstrip("\x1a")
    if any((sign < " " and sign not in "\t\r\n") or sign == "\x7f" for sign in text):
        raise Refused("control character")
    return re.split("\r*\n|\r+", text)


# Formats


# The numbers before their names; each `npts =` with the count behind it; each `dt =` or `dt (unit) =`.
OLD = re.compile(r"\s*([0-9]+)\s+(\S+)\s+npts\s+dt(?![^\s(\[])\s*([(\[].*)?.*")
NPTS = re.compile(r"\bnpts\s*[=:]\s*([^\s,;]*)")
DT = re.compile(r"\bdt\s*(?:[(\[]\s*[a-z]*\s*[)\]]\s*)?[=:]")


def _channel(lines, wanted):
    """(step, samples, factor) of the channel wanted of a file that has several; None if it is none."""
    channels = strict_formats.csmip(lines) or strict_formats.cosmos(lines)
    channels = channels or strict_formats.knet(lines) or strict_formats.smc(lines)
    if channels is None:
        return None
    wanted = None if wanted is None else str(wanted).casefold()
    found = [channel for channel in channels if wanted in (None, channel[0])]
    found = found or [channel for channel in channels if channel[1] == wanted]
    if len(found) != 1:
        raise Refused("channel")
    _, _, step, samples, factor = found[0]
    return step and (step, step), samples, factor


def _at2(lines):
    """(step, samples, factor) of a PEER AT2 file; None if it is none."""
    for index, line in enumerate(lines[:8]):
        line = line[:400]
        old = OLD.fullmatch(line.lower().replace(",", " "))
        counts, steps = NPTS.findall(line.lower()), DT.findall(line.lower())
        if old:
            inside = "".join(re.findall("[a-z]", (old[3] or "").partition(")")[0]))
            step_of(old[2], inside)
            count, line = old[1], f"dt = {old[2]} {inside}"
        elif counts and steps:
            if len(counts) > 1 or len(steps) > 1:
                raise Refused("twice")
            count = counts[0]
        else:
            continue
        statements, header = blanked([*lines[:index], line])
        step = step_of_all(statements)
        if None in [found for line in header for found in strict_columns.times_in(line)]:
            raise Refused("unit of time")
        factor = unit_of(header, index - 1)
        samples = fortran(lines[index + 1 :])
        if whole(count) != len(samples):
            raise Refused("count")
        return step and (step, step), samples, factor
    return None


def _dyna(lines):
    """(step, samples, factor) of an ESM/DYNA file; None if it is none."""
    begin = next(i for i, line in enumerate(lines) if line.strip())
    keys, i = {}, begin
    while i < len(lines) and (stated := re.match("([A-Z][A-Z0-9_/^]*):(.*)", lines[i][:400])):
        key, value = stated.groups()
        if keys.setdefault(key, value.strip()) != value.strip():
            raise Refused("two values")
        i += 1
    signs = ("EVENT_NAME", "SAMPLING_INTERVAL_S", "HEADER_FORMAT")
    if i == begin or not any(line.startswith(signs) for line in lines[:70]):
        return None
    unit = keys.get("UNITS", "").lower()
    if unit not in KNOWN:
        raise Refused("unit")
    if keys.get("DATA_TYPE") and keys["DATA_TYPE"][:3].lower() != "acc":
        raise Refused("type")
    samples = fortran(lines[i:])
    if whole(keys.get("NDATA", "")) != len(samples):
        raise Refused("count")
    step = step_of(keys.get("SAMPLING_INTERVAL_S", ""))
    return (step, step), samples, KNOWN[unit]
