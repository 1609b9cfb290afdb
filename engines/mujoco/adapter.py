"""MuJoCo's variants: its soft constraint solver computes contact and impact.

A MuJoCo contact is a spring and damper per unit of mass (solref: k, b), scaled by an impedance d < 1 (solimp). In each
step it gives a corner the acceleration (1 - d) a0 - d (b v + k r), with penetration r, velocity v and free acceleration
a0. There is no coefficient of restitution. With b = 1/step a corner stops in the step after it has penetrated, whatever
its velocity. The impact is then that of eq. (7), as the other corner may lift in the same solve. k only has to remove
the penetration slowly.

The scene is an MJCF model. Tested with mujoco 4.0.0; diagexact needs 3.9.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from analytic.response import Failure

from ..contract import Mismatch, Run, Variant
from ..loads import moving_mass, placements, size_scale, slabs_of
from ..loop import (
    GIVEN,
    MEAN_LOADS,
    RULED,
    SAMPLED,
    FirstScript,
    FixedStep,
    ImpactAware,
    Settings,
    raw_trace_of,
    require,
    run_of,
)

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.stack.equations import Slab

FRICTION = 5.0  # prevents sliding; MuJoCo takes the larger of two geoms; e is the same with 1
CORNER_RADIUS = 1e-6  # share of R: the block has a sphere at each bottom corner for contact; e is the same with 1e-8
IMPEDANCE = 0.999  # d of the contacts, at any depth; 1 - d is the share of a landing speed that remains after a step
# A penetration decays at RECOVERY [1/s], for the Caryatid's R, by at most MOST_RECOVERY in a step. It must vanish
# before the next impact, but slowly: a faster recovery throws the corner up.
RECOVERY, MOST_RECOVERY = 75.0, 0.1


def coordinates(scene: Scene, pedestal_tilt: float = 0.0) -> tuple[list[float], list[float]]:
    """Initial coordinates and velocities: base (if any), each block's centre x, z from its standing height, tilt."""
    bodies = placements(scene, pedestal_tilt)
    position, velocity = ([pair[i] for body in bodies for pair in body] for i in (0, 1))
    if scene.base is None:
        return position, velocity
    return [scene.start.base_displacement, *position], [scene.start.base_velocity, *velocity]


def _ground(scene: Scene, geom: str = "") -> str:
    """The support of the block as MJCF, its top at z = 0: a plane or, for a base, a slab on a slide joint."""
    if scene.base is None:
        return f'<geom type="plane" size="0 0 1" {geom}/>'
    reach, depth = 100 * scene.block.radius, scene.block.radius  # a plane cannot move in MuJoCo
    mass = moving_mass(scene)
    return (
        f'<body><joint name="base" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="{mass!r}" '
        f'diaginertia="{mass!r} {mass!r} {mass!r}"/>'
        f'<geom type="box" pos="0 0 {-depth!r}" size="{reach!r} {reach!r} {depth!r}" mass="0" {geom}/></body>'
    )


def contact_reference(step: float, recovery: float) -> tuple[float, float]:
    """MuJoCo's solref for a step [s]: -stiffness and -damping per unit of mass that stop a corner within it.

    A corner with penetration r then moves up at r min(MOST_RECOVERY/step, recovery), whatever its speed was.
    """
    return -min(MOST_RECOVERY / step, recovery) / step, -1.0 / step


def _body(slab: Slab, high: float, shape: str) -> str:
    """A block on slide-x, slide-z and hinge-y joints as MJCF; high: of its centre when standing [m]."""
    i = slab.inertia
    return (
        f'<body pos="0 0 {high!r}"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        f'<joint type="hinge" axis="0 1 0"/><inertial pos="0 0 0" mass="{slab.mass!r}" '
        f'diaginertia="{i!r} {i!r} {i!r}"/>{shape}</body>'
    )


def build(scene: Scene, step: float, plain: bool, pedestal_tilt: float = 0.0) -> MujocoBodies:
    """The block, on a free pedestal or not, over its ground or base in the initial state.

    step: longest step [s]. plain: a box for contact, and MuJoCo's defaults. Otherwise the pedestal carries the block on
    a box in its upper half, wider than itself, so that a corner at its edge meets the top and not the side. The ground
    does not meet this box.

    Raises
    ------
    Mismatch
        MuJoCo rejects the scene, or reports other values than it was given.
    """
    recovery, r = None if plain else RECOVERY / size_scale(scene), CORNER_RADIUS * scene.block.radius
    friction = FRICTION if scene.friction is None else scene.friction
    if recovery is None:
        solref, option, geom = None, "", "" if scene.friction is None else f'friction="{friction!r} 0 0"'
    else:
        stiffness, damping = solref = contact_reference(step, recovery)
        option, d = 'cone="elliptic"', IMPEDANCE
        geom = f'friction="{friction!r} 0 0" solref="{stiffness!r} {damping!r}" solimp="{d!r} {d!r} 1 .5 2"'
    bodies, ground, slabs = "", 0.0, slabs_of(scene)
    for slab in slabs:
        b, h = slab.b, slab.h
        spheres = "".join(
            f'<geom type="sphere" size="{r!r}" pos="{x!r} 0 {r - h!r}" contype="3" conaffinity="3" {geom}/>'
            for x in (-b, b)
        )
        top = f'size="{2 * b!r} {b!r} {h / 2!r}" pos="0 0 {h / 2!r}" contype="2" conaffinity="2" {geom}'
        box = f'<geom type="box" size="{b!r} {b!r} {h!r}" {geom}/>'
        bodies += _body(
            slab, ground + h, box if plain else spheres if slab is slabs[-1] else f'{spheres}<geom type="box" {top}/>'
        )
        ground += 2 * h
    try:
        model = mujoco.MjModel.from_xml_string(f"""<mujoco>
            <option timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" {option}>
              <flag autoreset="disable" diagexact="{"enable" if solref else "disable"}"/></option>
            <worldbody>{_ground(scene, geom)}{bodies}</worldbody></mujoco>""")
    except ValueError as error:
        raise Mismatch(str(error)) from error
    data = mujoco.MjData(model)
    check_readback(model, data, scene, step, solref, friction)
    data.qpos[:], data.qvel[:] = coordinates(scene, pedestal_tilt)
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

    The contacts are checked after MuJoCo has combined the parameters of both geoms: each block is moved into what
    carries it for this, and back. Contacts and solver are not checked where solref is None, as those are MuJoCo's
    defaults.
    """
    option, slabs, depth = model.opt, slabs_of(scene), -1e-3 * scene.block.radius
    masses = [moving_mass(scene)] * (scene.base is not None) + [slab.mass for slab in slabs]
    inertia = [[slab.inertia] * 3 for slab in slabs]
    expected = [
        ("time step", option.timestep, step),
        ("gravity", option.gravity, [0.0, 0.0, -scene.gravity]),
        ("integrator", option.integrator, int(mujoco.mjtIntegrator.mjINT_EULER)),
        ("disabled parts", option.disableflags, int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)),
        ("density and viscosity", [option.density, option.viscosity], 0.0),
        ("masses", model.body_mass[1:], masses),
        ("inertia", model.body_inertia[-len(slabs) :], inertia),
        ("centre of mass", model.body_ipos, 0.0),
        ("coordinates", model.nq, 2 * len(slabs) + len(masses)),
        *(
            (name, getattr(model, name), 0.0)
            for name in ("dof_damping", "dof_frictionloss", "dof_armature", "jnt_stiffness")
        ),
    ]
    if solref:
        data.qpos[1 - 3 * len(slabs) :: 3] = depth * np.arange(1, len(slabs) + 1)
        mujoco.mj_fwdPosition(model, data)
        expected += [
            ("cone", option.cone, int(mujoco.mjtCone.mjCONE_ELLIPTIC)),
            ("solver", option.solver, int(mujoco.mjtSolver.mjSOL_NEWTON)),
            ("enabled parts", option.enableflags, int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT)),
            ("contacts of standing blocks", data.ncon, 2 * len(slabs)),
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
        self.base, self.two = moving_mass(scene), scene.is_stack
        self.loaded = scene.bearings is not None
        self.option, self.gravity, self.push = model.opt, model.opt.gravity, data.qfrc_applied
        self.position, self.velocity = data.qpos.tolist, data.qvel.tolist

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> Sequence[float]:
        """A step: see `engines.loop.Bodies`."""
        if step != self.used:
            self.option.timestep = self.used = step
            if self.recovery:
                self.model.geom_solref[:] = contact_reference(step, self.recovery)
        self.gravity[0], self.gravity[2] = across / step, up / step
        if self.loaded:
            self.push[0] = impulse / step
        mujoco.mj_step(self.model, self.data)
        if self.two:
            return self.both()
        if not self.base:
            x, z, tilt = self.position()
            vx, vz, rate = self.velocity()
            return tilt, rate, x, z, vx, vz, 0.0, 0.0
        base, x, z, tilt = self.position()
        v, vx, vz, rate = self.velocity()
        return tilt, rate, x, z, vx, vz, base, v

    def both(self) -> Sequence[float]:
        """The states of pedestal and block, see `engines.loop.Bodies`."""
        *base, x1, z1, first, x, z, tilt = self.position()
        *speed, vx1, vz1, w1, vx, vz, rate = self.velocity()
        h, v = (base[0], speed[0]) if base else (0.0, 0.0)
        return first, w1, x1, z1, vx1, vz1, tilt, rate, x, z, vx, vz, h, v

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


def run(scene: Scene, variant: str, settings: Settings, pedestal_tilt: float = 0.0) -> Run:
    """The `Run` of a scene; pedestal_tilt: of a free pedestal at the start [rad]."""
    edge, plain = FIRST_CONTACT * scene.block.slenderness, isinstance(settings, FirstScript)
    messages: list[str] = []
    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(messages.append)  # otherwise MuJoCo writes a log file into the working directory
    try:
        result = run_of(
            scene,
            settings,
            lambda step: build(scene, step, plain, pedestal_tilt),
            lambda rows: replace(raw_trace_of(rows, scene, edge), settle=FIRST_SETTLE),
            pedestal_tilt=pedestal_tilt,
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


run_stack = run  # the same calls build one block and a stack
