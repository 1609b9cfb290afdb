"""The formats of observatories for the second reader of records (`strict_records`), which says what it is for.

Each function takes the lines of a file and gives None if the file is not of its format; else its channels,
[(number, direction, step, samples, factor)], or of one channel (bounds of the step, samples, factor).
"""

import re
from fractions import Fraction
from itertools import pairwise

from strict_statements import flat, fold
from strict_words import KNOWN, NUMBER, G, form_of, need, single, step_of, uniform, unit_of

GAL = Fraction(1, 100)
FORTRAN = re.compile(r"\( *([1-9][0-9]?)[A-Z]{1,2} *([1-9][0-9]?) *[.] *([0-9]{1,2})(?: *E *[0-9]?)? *\)")


def layout_of(line):
    """(numbers a line, width, decimals) of the last Fortran format in brackets; None without one."""
    found = FORTRAN.findall(line.upper())
    return tuple(map(int, found[-1])) if found else None


def columns_of(lines, at, count, layout):
    """(values, index of the line behind) of `count` numbers in columns of equal width."""
    per_line, width, decimals = layout
    fields = []
    while len(fields) < count:
        text = lines[at].rstrip(" ")
        wanted = min(per_line, count - len(fields))
        need(len(text) == wanted * width)
        fields += [text[k * width : (k + 1) * width].lstrip(" ") for k in range(wanted)]
        at += 1
    values, forms = [single(field) for field in fields], {form_of(field) for field in fields}
    need(len(forms) < 2 and None not in forms and all(decimals in (None, form[0]) for form in forms))
    while at < len(lines) and not lines[at].strip():
        at += 1
    return values, at


def first_of(lines):
    return next(line for line in lines if line.strip())


def starts(line, words):
    """Whether the line starts with the words, none of which ends within a longer one."""
    return re.match(rf"\s*{words}\b", line.lower())


def parted(lines, begins):
    """The lines of each channel; `begins` says of a line whether one begins there."""
    at = [index for index, line in enumerate(lines) if begins(line)] + [len(lines)]
    return [lines[begin:end] for begin, end in zip(at, at[1:], strict=False)]


def csmip(lines):
    def begins(line):
        return starts(line, "corrected accelerogram")

    return [_csmip_channel(part) for part in parted(lines, begins)] if begins(first_of(lines)) else None


def _csmip_data(line):
    """(count, kind, step, its unit) of a line that announces data, None of another."""
    announced = r"\s*([0-9]{1,9})\s+points\s+of\s+(accel|veloc|displ)\s+data\s+equally\s+spaced\s+at\s+(\S+)\s+([a-z]+)"
    found = re.match(announced, line.lower())
    return found and found.groups()


def _csmip_channel(lines):
    ((number, words),) = re.findall(r"^(?:(?!chan).)+chan(?:nel)?\s*([0-9]{1,4})\s*:(.*)", lines[0][:400].lower())
    data = next((at for at, line in enumerate(lines) if _csmip_data(line)), len(lines))
    count, kind, step, unit = _csmip_data(lines[data])
    values, behind = columns_of(lines, data + 1, int(count), layout_of(lines[data]) or (8, 10, None))
    need(kind == "accel" and (_csmip_data(lines[behind]) or lines[behind].startswith("/&")))
    need(any(line.startswith("/&") for line in lines[behind:]))
    rounded = step_of(step, unit)
    exact = lines[data - 6][40:50].strip() if data > 13 else ""
    if NUMBER.fullmatch(exact) and single(exact) > 0:
        need(abs(single(exact) - rounded) <= Fraction("0.5000001") / 10 ** len(step.partition(".")[2]))
        rounded = single(exact)
    name = " ".join(words.split()).removesuffix("from").strip().casefold()
    return str(int(number)), name, rounded, values, unit_of([lines[data]], None)


def cosmos(lines):
    if _cosmos_text(first_of(lines)) is None:
        return None
    parts = parted(lines, lambda line: _cosmos_text(line) is not None)
    return [_cosmos_channel(part, order) for order, part in enumerate(parts, 1)]


def _cosmos_text(line):
    """Lines of text that the first line of a channel counts; None if it is none."""
    found = re.match(r"[^(]*\(format v[0-9.]+ with ([0-9]{1,2}) text lines\)", line[:400].lower())
    return found and int(found[1])


def _cosmos_header(lines, at, kind):
    """(tokens, index of the line behind) of a header of numbers."""
    counts = rf"^\s*([0-9]{{1,4}})\s+{kind}-header\s+values\s+follow\s+on\s+([0-9]{{1,3}})\s+lines(?![^\W_])"
    ((count, rows),) = re.findall(counts, lines[at][:400].lower())
    end = at + 1 + int(rows)
    tokens = " ".join(lines[at + 1 : end]).split()
    need(len(tokens) == int(count))
    return tokens, end


def _cosmos_data(line):
    """(count, kind, unit, its code or "") of a line that announces data; None of another."""
    low = line[:400].lower()
    head = re.match(r"\s*([0-9]{1,9})\s+([a-z]+)\s+pts,(.*)", low)
    stated = head and re.fullmatch("(.*)units *=(.*)", head[3])  # the last one
    if not stated or len(low.split()) < 4 or re.search(r"\w$", stated[1]):
        return None
    rest, _, layout = stated[2].partition("format")
    unit = re.fullmatch(r" *([^,(]*[^,( ]) *(?:\( *0*([0-9]+) *\) *)?,? *", rest)
    if not re.match(" *=", layout) or re.search(r"\w$", rest) or not unit:
        return None
    return int(head[1]), head[2], unit[1], unit[2]


def _cosmos_channel(lines, order):
    at = _cosmos_text(lines[0])
    station = re.compile(r"\s*sta\s+chan?\s*:?\s*([0-9]{1,4}|\?)\s*:([^(]*)")
    stated = [found.groups() for line in lines[:at] if (found := station.match(line[:400].lower()))]
    number, direction = (stated or [("?", "")])[0]
    integers, at = _cosmos_header(lines, at, "integer")
    reals, at = _cosmos_header(lines, at, "real")
    (comments,) = re.findall(r"^\s*([0-9]{1,4})\s+comment\s+line", lines[at][:400].lower())
    at += 1 + int(comments)
    data, layout = _cosmos_data(lines[at]), layout_of(lines[at])
    need(data and layout and (len(integers) < 2 or single(integers[1]) in (1, -999)))
    count, kind, unit, code = data
    factor = KNOWN[unit.removesuffix(".")]
    need(kind == "acceleration" and {"2": G, "4": GAL}.get(code, factor) == factor)
    values, behind = columns_of(lines, at + 1, count, layout)
    ends = [bool(starts(line, "end-of-data")) or line.lstrip().startswith("/&") for line in lines[behind:]]
    need(any(ends) and (ends[0] or _cosmos_data(lines[behind])))
    milliseconds, length, _ = (single(reals[k]) if len(reals) > k else -999 for k in (61, 62, 63))
    step = milliseconds / 1000 if milliseconds > 0 else None
    need(not step or length <= 0 or abs(length - count * step) <= max(length / 100, 2 * step))
    return str(order) if number == "?" else number, " ".join(direction.split()), step, values, factor


def knet(lines):
    if not first_of(lines).lower().startswith("origin time "):
        return None
    (end, *_) = [at for at, line in enumerate(lines[:30]) if line.lower().startswith("memo.")]
    header, rows = [line[:400].lower() for line in lines[:end]], lines[end + 1 :]
    number = "([0-9]{1,%d}(?:[.][0-9]*)?)"
    (frequency,) = _knet_numbers(header, rf"sampling freq *\(hz\) *{number % 6} *(?:hz)? *")
    (duration,) = _knet_numbers(header, rf"duration time *\(s\) *{number % 6} *")
    gal, steps = _knet_numbers(header, rf"scale factor *{number % 9} *\(gal\) */ *{number % 12} *")
    need(sum(line.startswith("dir.") for line in header) == 1)
    words = [word for line in rows for word in re.finditer(r"\S+", line)]
    need({word.end() for word in words} <= {word.end() for word in re.finditer(r"\S+", rows[0])})
    need(all(re.fullmatch("[+-]?[0-9]{1,9}", word[0]) for word in words))
    counts = [int(word[0]) for word in words]
    need(frequency * gal * steps and counts and len(counts) == round(duration * frequency))
    mean = Fraction(sum(counts), len(counts))
    return (1 / frequency, 1 / frequency), [(count - mean) * gal / steps for count in counts], GAL


def _knet_numbers(header, pattern):
    """The numbers of the one line of the header that is of the pattern."""
    (found,) = [line for text in header if (line := re.fullmatch(pattern, text))]
    return [single(number) for number in found.groups()]


def knet_csv(lines):
    if not re.match(r"#\s*k-net csv(?!\w)", first_of(lines).lower()):
        return None
    header = [line[:400].strip()[1:] for line in lines if line.startswith("#")]
    rows = [line.split(",") for line in lines if line.strip() and not line.startswith("#")]
    below = {key: [after for line, after in pairwise(header) if line == key] for key in header}
    (frequency,), (duration,) = below["SamplingFrequency(Hz)"], below["DurationTime(s)"]
    ((titles, offsets),) = [(key, below[key][0]) for key in below["Offset"] if len(below[key]) == 1]
    need(header[-1] == f"Time,RelativeTime(s),{titles}" and len(below["Offset"]) == 1)
    names, offsets = re.findall(r"([^,()]+)\((?i:gal)\)", titles), [single(offset) for offset in offsets.split(",")]
    frequency, _ = single(frequency), single(duration)
    need(len(names) == len(offsets) and len(rows) > 1 and frequency > 0)
    need(all(len(row) == 2 + len(names) for row in rows))
    values = [[single(field) for field in column] for column in list(zip(*rows, strict=True))[1:]]
    need(all(len({form_of(field) for field in column}) == 1 for column in list(zip(*rows, strict=True))[1:]))
    least, most = uniform([row[1] for row in rows])
    need(least * (1 - Fraction(1, 10**6)) <= 1 / frequency <= most * (1 + Fraction(1, 10**6)))
    return [
        (str(place), name.casefold(), 1 / frequency, [value - offset for value in column], GAL)
        for place, (name, offset, column) in enumerate(zip(names, offsets, values[1:], strict=True), 1)
    ]


def smc(lines):
    begin = lines.index(first_of(lines))
    kinds = r"(accelerogram|velocity|displacement|response(?=\s+spectra(?!\S)))\b"
    found = re.match(rf"\s*[0-9]\s+(?:(?:un)?corrected\s+)?{kinds}", lines[begin][:400].lower())
    if not found:
        return None
    rows = [line.split() for line in lines[begin + 11 : begin + 27]]
    need(found[1] == "accelerogram" and [len(row) for row in rows] == [8] * 6 + [5] * 10)
    numbers = [single(token) for row in rows for token in row]
    comments, count, precision = (numbers[k] for k in (15, 16, 46))
    frequency = numbers[48 + 1]
    need(all(value == int(value) for value in (comments, count, precision)) and 0 < frequency < 10**30)
    layout = (5, 14, 7) if precision == 8 else (8, 10, 4)
    values, behind = columns_of(lines, begin + 27 + max(int(comments), 0), int(count), layout)
    need(not any(line.strip() for line in lines[behind:]))
    return (1 / frequency, 1 / frequency), values, GAL


UNREAD = re.compile(
    r"(?:un)?corrected accelerogram\s+[0-9]{8}_[0-9]{6}_|uncorrected accelerogram\b"
    r"|(?:response|fourier)\b(?!.*\(format)[^(]*\bspectr(?:a|um)\b|raw acceleration counts\b.*\(format"
    r"|\*?\s*vol[12]ds file\b|timeseries\b(?:.*[\s,])?(?:slist|tspair)(?:[\s,]|$)|# dataset: geocsv"
)


def by_name(lines, content):
    """Whether the file is of a format that is known and not read."""
    begin = lines.index(first_of(lines))
    top = [line[:200].lower().strip() for line in lines[begin : begin + 12]]
    return (
        UNREAD.match(top[0])
        or any(fold(flat(line)).startswith("archivo estandar de aceleracion") for line in top)
        or re.match(rb"[0-9]{6}[DRQM][ \0]|MS\x03", content)
        or content[304:308] in (b"\6\0\0\0", b"\0\0\0\6")
    )
