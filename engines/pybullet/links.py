"""Links and joints in Bullet without its default damping and motors."""

from __future__ import annotations

from .imported import pybullet


def chain(client: int, links: list[tuple], fixed: int = -1, **options: int) -> int:
    """A multibody of links (mass, shape, position, joint, axis, parent) on a fixed body of shape `fixed`, by default of
    none, at the origin."""
    masses, shapes, positions, joints, axes, parents = (list(column) for column in zip(*links, strict=True))
    count = len(links)
    return pybullet.createMultiBody(
        0,
        fixed,
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


def without_losses(client: int, body: int, links: int, friction: float, **limits: float) -> None:
    """Remove Bullet's damping of .04 1/s and motors of 1 N s per step from a body and its links; set their friction.

    A call that sets damping or velocity limits forces linkIndex to -1, so that friction is set in a separate call.
    """
    for link in range(-1, links):
        pybullet.changeDynamics(body, link, linearDamping=0.0, angularDamping=0.0, physicsClientId=client, **limits)
        pybullet.changeDynamics(body, link, lateralFriction=friction, physicsClientId=client)
    if links:
        motors = pybullet.VELOCITY_CONTROL
        pybullet.setJointMotorControlArray(body, range(links), motors, forces=[0.0] * links, physicsClientId=client)
