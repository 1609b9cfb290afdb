"""Columns of numbers for the second reader of records (`strict_records`), which says what it is for."""

from fractions import Fraction

from strict_words import DIGITS, LETTERS, TIME_WORDS, Refused, scan, single, stem_of, unit_of, words_of

OTHER_TIMES = ("us", "µs", "usec", "ns", "min", "minute", "minutes", "h", "hour", "hours", "samples")


def columns(lines, known, column):
    """(bounds of the step or None, samples, factor) of columns; `known`: the user says the step."""
    header, rows = _header_and_rows(lines)
    everything = "\n".join(rows)
    first = next((line for line in lines if line.strip()), "").lower()
    if not rows or "uncorrected accelerogram" in first[:200]:
        raise Refused("format")
    by, decimal = _separators(rows, everything)
    table = []
    for row in rows:
        row = row.replace(",", ".") if decimal == "," else row
        table.append([field.strip() for field in (row.split(by) if by else row.split())])
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
    stated = {step for line in header for step in _steps_in(" ".join(line[:400].split()))}
    if len(stated) > 1:
        raise Refused("two steps")
    stated = stated.pop() if stated else None
    known, width, step = known or stated is not None, len(table[0]), None
    times = [single(row[0]) for row in table] if known and width > 1 else []
    rises = len(times) > 1 and all(after > before for before, after in zip(times, times[1:], strict=False))
    timed = width > 1 and (rises or not known)
    if timed or column is not None:
        samples = _chosen(table, column, timed)
        if timed:
            step = _step_of(table, header)
    elif not known:
        raise Refused("no step")
    else:
        samples = _list(table)
    if column is not None and header:
        by = "\t" if by is None else by
        titles = header[-1][:400].split(by)
        header = [*header[:-1], titles[column - 1] if len(titles) == width else header[-1]]
    if stated is not None:
        if step and abs(stated - sum(step) / 2) > sum(step) / 2 / 10**6:
            raise Refused("two steps")
        step = stated, stated
    return step, samples, unit_of(header, len(header) - 1)


def _header_and_rows(lines):
    """Lines before the first that begins with a number, and those from it on without comments."""
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
    return header, rows


def _separators(rows, everything):
    """(what parts the columns, None for blanks; the sign of decimals)."""
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
    return by, decimal


def _chosen(table, column, timed):
    width, first = len(table[0]), 2 if timed else 1
    if any(len(row) != width for row in table):
        raise Refused("columns")
    if column is None and width > 2:
        raise Refused("column")
    column = 2 if column is None else column
    if not first <= column <= width:
        raise Refused("column")
    return [single(row[column - 1]) for row in table]


def _list(table):
    """Numbers one after the other, which are smoother along the lines than from line to line."""
    width = len(table[0])
    if any(len(row) != width for row in table[:-1]) or len(table[-1]) > width:
        raise Refused("lines")
    values = [single(field) for row in table for field in row]
    if 1 < width < len(values):
        along = [abs(after - before) for before, after in zip(values, values[1:], strict=False)]
        across = [abs(after - before) for before, after in zip(values, values[width:], strict=False)]
        means = [sum(along[k::width]) / len(along[k::width]) for k in range(width)]
        if sum(along) / len(along) >= Fraction("0.7") * sum(across) / len(across):
            raise Refused("rough")
        if max(means) >= Fraction("1.6") * min(means):
            raise Refused("unlike")
    return values


def _step_of(table, header):
    """Bounds of the step of the times in the first column."""
    per_second = {found for line in header for found in _times_in(line)}
    if len(per_second) > 1 or None in per_second:
        raise Refused("unit of time")
    times = [single(row[0]) for row in table]
    if len(times) < 2:
        raise Refused("samples")
    low, high = _uniform(times, [row[0] for row in table])
    scale = per_second.pop() if per_second else 1
    return low / scale, high / scale


def _steps_in(line):
    """Steps [s] that a line of the header states: dt = .01 s, dt [ms]: 5."""
    low = line.lower()
    at = low.find("dt")
    while at >= 0:
        before, rest, unit = low[at - 1 : at] if at else "", low[at + 2 :].removeprefix(" "), ""
        if rest[:1] in ("(", "["):
            inside = rest[1:].lstrip(" ")
            while inside[:1] and inside[0] in LETTERS + "µ":
                unit, inside = unit + inside[0], inside[1:]
            inside = inside.lstrip(" ")
            rest = inside[1:].removeprefix(" ") if unit and inside[:1] in (")", "]") else ""
        if rest[:1] in (":", "=") and before not in tuple(LETTERS):
            yield _stated(rest[1:].removeprefix(" "), unit)
        at = low.find("dt", at + 1)


def _stated(rest, unit):
    found = scan(rest, 0)
    behind = rest[found[3] :] if found else ""
    if not found or behind[:1] in tuple(DIGITS + ".") or (behind[:1] == "," and behind[1:2] in tuple(DIGITS)):
        raise Refused("step")
    word = ""
    for sign in behind.removeprefix(" "):
        if sign not in LETTERS + "µ":
            break
        word += sign
    word = word if word in TIME_WORDS or word in OTHER_TIMES else unit
    if found[0] <= 0 or (word and word not in TIME_WORDS):
        raise Refused("step")
    return found[0] / TIME_WORDS.get(word, 1)


def _numeric(field):
    field = field[1:] if field[:1] in ("+", "-") else field
    field = field[1:] if field[:1] in (".", ",") else field
    return field[:1] in tuple(DIGITS)


def _letters_of(word):
    """The letters a word begins with; nothing where digits follow them."""
    end = 0
    while end < len(word) and (word[end] in LETTERS or word[end] == "µ"):
        end += 1
    return "" if word[end : end + 1] in tuple(DIGITS) else word[:end]


def _times_in(line):
    """Units of time that stand behind the word time (or t) of a header line, in units a second; None: another unit."""
    found = []
    flat = " ".join(line[:400].lower().split())
    words = words_of(flat.replace("/", " , ").replace("_", " "))
    for i, word in enumerate(words):
        if stem_of(word) in ("time", "t"):
            rest = words[i + 1 :]
            while rest and rest[0] in ("(", "[", ",", ":", "=", "in", "unit", "units"):
                rest = rest[1:]
            unit = _letters_of(rest[0]) if rest else ""
            if unit in OTHER_TIMES:
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
