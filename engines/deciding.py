"""Runs of a scene without a duration: an engine goes on until the outcome of its own run is decided."""

import functools

import analytic
from analytic import decision


def until_decided(simulate):
    """Let an engine's ``simulate(scene, ...)`` take scenes without a duration.

    The first try ends where the analytic model's run does, as engines end alike; an engine whose own end state is not
    decided there goes on for longer (`analytic.decision.until_decided`).
    """
    @functools.wraps(simulate)
    def run(scene, **options):
        if scene.duration is not None:
            return simulate(scene, **options)
        end = analytic.simulate(scene, history=False).end.time
        return decision.until_decided(lambda cut: simulate(cut, **options), scene, at_least=end,
                                      finished=lambda _, response: response.decided)

    return run
