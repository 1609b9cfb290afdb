"""Tables of numbers: the lines of a file split into header and fields, and what the titles name."""

import itertools
import math
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..errors import SceneError
from .content import HEADER_WIDTH, UNKNOWN_FORMAT, first_of
from .notation import (
    END,
    LENGTHS,
    NOT_ACCELERATIONS,
    OTHER_TIMES,
    PER_SECOND,
    START,
    UNITS,
    WORDS,
    exact,
    form_of,
    in_latin,
    in_seconds,
    plain,
    printed_as,
    value_of,
)
from .statements import ACCELERATION, OTHER, TIMES, folded, read_statements, stated_count, stated_unit

# A line that begins like a number is data, so that a damaged row is not taken for a header.
DATA = re.compile(r"\s*(?:[-+.0-9]|[,;](?!\s*(?!nan|inf)[^\W\d_])|(?:nan|inf|infinity)\b)", re.I)
HEADING = re.compile(r"[1-9][0-9]?\. ?[^\W\d_]{4}")  # "4. DATOS DE ACELERACION", as Peru's networks number their header
COMMENT = ("#", "%", "!", "//")
HEADER_LINES = 200
NUMERIC = re.compile(r"[-+]?[.,]?[0-9]")
RULER = re.compile(r"[-=_*~+|]{3,}(?:\s+[-=_*~+|]{3,})*")  # below titles
SIGNS_OF_NUMBERS = "0123456789.,;+-eEdD \t"
QUOTED = re.compile(r'(?:(?:[^"]*[,;\s])?"[^"]*"(?=[,;\s]|$))+(?:[,;\s][^"]*)?')  # fields, some of them in quotes

LEADING = 6  # numbers of a list that may be no accelerations: its step, its number, a factor, zeros between them
USUAL = 0.99  # share of the numbers of a list that are printed in one form, where there is one
FAR = 10  # a number this many times as large as all that follow it is no part of the motion
SAY_WHICH = "and say which: # dt = .01 s"
OR_HOW_MANY = f"{SAY_WHICH}; or, if it is an acceleration, say above how many there are: # samples: 300"

Table = Sequence[tuple[int, list[str]]]  # line numbers and fields of the rows


def unquoted(lines: Sequence[str]) -> Sequence[str]:
    """Return the lines without quotes around the fields.

    If quoted numbers have decimal commas, the separator becomes a semicolon.
    """
    parts = {at: line.split('"') for at, line in enumerate(lines) if '"' in line and QUOTED.fullmatch(line.strip())}
    if not parts:
        return lines
    commas = any("," in field for pieces in parts.values() for field in pieces[1::2] if DATA.match(field))
    bare = list(lines)
    for at, pieces in parts.items():
        inside = [field if DATA.match(field) else re.sub("[,;]", "", field) for field in pieces[1::2]]
        between = [text.replace(",", ";") if commas else text for text in pieces[::2]]
        bare[at] = "".join(itertools.chain(*zip(between, [*inside, ""], strict=True)))
    return bare


def split(lines: Sequence[str]) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return (line number, text) of the header, cut to `HEADER_WIDTH`, and of the rows of data.

    Comments and blank lines are no rows.

    A comment inside the data that states a step or a unit is refused: there a second record begins.
    """
    header: list[tuple[int, str]] = []
    rows: list[tuple[int, str]] = []
    begin = _begin(lines)
    for at, line in enumerate(lines, 1):
        text = line.strip()
        if not rows and RULER.fullmatch(text):
            continue
        if text.startswith(COMMENT):
            comment = at, in_latin(text[:HEADER_WIDTH])
            if not rows:
                header.append(comment)
            elif (statements := read_statements([comment])).step or stated_unit(statements.rest):
                raise SceneError(f"line {at}", text, "a statement inside the data", "give one record of the file")
        elif text and not rows and (at <= begin or not DATA.match(text) or HEADING.match(text)):
            header.append((at, in_latin(text[:HEADER_WIDTH])))
        elif text:
            rows.append((at, in_seconds(f"line {at}", text.split("#")[0].strip())))
    if not rows or len(header) > HEADER_LINES:
        raise SceneError("line 1", first_of(lines).strip()[:60], *UNKNOWN_FORMAT)
    return header, rows


def _begin(lines: Sequence[str]) -> int:
    """Return the number of the last line that states how many samples follow.

    0 if a line up to there is one of numbers alone.
    """
    top = [line[:HEADER_WIDTH] for line in lines[:HEADER_LINES]]
    begin = max((at for at, line in enumerate(top, 1) if stated_count([(at, line)]) is not None), default=0)
    rows = (line for line in top[:begin] if re.search("[0-9]", line) and not line.strip(SIGNS_OF_NUMBERS))
    return 0 if any(rows) else begin


def parted(rows: Sequence[tuple[int, str]]) -> tuple[str | None, Table]:
    """Return (separator, None for blanks; the fields of all rows, with decimal points)."""
    separator, decimal = _dialect(rows)
    plain = ((at, row.replace(",", ".") if decimal == "," else row) for at, row in rows)
    table = [(at, fields_of(row, separator)) for at, row in plain]
    while all(len(fields) > 1 and not fields[-1] for _, fields in table):  # separators behind all rows
        table = [(at, fields[:-1]) for at, fields in table]
    return separator, table


def _dialect(rows: Sequence[tuple[int, str]]) -> tuple[str | None, str]:
    """Return (separator, decimal sign) of all rows; the separator of blanks is None."""
    texts = [row for _, row in rows]
    points = sum("." in text for text in texts)
    semicolon = ";" if any(";" in text for text in texts) else None
    first = next((row for row in rows if "," in row[1]), None)
    if first is None:
        return semicolon, "."
    spaced = any(re.search(r",[ \t]|[ \t],|^,|,$", text) for text in texts)
    blanks = all(len(text.split()) > 1 for text in texts)
    if not semicolon and (spaced or (not blanks and 2 * points >= len(texts))):
        return ",", "."
    if not (semicolon or blanks):
        problem = "its comma may part columns or be a decimal sign"
        raise SceneError(
            f"line {first[0]}", first[1], problem, "write decimal points, or part the columns by semicolons"
        )
    if points:
        problem = "a decimal comma in a file that has decimal points too"
        raise SceneError(f"line {first[0]}", first[1], problem, "write decimal points throughout")
    return semicolon, ","


def fields_of(row: str, separator: str | None) -> list[str]:
    """Return the fields of a line."""
    return row.split() if separator is None else [field.strip() for field in row.split(separator)]


def counted(table: Table) -> tuple[Table, list[tuple[int, str]]]:
    """Return (rows, (line number, statement)) of a table whose first line gives the number of its values or rows.

    The line may also give their step, as eqsig and many programs write. Without such a line the table is returned as it
    is.
    """
    (at, first), rest = table[0], table[1:]
    size, width = sum(len(fields) for _, fields in rest), max((len(fields) for _, fields in rest), default=0)
    if rest and len(first) < 3 and re.fullmatch("[0-9]{1,9}", first[0]) and value_of(first[-1]) >= 0:
        is_count = int(first[0]) in (size, len(rest)) and any("." in field for _, fields in rest for field in fields)
        if not is_count and len(first) == 2 and width != 2:
            problem = f"may be the number of values and their step, but {size} values follow"
            raise SceneError(f"line {at}", " ".join(first), problem, "correct it, or begin the line with #")
        rising = width == 2 == len(first) and value_of(rest[0][1][0]) > int(first[0])
        if is_count and not rising:
            return rest, [(at, f"samples: {first[0]}" + (f", dt = {first[1]} s" if len(first) == 2 else ""))]
    falls = len(first) == 2 == width and len(rest) > 2 and rises(rest, 0) and not rises(table, 0)
    if falls or len(first) == 1 < width:
        problem = "no row as those below are, and may be their step, their number or a factor"
        raise SceneError(f"line {at}", " ".join(first), problem, f"begin the line with #, {SAY_WHICH}")
    return table, []


def check_leading(values: Sequence[tuple[int, str]], step: float | None) -> None:
    """Refuse a number at the head of a list, (line number, number), that may be no acceleration.

    Such a number is not 0, and it is not printed as those below; or it says how many follow. The first one, and one
    behind numbers that are rounder or far larger than those below, may also be the step that is given [s], or itself be
    both rounder and far larger.
    """
    below = Counter(form_of(token) for _, token in values if value_of(token))
    decimals = sorted(map(_decimals, (token for _, token in values if value_of(token))))
    odd: list[bool] = []  # of each number before that is not 0: whether it is rounder or far larger
    for place, (at, token) in enumerate(values[:LEADING]):
        value, count = value_of(token), len(values) - place - 1
        if not value:
            continue
        below -= Counter([form_of(token)])
        ((usual, often),) = below.most_common(1) or [(None, 0)]
        following = max((abs(value_of(later)) for _, later in values[place + 1 :][: LEADING - 1]), default=math.inf)
        rounder, far_larger = _decimals(token) < decimals[len(decimals) // 2] - 1, abs(value) >= FAR * following
        problem = ""
        if below.total() > 1 and often >= USUAL * below.total() and not printed_as(usual, token):
            problem = "not printed as the numbers below are"
        elif step is not None and math.isclose(value, step, rel_tol=1e-3) and (not place or (odd and all(odd))):
            problem = "equal to the step that is given"
        elif count > 2 * LEADING and count - value in (0, 1, 2) and all(odd):
            problem = "as many as the numbers below"
        elif rounder and far_larger and all(odd):
            problem = "rounder and far larger than the numbers below"
        if problem:
            problem += ", and may be their step, their number or a factor"
            raise SceneError(f"line {at}", token, problem, f"write it in a line that begins with #, {OR_HOW_MANY}")
        odd.append(rounder or far_larger)


def _decimals(token: str) -> int:
    """Return the digits of a number behind the point, as many as it needs; fewer than 0 for a multiple of ten."""
    return -int(exact(token).normalize().as_tuple().exponent)


def unpaired(table: Table, titles: Sequence[str]) -> Table:
    """Return the table of two columns, if each line holds several pairs of time and value, which rise along the lines.

    Raises
    ------
    SceneError
        Few of the times do not rise: a damaged number. In columns side by side some number falls in each line.
    """
    width, last = len(table[0][1]), table[-1][1]
    complete = all(len(fields) == width for _, fields in table[:-1]) and not len(last) % 2
    if width < 4 or width % 2 or not complete or len({*titles[::2]}) > 1 or len({*titles[1::2]}) > 1:
        return table
    falls, before = [], -math.inf
    for at, field in ((at, field) for at, fields in table for field in fields[::2]):
        time = value_of(field)
        if not before < time:
            falls.append(at)
            if 2 * len(falls) >= len(table):
                return table
        before = time
    if falls:
        problem, remedy = "its times do not rise along the pairs of time and value", "mend the damaged time"
        raise SceneError(f"line {falls[0]}", None, problem, remedy)
    return [(at, fields[place : place + 2]) for at, fields in table for place in range(0, len(fields), 2)]


def rises(table: Table, place: int) -> bool:
    """Return whether a column may be one of times: its numbers only rise."""
    values = [value_of(fields[place]) if place < len(fields) else math.nan for _, fields in table]
    return len(values) > 1 and all(before < after for before, after in itertools.pairwise(values))


def counts(table: Table, place: int) -> bool:
    """Return whether a column numbers the rows."""
    column = [fields[place] for _, fields in table if place < len(fields)]
    return (
        len(column) == len(table)
        and column[0] in ("0", "1")
        and column == [str(at + int(column[0])) for at in range(len(column))]
    )


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
    """The titles of the columns, and the number of their line; empty where there are none."""

    at: int = 0
    words: tuple[str, ...] = ()


def find_titles(header: Sequence[tuple[int, str]], separator: str | None, width: int) -> Titles:
    """Return the `Titles` of `width` columns.

    They are the last line of the header, or the last but one with the units of the last.
    """
    named = [(at, match.string[match.end() :]) for at, line in header if (match := SEQUENCE.match(line.lstrip(" #")))]
    for at, line in named or header[-1:]:
        words = _parted(line, separator, width, _is_name)
        above = _parted(header[-2][1], separator, width, _is_name) if len(header) > 1 and not named else ()
        if above and (units := _parted(line, separator, width, _is_unit)):
            words = tuple(f"{name} ({unit.strip('()[]')})" for name, unit in zip(above, units, strict=True))
        if words and (width > 1 or _is_title(words[0])):
            return Titles(at, words)
    return Titles()


def _is_title(line: str) -> bool:
    """Return whether a line over one column is its title: it may be any words."""
    name = name_of(line)
    return " " not in name and (name.lower() in _RAW or _kind_of(line) in (ACCELERATED, *OTHERS))


def _parted(line: str, separator: str | None, width: int, is_one: Callable[[str], bool]) -> tuple[str, ...]:
    """Return the `width` titles that make up a line, or what `is_one` asks for, the first perhaps ""; else none."""
    line = line.lstrip("#%!/ ").rstrip(",;\t ")
    for by in (*([re.escape(separator)] if separator else []), "[;,]", r"\t", " {2,}", "[;, ]+", r"[;, ]+(?![;, (\[])"):
        words = [word.strip(" \"'") for word in re.split(by, line)]
        if len(words) == width and all(map(is_one, words[1:])) and (not words[0] or is_one(words[0])):
            return tuple(words)
    return ()


def _is_name(word: str) -> bool:
    return bool(re.search(r"[^\W\d_]", name_of(word))) and not NUMERIC.match(word) and not word.endswith(":")


def _is_unit(word: str) -> bool:
    """Return whether a field is a unit, "[s]" or "g", or the sign of none."""
    word = word.strip("()[]")
    return word == "-" or _is_time(word) or word.lower() in OTHER_TIMES or bool(known_unit(word))


def _is_time(word: str) -> bool:
    return word.lower() in PER_SECOND and bool(word)


def name_of(title: str) -> str:
    """Return a title without the words in brackets: U(+) is U."""
    return " ".join(_BRACKETS.sub(" ", title).split())


def kinds_of(titles: Titles, spectrum: bool) -> list[str]:
    """Return the kind of each column by its title; `spectrum`: the file may hold one by other words of its header."""
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
    """Return the kind that a title names.

    "t" and words of time are a time, and so are units of time in place of a name.
    """
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
    """Return a title of times and its unit as a sentence says it: "RelativeTime(ms)" has "time ms"."""
    title = _TIME_IN_A_WORD.sub("time", title, count=1)
    words = [title, *_BRACKETS.findall(title), re.split(r"[\s_,:/]+", name_of(title))[-1]]
    unit = next((word for word in map(str.strip, words) if _is_time(word) or word.lower() in OTHER_TIMES), None)
    return f"{title} time {unit}" if unit else title


def spectrum_in(words: Sequence[tuple[int, str]]) -> tuple[int, str] | None:
    """Return the line of a header that names a spectrum, or whose first word is a period or a frequency, if any."""
    named = [line for line in words if _SPECTRUM.search(folded(line[1]))]
    begun = [line for line in words[-1:] if _BEGINS_WITH_PERIODS.fullmatch(folded(line[1].lstrip("#%!/ ")))]
    return next(iter(named + begun), None)


def known_unit(word: str) -> str:
    """Return a unit of acceleration or velocity, as titles write it too: "cms2" is "cm/s2"; "" for another word."""
    word = word.strip().lower()
    if word[:1] in ("", ".", "'", '"'):  # the rest of a damaged word
        return ""
    if plain(word) in WORDS or plain(word) in NOT_ACCELERATIONS - {"m", "in", "ft"}:
        return word
    length, per, squared = glued.groups() if (glued := _GLUED.fullmatch(word.replace("²", "2"))) else ("", "", "")
    return f"{length}/s2" if squared else f"{length}/s" if per or length in ("cm", "mm") else ""


def has_unit(title: str) -> bool:
    """Return whether a title has a unit of length, velocity or acceleration in brackets."""
    return any(known_unit(word) or word.strip() in LENGTHS for word in _BRACKETS.findall(title))


def with_unit(titles: Titles, place: int) -> str:
    """Return a title with its unit in brackets: "acc_cms2" is "acc (cm/s2)".

    Raises
    ------
    SceneError
        A word stands where units stand, and is none that is known, or one of another quantity.
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
    """Return whether another title differs in its numbers alone: these count columns."""
    return sum(re.sub("[0-9]+", "", word) == re.sub("[0-9]+", "", title) for word in titles.words) > 1
