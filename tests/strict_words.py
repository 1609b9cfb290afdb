"""Numbers and units for the second reader of records (`strict_records`), which says what it is for."""

import re
import unicodedata
from collections import Counter
from fractions import Fraction

G = Fraction("9.81")
LENGTHS = {
    "mm": Fraction(1, 1000),
    "cm": Fraction(1, 100),
    "m": Fraction(1),
    "in": Fraction("0.0254"),
    "ft": Fraction("0.3048"),
}
TIME_WORDS = dict.fromkeys(
    "s sec secs second seconds seg segundo segundos sek sekunde sekunden seconde secondes sn saniye".split(), 1
) | dict.fromkeys(
    "ms msec msecs millisec millisecs millisecond milliseconds milisegundo milisegundos millisekunde millisekunden"
    " milliseconde millisecondes milisaniye".split(),
    1000,
)
GIVEN = {
    "g": G,
    "m/s2": Fraction(1),
    "cm/s2": Fraction(1, 100),
    "gal": Fraction(1, 100),
    "mm/s2": Fraction(1, 1000),
    "%g": G / 100,
}
DIGITS = "0123456789"
QUANTITIES = dict.fromkeys(
    "acc accel acceleration accelerations accelerogram pga aceleracion aceleraciones beschleunigung beschleunigungen"
    " ivme".split(),
    "acceleration",
) | dict.fromkeys(
    "velocity vel displacement disp velocidad velocidades desplazamiento desplazamientos geschwindigkeit"
    " geschwindigkeiten verschiebung verschiebungen vitesse vitesses deplacement deplacements".split(),
    "other",
)
UNIT_WORDS = ("unit", "units", "unites", "unidad", "unidades", "einheit", "einheiten", "birim", "birimi")


class Refused(Exception):
    """Not surely a record."""


# Numbers

NUMBER = re.compile(r"[+-]?(?=\.?[0-9])[0-9]*(\.[0-9]*)?(?:[EeDd][+-]?([0-9]{1,3}))?")


def scan(text, i):
    """(value, digits after the point or None, digits of the exponent, next i) of the number at i; None without one."""
    found = NUMBER.match(text, i)
    if not found or len(found[0]) > 100:
        return None
    value = Fraction(found[0].lower().replace("d", "e"))
    if abs(value) >= 2 * Fraction(10) ** 308:
        return None
    return value, found[1] and len(found[1]) - 1, len(found[2] or ""), found.end()


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
    for token in " ".join(lines).split():
        i = 0
        while i < len(token):
            found = scan(token, i)
            if found is None or (i and (token[i] not in "+-" or found[1] is None)):
                raise Refused(f"number {token[:40]}")
            values.append(found[0])
            parts.append(token[i : found[3]])
            i = found[3]
    forms = [form_of(part) for part in parts]
    counts = Counter(forms)
    usual = max(counts, key=counts.get, default=None)
    for part, form in zip(parts, forms, strict=True):
        small = re.search("[ed]-[1-9]", part.lower())
        if form != usual and not (form and usual and usual[1] == 2 and form == (usual[0], 3, usual[2]) and small):
            raise Refused(f"form of {part}")
    lengths = [len(line.rstrip()) for line in [line for line in lines if line.strip()][:-1] if len(line.split()) > 1]
    if len(lengths) > 2 and len(set(lengths)) == 2 and 1 in Counter(lengths).values():
        raise Refused("length of a line")
    return values


def whole(token):
    if not re.fullmatch("[0-9]{1,9}", token):
        raise Refused("count")
    return int(token)


def step_of(token, behind=""):
    """Seconds in a token as .02, 10ms or .02 SEC."""
    found = scan(token, 0)
    if found is None:
        raise Refused("step")
    word = token[found[3] :].lower() or behind.lower()
    if (word and word not in TIME_WORDS) or found[0] <= 0:
        raise Refused("step")
    return found[0] / TIME_WORDS.get(word, 1)


# Units


SQUARED = [f"/{time}{power}" for time in ("s", "sec") for power in ("2", "^2", "**2", "²", "/s", "/sec")]
# Every spelling of an acceleration that is known, in lower case, with its factor to m/s2.
KNOWN = GIVEN | {"g's": G, "gravity": G, "mg": G / 1000, "gals": Fraction(1, 100), "mgal": Fraction(1, 100_000)}
KNOWN |= {length + power: LENGTHS[length] for length in LENGTHS for power in ("/ss", "/s*s", "/s.s", *SQUARED)}
RATES = {f"{length}{rate}" for length in LENGTHS for rate in ("/s", "/sec")}


def words_of(line):
    """Words of a header line in lower case; brackets, colons, equals signs, commas and semicolons are words."""
    return [word for word, _ in glued_words(line)]


def glued_words(line):
    """[(word, sign behind it)] of the words of `words_of`."""
    text = line.lower() + " "
    return [(word[0], text[word.end()]) for word in re.finditer(r"[()\[\]:=,;]|[^\s()\[\]:=,;]+", text)]


def stem_of(word):
    """The word without the signs before it."""
    return re.sub("^[^a-z0-9_]+", "", word)


def ends_of(word):
    return word.rstrip(".'\"")


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
    return {KNOWN[unit] for unit in re.findall(r"(?<=[^\W_])_(mgal|gal|mg|g)(?![^\W_])", flat)}


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
        named = {QUANTITIES[part] for part in re.findall("[a-z]+", plain(line[:400])) if part in QUANTITIES}
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
                if (
                    words[i : i + 3] == ["de", "los", "datos"]
                    or bare in TIME_WORDS
                    or not (re.match("[a-z%]", bare) or words[i - 1] == "of")
                ):
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
