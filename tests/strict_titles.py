"""Titles of columns for the second reader of records (`strict_records`), which says what it is for."""

import re

from strict_statements import fold
from strict_words import KNOWN, LENGTHS, RATES, TIME_WORDS, letter, need, unit_of

OTHER_TIMES = "us µs usec ns min mins minute minutes h hr hrs hour hours day days samples".split()
LONG_TIMES = ("time", "zeit", "tiempo", "temps", "zaman")
# Words of each kind; of words of two kinds the upper one counts.
KINDS = {
    "spectrum": "sa|sv|sd|psa|psv|psd|pgv|pgd|spectrum|spectra|spektrum|spektra|fourier|fas|arias|husid|cav|intensity"
    r"|intensities|energy|rotd[0-9]+|pseudo\w*|(?:e|)(?:spectral|spektral)\w*",
    "period": r"period|periods|periodo|periodos|periode|perioden|periyo[td]\w*",
    "frequency": "freq|freqs|frequency|frequencys|frequencies|frecuencia|frecuencias|frequenz|frequenzen|frequence"
    "|frequences|frekans|frekanslar|omega",
    "acceleration": "acc|accel|acceleration|accelerations|accelerogram|accelerograms|pga|aceleracion|aceleraciones"
    "|beschleunigung|beschleunigungen|ivme",
    "other": "velocity|velocities|veloc|vel|displacement|displacements|displ|disp|velocidad|velocidades|desplazamiento"
    "|desplazamientos|geschwindigkeit|geschwindigkeiten|verschiebung|verschiebungen|vitesse|vitesses|deplacement"
    "|deplacements|dsp|dspl|desp|despl|dis|hiz|deplasman|drift|strain|stress|force|load|moment|shear|pressure|temperature"
    r"|temp|voltage|angle|rotation|gyro\w*|magnet\w*|mag|roll|pitch|yaw|speed",
    "place": "depth|distance|height|elevation|profundidad|distancia|tiefe|profondeur|derinlik|mesafe|story|storey"
    "|stories",
    "number": "index|no|nr|num|number|sample|samples|point|points|row|id|unnamed",
}
ALONE = {"a": "acceleration", "f": "frequency", "hz": "frequency"} | dict.fromkeys(
    ("per", "tn", "t n", "t0", "t 0"), "period"
)
RAW = "count counts cts volt volts mv lsb adc digits".split()
REFUSED = ("spectrum", "period", "frequency", "other")
REMARKS = (
    "n e w ns sn ew we nn ee ss ne nw se sw n-s e-w u-d ud north south east west up down vert vertical horiz horizontal"
    " raw corrected filtered processed uncorrected unfiltered unprocessed matched scaled"
).split()


def titles_of(header, by, width):
    """(titles or [], index of their line) of `width` columns."""
    named = [index for index, line in enumerate(header) if re.match("[# \\t]*datasequence:", line.lower())]
    at = named[0] if named else len(header) - 1
    if at < 0:
        return [], at
    line = header[at].partition(":")[2] if named else header[at]
    titles = parted(line, by, width, is_name)
    if not named and at > 0 and (above := parted(header[at - 1], by, width, is_name)):
        units = parted(line, by, width, is_unit)
        titles = (
            [f"{name} ({unit.strip('()[]')})" for name, unit in zip(above, units, strict=True)] if units else titles
        )
    if width == 1 and titles:
        one = " " not in name_of(titles[0])
        known = name_of(titles[0]).lower() in RAW or kind_of(titles[0]) in ("acceleration", *REFUSED)
        titles = titles if one and known else []
    return titles, at


def parted(line, by, width, fits):
    """The fields of a line, by the first of several separators that makes `width` of them, all of which fit."""
    line = re.sub(r"[,;\s]+$", "", re.sub(r"^[#%!/\s]+", "", line))
    for parting in (*([by] if by else []), "[;,]", "\t", "  +", "[ ;,]+", r"[ ;,]+(?![ ;,(\[])"):
        fields = [field.strip(" \"'") for field in re.split(parting, line)]
        if len(fields) == width and all(
            fits(field) or (place == 0 and not field) for place, field in enumerate(fields)
        ):
            return fields
    return []


def is_name(word):
    return any(map(letter, name_of(word))) and not re.match(r"[+-]?[.,]?[0-9]", word)


def is_unit(word):
    word = word.strip("()[]").lower()
    return word in ("-", *TIME_WORDS, *OTHER_TIMES) or bool(unit_word(word))


def name_of(title):
    """The title without what stands in brackets."""
    return " ".join(re.sub(r"[(\[][^)\]]*[)\]]?", " ", title).split())


def inside(title):
    """What stands in the brackets of a title."""
    return [word.strip() for word in re.findall(r"[(\[]([^)\]]*)", title)]


def kinds_of(titles, spectrum):
    """The kind of each column; `spectrum`: the header names one."""
    kinds = [kind_of(title) if title else "number" for title in titles]
    for place, name in enumerate(fold(name_of(title)) for title in titles):
        if name == "t" and (spectrum or "spectrum" in kinds):
            kinds[place] = "period"
        if name in ("v", "d") and "acceleration" in kinds:
            kinds[place] = "other"
    return kinds


def kind_of(title):
    name = fold(name_of(title)).strip(" .")
    if name in ALONE or any(word.lower() in ("hz", "rad/s") for word in inside(title)):
        return ALONE.get(name, "frequency")
    if re.match(rf"(?:t|{'|'.join(LONG_TIMES)})(?![^\W\d_])", name) or name in TIME_WORDS:
        return "time"
    found = [kind for kind in KINDS if any(_fits(kind, word, name) for word in _words(kind, name))]
    kind = found[0] if found else ""
    timed = any(word in name for word in LONG_TIMES) and kind not in ("acceleration", "period", "frequency")
    return "time" if timed else kind


def _words(kind, name):
    """Where the name has words of the kind, as matches."""
    return re.finditer(rf"(?<![^\W\d_])(?:{KINDS[kind]})(?![a-z])", name)


def _fits(kind, match, name):
    return not (re.fullmatch("p?s[avd]", match[0]) and re.match("[0-9]", name[match.end() :]))


def time_of(title):
    """The title of times and its unit as other words say it: time, and the unit behind."""
    title = re.sub(rf"(?i)[a-z]*(?:{'|'.join(LONG_TIMES)})[a-z]*", "time", title, count=1)
    last = re.split(r"[\s_,:/]+", name_of(title))[-1]
    units = [word for word in (title.strip(), *inside(title), last) if word.lower() in (*TIME_WORDS, *OTHER_TIMES)]
    return " time ".join((title, *units[:1]))


def names_spectrum(lines):
    """Whether lines of a header say that the file holds a spectrum."""
    texts = [fold(re.sub("^[#%!/ ]+", "", line)) for line in lines]
    words = r"spectr(um|a)|e?spectros?|spektr(um|en)|spectres?"
    for text in texts:
        if re.search(rf"(?<![^\W\d_])({words})(?![^\W\d_])", text):
            return True
    begin = re.compile(rf"(t|{KINDS['period']}|{KINDS['frequency']})(?![^\W\d_])[^0-9:=]*")
    return bool(texts and begin.fullmatch(texts[-1]))


def unit_word(word):
    """A unit of acceleration or velocity in its usual spelling; "" of another word."""
    word = word.strip().lower()
    if word in KNOWN or word in RATES or word in ("mm", "cm"):
        return word
    glued = re.fullmatch(rf"({'|'.join(LENGTHS)})[ _]?(p|per)?[ _]?s(?:ec)?[ _]?(2|²)?", word)
    if not glued or not (glued[3] or glued[2] or glued[1] in ("cm", "mm")):
        return ""
    return f"{glued[1]}/s2" if glued[3] else f"{glued[1]}/s"


def with_unit(titles, place):
    """The title with its unit in brackets; refused with a word where units stand that is none."""
    title = titles[place]
    if unit_of([title], 0) is not None:
        return title
    name = name_of(title)
    for words in inside(title):
        if unit_word(words):
            return f"{name} ({unit_word(words)})"
        parts = words.split()
        remark = len(parts) > 1 and not any(map(unit_word, parts)) and not set(words) & set("*^/²")
        need(remark or _is_remark(fold(words)))
    words = re.split(r"[\s_,:/]+", name)
    if set(name) & set("_,:/") or len(words) < 3:
        for count in (3, 2, 1):
            if unit_word(" ".join(words[-count:])):
                return f"{name} ({unit_word(' '.join(words[-count:]))})"
    last = words[-1].lower()
    alike = [other for other in titles if re.sub("[0-9]+", "", other) == re.sub("[0-9]+", "", title)]
    need(not (last in RAW and ("_" in name or len(words) == 1)))
    need(not ("_" in name and re.fullmatch("[a-zµ]+[-^]*2", last) and len(alike) < 2))
    return title


def _is_remark(word):
    """Whether what stands in brackets is no unit: numbers, or a direction, or what was done to the values."""
    return (
        not re.search("[a-z%µ°]", word)
        or word in REMARKS
        or re.fullmatch("[nsew]?[0-9]+-?[nsew]|[nsew]-?[nsew]|[xyzuhrtl][0-9]?|[behs][hnlg][enz12]", word)
    )
