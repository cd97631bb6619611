"""The batched locomotion environment: N robots, each with a velocity command and a skill."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.vector import AutoresetMode, VectorEnv
from torch import Tensor

from camp.common.seeding import generator_state, restore_generator
from camp.common.tensors import constant, copied
from camp.data import Step
from camp.envs.actions import as_action, usable
from camp.envs.commands import sample_commands, sample_skills, uniform
from camp.envs.config import EXTERNAL, EnvConfig
from camp.envs.divergence import FirstCase, judged, per_robot
from camp.envs.measurement import Measurement, measure
from camp.envs.motion_history import MotionHistory
from camp.envs.observer import Observer
from camp.envs.rewards import active_terms, averaged, mix_rewards, task_rewards
from camp.envs.saved_state import upgraded
from camp.envs.situation import Before, Setup, Situation
from camp.envs.skill_schedule import SkillSchedule
from camp.envs.start_pool import StartPool
from camp.envs.terminations import failed
from camp.motion.clips.sampler import ReferenceStates
from camp.robots.amp_state import amp_slice
from camp.robots.quadruped import NUM_JOINTS
from camp.sim.base import Dynamics, RobotState, Simulator, select

# A start for every robot is drawn this often, in s, and taken by those whose episode ends meanwhile: what drawing
# costs is shared by many control steps, and nobody has to wait for the number of robots that need one.
STARTS_PERIOD_S = 0.4
_JOINT_VELOCITY = amp_slice("joint_velocity")


class QuadrupedEnv(VectorEnv):
    """N robots in torch; ended episodes restart within the same step (``AutoresetMode.SAME_STEP``).

    A step works on all robots alike, with masks where they differ, so that on an accelerator the host never waits.

    Args:
        sim: the simulator; the environment's tensors live on its device.
        config: conf/env.
        action_scale: rad per unit of the network's output (k of the paper's action).
        references: frames of expert clips, one label per skill.
        generator: all of the environment's randomness, on the simulator's device.
    """

    def __init__(
        self,
        sim: Simulator,
        config: EnvConfig,
        action_scale: float,
        references: ReferenceStates,
        generator: torch.Generator,
    ):
        self.sim = sim
        self.robot = sim.robot
        self.config = config
        self.action_scale = action_scale
        self.num_envs = sim.num_envs
        self.num_skills = references.num_skills
        self.setup = Setup(self.robot, self.num_skills, config.observe_skill, action_scale, sim.control_period)
        self.observer = Observer(config, self.num_skills, generator)
        num_observed, num_privileged = self.observer.sizes
        self.metadata = {"autoreset_mode": AutoresetMode.SAME_STEP}
        self.single_observation_space = _box(num_observed)
        self.single_action_space = _box(NUM_JOINTS)
        self.observation_space = gym.vector.utils.batch_space(self.single_observation_space, self.num_envs)
        self.action_space = gym.vector.utils.batch_space(self.single_action_space, self.num_envs)

        self._generator = generator
        self._device = sim.device
        self._terms = active_terms(config.reward.terms)
        self._weights = config.reward.weights()
        self.num_steps = 0  # control steps of each robot since construction
        initial = config.hardening.initial
        self.difficulty = 1.0 if initial is None else initial  # share of noise, randomization and pushes
        self.skill_schedule: SkillSchedule | None = None  # None: all skills alike, as configured
        self._pool = StartPool(self.setup, config, references, self.observer, generator)
        self._steps_to_draw = 0  # control steps until new starts are drawn
        num, device = self.num_envs, self._device
        self.step_count = torch.zeros(num, dtype=torch.int64, device=device)  # control steps into the episode
        self.command = torch.zeros(num, 3, device=device)  # vx, vy in m/s, yaw rate in rad/s
        self.skill = torch.zeros(num, dtype=torch.int64, device=device)
        self.last_action = torch.zeros(num, NUM_JOINTS, device=device)
        self._before = Before(self.last_action, self.last_action)
        self.average_velocity = torch.zeros(num, 3, device=device)  # of the last strides, as the reward takes it
        self.dynamics = Dynamics.nominal(num, config.randomization.nominal_friction, device)
        self.motion = MotionHistory(num, config.transition_ages, config.foot_stance, device)
        self.num_diverged = torch.zeros((), dtype=torch.int64, device=device)  # simulations since construction
        self.first_diverged = FirstCase(device)
        self.default_pose = constant(self.robot.default_joint_position, self.command)
        self.observation = torch.zeros(num, num_observed, device=device)
        self.privileged = torch.zeros(num, num_privileged, device=device)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Tensor, dict[str, Any]]:
        """Restart every robot.

        Episodes begin at random times within their length, so that they do not all end together;
        ``options={"stagger": False}`` begins them all at 0; ``options={"dynamics": Dynamics}`` gives the N robots
        these physical parameters in the episodes that begin now, instead of random ones.
        """
        options = options or {}
        if seed is not None:
            self._generator.manual_seed(seed)
        self._draw_starts(options.get("dynamics"))
        self._begin(torch.ones(self.num_envs, dtype=torch.bool, device=self._device))
        self._steps_to_draw = 0
        if options.get("stagger", True):
            shortest = int(torch.as_tensor(self._episode_steps(self.skill)).min())
            self.step_count = torch.randint(shortest, (self.num_envs,), generator=self._generator, device=self._device)
        return self.observation, {"privileged": self.privileged}

    def step(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, dict[str, Any]]:
        """Gymnasium's form of ``advance``: the reward is the weighted task reward, the ``Step`` is in the info."""
        result = self.advance(actions)
        info = {"step": result, "privileged": result.privileged, "final_obs": result.final_observation}
        return result.observation, result.task_reward, result.terminated, result.truncated, info

    def advance(self, action: Tensor, give_up: Tensor | None = None) -> Step:
        """One control step with the network's outputs (N, 12): target = default pose + k action.

        A robot whose action is not finite or absurd, or whose state becomes physically impossible, has diverged: its
        episode is terminated without reward, and nothing of the impossible state is passed on.

        give_up: (N,) bool, whose episode is truncated at its end in any case. Raises ValueError, before anything
        changes, for actions of another type or shape.
        """
        given = as_action(action, (self.num_envs, NUM_JOINTS), self._device)
        action, useless = usable(given)
        if self._steps_to_draw == 0:
            self._draw_starts()
        self._steps_to_draw -= 1
        self.num_steps += 1
        self._before = Before(self.last_action, self.motion.newest[:, _JOINT_VELOCITY])
        self.last_action = action
        self._push()
        before, target = per_robot(self.sim.state_dict()), self.default_pose + self.action_scale * action
        self.sim.step(target)
        self.step_count = self.step_count + 1

        reached = self.sim.state
        state, diverged = judged(self.robot, reached, useless, self._pool.starts.initial.robot_state())
        self.first_diverged.note(diverged, self._case(before, given, target, reached))
        measurement = measure(self.robot, state)
        self.num_diverged = self.num_diverged + diverged.sum()
        transition = self.motion.move_on(measurement, state.foot_stance, diverged)
        velocity = measurement.velocity()
        self.average_velocity = averaged(
            self.average_velocity, velocity, self.sim.control_period, self.config.reward.velocity_average_s
        )
        situation = self._situation(measurement)
        reward = {name: term.masked_fill(diverged, 0.0) for name, term in task_rewards(self._terms, situation).items()}
        terminated = failed(measurement, diverged, self.config.termination)
        truncated = self.step_count >= self._episode_steps(self.skill)
        if give_up is not None:
            truncated = truncated | give_up
        truncated = truncated & ~terminated
        command, skill = self.command, self.skill

        self._draw_commands()
        situation = replace(situation, command=self.command, skill=self.skill)
        seen = self.observer.frame(situation, self.difficulty)
        final_observation, final_privileged = self.observer.next(self.observation, seen.observation), seen.privileged
        self.observation, self.privileged = final_observation, final_privileged
        self._begin(terminated | truncated)
        return Step(
            observation=self.observation,
            privileged=self.privileged,
            final_observation=final_observation,
            final_privileged=final_privileged,
            reward=reward,
            task_reward=mix_rewards(reward, self._weights) if reward else torch.zeros_like(self.command[:, 0]),
            terminated=terminated,
            truncated=truncated,
            diverged=diverged,
            transition=transition,
            skill=skill,
            command=command,
            velocity=velocity,
            foot_contact=measurement.foot_contact,
        )

    def set_command(self, command: Tensor, skill: Tensor) -> Tensor:
        """Command every robot: (N, 3) and (N,); returns the observation. Call ``reset`` first.

        With ``env.command.source=external`` this holds until the next call, also in episodes that begin meanwhile; else
        until the clock draws anew.
        """
        self.command, self.skill = command.clone(), skill.clone()
        if self.config.command.source == EXTERNAL:
            self._pool.keep(replace(self._pool.starts, command=self.command, skill=self.skill), self.difficulty)
        seen = self.observer.frame(self._situation(measure(self.robot, self.sim.state)), self.difficulty)
        self.observation = self.observer.corrected(self.observation, seen.observation)
        self.privileged = seen.privileged
        return self.observation

    def state_dict(self) -> dict[str, Any]:
        """Everything a bit-for-bit continuation needs, the simulator and the random state included."""
        state: dict[str, Any] = {name: getattr(self, name) for name in _STATE}
        state["amp_history"] = self.motion.states
        state["dynamics"] = self.dynamics.tensors()
        state |= self._pool.state_dict()
        state["steps_to_draw"] = self._steps_to_draw
        state["num_steps"] = self.num_steps
        state["difficulty"] = self.difficulty
        state["skill_schedule"] = None if self.skill_schedule is None else self.skill_schedule.state_dict()
        state["generator"] = generator_state(self._generator)
        state["sim"] = self.sim.state_dict()
        return state

    def load_state_dict(self, state: dict[str, Any]) -> None:
        generator = state["generator"]
        state = upgraded(copied(state, self._device))
        for name in _STATE:
            setattr(self, name, state[name])
        self.motion.states = state["amp_history"]
        self.dynamics = Dynamics.from_tensors(state["dynamics"])
        self._pool.load_state_dict(state)
        self._before = Before(self.last_action, self.motion.newest[:, _JOINT_VELOCITY])
        self._steps_to_draw = state["steps_to_draw"]
        self.num_steps = state["num_steps"]
        self.difficulty = state["difficulty"]
        schedule = state["skill_schedule"]
        self.skill_schedule = None if schedule is None else SkillSchedule.from_state_dict(schedule, self._device)
        restore_generator(self._generator, generator)
        self.sim.prepare(self.dynamics)
        self.sim.reset(torch.ones_like(self.step_count, dtype=torch.bool), self._pool.starts.initial)
        self.sim.load_state_dict(state["sim"])
        self.sim.prepare(self._pool.starts.dynamics)

    def _episode_steps(self, skill: Tensor) -> int | Tensor:
        """Control steps until an episode is truncated under these skills (N,), of all robots or (N,).

        Grows with ``env.episode_growth``.
        """
        growth, longest = self.config.episode_growth, self.config.episode_s
        if growth.by_skill_from_s is not None and self.skill_schedule is not None:
            return self.skill_schedule.episode_steps(skill, self.sim.control_period)
        if growth.initial_s is None:
            return self._steps(longest)
        doublings = self.num_steps * self.sim.control_period / growth.doubling_s
        return self._steps(min(longest, growth.initial_s * 2.0 ** min(doublings, 64.0)))

    def _steps(self, seconds: float) -> int:
        return max(1, round(seconds / self.sim.control_period))

    def _draw_starts(self, dynamics: Dynamics | None = None) -> None:
        """The start that each robot takes if its episode ends before the next draw."""
        external = self.config.command.source == EXTERNAL
        skill = self.skill if external else None
        starts = self._pool.drawn(self.num_envs, self.difficulty, self.skill_schedule, dynamics, skill)
        if external:
            starts = replace(starts, command=self.command)
        self.sim.prepare(starts.dynamics)
        self._pool.keep(starts, self.difficulty)
        self._steps_to_draw = self._steps(STARTS_PERIOD_S)

    def _begin(self, mask: Tensor) -> None:
        """Begin an episode with the robots of ``mask`` (N,) bool."""
        starts, observed, action = self._pool.starts, self._pool.observed, self._pool.action
        self.sim.reset(mask, starts.initial, starts.joint_target)
        self.dynamics = self.dynamics.replaced(mask, starts.dynamics)
        self.step_count = self.step_count.masked_fill(mask, 0)
        self.skill = select(mask, starts.skill, self.skill)
        self.command = select(mask, starts.command, self.command)
        self.average_velocity = select(mask, starts.average_velocity, self.average_velocity)
        self.last_action = select(mask, action, self.last_action)
        self._before = Before(
            select(mask, action, self._before.action),
            select(mask, starts.initial.joint_velocity, self._before.joint_velocity),
        )
        self.motion.begin(mask, starts.amp_history)
        self.observation = select(mask, observed.observation, self.observation)
        self.privileged = select(mask, observed.privileged, self.privileged)

    def _draw_commands(self) -> None:
        """New commands and skills for the robots whose clock has come round; none where they come from outside.

        A robot changes to a skill only if its episode, as long as the skill's are, leaves it the whole period: one that
        was stopped in the middle of the change would be counted as a failure of the skill.
        """
        config = self.config.command
        if config.source == EXTERNAL:
            return
        new_command = sample_commands(self.num_envs, config, self._generator)
        period = self._steps(config.skill_period_s)
        new_skill = self._next_skills(self.step_count + period)
        command_due = self.step_count % self._steps(config.period_s) == 0
        skill_due = self.step_count % period == 0
        self.command = torch.where(command_due[:, None], new_command, self.command)
        self.skill = torch.where(skill_due, new_skill, self.skill)

    def _next_skills(self, steps: Tensor) -> Tensor:
        """(N,) skills for robots whose episodes shall last for so many control steps (N,); theirs where none can."""
        schedule = self.skill_schedule
        if schedule is None or self.config.episode_growth.by_skill_from_s is None:
            return sample_skills(self.num_envs, self.num_skills, self._generator, schedule)
        every = torch.arange(self.num_skills, device=self._device)
        possible = schedule.episode_steps(every, self.sim.control_period) >= steps[:, None]
        stays = ~possible.any(dim=1, keepdim=True) & (every == self.skill[:, None])
        return schedule.draw_among(possible | stays, self._generator)

    def _push(self) -> None:
        config = self.config.push
        if not config.enabled:
            return
        limit = self.difficulty * config.max_velocity_m_s
        change = torch.zeros(self.num_envs, 3, device=self._device)
        change[:, :2] = uniform((-limit, limit), (self.num_envs, 2), self._generator)
        due = (self.step_count + 1) % self._steps(config.period_s) == 0
        self.sim.push(change * due[:, None])

    def _case(
        self, before: dict[str, Tensor], action: Tensor, target: Tensor, reached: RobotState
    ) -> dict[str, Tensor]:
        """What a control step began with and came to, each (N, ...), for `camp.replay`."""
        return {
            **{f"before.{name}": value for name, value in before.items()},
            **{f"dynamics.{name}": value for name, value in self.dynamics.tensors().items()},
            "action": action,
            "joint_target": target,
            "command": self.command,
            "skill": self.skill,
            "step": self.step_count,
            "reached.qpos": reached.qpos(),
            "reached.qvel": reached.qvel(),
        }

    def _situation(self, measurement: Measurement) -> Situation:
        return Situation(
            self.setup,
            measurement,
            self.command,
            self.skill,
            self.last_action,
            self.average_velocity,
            self.dynamics,
            self._before,
        )


# Tensors that, with the dynamics, the simulator and the generator, make up the environment's state.
_STATE = (
    "step_count",
    "command",
    "skill",
    "last_action",
    "average_velocity",
    "observation",
    "privileged",
    "num_diverged",
)


def _box(width: int) -> gym.spaces.Box:
    return gym.spaces.Box(-np.inf, np.inf, (width,), np.float32)
