"""The scene as a MuJoCo model."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import mujoco

from ..contract import Mismatch
from ..placement import placement
from ..readback import require
from ..scale import size_scale
from ..vibration import base_frequency

if TYPE_CHECKING:
    from analytic import Scene

    from .adapter import FirstScript, FixedStep, ImpactAware

    Settings: TypeAlias = FirstScript | FixedStep | ImpactAware

FRICTION = 5.0  # stands for the model's "no sliding"; of two geoms MuJoCo takes the larger; e is the same with 1
CORNER_RADIUS = 1e-6  # share of R: the block touches by a sphere at each bottom corner; e is the same with 1e-8
# Of the contacts, at any depth. Largest error of e at steps up to 4e-4 s: 6.4e-5 at .99, 4.3e-5 at .999, 6.2e-5 at
# .9999 (one start 2e-3 at a smaller accuracy).
IMPEDANCE = 0.999

# A sink decays at the variant's rate `recovery`, by at most this share in a step. Landing corners leave it; a small
# rate lets a slender block land early (gamma .05 on rigid ground: e off by 2.0e-5 at 50, 1.1e-5 at 100, 6e-6 at 150),
# a large one throws the landing corner up (gamma .45: 8e-6 at 50, 3.0e-5 at 150). At fixed steps of 1e-4 s only the
# second matters (gamma .45, before the arc: 4e-4 at 30, 1.8e-3 at 150).
MOST_RECOVERY = 0.1
# Below this slenderness the rate grows as its inverse, where steps are small at impacts: swings of .002 slendernesses,
# gamma .03: e off by 8e-3 without, 1.1e-3 with it.
SLENDER = 0.3

# Most radians of the base's vibration on its bearings in a step (at .15, without the mass of `leapfrog_stiffness`, the
# phase after 100 periods is off by .6 rad); what it shortens the steps to at most, as a share.
VIBRATION, MOST_REFINEMENT = 0.07, 40.0


def least_mass(scene: Scene) -> float:
    """Least inertia [kg] that a push on the base meets while the block stands or rocks on it, eqs (3)-(6)."""
    block = scene.block
    return scene.total_mass - (block.mass * block.radius) ** 2 / block.inertia


def recovery_rate(scene: Scene, chosen: Settings) -> float | None:
    """Rate [1/s] at which a sink decays, None where MuJoCo's defaults are to stay."""
    if chosen.recovery is None:
        return None
    slender = 1.0 if chosen.accuracy is None else max(1.0, SLENDER / scene.block.slenderness)
    return chosen.recovery * slender / size_scale(scene)


def impedance(scene: Scene) -> float:
    """Impedance d of the contacts: 1 - d is the share of a landing that they leave, more so where J_O is near m R^2."""
    block = scene.block
    return 1 - (1 - IMPEDANCE) * min(1.0, max(0.1, 3 * block.centre_inertia / (block.mass * block.radius**2)))


def longest_step(scene: Scene, chosen: Settings) -> float:
    """Length of the steps in flight and at rest [s]: the variant's, less for a small block and for stiff bearings."""
    if chosen.recovery is None:
        return chosen.largest_step
    step = chosen.largest_step * size_scale(scene)
    if scene.bearings is None:
        return step
    return min(step, max(VIBRATION / base_frequency(scene), step / MOST_REFINEMENT))


def coordinates(scene: Scene) -> tuple[list[float], list[float]]:
    """Coordinates and velocities at the start: base (if any), block's centre x, z from its standing height, tilt."""
    x, z, vx, vz = placement(scene)
    position, velocity = [x, z, scene.start.tilt], [vx, vz, scene.start.tilt_rate]
    if scene.base is None:
        return position, velocity
    return [scene.start.base_displacement, *position], [scene.start.base_velocity, *velocity]


def _ground(scene: Scene, geom: str = "") -> str:
    """MJCF of what the block stands on, its top at z = 0: a plane, or a slab on a slide joint for a base."""
    if scene.base is None:
        return f'<geom type="plane" size="0 0 1" {geom}/>'
    reach, depth = 100 * scene.block.radius, scene.block.radius  # a plane cannot move in MuJoCo
    return (
        f'<body><joint name="base" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="{scene.base.mass!r}" '
        f'diaginertia="{scene.base.mass!r} {scene.base.mass!r} {scene.base.mass!r}"/>'
        f'<geom type="box" pos="0 0 {-depth!r}" size="{reach!r} {reach!r} {depth!r}" mass="0" {geom}/></body>'
    )


def contact_reference(step: float, recovery: float) -> tuple[float, float]:
    """solref for a step [s]: -stiffness and -damping per unit of mass that stop a corner in this very step.

    A corner that has sunk by r then moves up at r min(MOST_RECOVERY/step, recovery), whatever its speed was.
    """
    return -min(MOST_RECOVERY / step, recovery) / step, -1.0 / step


def build(scene: Scene, chosen: Settings) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """(model, data) of the block on slide-x, slide-z and hinge-y joints over its ground or base, at the start.

    Raises
    ------
    Mismatch
        MuJoCo does not take the scene, or reports other values than it was given.
    """
    block, step = scene.block, longest_step(scene, chosen)
    friction = FRICTION if scene.friction is None else scene.friction
    b, h, r, i = block.half_width, block.half_height, CORNER_RADIUS * block.radius, block.centre_inertia
    if chosen.recovery is None:
        solref, option, geom = None, "", "" if scene.friction is None else f'friction="{friction!r} 0 0"'
        shape = f'<geom type="box" size="{b!r} {b!r} {h!r}" {geom}/>'
    else:
        stiffness, damping = solref = contact_reference(step, recovery_rate(scene, chosen))
        option = 'cone="elliptic"'
        d = impedance(scene)
        geom = f'friction="{friction!r} 0 0" solref="{stiffness!r} {damping!r}" solimp="{d!r} {d!r} 1 .5 2"'
        shape = "".join(f'<geom type="sphere" size="{r!r}" pos="{x!r} 0 {r - h!r}" {geom}/>' for x in (-b, b))
    damped = chosen.recovery is not None and scene.bearings is not None and scene.bearings.damping > 0
    damper = '<equality><joint joint1="base" active="false"/></equality>' if damped else ""
    try:
        model = mujoco.MjModel.from_xml_string(f"""<mujoco>
            <option timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" {option}>
              <flag autoreset="disable" diagexact="{"enable" if solref else "disable"}"/></option>
            <worldbody>{_ground(scene, geom)}<body pos="0 0 {h!r}">
              <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
              <inertial pos="0 0 0" mass="{block.mass!r}" diaginertia="{i!r} {i!r} {i!r}"/>{shape}
            </body></worldbody>{damper}</mujoco>""")
    except ValueError as error:
        raise Mismatch(str(error)) from error
    data = mujoco.MjData(model)
    check_readback(model, data, scene, step, solref, friction)
    data.qpos[:], data.qvel[:] = coordinates(scene)
    return model, data


def check_readback(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    scene: Scene,
    step: float,
    solref: tuple[float, float] | None,
    friction: float | None,
) -> None:
    """Compare what MuJoCo holds with what the scene needs; raises `Mismatch` naming what differs.

    The contacts are looked at as MuJoCo combines them: the block is pushed into its base for it, and put back.
    They, and the solver, are left out where solref is None: those are MuJoCo's defaults.
    """
    option, block, depth = model.opt, scene.block, -1e-3 * scene.block.radius
    masses = [block.mass] if scene.base is None else [scene.base.mass, block.mass]
    expected = [
        ("time step", option.timestep, step),
        ("gravity", option.gravity, [0.0, 0.0, -scene.gravity]),
        ("integrator", option.integrator, int(mujoco.mjtIntegrator.mjINT_EULER)),
        ("disabled parts", option.disableflags, int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)),
        ("density and viscosity", [option.density, option.viscosity], 0.0),
        ("masses", model.body_mass[1:], masses),
        ("inertia", model.body_inertia[-1], block.centre_inertia),
        ("centre of mass", model.body_ipos, 0.0),
        ("coordinates", model.nq, 2 + len(masses)),
        *(
            (name, getattr(model, name), 0.0)
            for name in ("dof_damping", "dof_frictionloss", "dof_armature", "jnt_stiffness")
        ),
    ]
    if solref:
        data.qpos[-2] = depth
        mujoco.mj_fwdPosition(model, data)
        expected += [
            ("cone", option.cone, int(mujoco.mjtCone.mjCONE_ELLIPTIC)),
            ("solver", option.solver, int(mujoco.mjtSolver.mjSOL_NEWTON)),
            ("enabled parts", option.enableflags, int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT)),
            ("contacts of a standing block", data.ncon, 2),
        ]
        for contact in data.contact:
            expected += [
                ("contact: friction", contact.friction[:2], friction),
                ("contact: dimension", contact.dim, 3),
                ("contact: solref", contact.solref, solref),
                ("contact: margin", contact.includemargin, 0.0),
                ("contact: solimp", contact.solimp, [impedance(scene), impedance(scene), 1, 0.5, 2]),
                ("contact: depth", contact.dist, depth),
            ]
        mujoco.mj_resetData(model, data)
    require(expected)
