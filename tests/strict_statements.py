"""Steps stated in headers, for the second reader of records (`strict_records`), which says what it is for."""

import re
import unicodedata
from fractions import Fraction
from itertools import product

from strict_words import NUMBER, TIME_WORDS, need, plain, printed, single

GAP = ("", " ", "-", " -")
SAMPLING_FR = (" dechantillonnage", " d?echantillonnage")  # ?: any sign


def _spelled(*parts):
    return {"".join(words) for words in product(*parts)}


SAMPLING = ("sample", "sampling", "digitizing", "digitising", "digitization", "digitisation")
RATE_KEYS = {"fs", "samprate", "sampled at"}.union(
    _spelled((*SAMPLING, "data", "acquisition", "scan", "record", "recording"), GAP, ("rate", "freq", "frequency")),
    _spelled(("tasa", "frecuencia", "velocidad"), (" de muestreo", " de adquisicion")),
    _spelled(("abtast", "sampling"), GAP, ("rate", "frequenz")),
    _spelled(("frequence", "taux", "cadence"), SAMPLING_FR),
    _spelled(("ornekleme ",), ("frekansi", "hizi", "orani")),
)
INTERVAL_KEYS = {"dt", "sampled every", "interval of", "intervals of"}.union(
    _spelled(("delta", "δ", "∆"), GAP, ("t",)),
    _spelled(("equally",), GAP, ("spaced at",)),
    _spelled((*SAMPLING, "data", "recording"), GAP, ("interval", "period", "step", "time", "spacing", "increment")),
    _spelled(
        ("time",),
        GAP,
        ("step", "interval", "increment", "spacing", "base"),
        ("", " size"),
        ("", *(f" between {what}" for what in ("samples", "points", "values", "readings"))),
    ),
    _spelled(("intervalo", "periodo", "paso", "incremento"), (" de muestreo", " de tiempo")),
    _spelled(("paso", "intervalo"), (" temporal",)),
    _spelled(
        ("abtast", "zeit"), GAP, ("intervall", "periode", "zeit", "schritt", "schrittweite", "inkrement", "abstand")
    ),
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


END = r"(?![^\W\d_])"
KEY = re.compile(
    rf"(?<![^\W\d_])(?:(?:{_one_of(RATE_KEYS | INTERVAL_KEYS)}){END}|(?:delta|{_one_of(PER_SECOND)})(?= ?[:=]))"
)
RATE_KEY = re.compile(_one_of(RATE_KEYS | PER_SECOND))
UNIT = f"(?:{_one_of(RATES)}|[a-zµ]+){END}"
SAID = re.compile(rf" ?[(\[]? ?((?!(?:is|of|at){END}){UNIT})? ?[)\]]? ?([:=]|is|of|at)? ?")
BEHIND = re.compile(rf" ?[(\[]? ?({UNIT})(?! ?[:=])| ?(?=[,;|)\]]|$)| (?=[a-z]+ ?[:=])")
DECIMAL_COMMA, GOES_ON = re.compile("[0-9]+,[0-9]+"), re.compile("[.,]?[0-9]")
# A number of samples a second, of which no sign is left out before it
SAMPLES = re.compile(
    r"(?:(?=[+-])|(?<![0-9+-])(?<![0-9][.,ed]))(?=[0-9.+-])(?=[.,ed+-]*[0-9])([0-9.,ed+-]*[0-9.])"
    f" ?(?:{_one_of(PER_SECOND)}){END}"
)
# Behind a number and its unit, or before them at the beginning of a line or of a part of it
BEHIND_UNIT = re.compile(
    r"[.]? ?-?(?>(?:time|sample|sampling) ?-?(?:intervals?|steps?|spacing|increments?|rate|freq|frequency)"
    rf"|intervals?|steps?|spacing|increments?|sampling){END}(?! ?[:=(\[0-9])"
)
MERE = re.compile(
    "(?:step|interval|spacing|rate|sampling|muestreo|schritt|abtastung|paso|pas|echantillonnage|adim|ornekleme)"
    rf"{END} ?(?:[(\[]? ?(?P<boxed>{UNIT})(?= ?[)\]:=]) ?[)\]]? ?)?[:=]? ?"
)
COUNT = re.compile(
    r"(?<![^\W\d_])(?:(?:no|nr|num|number)[.]? ?(?:of )?(?:data |sample |acceleration )?(?:points|samples|data|values)"
    "|(?:numero|num[.]?|total|cantidad) (?:total )?de (?:muestras|datos|puntos|valores)"
    "|(?:zahl|anzahl) (?:der )?(?:werte|punkte|daten|messwerte|abtastwerte|datenpunkte)"
    "|nombre (?:de |d.?)(?:points|valeurs|donnees|mesures|echantillons)"
    "|(?:veri|ornek|nokta) sayisi|npts|ndata|(?<!between )samples(?= ?[:=]))"
    rf"{END} ?[:=]? ?([0-9]{{1,9}})(?![.,]?[0-9])"
)


def flat(line):
    """The first 400 signs of a line, with single blanks, composed."""
    return unicodedata.normalize("NFC", " ".join(line[:400].split()))


def fold(text):
    """The text in lower case without accents; low lines are blanks."""
    return plain(text).replace("_", " ")


def blanked(lines):
    """(statements, lines without them) of lines of a header: [(is a rate, step [s], half a printed unit [s])]."""
    statements, kept = [], []
    for line in map(flat, lines):
        text, i = fold(line), 0
        while i < len(text):
            key = KEY.match(text, i)
            found, end = _stated(text, key) if key else _alone(text, i)
            if found:
                statements.append(found)
                line = line[:i] + " " * (end - i) + line[end:]
            i = end
        for count in COUNT.finditer(text):
            line = line[: count.start()] + " " * (count.end() - count.start()) + line[count.end() :]
        kept.append(line)
    return statements, kept


def count_of(lines):
    """The number of samples that lines of a header state, None of none and of several."""
    counts = {int(found[1]) for line in lines for found in COUNT.finditer(fold(" ".join(line.split())))}
    return counts.pop() if len(counts) == 1 else None


def step_of_all(statements):
    """The step [s] that statements agree on, None without any."""
    rates = [step for is_rate, step, _ in statements if is_rate]
    if not statements:
        return None
    step = rates[0] if rates else statements[0][1]
    for is_rate, other, half in statements:
        need(abs(other - step) <= (half if rates and not is_rate else 0) + step / 10**6)
    need(Fraction(1, 10**7) <= step <= 1000)
    return step


def _number(text, i):
    """(token, next i) of a number or one with a decimal comma at i; None without one."""
    found = [pattern.match(text, i) for pattern in (NUMBER, DECIMAL_COMMA)]
    return next(((one[0], one.end()) for one in found if one and not GOES_ON.match(text, one.end())), None)


def _sure(token, behind=""):
    """(value, half the unit of its last digit); no comma that may part thousands or has an exponent behind it."""
    need(not re.fullmatch("[1-9][0-9]*,[0-9]{3}", token) and not ("," in token and re.match("[ed][0-9+-]", behind)))
    token = token.replace(",", ".")
    value = single(token)
    need(value > 0)
    return value, Fraction(10) ** printed(token)[1] / 2


def _stated(text, key):
    """(statement, where it ends) of what stands behind a key; (None, end of the key) if it states nothing."""
    said = SAID.match(text, key.end())
    before, sign = said.groups()
    number = _number(text, said.end())
    after = BEHIND.match(text, number[1]) if number else None
    if not after or (before and not _known(before) and not after[1]):
        need(sign not in (":", "="))
        return None, key.end()
    unit = next((word for word in (after[1], before) if _known(word)), None)
    need(unit or not after[1])
    value, half = _sure(number[0], text[number[1] :])
    if unit in RATES or (not unit and RATE_KEY.fullmatch(key[0])):
        need(unit or value >= 1)
        return (True, 1 / value, 0), after.end()
    per_second = TIME_WORDS[unit or "s"]
    return (False, value / per_second, half / per_second), after.end()


def _known(word):
    return word in TIME_WORDS or word in RATES


def _alone(text, i):
    """(statement, where it ends) of a number at i that says its unit and what it is, or of a mere word and such a
    number; (None, i + 1) of another text."""
    found = SAMPLES.match(text, i)
    number = found and _number(text, i)
    if found and (not number or number[1] == found.end(1)):
        need(number)
        return (True, 1 / _sure(number[0])[0], 0), found.end()
    begins = i == 0 or text[i - 1] in ",;|#%!" or (text[i - 1] == " " and i > 1 and text[i - 2] in ",;|#%!")
    mere = MERE.match(text, i) if begins else None
    at = mere.end() if mere else i
    number = _number(text, at) if mere or i == 0 or text[i - 1] not in "0123456789.," else None
    if not number:
        return None, i + 1
    unit = re.match(rf"( ?{'' if mere else '-?'})({UNIT})", text[number[1] :])
    word = mere["boxed"] if mere and mere["boxed"] else unit and unit[2]
    end = number[1] if mere and mere["boxed"] else number[1] + len(unit[0]) if unit else number[1]
    behind = None if mere else BEHIND_UNIT.match(text, end)
    if not word or not _known(word) or not (mere or behind):
        return None, i + 1
    value, half = _sure(number[0], text[number[1] :])
    end = behind.end() if behind else end
    if word in RATES:
        return (True, 1 / value, 0), end
    return (False, value / TIME_WORDS[word], half / TIME_WORDS[word]), end
