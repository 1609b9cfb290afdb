"""Every number chosen in an engine's tuned variant, halved and doubled alone: it changes no run, or as much as listed.

Blocks released on three grounds, random statues that stay upright, pulses close to an outcome boundary, and the
Caryatid under the synthetic motion: 21 runs for each value.
"""

import itertools
from functools import cache, partial
from pkgutil import resolve_name

import numpy as np
import pytest
from engine_cases import ACCURATE

from analytic import Base, Start, load_scene, simulate
from analytic.scene import BASE, MASS, caryatid_block
from comparisons.ensembles import random_scene
from comparisons.metrics.errors import impact_errors, rms
from comparisons.studies.restitution.study import free_scene
from comparisons.studies.stability.cases import hard_cases
from engines import get_engine
from engines.exudyn.adapter import CONSTANTS as EXUDYN
from engines.pybullet.adapter import CONSTANTS as PYBULLET
from engines.simulating import RANGE

pytestmark = pytest.mark.timeout(1400)

LEAST = 1e-5  # of the slenderness: errors of a peak tilt below it are taken as it
MOST_IMPACTS = 1000  # a run of so many costs as much as the rest of the sample
ALMOST = 0.02  # of a factor
# {engine: {constant: by what factor an error (of restitution rms, of peak tilts in the median and at worst) moves at
# most, either way, where it is halved and where it is doubled}}; those not listed change no run, bit for bit. Large
# effects are listed, not tuned away: stiffness and largest_step are the accuracy parameters.
MOVES = {
    "exudyn": {
        "stiffness": (3.422, 14.381),
        "rebound": (2.251, 1.357),
        "friction": (1.302, 1.567),
        "sticking": (1.926, 1.875),
        "damping": (1.014, 1.013),
        "slip": (1.014, 1.082),
        "tolerance": (1.003, 1.005),
        "longest_step": (1.022, 1.019),
        "pivoting_step": (2.567, 1.831),
        "engines.exudyn.corners:RELAX": (1.741, 1.055),
        "engines.exudyn.stepping:AHEAD": (1.023, 1.040),
        "engines.exudyn.stepping:PUSHED": (1.014, 1.008),
        "engines.exudyn.stepping:CARRIES": (1.003, 1.010),
        "engines.exudyn.stepping:WORTHWHILE": (1.000, 1.020),
        "engines.exudyn.stepping:SMOOTH": (1.033, 1.122),
        "engines.exudyn.stepping:FIRST": (1.022, 1.019),
        "engines.exudyn.stepping:RESIDUAL": (1.027, 1.036),
        "engines.exudyn.stepping:DIFFERENCE": (1.009, 1.045),
        "engines.loads:VIBRATION": (1.035, 1.173),
    },
    "pybullet": {
        "largest_step": (3.409, 3.542),
        "engines.loop:SMALLEST_STEP": (1.703, 1.826),
        "engines.loop:SHARE": (1.031, 1.098),
        "engines.loop:GROWTH": (1.191, 1.203),
        "engines.loop:HOLD": (1.000, 1.000),
        "engines.loop:NEAR": (1.000, 1.001),
        "engines.loop:LANDING": (1.000, 1.001),
        "engines.loop:SMEARED": (1.000, 1.000),
        "engines.loads:STIFF": (1.000, 1.010),
        "engines.pybullet.adapter:FRICTION": (1.000, None),
        "engines.pybullet.adapter:CORNER_RADIUS": (1.009, 1.037),
        "engines.pybullet.adapter:ROCKING_REST": (1.000, 1.000),
        "engines.pybullet.adapter:STANDING_REST": (1.000, 1.003),
    },
}
DECLARED = [("exudyn", constant) for constant in EXUDYN] + [("pybullet", constant) for constant in PYBULLET]
each_constant = pytest.mark.parametrize("engine, constant", DECLARED)


@cache
def sample():
    """([scenes whose impacts are judged], [statues whose peak tilts are], [scenes whose outcomes are])."""
    isolated = load_scene("free-rocking-isolated").with_(duration=4.0)
    heavy = {"base": Base(mass=MASS), "block": caryatid_block(0.2), "start": Start(tilt=0.12)}
    released = [free_scene(*case, 0.6) for case in itertools.product((0.15, 0.45), (None, BASE.mass / MASS))]
    drawn = (scene for index in itertools.count() if (scene := random_scene(0, index)).motion and _stays(scene))
    near = [hard_cases()[f"critical pulse {sign}0.001"].scene for sign in "-+"]
    statues = list(itertools.islice(drawn, 12))
    return [*released, isolated, isolated.with_(**heavy)], statues, [load_scene("caryatid-rigid"), *near]


def _stays(scene):
    """Whether a block rocks, but never beyond its unstable point: there the least change may be another outcome."""
    run = simulate(scene, history=False)
    return RANGE["tilt"][0] <= run.peak_tilt_ratio < 1 and len(run.impacts) < MOST_IMPACTS


def ran(engine, variant, **settings):
    """Outcomes of the runs; all else that may move; errors of restitution, and of peak tilts, median and worst."""
    released, statues, others = sample()
    scenes = [*released, *statues, *others]
    solve = partial(get_engine(engine).simulate, variant=variant, history=False, compare=False, **settings)
    runs = [solve(scene) for scene in scenes]
    impacts = [impact_errors(scene, run)["state"].tolist() for scene, run in zip(scenes, runs, strict=True)]
    peaks = [
        abs(run.peak_tilt_ratio - simulate(scene, history=False).peak_tilt_ratio)
        for scene, run in zip(statues, runs[len(released) :], strict=False)
    ]
    bits = repr([(run.peak_tilt_ratio, run.steps, each) for run, each in zip(runs, impacts, strict=True)])
    errors = rms(sum(impacts[: len(released)], [])), *np.maximum((np.median(peaks), max(peaks)), LEAST)
    return [run.outcome for run in runs], bits, np.array(errors)


as_it_is = cache(ran)


def changed(engine, constant, factor, monkeypatch):
    """The settings with which a run has a constant times a factor, which in the code is changed here; whole numbers
    remain so."""
    if ":" not in constant:
        settings = get_engine(engine).variants[ACCURATE[engine]].settings
        return {constant: scaled(getattr(settings, constant), factor)}
    monkeypatch.setattr(constant.replace(":", "."), scaled(resolve_name(constant), factor))
    return {}


def scaled(value, factor):
    return type(value)(factor * value)


@each_constant
def test_every_constant_declared_is_a_number_that_is_there(engine, constant, monkeypatch):
    assert constant in get_engine(engine).variants[ACCURATE[engine]].constants
    given = changed(engine, constant, 2.0, monkeypatch)
    assert (given[constant] if given else resolve_name(constant)) > 0
    assert {(engine, listed) for listed in MOVES[engine]} <= set(DECLARED)


@pytest.mark.long
@each_constant
def test_a_constant_halved_or_doubled_changes_as_much_as_is_listed(engine, constant, monkeypatch):
    outcomes, bits, errors = as_it_is(engine, ACCURATE[engine])
    factors = []
    for factor in (0.5, 2.0):
        with monkeypatch.context() as patch:
            ended, *others = ran(engine, ACCURATE[engine], **changed(engine, constant, factor, patch))
        assert ended == outcomes
        ratios = others[1] / errors
        factors.append(None if others[0] == bits else float(max(*ratios, *(1 / ratios))))
    listed = MOVES[engine].get(constant, (None, None))
    print(f"{engine}, {constant}: {factors}, listed {listed}")
    assert factors == [value and pytest.approx(value, rel=ALMOST) for value in listed]
