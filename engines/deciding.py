"""Runs of a scene without a duration: an engine goes on until the outcome of its own run is decided."""

import functools

import analytic
from analytic.decision import until_decided


def run_until_decided(simulate):
    """Let an engine's ``simulate(scene, ...)`` take scenes without a duration.

    The analytic model's end is where the first try ends, as engines end alike; an engine whose own end state is not
    decided there goes on for longer (`analytic.decision.until_decided`).
    """
    @functools.wraps(simulate)
    def run(scene, **options):
        if scene.duration is not None:
            return simulate(scene, **options)
        end = analytic.simulate(scene, history=False).end.time
        return until_decided(lambda cut: simulate(cut, **options), scene, at_least=end, finished=_decided)

    return run


def _decided(scene, response):
    return response.decided
