"""One way to write a file, `comparisons.execution.writing`: no other call that writes stands in the code."""

import ast
from pathlib import Path

PROJECT = Path(__file__).parents[3]
WAY = "comparisons/execution/writing.py"
# (file, function, call): why what it writes need not be there whole or not at all
ELSEWHERE = {
    ("comparisons/execution/sweep.py", "__init__", "open"): "runs are appended, and a torn end is found",
    ("comparisons/execution/sweep.py", "append", "truncate"): "the same",
    ("comparisons/execution/sweep.py", "_read", "truncate"): "the same",
    ("comparisons/execution/sweep.py", "_work", "open"): "what a worker prints, in a temporary folder",
    ("comparisons/execution/command_runs.py", "scene_of", "tempfile.NamedTemporaryFile"): "temporary",
    ("comparisons/execution/results.py", "save", "numpy.savez_compressed"): "into memory",
    ("comparisons/metrics/scripts.py", "run_script", "write_text"): "a script, in a temporary folder",
    ("comparisons/report/figures.py", "__call__", "numpy.savez"): "into memory",
    ("comparisons/plotting/plots.py", "picture", "savefig"): "into memory",
    ("comparisons/lessons/lesson.py", "svg", "savefig"): "into memory",
    ("comparisons/lessons/lesson.py", "downloads", "savefig"): "into memory",
    ("comparisons/commands/runs.py", "_history_text", "to_csv"): "into memory",
    ("comparisons/cli/__init__.py", "open_streams", "open"): "a standard stream",
    ("comparisons/cli/__init__.py", "open_streams", "os.open"): "no file: os.devnull",
    ("comparisons/cli/__init__.py", "_silence", "os.open"): "no file: os.devnull",
    ("engines/guard.py", "_evidence", "tempfile.TemporaryFile"): "temporary",
    ("engines/guard.py", "without", "tempfile.TemporaryFile"): "temporary",
    ("comparisons/schemas/__main__.py", "", "write_text"): "of this checkout, in which a change is seen",
    ("engines/guard.py", "_evidence", "open"): "no file: os.devnull",
    ("analytic/records/content.py", "_unzipped", "open"): "a member of an archive, to be read",
    ("analytic/response.py", "to_csv", "numpy.savetxt"): "from Python alone, which says where",
}
OF_MODULES = {
    "numpy": ("save", "savez", "savez_compressed", "savetxt", "memmap"),
    "os": ("open", "fdopen", "replace", "rename", "renames", "truncate", "link", "symlink"),
    "shutil": ("copy", "copy2", "copyfile", "copyfileobj", "copytree", "move", "make_archive"),
    "tempfile": ("NamedTemporaryFile", "TemporaryFile", "mkstemp"),
    "json": ("dump",),
    "pickle": ("dump",),
    "zipfile": ("ZipFile",),
    "tarfile": ("open",),
    "sqlite3": ("connect",),
}
OF_ANYTHING = (
    *("write_text", "write_bytes", "savefig", "print_figure", "tofile", "to_csv", "touch", "truncate"),
    *("rename", "symlink_to", "hardlink_to", "writestr", "extract", "extractall"),
)


def writing(tree):
    """(function it stands in, call) of all calls in a tree that write, or may write, a file."""
    modules = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules |= {alias.asname or alias.name: alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            modules |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    return list(_calls(tree, "", modules))


def _calls(node, function, modules):
    if isinstance(node, ast.FunctionDef):
        function = node.name
    if isinstance(node, ast.Call) and (name := _writes(node, modules)):
        yield function, name
    for child in ast.iter_child_nodes(node):
        yield from _calls(child, function, modules)


def _writes(call, modules):
    """The name of a call that writes, else None."""
    named = ast.unparse(call.func)
    first, dot, rest = named.partition(".")
    whole = modules.get(first, first) + dot + rest
    module, _, function = whole.rpartition(".")
    if function in OF_MODULES.get(module, ()):
        return whole if module != "zipfile" or _mode(call, 1) else None
    if function == "open":  # of a path its first argument is the mode
        return "open" if _mode(call, 1 if module in ("", "io", "gzip") else 0) else None
    if function == "replace":  # of a path: a string's takes two, that of dataclasses names
        return "replace" if len(call.args) == 1 and not call.keywords else None
    return function if isinstance(call.func, ast.Attribute) and function in OF_ANYTHING else None


def _mode(call, place):
    """Whether a file is opened to be written, or by a mode that is not known here."""
    given = [key.value for key in call.keywords if key.arg == "mode"] + call.args[place : place + 1]
    return any(not isinstance(mode, ast.Constant) or set(str(mode.value)) & set("wax+") for mode in given)


def test_the_code_has_one_way_to_write_a_file():
    calls = {
        (file.relative_to(PROJECT).as_posix(), *call)
        for package in ("analytic", "engines", "comparisons")
        for file in (PROJECT / package).rglob("*.py")
        for call in writing(ast.parse(file.read_text(encoding="utf-8")))
    }
    assert {function for file, function, _ in calls if file == WAY} >= {"_put", "write_pair"}
    others = {call for call in calls if call[0] != WAY}
    assert not others - ELSEWHERE.keys(), "write by comparisons.execution.writing"
    assert not ELSEWHERE.keys() - others, "no longer there: take it off the list"
