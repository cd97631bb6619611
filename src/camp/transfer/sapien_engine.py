"""SAPIEN: PhysX's articulations, rigid contacts, PD drives that are part of the solver."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # that it draws by its own Vulkan; nothing is drawn
    import sapien

from camp.robots.quadruped import GRAVITY, JOINT_NAMES
from camp.transfer.description import Description
from camp.transfer.engine import READING_S, Contacts, Floats, State, contacts_of, dry_friction

TIMESTEP_S = 0.005
POSITION_ITERATIONS, VELOCITY_ITERATIONS = 50, 1
_ROBOT = 1  # collision group: shapes that share one do not touch each other


def start(description: Description) -> SapienEngine:
    """The robot on the ground."""
    return SapienEngine(description)


class SapienEngine:
    """One articulation in a scene of its own on the CPU."""

    timestep_s = TIMESTEP_S

    def __init__(self, description: Description):
        self._description = description
        friction = description.ground_friction
        sapien.physx.set_default_material(friction, friction, 0.0)
        sapien.physx.set_shape_config(contact_offset=0.01, rest_offset=0.0)
        sapien.physx.set_scene_config(
            gravity=[0.0, 0.0, -GRAVITY],  # pyright: ignore[reportArgumentType]
            enable_pcm=True,
            enable_tgs=True,
            enable_friction_every_iteration=True,
        )
        self._scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
        self._scene.set_timestep(TIMESTEP_S)
        material = self._scene.create_physical_material(friction, friction, 0.0)
        self._scene.add_ground(0.0, render=False, material=material)
        self._robot = self._load(friction)
        joints = self._robot.get_active_joints()
        names = [joint.name for joint in joints]  # sorted by type: all hips, all thighs, all calves
        self._order = np.array([names.index(name) for name in JOINT_NAMES])
        self._joints = [joints[place] for place in self._order]
        self._base = next(link for link in self._robot.links if link.parent is None)
        self._parts = self._watched()
        self._set_motors()

    def _load(self, friction: float):
        loader = self._scene.create_urdf_loader()
        loader.fix_root_link = False
        loader.set_material(friction, friction, 0.0)
        with tempfile.TemporaryDirectory() as folder:  # the loader takes files
            path = Path(folder) / f"{self._description.name}.urdf"
            path.write_text(self._description.urdf)
            robot = loader.load(str(path))
        robot.set_solver_position_iterations(POSITION_ITERATIONS)
        robot.set_solver_velocity_iterations(VELOCITY_ITERATIONS)
        for link in robot.links:
            link.linear_damping = link.angular_damping = 0.0
            for shape in link.collision_shapes:
                first, second, _, fourth = shape.get_collision_groups()
                shape.set_collision_groups([first, second, _ROBOT, fourth])
        return robot

    def _watched(self) -> dict[object, str]:
        """The part of the robot that each shape belongs to. Shapes have lost their names, but kept their order."""
        return {
            shape: part
            for link in self._robot.links
            for shape, part in zip(link.collision_shapes, self._description.parts[link.name].values(), strict=True)
        }

    def _set_motors(self) -> None:
        one = self._description
        for number, joint in enumerate(self._joints):
            joint.set_armature(np.array([one.armature[number]], dtype=np.float32))
            joint.set_friction(0.0)  # a multiple of the joint's load, which dry friction is not
            joint.set_drive_properties(
                float(one.kp[number]),
                float(one.kd[number] + one.damping[number]),
                force_limit=float(one.torque_limit[number]),
                mode="force",
            )

    def reset(self) -> None:
        one, joints = self._description, np.zeros(len(JOINT_NAMES), dtype=np.float32)
        joints[self._order] = one.default_pose
        self._robot.set_root_pose(sapien.Pose([0.0, 0.0, one.height]))
        self._robot.set_root_linear_velocity([0.0, 0.0, 0.0])
        self._robot.set_root_angular_velocity([0.0, 0.0, 0.0])
        self._robot.set_qpos(joints)
        self._robot.set_qvel(np.zeros_like(joints))
        self.set_targets(one.default_pose)

    def set_targets(self, target: Floats) -> None:
        for joint, value in zip(self._joints, target, strict=True):
            joint.set_drive_target(float(value))

    def step(self) -> None:
        for _ in range(round(READING_S / TIMESTEP_S)):
            torque = np.zeros(len(JOINT_NAMES), dtype=np.float32)
            torque[self._order] = dry_friction(self._description, self._robot.get_qvel()[self._order])
            self._robot.set_qf(torque)
            self._scene.step()

    def state(self) -> State:
        pose = self._base.entity_pose
        return State(
            position=np.array(pose.p, dtype=np.float64),
            rotation=pose.to_transformation_matrix()[:3, :3].astype(np.float64),
            angular_velocity=np.array(self._robot.root_angular_velocity, dtype=np.float64),
            joint_position=self._robot.get_qpos()[self._order],
            joint_velocity=self._robot.get_qvel()[self._order],
        )

    def contacts(self) -> Contacts:
        force: dict[str, Floats] = {}
        for contact in self._scene.get_contacts():
            impulse = sum((point.impulse for point in contact.points), np.zeros(3))
            for shape in contact.shapes:
                if shape in self._parts:
                    part = self._parts[shape]
                    force[part] = force.get(part, np.zeros(3)) + impulse / TIMESTEP_S
        return contacts_of(force, self._description)
