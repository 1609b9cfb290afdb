"""Runs of a scene without a duration: an engine goes on until its outcome is decided."""

import functools

from analytic.decision import shortest_duration


def until_decided(simulate):
    """Let an engine's ``simulate(scene, ...)`` take scenes without a duration."""
    @functools.wraps(simulate)
    def run(scene, **options):
        if scene.duration is None:
            scene = scene.with_(duration=shortest_duration(scene))
        return simulate(scene, **options)

    return run
