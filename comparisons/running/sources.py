"""Which source files a number depends on, as digests of their code: comments, docstrings and layout do not count."""

import ast
import functools
import hashlib
import importlib.util
import tomllib
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from pathlib import Path

from analytic.scene_file import SHIPPED, shipped_scenes

PROJECT = ("analytic", "engines", "comparisons")
SCENES = "analytic.scenes."  # and the name of a shipped scene: as modules are called, so are they
SHIPPED_NAMES = shipped_scenes()
# What runs, stores, checks and describes runs computes no number of theirs; `cases` says what is run.
CARRIES_OUT, COMPUTES = ("comparisons.running", "comparisons.schemas"), "comparisons.running.cases"
# (node, field) that say nothing of a number: types of arguments and results, and where an imported name comes from
SILENT = {("arg", "annotation"), ("FunctionDef", "returns"), ("ImportFrom", "module"), ("ImportFrom", "level")}


def source_digests(modules: Iterable[str]) -> dict[str, str]:
    """Digest of every project source file that `modules` reach through their imports.

    Parameters
    ----------
    modules : iterable of str
        Dotted names (``analytic``, ``engines.exudyn.adapter``). Imports are followed, inside functions too,
        but only within `PROJECT` and the top-level packages of `modules` themselves, and not into what carries runs
        out (`computes`). A package that holds a module
        is not followed for that: what a study's package imports to show a result says nothing of how it was found.

    Returns
    -------
    dict
        Dotted module name -> hexadecimal digest of its code, sorted by name; and so of the scenes that the package
        ships, where a module names them (``analytic.scenes.caryatid-rigid``). Neither rewording nor moving a module
        changes its digest.

    Raises
    ------
    ModuleNotFoundError
        One of `modules` does not exist.
    """
    waiting = list(modules)
    if absent := [name for name in waiting if _file(name) is None]:
        raise ModuleNotFoundError(f"no source file for module {absent[0]!r}")
    within = {*PROJECT, *(name.partition(".")[0] for name in waiting)}
    digests: dict[str, str] = {}
    while waiting:
        name = waiting.pop()
        if name in digests or name.partition(".")[0] not in within or not computes(name):
            continue
        if file := _file(name):
            digests[name], imported = _read(file)
            package = name if file.name == "__init__.py" else name.rpartition(".")[0]
            waiting += [importlib.util.resolve_name(other, package) for other in imported]
    return dict(sorted(digests.items()))


def computes(name: str) -> bool:
    """Whether a number may depend on the module of this name, and does not only go through it."""
    return name == COMPUTES or not any(f"{name}.".startswith(f"{one}.") for one in CARRIES_OUT)


def digests_of_all(packages: Iterable[str]) -> set[str]:
    """Digests of every source file of some packages or modules, as a set: what the code holds, wherever it lies."""
    digests: set[str] = set()
    for package in packages:
        if file := _file(package):
            inside = file.parent.rglob("*.py") if file.name == "__init__.py" else [file]
            digests.update(_read(path)[0] for path in [*inside, *file.parent.glob("scenes/*.toml")])
    return digests


def version_of(package: str) -> str | None:
    """Version of an installed package, also where its distribution has another name (pydrake's is drake); else None."""
    try:
        return version(package)
    except PackageNotFoundError:
        distribution = packages_distributions().get(package)
        return version(distribution[0]) if distribution else None


def _file(name):
    if name.startswith(SCENES):
        return SHIPPED / f"{name.removeprefix(SCENES)}.toml"
    try:
        spec = importlib.util.find_spec(name)
    except ModuleNotFoundError:  # `name` is a function or class of a module, not a module
        return None
    origin = spec.origin if spec else None
    return Path(origin) if origin and origin.endswith(".py") else None


def _read(file):
    """(digest, names imported as the file says them) of the file of a module, or of a scene."""
    if file.suffix == ".toml":
        return _digest(tomllib.loads(file.read_text(encoding="utf-8"))), ()
    return _parsed(str(file), file.stat().st_mtime_ns)  # with its time: a file edited meanwhile is read again


@functools.cache
def _parsed(file, _modified):
    tree = _ForNumbers().visit(ast.parse(Path(file).read_bytes()))
    imported: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imported.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            imported.update([base, *(f"{base}{'.' * bool(node.module)}{alias.name}" for alias in node.names)])
        elif isinstance(node, ast.Constant) and node.value in SHIPPED_NAMES:
            imported.add(f"{SCENES}{node.value}")
    return _digest(_plain(tree)), tuple(sorted(imported))


class _ForNumbers(ast.NodeTransformer):
    """Takes docstrings, and what is imported for a type checker only, out of a tree."""

    def visit_Expr(self, node):
        return None if isinstance(node.value, ast.Constant) else node

    def visit_If(self, node):
        self.generic_visit(node)
        return node.orelse if getattr(node.test, "id", None) == "TYPE_CHECKING" else node


def _plain(node):
    """The tree as tuples, without `SILENT` and empty fields (which differ between Python versions)."""
    if isinstance(node, list):
        return tuple(map(_plain, node))
    if not isinstance(node, ast.AST):
        return node
    kind = type(node).__name__
    fields = {name: value for name, value in ast.iter_fields(node) if (kind, name) not in SILENT}
    return kind, *((name, _plain(value)) for name, value in fields.items() if value is not None and value != [])


def _digest(content):
    return hashlib.sha256(repr(content).encode()).hexdigest()
