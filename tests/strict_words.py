"""Numbers and units for the second reader of records (`strict_records`), which says what it is for."""

import unicodedata
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
TIME_WORDS |= dict.fromkeys("seg segundo segundos sek sekunde sekunden seconde secondes sn saniye".split(), 1)
TIME_WORDS |= dict.fromkeys(
    "milisegundo milisegundos millisekunde millisekunden milliseconde millisecondes milisaniye".split(), 1000
)
GIVEN = {
    "g": G,
    "m/s2": Fraction(1),
    "cm/s2": Fraction(1, 100),
    "gal": Fraction(1, 100),
    "mm/s2": Fraction(1, 1000),
    "%g": G / 100,
}
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
ACCELERATIONS = "pga aceleracion aceleraciones beschleunigung beschleunigungen ivme".split()
QUANTITIES |= dict.fromkeys(ACCELERATIONS, "acceleration")
QUANTITIES |= dict.fromkeys(
    "velocidad velocidades desplazamiento desplazamientos geschwindigkeit geschwindigkeiten verschiebung"
    " verschiebungen vitesse vitesses deplacement deplacements".split(),
    "other",
)
UNIT_WORDS = ("unit", "units", "unites", "unidad", "unidades", "einheit", "einheiten", "birim", "birimi")


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


def form_of(token):
    """None of a number without a point, else (decimals, digits of the exponent, several digits before the point)."""
    found = scan(token, 0)
    if found[1] is None:
        return None
    before = token.lstrip("+-").partition(".")[0]
    return found[1], found[2], found[2] > 0 and len(before) > 1


def fortran(lines):
    """The values of all lines, of one form: parted by blanks, or stuck together by their signs."""
    values, parts = [], []
    for line in lines:
        for token in line.split():
            i = 0
            while i < len(token):
                if i and token[i] not in "+-":
                    raise Refused(f"stuck {token[:40]}")
                found = scan(token, i)
                if found is None or (i and found[1] is None):
                    raise Refused(f"number {token[:40]}")
                values.append(found[0])
                parts.append(token[i : found[3]])
                i = found[3]
    forms = [form_of(part) for part in parts]
    counts = {}
    for form in forms:
        counts[form] = counts.get(form, 0) + 1
    usual = next((form for form in counts if counts[form] == max(counts.values())), None)
    for part, form in zip(parts, forms, strict=True):
        exponent = part.lower().replace("d", "e").partition("e")[2]
        small = exponent[:1] == "-" and exponent[1:2] != "0"
        if form != usual and not (form and usual and usual[1] == 2 and form == (usual[0], 3, usual[2]) and small):
            raise Refused(f"form of {part}")
    lengths = [len(line.rstrip()) for line in [line for line in lines if line.strip()][:-1] if len(line.split()) > 1]
    if len(set(lengths)) == 2 and len(lengths) > 2 and 1 in [lengths.count(length) for length in lengths]:
        raise Refused("length of a line")
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
    return [word for word, _ in glued_words(line)]


def glued_words(line):
    """[(word, sign behind it)] of the words of `words_of`."""
    words, word = [], ""
    for sign in line.lower() + " ":
        if sign.isspace() or sign in "()[]:=,;":
            words += [(word, sign)] if word else []
            word = ""
            if words and words[-1][1] is None:
                words[-1] = (words[-1][0], sign)
            words += [] if sign.isspace() else [(sign, None)]
        else:
            if not word and words and words[-1][1] is None:
                words[-1] = (words[-1][0], sign)
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


def letter(sign):
    """Whether the sign is one of words: no digit, but ³ or ½."""
    return sign.isalnum() and not sign.isdecimal()


def plain(text):
    """The text in lower case, without accents."""
    return "".join(unicodedata.normalize("NFD", sign.lower()[:1])[:1] for sign in text).replace("ı", "i")


def introduces(word):
    return plain(stem_of(word)).endswith(UNIT_WORDS)


def _bracketed(words, i):
    """Factor of a unit that is said twice, as gal(cm/s/s); None of another."""
    bare = ends_of(words[i][0])
    inside = words[i + 2 : i + 4]
    if len(inside) < 2 or inside[1][0] not in ")]" or not (inside[1][1].isspace() or inside[1][1] in ")],;:"):
        return None
    if bare in KNOWN and KNOWN.get(ends_of(inside[0][0])) == KNOWN[bare]:
        return KNOWN[bare]
    return None


def _low_lines(flat):
    """Factors of units behind low lines in a line of titles: NS_gal."""
    factors = set()
    for at, sign in enumerate(flat):
        end = at + 1
        while flat[end : end + 1] and flat[end] in LETTERS:
            end += 1
        unit = flat[at + 1 : end] if sign == "_" and flat[at - 1 : at].isalnum() else ""
        if unit in ("gal", "g", "mg", "mgal") and not flat[end : end + 1].isalnum():
            factors.add(KNOWN[unit])
    return factors


def unit_of(lines, titles):
    """Factor of the unit that header lines state, None without one; `titles` is the index of the titles' line."""
    factors, quantities = set(), set()
    for index, line in enumerate(lines):
        flat = " ".join(line[:400].replace('"', " ").split())
        for sign in ("/", "^", "**"):
            flat = flat.replace(f" {sign}", sign).replace(f"{sign} ", sign)
        flat = f"{flat.lower()} ".replace(" per ", "/")
        pairs = glued_words(flat)
        words = [word for word, _ in pairs]
        parts = "".join(sign if sign in LETTERS else " " for sign in plain(line[:400])).split()
        named = {QUANTITIES[part] for part in parts if part in QUANTITIES}
        quantities |= named
        for i, word in enumerate(words):
            before = words[max(i - 7, 0) : i]
            stated = False
            while before and before[-1] in ("(", "[", ":", "="):
                before = before[:-1]
            if before[-3:] == ["de", "los", "datos"]:
                before = before[:-3]
            if before and before[-1] in ("of", "in", "is", "are"):
                stated = before[-1] == "in" and (named or index == titles)
                before = before[:-1] if before[:-1] and introduces(before[-2]) else before
            bare = ends_of(word)
            glued = pairs[i][1] in ("(", "[")  # a name: g[cm/s2]
            tail = bare.rpartition("_")[2]
            if word == "in" and words[i + 1 : i + 2] and words[i + 1] not in "()[]:=,;":
                continue  # no inches
            if before and introduces(before[-1]) and word not in "()[]:=,;" and word not in ("of", "in", "is", "are"):
                if words[i : i + 3] == ["de", "los", "datos"]:
                    continue
                if bare in TIME_WORDS:
                    continue
                if not bare or bare[0] not in LETTERS + "%":
                    if words[i - 1] == "of":
                        raise Refused(f"unit {word}")
                    continue
                factor = _bracketed(pairs, i) if glued else KNOWN.get(bare)
                if factor is None:
                    raise Refused(f"unit {word}")
                factors.add(factor)
            elif tail.partition("/")[0] in LENGTHS and "/" in tail and not word.endswith("/"):
                if i and words[i - 1][-1] in DIGITS + ".":
                    continue
                if tail not in KNOWN:
                    raise Refused(f"unit {word}")
                factors.add(KNOWN[tail])
            elif (
                stated
                or ((named or index == titles) and i and words[i - 1] in ("(", "["))
                or (i and stem_of(ends_of(words[i - 1])) in ("acc", "accel", "acceleration"))
            ):
                if (bare in LENGTHS or bare in RATES) and not glued:
                    raise Refused(f"unit {word}")
                factor = _bracketed(pairs, i) if glued else KNOWN.get(bare)
                if factor is not None:
                    factors.add(factor)
            elif (
                word in ("gal", "gals") and i and words[i - 1] in ("(", "[") and words[i + 1 : i + 2] in ([")"], ["]"])
            ):
                factors.add(KNOWN[word])
        factors |= _low_lines(flat) if index == titles else set()
    if len(factors) > 1:
        raise Refused("two units")
    if quantities == {"other"}:
        raise Refused("no acceleration")
    return factors.pop() if factors else None
