"""Titles of columns: their position, the quantity that each names, and its unit."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..errors import SceneError
from .rows import NUMERIC
from .statements import ACCELERATION, OTHER, TIMES, folded, stated_unit
from .times import OTHER_TIMES, PER_SECOND
from .units import END, LENGTHS, NOT_ACCELERATIONS, START, UNITS, WORDS, plain

SEQUENCE = re.compile(r"datasequence:", re.I)  # Taiwan's line of titles
# Kinds of columns. If a title has words of two kinds, the upper one counts.
TIME, PERIOD, FREQUENCY, DEPTH = "the time", "a period", "a frequency", "a place"
SPECTRUM, ACCELERATED = "of a spectrum or an intensity", "an acceleration"
OTHER_QUANTITY = "a velocity, a displacement or another quantity"
NUMBERS, UNKNOWN = "the number of the row", ""
PERIODS = (PERIOD, FREQUENCY)
OTHERS = (SPECTRUM, OTHER_QUANTITY, *PERIODS)
_WORDS = {
    SPECTRUM: r"p?s[avd](?![0-9])|pg[vd]|rotd[0-9]+|e?spe[ck]tral\w*|spe[ck]tr(?:um|a)|pseudo\w*|fourier|fas"
    "|arias|husid|cav|intensit(?:y|ies)|energy",
    PERIOD: r"period(?:s|os?|en?)?|periyo[dt]\w*",
    FREQUENCY: "freq(?:uency|uencies|s)?|frecuencias?|frequenz(?:en)?|frequences?|frekans(?:lar)?|omega",
    ACCELERATED: ACCELERATION,
    OTHER_QUANTITY: f"{OTHER}|d[ie]?spl?|dis|hiz|deplasman|drift|strain|stress|force|load|moment|shear|pressure"
    r"|temp(?:erature)?|voltage|angle|rotation|gyro\w*|magnet\w*|mag|roll|pitch|yaw|speed",
    DEPTH: "depth|distance|height|elevation|profundidad|distancia|tiefe|profondeur|derinlik|mesafe|stor(?:e?y|ies)",
    NUMBERS: "index|no|nr|num|number|samples?|points?|row|id|unnamed",
}
_OF = {kind: re.compile(rf"{START}(?:{words})(?![a-z])") for kind, words in _WORDS.items()}
# Whole titles of a table of earthquakes, a row each: at least two of them, of which one may be the peak.
_EVENT = re.compile(
    "record sequence number|rsn|eqid|(?:earthquake|event|eq)(?: (?:name|id|no|code|date|time|magnitude))?"
    "|station(?: (?:name|id|no|code|sequence number))?|year|mw|(?:moment )?magnitude|vs ?30.*|(?:epi|hypo)[cd].*"
    "|latitude|longitude"
)
ONE_RECORD = "give the file of one record, its accelerations over time"
_PEAK = re.compile(r"pg[avd]\b.*")
# Whole titles.
_ALONE = {"a": ACCELERATED, "f": FREQUENCY, "hz": FREQUENCY, **dict.fromkeys(("per", "tn", "t n", "t0", "t 0"), PERIOD)}
_TIME = re.compile(rf"(?:{TIMES}){END}")
_LONG_TIME = re.compile("time|zeit|tiempo|temps|zaman")
_TIME_IN_A_WORD = re.compile(rf"[a-z]*(?:{_LONG_TIME.pattern})[a-z]*", re.I)
_BEGINS_WITH_PERIODS = re.compile(rf"(?:t|{_WORDS[PERIOD]}|{_WORDS[FREQUENCY]}){END}[^0-9:=]*")
_SPECTRUM = re.compile(rf"{START}(?:spectr(?:um|a)|e?spectros?|spektr(?:um|en)|spectres?){END}")
_BRACKETS = re.compile(r"[(\[]([^)\]]*)[)\]]?")
_GLUED = re.compile(rf"({'|'.join(LENGTHS)})[ _]?(p|per)?[ _]?s(?:ec)?[ _]?(2?)")  # cms2, m_per_s2, mps
# Words in brackets that are no unit: numbers, directions and processing of the values.
_REMARK = re.compile(
    r"(?:[^\w%°]|[\dº_])*|[東东西南北上下]{1,2}|[сюзв](?:-[сюзв])?|[nsew]?[0-9]+-?[nsew]|[new]|[nsew]-?[nsew]|u-?d|[xyzuhrtl][0-9]?|[behs][hnlg][enz12]|north|south|east|west|up|down"
    "|vert(?:ical)?|horiz(?:ontal)?|raw|(?:un)?(?:corrected|filtered|processed)|matched|scaled"
)
_RAW = ("count", "counts", "cts", "volt", "volts", "mv", "lsb", "adc", "digits")


@dataclass(frozen=True)
class Titles:
    """The titles of the columns, none where none are, and the number of their line."""

    at: int = 0
    words: tuple[str, ...] = ()


def find_titles(header: Sequence[tuple[int, str]], separator: str | None, width: int) -> Titles:
    """The `Titles` of `width` columns: the last line of the header, or the last but one with the units of the last."""
    named = [(at, found.string[found.end() :]) for at, line in header if (found := SEQUENCE.match(line.lstrip(" #")))]
    for at, line in named or header[-1:]:
        words = _parted(line, separator, width, _is_name)
        above = _parted(header[-2][1], separator, width, _is_name) if len(header) > 1 and not named else ()
        if above and (units := _parted(line, separator, width, _is_unit)):
            words = tuple(f"{name} ({unit.strip('()[]')})" for name, unit in zip(above, units, strict=True))
        if words and (width > 1 or _is_title(words[0])):
            return Titles(at, words)
    return Titles()


def _is_title(line: str) -> bool:
    """Whether a line over one column is its title: it may be any words."""
    name = name_of(line)
    return " " not in name and (name.lower() in _RAW or _kind_of(line) in (ACCELERATED, *OTHERS))


def _parted(line: str, separator: str | None, width: int, is_one: Callable[[str], bool]) -> tuple[str, ...]:
    """The `width` titles, or what `is_one` asks for, that make up a line, the first perhaps ""; else none."""
    line = line.lstrip("#%!/ ").rstrip(",;\t ")
    for by in (*([re.escape(separator)] if separator else []), "[;,]", r"\t", " {2,}", "[;, ]+", r"[;, ]+(?![;, (\[])"):
        words = [word.strip(" \"'") for word in re.split(by, line)]
        if len(words) == width and all(map(is_one, words[1:])) and (not words[0] or is_one(words[0])):
            return tuple(words)
    return ()


def _is_name(word: str) -> bool:
    return bool(re.search(r"[^\W\d_]", name_of(word))) and not NUMERIC.match(word) and not word.endswith(":")


def _is_unit(word: str) -> bool:
    """Whether a field is a unit, "[s]" or "g", or the sign of none."""
    word = word.strip("()[]")
    return word == "-" or _is_time(word) or word.lower() in OTHER_TIMES or bool(known_unit(word))


def _is_time(word: str) -> bool:
    return word.lower() in PER_SECOND and bool(word)


def name_of(title: str) -> str:
    """A title without what stands in brackets: U(+) is U."""
    return " ".join(_BRACKETS.sub(" ", title).split())


def kinds_of(titles: Titles, spectrum: bool) -> list[str]:
    """What each column is by its title; `spectrum`: the file may hold one by other words of its header."""
    kinds = [_kind_of(word) if word else NUMBERS for word in titles.words]
    names = [folded(name_of(word)) for word in titles.words]
    if spectrum or SPECTRUM in kinds:
        kinds = [PERIOD if name == "t" else kind for name, kind in zip(names, kinds, strict=True)]
    if ACCELERATED in kinds:  # "a, v, d"; else v may be vertical
        kinds = [OTHER_QUANTITY if name in ("v", "d") else kind for name, kind in zip(names, kinds, strict=True)]
    return kinds


def check_events(titles: Titles) -> None:
    """Refuse the titles of a table of earthquakes or stations, which holds a peak of each and no motion."""
    names = [folded(name_of(word)).strip(" .") for word in titles.words]
    of_events = [name for name in names if _EVENT.fullmatch(name)]
    if not any(map(_TIME.match, names)) and of_events and len(of_events) + any(map(_PEAK.fullmatch, names)) > 1:
        problem = f"are those of a table of earthquakes or stations ({of_events[0]})"
        raise SceneError(f"line {titles.at}, titles", ", ".join(titles.words), problem, ONE_RECORD)


def _kind_of(title: str) -> str:
    """The kind that a title names; "t" and words of time are a time, and so are units of it in place of a name."""
    name = folded(name_of(title)).strip(" .")
    inside = [word.strip().lower() for word in _BRACKETS.findall(title)]
    if name in _ALONE or {"hz", "rad/s"} & set(inside):
        return _ALONE.get(name, FREQUENCY)
    if _TIME.match(name) or _is_time(name):
        return TIME
    kind = next((kind for kind, pattern in _OF.items() if pattern.search(name)), UNKNOWN)
    if kind not in (ACCELERATED, PERIOD, FREQUENCY) and _LONG_TIME.search(name):  # "RelativeTime"
        return TIME
    return kind


def time_words(title: str) -> str:
    """A title of times and its unit as a sentence says it: "RelativeTime(ms)" has "time ms"."""
    title = _TIME_IN_A_WORD.sub("time", title, count=1)
    words = [title, *_BRACKETS.findall(title), re.split(r"[\s_,:/]+", name_of(title))[-1]]
    unit = next((word for word in map(str.strip, words) if _is_time(word) or word.lower() in OTHER_TIMES), None)
    return f"{title} time {unit}" if unit else title


def spectrum_in(words: Sequence[tuple[int, str]]) -> tuple[int, str] | None:
    """The line of a header that names a spectrum, or whose first word is a period or a frequency, if one does."""
    texts = [(at, line, folded(line.lstrip("#%!/ "))) for at, line in words]
    for at, line, text in texts:
        if _SPECTRUM.search(text):
            return at, line
    for at, line, text in texts[-1:]:
        if _BEGINS_WITH_PERIODS.fullmatch(text):
            return at, line
    return None


def known_unit(word: str) -> str:
    """A unit of acceleration or velocity, as titles write it too: "cms2" is "cm/s2"; "" of another word."""
    word = word.strip().lower()
    if word[:1] in ("", ".", "'", '"'):  # the rest of a damaged word
        return ""
    if plain(word) in WORDS or plain(word) in NOT_ACCELERATIONS - {"m", "in", "ft"}:
        return word
    length, per, squared = found.groups() if (found := _GLUED.fullmatch(word.replace("²", "2"))) else ("", "", "")
    return f"{length}/s2" if squared else f"{length}/s" if per or length in ("cm", "mm") else ""


def has_unit(title: str) -> bool:
    """Whether a title has a unit of length, velocity or acceleration in brackets."""
    return any(known_unit(word) or word.strip() in LENGTHS for word in _BRACKETS.findall(title))


def with_unit(titles: Titles, place: int) -> str:
    """A title with its unit in brackets: "acc_cms2" is "acc (cm/s2)".

    Raises
    ------
    SceneError
        It has a word where units stand that is none that is known, or one of another quantity.
    """
    title = titles.words[place]
    if stated_unit([(titles.at, title)], titles.at):
        return title
    name = name_of(title)
    for inside in map(str.strip, _BRACKETS.findall(title)):
        if unit := known_unit(inside):
            return f"{name} ({unit})"
        parts = inside.split()
        several = len(parts) > 1 and not any(map(known_unit, parts)) and not re.search(r"[*^/²]", inside)
        if not several and not _REMARK.fullmatch(folded(inside)):
            raise _asked(titles.at, title, inside)
    words = re.split(r"[\s_,:/]+", name)
    if re.search("[_,:/]", name) or len(words) <= 2:
        for count in (3, 2, 1):
            if unit := known_unit(" ".join(words[-count:])):
                return f"{name} ({unit})"
    last = words[-1].lower()
    raw = last in _RAW and ("_" in name or len(words) == 1)
    if raw or ("_" in name and re.fullmatch("[a-zµ]+[-^]*2", last) and not _numbered(titles, title)):
        raise _asked(titles.at, title, words[-1])
    return title


def _asked(at: int, title: str, word: str) -> SceneError:
    problem = f"{word!r} may be a unit, and is none of acceleration that is known"
    remedy = f"write one of {', '.join(UNITS)} in its place, or take it out of the title and give units"
    return SceneError(f"line {at}, title", title, problem, remedy)


def _numbered(titles: Titles, title: str) -> bool:
    """Whether another title differs in its numbers alone: these count columns."""
    return sum(re.sub("[0-9]+", "", word) == re.sub("[0-9]+", "", title) for word in titles.words) > 1
