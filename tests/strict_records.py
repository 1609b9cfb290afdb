"""A second reader of records, written for tests alone: by patterns of its own, in whole numbers and fractions.

It shares no code, no pattern and no floating-point step with the reader of the project, so that the two can be held
against each other on damaged files. It is slow (its test of uniform times takes every pair) and as strict as the rules:
what is not surely a record is refused by one of `strict_words.REFUSED`, without words.
"""

import re
from fractions import Fraction

import strict_columns
import strict_formats
from strict_statements import blanked, step_of_all
from strict_words import GIVEN, KNOWN, G, fortran, need, step_of, unit_of, whole


def read(content, units=None, dt=None, column=None, channel=None):
    """(least step [s], largest step [s], samples [m/s2]) of the record in the bytes `content`."""
    lines = _lines(content)
    need(any(line.strip() for line in lines) and not strict_formats.by_name(lines, content))
    found = _at2(lines) or _dyna(lines)
    need(not found or channel is None)
    found = found or _channel(lines, channel)
    need(not found or column is None)
    step, samples, factor = found or strict_columns.columns(lines, dt is not None, column)
    need(units is None or factor in (None, GIVEN[units]))
    factor = GIVEN[units] if factor is None else factor
    need(len(samples) > 1 and (step or dt is not None))
    step = step or (Fraction(dt), Fraction(dt))
    need(dt is None or abs(Fraction(dt) - sum(step) / 2) <= sum(step) / 2 / 10**6)
    need(all(Fraction(1, 10**7) <= bound <= 1000 for bound in step))
    need(max(map(abs, samples)) * factor <= 10**6 * G)
    return float(step[0]), float(step[1]), [float(sample * factor) for sample in samples]


def _lines(content):
    need(not content.startswith((b"\x1f\x8b", b"PK", b"BZh", b"\xfd7zXZ")))  # `test_packed` damages packed files
    wide = content.startswith((b"\xff\xfe", b"\xfe\xff"))
    try:
        text = content.decode("utf-16", "replace") if wide else content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    text = text.rstrip("\x1a")
    need(not re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]", text))
    return re.split("\r*\n|\r+", text)


# Formats


# The numbers before their names; each `npts =` with the count behind it; each `dt =` or `dt (unit) =`.
OLD = re.compile(r"\s*([0-9]+)\s+(\S+)\s+npts\s+dt(?![^\s(\[])\s*([(\[].*)?.*")
NPTS = re.compile(r"\bnpts\s*[=:]\s*([^\s,;]*)")
DT = re.compile(r"\bdt\s*(?:[(\[]\s*[a-z]*\s*[)\]]\s*)?[=:]")


def _channel(lines, wanted):
    """(step, samples, factor) of the channel wanted, by its number or else its direction; None of columns."""
    channels = strict_formats.csmip(lines) or strict_formats.cosmos(lines) or strict_formats.knet_csv(lines)
    if not channels:
        need(wanted is None)
        return strict_formats.knet(lines) or strict_formats.smc(lines)
    wanted = None if wanted is None else str(wanted).casefold()
    found = [channel for channel in channels if wanted in (None, channel[0])]
    ((_, _, step, samples, factor),) = found or [channel for channel in channels if channel[1] == wanted]
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
            need(len(steps) == 1)
            (count,) = counts
        else:
            continue
        statements, header = blanked([*lines[:index], line])
        step = step_of_all(statements)
        need(None not in [found for line in header for found in strict_columns.times_in(line)])
        factor = unit_of(header, index - 1)
        samples = fortran(lines[index + 1 :])
        need(whole(count) == len(samples))
        return step and (step, step), samples, factor
    return None


def _dyna(lines):
    """(step, samples, factor) of an ESM/DYNA file; None if it is none."""
    begin = next(i for i, line in enumerate(lines) if line.strip())
    keys, i = {}, begin
    while i < len(lines) and (stated := re.match("([A-Z][A-Z0-9_/^]*):(.*)", lines[i][:400])):
        key, value = stated.groups()
        need(keys.setdefault(key, value.strip()) == value.strip())
        i += 1
    signs = ("EVENT_NAME", "SAMPLING_INTERVAL_S", "HEADER_FORMAT")
    if i == begin or not any(line.startswith(signs) for line in lines[:70]):
        return None
    factor, samples = KNOWN[keys["UNITS"].lower()], fortran(lines[i:])
    need(keys.get("DATA_TYPE", "").lower()[:3] in ("", "acc") and "spectr" not in keys.get("DATA_TYPE", "").lower())
    need(whole(keys["NDATA"]) == len(samples))
    step = step_of(keys["SAMPLING_INTERVAL_S"])
    return (step, step), samples, factor
