"""Where an episode starts: in a frame of an expert clip, or standing."""

from __future__ import annotations

import torch

from camp.common.tensors import constant
from camp.envs.commands import uniform
from camp.envs.config import InitializationConfig
from camp.envs.measurement import rotate
from camp.motion.clips.sampler import ReferenceState
from camp.robots.kinematics import foot_position
from camp.robots.quadruped import NUM_JOINTS
from camp.robots.robot import Robot
from camp.sim.base import InitialState


def from_reference(reference: ReferenceState) -> InitialState:
    """Reference-state initialization: the exact state of a clip's frame, above the world's origin."""
    position = torch.zeros_like(reference.base_linear_velocity)
    position[:, 2] = reference.base_height
    return InitialState(
        base_position=position,
        base_quaternion=reference.base_quaternion,
        base_linear_velocity=rotate(reference.base_quaternion, reference.base_linear_velocity),
        base_angular_velocity=reference.base_angular_velocity,
        joint_position=reference.joint_position,
        joint_velocity=reference.joint_velocity,
    )


def standing(robot: Robot, num: int, config: InitializationConfig, generator: torch.Generator) -> InitialState:
    """At rest, joints at the default pose times a random factor (Table I, "Initial Joint Positions").

    The base is raised or lowered so that the lowest foot just touches the ground.
    """
    device = generator.device
    scale = uniform(config.joint_position_scale, (num, NUM_JOINTS), generator)
    joints = constant(robot.default_joint_position, scale) * scale
    joints = joints.clamp(constant(robot.joint_lower, scale), constant(robot.joint_upper, scale))
    position = torch.zeros(num, 3, device=device)
    position[:, 2] = robot.leg.foot_radius - foot_position(robot.leg, joints)[..., 2].amin(dim=1)
    return InitialState(
        base_position=position,
        base_quaternion=constant((1.0, 0.0, 0.0, 0.0), scale).expand(num, 4),
        base_linear_velocity=torch.zeros(num, 3, device=device),
        base_angular_velocity=torch.zeros(num, 3, device=device),
        joint_position=joints,
        joint_velocity=torch.zeros(num, NUM_JOINTS, device=device),
    )
