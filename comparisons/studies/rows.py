"""The columns that several studies share, and results whose rows are checked against their study.

A study declares in its ``study.py`` the columns of its rows, ``COLUMNS``, and by ``part`` which of them a row has,
``PARTS``. A value that is not known, or does not exist, is null.

    columns = columns_of("restitution")
    frame = pandas.DataFrame(read_result("restitution.json").rows)  # or any other table library
    print(columns["rms"].head, columns["rms"].declaration)  # name with unit; meaning, unit and type

No result depends on anything here.
"""

import shlex
from collections import Counter
from collections.abc import Mapping
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from ..execution.by_solver import MODEL, engine_of, read
from ..execution.results import Result, ResultError
from ..execution.writing import readable
from ..schemas.columns import Column, declared, flag_of, list_of, number_of, table_of, whole_of, word_of
from . import STUDIES, get_study

SHARED = declared(
    word_of("part", "part", "what the row is of, among the study's rows"),
    word_of("scene", "scene", "name of the scene, described in the settings"),
    word_of("engine", "solver", 'engine, or "analytic", "twin", "time-stepping", or the name of another integrator'),
    word_of("variant", "variant", "variant of the engine; empty where there is one only"),
    word_of("tier", "kind", "kind of the variant: defaults, tuned or assisted"),
    number_of("level", "level", "value of the variant's accuracy parameter", "of the parameter, see settings"),
    word_of("ground", "ground", "what the block stands on: rigid ground, or a base"),
    number_of("slenderness", "slenderness γ", "slenderness of the block, atan(width/height)", "rad", digits=None),
    whole_of("runs", "runs judged", "number of runs that the row sums up"),
    whole_of("failed", "failed", "number of runs that failed"),
    whole_of(
        "lost",
        "missed impacts",
        "missed impacts: strong impacts of the analytic model that the run, or the runs, do not have",
    ),
    table_of("failure", "failure", "why the run failed: kind, reason, message; null where it did not"),
    word_of("kind", "kind", 'kind of a failure: "solver", "exception", "time limit", "crash" or "undecided"'),
    word_of("reason", "reason", "why the run failed, or the value does not exist, in words"),
    word_of("message", "message", "the engine's own words on a failure, and the evidence"),
    whole_of("exit_code", "exit code", "exit code of a process that crashed"),
    number_of("time_limit", "time limit", "time limit that a failed run reached", "s"),
    table_of(
        "last_state",
        "last state",
        "last finite state of a failed run: time [s], tilt [rad], displacement [m], their rates",
    ),
    number_of("p_value", "p (McNemar)", "p of McNemar's exact test that outcomes change both ways alike", digits=3),
    whole_of("both_stand", "both stand", "runs that stand in the model and in the engine"),
    whole_of("both_overturn", "both overturn", "runs that overturn in both"),
    whole_of("only_a", "only the analytic model overturns", "runs that overturn in the analytic model alone"),
    whole_of("only_b", "only the engine overturns", "runs that overturn in the engine alone"),
    word_of("comparable", "comparable", '"yes", or why no engine is compared in this scene'),
    word_of("class", "class", '"right", "differs", "failed" or "left out"'),
    list_of("differences", "differences", "what differs from the model, in words"),
    list_of("quantities", "quantities", "names of the quantities that differ from the model"),
    word_of("outcome", "outcome", "outcome of the run: stands, slides, rocks, overturns or failed"),
    word_of("law", "law", "law of the bearings; null: none"),
    whole_of("steps", "steps", "steps of the run"),
    table_of("settings", "settings", "all settings of the run"),
    number_of("cpu_per_second", "CPU time per simulated second", "CPU time over simulated time", "s/s"),
    number_of("cpu_seconds", "CPU time of a run", "CPU time of one run: median over the processes", "s"),
)


# Columns of an engine's overturning boundary, and of the model's.
BOUNDARY = declared(
    word_of("shape", "shape", "shape of the pulse"),
    number_of("frequency", "frequency", "frequency of the pulse over omega_r"),
    number_of("amplitude", "amplitude", "amplitude of the pulse over g tan(slenderness)"),
    flag_of("rises", "rises", "whether overturning lies above the boundary"),
    whole_of("mode", "mode", "number of impacts before overturning"),
    number_of("low", "low", "amplitude halfway to the boundary below"),
    number_of("high", "high", "amplitude halfway to the boundary above"),
    number_of("min_normal", "min normal", "least N/(m g) of the analytic model; below 0 it holds the corner down"),
    number_of("room", "room", "relative distance to the nearer of low and high"),
    number_of("shift", "shift", "relative shift of the engine's boundary from the model's"),
    number_of("half_width", "half width", "relative half width of the bracket in which that boundary lies"),
)
# Fields of the rows of boundaries by part; see `Study.parts`.
PULSE = "engine variant level ground shape frequency amplitude"
EDGE = "ground shape frequency amplitude rises mode low high min_normal"
BOUNDARY_ROW = f"{PULSE} rises mode room shift? half_width? reason? runs"
SOUGHT = f"{PULSE} min_normal kind reason message"  # fields of a failed run that searched for a boundary

SHOWN = 80  # characters of a wrong value that messages show
NOTHING = ("failure", "why_not")  # a row with one of these fields says why it has no numbers


def columns_of(kind: str) -> Mapping[str, Column]:
    """Return {field: its column} of the rows of a study.

    A study of another package that declares none has those that all studies share.
    """
    return get_study(kind).columns or SHARED


def read_study(path: str | PathLike[str], name: str | None = None) -> Result:
    """Read a result and check that its rows are as its study writes them.

    Rows of another package's study are not checked.

    path: a folder of files by solver, or one file. name: of the study that the result must be of; None: any.

    Raises
    ------
    ResultError
        `by_solver.read` raises it, the result is of another study, or a row is not as it should be.
    """
    result, file = read(path), Path(path).name
    if name not in (None, result.kind):
        raise ResultError(f"{file}: a result of {result.kind}; give one that rocking study {name} wrote")
    place: Counter[str] = Counter()
    for row in result.rows if result.kind in STUDIES else ():
        engine = engine_of(row)
        solver = engine if engine in result.provenance.get("engines", ()) else MODEL
        place[solver] += 1
        if wrong := wrong_with(row, result.kind):
            whose = f"{file}/{solver}.json" if Path(path).is_dir() else file
            raise ResultError(f"{whose}, row {place[solver]}: {wrong}; run rocking study {result.kind} again")
    return result


def wrong_with(row: Mapping[str, Any], kind: str) -> str | None:
    """Return what is wrong with a row of the study `kind`, in words; None if nothing is."""
    study, part = _study(kind), row.get("part", "")
    if part not in list(study.parts):
        return f"part = {_shown(part)} is none of {', '.join(study.parts)}"
    always, numbers = fields_of(study.parts[part])
    for name, null in (always if any(row.get(name) for name in NOTHING) else always | numbers).items():
        if name not in row:
            return f"column {name!r} is missing"
        if row[name] is None and not null:
            return f"column {name!r} is null"
    for name, value in row.items():
        if name not in study.columns:
            return f"column {name!r} = {_shown(value)} is none of this study"
        declaration = study.columns[name].declaration
        if value is not None and declaration and not declaration.holds(value):
            return f"column {name!r} = {_shown(value)} is no {declaration.type}"
    return None


_study = cache(get_study)


@cache
def fields_of(part: str) -> list[dict[str, bool]]:
    """Return the fields of a part as `Study.parts` writes it: those of every row, and those of rows with numbers.

    Each is {field: whether null may stand there}.
    """
    words = shlex.split(part)
    bar = words.index("|") if "|" in words else len(words)
    return [
        {word.removesuffix("?"): word.endswith("?") for word in fields} for fields in (words[:bar], words[bar + 1 :])
    ]


def _shown(value):
    return readable(repr(value), SHOWN)
