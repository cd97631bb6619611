"""Drake: PD motors as part of the discrete solver, soft point contacts."""

# Drake's own stubs write the types of arrays in a way that no array fits.
# pyright: reportArgumentType=false, reportCallIssue=false

from __future__ import annotations

import logging
from xml.etree import ElementTree

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometryId, GeometrySet, HalfSpace, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    CoulombFriction,
    DiscreteContactApproximation,
)
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from camp.robots.quadruped import JOINT_NAMES, NUM_JOINTS
from camp.transfer.description import Description
from camp.transfer.engine import READING_S, Contacts, Floats, State, contacts_of, dry_friction

TIMESTEP_S = 0.0025
CONTACT = DiscreteContactApproximation.kSap  # the default, kLagged, needs 1-ms steps for these gaits


def start(description: Description) -> DrakeEngine:
    """The robot on the ground."""
    logging.getLogger("drake").setLevel(logging.ERROR)  # it warns of deformable bodies, of which there are none
    return DrakeEngine(description)


class DrakeEngine:
    """One plant with a simulator of its own."""

    timestep_s = TIMESTEP_S

    def __init__(self, description: Description):
        self._description = description
        builder = DiagramBuilder()
        self._plant, scene = AddMultibodyPlantSceneGraph(builder, TIMESTEP_S)
        self._plant.set_contact_model(ContactModel.kPoint)
        self._plant.set_discrete_contact_approximation(CONTACT)
        (self._robot,) = Parser(self._plant).AddModelsFromString(with_friction(description), "urdf")
        friction = CoulombFriction(description.ground_friction, description.ground_friction)
        surface = HalfSpace.MakePose([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
        self._plant.RegisterCollisionGeometry(self._plant.world_body(), surface, HalfSpace(), "ground", friction)
        self._add_motors()
        self._plant.Finalize()
        self._parts = self._watched(scene)
        among_itself = CollisionFilterDeclaration().ExcludeWithin(GeometrySet(list(self._parts)))
        scene.collision_filter_manager().Apply(among_itself)
        self._simulator = Simulator(builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())
        self._targets = self._plant.get_desired_state_input_port(self._robot)
        self._torques = self._plant.get_actuation_input_port(self._robot)
        self._found = self._plant.get_contact_results_output_port()
        self._base = self._plant.GetBodyByName("base", self._robot)
        self._joints = [self._plant.GetJointByName(name, self._robot) for name in JOINT_NAMES]

    def _add_motors(self) -> None:
        """In the order of JOINT_NAMES, which the input ports follow. A plant takes none once it is finalized."""
        one = self._description
        for number, name in enumerate(JOINT_NAMES):
            joint = self._plant.GetJointByName(name, self._robot)
            motor = self._plant.AddJointActuator(name, joint, float(one.torque_limit[number]))
            motor.set_default_rotor_inertia(float(one.armature[number]))
            motor.set_default_gear_ratio(1.0)
            motor.set_controller_gains(PdControllerGains(p=float(one.kp[number]), d=float(one.kd[number])))

    def _watched(self, scene: SceneGraph) -> dict[GeometryId, str]:
        """The part of the robot that each of its shapes belongs to."""
        inspector, parts = scene.model_inspector(), {}
        for link, shapes in self._description.parts.items():
            body = self._plant.GetBodyByName(link, self._robot)
            for shape in self._plant.GetCollisionGeometriesForBody(body):
                parts[shape] = shapes[inspector.GetName(shape).split("::")[-1]]
        return parts

    def reset(self) -> None:
        one, context = self._description, self._context
        self._simulator.get_mutable_context().SetTime(0.0)
        self._plant.SetFreeBodyPose(context, self._base, RigidTransform([0.0, 0.0, one.height]))
        self._plant.SetFreeBodySpatialVelocity(context, self._base, SpatialVelocity(np.zeros(6)))
        for joint, angle in zip(self._joints, one.default_pose, strict=True):
            joint.set_angle(context, angle)
            joint.set_angular_rate(context, 0.0)
        self.set_targets(one.default_pose)
        self._torques.FixValue(context, np.zeros(NUM_JOINTS))
        self._simulator.Initialize()

    def set_targets(self, target: Floats) -> None:
        self._targets.FixValue(self._context, np.concatenate([target, np.zeros(NUM_JOINTS)]))

    def step(self) -> None:
        for _ in range(round(READING_S / TIMESTEP_S)):
            self._torques.FixValue(self._context, dry_friction(self._description, self.state().joint_velocity))
            self._simulator.AdvanceTo(self._simulator.get_context().get_time() + TIMESTEP_S)

    def state(self) -> State:
        pose = self._plant.EvalBodyPoseInWorld(self._context, self._base)
        return State(
            position=pose.translation(),
            rotation=pose.rotation().matrix(),
            angular_velocity=self._plant.EvalBodySpatialVelocityInWorld(self._context, self._base).rotational(),
            joint_position=np.array([joint.get_angle(self._context) for joint in self._joints]),
            joint_velocity=np.array([joint.get_angular_rate(self._context) for joint in self._joints]),
        )

    def contacts(self) -> Contacts:
        force: dict[str, Floats] = {}
        results = self._found.Eval(self._context)
        for number in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(number)
            for shape in (contact.point_pair().id_A, contact.point_pair().id_B):
                part = self._parts.get(shape)
                if part is not None:
                    force[part] = force.get(part, np.zeros(3)) + contact.contact_force()
        return contacts_of(force, self._description)


def with_friction(description: Description) -> str:
    """The URDF with Drake's own elements for the shapes' friction, without which it would be 1.

    Without the joints' friction, which Drake's joints do not have: `step` applies it.
    """
    root = ElementTree.fromstring(description.urdf)
    for dynamics in root.iter("dynamics"):
        dynamics.attrib.pop("friction")
    for collision in root.iter("collision"):
        properties = ElementTree.SubElement(collision, "drake:proximity_properties")
        for name in ("drake:mu_static", "drake:mu_dynamic"):
            ElementTree.SubElement(properties, name, value=f"{description.ground_friction:g}")
    return ElementTree.tostring(root, encoding="unicode")
