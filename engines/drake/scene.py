"""The scene as a plant of Drake: the block on a planar joint (z, x, tilt), the base on a prismatic one.

The plant has one time step, c. Nothing in it asks how long ours are: its update takes velocities and an impulse, solves
the contacts, and hands the velocities back that are left. Its contact yields, though: a corner that sank by d leaves at
d/c, less impulse/(c^2 stiffness). So c is long, and the contact stiff in c.

Of Drake's solvers TAMSI takes 20 microseconds an update, SAP 110. TAMSI's Newton iteration cycles in up to a third of
the updates where a corner with that friction could jam (Painleve), though nothing slides: so it is given less, and as
long as nothing slips either friction has the same impulses. Where a corner slips, or TAMSI still cycles, SAP
repeats the update with all the friction that there is. SAP alone would lift a body that slides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, ProximityProperties, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiscreteContactApproximation,
    MultibodyPlant,
)
from pydrake.multibody.tree import FixedOffsetFrame, PlanarJoint, PrismaticJoint, RigidBody, SpatialInertia, UnitInertia
from pydrake.systems.framework import DiagramBuilder

from ..pivoting import depth
from ..placement import placement
from ..readback import require

if TYPE_CHECKING:
    from analytic import Scene

FRICTION = 5.0  # stands for the model's "no sliding", where the scene gives none
UNJAMMED = 0.8  # share of the friction at which a corner could jam, for TAMSI
CORNER_RADIUS = 1e-6  # share of R: the block touches by a sphere at each bottom corner
WIDTH, THICKNESS = 2e3, 2.0  # of the ground, shares of R
CLOCK = 1e3  # the plant's time step over sqrt(R/g)
RIGID = 1e4  # stiffness of each of two materials, one above the other, times CLOCK^2 R/g over the block's mass
STICTION = 1e-6  # most slip of a corner that sticks, over sqrt(R g)
NEAR_RIGID = 1e-3  # SAP's: what is left of a speed into the ground is the square of this over 4 pi^2


class Contacts:
    """A plant of Drake with one contact solver: velocities after an impulse."""

    def __init__(self, scene: Scene, approximation: DiscreteContactApproximation, friction: float) -> None:
        self.friction, self.approximation = friction, approximation
        builder, R = DiagramBuilder(), scene.block.radius
        clock, stiffness = clock_of(scene)
        touching = material(friction, stiffness, 0.0)
        self.plant, self.graph = plant, _ = AddMultibodyPlantSceneGraph(builder, clock)
        plant.SetUseSampledOutputPorts(False)  # else there is no update by itself, without a simulator
        plant.set_discrete_contact_approximation(approximation)
        plant.set_stiction_tolerance(STICTION * math.sqrt(R * scene.gravity))
        plant.set_sap_near_rigid_threshold(NEAR_RIGID)
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
        self.block = plant.AddRigidBody("block", solid(scene.block.mass, scene.block.centre_inertia))
        # The joint's x, y and z are the world's z, x and y.
        turned = RigidTransform(RotationMatrix(np.roll(np.eye(3), -1, axis=0)), [0.0, 0.0, 0.0])
        plane, centre = (
            plant.AddFrame(FixedOffsetFrame(name, frame, turned))
            for name, frame in (("plane", plant.world_frame()), ("centre", self.block.body_frame()))
        )
        plant.AddJoint(PlanarJoint("planar", plane, centre, [0.0, 0.0, 0.0]))
        self.base, r = add_ground(plant, scene, touching), CORNER_RADIUS * R
        for name, x in (("left", -scene.block.half_width), ("right", scene.block.half_width)):
            place = RigidTransform([x, 0.0, r - scene.block.half_height])
            plant.RegisterCollisionGeometry(self.block, place, Sphere(r), name, touching)
        plant.Finalize()
        self.diagram = builder.Build()
        self.root = self.diagram.CreateDefaultContext()
        self.context = plant.GetMyMutableContextFromRoot(self.root)
        self.count, self.clock = plant.num_velocities(), clock
        port = plant.get_applied_generalized_force_input_port()
        self.loads = port.FixValue(self.context, np.zeros(self.count))
        self.context.SetDiscreteState(start_of(scene))

    def kick(self, state: np.ndarray, impulse: np.ndarray) -> list[float]:
        """Velocities after an impulse on a state as `start_of` has it.

        Raises
        ------
        RuntimeError
            Drake finds no solution.
        """
        self.loads.GetMutableData().get_mutable_value().SetFromVector(impulse / self.clock)
        self.context.SetDiscreteState(state)
        return self.plant.EvalUniquePeriodicDiscreteUpdate(self.context).value()[self.count :].tolist()


@dataclass(frozen=True)
class Assembly:
    """The scene twice: with TAMSI, and with SAP for corners that TAMSI's friction does not hold (None: it is all)."""

    contacts: Contacts
    holding: Contacts | None


def material(friction: float, stiffness: float | None = None, dissipation: float | None = None) -> ProximityProperties:
    """Of a shape that touches: stiffness [N/m], dissipation [s/m]; None: Drake's own."""
    properties = ProximityProperties()
    given = {"point_stiffness": stiffness, "dissipation": dissipation}
    AddContactMaterial(
        properties=properties,
        friction=CoulombFriction(friction, friction),
        **{name: value for name, value in given.items() if value is not None},
    )
    return properties


def solid(mass: float, inertia: float) -> SpatialInertia:
    """Of a body that has the same moment of inertia [kg m2] about every axis through its centre."""
    return SpatialInertia(mass, [0.0, 0.0, 0.0], UnitInertia(*[inertia / mass] * 3))


def add_ground(plant: MultibodyPlant, scene: Scene, properties: ProximityProperties) -> RigidBody | None:
    """Give a plant the ground of a scene, its top at z = 0; the body that is the base."""
    base, R = None, scene.block.radius
    if scene.base is not None:
        base = plant.AddRigidBody("base", solid(scene.base.mass, scene.base.mass * R**2))
        plant.AddJoint(PrismaticJoint("slide", plant.world_frame(), base.body_frame(), [1.0, 0.0, 0.0]))
    plant.RegisterCollisionGeometry(
        plant.world_body() if base is None else base,
        RigidTransform([0.0, 0.0, -0.5 * THICKNESS * R]),
        Box(WIDTH * R, WIDTH * R, THICKNESS * R),
        "ground",
        properties,
    )
    return base


def build(scene: Scene) -> Assembly:
    """The `Assembly` of a scene at its start. Gravity and all loads are given as impulses: the plants have none.

    Raises
    ------
    Mismatch
        Drake reports other values than it was given.
    """
    friction = FRICTION if scene.friction is None else scene.friction
    less = min(friction, UNJAMMED * jamming(scene))
    assembly = Assembly(
        Contacts(scene, DiscreteContactApproximation.kTamsi, less),
        Contacts(scene, DiscreteContactApproximation.kSap, friction) if less < friction else None,
    )
    for contacts in filter(None, (assembly.contacts, assembly.holding)):
        check_readback(contacts, scene)
    return assembly


def jamming(scene: Scene) -> float:
    """Least friction, at any tilt, at which a sliding corner could jam: (j - 1 + sin^2)/(sin cos), J_O = j m R^2."""
    j = 1 + scene.block.centre_inertia / (scene.block.mass * scene.block.radius**2)
    angle = min(scene.block.slenderness, math.atan(math.sqrt((j - 1) / j)))
    return (j - 1 + math.sin(angle) ** 2) / (math.sin(angle) * math.cos(angle))


def start_of(scene: Scene) -> np.ndarray:
    """Positions (z, x, tilt, base) and velocities of the plant at the start; without a base they lack the fourth."""
    x, z, vx, vz = placement(scene)
    start = scene.start
    positions, velocities = [z + scene.block.half_height - depth(scene), x, start.tilt], [vz, vx, start.tilt_rate]
    if scene.base is not None:
        positions.append(start.base_displacement)
        velocities.append(start.base_velocity)
    return np.array(positions + velocities)


def clock_of(scene: Scene) -> tuple[float, float]:
    """(time step of the plant [s], stiffness of each of two materials [N/m]) for a scene."""
    clock = CLOCK * math.sqrt(scene.block.radius / scene.gravity)
    return clock, RIGID * scene.block.mass / clock**2


def check_readback(contacts: Contacts, scene: Scene) -> None:
    """Compare what Drake reports with what the scene needs; raises `Mismatch` naming what differs."""
    plant, context, inspector = contacts.plant, contacts.context, contacts.graph.model_inspector()
    clock, stiffness = clock_of(scene)
    inertia = contacts.block.CalcSpatialInertiaInBodyFrame(context).CalcRotationalInertia()
    expected = [
        ("time step", plant.time_step(), clock),
        ("solver is as asked", plant.get_discrete_contact_approximation() == contacts.approximation, True),
        ("gravity", plant.gravity_field().gravity_vector(), 0.0),
        ("block: mass", contacts.block.get_mass(context), scene.block.mass),
        ("block: inertia", inertia.get_moments(), scene.block.centre_inertia),
        ("positions and velocities", plant.GetPositionsAndVelocities(context), start_of(scene)),
    ]
    for shape in inspector.GetAllGeometryIds():
        held, name = inspector.GetProximityProperties(shape), inspector.GetName(shape).split("::")[-1]
        coulomb = held.GetProperty("material", "coulomb_friction")
        expected += [
            (f"{name}: friction", [coulomb.static_friction(), coulomb.dynamic_friction()], contacts.friction),
            (f"{name}: stiffness", held.GetProperty("material", "point_contact_stiffness"), stiffness),
            (f"{name}: dissipation", held.GetProperty("material", "hunt_crossley_dissipation"), 0.0),
        ]
    if contacts.base is not None:
        expected += [("base: mass", contacts.base.get_mass(context), scene.base.mass)]
    require(expected)
