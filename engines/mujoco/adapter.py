"""MuJoCo's variants: its soft constraint solver computes contact and impact.

A MuJoCo contact is a spring and damper per unit of mass (solref: k, b), scaled by an impedance d < 1 (solimp). In each
step it gives a corner the acceleration (1 - d) a0 - d (b v + k r), with penetration r, velocity v and free acceleration
a0. There is no coefficient of restitution. With b = 1/step a corner stops in the step after it has penetrated, whatever
its velocity. The impact is then that of eq. (7), as the other corner may lift in the same solve. k only has to remove
the penetration slowly.

The scene is an MJCF model. Tested with mujoco 4.0.0; diagexact needs 3.9.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import mujoco

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..loads import placement, size_scale
from ..loop import (
    GIVEN,
    MEAN_LOADS,
    RULED,
    SAMPLED,
    FirstScript,
    FixedStep,
    ImpactAware,
    Settings,
    State,
    raw_trace_of,
    require,
    run_of,
)

if TYPE_CHECKING:
    from analytic import Scene

FRICTION = 5.0  # prevents sliding; MuJoCo takes the larger of two geoms; e is the same with 1
CORNER_RADIUS = 1e-6  # share of R: the block has a sphere at each bottom corner for contact; e is the same with 1e-8
IMPEDANCE = 0.999  # d of the contacts, at any depth; 1 - d is the share of a landing speed that remains after a step
# A penetration decays at RECOVERY [1/s], for the Caryatid's R, by at most MOST_RECOVERY in a step. It must vanish
# before the next impact, but slowly: a faster recovery throws the corner up.
RECOVERY, MOST_RECOVERY = 75.0, 0.1


def coordinates(scene: Scene) -> tuple[list[float], list[float]]:
    """Initial coordinates and velocities: base (if any), block's centre x, z from its standing height, tilt."""
    x, z, vx, vz = placement(scene)
    position, velocity = [x, z, scene.start.tilt], [vx, vz, scene.start.tilt_rate]
    if scene.base is None:
        return position, velocity
    return [scene.start.base_displacement, *position], [scene.start.base_velocity, *velocity]


def _ground(scene: Scene, geom: str = "") -> str:
    """The support of the block as MJCF, its top at z = 0: a plane or, for a base, a slab on a slide joint."""
    if scene.base is None:
        return f'<geom type="plane" size="0 0 1" {geom}/>'
    reach, depth = 100 * scene.block.radius, scene.block.radius  # a plane cannot move in MuJoCo
    return (
        f'<body><joint name="base" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="{scene.base_mass!r}" '
        f'diaginertia="{scene.base_mass!r} {scene.base_mass!r} {scene.base_mass!r}"/>'
        f'<geom type="box" pos="0 0 {-depth!r}" size="{reach!r} {reach!r} {depth!r}" mass="0" {geom}/></body>'
    )


def contact_reference(step: float, recovery: float) -> tuple[float, float]:
    """MuJoCo's solref for a step [s]: -stiffness and -damping per unit of mass that stop a corner within it.

    A corner with penetration r then moves up at r min(MOST_RECOVERY/step, recovery), whatever its speed was.
    """
    return -min(MOST_RECOVERY / step, recovery) / step, -1.0 / step


def build(scene: Scene, step: float, plain: bool) -> MujocoBodies:
    """The block on slide-x, slide-z and hinge-y joints over its ground or base in the initial state.

    step: longest step [s]. plain: a box for contact, and MuJoCo's defaults.

    Raises
    ------
    Mismatch
        MuJoCo rejects the scene, or reports other values than it was given.
    """
    block, recovery = scene.block, None if plain else RECOVERY / size_scale(scene)
    friction = FRICTION if scene.friction is None else scene.friction
    b, h, r, i = block.half_width, block.half_height, CORNER_RADIUS * block.radius, block.centre_inertia
    if recovery is None:
        solref, option, geom = None, "", "" if scene.friction is None else f'friction="{friction!r} 0 0"'
        shape = f'<geom type="box" size="{b!r} {b!r} {h!r}" {geom}/>'
    else:
        stiffness, damping = solref = contact_reference(step, recovery)
        option, d = 'cone="elliptic"', IMPEDANCE
        geom = f'friction="{friction!r} 0 0" solref="{stiffness!r} {damping!r}" solimp="{d!r} {d!r} 1 .5 2"'
        shape = "".join(f'<geom type="sphere" size="{r!r}" pos="{x!r} 0 {r - h!r}" {geom}/>' for x in (-b, b))
    try:
        model = mujoco.MjModel.from_xml_string(f"""<mujoco>
            <option timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" {option}>
              <flag autoreset="disable" diagexact="{"enable" if solref else "disable"}"/></option>
            <worldbody>{_ground(scene, geom)}<body pos="0 0 {h!r}">
              <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
              <inertial pos="0 0 0" mass="{block.mass!r}" diaginertia="{i!r} {i!r} {i!r}"/>{shape}
            </body></worldbody></mujoco>""")
    except ValueError as error:
        raise Mismatch(str(error)) from error
    data = mujoco.MjData(model)
    check_readback(model, data, scene, step, solref, friction)
    data.qpos[:], data.qvel[:] = coordinates(scene)
    return MujocoBodies(model, data, scene, recovery)


def check_readback(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    scene: Scene,
    step: float,
    solref: tuple[float, float] | None,
    friction: float,
) -> None:
    """Compare what MuJoCo holds with what the scene needs; raises `Mismatch` naming what differs.

    The contacts are checked after MuJoCo has combined the parameters of both geoms: the block is moved into its base
    for this, and back. Contacts and solver are not checked where solref is None, as those are MuJoCo's defaults.
    """
    option, block, depth = model.opt, scene.block, -1e-3 * scene.block.radius
    masses = [block.mass] if scene.base is None else [scene.base_mass, block.mass]
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
                ("contact: solimp", contact.solimp, [IMPEDANCE, IMPEDANCE, 1, 0.5, 2]),
                ("contact: depth", contact.dist, depth),
            ]
        mujoco.mj_resetData(model, data)
    require(expected)


class MujocoBodies:
    """MuJoCo's model and data of a scene; recovery: see `contact_reference`, None for the default contact."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, scene: Scene, recovery: float | None) -> None:
        self.model, self.data, self.recovery, self.used = model, data, recovery, model.opt.timestep
        self.base = scene.base_mass
        self.loaded = scene.bearings is not None
        self.option, self.gravity, self.push = model.opt, model.opt.gravity, data.qfrc_applied
        self.position, self.velocity = data.qpos.tolist, data.qvel.tolist

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.loop.Bodies`."""
        if step != self.used:
            self.option.timestep = self.used = step
            if self.recovery:
                self.model.geom_solref[:] = contact_reference(step, self.recovery)
        self.gravity[0], self.gravity[2] = across / step, up / step
        if self.loaded:
            self.push[0] = impulse / step
        mujoco.mj_step(self.model, self.data)
        if not self.base:
            x, z, tilt = self.position()
            vx, vz, rate = self.velocity()
            return tilt, rate, x, z, vx, vz, 0.0, 0.0
        base, x, z, tilt = self.position()
        v, vx, vz, rate = self.velocity()
        return tilt, rate, x, z, vx, vz, base, v

    def twist(self, moment: float) -> None:
        """See `engines.loop.Bodies`; MuJoCo keeps it until the next one."""
        self.push[-1] = moment

    def weigh(self, added: float) -> None:
        """See `engines.loop.Bodies`."""
        self.model.dof_M0[0] = self.model.body_mass[1] = self.base + added


# tests/engines/test_physics.py shows it: friction and contact are one convex problem, in which a sliding contact opens.
SLIPPING = (
    "a corner that slides rises, the faster the higher, by some millimetres at 1 m/s: a block whose friction is below "
    "tan γ, which can only slide, rocks and may overturn; an impact in which the corner slides has a restitution near 1"
)

VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        kind="tuned",
        levels=(2e-3, 6e-4, 2e-4, 1e-4),
        takes_restitution=True,
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {RULED}; {GIVEN}",
        faults=SLIPPING,
    ),
    "fixed-step": Variant(
        FixedStep(1e-4),
        kind="tuned",
        levels=(4e-3, 1e-3, 1e-4),
        finer=({"step": 2e-5},),
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {MEAN_LOADS}",
        faults=SLIPPING,
    ),
    "first-script": Variant(
        FirstScript(2e-3),  # MuJoCo's own default
        kind="defaults",
        levels=(1 / 120, 2e-3, 5e-4),
        finer=({"step": 2e-4},),
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {SAMPLED}",
    ),
}

# Tilt below which the block counts as in flat contact, over the slenderness, and relaxation time [s], both of the
# default contact, which penetrates by .02 of gamma and has a time constant of .02 s.
FIRST_CONTACT, FIRST_SETTLE = 0.05, 0.1


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"mujoco": mujoco.__version__, "mujoco-library": mujoco.mj_versionString()}


def run(scene: Scene, variant: str, settings: Settings) -> Run:
    """The `Run` of a scene."""
    edge = FIRST_CONTACT * scene.block.slenderness
    messages: list[str] = []
    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(messages.append)  # otherwise MuJoCo writes a log file into the working directory
    try:
        result = run_of(
            scene,
            settings,
            lambda step: build(scene, step, isinstance(settings, FirstScript)),
            lambda rows: replace(raw_trace_of(rows, scene, edge), settle=FIRST_SETTLE),
        )
    except mujoco.FatalError as error:
        return Run(None, 0, 0.0, Failure("MuJoCo does not run the scene", str(error)))
    finally:
        mujoco.set_mju_user_warning(handler)
    if not messages:
        return result
    words = "; ".join(line.strip() for line in messages)  # of a bad state, at which MuJoCo would reset to the start
    message = f"{result.failure.message}. {words}" if result.failure else words
    return replace(result, failure=Failure(result.failure.reason if result.failure else "MuJoCo warned", message))
