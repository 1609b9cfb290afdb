"""Reading of a file of answers, and the error of the exact answers."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from os import PathLike

from analytic.errors import SceneError
from analytic.files import read_plain

from .observed import Value, solved
from .problems import COLUMNS, PROBLEMS, Problem
from .variants import TIGHTEST, Fault, with_fault

LARGEST = 1_000_000  # bytes of a file of answers, a hundred times what the sheet asks for
LOOSER = 1e-14  # tolerance of the run beside the tightest one
WORDS = ("stands", "rocks", "overturns")


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


def error(problem: Problem, given: Mapping[str, Value], right: Mapping[str, Value]) -> dict[str, float]:
    """{quantity: error over its scale} of the answers given; of a word 0, or 1 where it is another."""
    return {
        one.name: float(given[one.name] != right[one.name])
        if one.kind == "outcome"
        else abs(float(given[one.name]) - float(right[one.name])) / problem.scale(one)
        for one in problem.quantities
        if one.name in given
    }


def own_error(problem: Problem) -> float:
    """What the exact answers may be off by: the largest difference, over the scales, from a run of the model at a
    looser tolerance and from one of the second implementation."""
    right = solved(problem)
    others = solved(problem, tolerance=LOOSER), with_fault(problem, Fault(), TIGHTEST)
    if any(other is None or other.keys() != right.keys() for other in others):
        raise ArithmeticError(f"{problem.name}: the second implementation fails, or two solutions do not show the same")
    return max(max(error(problem, other, right).values()) for other in others if other is not None)
