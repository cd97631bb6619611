"""DART, Gazebo's default engine: rigid contacts, motors as torques that are computed anew in every timestep."""

from __future__ import annotations

import tempfile
from pathlib import Path
from xml.etree import ElementTree

import dartpy as dart
import numpy as np

from camp.robots.quadruped import GRAVITY, JOINT_NAMES
from camp.transfer.description import Description
from camp.transfer.engine import READING_S, Contacts, Floats, State, contacts_of

TIMESTEP_S = 0.001
GROUND_M = (50.0, 50.0, 1.0)  # a box: its upper face is the ground
_HEIGHT = 5  # of the free joint's six values, turn first


def start(description: Description) -> DartEngine:
    """The robot on the ground."""
    return DartEngine(description)


class DartEngine:
    """One skeleton in a world of its own, collisions by ODE's detector."""

    timestep_s = TIMESTEP_S

    def __init__(self, description: Description):
        self._description = description
        self._world = dart.simulation.World()
        self._world.setGravity([0.0, 0.0, -GRAVITY])
        self._world.setTimeStep(TIMESTEP_S)
        self._world.getConstraintSolver().setCollisionDetector(dart.collision.OdeCollisionDetector())
        self._world.addSkeleton(_ground(description.ground_friction))
        self._robot = _loaded(description)
        self._world.addSkeleton(self._robot)
        names = [self._robot.getDof(k).getName() for k in range(self._robot.getNumDofs())]
        self._order = np.array([names.index(name) for name in JOINT_NAMES])
        self._base = self._robot.getBodyNode("base")
        for number, name in enumerate(JOINT_NAMES):
            joint = self._robot.getJoint(name)
            joint.setDampingCoefficient(0, float(description.damping[number]))
            joint.setCoulombFriction(0, float(description.dry_friction[number]))
            joint.setLimitEnforcement(True)
        for body in self._robot.getBodyNodes():
            for shape in body.getShapeNodes():
                shape.getDynamicsAspect().setFrictionCoeff(description.ground_friction)
        self._parts = {shape: part for shapes in description.parts.values() for shape, part in shapes.items()}
        self._target = description.default_pose

    def reset(self) -> None:
        position = np.zeros(self._robot.getNumDofs())
        position[self._order], position[_HEIGHT] = self._description.default_pose, self._description.height
        self._robot.setPositions(position)
        self._robot.setVelocities(np.zeros_like(position))
        self.set_targets(self._description.default_pose)

    def set_targets(self, target: Floats) -> None:
        self._target = target

    def step(self) -> None:
        one = self._description
        for _ in range(round(READING_S / TIMESTEP_S)):
            position, velocity = self._robot.getPositions()[self._order], self._robot.getVelocities()[self._order]
            wanted = one.kp * (self._target - position) - one.kd * velocity
            torque = np.zeros(self._robot.getNumDofs())
            torque[self._order] = np.clip(wanted, -one.torque_limit, one.torque_limit)
            self._robot.setForces(torque)
            self._world.step()

    def state(self) -> State:
        pose = self._base.getWorldTransform()
        return State(
            position=pose.translation(),
            rotation=pose.rotation(),
            angular_velocity=self._base.getAngularVelocity(),
            joint_position=self._robot.getPositions()[self._order],
            joint_velocity=self._robot.getVelocities()[self._order],
        )

    def contacts(self) -> Contacts:
        force: dict[str, Floats] = {}
        for contact in self._world.getLastCollisionResult().getContacts():
            for side in (contact.collisionObject1, contact.collisionObject2):
                part = self._parts.get(side.getShapeFrame().getName())
                if part is not None:
                    force[part] = force.get(part, np.zeros(3)) + contact.force
        return contacts_of(force, self._description)


def _loaded(description: Description):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{description.name}.urdf"
        path.write_text(with_rotors(description))
        return dart.utils.DartLoader().parseSkeleton(str(path))


def _ground(friction: float):
    ground = dart.dynamics.Skeleton("ground")
    _, body = ground.createWeldJointAndBodyNodePair()
    shape = body.createShapeNode(dart.dynamics.BoxShape(list(GROUND_M)))
    shape.createCollisionAspect()
    shape.createDynamicsAspect().setFrictionCoeff(friction)
    shape.setRelativeTranslation([0.0, 0.0, -GROUND_M[2] / 2])
    return ground


def with_rotors(description: Description) -> str:
    """The URDF with each rotor's inertia added to its link, about the joint's axis: DART's joints have no armature.

    No exact equivalent: the link's own turning counts, not the joint's.
    """
    root = ElementTree.fromstring(description.urdf)
    inertia = {link.get("name"): link.find("inertial/inertia") for link in root.iter("link")}
    for joint in root.iter("joint"):
        armature = description.armature[JOINT_NAMES.index(str(joint.get("name")))]
        child, axis = joint.find("child"), joint.find("axis")
        assert child is not None and axis is not None
        entries = inertia[child.get("link")]
        assert entries is not None
        x, y, z = map(float, str(axis.get("xyz")).split())
        for name, part in {"ixx": x * x, "iyy": y * y, "izz": z * z, "ixy": x * y, "ixz": x * z, "iyz": y * z}.items():
            entries.set(name, f"{float(str(entries.get(name))) + armature * part:.12g}")
    return ElementTree.tostring(root, encoding="unicode")
