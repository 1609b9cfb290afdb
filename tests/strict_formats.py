"""The formats of observatories for the second reader of records (`strict_records`), which says what it is for.

Each function takes the lines of a file and gives its channels, [(number, direction, step, samples, factor)], or None
if the file is not of its format.
"""

from fractions import Fraction

from strict_words import DIGITS, LETTERS, Refused, scan, single, step_of, unit_of


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
        if good and all(len(part) < 3 for part in kept) and kept[0][0] in DIGITS[1:] and kept[1][0] in DIGITS[1:]:
            found = int(kept[0]), int(kept[1]), int(kept[3])
    return found


def columns_of(lines, at, count, layout):
    """(values, index of the line behind) of `count` numbers in columns of equal width."""
    per_line, width, decimals = layout
    values = []
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
