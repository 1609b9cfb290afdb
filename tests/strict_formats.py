"""The formats of observatories for the second reader of records (`strict_records`), which says what it is for.

Each function takes the lines of a file and gives its channels, [(number, direction, step, samples, factor)], or None
if the file is not of its format.
"""

import re
from fractions import Fraction

from strict_statements import flat, fold
from strict_words import KNOWN, G, Refused, form_of, scan, single, step_of, unit_of

FORTRAN = re.compile("([1-9][0-9]?)[A-Z]{1,2} *([1-9][0-9]?) *[.] *([0-9]{1,2})(?: *E *[0-9]?)?")


def layout_of(line):
    """(numbers a line, width, decimals) of the last Fortran format in brackets; None without one."""
    found = None
    for piece in line.split("(")[1:]:
        inside, closed, _ = piece.partition(")")
        layout = FORTRAN.fullmatch(inside.strip(" ").upper())
        found = tuple(map(int, layout.groups())) if layout and closed else found
    return found


def columns_of(lines, at, count, layout):
    """(values, index of the line behind) of `count` numbers in columns of equal width."""
    per_line, width, decimals = layout
    values, forms = [], set()
    while len(values) < count:
        if at >= len(lines):
            raise Refused("cut")
        text = lines[at].rstrip(" ")
        wanted = min(per_line, count - len(values))
        if len(text) != wanted * width:
            raise Refused("width")
        for k in range(wanted):
            field = text[k * width : (k + 1) * width].lstrip(" ")
            values.append(single(field))
            found = scan(field, 0)[1]
            decimals = found if decimals is None else decimals
            if found is None or found != decimals:
                raise Refused("decimals")
            forms.add(form_of(field))
        at += 1
    if len(forms) > 1:
        raise Refused("forms")
    while at < len(lines) and not lines[at].strip():
        at += 1
    return values, at


def starts(line, words):
    """Whether the line starts with the words, none of which ends within a longer one."""
    return re.match(rf"\s*{words}\b", line.lower())


def csmip(lines):
    first = next((line for line in lines if line.strip()), "")
    if not starts(first, "corrected accelerogram"):
        return None
    begins = [at for at, line in enumerate(lines) if starts(line, "corrected accelerogram")] + [len(lines)]
    return [_csmip_channel(lines[begin:end]) for begin, end in zip(begins, begins[1:], strict=False)]


def _csmip_data(line):
    """(count, kind, step, its unit) of a line that announces data, None of another."""
    announced = r"\s*([0-9]{1,9})\s+points\s+of\s+(accel|veloc|displ)\s+data\s+equally\s+spaced\s+at\s+(\S+)\s+([a-z]+)"
    found = re.match(announced, line.lower())
    return found and found.groups()


def _csmip_channel(lines):
    top = re.match(r"(?:(?!chan).)+chan(?:nel)?\s*([0-9]{1,4})\s*:(.*)", lines[0][:400].lower())
    data = next((at for at, line in enumerate(lines) if _csmip_data(line)), None)
    if not top or data is None or _csmip_data(lines[data])[1] != "accel":
        raise Refused("no channel or no data")
    count, _, step, unit = _csmip_data(lines[data])
    values, behind = columns_of(lines, data + 1, int(count), layout_of(lines[data]) or (8, 10, None))
    rest = lines[behind:]
    if not rest or not (_csmip_data(rest[0]) or rest[0].startswith("/&")):
        raise Refused("more numbers")
    if not any(line.startswith("/&") for line in rest):
        raise Refused("no end")
    rounded = step_of(step, unit)
    exact = scan(lines[data - 6][40:50].strip() + " ", 0) if data > 13 else None
    if exact and exact[3] == len(lines[data - 6][40:50].strip()) and exact[0] > 0:
        if abs(exact[0] - rounded) > Fraction("0.5000001") / 10 ** len(step.partition(".")[2]):
            raise Refused("two steps")
        rounded = exact[0]
    words = top[2].split()
    name = " ".join(words[:-1] if words[-1:] == ["from"] else words).casefold()
    return str(int(top[1])), name, rounded, values, unit_of([lines[data]], None)


def cosmos(lines):
    first = next((line for line in lines if line.strip()), "")
    if _cosmos_text(first) is None:
        return None
    begins = [at for at, line in enumerate(lines) if _cosmos_text(line) is not None] + [len(lines)]
    pairs = zip(begins, begins[1:], strict=False)
    return [_cosmos_channel(lines[begin:end], order) for order, (begin, end) in enumerate(pairs, 1)]


def _cosmos_text(line):
    """Lines of text that the first line of a channel counts; None if it is none."""
    found = re.match(r"[^(]*\(format v[0-9.]+ with ([0-9]{1,2}) text lines\)", line[:400].lower())
    return found and int(found[1])


def _cosmos_header(lines, at, kind):
    """(tokens, index of the line behind) of a header of numbers."""
    counts = rf"\s*([0-9]{{1,4}})\s+{kind}-header\s+values\s+follow\s+on\s+([0-9]{{1,3}})\s+lines(?![^\W_])"
    found = re.match(counts, lines[at][:400].lower()) if at < len(lines) else None
    if not found:
        raise Refused("header")
    end = at + 1 + int(found[2])
    tokens = " ".join(lines[at + 1 : end]).split()
    if len(tokens) != int(found[1]):
        raise Refused("header values")
    return tokens, end


def _cosmos_data(line):
    """(count, kind, unit, its code or None) of a line that announces data; None of another."""
    low = line[:400].lower()
    head = re.match(r"\s*([0-9]{1,9})\s+([a-z]+)\s+pts,(.*)", low)
    stated = head and re.search("units *=(.*)", head[3])
    if not stated or len(low.split()) < 4 or re.search(r"\w$", head[3][: stated.start()]):
        return None
    rest, _, layout = stated[1].partition("format")
    unit = re.fullmatch(r" *([^,(]*[^,( ]) *(?:\( *([0-9]+) *\) *)?,? *", rest)
    if not re.match(" *=", layout) or re.search(r"\w$", rest) or not unit:
        return None
    return int(head[1]), head[2], unit[1], unit[2] and int(unit[2])


def _ends(line):
    return starts(line, "end-of-data") or line.lstrip().startswith("/&")


def _cosmos_channel(lines, order):
    at = _cosmos_text(lines[0])
    station = re.compile(r"\s*sta\s+chan?\s*:?\s*([0-9]{1,4}|\?)\s*:([^(]*)")
    stated = [found for line in lines[:at] if (found := station.match(line[:400].lower()))]
    number, direction = stated[0].groups() if stated else ("?", "")
    number, direction = str(order) if number == "?" else number, " ".join(direction.split())
    integers, at = _cosmos_header(lines, at, "integer")
    reals, at = _cosmos_header(lines, at, "real")
    comments = re.match(r"\s*([0-9]{1,4})\s+comment\s+line", lines[at][:400].lower()) if at < len(lines) else None
    if not comments:
        raise Refused("comments")
    at += 1 + int(comments[1])
    data = _cosmos_data(lines[at]) if at < len(lines) else None
    integer = single(integers[1]) if len(integers) > 1 else -999
    if not data or data[1] != "acceleration" or integer not in (1, -999):
        raise Refused("no acceleration")
    layout, factor = layout_of(lines[at]), KNOWN.get(data[2].removesuffix("."))
    if factor is None or {2: G, 4: Fraction(1, 100)}.get(data[3], factor) != factor or not layout:
        raise Refused("unit")
    values, behind = columns_of(lines, at + 1, data[0], layout)
    rest = lines[behind:]
    if not any(_ends(line) for line in rest) or not (_ends(rest[0]) or _cosmos_data(rest[0])):
        raise Refused("end")
    milliseconds, length, _ = (single(reals[k]) if len(reals) > k else -999 for k in (61, 62, 63))
    if milliseconds <= 0:
        return number, direction, None, values, factor
    step = milliseconds / 1000
    if length > 0 and abs(length - data[0] * step) > max(length / 100, 2 * step):
        raise Refused("length")
    return number, direction, step, values, factor


def knet(lines):
    first = next((line for line in lines if line.strip()), "")
    if not first.lower().startswith("origin time "):
        return None
    end = next((at for at, line in enumerate(lines[:30]) if line.lower().startswith("memo.")), None)
    if end is None:
        raise Refused("memo")
    header = [line[:400] for line in lines[:end]]
    (frequency,) = _knet_numbers(header, r"sampling freq *\(hz\) *([0-9]{1,6}(?:[.][0-9]*)?) *(?:hz)? *")
    (duration,) = _knet_numbers(header, r"duration time *\(s\) *([0-9]{1,6}(?:[.][0-9]*)?) *")
    number = "([0-9]{1,%d}(?:[.][0-9]*)?)"
    gal, steps = _knet_numbers(header, rf"scale factor *{number % 9} *\(gal\) */ *{number % 12} *")
    if sum(line.lower().startswith("dir.") for line in header) != 1 or not frequency * gal * steps:
        raise Refused("header")
    counts = []
    ends = {word.end() for line in lines[end + 1 : end + 2] for word in re.finditer(r"\S+", line)}
    for line in lines[end + 1 :]:
        if not ends.issuperset(word.end() for word in re.finditer(r"\S+", line)):
            raise Refused("columns of counts")
        if not all(re.fullmatch("[+-]?[0-9]{1,9}", token) for token in line.split()):
            raise Refused("count")
        counts += map(int, line.split())
    if len(counts) != round(duration * frequency):
        raise Refused("samples")
    mean = Fraction(sum(counts), max(len(counts), 1))
    values = [(count - mean) * gal / steps for count in counts]
    return [("", "", 1 / frequency, values, Fraction(1, 100))]


def _knet_numbers(header, pattern):
    """The numbers of the one line of the header that is of the pattern."""
    found = [line for text in header if (line := re.fullmatch(pattern, text.lower()))]
    if len(found) != 1:
        raise Refused("header")
    return [single(number) for number in found[0].groups()]


def smc(lines):
    begin = next(at for at, line in enumerate(lines) if line.strip())
    kinds = r"(accelerogram|velocity|displacement|response(?=\s+spectra(?!\S)))\b"
    found = re.match(rf"\s*[0-9]\s+(?:(?:un)?corrected\s+)?{kinds}", lines[begin][:400].lower())
    if not found:
        return None
    if found[1] != "accelerogram":
        raise Refused("no acceleration")
    rows = [line.split() for line in lines[begin + 11 : begin + 27]]
    if [len(row) for row in rows] != [8] * 6 + [5] * 10:
        raise Refused("header")
    numbers = [single(token) for row in rows for token in row]
    comments, count, precision = (numbers[k] for k in (15, 16, 46))
    frequency = numbers[48 + 1]
    if any(value != int(value) for value in (comments, count, precision)) or not 0 < frequency < 10**30:
        raise Refused("header")
    layout = (5, 14, 7) if precision == 8 else (8, 10, 4)
    values, behind = columns_of(lines, begin + 27 + max(int(comments), 0), int(count), layout)
    if any(line.strip() for line in lines[behind:]):
        raise Refused("more numbers")
    return [("", "", 1 / frequency, values, Fraction(1, 100))]


UNREAD = re.compile(
    r"(?:un)?corrected accelerogram\s+[0-9]{8}_[0-9]{6}_|uncorrected accelerogram\b"
    r"|(?:response|fourier)\b(?!.*\(format)[^(]*\bspectr(?:a|um)\b|raw acceleration counts\b.*\(format"
    r"|\*?\s*vol[12]ds file\b|timeseries\b(?:.*[\s,])?slist(?:[\s,]|$)|# dataset: geocsv"
)


def by_name(lines, content):
    """Whether the file is of a format that is known and not read."""
    begin = next(at for at, line in enumerate(lines) if line.strip())
    top = [line[:200].lower().strip() for line in lines[begin : begin + 12]]
    return (
        UNREAD.match(top[0])
        or any(fold(flat(line)).startswith("archivo estandar de aceleracion") for line in top)
        or re.match(rb"[0-9]{6}[DRQM][ \0]|MS\x03", content)
        or content[304:308] in (b"\6\0\0\0", b"\0\0\0\6")
    )
