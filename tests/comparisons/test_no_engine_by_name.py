"""Nothing in `comparisons` knows an engine, or a variant of one, by its name: it asks `engines` which can do what."""

import ast
import re
from pathlib import Path

import pytest

import comparisons
from engines import BUILT_IN, ENGINES

FOLDER = Path(comparisons.__file__).parent
VARIANTS = {variant for name in BUILT_IN if ENGINES[name].installed for variant in ENGINES[name].variants}
ENGINE = re.compile(rf"(?<![\w-])({'|'.join(BUILT_IN)})(?![\w-])", re.IGNORECASE)
VARIANT = re.compile(rf"(^|, )({'|'.join(sorted(VARIANTS))})$")


def names_in(source):
    """(line, what) of every string but docstrings that names an engine or a variant, and every import of an engine."""
    nodes, found = list(ast.walk(ast.parse(source))), []
    prose = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}  # docstrings
    for node in nodes:
        words = []
        if isinstance(node, ast.Import | ast.ImportFrom):
            words = [getattr(node, "module", None) or "", *(name.name for name in node.names)]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            words = [node.value]
        found += [(node.lineno, word) for word in words if ENGINE.search(word) or VARIANT.search(word)]
    return found


@pytest.mark.parametrize(
    "line",
    [
        'ENGINES = ("exudyn", "pybullet")',
        'if "mujoco" in engines: pass',
        'CORNERS = "exudyn, compliant-corners"',
        'TITLE = "Phase of the step (PyBullet)"',
        'words = f"in exudyn {number}"',
        'apart = variant == "compliant-corners"',
        "from engines.pybullet import scene",
        "import mujoco",
    ],
)
def test_a_name_is_seen(line):
    pytest.importorskip("exudyn")  # else its variants are not known
    assert names_in(line)
    assert names_in('"""As exudyn does."""\n# as in PyBullet\nKIND = "fixed-step RK4"\n') == []  # prose is none


def test_no_module_names_an_engine():
    found = {
        str(file.relative_to(FOLDER)): names
        for file in sorted(FOLDER.rglob("*.py"))
        if (names := names_in(file.read_text()))
    }
    assert found == {}


def test_no_template_names_an_engine():
    templates = list(FOLDER.rglob("*.html"))
    assert templates and not [file.name for file in templates if ENGINE.search(file.read_text())]
