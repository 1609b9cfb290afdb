"""Columns of numbers for the second reader of records (`strict_records`), which says what it is for."""

import re
from fractions import Fraction

from strict_statements import blanked, flat, fold, step_of_all
from strict_words import TIME_WORDS, Refused, form_of, letter, single, stem_of, unit_of, words_of

OTHER_TIMES = ("us", "µs", "usec", "ns", "min", "minute", "minutes", "h", "hour", "hours", "samples")
COMMENT = re.compile("[#%!]|//")
NAMES_OF_TIMES = ("time", "t", "zeit", "tiempo", "temps", "zaman")


def columns(lines, given, column):
    """(bounds of the step or None, samples, factor) of columns; `given`: the user says the step."""
    header, rows, comments = _header_and_rows(lines)
    everything = "\n".join(rows)
    first = next((line for line in lines if line.strip()), "").lower()
    if not rows or "uncorrected accelerogram" in first[:200]:
        raise Refused("format")
    by, decimal = _separators(rows, everything)
    table = []
    for row in rows:
        row = row.replace(",", ".") if decimal == "," else row
        table.append([field.strip() for field in row.split(by)])
    if header:
        fields = [field.strip() for field in header[-1].split(by)][1:]
        if not COMMENT.match(header[-1]) and any(re.match("[+-]?[.,]?[0-9]", field) for field in fields):
            raise Refused("header")
        if any(re.search(r"\bnpts\b", line.lower()) for line in header):
            raise Refused("NPTS")
    for comment in comments:
        statements, kept = blanked([comment])
        if statements or unit_of(kept, None) is not None:
            raise Refused("statement among the data")
    width = len(table[0])
    others, titles, at = _titles(header, by, width)
    top = [*others[:at], titles[0], *others[at:]] if titles else others
    statements, kept = blanked(top)
    stated = step_of_all(statements)
    if None in [found for line in kept for found in times_in(line)]:
        raise Refused("unit of time")
    timed = width > 1 and _are_times(table, titles, given or stated is not None)
    if lines[-1].strip():
        _whole_end(table)
    samples, number, step = _samples(table, titles, timed, column), 0, None
    if timed:
        step = _step_of(table, kept)
    number = _number_of(column, titles, timed, width) if column is not None or timed else 1
    if titles:
        stated_there, chosen = blanked([titles[number - 1]])
        step_of_all(statements + stated_there)
        kept = [*kept[:at], *chosen, *kept[at + 1 :]]
    if stated is not None:
        if step and abs(stated - sum(step) / 2) > sum(step) / 2 / 10**6:
            raise Refused("two steps")
        step = stated, stated
    return step, samples, unit_of(kept, at)


def _titles(header, by, width):
    """(lines of the header other than that of titles, titles or [], index of the line of titles)."""
    named = [index for index, line in enumerate(header) if re.match("[# \t]*datasequence:", line.lower())]
    at = named[0] if named else len(header) - 1
    if at < 0:
        return header, [], at
    line = re.sub(r"^[#%!/\s]+", "", header[at][:400].partition(":")[2] if named else header[at][:400])
    for parting in (*([by] if by else []), "[;,]", "\t", "  +", "[ ;,]+"):
        split = [part.strip() for part in re.split(parting, line.strip() if parting[-1] == "+" else line)]
        if len(split) == width and all(any(letter(sign) for sign in _name_of(part)) for part in split):
            return [*header[:at], *header[at + 1 :]], split, at
    return header, [], at


def _name_of(title):
    """The title without what stands in brackets."""
    return re.sub(r"[(\[][^)\]]*[)\]]?", "", title).strip()


def _are_times(table, titles, known):
    times = [single(row[0]) for row in table]
    if len(times) > 1 and all(after > before for before, after in zip(times, times[1:], strict=False)):
        return True
    if not titles:
        return not known
    return re.match(r"[^\W_]*", stem_of(fold(titles[0]).strip()))[0] in NAMES_OF_TIMES


def _number_of(column, titles, timed, width):
    """The column (from 1) of accelerations."""
    first = 2 if timed else 1
    if column is None:
        if width > first:
            raise Refused("column missing")
        return first
    wanted = str(column).strip()
    if re.fullmatch("[0-9]+", wanted):
        found = [int(wanted)]
    else:
        wanted = wanted.casefold()
        found = [at for at, title in enumerate(titles, 1) if wanted in (title.casefold(), _name_of(title).casefold())]
    if len(found) != 1 or not first <= found[0] <= width:
        raise Refused("column")
    return found[0]


def _samples(table, titles, timed, column):
    if not timed and column is None and len(titles) < 2:
        return _list(table)
    width = len(table[0])
    if any(len(row) != width for row in table):
        raise Refused("columns")
    number = _number_of(column, titles, timed, width)
    return [single(row[number - 1]) for row in table]


def _whole_end(table):
    """Refuses a last number of another form than all those above it: the file may be cut within it."""
    *others, last = table
    forms = []
    for row in [*others, last]:
        try:
            field = row[len(last) - 1]
            single(field)
            forms.append(form_of(field))
        except (Refused, IndexError):
            forms.append(None)
    if len(others) > 1 and len(set(forms[:-1])) == 1 and forms[-1] != forms[0]:
        raise Refused("cut")


def _header_and_rows(lines):
    """Lines before the first that begins with a number, those from it on without comments, and the comments."""
    header, rows, comments = [], [], []
    for line in lines:
        text = line.strip()
        if COMMENT.match(text):
            (comments if rows else header).append(text)
        elif rows or re.match(r"[-+.,;0-9]|(nan|inf|infinity)\b", text.lower()):
            rows += [text.split("#")[0].strip()] if text else []
        elif text:
            header.append(text)
    return header, rows, comments


def _separators(rows, everything):
    """(what parts the columns, None for blanks; the sign of decimals)."""
    semicolons, commas = ";" in everything, "," in everything
    spaced = any(re.search("^,|,$|[ \t],|,[ \t]", row) for row in rows)
    blanks = all(len(row.split()) > 1 for row in rows)
    if not commas:
        return ";" if semicolons else None, "."
    if not semicolons and (spaced or (not blanks and 2 * sum("." in row for row in rows) >= len(rows))):
        return ",", "."
    if "." in everything or not (semicolons or blanks):
        raise Refused("comma")
    return ";" if semicolons else None, ","


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
    per_second = {found for line in header for found in times_in(line)}
    if len(per_second) > 1 or None in per_second:
        raise Refused("unit of time")
    times = [single(row[0]) for row in table]
    if len(times) < 2:
        raise Refused("samples")
    low, high = _uniform(times, [row[0] for row in table])
    scale = per_second.pop() if per_second else 1
    return low / scale, high / scale


def times_in(line):
    """Units of time that stand behind the word time (or t) of a header line, in units a second; None: another unit."""
    found = []
    words = words_of(fold(flat(line)).replace("/", " , "))
    for i, word in enumerate(words):
        if stem_of(word) in NAMES_OF_TIMES:
            rest = words[i + 1 :]
            while rest and rest[0] in ("(", "[", ",", ":", "=", "in", "unit", "units"):
                rest = rest[1:]
            unit = re.match("([a-zµ]*)(?![a-zµ0-9])", rest[0] if rest else "")
            if unit and (unit[1] in OTHER_TIMES or unit[1] in TIME_WORDS):
                found.append(TIME_WORDS.get(unit[1]))
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
