"""The house: three floors without a stair back up, no circle of modules, few parameters in what is compiled."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

PROJECT = Path(__file__).parents[1]
FLOORS = ("analytic", "engines", "comparisons")
FILES = {
    ".".join(file.relative_to(PROJECT).with_suffix("").parts).removesuffix(".__init__"): file
    for floor in FLOORS
    for file in (PROJECT / floor).rglob("*.py")
}
TREES = {name: ast.parse(file.read_text(encoding="utf-8")) for name, file in FILES.items()}
MOST = 8  # parameters of a compiled function


def imported(name):
    """Modules of the project that a module imports, wherever in it, for a type checker too."""
    package = name if FILES[name].name == "__init__.py" else name.rpartition(".")[0]
    found = set()
    for node in ast.walk(TREES[name]):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            inside = [f"{base}.{alias.name}" for alias in node.names]
            found.update(one if one in FILES else base for one in inside)
    return (found & FILES.keys()) - {name}


GRAPH = {name: imported(name) for name in FILES}


def test_no_floor_imports_one_above_it():
    for name, others in GRAPH.items():
        floor = FLOORS.index(name.partition(".")[0])
        assert all(FLOORS.index(other.partition(".")[0]) <= floor for other in others), name


def test_no_modules_import_each_other_in_a_circle():
    """`graphlib.CycleError` names the modules of a circle."""
    assert len(list(TopologicalSorter(GRAPH).static_order())) == len(FILES) > 200


def test_no_compiled_function_takes_more_parameters_than_one_can_keep_in_order():
    compiled = {"inner", "inlined", "entry", "njit"}
    found = {}
    for name, tree in TREES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                decorators = {getattr(getattr(one, "func", one), "id", "") for one in node.decorator_list}
                if decorators & compiled:
                    found[f"{name}.{node.name}"] = len(node.args.args)
    assert len(found) > 60 and not {name: count for name, count in found.items() if count > MOST}
