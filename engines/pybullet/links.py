"""Links and joints in Bullet without its default damping and motors."""

from __future__ import annotations

from .imported import pybullet


def chain(client: int, links: list[tuple], **options: int) -> int:
    """A multibody on a fixed origin of links (mass, shape, position, joint, axis, parent); their frames are level."""
    masses, shapes, positions, joints, axes, parents = (list(column) for column in zip(*links, strict=True))
    count = len(links)
    return pybullet.createMultiBody(
        0,
        -1,
        -1,
        [0, 0, 0],
        linkMasses=masses,
        linkCollisionShapeIndices=shapes,
        linkVisualShapeIndices=[-1] * count,
        linkPositions=positions,
        linkOrientations=[[0, 0, 0, 1]] * count,
        linkInertialFramePositions=[[0, 0, 0]] * count,
        linkInertialFrameOrientations=[[0, 0, 0, 1]] * count,
        linkParentIndices=parents,
        linkJointTypes=joints,
        linkJointAxis=axes,
        physicsClientId=client,
        **options,
    )


def without_losses(client: int, body: int, link: int, friction: float, **limits: float) -> None:
    """Remove Bullet's damping, restitution and motor from a link (-1: the body itself), and set its friction.

    A call that sets damping or velocity limits forces linkIndex to -1, so that friction is set in a separate call.
    """
    pybullet.changeDynamics(body, link, linearDamping=0.0, angularDamping=0.0, physicsClientId=client, **limits)
    none = dict.fromkeys(("rollingFriction", "spinningFriction", "restitution", "jointDamping"), 0.0)
    pybullet.changeDynamics(body, link, lateralFriction=friction, physicsClientId=client, **none)
    if link >= 0:  # joints have a default motor of 1 N s per step
        pybullet.setJointMotorControl2(body, link, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
