"""Nothing in `comparisons` knows an engine, or a variant of one, by its name: it asks `engines` which can do what."""

import ast
import re
from pathlib import Path

from engine_cases import VARIANTS

import comparisons
from engines import BUILT_IN

FOLDER = Path(comparisons.__file__).parent
ENGINE = re.compile(rf"(?<![\w-])({'|'.join(BUILT_IN)})(?![\w-])", re.IGNORECASE)
VARIANT = re.compile(rf"(^|, )({'|'.join(sorted({name for own in VARIANTS.values() for name in own}))})$")


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


def test_no_module_or_template_names_an_engine():
    seen = ('CORNERS = "exudyn, compliant-corners"', 'T = "a step (PyBullet)"', "from engines.pybullet import scene")
    assert all(map(names_in, seen)) and names_in('"""As exudyn does."""\nKIND = "fixed-step RK4"\n') == []
    assert {file: names for file in FOLDER.rglob("*.py") if (names := names_in(file.read_text()))} == {}
    templates = list(FOLDER.rglob("*.html"))
    assert templates and not [file.name for file in templates if ENGINE.search(file.read_text())]
