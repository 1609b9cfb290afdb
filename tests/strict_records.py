"""A second reader of records, written for tests alone: character by character, in whole numbers and fractions.

It shares no code, no pattern and no floating-point step with the reader of the project, so that the two can be held
against each other on damaged files. It is slow (its test of uniform times takes every pair) and as strict as the rules:
what is not surely a record is `Refused`.
"""

from fractions import Fraction

G = Fraction("9.81")
LENGTHS = {"mm": Fraction(1, 1000), "cm": Fraction(1, 100), "m": Fraction(1), "in": Fraction("0.0254"),
           "ft": Fraction("0.3048")}
TIME_WORDS = {"s": 1, "sec": 1, "secs": 1, "second": 1, "seconds": 1, "ms": 1000, "msec": 1000, "msecs": 1000,
              "millisec": 1000, "millisecs": 1000, "millisecond": 1000, "milliseconds": 1000}
GIVEN = {"g": G, "m/s2": Fraction(1), "cm/s2": Fraction(1, 100)}
DIGITS, LETTERS = "0123456789", "abcdefghijklmnopqrstuvwxyz"
QUANTITIES = {"acc": "acceleration", "accel": "acceleration", "acceleration": "acceleration",
              "accelerations": "acceleration", "accelerogram": "acceleration", "velocity": "other", "vel": "other",
              "displacement": "other", "disp": "other"}


class Refused(Exception):
    """Not surely a record."""


def read(content, given=None):
    """(least step [s], largest step [s], samples [m/s2]) of the record in the bytes `content`."""
    lines = _lines(content)
    if not any(line.strip() for line in lines):
        raise Refused("empty")
    step, samples, factor = _at2(lines) or _dyna(lines) or _columns(lines)
    if given is not None and given not in GIVEN:
        raise Refused("unit given")
    if factor is None and given is None:
        raise Refused("no unit")
    if factor is not None and given is not None and factor != GIVEN[given]:
        raise Refused("two units")
    factor = GIVEN[given] if factor is None else factor
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


# Numbers

def _scan(text, i):
    """(value, digits after the point or None, digits of the exponent, next i) of the number at i; None without one."""
    begin, sign = i, 1
    if i < len(text) and text[i] in "+-":
        sign = -1 if text[i] == "-" else 1
        i += 1
    whole = decimals = 0
    mantissa, point = 0, False
    while i < len(text) and (text[i] in DIGITS or (text[i] == "." and not point)):
        if text[i] == ".":
            point = True
        else:
            mantissa = 10 * mantissa + DIGITS.index(text[i])
            whole, decimals = (whole, decimals + 1) if point else (whole + 1, decimals)
        i += 1
    if whole + decimals == 0:
        return None
    exponent = places = 0
    if i < len(text) and text[i] in "EeDd":
        j, minus = i + 1, False
        if j < len(text) and text[j] in "+-":
            minus = text[j] == "-"
            j += 1
        while j < len(text) and text[j] in DIGITS and places < 3:
            exponent = 10 * exponent + DIGITS.index(text[j])
            places += 1
            j += 1
        if places:
            i = j
            exponent = -exponent if minus else exponent
    if i - begin > 100:
        return None
    value = sign * mantissa * Fraction(10) ** (exponent - decimals)
    if abs(value) >= 2 * Fraction(10) ** 308:
        return None
    return value, decimals if point else None, places, i


def _single(token):
    """The value of a token that is one number and nothing else."""
    found = _scan(token, 0)
    if found is None or found[3] != len(token):
        raise Refused(f"number {token[:40]}")
    return found[0]


def _fortran(lines):
    """The values of all lines: parted by blanks, or stuck together by their signs in one format."""
    values, exponents = [], []
    for at, line in enumerate(lines):
        for token in line.split():
            i, forms = 0, []
            while i < len(token):
                if i and token[i] not in "+-":
                    raise Refused(f"stuck {token[:40]}")
                found = _scan(token, i)
                if found is None:
                    raise Refused(f"number {token[:40]}")
                values.append(found[0])
                forms.append(found[1:3])
                if found[2]:
                    digits = token[i:found[3]].lower().replace("d", "e").split("e")[1].lstrip("+-")
                    exponents.append((at, digits))
                i = found[3]
            if len(forms) > 1 and (len(set(forms)) > 1 or forms[0][0] is None):
                raise Refused(f"stuck {token[:40]}")
    long = [(at, digits) for at, digits in exponents if len(digits) == 3]
    if long and len(long) < len(exponents):
        widths = [len(line.rstrip()) for line in lines if line.strip()]
        for at, digits in long:
            most = max(widths.count(width) for width in widths)
            usual = next(width for width in widths if widths.count(width) == most)
            if digits[0] == "0" or len(lines[at].rstrip()) != usual:
                raise Refused("exponent of three digits")
    return values


def _count(token):
    if not token or len(token) > 9 or any(sign not in DIGITS for sign in token):
        raise Refused("count")
    return int(token)


def _step(token, behind=""):
    """Seconds in a token as .02, 10ms or .02 SEC."""
    found = _scan(token, 0)
    if found is None:
        raise Refused("step")
    glued = token[found[3]:].lower()
    word = glued or behind.lower()
    if any(sign not in LETTERS for sign in glued) or (word and word not in TIME_WORDS) or found[0] <= 0:
        raise Refused("step")
    return found[0] / TIME_WORDS.get(word, 1)


# Units

def _known_units():
    """Every spelling of an acceleration this parser knows, in lower case, with its factor to m/s2."""
    known = {"g": G, "g's": G, "gravity": G, "mg": G / 1000, "%g": G / 100, "gal": Fraction(1, 100),
             "gals": Fraction(1, 100), "mgal": Fraction(1, 100_000)}
    for length, factor in LENGTHS.items():
        for time in ("s", "sec"):
            for power in (f"/{time}2", f"/{time}^2", f"/{time}**2", f"/{time}*2", f"/{time}²", f"/{time}/s",
                          f"/{time}/sec", f"/{time}^", f"/{time}*"):
                if power[-1] not in "^*":
                    known[length + power] = factor
    return known


KNOWN = _known_units()
RATES = {f"{length}{rate}" for length in LENGTHS for rate in ("/s", "/sec")}


def _words(line):
    """Words of a header line in lower case; brackets, colons, equals signs, commas and semicolons are words."""
    words, word = [], ""
    for sign in line.lower() + " ":
        if sign.isspace() or sign in "()[]:=,;":
            words += [word] if word else []
            word = ""
            words += [] if sign.isspace() else [sign]
        else:
            word += sign
    return words


def _ends(word):
    while word and word[-1] in ".'\"":
        word = word[:-1]
    return word


def _unit(lines, titles):
    """Factor of the unit that header lines state, None without one; `titles` is the index of the titles' line."""
    factors, quantities = set(), set()
    for index, line in enumerate(lines):
        words = _words(line[:400])
        parts = "".join(sign if sign in LETTERS else " " for sign in line[:400].lower()).split()
        named = {QUANTITIES[part] for part in parts if part in QUANTITIES}
        quantities |= named
        for i, word in enumerate(words):
            before = words[max(i - 4, 0):i]
            stated = False
            while before and before[-1] in ("(", "[", ":", "="):
                before = before[:-1]
            if before and before[-1] in ("of", "in", "is", "are"):
                stated = before[-1] == "in" and (named or index == titles)
                before = before[:-1] if before[:-1] and before[-2] in ("unit", "units") else before
            bare = _ends(word)
            if before and before[-1] in ("unit", "units") and word not in "()[]:=,;" and word not in (
                    "of", "in", "is", "are"):
                if bare in TIME_WORDS:
                    continue
                if not bare or bare[0] not in LETTERS + "%":
                    continue
                if bare not in KNOWN:
                    raise Refused(f"unit {word}")
                factors.add(KNOWN[bare])
            elif "/" in word and word[:word.index("/")] in LENGTHS and not word.endswith("/"):
                if i and words[i - 1][-1] in DIGITS + ".":
                    continue
                if bare not in KNOWN:
                    raise Refused(f"unit {word}")
                factors.add(KNOWN[bare])
            elif stated or ((named or index == titles) and i and words[i - 1] in ("(", "[")) or (
                    i and _ends(words[i - 1]) in ("acc", "accel", "acceleration")):
                if bare in LENGTHS or bare in RATES:
                    raise Refused(f"unit {word}")
                if bare in KNOWN:
                    factors.add(KNOWN[bare])
    if len(factors) > 1:
        raise Refused("two units")
    if quantities == {"other"}:
        raise Refused("no acceleration")
    return factors.pop() if factors else None


# Formats

def _named(line, name):
    """What stands behind every `name =` or `name (unit) =` of a line: list of (unit, rest of the line)."""
    found, low = [], line.lower()
    at = low.find(name)
    while at >= 0:
        before, i = low[at - 1:at], at + len(name)
        while line[i:i + 1].isspace():
            i += 1
        unit = ""
        if name == "dt" and line[i:i + 1] and line[i] in "([":
            i += 1
            while line[i:i + 1].isspace():
                i += 1
            while low[i:i + 1] and low[i] in LETTERS:
                unit += low[i]
                i += 1
            while line[i:i + 1].isspace():
                i += 1
            i = i + 1 if line[i:i + 1] and line[i] in ")]" else len(line)
            while line[i:i + 1].isspace():
                i += 1
        if line[i:i + 1] and line[i] in "=:" and not (before and (before.isalnum() or before == "_")):
            found.append((unit, line[i + 1:].lstrip()))
        at = low.find(name, at + 1)
    return found


def _until(text, stops):
    i = 0
    while i < len(text) and not text[i].isspace() and text[i] not in stops:
        i += 1
    return text[:i], text[i:]


def _at2(lines):
    """(step, samples, factor) of a PEER AT2 file; None if it is none."""
    for index, line in enumerate(lines[:8]):
        line = line[:400]
        old = line.lower().replace(",", " ").split()
        counts, steps = _named(line, "npts"), _named(line, "dt")
        if len(old) >= 4 and old[2] == "npts" and (old[3] == "dt" or old[3][:3] in ("dt(", "dt[")) and all(
                sign in DIGITS for sign in old[0]):
            behind = "".join(old[3:])[2:]
            inside = "".join(sign for sign in behind.partition(")")[0] if sign in LETTERS and behind[0] in "([")
            count, step = old[0], _step(old[1], inside)
        elif counts and steps:
            if len(counts) > 1 or len(steps) > 1:
                raise Refused("twice")
            count = _until(counts[0][1], ",;")[0]
            unit, rest = steps[0]
            token, behind = _until(rest, ";")
            for comma in range(len(token)):
                if token[comma] == "," and token[comma + 1:comma + 2] not in tuple(DIGITS):
                    token, behind = token[:comma], token[comma:] + behind
                    break
            word = ""
            for sign in behind.lstrip(" \t").lower():
                if sign not in LETTERS + "µ":
                    break
                word += sign
            if word and word not in TIME_WORDS:
                raise Refused("step")
            step = _step(token, word or unit)
        else:
            continue
        factor = _unit(lines[:index + 1], index - 1)
        samples = _fortran(lines[index + 1:])
        if _count(count) != len(samples):
            raise Refused("count")
        return (step, step), samples, factor
    return None


def _dyna(lines):
    """(step, samples, factor) of an ESM/DYNA file; None if it is none."""
    begin = next(i for i, line in enumerate(lines) if line.strip())
    keys, i = {}, begin
    while i < len(lines):
        key, colon, value = lines[i][:400].partition(":")
        if not colon or not key or key[0] not in LETTERS.upper() or any(
                sign not in LETTERS.upper() + DIGITS + "_/^" for sign in key):
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
    samples = _fortran(lines[i:])
    if _count(keys.get("NDATA", "")) != len(samples):
        raise Refused("count")
    step = _step(keys.get("SAMPLING_INTERVAL_S", ""))
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
    spaced = any(row[0] == "," or row[-1] == "," or any(
        sign == "," and (row[i - 1] in " \t" or row[i + 1:i + 2] in (" ", "\t")) for i, sign in enumerate(row))
        for row in rows if row)
    by, decimal = None, "."
    if semicolons:
        by, decimal = ";", "," if commas else "."
    elif commas and (spaced or (any(len(row.split()) < 2 for row in rows)
                                and 2 * sum("." in row for row in rows) >= len(rows))):
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
        if any("npts" in "".join(sign if sign.isalnum() or sign == "_" else " " for sign in line.lower()).split()
               for line in header):
            raise Refused("NPTS")
    factor = _unit(header, len(header) - 1)
    per_second = {found for line in header for found in _times_in(line)}
    if len(per_second) > 1 or None in per_second:
        raise Refused("unit of time")
    samples = [_single(second) for _, second in pairs]
    times = [_single(first) for first, _ in pairs]
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
    words = _words(flat.replace("/", " , ").replace("_", " "))
    for i, word in enumerate(words):
        if word in ("time", "t"):
            rest = words[i + 1:]
            while rest and rest[0] in ("(", "[", ",", ":", "=", "in", "unit", "units"):
                rest = rest[1:]
            unit = _ends(rest[0]) if rest else ""
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
    units = [Fraction(10) ** max(min(lasts), last + figures - max(digits))
             for last, figures in zip(lasts, digits, strict=True)]
    for unit in (units, [mean / 100] * count):
        if max(unit) * 2 > mean:
            continue
        half = [one / 2 + max(unit) / 1000 for one in unit]  # the reader's own margin
        low = max((times[k] - half[k] - times[j] - half[j]) / (k - j) for k in range(count) for j in range(k))
        high = min((times[k] + half[k] - times[j] + half[j]) / (k - j) for k in range(count) for j in range(k))
        if low <= high:
            return low, high
    raise Refused("not uniform")
