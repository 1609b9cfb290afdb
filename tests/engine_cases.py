"""Engines and variants as parameters of tests, and the scenes that they are tried on."""

from pathlib import Path

import numpy as np
import pytest
from bearing_laws import bearings_of

import analytic
from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start
from analytic.errors import EngineNotInstalled
from engines import ENGINES, get_engine

BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
PULSE = PulseMotion("one-sine", 6.0, 4.0)
RECORD = Path(__file__).parents[2] / "shared" / "records" / "RSN1605_DUZCE_DZC270.AT2"

FIRST_SCRIPT = "first-script"  # of an engine that has nothing else this is the default, and not accurate
# Held to the analytic model beside the default variants.
ALSO_ACCURATE = {("exudyn", "switched-joints")}


def cases(keep):
    """A pytest parameter (engine, variant) for each that `keep` takes; one that is skipped for an absent engine."""
    for name in ENGINES:
        try:
            engine = get_engine(name)
        except EngineNotInstalled as error:
            yield pytest.param(name, None, marks=pytest.mark.skip(reason=str(error)))
            continue
        for variant in engine.variants:
            if keep(name, variant, engine.default_variant):
                yield pytest.param(name, variant)


every_variant = pytest.mark.parametrize("engine, variant", list(cases(lambda *case: True)))
default_variant = pytest.mark.parametrize(
    "engine, variant", list(cases(lambda name, variant, default: variant == default != FIRST_SCRIPT))
)
accurate_variant = pytest.mark.parametrize(
    "engine, variant",
    list(cases(lambda name, variant, default: variant == default != FIRST_SCRIPT or (name, variant) in ALSO_ACCURATE)),
)


def needs(engine):
    """Skip the test where the engine's package is not installed."""
    record = ENGINES[engine]
    pytest.importorskip(record.package, reason=f"{engine} is not installed: {record.install}")


def scene(slenderness, base=None, duration=2.0, **parts):
    return Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness),
        name="contract",
        base=Base(mass=base) if base else None,
        duration=duration,
        **parts,
    )


def released(base, slenderness=0.2, tilt=0.5, rate=0.0):
    """A block let go, until it is well into its second swing; tilt as a share of the slenderness, its rate [rad/s]."""
    start = Start(tilt=tilt * slenderness, tilt_rate=rate)
    given = scene(slenderness, duration=5.0, start=start).with_(base=base)
    first, second, *_ = analytic.simulate(given, history=False).impacts
    return given.with_(duration=first.time + 0.1 * (second.time - first.time))


def simulate(engine, variant, given, **settings):
    return get_engine(engine).simulate(given, variant=variant, **settings)


def bearings(law, damping):
    return bearings_of(law, count=4, damping=damping)


def shaking(peak, duration=6.0):
    instants = 0.01 * np.arange(round(100 * duration) + 1)
    level = np.sin(8 * instants) + 0.5 * np.sin(26 * instants)
    return SampledMotion(0.01, level / np.abs(level).max() * peak)
