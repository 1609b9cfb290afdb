"""Columns of numbers for the second reader of records (`strict_records`), which says what it is for."""

import re
from datetime import date
from fractions import Fraction
from itertools import pairwise

from strict_statements import blanked, count_of, flat, fold, step_of_all
from strict_titles import (
    OTHER_TIMES,
    REFUSED,
    inside,
    kinds_of,
    names_spectrum,
    time_of,
    titles_of,
    unit_word,
    with_unit,
)
from strict_words import NUMBER, TIME_WORDS, form_of, fortran, letter, need, single, stem_of, uniform, unit_of, words_of
from strict_words import REFUSED as ERRORS

COMMENT = re.compile("[#%!]|//")
NAMES_OF_TIMES = ("time", "t", "zeit", "tiempo", "temps", "zaman")


def columns(lines, given, column):
    """(bounds of the step or None, samples, factor) of columns; `given`: the user says the step."""
    lines = _unquoted(lines)
    header, rows, comments, begin = _header_and_rows(lines)
    by, decimal = _separators(rows, "\n".join(rows))
    rows = [row.replace(",", ".") if decimal == "," else row for row in rows]
    table = [[field.strip() for field in row.split(by)] for row in rows]
    while table and all(row[1:] and not row[-1] for row in table):
        table = [row[:-1] for row in table]
    for comment in comments:
        statements, kept = blanked([comment])
        need(not statements and unit_of(kept, None) is None)
    need(not lines[-1].strip() or _whole_end(table))
    whole = len(table)
    table, counted = _counted(table)
    titles, at = titles_of(header, by, len(table[0]))
    table, titles = _unpaired(table, titles)
    width = len(table[0])
    count = count_of([*counted, *header])
    if by is None and column is None and _runs_on(table, bool(titles), count):
        statements, kept = blanked([*counted, *header])
        need(None not in {found for line in kept for found in times_in(line)})
        samples = fortran(lines[begin + whole - len(table) :])
        need(len(samples) == count)
        step = step_of_all(statements)
        return step and (step, step), samples, unit_of(kept, len(kept) - 1)
    others = [line for index, line in enumerate(header) if not titles or index != at]
    statements, kept = blanked([*counted, *others, *titles[:1]])
    stated = step_of_all(statements)
    _check_header(header, titles, at, by, stated is not None and count in (len(table), sum(map(len, table))))
    need(re.fullmatch(NUMBER, table[0][0]))
    per_second = {found for line in kept for found in times_in(line)}
    need(None not in per_second)
    negative = any(field[:1] == "-" for row in table for field in row[1:])
    spectrum = not negative and names_spectrum([*counted, *others])
    kinds = kinds_of(titles, spectrum) or [""] * width
    if width > 2 and not titles and _rises(table, 1):
        kinds[0] = "number"
    kinds = ["" if kind == "number" and not _numbers(table, k) else kind for k, kind in enumerate(kinds)]
    times = _times(table, kinds, titles, given or stated is not None, spectrum)
    number, step = 1, None
    if times or column is not None or len(titles) > 1:
        number = _number_of(column, titles, [k for k in range(width) if k not in times and kinds[k] != "number"], width)
        need(all(len(row) == width for row in table))
        samples = [single(row[number - 1]) for row in table]
    else:
        samples = _list(table)
    need(kinds[number - 1] not in REFUSED)
    if times:
        time = max((k for k in times if k < number - 1), default=times[0])
        statements, said = blanked([*counted, *others, *([time_of(titles[time])] if titles else [])])
        stated = step_of_all(statements)
        per_second = {found for line in said for found in times_in(line)}
        need(len(per_second) < 2 and None not in per_second)
        scale = max(per_second, default=1)
        step = tuple(bound / scale for bound in uniform([row[time] for row in table]))
    kept = [*counted, *others]
    if titles:
        kept.append(with_unit(titles, number - 1))
    there, kept = blanked(kept)
    step_of_all(there)
    if stated is not None:
        need(not step or step[0] * (1 - Fraction(1, 10**6)) <= stated <= step[1] * (1 + Fraction(1, 10**6)))
        step = stated, stated
    return step, samples, unit_of(kept, len(kept) - 1)


def _unquoted(lines):
    """The lines without the quotes around fields; semicolons for commas outside, if numbers inside have commas."""
    quoted = {}
    for at, line in enumerate(lines):
        parts = line.strip().split('"')
        ends = [re.search(r"(^|[,;\s])$", part) for part in parts[2:-1:2]]
        begins = [re.match(r"[,;\s]", part) for part in parts[2:-1:2]]
        if len(parts) > 2 and len(parts) % 2 and all(ends) and all(begins):
            if (not parts[0] or parts[0][-1] in ",; \t") and (not parts[-1] or parts[-1][0] in ",; \t"):
                quoted[at] = line.split('"')
    numbers = [field for parts in quoted.values() for field in parts[1::2] if _is_data(field)]
    found = list(lines)
    for at, parts in quoted.items():
        if any("," in field for field in numbers):
            parts[::2] = [part.replace(",", ";") for part in parts[::2]]
        parts[1::2] = [field if _is_data(field) else field.replace(",", "").replace(";", "") for field in parts[1::2]]
        found[at] = "".join(parts)
    return found


def _is_data(line):
    """Whether a line begins like a number."""
    line = line.strip().lower()
    if line[:1] in (",", ";"):
        behind = line[1:].strip()
        return not (behind and letter(behind[0]) and not behind.startswith(("nan", "inf")))
    return bool(re.match(r"[-+.0-9]|(nan|inf|infinity)\b", line))


def _counted(table):
    """(rows of data, what the numbers before them state) where a file begins with the number of values or rows."""
    first, rest = table[0], table[1:]
    if len(first) == 1 and rest and len(rest[0]) == 1 and first[0] == str(len(rest) - 1):
        first, rest = first + rest[0], rest[1:]
    numbers = [field for row in rest for field in row]
    if rest and len(first) < 3 and re.fullmatch("[0-9]{1,9}", first[0]) and NUMBER.fullmatch(first[-1]):
        known = int(first[0]) in (len(rest), len(numbers)) and any("." in field for field in numbers)
        need(known or len(first) == 1 or len(rest[0]) == 2)
        two = len(first) == 2 == len(rest[0]) and NUMBER.fullmatch(rest[0][0])
        if known and not (two and single(rest[0][0]) > int(first[0])):
            return rest, [f"samples: {first[0]}" + "".join(f", dt = {step} s" for step in first[1:])]
    forms = set(map(form_of, numbers))
    alone = len(first) == 1 and len(rest) > 1 and all(len(row) == 1 for row in rest) and len(forms) == 1
    if alone and NUMBER.fullmatch(first[0]) and form_of(first[0]) not in forms:
        need(single(first[0]) == 0)
    return table, []


def _unpaired(table, titles):
    """(rows of two numbers, their titles) of lines of several pairs, whose times rise along the lines."""
    width, pairs = len(table[0]), [row[k : k + 2] for row in table for k in range(0, len(row), 2)]
    if width % 2 or width < 4 or any(len(row) != width for row in table[:-1]) or len(pairs[-1]) < 2:
        return table, titles
    if len(set(titles[::2])) > 1 or len(set(titles[1::2])) > 1:
        return table, titles
    falls = sum(not _rises([before, after], 0) for before, after in pairwise(pairs))
    need(not falls or 2 * falls >= len(table))
    if falls:
        return table, titles
    return pairs, titles[:2]


def _runs_on(table, titled, count):
    """Whether rows hold numbers one after the other, of which the header states how many."""
    if count is None or count == len(table):
        return False
    if any(len(NUMBER.findall(field)) > 1 for row in table for field in row):
        return True
    return not titled and max(map(len, table)) > 1 and not _rises(table, 0)


def _rises(table, place):
    column = [row[place] for row in table if len(row) > place]
    if len(column) < len(table) or len(table) < 2 or not all(re.fullmatch(NUMBER, field) for field in column):
        return False
    return all(single(after) > single(before) for before, after in pairwise(column))


def _numbers(table, place):
    """Whether the column numbers the rows, from 0 or from 1 on."""
    column = [row[place] for row in table if len(row) > place]
    return len(column) == len(table) and any(column == [str(k + n) for k in range(len(table))] for n in (0, 1))


def _check_header(header, titles, at, by, whole):
    """Refuses a damaged first row, and PEER's header, damaged."""
    need(whole or not any(re.search(r"\bnpts\b", line.lower()) for line in header))
    if header and not (titles and at == len(header) - 1) and not COMMENT.match(header[-1]):
        _, (line,) = blanked(header[-1:])
        need(not any(re.match("[+-]?[.,]?[0-9]", field.strip()) for field in line.split(by)[1:]))


def _times(table, kinds, titles, known, spectrum):
    """The columns of times."""
    named = [k for k, kind in enumerate(kinds) if kind == "time"]
    if named or len(kinds) == 1:
        return named
    first = int(kinds[0] == "number")
    rising = first < len(kinds) - 1 and _rises(table, first)
    if first < len(kinds) - 1:
        for row in table:
            single(row[min(first, len(row) - 1)])
    need("period" not in kinds and "frequency" not in kinds)
    need(not rising or (kinds[first] in ("", "acceleration", "number") and not spectrum))
    if rising and titles:
        need(not any(unit_word(word) or word in ("m", "in", "ft") for word in inside(titles[first])))
    if rising and kinds[first] in ("", "acceleration"):
        return [first]
    need(titles or known)
    return []


def _number_of(column, titles, places, width):
    """The column (from 1) of accelerations."""
    wanted = str(column).strip().casefold()
    bare = [re.sub(r"[(\[][^)\]]*[)\]]?", " ", title) for title in titles]
    named = [k for k in range(len(titles)) if wanted in (titles[k].casefold(), " ".join(bare[k].split()).casefold())]
    by_number = [k for k in range(width) if str(k + 1) == wanted]
    (found,) = places if column is None else by_number or named
    need(found in places)
    return found + 1


def _whole_end(table):
    """Whether the last number is of the form that all those above it share: else the file may be cut within it."""
    forms = []
    for row in table:
        try:
            field = row[len(table[-1]) - 1]
            single(field)
            forms.append(form_of(field))
        except ERRORS:
            forms.append(None)
    return len(forms) < 3 or len(set(forms[:-1])) > 1 or forms[-1] == forms[0]


def _header_and_rows(lines):
    """Lines before the first that begins with a number, those from it on without comments, the comments, and the index
    of the first row."""
    header, rows, comments, first = [], [], [], 0
    top = [line[:400] for line in lines[:200]]
    begin = max((at + 1 for at, line in enumerate(top) if count_of([line]) is not None), default=0)
    if any(re.search("[0-9]", line) and not re.search(r"[^0-9.,;+\-eEdD \t]", line) for line in top[:begin]):
        begin = 0
    for at, line in enumerate(lines):
        line = line.strip()
        if not rows and line and all(re.fullmatch("[-=_*~+|]{3,}", part) for part in line.split()):
            continue
        if COMMENT.match(line):
            (comments if rows else header).append(line[:400])
        elif line and (rows or (at >= begin and _is_data(line))):
            first = first if rows else at
            rows.append(_stamped(line.split("#")[0].strip()))
        elif line:
            header.append(line[:400])
    return header, rows, comments, first


STAMP = re.compile(
    r"(?:(?P<y>[0-9]{4})(?:-(?P<m>[0-9]{1,2})-(?P<d>[0-9]{1,2})|/(?P<n>[0-9]{1,2})/(?P<e>[0-9]{1,2}))(?:T| +))?"
    r"(?P<hour>[0-9]{1,2}):(?P<minute>[0-9]{2}):(?P<second>[0-9]{2})(?P<rest>[.][0-9]{1,9}|,[0-9]{1,9}(?=[;\s])|)"
    r"(?:Z|[+-][0-9]{2}:?[0-9]{2})?(?=[\s;,]|$)"
)


def _stamped(row):
    """The row with seconds in place of its first time stamp."""
    found = next((one for one in STAMP.finditer(row) if one.start() == 0 or row[one.start() - 1] in ",; \t"), None)
    dated = re.match(r"[0-9]{1,4}([-/.])[0-9]{1,2}\1[0-9]{1,4}[T\s;,]|[0-9]{1,2}:[0-9]{2}", row)
    need(not dated or (found and found.start() == 0))
    if not found:
        return row
    days = (
        date(int(found["y"]), int(found["m"] or found["n"]), int(found["d"] or found["e"])).toordinal()
        if found["y"]
        else 0
    )
    seconds = ((days * 24 + int(found["hour"])) * 60 + int(found["minute"])) * 60 + int(found["second"])
    return f"{row[: found.start()]}{seconds}{found['rest']}{row[found.end() :]}"


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
