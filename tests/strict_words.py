"""Numbers and units for the second reader of records (`strict_records`), which says what it is for."""

from fractions import Fraction

G = Fraction("9.81")
LENGTHS = {
    "mm": Fraction(1, 1000),
    "cm": Fraction(1, 100),
    "m": Fraction(1),
    "in": Fraction("0.0254"),
    "ft": Fraction("0.3048"),
}
TIME_WORDS = {
    "s": 1,
    "sec": 1,
    "secs": 1,
    "second": 1,
    "seconds": 1,
    "ms": 1000,
    "msec": 1000,
    "msecs": 1000,
    "millisec": 1000,
    "millisecs": 1000,
    "millisecond": 1000,
    "milliseconds": 1000,
}
GIVEN = {"g": G, "m/s2": Fraction(1), "cm/s2": Fraction(1, 100)}
DIGITS, LETTERS = "0123456789", "abcdefghijklmnopqrstuvwxyz"
QUANTITIES = {
    "acc": "acceleration",
    "accel": "acceleration",
    "acceleration": "acceleration",
    "accelerations": "acceleration",
    "accelerogram": "acceleration",
    "velocity": "other",
    "vel": "other",
    "displacement": "other",
    "disp": "other",
}


class Refused(Exception):
    """Not surely a record."""


# Numbers


def scan(text, i):
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


def single(token):
    """The value of a token that is one number and nothing else."""
    found = scan(token, 0)
    if found is None or found[3] != len(token):
        raise Refused(f"number {token[:40]}")
    return found[0]


def fortran(lines):
    """The values of all lines: parted by blanks, or stuck together by their signs in one format."""
    values, exponents = [], []
    for at, line in enumerate(lines):
        for token in line.split():
            i, forms = 0, []
            while i < len(token):
                if i and token[i] not in "+-":
                    raise Refused(f"stuck {token[:40]}")
                found = scan(token, i)
                if found is None:
                    raise Refused(f"number {token[:40]}")
                values.append(found[0])
                forms.append(found[1:3])
                if found[2]:
                    digits = token[i : found[3]].lower().replace("d", "e").split("e")[1].lstrip("+-")
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


def whole(token):
    if not token or len(token) > 9 or any(sign not in DIGITS for sign in token):
        raise Refused("count")
    return int(token)


def step_of(token, behind=""):
    """Seconds in a token as .02, 10ms or .02 SEC."""
    found = scan(token, 0)
    if found is None:
        raise Refused("step")
    glued = token[found[3] :].lower()
    word = glued or behind.lower()
    if any(sign not in LETTERS for sign in glued) or (word and word not in TIME_WORDS) or found[0] <= 0:
        raise Refused("step")
    return found[0] / TIME_WORDS.get(word, 1)


# Units


def _known_units():
    """Every spelling of an acceleration this parser knows, in lower case, with its factor to m/s2."""
    known = {
        "g": G,
        "g's": G,
        "gravity": G,
        "mg": G / 1000,
        "%g": G / 100,
        "gal": Fraction(1, 100),
        "gals": Fraction(1, 100),
        "mgal": Fraction(1, 100_000),
    }
    for length, factor in LENGTHS.items():
        known |= {f"{length}/{power}": factor for power in ("ss", "s*s", "s.s")}
        for time in ("s", "sec"):
            for power in (
                f"/{time}2",
                f"/{time}^2",
                f"/{time}**2",
                f"/{time}*2",
                f"/{time}²",
                f"/{time}/s",
                f"/{time}/sec",
                f"/{time}^",
                f"/{time}*",
            ):
                if power[-1] not in "^*":
                    known[length + power] = factor
    return known


KNOWN = _known_units()
RATES = {f"{length}{rate}" for length in LENGTHS for rate in ("/s", "/sec")}


def words_of(line):
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


def stem_of(word):
    """The word without the signs before it."""
    while word and not (word[0] in LETTERS or word[0] in DIGITS or word[0] == "_"):
        word = word[1:]
    return word


def ends_of(word):
    while word and word[-1] in ".'\"":
        word = word[:-1]
    return word


def unit_of(lines, titles):
    """Factor of the unit that header lines state, None without one; `titles` is the index of the titles' line."""
    factors, quantities = set(), set()
    for index, line in enumerate(lines):
        flat = " ".join(line[:400].replace('"', " ").split())
        for sign in ("/", "^", "**"):
            flat = flat.replace(f" {sign}", sign).replace(f"{sign} ", sign)
        words = words_of(flat)
        parts = "".join(sign if sign in LETTERS else " " for sign in line[:400].lower()).split()
        named = {QUANTITIES[part] for part in parts if part in QUANTITIES}
        quantities |= named
        for i, word in enumerate(words):
            before = words[max(i - 4, 0) : i]
            stated = False
            while before and before[-1] in ("(", "[", ":", "="):
                before = before[:-1]
            if before and before[-1] in ("of", "in", "is", "are"):
                stated = before[-1] == "in" and (named or index == titles)
                before = before[:-1] if before[:-1] and stem_of(before[-2]) in ("unit", "units") else before
            bare = ends_of(word)
            glued = f"{word}(" in flat.lower() or f"{word}[" in flat.lower()  # a name: g[cm/s2]
            if (
                before
                and stem_of(before[-1]) in ("unit", "units")
                and word not in "()[]:=,;"
                and word not in ("of", "in", "is", "are")
            ):
                if bare in TIME_WORDS:
                    continue
                if not bare or bare[0] not in LETTERS + "%":
                    continue
                if bare not in KNOWN:
                    raise Refused(f"unit {word}")
                factors.add(KNOWN[bare])
            elif "/" in word and word[: word.index("/")] in LENGTHS and not word.endswith("/"):
                if i and words[i - 1][-1] in DIGITS + ".":
                    continue
                if bare not in KNOWN:
                    raise Refused(f"unit {word}")
                factors.add(KNOWN[bare])
            elif (
                stated
                or ((named or index == titles) and i and words[i - 1] in ("(", "["))
                or (i and ends_of(words[i - 1]) in ("acc", "accel", "acceleration"))
            ):
                if (bare in LENGTHS or bare in RATES) and not glued:
                    raise Refused(f"unit {word}")
                if bare in KNOWN and not glued:
                    factors.add(KNOWN[bare])
    if len(factors) > 1:
        raise Refused("two units")
    if quantities == {"other"}:
        raise Refused("no acceleration")
    return factors.pop() if factors else None
