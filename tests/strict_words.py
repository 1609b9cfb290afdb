"""Numbers and units for the second reader of records (`strict_records`), which says what it is for."""

import re
import unicodedata
from collections import Counter
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise

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


REFUSED = ValueError, LookupError  # what the second readers raise


def need(condition):
    """Refuses what is not surely a record."""
    if not condition:
        raise ValueError


# Numbers

NUMBER = re.compile(r"[+-]?(?=\.?[0-9])[0-9]*(?:\.[0-9]*)?(?:[EeDd][+-]?[0-9]{1,3})?")
FORM = re.compile(r"[+-]?([0-9]*)\.([0-9]*)(?:[EeDd][+-]?([0-9]+))?")
LARGEST = 2 * Fraction(10) ** 308


def single(token):
    """The value of a token that is one number and nothing else."""
    need(len(token) <= 100 and NUMBER.fullmatch(token))
    value = Fraction(token.lower().replace("d", "e"))
    need(abs(value) < LARGEST)
    return value


def printed(token):
    """(digits, power of ten of the last one) of a number, its leading zeros left out."""
    _, digits, exponent = Decimal(token.lower().replace("d", "e")).as_tuple()
    return len(digits), exponent


def form_of(token):
    """None of a number without a point, else (decimals, digits of the exponent, several digits before the point)."""
    found = FORM.fullmatch(token)
    return found and (len(found[2]), len(found[3] or ""), bool(found[3]) and len(found[1]) > 1)


def fortran(lines):
    """The values of all lines, of one form: parted by blanks, or stuck together by their signs."""
    stuck = [re.split("(?<=[0-9.])(?=[+-])", token) for token in " ".join(lines).split()]
    need(all("." in part for parts in stuck for part in parts[1:]))
    parts = [part for parts in stuck for part in parts]
    values = [single(part) for part in parts]
    forms = Counter(map(form_of, parts))
    usual = max(forms, key=forms.get, default=None)
    tiny = usual and (usual[0], 3, usual[2]) if usual and usual[1] == 2 else usual  # 1.2E-105 among 1.2E-05
    small = re.compile("[ed]-[1-9]")
    need(all(form_of(part) == usual or form_of(part) == tiny and small.search(part.lower()) for part in parts))
    lengths = Counter(len(line.rstrip()) for line in [line for line in lines if line.strip()][:-1] if line.split()[1:])
    need(sum(lengths.values()) < 3 or len(lengths) != 2 or 1 not in lengths.values())
    return values


def whole(token):
    need(re.fullmatch("[0-9]{1,9}", token))
    return int(token)


def step_of(token, behind=""):
    """Seconds in a token as .02, 10ms or .02 SEC."""
    digits, word = re.fullmatch("(.*?)([a-z]*)", token.lower()).groups()
    value = single(digits)
    need(value > 0)
    return value / TIME_WORDS[word or behind.lower() or "s"]


def uniform(tokens):
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


# Units

SQUARED = [f"/{time}{power}" for time in ("s", "sec") for power in ("2", "^2", "**2", "²", "/s", "/sec")]
# Every spelling of an acceleration that is known, in lower case, with its factor to m/s2.
KNOWN = GIVEN | {"g's": G, "gravity": G, "mg": G / 1000, "gals": Fraction(1, 100), "mgal": Fraction(1, 100_000)}
KNOWN |= {length + power: LENGTHS[length] for length in LENGTHS for power in ("/ss", "/s*s", "/s.s", *SQUARED)}
# A length over a squared time behind other letters or signs than those that part words is no unit that is known.
SQUARED_LENGTH = re.compile(r"([^\s,;:=(\[]*?)(?:mm|cm|m|in|ft)/s(?:ec)?(?:/s|(?:\^|\*\*)?[-{(]*[2²])")
APART = re.compile(r"""|.*[{<'"|]|.*[^\W_][_-]""")
RATES = {f"{length}{rate}" for length in LENGTHS for rate in ("/s", "/sec")}


OPENING, JOINING, SIGNS = ("(", "[", ":", "="), ("of", "in", "is", "are"), "()[]:=,;"
WORD = re.compile(r"[()\[\]:=,;]|[^\s()\[\]:=,;]+")
TWICE = re.compile(r"[(\[] *([^\s()\[\]:=,;]+) *[)\]][\s)\],;:]")


def words_of(line):
    """Words of a header line in lower case; brackets, colons, equals signs, commas and semicolons are words."""
    return WORD.findall(line.lower())


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


def introduces(words):
    """Whether the last of the words says that a unit follows."""
    return bool(words) and plain(stem_of(words[-1])).endswith(UNIT_WORDS)


def unit_of(lines, titles):
    """Factor of the unit that header lines state, None without one; `titles` is the index of the titles' line."""
    factors, quantities = set(), set()
    for index, line in enumerate(lines):
        named = {QUANTITIES[part] for part in re.findall("[a-z]+", plain(line[:400])) if part in QUANTITIES}
        quantities |= named
        text = " ".join(line[:400].replace('"', " ").split())
        for sign in ("/", "^", "**"):
            text = text.replace(f" {sign}", sign).replace(f"{sign} ", sign)
        text = f"{text.lower()} ".replace(" per ", "/")
        for word in SQUARED_LENGTH.finditer(text):
            need(
                re.match("[-+]?[.]?[0-9]", word[0])
                or APART.fullmatch(word[1])
                or (word[1] in "#!" and not word.start())
            )
        found = list(WORD.finditer(text))
        factors |= {_factor(text, found, i, bool(named) or index == titles) for i in range(len(found))}
        if index == titles:
            factors |= {KNOWN[unit] for unit in re.findall(r"(?<=[^\W_])_(mgal|gal|mg|g)(?![^\W_])", text)}
    factors -= {None}
    need(len(factors) < 2 and quantities != {"other"})
    return factors.pop() if factors else None


def _factor(text, found, i, named):
    """Factor of the unit that the word of index i in a line is, None of another word; `named`: units are expected."""
    words = [one[0] for one in found]
    word, before, behind = words[i], words[max(i - 7, 0) : i], words[i + 1 : i + 2]
    if word in SIGNS or (word == "in" and behind and behind[0] not in SIGNS):
        return None  # no inches
    last = before[-1] if before else ""
    last = before[-2] if last == "," and len(before) > 1 else last
    if before[-1:] and before[-1] in (",", ";", "and", "y", "und", "et", "ve") and set(before[-2:-1]) & {*TIME_WORDS}:
        del before[-2:]
    while before and before[-1] in OPENING:
        before.pop()
    if before[-3:] == ["de", "los", "datos"]:
        del before[-3:]
    stated = before[-1:] == ["in"] and named
    if before and before[-1] in JOINING and introduces(before[:-1]):
        before.pop()
    bare, glued = ends_of(word), TWICE.match(text, found[i].end())  # gal(cm/s/s), where both must be the same
    factor = KNOWN.get(bare)
    if text[found[i].end()] in "([":  # a name, as g[cm/s2]
        factor = factor if glued and KNOWN.get(ends_of(glued[1])) == factor else None
    tail = bare.rpartition("_")[2]
    if introduces(before) and word not in JOINING:
        dated = words[i : i + 3] == ["de", "los", "datos"]
        if dated or bare in TIME_WORDS or not (re.match("[a-z%]", bare) or last == "of"):
            return None
        need(factor)
    elif tail.partition("/")[0] in LENGTHS and "/" in tail and not word.endswith("/"):
        return None if re.search("[0-9.]$", last) else KNOWN[tail]
    elif stated or (named and last in ("(", "[")) or stem_of(ends_of(last)) in ("acc", "accel", "acceleration"):
        need(text[found[i].end()] in "([" or bare not in {*LENGTHS, *RATES})
    elif not (word in ("gal", "gals") and last in ("(", "[") and behind in ([")"], ["]"])):
        return None
    return factor
