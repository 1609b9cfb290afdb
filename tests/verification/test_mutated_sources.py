"""The suite can fail: a module is changed in one place, and one of the suite's own tests must fail for it, in time.

Each mutation once passed all tests. `test_mutations` does the same for the tolerance table, by numbers.
"""

import importlib.util
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from analytic import load_scene, simulate

PROJECT = Path(__file__).parents[2]
LIMIT = 30  # s, of a test under mutation
SHORT = 10  # s, where it hangs


@dataclass(frozen=True)
class Mutation:
    """`old`, which stands once in the source of `module`, becomes `new`; `test` of the suite must see it.

    words: part of what the failing test says.
    """

    module: str
    old: str
    new: str
    test: str
    words: str = "AssertionError"
    limit: float = LIMIT


RANGE = "tests/engines/test_exudyn.py"
HOLDS = "tests/verification/test_tolerances_hold.py::test_row_of_the_tolerance_table"
MUTATIONS = {
    "exudyn: a corner is drawn back to where it stood": Mutation(
        "engines.exudyn.model",
        "at = min(max(self.at, low), high)",
        "at = self.at",
        f"{RANGE}::test_a_block_that_slid_stays_where_it_came_to_rest",
    ),
    "exudyn: the start forgets that the corners give way": Mutation(
        "engines.exudyn.corners",
        "-normal / (2 * corner.stiffness)",
        "0.0",
        f"{RANGE}::test_a_block_left_alone_does_not_sink",
    ),
    "exudyn: a chord off by 2 %": Mutation(
        "engines.exudyn.model",
        "chord = law.kb +",
        "chord = 1.02 * law.kb +",
        f"{RANGE}::test_the_bearings_spring_meets_the_law_at_both_ends_of_a_step",
    ),
    "exudyn: steps do not meet the samples of a record": Mutation(
        "engines.exudyn.phases",
        "self._meets(t) if self.implicit else self.end",
        "self.end",
        f"{HOLDS}[bearing impulse in the motion: exudyn, compliant-corners, isolated Caryatid, synthetic motion]",
    ),
    "twin: nobody counts its impacts": Mutation(
        "analytic.twin",
        "if self.stalled > STALL_LIMIT or len(self.impacts) > IMPACT_LIMIT:",
        "if False:",
        "tests/analytic/test_twin.py::test_restitution_of_one_fails_instead_of_bouncing_for_ever",
        "Timeout",
        limit=SHORT,
    ),
}

PLUGIN = """
import importlib, importlib.util, sys
spec = importlib.util.spec_from_file_location({module!r}, {file!r})
package, _, name = {module!r}.rpartition(".")
parent = importlib.import_module(package)
module = importlib.util.module_from_spec(spec)
sys.modules[{module!r}] = module
spec.loader.exec_module(module)
setattr(parent, name, module)
"""


def run_mutated(folder, mutation):
    """(status, output) of the test under the mutation: the module is loaded from a changed copy of its source."""
    source = Path(importlib.util.find_spec(mutation.module).origin).read_text()
    assert source.count(mutation.old) == 1, f"{mutation.module} has changed: mutate another place"
    copy = folder / f"mutated_{mutation.module.rpartition('.')[2]}.py"
    copy.write_text(source.replace(mutation.old, mutation.new))
    (folder / "mutation.py").write_text(PLUGIN.format(module=mutation.module, file=str(copy)))
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    environment["PYTHONPATH"] = os.pathsep.join([str(folder), str(PROJECT)])
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-x",
            "-p",
            "mutation",
            "-p",
            "no:cacheprovider",
            "-o",
            f"timeout={mutation.limit}",
            "-o",
            f"faulthandler_timeout={2 * mutation.limit}",
            mutation.test,
        ],
        cwd=PROJECT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=15 * mutation.limit,
    )
    return done.returncode, done.stdout


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """The kernel is on the disk before a limit runs."""
    simulate(load_scene("free-rocking-rigid"))


@pytest.mark.parametrize("name", MUTATIONS)
def test_a_mutation_of_the_source_is_caught(tmp_path, name):
    mutation = MUTATIONS[name]
    if mutation.module.startswith("engines."):
        pytest.importorskip(name.partition(":")[0])
    status, output = run_mutated(tmp_path, mutation)
    assert status == 1 and mutation.words in output, output[-3000:]


def test_a_copy_that_changes_nothing_passes(tmp_path):
    pytest.importorskip("exudyn")
    one = MUTATIONS["exudyn: a chord off by 2 %"]
    status, output = run_mutated(tmp_path, Mutation(one.module, one.old, one.old, one.test))
    assert status == 0, output[-3000:]
