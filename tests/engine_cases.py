"""Engines and variants as parameters of tests, and the scenes that they are tried on."""

import numpy as np
import pytest

import analytic
from analytic import Base, PulseMotion, SampledMotion, Scene, Start
from analytic.rocking import RockingModel, restitution
from analytic.scene import caryatid_block
from engines import get_engine

PULSE = PulseMotion("one-sine", 6.0, 4.0)


# The variants of every engine, the main one first: no engine is loaded to know them (test_contract holds it to them).
VARIANTS = {
    "exudyn": ("compliant-corners", "native-contact"),
    "pybullet": ("impact-aware", "fixed-step", "first-script"),
    "dart": ("impact-aware", "first-script"),
    "drake": ("first-script",),
    "mujoco": ("impact-aware", "fixed-step", "first-script"),
    "pymunk": ("impact-aware", "first-script"),
}
# In a first script the engine is left as it comes: it is not held to the analytic model.
ACCURATE = {name: variants[0] for name, variants in VARIANTS.items() if variants[0] != "first-script"}

CASES = [(name, variant) for name, variants in VARIANTS.items() for variant in variants]

every_variant = pytest.mark.parametrize("engine, variant", CASES)
default_variant = pytest.mark.parametrize("engine, variant", [(name, own[0]) for name, own in VARIANTS.items()])
accurate_variant = pytest.mark.parametrize("engine, variant", ACCURATE.items())


def scene(slenderness, base=None, duration=2.0, **parts):
    """The Caryatid's block at another slenderness, on rigid ground or a base of this mass [kg]."""
    return Scene(
        block=caryatid_block(slenderness),
        name="contract",
        base=Base(mass=base) if base else None,
        duration=duration,
        **parts,
    )


def released(base, slenderness=0.2, tilt=0.5, rate=0.0):
    """A released block, until it is well into its second swing; tilt as a share of the slenderness, rate [rad/s]."""
    start = Start(tilt=tilt * slenderness, tilt_rate=rate)
    given = scene(slenderness, duration=5.0, start=start).with_(base=base)
    first, second, *_ = analytic.simulate(given, history=False).impacts
    return given.with_(duration=first.time + 0.1 * (second.time - first.time))


def simulate(engine, variant, given, **settings):
    return get_engine(engine).simulate(given, variant=variant, **settings)


def shaking(peak, duration=6.0):
    instants = 0.01 * np.arange(round(100 * duration) + 1)
    level = np.sin(8 * instants) + 0.5 * np.sin(26 * instants)
    return SampledMotion(0.01, level / np.abs(level).max() * peak)


def impact_errors(simulate, slenderness, base, starts=8, duration=3.0, **settings):
    """Of blocks released, 3 impacts a start: root mean squares of the errors of e (absolute) and of the base velocity
    jump (relative), the largest of the jump [m/s]; CPU seconds per simulated second."""
    errors, jumps, cpu = [], [], 0.0
    for share in np.linspace(0.3, 0.8, starts):
        given = scene(slenderness, base, duration, start=Start(tilt=share * slenderness))
        response = simulate(given, history=False, **settings)
        assert response.outcome == "rocks", response.failure
        assert len(response.impacts) >= 2
        for impact in response.impacts[:3]:
            errors.append(impact.rate_after / impact.rate_before - restitution(given))
            jumps.append((impact.base_velocity_jump, RockingModel.of(given).impact(impact.rate_before)[1]))
        cpu += response.cpu_seconds
    found, wanted = np.array(jumps if base else [(1.0, 1.0)]).T
    rms, jump = (np.sqrt(np.mean(np.square(error))) for error in (errors, found / wanted - 1))
    return rms, jump, np.abs(found - wanted).max(), cpu / (starts * duration)
