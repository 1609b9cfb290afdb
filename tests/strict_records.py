"""A second reader of records, written for tests alone: character by character, in whole numbers and fractions.

It shares no code, no pattern and no floating-point step with the reader of the project, so that the two can be held
against each other on damaged files. It is slow (its test of uniform times takes every pair) and as strict as the rules:
what is not surely a record is `Refused`.
"""

from fractions import Fraction

import strict_formats
from strict_words import (
    DIGITS,
    GIVEN,
    KNOWN,
    LETTERS,
    TIME_WORDS,
    G,
    Refused,
    ends_of,
    fortran,
    single,
    step_of,
    unit_of,
    whole,
    words_of,
)


def read(content, units=None, channel=None):
    """(least step [s], largest step [s], samples [m/s2]) of the record in the bytes `content`."""
    lines = _lines(content)
    if not any(line.strip() for line in lines):
        raise Refused("empty")
    step, samples, factor = _at2(lines) or _dyna(lines) or _channel(lines, channel) or _columns(lines)
    if channel is not None and not strict_formats.csmip(lines):
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
    if content.startswith((b"\x1f\x8b", b"PK\x03\x04", b"BZh", b"\xfd7zXZ")):
        raise Refused("packed")
    while text.endswith("\x1a"):
        text = text[:-1]
    lines, line, i = [], "", 0
    while i < len(text):
        if text[i] in "\r\n":
            while text[i] == "\r" and i + 1 < len(text) and text[i + 1] in "\r\n":
                i += 1
            lines.append(line)
            line = ""
        else:
            if (ord(text[i]) < 32 and text[i] != "\t") or ord(text[i]) == 127:
                raise Refused("control character")
            line += text[i]
        i += 1
    return [*lines, line]


# Formats


def _named(line, name):
    """What stands behind every `name =` or `name (unit) =` of a line: list of (unit, rest of the line)."""
    found, low = [], line.lower()
    at = low.find(name)
    while at >= 0:
        before, i = low[at - 1 : at], at + len(name)
        while line[i : i + 1].isspace():
            i += 1
        unit = ""
        if name == "dt" and line[i : i + 1] and line[i] in "([":
            i += 1
            while line[i : i + 1].isspace():
                i += 1
            while low[i : i + 1] and low[i] in LETTERS:
                unit += low[i]
                i += 1
            while line[i : i + 1].isspace():
                i += 1
            i = i + 1 if line[i : i + 1] and line[i] in ")]" else len(line)
            while line[i : i + 1].isspace():
                i += 1
        if line[i : i + 1] and line[i] in "=:" and not (before and (before.isalnum() or before == "_")):
            found.append((unit, line[i + 1 :].lstrip()))
        at = low.find(name, at + 1)
    return found


def _until(text, stops):
    i = 0
    while i < len(text) and not text[i].isspace() and text[i] not in stops:
        i += 1
    return text[:i], text[i:]


def _channel(lines, wanted):
    """(step, samples, factor) of the channel wanted of a file that has several; None if it is none."""
    channels = strict_formats.csmip(lines)
    if channels is None:
        return None
    wanted = None if wanted is None else str(wanted).casefold()
    found = [channel for channel in channels if wanted in (None, channel[0])]
    found = found or [channel for channel in channels if channel[1] == wanted]
    if len(found) != 1:
        raise Refused("channel")
    _, _, step, samples, factor = found[0]
    return (step, step), samples, factor


def _at2(lines):
    """(step, samples, factor) of a PEER AT2 file; None if it is none."""
    for index, line in enumerate(lines[:8]):
        line = line[:400]
        old = line.lower().replace(",", " ").split()
        counts, steps = _named(line, "npts"), _named(line, "dt")
        if (
            len(old) >= 4
            and old[2] == "npts"
            and (old[3] == "dt" or old[3][:3] in ("dt(", "dt["))
            and all(sign in DIGITS for sign in old[0])
        ):
            behind = "".join(old[3:])[2:]
            inside = "".join(sign for sign in behind.partition(")")[0] if sign in LETTERS and behind[0] in "([")
            count, step = old[0], step_of(old[1], inside)
        elif counts and steps:
            if len(counts) > 1 or len(steps) > 1:
                raise Refused("twice")
            count = _until(counts[0][1], ",;")[0]
            unit, rest = steps[0]
            token, behind = _until(rest, ";")
            for comma in range(len(token)):
                if token[comma] == "," and token[comma + 1 : comma + 2] not in tuple(DIGITS):
                    token, behind = token[:comma], token[comma:] + behind
                    break
            word = ""
            for sign in behind.lstrip(" \t").lower():
                if sign not in LETTERS + "µ":
                    break
                word += sign
            if word and word not in TIME_WORDS:
                raise Refused("step")
            step = step_of(token, word or unit)
        else:
            continue
        factor = unit_of(lines[: index + 1], index - 1)
        samples = fortran(lines[index + 1 :])
        if whole(count) != len(samples):
            raise Refused("count")
        return (step, step), samples, factor
    return None


def _dyna(lines):
    """(step, samples, factor) of an ESM/DYNA file; None if it is none."""
    begin = next(i for i, line in enumerate(lines) if line.strip())
    keys, i = {}, begin
    while i < len(lines):
        key, colon, value = lines[i][:400].partition(":")
        if (
            not colon
            or not key
            or key[0] not in LETTERS.upper()
            or any(sign not in LETTERS.upper() + DIGITS + "_/^" for sign in key)
        ):
            break
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


def _columns(lines):
    """(step, samples, factor) of two columns."""
    header, rows = [], []
    for line in lines:
        text = line.strip()
        if text[:1] in ("#", "%", "!") or text[:2] == "//":
            header += [] if rows else [text]
        elif text:
            word = ""
            for sign in text.lower().lstrip("+-"):
                if not (sign.isalnum() or sign == "_"):
                    break
                word += sign
            if rows or text[0] in "-+.,;" + DIGITS or word in ("nan", "inf", "infinity"):
                rows.append(text.split("#")[0].strip())
            else:
                header.append(text)
    everything = "\n".join(rows)
    first = next((line for line in lines if line.strip()), "").lower()
    if not rows or "corrected accel" in first[:60] or first.startswith("origin time"):
        raise Refused("format")
    semicolons, commas = ";" in everything, "," in everything
    spaced = any(
        row[0] == ","
        or row[-1] == ","
        or any(sign == "," and (row[i - 1] in " \t" or row[i + 1 : i + 2] in (" ", "\t")) for i, sign in enumerate(row))
        for row in rows
        if row
    )
    by, decimal = None, "."
    if semicolons:
        by, decimal = ";", "," if commas else "."
    elif commas and (
        spaced or (any(len(row.split()) < 2 for row in rows) and 2 * sum("." in row for row in rows) >= len(rows))
    ):
        by = ","
    elif commas and all(len(row.split()) > 1 for row in rows):
        decimal = ","
    elif commas:
        raise Refused("comma")
    if decimal == "," and "." in everything:
        raise Refused("points and commas")
    pairs = []
    for row in rows:
        fields = [field.strip() for field in (row.split(by) if by else row.split())]
        if len(fields) != 2:
            raise Refused("columns")
        pairs.append([field.replace(",", ".") if decimal == "," else field for field in fields])
    if header:
        last = header[-1]
        fields = [field.strip() for field in (last.split(by) if by else last.split())][1:]
        if last[0] not in "#%!" and last[:2] != "//" and any(_numeric(field) for field in fields):
            raise Refused("header")
        if any(
            "npts" in "".join(sign if sign.isalnum() or sign == "_" else " " for sign in line.lower()).split()
            for line in header
        ):
            raise Refused("NPTS")
    factor = unit_of(header, len(header) - 1)
    per_second = {found for line in header for found in _times_in(line)}
    if len(per_second) > 1 or None in per_second:
        raise Refused("unit of time")
    samples = [single(second) for _, second in pairs]
    times = [single(first) for first, _ in pairs]
    if len(times) < 2:
        raise Refused("samples")
    low, high = _uniform(times, [first for first, _ in pairs])
    scale = per_second.pop() if per_second else 1
    return (low / scale, high / scale), samples, factor


def _numeric(field):
    field = field[1:] if field[:1] in ("+", "-") else field
    field = field[1:] if field[:1] in (".", ",") else field
    return field[:1] in tuple(DIGITS)


def _times_in(line):
    """Units of time that stand behind the word time (or t) of a header line, in units a second; None: another unit."""
    found = []
    flat = " ".join(line[:400].lower().split())
    words = words_of(flat.replace("/", " , ").replace("_", " "))
    for i, word in enumerate(words):
        if word in ("time", "t"):
            rest = words[i + 1 :]
            while rest and rest[0] in ("(", "[", ",", ":", "=", "in", "unit", "units"):
                rest = rest[1:]
            unit = ends_of(rest[0]) if rest else ""
            if unit in ("us", "µs", "usec", "ns", "min", "minute", "minutes", "h", "hour", "hours", "samples"):
                found.append(None)
            elif unit in TIME_WORDS:
                found.append(TIME_WORDS[unit])
    return found


def _uniform(times, tokens):
    """(least, largest) step of the lines that pass within half a printed unit of all times."""
    count = len(times)
    mean = (times[-1] - times[0]) / (count - 1)
    steps = [after - before for before, after in zip(times, times[1:], strict=False)]
    if min(steps) <= 0:
        raise Refused("time goes back")
    if max(steps) - min(steps) <= mean / 10**6:
        return mean * (1 - Fraction(1, 10**11)), mean * (1 + Fraction(1, 10**11))
    lasts, digits = [], []
    for token in tokens:
        mantissa, _, exponent = token.lower().replace("d", "e").partition("e")
        figures = mantissa.lstrip("+-").replace(".", "").lstrip("0")
        lasts.append((int(exponent) if exponent else 0) - len(mantissa.partition(".")[2]))
        digits.append(max(len(figures), 1))
    units = [
        Fraction(10) ** max(min(lasts), last + figures - max(digits))
        for last, figures in zip(lasts, digits, strict=True)
    ]
    for unit in (units, [mean / 100] * count):
        if max(unit) * 2 > mean:
            continue
        half = [one / 2 + max(unit) / 1000 for one in unit]  # the reader's own margin
        low = max((times[k] - half[k] - times[j] - half[j]) / (k - j) for k in range(count) for j in range(k))
        high = min((times[k] + half[k] - times[j] + half[j]) / (k - j) for k in range(count) for j in range(k))
        if low <= high:
            return low, high
    raise Refused("not uniform")
