"""The house: three floors without a stair back up, no circle of modules, few parameters in what is compiled."""

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

from analytic.advice.margins import LIMIT_STATES
from analytic.response import DIFFERENCES, KINDS, OUTCOMES
from comparisons.plotting.margins import COLOURS, DOUBTS, _names
from comparisons.plotting.wording import OUTCOMES as TOLD
from comparisons.report.statue import WORDS, WORST
from engines.comparison import END

PROJECT = Path(__file__).parents[1]
FLOORS = ("analytic", "engines", "comparisons")
FILES = {
    ".".join(file.relative_to(PROJECT).with_suffix("").parts).removesuffix(".__init__"): file
    for floor in FLOORS
    for file in (PROJECT / floor).rglob("*.py")
}
PEAKS = ("peak_tilt", "pedestal_tilt", "peak_base_displacement", "peak_slip")
IMPACTS = ("restitution", "impact_loss", "missing_impacts", "extra_impacts")
MOST = 8  # parameters of a compiled function


@cache
def trees():
    return {name: ast.parse(file.read_text(encoding="utf-8")) for name, file in FILES.items()}


def imported(name):
    """Modules of the project that a module imports, wherever in it, for a type checker too."""
    package = name if FILES[name].name == "__init__.py" else name.rpartition(".")[0]
    found = set()
    for node in ast.walk(trees()[name]):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            inside = [f"{base}.{alias.name}" for alias in node.names]
            found.update(one if one in FILES else base for one in inside)
    return (found & FILES.keys()) - {name}


@cache
def graph():
    return {name: imported(name) for name in FILES}


def test_no_floor_imports_one_above_it():
    for name, others in graph().items():
        floor = FLOORS.index(name.partition(".")[0])
        assert all(FLOORS.index(other.partition(".")[0]) <= floor for other in others), name


def test_no_modules_import_each_other_in_a_circle():
    """`graphlib.CycleError` names the modules of a circle."""
    assert len(list(TopologicalSorter(graph()).static_order())) == len(FILES) > 100


def test_no_study_imports_another_study():
    """What studies share has a room outside `comparisons.studies`."""

    def study(module):
        parts = module.split(".")
        return parts[2] if parts[:2] == ["comparisons", "studies"] and len(parts) > 3 else None

    pairs = {(study(name), study(other)) for name, others in graph().items() for other in others}
    assert not [pair for pair in pairs if None not in pair and len(set(pair)) > 1] and ("statues", "statues") in pairs


# Where any exception may be caught: an engine's or another package's code is called or imported, the process ends, or
# the error is raised again. None stands between a command and the model.
BROAD = {
    "engines.contract": 3,  # another package's adapter is imported, its versions asked for; another package is imported
    "engines.guard": 1,  # an engine runs
    "engines.simulating": 1,  # raised again, with a note
    "comparisons.execution.sweep": 2,  # a solver and a measure run; raised again
    "comparisons.execution.cluster": 1,  # Dask, as it ends
    "comparisons.report.answer": 1,  # the page of a result of another version, or of another package's study
    "comparisons.report.detail": 1,  # likewise; raised again where the code is that of the result
    "comparisons.studies": 1,  # another package is imported
    "comparisons.studies.shake_table.campaign": 1,  # openpyxl
    "comparisons.cli": 4,  # the process ends; raised again, unless it is a message for the user
}


def test_any_exception_is_caught_only_where_foreign_code_runs_or_it_is_raised_again():
    found = {}
    for name, tree in trees().items():
        for node in ast.walk(tree):
            caught = [node.type] if isinstance(node, ast.ExceptHandler) else []
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "suppress":
                caught = node.args
            if any(one is None or getattr(one, "id", "") in ("Exception", "BaseException") for one in caught):
                found[name] = found.get(name, 0) + 1
    assert found == BROAD


def test_sets_of_words_that_are_written_as_json_stand_in_one_place():
    """A schema takes its words from the list that the code goes by; `peak_slip` stood in one of two lists."""
    for name, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Subscript) and getattr(node.value, "id", "") == "Literal":
                words = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
                several = sum(isinstance(one, ast.Constant) for one in words) > 1
                assert not (several and ".schemas" in name), f"{name}, line {node.lineno}"


def test_what_is_keyed_by_a_set_of_words_has_all_of_them():
    outcomes, upright = set(OUTCOMES), set(OUTCOMES) - {"failed"}
    assert set(COLOURS) == set(WORST) == set(WORDS) == outcomes and set(TOLD) == upright
    assert {kind for kind, _ in DOUBTS} == set(KINDS) and all((kind, None) in DOUBTS for kind in KINDS)
    assert set(_names(0.5)) == set(LIMIT_STATES)
    assert {*END, *PEAKS, *IMPACTS} == set(DIFFERENCES)


def test_no_compiled_function_takes_more_parameters_than_one_can_keep_in_order():
    compiled = {"inner", "inlined", "entry", "cached", "njit"}
    found = {}
    for name, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                decorators = {getattr(getattr(one, "func", one), "id", "") for one in node.decorator_list}
                if decorators & compiled:
                    found[f"{name}.{node.name}"] = len(node.args.args)
    assert len(found) > 60 and not {name: count for name, count in found.items() if count > MOST}
