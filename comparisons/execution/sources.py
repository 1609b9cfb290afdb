"""Which definitions a number depends on, as digests of their code: comments, docstrings, layout, and the module that a
definition stands in, do not count.

A definition is a statement of a module that is no import: a function, a class, a constant, a table. What it reads is
found by the names in it: those of its own module and those that it imports, also inside functions. A class counts
whole, as nobody can tell by its name which method is called.
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
from typing import Any

from analytic.scene_file import SHIPPED, shipped_scenes

PROJECT = ("analytic", "engines", "comparisons")
SHIPPED_NAMES = shipped_scenes()
# What runs, stores, checks and describes runs, and what keeps compiled code, computes no number of theirs; `cases` says
# what is run.
CARRIES_OUT, COMPUTES = (
    ("comparisons.execution", "comparisons.schemas", "analytic.kernel.cache"),
    "comparisons.execution.cases",
)
DIGITS = 8  # of a digest that is kept: of a thousand definitions one collides by chance in some 1e6 changes


# {a name by which stored results call code: where that stands today}, of what was moved since
ALIASES: dict[str, str] = {
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
TABLE_OF_TOLERANCES = re.compile(r"(engines\.\w+)\.tolerances:TOLERANCES")  # of an engine: stands in its record


def source_digests(roots: Iterable[str]) -> dict[str, str]:
    """Digest of every definition of the project that `roots` reach.

    Parameters
    ----------
    roots : iterable of str
        Modules, with all that they hold (``engines.exudyn.adapter``), or definitions (``analytic:simulate``). What
        they read is followed within `PROJECT` and the top-level packages of the roots, and not into what carries runs
        out (`computes`).

    Returns
    -------
    dict
        Name of the definition with its module's -> digest of its code and of the code of all that it reads by name,
        sorted by name; and so of the scenes that the package ships, where a definition names them
        (``analytic.scenes.caryatid-rigid``).

    Raises
    ------
    ModuleNotFoundError
        The module of a root does not exist, or holds no such definition.
    """
    roots = list(roots)
    code = code_of(map(package_of, roots))
    return dict(sorted((code.named(place), code.digest(place)) for place in code.reached(roots)))


def kept_digests(roots: Iterable[str]) -> dict[str, str]:
    """What a result keeps of `source_digests`: {root: digests that those of the roots before it have not, joined}."""
    known: set[str] = set()
    kept = {}
    for root in roots:
        own = set(source_digests([root]).values()) - known
        kept[root] = "".join(sorted(own))
        known |= own
    return kept


def changes(kept: Mapping[str, str]) -> list[str]:
    """Names of the definitions that are others today than those of which `kept_digests` were kept: of those that do not
    read another such one; and of roots that are gone."""
    known = {text[k : k + DIGITS] for text in kept.values() for k in range(0, len(text), DIGITS)}
    roots = list(map(today, kept))
    code, there, gone = code_of(map(package_of, roots)), list[str](), list[str]()
    for root in roots:
        (there if code.root(root) else gone).append(root)
    others = {place for place in code.reached(there) if code.digest(place) not in known}
    return gone + sorted(code.named(one) for one in others if not others & {*code.reads(one)} - {one})


def today(name: str) -> str:
    """Where what a stored result calls `name`, "module:definition" or a module, stands today."""
    return ALIASES.get(name, TABLE_OF_TOLERANCES.sub(r"\1:TOLERANCES", name))


def computes(name: str) -> bool:
    """Whether a number may depend on the module of this name, and does not only go through it."""
    return name == COMPUTES or not any(f"{name}.".startswith(f"{one}.") for one in CARRIES_OUT)


def digests_of_all(packages: Iterable[str]) -> set[str]:
    """Digests of every definition of the project and of some more packages: what the code holds, wherever it lies."""
    code = code_of(packages)
    return {code.digest(place) for place in code.all()}


@functools.cache  # of this process: another version takes another one
def version_of(package: str) -> str | None:
    """Version of an installed package, also where its distribution has another name (pydrake's is drake); else None."""
    try:
        return version(package)
    except PackageNotFoundError:
        distribution = packages_distributions().get(package)
        return version(distribution[0]) if distribution else None


@dataclass(frozen=True)
class Place:
    """A definition: the module, and the number of its statement; `SCENE`: the shipped scene of that name."""

    module: str
    number: int


SCENE = -1


@dataclass(frozen=True)
class Unit:
    """A statement of a module. names: that it binds. code: digest of its own. reads: names, each with the attributes
    behind it ("kernel", "run"). local: what its functions import, as `Module.imports`. scenes: shipped ones named."""

    names: tuple[str, ...]
    code: str
    reads: frozenset[tuple[str, ...]]
    local: Mapping[str, tuple[str, str]]
    scenes: tuple[str, ...]


@dataclass(frozen=True)
class Module:
    """imports: {name here: (module that it is of, name there or "" for the module itself)}."""

    units: tuple[Unit, ...]
    imports: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def binding(self, name: str) -> list[int]:
        return [k for k, unit in enumerate(self.units) if name in unit.names]


class Code:
    """The definitions of some top-level packages, and what they read; all as it is when it is first asked for."""

    def __init__(self, packages: Iterable[str]) -> None:
        self.packages = frozenset(packages)
        self.file, self.module = functools.cache(_file), functools.cache(_module)
        self.of, self.targets = functools.cache(self._of), functools.cache(self._targets)
        self.digest, self.reads = functools.cache(self._digest), functools.cache(self._reads)

    def all(self) -> Iterator[Place]:
        """All of them, and the shipped scenes."""
        for name, _ in _modules(self.packages):
            yield from (place for place in self.of(name, ()) if isinstance(place, Place))
        yield from (Place(one, SCENE) for one in SHIPPED_NAMES)

    def root(self, root: str) -> list[Place]:
        """The definitions of a root; none where it is gone."""
        module, _, name = root.partition(":")
        found = self.of(module, tuple(name.split(".")) if name else ()) if self.file(module) else ()
        return [one for one in found if isinstance(one, Place)]

    def reached(self, roots: Iterable[str]) -> set[Place]:
        """The definitions that roots reach, themselves among them."""
        waiting = []
        for root in roots:
            if not (places := self.root(root)) and not self.file(root):
                raise ModuleNotFoundError(f"no source for {root!r}")
            waiting += places
        found: set[Place] = set()
        while waiting:
            place = waiting.pop()
            if place not in found:
                found.add(place)
                waiting += [*self.reads(place), *self.nameless(place)]
        return found

    def _digest(self, place: Place) -> str:
        """Of a definition's code and of what its names stand for."""
        if place.number == SCENE:
            return self._own(place)
        found = {
            name: sorted(self._own(one) if isinstance(one, Place) else one for one in targets)
            for name, targets in self.targets(place).items()
        }
        return _digest((self._own(place), sorted(found.items())))[:DIGITS]

    def _reads(self, place: Place) -> list[Place]:
        """The definitions that one reads by name."""
        if place.number == SCENE:
            return []
        return [one for some in self.targets(place).values() for one in some if isinstance(one, Place)]

    def nameless(self, place: Place) -> list[Place]:
        """What else runs where a module is imported."""
        if place.number == SCENE:
            return []
        units = self.module(place.module).units
        return [Place(place.module, k) for k, unit in enumerate(units) if not unit.names]

    def named(self, place: Place) -> str:
        """A name for people."""
        if place.number == SCENE:
            return f"analytic.scenes.{place.module}"
        names = self.module(place.module).units[place.number].names
        return f"{place.module}.{names[0] if names else f'statement {place.number}'}"

    def _own(self, place):
        if place.number == SCENE:
            return _scene(place.module)[:DIGITS]
        return self.module(place.module).units[place.number].code

    def _targets(self, place):
        """{name as it is read: definitions that it stands for, or the name of what is another package's}."""
        unit = self.module(place.module).units[place.number]
        found = {}
        for chain in unit.reads:
            name, *rest = chain
            if name in unit.local:
                targets = self._imported(unit.local[name], tuple(rest))
            else:
                targets = self.of(place.module, chain)
            others = [one for one in targets if one != place]
            if others:
                found[".".join(chain)] = others
        for scene in unit.scenes:
            found[f"scene {scene}"] = [Place(scene, SCENE)]
        return found

    def _of(self, module: str, chain: tuple[str, ...]) -> list[Place | str]:
        """What a chain of names stands for in a module; all of it without a name."""
        if package_of(module) not in self.packages:
            return [".".join((module, *chain[:1]))]
        if self.file(module) is None:  # a folder of modules, or nothing
            return self.of(f"{module}.{chain[0]}", chain[1:]) if chain and self.file(f"{module}.{chain[0]}") else []
        if not computes(module):
            return []
        here = self.module(module)
        if not chain:
            return [Place(module, k) for k in range(len(here.units))]
        if chain == ("globals",):  # all that is there, and all that is imported
            found = [one for source in here.imports.values() for one in self._imported(source, ())]
            return [*found, *(Place(module, k) for k in range(len(here.units)))]
        if own := here.binding(chain[0]):
            return [Place(module, k) for k in own]
        if here.imports.get(chain[0], (module, chain[0])) != (module, chain[0]):  # else: of the package's own module
            return self._imported(here.imports[chain[0]], chain[1:])
        if self.file(module).name == "__init__.py" and self.file(f"{module}.{chain[0]}"):
            return self.of(f"{module}.{chain[0]}", chain[1:])
        return []

    def _imported(self, source: tuple[str, str], rest: tuple[str, ...]) -> list[Place | str]:
        module, name = source
        return self.of(module, (name, *rest) if name else rest)


def package_of(root: str) -> str:
    """The top-level package of a root."""
    return root.partition(":")[0].partition(".")[0]


def code_of(packages: Iterable[str]) -> Code:
    """The `Code` of the project and some more packages, as it is now."""
    names = frozenset({*PROJECT, *packages})
    files = [*(file for _, file in _modules(names)), *sorted(SHIPPED.glob("*.toml"))]
    return _code(names, tuple((str(file), file.stat().st_mtime_ns) for file in files))


@functools.lru_cache(maxsize=4)
def _code(names, _files):
    return Code(names)


def _modules(packages: Iterable[str]) -> Iterator[tuple[str, Path]]:
    """(name, file) of all modules of some packages."""
    for package in packages:
        file = _file(package)
        if file and file.name == "__init__.py":
            for path in sorted(file.parent.rglob("*.py")):
                inner = path.relative_to(file.parent).with_suffix("").parts
                yield ".".join((package, *(inner[:-1] if inner[-1] == "__init__" else inner))), path
        elif file:
            yield package, file


def _file(name):
    """The file of a module; None: `name` is no module, or one of no source. Nothing but its package is looked for."""
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
    return _parsed(str(file), package, file.stat().st_mtime_ns)  # with its time: a file edited meanwhile is read again


def _scene(name):
    return _digest(tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8")))


@functools.cache
def _parsed(file, package, _modified):
    text = Path(file).read_text(encoding="utf-8")
    lines, units, imports = text.splitlines(), [], {}
    for node in _ForNumbers().visit(ast.parse(text)).body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            imports.update(_bound(node, package))
        else:
            units.append(_unit(node, package, lines))
    return Module(tuple(units), imports)


def _bound(node, package):
    """{name: (module, name there)} of an import; `Module.imports`."""
    if isinstance(node, ast.Import):
        whole = {one.asname: (one.name, "") for one in node.names if one.asname}
        return whole | {name: (name, "") for one in node.names if not one.asname for name in one.name.split(".")[:1]}
    base = importlib.util.resolve_name("." * node.level + (node.module or ""), package) if node.level else node.module
    return {one.asname or one.name: (base, one.name) for one in node.names}


def _unit(node, package, lines):
    start = min(one.lineno for one in (node, *getattr(node, "decorator_list", ())))
    text = textwrap.dedent("\n".join(lines[start - 1 : node.end_lineno]))
    table = symtable.symtable(f"from __future__ import annotations\n{text}", "unit", "exec")
    reading = Reading(package)
    code = _digest(reading.plain(node))
    own = {"annotations"}  # of the line before it
    read = (_global(table) | reading.types | reading.imports.keys()) - own
    reads = {chain for chain in reading.chains if chain[0] in read}
    reads |= {(name,) for name in reading.imports if not any(chain[0] == name for chain in reads)}
    bound = (one.get_name() for one in table.get_symbols() if one.is_assigned() or one.is_imported())
    names = tuple(name for name in bound if name not in own)
    return Unit(names, code, frozenset(reads), reading.imports, tuple(sorted(reading.scenes)))


def _global(table):
    """Names that a statement and the functions in it read from outside."""
    top = table.get_type() == "module"
    here = {one.get_name() for one in table.get_symbols() if (one.is_referenced() if top else one.is_global())}
    return here.union(*map(_global, table.get_children()))


@dataclass
class Reading:
    """What is met in a statement. chains: names read, with the attributes behind them. types: names in types of fields.
    imports: as `Module.imports`. scenes: shipped ones that it names."""

    package: str
    chains: set[tuple[str, ...]] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    imports: dict[str, tuple[str, str]] = field(default_factory=dict)
    scenes: set[str] = field(default_factory=set)

    def plain(self, node: Any, behind: tuple[str, ...] = ()) -> Any:
        """The tree as tuples, without empty fields (which differ between Python versions) nor that whence a name is
        imported. behind: attributes that follow it."""
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
            self.types |= {one.id for one in ast.walk(node.annotation) if isinstance(one, ast.Name)}
        elif isinstance(node, ast.Constant) and node.value in SHIPPED_NAMES:
            self.scenes.add(node.value)
        return kind, *((name, self.plain(value)) for name, value in fields.items() if value is not None and value != [])


class _ForNumbers(ast.NodeTransformer):
    """Takes out of a tree what says nothing of a number: docstrings, types of arguments and results, and what is
    imported for a type checker only."""

    def visit_Expr(self, node):
        return None if isinstance(node.value, ast.Constant) else self.generic_visit(node)

    def visit_If(self, node):
        self.generic_visit(node)
        return node.orelse if getattr(node.test, "id", None) == "TYPE_CHECKING" else node

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
