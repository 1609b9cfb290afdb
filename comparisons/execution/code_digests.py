"""Digests of the code that a number depends on, definition by definition.

Comments, docstrings, layout, and the module in which a definition stands do not count. A definition is a statement of a
module other than an import: a function, a class, a constant, a table. What it reads is found by the names in it: names
of its own module and names that it imports, also inside functions. A class counts as a whole, because a name does not
tell which method is called.
"""

import ast
import functools
import hashlib
import importlib.util
import re
import symtable
import textwrap
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from pathlib import Path
from typing import Any, TypeGuard

from analytic.scene_file import SHIPPED, shipped_scenes

PROJECT = ("analytic", "engines", "comparisons")
SHIPPED_NAMES = shipped_scenes()
# These modules run, store, check and describe runs, or keep compiled code, and compute no number. The exception is
# `cases`, which says what is run.
CARRIES_OUT, COMPUTES = (
    ("comparisons.execution", "comparisons.schemas", "analytic.kernel.cache"),
    "comparisons.execution.cases",
)
DIGITS = 8  # kept of a digest: with a thousand definitions, about one change in 1e6 goes undetected


# {name of moved code in stored results: where it stands today}
ALIASES: dict[str, str] = {
    "comparisons.measuring.scripts:simulate_script": "comparisons.metrics.scripts:simulate_script",
    "comparisons.studies.caryatid.runs:measure": "comparisons.studies.caryatid.study:measure",
    "analytic.time_stepping:simulate_time_stepping": "analytic.checks.time_stepping:simulate_time_stepping",
    "analytic.twin:simulate_twin": "analytic.checks.twin:simulate_twin",
    "comparisons.studies.autopsy.study:measure": "comparisons.studies.restitution.study:taken_apart",
    "comparisons.studies.overturning.study:measure": "comparisons.metrics.boundaries:measure",
    "comparisons.studies.random_scenes.study:compared": "comparisons.studies.statues.study:of_engine",
    "comparisons.studies.random_scenes.study:plan": "comparisons.studies.statues.study:plan",
    "comparisons.studies.sliding.study:of_engine": "comparisons.studies.statues.study:of_engine",
    "comparisons.studies.sliding.study:of_model": "comparisons.studies.statues.study:of_model",
    "comparisons.studies.sliding.study:plan": "comparisons.studies.statues.study:plan",
    "comparisons.studies.tolerances.study:plan": "comparisons.metrics.agreement:measure_all",
}
TABLE_OF_TOLERANCES = re.compile(
    r"(engines\.\w+)\.tolerances:TOLERANCES"
)  # the table of an engine now stands in its record


def source_digests(roots: Iterable[str]) -> dict[str, str]:
    """Return the digest of every definition of the project that `roots` reach.

    Parameters
    ----------
    roots : iterable of str
        Whole modules (``engines.exudyn.adapter``) or definitions (``analytic:simulate``). What they read is followed
        within `PROJECT` and the top-level packages of the roots, but not into modules that only carry out runs
        (`computes`).

    Returns
    -------
    dict
        {name of the definition, with its module: digest of its code and of the code of all that it reads}, sorted by
        name. Shipped scenes that a definition names are included (``analytic.scenes.caryatid-rigid``).

    Raises
    ------
    ModuleNotFoundError
        The module of a root does not exist, or has no such definition.
    """
    roots = list(roots)
    code = code_of(map(package_of, roots))
    return dict(sorted((code.named(place), code.digest(place)) for place in code.reached(roots)))


def kept_digests(roots: Iterable[str]) -> dict[str, str]:
    """Return the digests that a result stores: {root: the joined digests that earlier roots do not have}."""
    known: set[str] = set()
    kept = {}
    for root in roots:
        added = set(source_digests([root]).values()) - known
        kept[root] = "".join(sorted(added))
        known |= added
    return kept


def changes(kept: Mapping[str, str]) -> list[str]:
    """Return names of the definitions that have changed since `kept_digests` were stored, and of roots that are gone.

    A definition that reads another changed one is not named.
    """
    known = {text[k : k + DIGITS] for text in kept.values() for k in range(0, len(text), DIGITS)}
    roots = list(map(today, kept))
    code, present, gone = code_of(map(package_of, roots)), list[str](), list[str]()
    for root in roots:
        (present if code.root(root) else gone).append(root)
    changed = {place for place in code.reached(present) if code.digest(place) not in known}
    return gone + sorted(code.named(place) for place in changed if not changed & {*code.reads(place)} - {place})


def today(name: str) -> str:
    """Return the present name of the module or "module:definition" that a stored result calls `name`."""
    return ALIASES.get(name, TABLE_OF_TOLERANCES.sub(r"\1:TOLERANCES", name))


def computes(name: str) -> bool:
    """Return whether a number may depend on the code of this module. False: the module only carries out runs."""
    return name == COMPUTES or not any(f"{name}.".startswith(f"{module}.") for module in CARRIES_OUT)


def digests_of_all(packages: Iterable[str]) -> set[str]:
    """Return the digests of all definitions of the project and of further packages."""
    code = code_of(packages)
    return {code.digest(place) for place in code.all()}


@functools.cache  # a version does not change within a process
def version_of(package: str) -> str | None:
    """Return the version of an installed package or None. Its distribution may have another name (pydrake: drake)."""
    try:
        return version(package)
    except PackageNotFoundError:
        distribution = packages_distributions().get(package)
        return version(distribution[0]) if distribution else None


@dataclass(frozen=True)
class Place:
    """A definition: its module and the number of its statement. With `SCENE`: the shipped scene of that name."""

    module: str
    number: int


SCENE = -1


@dataclass(frozen=True)
class Unit:
    """A statement of a module.

    names: the names that it binds. code: digest of its own code. reads: the names that it reads, each with the
    attributes after it ("kernel", "run"). local: what its functions import, as `Module.imports`. scenes: the shipped
    scenes that it names.
    """

    names: tuple[str, ...]
    code: str
    reads: frozenset[tuple[str, ...]]
    local: Mapping[str, tuple[str, str]]
    scenes: tuple[str, ...]


@dataclass(frozen=True)
class Module:
    """The statements of a module. imports: {name here: (its module, its name there or "" for the module itself)}."""

    units: tuple[Unit, ...]
    imports: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def binding(self, name: str) -> list[int]:
        return [k for k, unit in enumerate(self.units) if name in unit.names]


class Code:
    """The definitions of some top-level packages, and what they read. A file is read once, when first needed."""

    def __init__(self, packages: Iterable[str]) -> None:
        self.packages = frozenset(packages)
        self.file, self.module = functools.cache(_file), functools.cache(_module)
        self.of, self.targets = functools.cache(self._of), functools.cache(self._targets)
        self.digest, self.reads = functools.cache(self._digest), functools.cache(self._reads)

    def all(self) -> Iterator[Place]:
        """Yield all definitions, and the shipped scenes."""
        for name, _ in _modules(self.packages):
            yield from (place for place in self.of(name, ()) if isinstance(place, Place))
        yield from (Place(scene, SCENE) for scene in SHIPPED_NAMES)

    def root(self, root: str) -> list[Place]:
        """Return the definitions of a root; none if it is gone."""
        module, _, name = root.partition(":")
        reached = self.of(module, tuple(name.split(".")) if name else ()) if self.file(module) else ()
        return [place for place in reached if isinstance(place, Place)]

    def reached(self, roots: Iterable[str]) -> set[Place]:
        """Return the definitions that roots reach, including their own."""
        waiting = []
        for root in roots:
            if not (places := self.root(root)) and not self.file(root):
                raise ModuleNotFoundError(f"no source for {root!r}")
            waiting += places
        known: set[Place] = set()
        while waiting:
            place = waiting.pop()
            if place not in known:
                known.add(place)
                waiting += [*self.reads(place), *self.nameless(place)]
        return known

    def _digest(self, place: Place) -> str:
        """Digest of a definition's code and of all that its names stand for."""
        if place.number == SCENE:
            return self._own(place)
        targets_by_name = {
            name: sorted(self._own(target) if isinstance(target, Place) else target for target in targets)
            for name, targets in self.targets(place).items()
        }
        return _digest((self._own(place), sorted(targets_by_name.items())))[:DIGITS]

    def _reads(self, place: Place) -> list[Place]:
        """The definitions that a definition reads by name."""
        if place.number == SCENE:
            return []
        return [target for targets in self.targets(place).values() for target in targets if isinstance(target, Place)]

    def nameless(self, place: Place) -> list[Place]:
        """Return the statements without a name that run when the definition's module is imported."""
        if place.number == SCENE:
            return []
        units = self.module(place.module).units
        return [Place(place.module, k) for k, unit in enumerate(units) if not unit.names]

    def named(self, place: Place) -> str:
        """Return the full name of a definition."""
        if place.number == SCENE:
            return f"analytic.scenes.{place.module}"
        names = self.module(place.module).units[place.number].names
        return f"{place.module}.{names[0] if names else f'statement {place.number}'}"

    def _own(self, place):
        if place.number == SCENE:
            return _scene(place.module)[:DIGITS]
        return self.module(place.module).units[place.number].code

    def _targets(self, place):
        """{name as it is read: the definitions that it stands for, or its full name if it is another package's}."""
        unit = self.module(place.module).units[place.number]
        stands_for = {}
        for chain in unit.reads:
            name, *rest = chain
            if name in unit.local:
                targets = self._imported(unit.local[name], tuple(rest))
            else:
                targets = self.of(place.module, chain)
            others = [target for target in targets if target != place]
            if others:
                stands_for[".".join(chain)] = others
        for scene in unit.scenes:
            stands_for[f"scene {scene}"] = [Place(scene, SCENE)]
        return stands_for

    def _of(self, module: str, chain: tuple[str, ...]) -> list[Place | str]:
        """The definitions that a chain of names stands for in a module; the whole module for an empty chain."""
        if package_of(module) not in self.packages:
            return [".".join((module, *chain[:1]))]
        if self.file(module) is None:  # a folder of modules, or nothing
            return self.of(f"{module}.{chain[0]}", chain[1:]) if chain and self.file(f"{module}.{chain[0]}") else []
        if not computes(module):
            return []
        here = self.module(module)
        if not chain:
            return [Place(module, k) for k in range(len(here.units))]
        if chain == ("globals",):  # the whole module, and all that it imports
            places = [target for source in here.imports.values() for target in self._imported(source, ())]
            return [*places, *(Place(module, k) for k in range(len(here.units)))]
        if numbers := here.binding(chain[0]):
            return [Place(module, k) for k in numbers]
        if here.imports.get(chain[0], (module, chain[0])) != (
            module,
            chain[0],
        ):  # otherwise it is a module of the package
            return self._imported(here.imports[chain[0]], chain[1:])
        if self.file(module).name == "__init__.py" and self.file(f"{module}.{chain[0]}"):
            return self.of(f"{module}.{chain[0]}", chain[1:])
        return []

    def _imported(self, source: tuple[str, str], rest: tuple[str, ...]) -> list[Place | str]:
        module, name = source
        return self.of(module, (name, *rest) if name else rest)


def package_of(root: str) -> str:
    """Return the top-level package of a root."""
    return root.partition(":")[0].partition(".")[0]


def code_of(packages: Iterable[str]) -> Code:
    """Return the present `Code` of the project and of further packages."""
    names = frozenset({*PROJECT, *packages})
    files = [*(file for _, file in _modules(names)), *sorted(SHIPPED.glob("*.toml"))]
    return _code(names, tuple((str(file), file.stat().st_mtime_ns) for file in files))


@functools.lru_cache(maxsize=4)
def _code(names, _files):
    return Code(names)


def _modules(packages: Iterable[str]) -> Iterator[tuple[str, Path]]:
    """Yield (name, file) of all modules of some packages."""
    for package in packages:
        file = _file(package)
        if file and file.name == "__init__.py":
            for path in sorted(file.parent.rglob("*.py")):
                inner = path.relative_to(file.parent).with_suffix("").parts
                yield ".".join((package, *(inner[:-1] if inner[-1] == "__init__" else inner))), path
        elif file:
            yield package, file


def _file(name):
    """The file of a module, or None if there is no such module or no source of it. Only its package is imported."""
    package, *inner = name.split(".")
    spec = importlib.util.find_spec(package)
    places = spec and spec.submodule_search_locations
    if not inner:
        return Path(spec.origin) if spec and spec.origin and spec.origin.endswith(".py") else None
    for place in places or ():
        for path in (Path(place, *inner).with_suffix(".py"), Path(place, *inner, "__init__.py")):
            if path.is_file():
                return path
    return None


def _module(name):
    file = _file(name)
    package = name if file.name == "__init__.py" else name.rpartition(".")[0]
    return _parsed(str(file), package, file.stat().st_mtime_ns)  # an edited file has another time, and is read again


def _scene(name):
    return _digest(tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8")))


@functools.cache
def _parsed(file, package, _modified):
    text = Path(file).read_text(encoding="utf-8")
    lines, units, imports, body = text.splitlines(), [], {}, ast.parse(text).body
    if any(isinstance(node, ast.FunctionDef) and node.name == "__getattr__" for node in body):
        # what a package imports when it is first used, it imports for types as well
        body = [each for node in body for each in (node.body if _for_types(node) else [node])]
    for node in _ForNumbers().visit(ast.Module(body, [])).body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            imports.update(_bound(node, package))
        else:
            units.append(_unit(node, package, lines))
    return Module(tuple(units), imports)


def _bound(node, package):
    """{name: (module, name there)} of an import statement, as in `Module.imports`."""
    if isinstance(node, ast.Import):
        whole = {alias.asname: (alias.name, "") for alias in node.names if alias.asname}
        return whole | {
            name: (name, "") for alias in node.names if not alias.asname for name in alias.name.split(".")[:1]
        }
    base = importlib.util.resolve_name("." * node.level + (node.module or ""), package) if node.level else node.module
    return {alias.asname or alias.name: (base, alias.name) for alias in node.names}


def _unit(node, package, lines):
    start = min(part.lineno for part in (node, *getattr(node, "decorator_list", ())))
    text = textwrap.dedent("\n".join(lines[start - 1 : node.end_lineno]))
    table = symtable.symtable(f"from __future__ import annotations\n{text}", "unit", "exec")
    reading = Reading(package)
    code = _digest(reading.plain(node))
    added = {"annotations"}  # bound by the line put before the statement
    read = (_global(table) | reading.types | reading.imports.keys()) - added
    reads = {chain for chain in reading.chains if chain[0] in read}
    reads |= {(name,) for name in reading.imports if not any(chain[0] == name for chain in reads)}
    bound = (symbol.get_name() for symbol in table.get_symbols() if symbol.is_assigned() or symbol.is_imported())
    names = tuple(name for name in bound if name not in added)
    return Unit(names, code, frozenset(reads), reading.imports, tuple(sorted(reading.scenes)))


def _global(table):
    """The names that a statement and the functions in it read from outside."""
    top = table.get_type() == "module"
    here = {
        symbol.get_name() for symbol in table.get_symbols() if (symbol.is_referenced() if top else symbol.is_global())
    }
    return here.union(*map(_global, table.get_children()))


@dataclass
class Reading:
    """Collects what a statement reads, while its tree is turned into tuples.

    chains: names with the attributes after them. types: names in the types of fields. imports: as `Module.imports`.
    scenes: shipped scenes.
    """

    package: str
    chains: set[tuple[str, ...]] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)
    scenes: set[str] = field(default_factory=set)

    def plain(self, node: Any, behind: tuple[str, ...] = ()) -> Any:
        """Return the tree as tuples. behind: the attributes that follow the node.

        Empty fields are left out, because they differ between Python versions, and the modules of imports.
        """
        if isinstance(node, list):
            return tuple(map(self.plain, node))
        if not isinstance(node, ast.AST):
            return node
        kind, fields = type(node).__name__, dict(ast.iter_fields(node))
        if isinstance(node, ast.Name):
            self.chains.add((node.id, *behind))
        elif isinstance(node, ast.Attribute):
            return kind, ("attr", node.attr), ("value", self.plain(node.value, (node.attr, *behind)))
        elif isinstance(node, ast.Import | ast.ImportFrom):
            self.imports.update(_bound(node, self.package))
            fields = {"names": node.names}
        elif isinstance(node, ast.AnnAssign):
            self.types |= {name.id for name in ast.walk(node.annotation) if isinstance(name, ast.Name)}
        elif isinstance(node, ast.Constant) and node.value in SHIPPED_NAMES:
            self.scenes.add(node.value)
        return kind, *((name, self.plain(value)) for name, value in fields.items() if value is not None and value != [])


def _for_types(node: ast.AST) -> TypeGuard[ast.If]:
    return isinstance(node, ast.If) and getattr(node.test, "id", None) == "TYPE_CHECKING"


class _ForNumbers(ast.NodeTransformer):
    """Removes from a tree what no number depends on: docstrings, types of arguments and results, imports for types."""

    def visit_Expr(self, node):
        return None if isinstance(node.value, ast.Constant) else self.generic_visit(node)

    def visit_If(self, node):
        self.generic_visit(node)
        return node.orelse if _for_types(node) else node

    def visit_arg(self, node):
        node.annotation = None
        return node

    def visit_FunctionDef(self, node):
        node.returns = None
        return self.visit_ClassDef(node)

    def visit_ClassDef(self, node):
        self.generic_visit(node)
        node.body = node.body or [ast.Pass()]
        return node


def _digest(content):
    return hashlib.sha256(repr(content).encode()).hexdigest()
