"""Scripts of scenes, run as a user runs them, and measured by the project's own measures."""

import math
import runpy
import subprocess
import sys
from dataclasses import dataclass

import numpy as np

import analytic
from analytic import Response, Scene
from analytic.rocking import RockingModel
from engines import ENGINES
from engines.observe import observe
from engines.scripting import write_script
from engines.swings import Trace

# Runs a script as its own program and fails if a module of the project is imported by then.
ALONE = """
import runpy, sys
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
project = {"analytic", "engines", "comparisons"} & {name.partition(".")[0] for name in sys.modules}
assert not project, project
"""
# Impacts below this rate, over slenderness sqrt(g/R), are listed by no script and measured in no test, unless the
# script says its own: the error of compliant corners goes as the inverse square of the rate.
FAINT = 0.05


@dataclass(frozen=True)
class Ran:
    """What a script printed and wrote, and the project's reading of it beside the model's run."""

    said: str
    trace: Trace
    seen: Response
    model: Response
    slip: np.ndarray  # m, none of a scene without a friction
    errors: np.ndarray  # of the restitution at each impact that is not faint
    jumps: np.ndarray  # of the base velocity's jump against (8) with the run's own rates, relative


def written(engine, scene, folder, name="script"):
    """The path of the script of a scene."""
    for file, text in write_script(ENGINES[engine], scene, name).items():
        (folder / file).write_text(text, encoding="utf-8")
    return folder / f"{name}.py"


def run_alone(script, *arguments):
    """What a script prints, in a process of its own that is shut off from this project."""
    command = [sys.executable, "-I", "-c", ALONE, str(script), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=script.parent)
    assert done.returncode == 0, done.stderr
    return done.stdout


def ran(engine, scene: Scene, folder) -> Ran:
    """Write and run the script of a scene."""
    script = written(engine, scene, folder)
    said = run_alone(script, "--csv", folder / "history.csv")
    return measured(scene, script, said)


def measured(scene: Scene, script, said) -> Ran:
    """The reading of what a script wrote; `scene` is the one that it should have run."""
    file = script.parent / "history.csv"
    names = file.read_text().partition("\n")[0].split(",")
    rows, count = np.loadtxt(file, delimiter=",", skiprows=1), len(Trace.COLUMNS)
    assert names == [*Trace.COLUMNS, *["slip"] * (rows.shape[1] - count)]
    rows, slip = rows[:, :count], rows[:, count:].ravel()
    numbers = runpy.run_path(str(script))
    contact, block = numbers["contact"], scene.block
    if "lead" in numbers:  # what the couple turns is no flight
        contact = 2 * numbers["lead"] * np.abs(rows[np.abs(rows[:, 1]) < 0.5 * block.slenderness, 2]).max()
    trace = Trace(*rows.T, contact_tilt=contact, settle=numbers.get("settle", 0.0))
    cut = scene if scene.duration else scene.with_(duration=float(trace.time[-1]))
    given = dict(engine="script", variant="script", cpu_seconds=0.0, steps=len(rows) - 1, settings={}, versions={})
    seen = observe(cut, trace, history=False, ended="overturned" if abs(rows[-1, 1]) >= math.pi / 2 else None, **given)
    model, least = (
        RockingModel.of(scene),
        numbers.get("faint", FAINT * block.slenderness * math.sqrt(scene.gravity / block.radius)),
    )
    impacts = [one for one in seen.impacts if abs(one.rate_before) > least and one.rate_after != 0]
    before, after, jump = (
        np.array([(i.rate_before, i.rate_after, i.base_velocity_jump) for i in impacts]).reshape(-1, 3).T
    )
    jumps = jump / (model.jump_arm * (before - after)) - 1 if scene.base else np.empty(0)
    return Ran(said, trace, seen, analytic.simulate(scene), slip, after / before - model.restitution, jumps)
