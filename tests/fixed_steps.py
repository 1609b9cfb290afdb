"""pymunk's tuned scene in equal steps, and with a setting spoilt: errors of known causes."""

from dataclasses import replace

from engines.scale import size_scale


def fixed_steps(scene, step, change=None):
    """The trace of equal steps [s]; change(space, block's body, scene) spoils Chipmunk's space."""
    from engines.pymunk.scene import ChipmunkBodies
    from engines.stepping import FixedStep, run_of

    def bodies(largest):
        made = ChipmunkBodies(scene, largest, plain=False)
        if change:
            change(made.space, made.block, scene)
        return made

    trace = run_of(scene, FixedStep(step / size_scale(scene)), bodies, lambda rows: None).trace
    if change is None:
        return trace
    # a spoilt corner is met after it has sunk: what a block passes in a step or two, so often of gamma a second
    return replace(trace, contact_tilt=10.0 * step * scene.block.slenderness)
