"""The formats of observatories for the second reader of records (`strict_records`), which says what it is for.

Each function takes the lines of a file and gives its channels, [(number, direction, step, samples, factor)], or None
if the file is not of its format.
"""

from fractions import Fraction

from strict_statements import flat, fold
from strict_words import DIGITS, KNOWN, LETTERS, G, Refused, form_of, scan, single, step_of, unit_of


def layout_of(line):
    """(numbers a line, width, decimals) of the last Fortran format in brackets; None without one."""
    found = None
    for piece in line.split("(")[1:]:
        inside, closed, _ = piece.partition(")")
        parts, kind = [""], ""
        for sign in inside.strip(" ").upper():
            if sign in DIGITS:
                parts[-1] += sign
            elif sign in LETTERS.upper() and len(parts) == 1:
                kind += sign
                parts += [""]
            elif sign in LETTERS.upper() and parts[1:] == [""]:
                kind += sign
            else:
                parts += [sign, ""]
        kept = [part for part in parts if part.strip(" ")]
        if len(kept) > 4 and kept[4] == "E" and "".join(kept[5:]) in ("", *DIGITS):
            kept = kept[:4]
        good = len(kept) == 4 and kept[2] == "." and 0 < len(kind) < 3 and closed
        numbers = [part for at, part in enumerate(kept) if at != 2]
        if (
            good
            and all(len(part) < 3 and part[0] in DIGITS for part in numbers)
            and "0" not in (kept[0][0], kept[1][0])
        ):
            found = int(kept[0]), int(kept[1]), int(kept[3])
    return found


def columns_of(lines, at, count, layout):
    """(values, index of the line behind) of `count` numbers in columns of equal width."""
    per_line, width, decimals = layout
    values, forms = [], set()
    while len(values) < count:
        if at >= len(lines):
            raise Refused("cut")
        text = lines[at]
        while text.endswith(" "):
            text = text[:-1]
        wanted = min(per_line, count - len(values))
        if len(text) != wanted * width:
            raise Refused("width")
        for k in range(wanted):
            field = text[k * width : (k + 1) * width]
            while field.startswith(" "):
                field = field[1:]
            value = single(field)
            found = scan(field, 0)[1]
            decimals = found if decimals is None else decimals
            if found is None or found != decimals:
                raise Refused("decimals")
            values.append(value)
            forms.add(form_of(field))
        at += 1
    if len(forms) > 1:
        raise Refused("forms")
    while at < len(lines) and not lines[at].strip():
        at += 1
    return values, at


def starts(line, words):
    """Whether the line starts with the words, none of which ends within a longer one."""
    text = line.lstrip().lower()
    return text.startswith(words) and not (text[len(words) : len(words) + 1].isalnum() or text[len(words) :][:1] == "_")


def csmip(lines):
    first = next((line for line in lines if line.strip()), "")
    if not starts(first, "corrected accelerogram"):
        return None
    begins = [at for at, line in enumerate(lines) if starts(line, "corrected accelerogram")] + [len(lines)]
    return [_csmip_channel(lines[begin:end]) for begin, end in zip(begins, begins[1:], strict=False)]


def _csmip_data(line):
    """[count, kind, step, its unit] of a line that announces data, None of another."""
    words = line.lower().split()
    if words[1:3] != ["points", "of"] or words[4:8] != ["data", "equally", "spaced", "at"] or len(words) < 10:
        return None
    if words[3] not in ("accel", "veloc", "displ") or any(sign not in DIGITS for sign in words[0]):
        return None
    unit = ""
    for sign in words[9]:
        if sign not in LETTERS:
            break
        unit += sign
    return [words[0], words[3], words[8], unit] if unit and len(words[0]) < 10 else None


def _csmip_channel(lines):
    top = lines[0][:400].rstrip()
    at = top.lower().find("chan")
    number, colon, name = top[at + 4 :].partition(":")
    number = number.lower().removeprefix("nel").strip()
    if at < 1 or not colon or not number or len(number) > 4 or any(sign not in DIGITS for sign in number):
        raise Refused("channel")
    words = name.split()
    words = words[:-1] if words and words[-1].lower() == "from" else words
    data = next((at for at, line in enumerate(lines) if _csmip_data(line)), None)
    if data is None or _csmip_data(lines[data])[1] != "accel":
        raise Refused("no data")
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
        places = len(step.partition(".")[2])
        if abs(exact[0] - rounded) > Fraction("0.5000001") / 10**places:
            raise Refused("two steps")
        rounded = exact[0]
    return str(int(number)), " ".join(words).casefold(), rounded, values, unit_of([lines[data]], None)


def _leading(text, most):
    """(whole number, rest) of a text that begins with one of up to `most` digits; None without one."""
    i = 0
    while text[i : i + 1] and text[i] in DIGITS:
        i += 1
    return (int(text[:i]), text[i:]) if 0 < i <= most else None


def cosmos(lines):
    first = next((line for line in lines if line.strip()), "")
    if _cosmos_text(first) is None:
        return None
    begins = [at for at, line in enumerate(lines) if _cosmos_text(line) is not None] + [len(lines)]
    pairs = zip(begins, begins[1:], strict=False)
    return [_cosmos_channel(lines[begin:end], order) for order, (begin, end) in enumerate(pairs, 1)]


def _cosmos_text(line):
    """Lines of text that the first line of a channel counts; None if it is none."""
    inside = line[:400].lower().partition("(")[2].partition(")")[0].split(" ")
    good = len(inside) == 6 and inside[0] == "format" and inside[2] == "with" and inside[4:] == ["text", "lines"]
    if not good or inside[1][:1] != "v" or not inside[1][1:] or any(sign not in DIGITS + "." for sign in inside[1][1:]):
        return None
    found = _leading(inside[3], 2)
    return found[0] if found and not found[1] and ")" in line[:400] else None


def _cosmos_header(lines, at, kind):
    """(tokens, index of the line behind) of a header of numbers."""
    words = lines[at][:400].lower().split() if at < len(lines) else []
    if words[1:5] != [f"{kind}-header", "values", "follow", "on"] or len(words) < 7 or words[6][:5] != "lines":
        raise Refused("header")
    count, rows = _leading(words[0], 4), _leading(words[5], 3)
    if not count or count[1] or not rows or rows[1] or words[6][5:6].isalnum():
        raise Refused("header")
    tokens = " ".join(lines[at + 1 : at + 1 + rows[0]]).split()
    if len(tokens) != count[0]:
        raise Refused("header values")
    return tokens, at + 1 + rows[0]


def _cosmos_data(line):
    """(count, kind, unit, its code or None) of a line that announces data; None of another."""
    words = line[:400].lower().split()
    count = _leading(words[0], 9) if words else None
    if not count or count[1] or len(words) < 4 or words[2][:4] != "pts," or any(s not in LETTERS for s in words[1]):
        return None
    behind = line[:400].partition(",")[2].lower()
    pieces = behind.split("units")
    places = [k for k in range(1, len(pieces)) if pieces[k].lstrip(" ")[:1] == "="]
    if not places or (pieces[places[0] - 1][-1:].isalnum() or pieces[places[0] - 1][-1:] == "_"):
        return None
    rest = "units".join(pieces[places[0] :]).lstrip(" ")[1:]
    rest, formatted, layout = rest.partition("format")
    if not formatted or layout.lstrip(" ")[:1] != "=" or rest[-1:].isalnum() or rest[-1:] == "_":
        return None
    unit, opened, code = rest.rstrip(" ").removesuffix(",").partition("(")
    code = code.rstrip(" ")
    if not unit.strip(" ") or "," in unit or (opened and not code.endswith(")")):
        return None
    code = code[:-1].strip(" ") if opened else None
    if code is not None and (not code or any(sign not in DIGITS for sign in code)):
        return None
    return count[0], words[1], unit.strip(" "), code and (code.lstrip("0") or "0")


def _ends(line):
    return starts(line, "end-of-data") or line.lstrip().startswith("/&")


def _cosmos_channel(lines, order):
    at = _cosmos_text(lines[0])
    number, direction = str(order), ""
    for line in lines[:at]:
        words = line[:400].lower().split()
        if words[:1] == ["sta"] and words[1:] and words[1][:3] == "cha":
            behind = line[:400].lower().partition("cha")[2].removeprefix("n").strip().removeprefix(":").strip()
            stated, colon, name = behind.partition(":")
            found = _leading(stated.strip(), 4)
            if colon and ((found and not found[1]) or stated.strip() == "?"):
                number = stated.strip() if found else str(order)
                direction = " ".join(name.partition("(")[0].split())
                break
    integers, at = _cosmos_header(lines, at, "integer")
    reals, at = _cosmos_header(lines, at, "real")
    words = lines[at][:400].lower().split() if at < len(lines) else []
    comments = _leading(words[0], 4) if words else None
    if not comments or comments[1] or words[1:2] != ["comment"] or not words[2:] or words[2][:4] != "line":
        raise Refused("comments")
    at += 1 + comments[0]
    data = _cosmos_data(lines[at]) if at < len(lines) else None
    integer = single(integers[1]) if len(integers) > 1 else -999
    if not data or data[1] != "acceleration" or integer not in (1, -999):
        raise Refused("no acceleration")
    layout, factor = layout_of(lines[at]), KNOWN.get(data[2].removesuffix("."))
    if factor is None or {"2": G, "4": Fraction(1, 100)}.get(data[3], factor) != factor or not layout:
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
    frequency = _knet_numbers(header, ("sampling freq", "(hz)"), [6], ("hz", ""))[0]
    duration = _knet_numbers(header, ("duration time", "(s)"), [6], ("",))[0]
    gal, steps = _knet_numbers(header, ("scale factor", ""), [9, 12], ("",))
    if sum(line.lower().startswith("dir.") for line in header) != 1 or not frequency * gal * steps:
        raise Refused("header")
    counts = []
    ends = set(_ends_in(lines[end + 1])) if lines[end + 1 :] else set()
    for line in lines[end + 1 :]:
        if not ends.issuperset(_ends_in(line)):
            raise Refused("columns of counts")
        for token in line.split():
            bare = token[1:] if token[0] in "+-" else token
            found = _leading(bare, 9)
            if not found or found[1]:
                raise Refused("count")
            counts.append(-found[0] if token[0] == "-" else found[0])
    if len(counts) != round(duration * frequency):
        raise Refused("samples")
    mean = Fraction(sum(counts), max(len(counts), 1))
    values = [(count - mean) * gal / steps for count in counts]
    return [("", "", 1 / frequency, values, Fraction(1, 100))]


def _ends_in(line):
    """Positions behind the words of a line."""
    return [at + 1 for at, sign in enumerate(line) if not sign.isspace() and (line[at + 1 :][:1] or " ").isspace()]


def _knet_numbers(header, names, digits, ends):
    """The numbers of the one line of the header that begins with `names`; "(gal)/" stands between two."""
    found = []
    for line in header:
        rest = line.lower()
        good = rest.startswith(names[0])
        rest = rest[len(names[0]) :].lstrip(" ")
        good, rest = good and rest.startswith(names[1]), rest[len(names[1]) :].lstrip(" ")
        numbers = []
        for k, most in enumerate(digits):
            if k:
                good = good and rest.lstrip(" ").startswith("(gal)")
                rest = rest.lstrip(" ").removeprefix("(gal)").lstrip(" ")
                good, rest = good and rest[:1] == "/", rest[1:].lstrip(" ")
            whole = _leading(rest, most)
            decimals = whole and whole[1][:1] == "." and _leading(whole[1][1:], 400)
            if not whole:
                good = False
                break
            text = rest[: len(rest) - len(whole[1])]
            rest = whole[1]
            if rest[:1] == ".":
                tail = decimals[1] if decimals else rest[1:]
                text, rest = text + rest[: len(rest) - len(tail)], tail
            numbers.append(single(text))
        if good and rest.strip(" ") in ends:
            found.append(numbers)
    if len(found) != 1:
        raise Refused("header")
    return found[0]


def smc(lines):
    begin = next(at for at, line in enumerate(lines) if line.strip())
    words = lines[begin][:400].lower().split()
    kinds = [word for word in words[1:3] if word not in ("corrected", "uncorrected")]
    if not words or len(words[0]) != 1 or words[0] not in DIGITS or not kinds:
        return None
    if not any(starts(kinds[0], kind) for kind in ("accelerogram", "velocity", "displacement", "response")):
        return None
    if starts(kinds[0], "response") and words[2:3] != ["spectra"]:
        return None
    if not starts(kinds[0], "accelerogram"):
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


def by_name(lines, content):
    """Whether the file is of a format that is known and not read."""
    begin = next(at for at, line in enumerate(lines) if line.strip())
    top = [line[:200].lower().strip() for line in lines[begin : begin + 12]]
    first = top[0]
    words = "".join(sign if sign.isalnum() or sign == "_" else " " for sign in first.partition("(")[0]).split()
    geonet = first.removeprefix("un")
    digits = geonet.removeprefix("corrected accelerogram")
    name = digits.lstrip()
    return (
        (
            geonet != digits
            and name != digits
            and len(name) >= 16
            and all(sign in DIGITS for sign in name[:8] + name[9:15])
            and name[8] + name[15] == "__"
        )
        or starts(first, "uncorrected accelerogram")
        or (
            words[:1] in (["response"], ["fourier"])
            and first.startswith(words[0])
            and ("spectra" in words or "spectrum" in words)
            and "(format" not in first
        )
        or (starts(first, "raw acceleration counts") and "(format" in first)
        or any(fold(flat(line)).startswith("archivo estandar de aceleracion") for line in top)
        or starts(first.removeprefix("*").lstrip(), "vol1ds file")
        or starts(first.removeprefix("*").lstrip(), "vol2ds file")
        or (
            words[:1] == ["timeseries"]
            and first.startswith("timeseries")
            and "slist" in first.replace(",", " ").split()
        )
        or first.startswith("# dataset: geocsv")
        or (content[:6].isdigit() and content[6:7] in (b"D", b"R", b"Q", b"M") and content[7:8] in (b" ", b"\0"))
        or content[:3] == b"MS\x03"
        or content[304:308] in (b"\6\0\0\0", b"\0\0\0\6")
    )
