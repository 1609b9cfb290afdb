"""Columns of numbers for the second reader of records (`strict_records`), which says what it is for."""

import re
from fractions import Fraction
from itertools import pairwise

from strict_statements import blanked, flat, fold, step_of_all
from strict_words import REFUSED, TIME_WORDS, form_of, letter, need, printed, single, stem_of, unit_of, words_of

OTHER_TIMES = ("us", "µs", "usec", "ns", "min", "minute", "minutes", "h", "hour", "hours", "samples")
COMMENT = re.compile("[#%!]|//")
NAMES_OF_TIMES = ("time", "t", "zeit", "tiempo", "temps", "zaman")


def columns(lines, given, column):
    """(bounds of the step or None, samples, factor) of columns; `given`: the user says the step."""
    header, rows, comments = _header_and_rows(lines)
    by, decimal = _separators(rows, "\n".join(rows))
    rows = [row.replace(",", ".") if decimal == "," else row for row in rows]
    table = [[field.strip() for field in row.split(by)] for row in rows]
    if header and not COMMENT.match(header[-1]):
        need(not any(re.match("[+-]?[.,]?[0-9]", field.strip()) for field in header[-1].split(by)[1:]))
    need(not any(re.search(r"\bnpts\b", line.lower()) for line in header))
    for comment in comments:
        statements, kept = blanked([comment])
        need(not statements and unit_of(kept, None) is None)
    width = len(table[0])
    others, titles, at = _titles(header, by, width)
    statements, kept = blanked([*others[:at], titles[0], *others[at:]] if titles else others)
    stated = step_of_all(statements)
    per_second = {found for line in kept for found in times_in(line)}
    need(None not in per_second)
    timed = width > 1 and _are_times(table, titles, given or stated is not None)
    need(not lines[-1].strip() or _whole_end(table))
    number, step = 1, None
    if timed or column is not None or len(titles) > 1:
        number = _number_of(column, titles, timed, width)
        need(all(len(row) == width for row in table))
        samples = [single(row[number - 1]) for row in table]
    else:
        samples = _list(table)
    if timed:
        need(len(per_second) < 2)
        scale = max(per_second, default=1)
        step = tuple(bound / scale for bound in _uniform([row[0] for row in table]))
    if titles:
        stated_there, chosen = blanked([titles[number - 1]])
        step_of_all(statements + stated_there)
        kept[at : at + 1] = chosen
    if stated is not None:
        need(not step or abs(stated - sum(step) / 2) <= sum(step) / 2 / 10**6)
        step = stated, stated
    return step, samples, unit_of(kept, at)


def _titles(header, by, width):
    """(lines of the header other than that of titles, titles or [], index of the line of titles)."""
    named = [index for index, line in enumerate(header) if re.match("[# \\t]*datasequence:", line.lower())]
    at = named[0] if named else len(header) - 1
    if at >= 0:
        line = re.sub(r"^[#%!/\s]+", "", header[at][:400].partition(":")[2] if named else header[at][:400])
        for parting in (*([by] if by else []), "[;,]", "\t", "  +", "[ ;,]+"):
            split = [part.strip() for part in re.split(parting, line.strip() if parting[-1] == "+" else line)]
            if len(split) == width and all(any(map(letter, _name_of(part))) for part in split):
                return [*header[:at], *header[at + 1 :]], split, at
    return header, [], at


def _name_of(title):
    """The title without what stands in brackets."""
    return re.sub(r"[(\[][^)\]]*[)\]]?", "", title).strip()


def _are_times(table, titles, known):
    times = [single(row[0]) for row in table]
    if len(times) > 1 and all(after > before for before, after in pairwise(times)):
        return True
    if not titles:
        return not known
    return re.match(r"[^\W_]*", stem_of(fold(titles[0]).strip()))[0] in NAMES_OF_TIMES


def _number_of(column, titles, timed, width):
    """The column (from 1) of accelerations."""
    places = range(1 + timed, width + 1)
    wanted = str(column).strip().casefold()
    named = [at for at, title in enumerate(titles, 1) if wanted in (title.casefold(), _name_of(title).casefold())]
    (found,) = places if column is None else [int(wanted)] if re.fullmatch("[0-9]+", wanted) else named
    need(found in places)
    return found


def _whole_end(table):
    """Whether the last number is of the form that all those above it share: else the file may be cut within it."""
    forms = []
    for row in table:
        try:
            field = row[len(table[-1]) - 1]
            single(field)
            forms.append(form_of(field))
        except REFUSED:
            forms.append(None)
    return len(forms) < 3 or len(set(forms[:-1])) > 1 or forms[-1] == forms[0]


def _header_and_rows(lines):
    """Lines before the first that begins with a number, those from it on without comments, and the comments."""
    header, rows, comments = [], [], []
    for line in filter(None, map(str.strip, lines)):
        if COMMENT.match(line):
            (comments if rows else header).append(line)
        elif rows or re.match(r"[-+.,;0-9]|(nan|inf|infinity)\b", line.lower()):
            rows.append(line.split("#")[0].strip())
        else:
            header.append(line)
    return header, rows, comments


def _separators(rows, everything):
    """(what parts the columns, None for blanks; the sign of decimals)."""
    semicolon = ";" if ";" in everything else None
    if "," not in everything:
        return semicolon, "."
    spaced = any(re.search("^,|,$|[ \t],|,[ \t]", row) for row in rows)
    blanks = all(len(row.split()) > 1 for row in rows)
    if not semicolon and (spaced or (not blanks and 2 * sum("." in row for row in rows) >= len(rows))):
        return ",", "."
    need("." not in everything and (semicolon or blanks))
    return semicolon, ","


def _list(table):
    """Numbers one after the other, which are smoother along the lines than from line to line."""
    width = len(table[0])
    need(all(len(row) == width for row in table[:-1]) and len(table[-1]) <= width)
    values = [single(field) for row in table for field in row]
    if 1 < width < len(values):
        along = [abs(after - before) for before, after in pairwise(values)]
        across = [abs(after - before) for before, after in zip(values, values[width:], strict=False)]
        means = [sum(along[k::width]) / len(along[k::width]) for k in range(width)]
        need(sum(along) / len(along) < Fraction("0.7") * sum(across) / len(across))
        need(max(means) < Fraction("1.6") * min(means))
    return values


def times_in(line):
    """Units of time that stand behind the word time (or t) of a header line, in units a second; None: another unit."""
    found = []
    words = words_of(fold(flat(line)).replace("/", " , "))
    for i, word in enumerate(words):
        rest = words[i + 1 :] if stem_of(word) in NAMES_OF_TIMES else []
        while rest and rest[0] in ("(", "[", ",", ":", "=", "in", "unit", "units"):
            del rest[0]
        unit = re.match("([a-zµ]*)(?![a-zµ0-9])", rest[0]) if rest else None
        if unit and (unit[1] in OTHER_TIMES or unit[1] in TIME_WORDS):
            found.append(TIME_WORDS.get(unit[1]))
    return found


def _uniform(tokens):
    """(least, largest) step of the lines that pass within half a printed unit of all times."""
    times, count = [single(token) for token in tokens], len(tokens)
    mean = (times[-1] - times[0]) / (count - 1) if count > 1 else 0
    steps = [after - before for before, after in pairwise(times)]
    need(min(steps) > 0)
    if max(steps) - min(steps) <= mean / 10**6:
        return mean * (1 - Fraction(1, 10**11)), mean * (1 + Fraction(1, 10**11))
    digits, lasts = zip(*map(printed, tokens), strict=True)
    units = [
        Fraction(10) ** max(min(lasts), last + figures - max(digits))
        for last, figures in zip(lasts, digits, strict=True)
    ]
    for unit in (units, [mean / 100] * count):
        half = [one / 2 + max(unit) / 1000 for one in unit]  # the reader's own margin
        low = max((times[k] - half[k] - times[j] - half[j]) / (k - j) for k in range(count) for j in range(k))
        high = min((times[k] + half[k] - times[j] + half[j]) / (k - j) for k in range(count) for j in range(k))
        if low <= high and max(unit) * 2 <= mean:
            return low, high
    raise ValueError("not uniform")
