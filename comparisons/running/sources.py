"""Which source files a number depends on, as digests that ignore comments, docstrings, types and where modules lie."""

import ast
import functools
import hashlib
import importlib.util
import tomllib
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from pathlib import Path

from analytic.scene_file import SHIPPED, shipped_scenes

PROJECT = ("analytic", "engines", "comparisons")
SCENES = "analytic.scenes."  # and the name of a shipped scene: as modules are called, so are they
SHIPPED_NAMES = shipped_scenes()


def source_digests(modules: Iterable[str]) -> dict[str, str]:
    """Digest of every project source file that `modules` reach through their imports.

    Parameters
    ----------
    modules : iterable of str
        Dotted names (``analytic``, ``engines.exudyn.adapter``). Imports are followed, inside functions too,
        but only within `PROJECT` and the top-level packages of `modules` themselves. A package that holds a module
        is not followed for that: what a study's package imports to show a result says nothing of how it was found.

    Returns
    -------
    dict
        Dotted module name -> hexadecimal digest of its code, sorted by name; and so of the scenes that the package
        ships, where a module names them (``analytic.scenes.caryatid-rigid``). Comments, docstrings and layout do not
        count, nor types, but for the fields of classes; of an import count only the names that it binds: neither
        rewording nor moving nor annotating makes a result stale.

    Raises
    ------
    ModuleNotFoundError
        One of `modules` does not exist.
    """
    within = {*PROJECT, *(name.partition(".")[0] for name in modules)}
    digests, waiting = {}, []
    for name in modules:
        if _file(name) is None:
            raise ModuleNotFoundError(f"no source file for module {name!r}")
        waiting.append(name)
    while waiting:
        name = waiting.pop()
        file = _file(name) if name not in digests else None
        if file is None:
            continue
        if file.suffix == ".toml":
            digests[name] = _scene_digest(file)
            continue
        # The time stamp is part of the cache's key: a file edited meanwhile is read again.
        digests[name], imported = _read(name, str(file), file.stat().st_mtime_ns)
        waiting += [other for other in imported if other.partition(".")[0] in within]
    return dict(sorted(digests.items()))


def version_of(package: str) -> str | None:
    """Version of an installed package, also where its distribution has another name (pydrake's is drake); else None."""
    try:
        return version(package)
    except PackageNotFoundError:
        distribution = packages_distributions().get(package)
        return version(distribution[0]) if distribution else None


def digest_of(digests: Mapping[str, str]) -> str:
    """One digest for a dict of digests, whatever their names."""
    return hashlib.sha256(repr(sorted(digests.values())).encode()).hexdigest()


def digests_of_all(packages: Iterable[str]) -> set[str]:
    """Digests of every source file of some packages or modules, as a set: what the code holds, wherever it lies."""
    digests: set[str] = set()
    for package in packages:
        file = _file(package)
        if file is None:
            continue
        inside = file.parent.rglob("*.py") if file.name == "__init__.py" else [file]
        digests.update(_read(package, str(path), path.stat().st_mtime_ns)[0] for path in inside)
        digests.update(_scene_digest(path) for path in file.parent.glob("scenes/*.toml"))
    return digests


def _scene_digest(path):
    return hashlib.sha256(repr(tomllib.loads(path.read_text(encoding="utf-8"))).encode()).hexdigest()


def _file(name):
    if name.startswith(SCENES):
        return SHIPPED / f"{name.removeprefix(SCENES)}.toml"
    try:
        spec = importlib.util.find_spec(name)
    except ModuleNotFoundError:  # `name` is a function or class of a module, not a module
        return None
    origin = spec.origin if spec else None
    return Path(origin) if origin and origin.endswith(".py") else None


@functools.cache
def _read(name, file, _modified):
    tree = _without_types(ast.parse(Path(file).read_bytes()))
    package = name if file.endswith("__init__.py") else name.rpartition(".")[0]
    imported: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imported.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, base] if base else above)
            imported.add(base)
            imported.update(f"{base}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant) and node.value in SHIPPED_NAMES:
            imported.add(f"{SCENES}{node.value}")
    return hashlib.sha256(_code(tree).encode()).hexdigest(), tuple(sorted(imported))


def _without_types(tree):
    """The tree without what only a type checker reads: annotations, and imports for them alone. Fields keep theirs."""
    types = _Types()
    tree = types.visit(tree)
    code = {getattr(node, "id", getattr(node, "value", None)) for node in ast.walk(tree) if _names(node)}
    for_types = types.names - code

    def kept(node):
        if isinstance(node, ast.Import | ast.ImportFrom):
            node.names = [alias for alias in node.names if (alias.asname or alias.name) not in for_types]
            return bool(node.names) and getattr(node, "module", None) != "__future__"
        return True

    for node in ast.walk(tree):
        for field, value in ast.iter_fields(node):
            if isinstance(value, list):
                setattr(node, field, [item for item in value if kept(item)])
    return tree


def _names(node):
    """Whether it is a name, or text that may be one (in ``__all__``)."""
    return isinstance(node, ast.Name) or isinstance(node, ast.Constant) and isinstance(node.value, str)


class _Types(ast.NodeTransformer):
    """Takes the annotations of functions and of variables outside classes out of a tree, and keeps their names."""

    def __init__(self) -> None:
        self.names: set[str] = set()
        self.in_class = False

    def take(self, node):
        self.names.update(part.id for part in ast.walk(node) if isinstance(part, ast.Name))

    def visit_FunctionDef(self, node):
        for part in (node, *(part for part in ast.walk(node.args) if isinstance(part, ast.arg))):
            field = "returns" if part is node else "annotation"
            if getattr(part, field) is not None:
                self.take(getattr(part, field))
                setattr(part, field, None)
        outside, self.in_class = self.in_class, False
        self.generic_visit(node)
        self.in_class = outside
        return node

    def visit_ClassDef(self, node):
        outside, self.in_class = self.in_class, True
        self.generic_visit(node)
        self.in_class = outside
        return node

    def visit_AnnAssign(self, node):
        if self.in_class:
            return self.generic_visit(node)
        self.take(node.annotation)
        self.generic_visit(node)
        return ast.Assign([node.target], node.value) if node.value else None

    def visit_If(self, node):
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            self.names.update(name.id for name in ast.walk(node) if isinstance(name, ast.Name))
            return None
        return self.generic_visit(node)


def _code(node):
    """The tree as text, without docstrings and empty fields (which differ between Python versions)."""
    if isinstance(node, list):
        return "[" + ",".join(map(_code, node)) + "]"
    if isinstance(node, ast.Import | ast.ImportFrom):
        return f"Import({','.join(sorted(alias.asname or alias.name for alias in node.names))})"
    if not isinstance(node, ast.AST):
        return repr(node)
    fields = []
    for field, value in ast.iter_fields(node):
        if field == "body" and isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            value = value[1:] if ast.get_docstring(node, clean=False) is not None else value
        if value is not None and value != []:
            fields.append(f"{field}={_code(value)}")
    return f"{type(node).__name__}({','.join(fields)})"
