"""What a variant's record says that a leapfrog engine's adapter imposes is what it does, and all of it."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from engine_cases import CASES, scene

from analytic import Bearings, PulseMotion, Start
from engines import get_engine, stepping
from engines.ground_velocity import ground_velocity

BEGIN = 0.02037
MOTION = PulseMotion("rectangular", 2.0, 60.0, start=BEGIN)
DAMPED = Bearings(law="linear", count=4, ka=6e4, damping=300.0)
GIVEN = scene(0.2, 212.0, 0.06, bearings=DAMPED, motion=MOTION, start=Start(tilt=2e-3))


@dataclass
class Seen:
    """A run: its bodies, their loads in each step, masses and couples that were set, rows and trace."""

    bodies: object
    loads: list = field(default_factory=list)
    added: list = field(default_factory=list)
    couples: list = field(default_factory=list)

    def __post_init__(self):
        weigh = self.bodies.weigh  # of which the loads know, too
        self.bodies.weigh = lambda added: self.added.append(added) or weigh(added)

    def step(self, *loads):
        self.loads.append(loads)
        return self.bodies.step(*loads)

    def twist(self, moment):
        self.couples.append(moment)
        self.bodies.twist(moment)


def ran(monkeypatch, engine, variant, given):
    """(what was `Seen` of a run, its rows, its trace)."""
    march, found = stepping.march, []

    def watched(bodies, *rest):
        found.append(Seen(bodies))
        rows, ended = march(found[-1], *rest)
        found.append(rows)
        return rows, ended

    with monkeypatch.context() as patched:
        patched.setattr(stepping, "march", watched)
        run = engine.run(given, variant, engine.variants[variant].settings)
    assert run.failure is None and run.steps > 5
    return *found, run.trace


def planar(bodies):
    """Whether joints leave a body of three dimensions the motions of a plane."""
    if hasattr(bodies, "model"):
        return 0 not in bodies.model.jnt_type  # MuJoCo's number of a free joint
    return hasattr(bodies, "joints")


def imposed(monkeypatch, engine, variant):
    """The clauses that hold of a variant."""
    seen, rows, trace = ran(monkeypatch, engine, variant, GIVEN)
    step, before, across, up, _ = np.array(seen.loads).T
    t, velocity = rows[:-1, 0], ground_velocity(MOTION)
    moments = np.sort([*(t - before / 2), *(t + step / 2)])
    couples = [0.0]
    if engine.variants[variant].takes_restitution:
        slower = GIVEN.with_(
            block={"restitution": 0.6}, start={"tilt": 1e-3, "tilt_rate": -0.1}, bearings=None, motion=None
        )
        couples = ran(monkeypatch, engine, variant, slower)[0].couples
    mean = [-(velocity(a + b / 2) - velocity(max(a - c / 2, 0.0))) for a, b, c in zip(t, step, before, strict=True)]
    level = -9.81 * step, -MOTION.acceleration(t) * step
    return {
        "a plane, by joints": planar(seen.bodies),
        "steps by gaps and closing speeds, which meet jumps of the ground's acceleration": (
            step.max() > 10 * step[:-1].min() and np.abs(moments - BEGIN).min() < 1e-9
        ),
        "loads times (step + step before)/(2 step), the ground's as its mean": (
            np.allclose(up, -9.81 * (step + before) / 2) and np.allclose(across, mean, atol=1e-12)
        ),
        "loads as where a step begins": np.allclose(up, level[0]) and np.allclose(across, level[1]),
        "dampers and stiff bearings as mass added to the base": bool(seen.added) and min(seen.added) > 0,
        "velocities read half a step early": not np.allclose(trace.tilt_rate, rows[:, 3], rtol=1e-9),
        "restitution given: a couple before each landing": any(couples),
    }


@pytest.mark.parametrize("engine, variant", [case for case in CASES if case[0] != "exudyn"])
def test_a_leapfrog_engines_record_says_what_its_adapter_imposes(monkeypatch, engine, variant):
    engine = get_engine(engine)
    found = imposed(monkeypatch, engine, variant)
    assert set(engine.variants[variant].imposes.split("; ")) == {clause for clause, holds in found.items() if holds}
