"""The robot as other engines read it: a URDF made from its MuJoCo model, and the joints' properties beside it.

A URDF tells links, inertias, joint axes, ranges, joint friction and collision shapes. It knows nothing of gains, of the
rotors' inertia (armature) or of the ground: engines are given these as numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import NDArray

from camp.common.errors import CampError
from camp.robots.mujoco_robot import Joints, lowest_foot
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES
from camp.robots.robot import Robot

Floats = NDArray[np.float64]

NO_SPEED_LIMIT = 1000.0  # rad/s: a URDF must name one, and MuJoCo's joints have none
_CAPSULE_ENDS = (-1.0, 1.0)


@dataclass(frozen=True)
class Description:
    """One robot with one policy's gains. Joint values (12,) are in the order of JOINT_NAMES."""

    name: str
    urdf: str  # the file's text; collision elements have the names of the model's geoms
    kp: Floats  # N m/rad
    kd: Floats  # N m s/rad
    torque_limit: Floats  # N m
    armature: Floats  # kg m^2, inertia of the rotor as the joint feels it
    damping: Floats  # N m s/rad, of the joint itself
    dry_friction: Floats  # N m
    ground_friction: float  # of a foot on the ground
    default_pose: Floats  # rad
    height: float  # m, of the base in the default pose, the lowest foot just touching

    @cached_property
    def parts(self) -> dict[str, dict[str, str]]:
        """By link, in the order of the file: the shapes, each with the part that it belongs to.

        A foot is a part of its own; any other shape belongs to its link.
        """
        links = ElementTree.fromstring(self.urdf).iter("link")
        shapes = {link.attrib["name"]: [one.attrib["name"] for one in link.iter("collision")] for link in links}
        return {link: {name: name if name in self.feet else link for name in names} for link, names in shapes.items()}

    @property
    def feet(self) -> tuple[str, ...]:
        """Names of the feet's collision shapes, in the order of FOOT_NAMES."""
        return tuple(f"{foot}_foot" for foot in FOOT_NAMES)

    @property
    def trunk_and_thighs(self) -> tuple[str, ...]:
        """Names of the links that touch the ground in a fall."""
        return ("base", *(f"{foot}_thigh" for foot in FOOT_NAMES))


def describe(robot: Robot, metadata: Mapping[str, Any]) -> Description:
    """The robot with the gains and the pose of an exported policy's metadata."""
    model = fused_model(robot)
    joints = [model.joint(name) for name in JOINT_NAMES]
    dof = np.array([joint.dofadr[0] for joint in joints])
    limit = np.array([model.actuator(name).forcerange[1] for name in JOINT_NAMES])
    pose = _in_order(metadata, "default_pose")
    return Description(
        name=robot.name,
        urdf=urdf_of(model, robot.name, dict(zip(JOINT_NAMES, limit, strict=True))),
        kp=_in_order(metadata, "kp"),
        kd=_in_order(metadata, "kd"),
        torque_limit=limit,
        armature=model.dof_armature[dof].copy(),
        damping=model.dof_damping[dof].copy(),
        dry_friction=model.dof_frictionloss[dof].copy(),
        ground_friction=float(model.geom(f"{FOOT_NAMES[0]}_foot").friction[0]),
        default_pose=pose,
        height=_standing_height(model, pose),
    )


def fused_model(robot: Robot) -> mujoco.MjModel:
    """The robot's model with every body that has no joint of its own as part of the body that carries it.

    Links without mass, such as a foot that is only a shape, trouble other engines: some give them 1 kg.
    """
    spec = robot.load_spec()
    spec.compiler.fusestatic = True
    return spec.compile()


def urdf_of(model: mujoco.MjModel, name: str, torque_limit: Mapping[str, float]) -> str:
    """The text of a URDF: links, joints and collision shapes of a model with one floating robot.

    torque_limit: N m by joint. A capsule, which a URDF does not have, becomes a cylinder and two spheres. Raises
    CampError for a shape that is neither sphere, capsule, cylinder nor box.
    """
    root = ElementTree.Element("robot", name=name)
    for body in range(1, model.nbody):
        link = ElementTree.SubElement(root, "link", name=model.body(body).name)
        _add_inertial(link, model, body)
        for geom in np.flatnonzero((model.geom_bodyid == body) & (model.geom_conaffinity != 0)):
            _add_collisions(link, model, int(geom))
        if model.body_parentid[body] != 0:
            _add_joint(root, model, body, torque_limit)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _add_inertial(link: ElementTree.Element, model: mujoco.MjModel, body: int) -> None:
    """Mass, centre of mass, and the inertia about it along the link's own axes."""
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    axes = turn.reshape(3, 3)
    inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=_text(model.body_ipos[body]), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=_text(model.body_mass[body]))
    entries = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    ElementTree.SubElement(inertial, "inertia", {name: _text(inertia[at]) for name, at in entries.items()})


def _add_joint(root: ElementTree.Element, model: mujoco.MjModel, body: int, limit: Mapping[str, float]) -> None:
    """The hinge between a body and the one that carries it."""
    joint = model.joint(model.body_jntadr[body])
    element = ElementTree.SubElement(root, "joint", name=joint.name, type="revolute")
    ElementTree.SubElement(element, "parent", link=model.body(model.body_parentid[body]).name)
    ElementTree.SubElement(element, "child", link=model.body(body).name)
    _add_origin(element, model.body_pos[body], model.body_quat[body])
    ElementTree.SubElement(element, "axis", xyz=_text(joint.axis))
    lower, upper = map(_text, joint.range)
    dof = joint.dofadr[0]
    damping, friction = _text(model.dof_damping[dof]), _text(model.dof_frictionloss[dof])
    ElementTree.SubElement(element, "dynamics", damping=damping, friction=friction)
    bounds = {"lower": lower, "upper": upper, "effort": _text(limit[joint.name]), "velocity": _text(NO_SPEED_LIMIT)}
    ElementTree.SubElement(element, "limit", bounds)


def _add_collisions(link: ElementTree.Element, model: mujoco.MjModel, geom: int) -> None:
    name, size, kind = model.geom(geom).name, model.geom_size[geom], mujoco.mjtGeom(model.geom_type[geom])
    position, turn = model.geom_pos[geom], model.geom_quat[geom]
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        _add_shape(link, name, position, turn).append(_sphere(size[0]))
    elif kind == mujoco.mjtGeom.mjGEOM_BOX:
        shape = ElementTree.Element("box", size=_text(2.0 * size))
        _add_shape(link, name, position, turn).append(shape)
    elif kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER):
        shape = ElementTree.Element("cylinder", radius=_text(size[0]), length=_text(2.0 * size[1]))
        _add_shape(link, name, position, turn).append(shape)
        for end in _CAPSULE_ENDS if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else ():
            along = np.zeros(3)
            mujoco.mju_rotVecQuat(along, np.array([0.0, 0.0, end * size[1]]), turn)
            _add_shape(link, f"{name}_end{end:+.0f}", position + along, turn).append(_sphere(size[0]))
    else:
        shape = kind.name.removeprefix("mjGEOM_").lower()
        raise CampError(f"geom {name}: shape {shape} has no place in a URDF of primitives; use a capsule")


def _add_shape(link: ElementTree.Element, name: str, position: Floats, turn: Floats) -> ElementTree.Element:
    """The `geometry` of a new collision element, to hold the shape."""
    collision = ElementTree.SubElement(link, "collision", name=name)
    _add_origin(collision, position, turn)
    return ElementTree.SubElement(collision, "geometry")


def _sphere(radius: float) -> ElementTree.Element:
    return ElementTree.Element("sphere", radius=_text(radius))


def _add_origin(element: ElementTree.Element, position: Floats, turn: Floats) -> None:
    """A pose as URDF writes it: roll, pitch and yaw about fixed axes."""
    w, x, y, z = turn
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    ElementTree.SubElement(element, "origin", xyz=_text(position), rpy=_text(np.array([roll, pitch, yaw])))


def _in_order(metadata: Mapping[str, Any], key: str) -> Floats:
    """Values (12,) of the metadata in the order of JOINT_NAMES."""
    by_name = dict(zip(metadata["joint_names"], metadata[key], strict=True))
    return np.array([by_name[name] for name in JOINT_NAMES], dtype=np.float64)


def _standing_height(model: mujoco.MjModel, pose: Floats) -> float:
    data = mujoco.MjData(model)
    data.qpos[:7] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    data.qpos[Joints.of(model, JOINT_NAMES).position] = pose
    return -lowest_foot(model, data)


def _text(value: float | Floats) -> str:
    """Numbers with all their digits, side by side."""
    return " ".join(f"{number:.12g}" for number in np.atleast_1d(value))
