"""Blocks let go in an engine: how wrong its impacts are."""

import numpy as np

from analytic import Base, Block, Scene, Start
from analytic.rocking import RockingModel, restitution


def scene(slenderness, base=None, duration=2.0, **parts):
    """The Caryatid's block at another slenderness, on rigid ground or a base of this mass [kg]."""
    return Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness),
        base=Base(mass=base) if base else None,
        duration=duration,
        **parts,
    )


def impact_errors(simulate, slenderness, base, starts=8, duration=3.0, **settings):
    """Root mean squares of the errors of e (absolute) and of the base velocity jump (relative), 3 impacts a start; CPU
    seconds per simulated second."""
    errors, jumps, cpu = [], [], 0.0
    for share in np.linspace(0.3, 0.8, starts):
        given = scene(slenderness, base, duration, start=Start(tilt=share * slenderness))
        response = simulate(given, history=False, **settings)
        assert response.outcome == "rocks", response.failure
        model = RockingModel.of(given)
        assert len(response.impacts) >= 2
        for impact in response.impacts[:3]:
            errors.append(impact.rate_after / impact.rate_before - restitution(given))
            if base:
                jumps.append(impact.base_velocity_jump / model.impact(impact.rate_before)[1] - 1)
        cpu += response.cpu_seconds
    return np.sqrt(np.mean(np.square(errors))), np.sqrt(np.mean(np.square(jumps or [0.0]))), cpu / (starts * duration)
