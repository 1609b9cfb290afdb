"""Steps stated in headers, for the second reader of records (`strict_records`), which says what it is for."""

import re
import unicodedata
from fractions import Fraction
from itertools import product

from strict_words import TIME_WORDS, Refused, scan

GAP = ("", " ", "-", " -")
SAMPLING_FR = (" dechantillonnage", " d?echantillonnage")  # ?: any sign


def _spelled(*parts):
    return {"".join(words) for words in product(*parts)}


RATE_KEYS = {"fs", "sampled at"}.union(
    _spelled(
        ("sample", "sampling", "digitizing", "digitising", "digitization", "digitisation"),
        GAP,
        ("rate", "freq", "frequency"),
    ),
    _spelled(("tasa", "frecuencia", "velocidad"), (" de muestreo",)),
    _spelled(("abtast", "sampling"), GAP, ("rate", "frequenz")),
    _spelled(("frequence", "taux", "cadence"), SAMPLING_FR),
    _spelled(("ornekleme ",), ("frekansi", "hizi", "orani")),
)
INTERVAL_KEYS = {"dt", "interval of", "intervals of"}.union(
    _spelled(("delta",), GAP, ("t",)),
    _spelled(("equally",), GAP, ("spaced at",)),
    _spelled(("sample", "sampling"), GAP, ("interval", "period", "step", "time", "spacing")),
    _spelled(("time",), GAP, ("step", "interval", "increment", "spacing")),
    _spelled(("intervalo", "periodo", "paso"), (" de muestreo", " de tiempo")),
    _spelled(("abtast", "zeit"), GAP, ("intervall", "periode", "zeit", "schritt", "schrittweite", "inkrement")),
    _spelled(("pas", "intervalle", "periode"), (" de temps", *SAMPLING_FR)),
    _spelled(("ornekleme", "zaman"), (" araligi", " periyodu", " adimi")),
)
PER_SECOND = {"sps"}.union(
    _spelled(
        ("sample", "muestra", "abtastwert", "wert", "echantillon", "ornek", "point"),
        ("", "s", "e"),
        ("/", " per ", " por ", " pro ", " par "),
        ("s", "sec", "second", "segundo", "sekunde", "seconde", "saniye"),
    )
)
RATES = PER_SECOND | {"hz", "hertz", "1/s", "1/sec"}


def _one_of(words):
    """A pattern of any of the words, the longest first."""
    return "|".join(re.escape(word).replace(r"\?", ".") for word in sorted(words, key=len, reverse=True))


LETTER = r"[^\W\d_]"
KEY = re.compile(f"(?<!{LETTER})(?:{_one_of(RATE_KEYS | INTERVAL_KEYS)})(?!{LETTER})")
RATE_KEY = re.compile(_one_of(RATE_KEYS))
UNIT = re.compile(f"(?:{_one_of(RATES)}|[a-zµ]*)(?!{LETTER})")
DECIMAL_COMMA = re.compile("[0-9]+,([0-9]+)")
LARGE = re.compile(r"[+-]?\.?[0-9][0-9.]*(?:[ed][+-]?[0-9]+)?")
GOES_ON = re.compile("[.,]?[0-9]")
OPENED, SAID = re.compile(r" ?[(\[]? ?"), re.compile(r" ?[)\]]? ?([:=]|is|of|at)? ?")
SAMPLES = re.compile("[0-9.,ed+-]*")


def flat(line):
    """The first 400 signs of a line, with single blanks, composed."""
    return unicodedata.normalize("NFC", " ".join(line[:400].split()))


def fold(text):
    """As many signs as the text has: lower case, without accents, blanks for low lines."""
    plain = "".join(unicodedata.normalize("NFD", sign.lower()[:1])[:1] for sign in text)
    return plain.replace("ı", "i").replace("_", " ")


def blanked(lines):
    """(statements, lines without them) of lines of a header: [(is a rate, step [s], half a printed unit [s])]."""
    statements, kept = [], []
    for line in lines:
        line = flat(line)
        text, i = fold(line), 0
        while i < len(text):
            key = KEY.match(text, i)
            found = _stated(text, i, key.end()) if key else _alone(text, i)
            end = found[1] if found else key.end() if key else i + 1
            if found:
                statements.append(found[0])
                line = line[:i] + " " * (end - i) + line[end:]
            i = end
        kept.append(line)
    return statements, kept


def step_of_all(statements):
    """The step [s] that statements agree on, None without any."""
    rates = [step for is_rate, step, _ in statements if is_rate]
    if not statements:
        return None
    step = rates[0] if rates else statements[0][1]
    for is_rate, other, half in statements:
        room = half if rates and not is_rate else 0
        if abs(other - step) > room + step / 10**6:
            raise Refused("two steps")
    if not Fraction(1, 10**7) <= step <= 1000:
        raise Refused("step")
    return step


def _word(text, i):
    """A unit of rates or a word of letters at i, "" without one."""
    found = UNIT.match(text, i)
    return found[0] if found else ""


def _number(text, i):
    """(value, unit of its last digit, next i) of a number or one with a decimal comma at i; None without one."""
    found, large, comma = scan(text, i), LARGE.match(text, i), DECIMAL_COMMA.match(text, i)
    if found and not GOES_ON.match(text, found[3]):
        power = text[i : found[3]].replace("d", "e").partition("e")[2]
        return found[0], Fraction(10) ** (int(power or 0) - (found[1] or 0)), found[3]
    if not found and large and not GOES_ON.match(text, large.end()):
        return None, Fraction(1), large.end()
    if not comma or len(comma[0]) > 100 or GOES_ON.match(text, comma.end()):
        return None
    return Fraction(comma[0].replace(",", ".")), Fraction(1, 10 ** len(comma[1])), comma.end()


def _sure(text, i, end):
    """Refuses a number too large, or a decimal comma that may part thousands or has an exponent behind it."""
    if "," not in text[i:end] and not scan(text, i):
        raise Refused("not finite")
    whole, comma, decimals = text[i:end].partition(",")
    if comma and (len(decimals) == 3 and whole[0] != "0" or re.match("[ed][0-9+-]", text[end:])):
        raise Refused("thousands, or an exponent behind a decimal comma")


def _value(text, i):
    """(value, unit of its last digit, word behind, next i) of a number with what may stand behind it."""
    found = _number(text, i)
    if not found:
        return None
    at = found[2]
    after = at + (text[at : at + 1] == " ")
    inside = after + (text[after : after + 1] in ("(", "["))
    for begin in (inside + (text[inside : inside + 1] == " "), inside, after):
        word = _word(text, begin)
        if word:
            return *found[:2], word, begin + len(word)
    if text[after : after + 1] not in ("", ",", ";", "|", ")", "]"):
        return None
    return *found[:2], "", after


def _stated(text, begin, key_end):
    """(statement, where it ends) of what stands behind the key from begin to its end; None if it states nothing."""
    i = OPENED.match(text, key_end).end()
    before = _word(text, i)
    before = "" if before in ("is", "of", "at") else before
    says = SAID.match(text, i + len(before))
    i = says.end()
    found = _value(text, i)
    if not found or (before and not _known(before) and not found[2]):
        if says[1] in (":", "="):
            raise Refused("no number")
        return None
    _sure(text, i, _number(text, i)[2])
    value, last, behind, end = found
    unit = behind if _known(behind) else before if _known(before) else ""
    if behind and not unit:
        raise Refused("unit of a step")
    is_rate = unit in RATES if unit else bool(RATE_KEY.fullmatch(text, begin, key_end))
    if is_rate and not unit and value < 1:
        raise Refused("rate below 1")
    return _meant(is_rate, value, last, TIME_WORDS.get(unit, 1)), end


def _meant(is_rate, value, last, per_second):
    if value <= 0:
        raise Refused("step")
    return (True, 1 / value, 0) if is_rate else (False, value / per_second, last / 2 / per_second)


def _known(word):
    return word in TIME_WORDS or word in RATES


def _alone(text, i):
    """A number of samples a second that begins at i."""
    within = re.search("[0-9+-]$|[0-9][.,ed]$", text[:i]) if text[i] not in "+-" else None
    if within or not re.match("[0-9.+-]", text[i]):
        return None
    found = _number(text, i)
    end = found[2] if found else SAMPLES.match(text, i).end()
    begin, end = end, end + (text[end : end + 1] == " ")
    word = _word(text, end)
    if word not in PER_SECOND or not re.match("[0-9.]", text[begin - 1]):
        return None
    if not found:
        if not re.search("[0-9]", text[i:begin]):
            return None
        raise Refused("no number of samples a second")
    _sure(text, i, begin)
    return _meant(True, found[0], found[1], 1), end + len(word)
