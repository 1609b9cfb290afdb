"""Steps stated in headers, for the second reader of records (`strict_records`), which says what it is for."""

import unicodedata
from fractions import Fraction
from itertools import product

from strict_words import DIGITS, LETTERS, TIME_WORDS, Refused, letter, scan

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
KEYS = sorted(RATE_KEYS | INTERVAL_KEYS, key=len, reverse=True)
PER_SECOND = {"sps"}.union(
    _spelled(
        ("sample", "muestra", "abtastwert", "wert", "echantillon", "ornek", "point"),
        ("", "s", "e"),
        ("/", " per ", " por ", " pro ", " par "),
        ("s", "sec", "second", "segundo", "sekunde", "seconde", "saniye"),
    )
)
RATES_LONGEST = sorted(PER_SECOND | {"hz", "hertz", "1/s", "1/sec"}, key=len, reverse=True)


def flat(line):
    """The first 400 signs of a line, with single blanks, composed."""
    return unicodedata.normalize("NFC", " ".join(line[:400].split()))


def fold(text):
    """As many signs as the text has: lower case, without accents, blanks for low lines."""
    folded = ""
    for sign in text:
        sign = unicodedata.normalize("NFD", sign.lower()[:1])[:1]
        folded += {"ı": "i", "_": " "}.get(sign, sign)
    return folded


def blanked(lines):
    """(statements, lines without them) of lines of a header: [(is a rate, step [s], half a printed unit [s])]."""
    statements, kept = [], []
    for line in lines:
        line = flat(line)
        text, i = fold(line), 0
        while i < len(text):
            end = _key_end(text, i)
            if end:
                found = _stated(text, i, end)
            else:
                found = _alone(text, i)
            if found:
                statements.append(found[0])
                line = line[:i] + " " * (found[1] - i) + line[found[1] :]
            i = found[1] if found else end or i + 1
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


def _key_end(text, i):
    """Where the longest key at i ends; None without one."""
    if i and letter(text[i - 1]):
        return None
    for key in KEYS:
        piece = text[i : i + len(key)]
        if key[0] == piece[:1] and len(piece) == len(key):
            like = all(wanted in (sign, "?") for wanted, sign in zip(key, piece, strict=True))
            if like and not letter(text[i + len(key) : i + len(key) + 1]):
                return i + len(key)
    return None


def _word(text, i):
    """A unit of rates or a word of letters at i, "" without one."""
    for unit in RATES_LONGEST:
        if text.startswith(unit, i) and not letter(text[i + len(unit) : i + len(unit) + 1]):
            return unit
    end = i
    while text[end : end + 1] and (text[end] in LETTERS or text[end] == "µ"):
        end += 1
    return "" if letter(text[end : end + 1]) else text[i:end]


def _number(text, i):
    """(value, unit of its last digit, next i) of a number or one with a decimal comma at i; None without one."""
    found, comma = scan(text, i), i
    if found and not _goes_on(text, found[3]):
        exponent = 0
        if found[2]:
            mantissa, _, power = text[i : found[3]].replace("d", "e").partition("e")
            exponent = int(power)
        return found[0], Fraction(10) ** (exponent - (found[1] or 0)), found[3]
    end = _large(text, i)
    if not found and end and not _goes_on(text, end):
        return None, Fraction(1), end
    while text[comma : comma + 1] and text[comma] in DIGITS:
        comma += 1
    end = comma + 1
    while text[end : end + 1] and text[end] in DIGITS:
        end += 1
    decimals = end - comma - 1
    if comma == i or text[comma : comma + 1] != "," or not decimals or _goes_on(text, end) or end - i > 100:
        return None
    return Fraction(int(text[i:comma] + text[comma + 1 : end]), 10**decimals), Fraction(1, 10**decimals), end


def _large(text, i):
    """Where a number at i that is too long or too large for `scan` ends; 0 without one."""
    start = i + (text[i : i + 1] in ("+", "-"))
    start += text[start : start + 1] == "."
    if text[start : start + 1] not in tuple(DIGITS):
        return 0
    while text[start : start + 1] and text[start] in DIGITS + ".":
        start += 1
    power = start + 1 + (text[start + 1 : start + 2] in ("+", "-"))
    if text[start : start + 1] in ("e", "d") and text[power : power + 1] in tuple(DIGITS):
        start = power
        while text[start : start + 1] and text[start] in DIGITS:
            start += 1
    return start


def _sure(text, i, end):
    """Refuses a number too large, or a decimal comma that may part thousands or has an exponent behind it."""
    if "," not in text[i:end] and not scan(text, i):
        raise Refused("not finite")
    whole, comma, decimals = text[i:end].partition(",")
    if comma and len(decimals) == 3 and whole[0] != "0":
        raise Refused("thousands")
    if comma and text[end : end + 1] in ("e", "d") and text[end + 1 : end + 2] in (*DIGITS, "+", "-"):
        raise Refused("exponent behind a decimal comma")


def _goes_on(text, end):
    digits = tuple(DIGITS)
    return text[end : end + 1] in digits or (text[end : end + 1] in (".", ",") and text[end + 1 : end + 2] in digits)


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


def _stated(text, begin, i):
    """(statement, where it ends) of what stands behind the key from begin to i; None if it states nothing."""
    key_end = i
    i += text[i : i + 1] == " "
    i += text[i : i + 1] in ("(", "[")
    i += text[i : i + 1] == " "
    before = _word(text, i)
    before = "" if before in ("is", "of", "at") else before
    i += len(before)
    i += text[i : i + 1] == " "
    i += text[i : i + 1] in (")", "]")
    i += text[i : i + 1] == " "
    sign = text[i : i + 1] if text[i : i + 1] in (":", "=") else ""
    sign = text[i : i + 2] if text[i : i + 2] in ("is", "of", "at") else sign
    i += len(sign)
    i += text[i : i + 1] == " "
    found = _value(text, i)
    if not found or (before and not _known(before) and not found[2]):
        if sign in (":", "="):
            raise Refused("no number")
        return None
    _sure(text, i, _number(text, i)[2])
    value, last, behind, end = found
    unit = behind if _known(behind) else before if _known(before) else ""
    if behind and not unit:
        raise Refused("unit of a step")
    is_rate = unit in RATES_LONGEST if unit else _is_rate(text[begin:key_end])
    if is_rate and not unit and value < 1:
        raise Refused("rate below 1")
    return _meant(is_rate, value, last, TIME_WORDS.get(unit, 1)), end


def _is_rate(piece):
    return any(
        len(key) == len(piece) and all(wanted in (sign, "?") for wanted, sign in zip(key, piece, strict=True))
        for key in RATE_KEYS
    )


def _meant(is_rate, value, last, per_second):
    if value <= 0:
        raise Refused("step")
    return (True, 1 / value, 0) if is_rate else (False, value / per_second, last / 2 / per_second)


def _known(word):
    return word in TIME_WORDS or word in RATES_LONGEST


def _alone(text, i):
    """A number of samples a second that begins at i."""
    before, signs = text[i - 1 : i] if i else "", text[max(i - 2, 0) : max(i - 1, 0)]
    if text[i] not in DIGITS + ".+-":
        return None
    inside = before in (*DIGITS, "+", "-") or (before in (".", ",", "e", "d") and signs in tuple(DIGITS))
    if text[i] not in "+-" and inside:
        return None
    found = _number(text, i)
    end = found[2] if found else i
    if not found:
        while text[end : end + 1] and text[end] in DIGITS + ".,ed+-":
            end += 1
    begin, end = end, end + (text[end : end + 1] == " ")
    word = _word(text, end)
    if word not in PER_SECOND or text[begin - 1] not in DIGITS + ".":
        return None
    if not found:
        if not any(sign in DIGITS for sign in text[i:begin]):
            return None
        raise Refused("no number of samples a second")
    _sure(text, i, begin)
    return _meant(True, found[0], found[1], 1), end + len(word)
