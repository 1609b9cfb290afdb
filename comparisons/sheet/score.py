"""Answers read from a file and scored: how far off, in which place beside the solvers measured here, and what probably
went wrong.

A mistake is named only where what it would answer has been computed and all answers of the scene lie within `MATCHING`
of it, while no other mistake's do. Else the cause is unknown.
"""

import csv
import math
from collections.abc import Callable, Mapping
from os import PathLike

from pydantic import Field

from analytic.errors import SceneError
from analytic.files import read_plain

from ..running.age import by_engine, date_of
from ..running.provenance import RESULTS, ResultError
from ..schemas.form import Form, Part
from ..showing.wording import TRUSTED
from ..studies.rows import read_study
from .problems import COLUMNS, PROBLEMS, VERSION
from .variants import MISTAKES, Value, error, solved

LARGEST = 1_000_000  # bytes of a file of answers, a hundred times what the sheet asks for
WORDS = ("stands", "slides", "rocks", "overturns")


def read_answers(path: str | PathLike[str]) -> dict[str, dict[str, Value]]:
    """{problem: {quantity: value}} of a file of answers; what is not answered is not in it.

    Raises
    ------
    SceneError
        A line is not (scene, quantity, value), or names what the sheet does not ask; says file, line and remedy.
    """
    try:
        text = read_plain(path, LARGEST).decode("utf-8-sig")
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise SceneError("answers", str(path), problem, "give the file of answers") from None
    except UnicodeDecodeError as error:
        raise SceneError("answers", str(path), "no text in UTF-8", "save it as CSV in UTF-8") from error
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"]
    rows = [(number, _cells(line, f"{path}, line {number}")) for number, line in lines]
    head = ",".join(rows[0][1] if rows else [])
    if head != ",".join(COLUMNS):
        raise SceneError("answers", head, f"{path}: not the head {','.join(COLUMNS)}", "begin with that line")
    asked = {problem.name: {one.name: one for one in problem.quantities} for problem in PROBLEMS}
    given: dict[str, dict[str, Value]] = {}
    for number, row in rows[1:]:
        place = f"{path}, line {number}"
        if len(row) != len(COLUMNS):
            raise SceneError("answers", ",".join(row), f"{place}: not three columns", "write scene,quantity,value")
        name, quantity, value = row
        if name not in asked:
            raise SceneError("scene", name, f"{place}: no scene of the sheet", f"choose one of {', '.join(asked)}")
        if quantity not in asked[name]:
            raise SceneError("quantity", quantity, f"{place}: not asked of {name}", f"see {name}.md")
        if quantity in given.setdefault(name, {}):
            raise SceneError("quantity", quantity, f"{place}: answered twice", "remove one")
        if value:
            given[name][quantity] = _value(asked[name][quantity].kind, value, place)
    return {name: values for name, values in given.items() if values}


def _cells(line, place):
    """The cells of a line, which none goes beyond: a quote that is not closed costs no other line."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], strict=True))]
    except csv.Error as error:
        problem = f"{place}: no line of CSV ({error})"
        raise SceneError("answers", line, problem, "write scene,quantity,value, and close each quote") from None


def _value(kind, text, place):
    if kind == "outcome":
        if text not in WORDS:
            raise SceneError("value", text, f"{place}: no outcome", f"write one of {', '.join(WORDS)}")
        return text
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise SceneError("value", text, f"{place}: not a finite number", "write one with a decimal point, or nothing")
    return value


MATCHING = 1e-5  # largest error of answers against those of the mistake they come from
WRONG = 1e-3  # error from which a cause is looked for: far beyond what `MATCHING` allows for
TELLING = 2  # numbers at least that must be wrong before a cause is named
STORED = "sheet"


class SceneScore(Part):
    """One scene's answers: error over the scales, the largest and of each; place beside the stored solvers (None where
    not all was answered, or nothing is stored); cause: name of the mistake behind a wrong answer, None if unknown."""

    scene: str
    error: float
    worst: str
    errors: dict[str, float]
    missing: list[str]
    rank: int | None
    of: int
    right: bool
    cause: str | None
    advice: str | None


class FirstWrong(Part):
    """The wrong answer that comes first in time [s] of its run, over all scenes; where none of the wrong ones has a
    time, the first on the sheet. error: over its scale."""

    scene: str
    quantity: str
    time: float | None
    error: float


class Score(Form):
    """A file's scores. first_wrong: where the solver first goes wrong, None if nowhere. stored: where the solvers
    beside it come from; cause: the one mistake that explains all that is wrong, if there is one."""

    schema_: str = Field(default="rocking score 2", serialization_alias="schema")
    sheet: int = VERSION
    first_wrong: FirstWrong | None
    scenes: list[SceneScore]
    unanswered: list[str]
    cause: str | None
    passed: bool
    stored: str


def score(given: Mapping[str, Mapping[str, Value]], tell: Callable[[str], object] = lambda name: None) -> Score:
    """The `Score` of answers as `read_answers` gives them; `tell` is called with each scene's name.

    >>> from comparisons.sheet.variants import solved
    >>> from comparisons.sheet.problems import PROBLEMS
    >>> found = score({"free-rigid": solved(PROBLEMS[0])})
    >>> found.passed, found.scenes[0].cause
    (True, None)
    """
    problems = [problem for problem in PROBLEMS if problem.name in given]
    right, errors = {}, {}
    for problem in problems:
        tell(problem.name)
        right[problem.name] = solved(problem)
        errors[problem.name] = error(problem, given[problem.name], right[problem.name])
    causes, whole = _causes(problems, given, errors)
    table, stored = stored_errors()
    scenes = [
        _scene_score(problem, errors[problem.name], causes.get(problem.name), table.get(problem.name, []))
        for problem in problems
    ]
    return Score(
        first_wrong=_first_wrong(problems, errors, right),
        scenes=scenes,
        unanswered=[problem.name for problem in PROBLEMS if problem.name not in given],
        cause=whole,
        passed=bool(scenes) and all(one.right for one in scenes),
        stored=stored,
    )


def stored_errors() -> tuple[dict[str, list[tuple[float, str]]], str]:
    """({scene: [(error, solver)] from the least on}, where they come from in words)."""
    try:
        result = read_study(RESULTS / STORED)
    except ResultError as problem:
        return {}, f"no stored solvers ({problem})"
    table: dict[str, list[tuple[float, str]]] = {}
    for row in result.rows:
        if row["error"] is not None:
            table.setdefault(row["scene"], []).append((row["error"], f"{row['engine']}, {row['variant']}"))
    when = f"{STORED}, computed on {by_engine(result, date_of)}"
    return {name: sorted(rows) for name, rows in table.items()}, when


def _first_wrong(problems, errors, right):
    """The `FirstWrong` of answers by their errors; None if all are right."""
    wrong = [
        FirstWrong(scene=problem.name, quantity=one.name, time=problem.when(one, right[problem.name]), error=error)
        for problem in problems
        for one in problem.quantities
        if (error := errors[problem.name].get(one.name, 0.0)) > TRUSTED
    ]
    return min(wrong, key=lambda one: math.inf if one.time is None else one.time, default=None)


def _scene_score(problem, errors, cause, stored):
    missing = [one.name for one in problem.quantities if one.name not in errors]
    worst = max(errors, key=errors.get)
    place = None if missing or not stored else 1 + sum(found < errors[worst] for found, _ in stored)
    return SceneScore(
        scene=problem.name,
        error=errors[worst],
        worst=worst,
        errors=errors,
        missing=missing,
        rank=place,
        of=len(stored) + 1,
        right=errors[worst] <= TRUSTED,
        cause=cause and cause.name,
        advice=cause and cause.words,
    )


def _causes(problems, given, errors):
    """({scene: `Mistake`} of wrong scenes whose cause is known, name of the one behind all that is wrong or None)."""
    wrong = [problem for problem in problems if _is_wrong(problem, errors[problem.name])]
    verdicts = {
        mistake: {problem.name: _verdict(mistake, problem, given[problem.name]) for problem in wrong}
        for mistake in MISTAKES
    }
    whole = [
        mistake
        for mistake, found in verdicts.items()
        if True in found.values()
        and False not in found.values()
        and not any(
            _verdict(mistake, problem, given[problem.name]) is False for problem in problems if problem not in wrong
        )
    ]
    if len(whole) == 1:
        return {scene: whole[0] for scene, found in verdicts[whole[0]].items() if found}, whole[0].name
    matching = {problem.name: [one for one, found in verdicts.items() if found[problem.name]] for problem in wrong}
    return {scene: found[0] for scene, found in matching.items() if len(found) == 1}, None


def _is_wrong(problem, errors):
    numbers = [one.name for one in problem.quantities if one.kind != "outcome" and one.name in errors]
    return sum(errors[name] > WRONG for name in numbers) >= TELLING


def _verdict(mistake, problem, given):
    """Whether a mistake explains the answers of a scene; None where it is not known what it would answer, or where it
    would answer all of that right."""
    forms = [form for form in mistake.answers(problem, given) if form]
    whole = [form for form in forms if form.keys() >= given.keys()]
    return any(max(error(problem, given, form).values()) <= MATCHING for form in whole) if forms else None
