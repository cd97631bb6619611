"""The batched locomotion environment: N robots, each with a velocity command and a skill."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.vector import AutoresetMode, VectorEnv
from torch import Tensor

from camp.algo.losses import mix_rewards
from camp.data import Step
from camp.envs import initialization, observations
from camp.envs.commands import sample_commands, sample_skills, uniform
from camp.envs.config import EnvConfig
from camp.envs.measurement import AMP_STATE_SIZE, Measurement, measure
from camp.envs.randomization import sample_dynamics
from camp.envs.rewards import angular_velocity_reward, linear_velocity_reward
from camp.envs.terminations import failed
from camp.motion.sampler import ReferenceStates
from camp.robots import go2
from camp.sim.base import Dynamics, Simulator

# The observation's bound for values that a diverging simulation produces; far beyond anything physical.
_OBSERVATION_LIMIT = 1e3


class QuadrupedEnv(VectorEnv):
    """N robots in torch; ended episodes restart within the same step (``AutoresetMode.SAME_STEP``).

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
        self.config = config
        self.action_scale = action_scale
        self.references = references
        self.num_envs = sim.num_envs
        self.num_skills = references.num_skills
        self.actor_entries = observations.actor_entries(self.num_skills)
        self.privileged_entries = observations.privileged_entries()
        self.metadata = {"autoreset_mode": AutoresetMode.SAME_STEP}
        self.single_observation_space = _box(observations.size(self.actor_entries))
        self.single_action_space = _box(go2.NUM_JOINTS)
        self.observation_space = gym.vector.utils.batch_space(self.single_observation_space, self.num_envs)
        self.action_space = gym.vector.utils.batch_space(self.single_action_space, self.num_envs)

        self._generator = generator
        self._device = sim.device
        self.default_pose = torch.tensor(go2.DEFAULT_JOINT_POSITION, device=self._device)
        self._noise = observations.noise_width(self.actor_entries, config.noise).to(self._device)
        self._episode_steps = self._steps(config.episode_s)
        num, device = self.num_envs, self._device
        self.step_count = torch.zeros(num, dtype=torch.int64, device=device)  # control steps into the episode
        self.command = torch.zeros(num, 3, device=device)  # vx, vy in m/s, yaw rate in rad/s
        self.skill = torch.zeros(num, dtype=torch.int64, device=device)
        self.last_action = torch.zeros(num, go2.NUM_JOINTS, device=device)
        self.dynamics = Dynamics.nominal(num, config.randomization.nominal_friction, device)
        self.amp_state = torch.zeros(num, AMP_STATE_SIZE, device=device)
        self.num_diverged = 0  # simulations that ended in a non-finite state since construction
        self.observation = torch.zeros(num, observations.size(self.actor_entries), device=device)
        self.privileged = torch.zeros(num, observations.size(self.privileged_entries), device=device)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Tensor, dict[str, Any]]:
        """Restart every robot.

        Episodes begin at random times within their length, so that they do not all end together;
        ``options={"stagger": False}`` begins them all at 0.
        """
        if seed is not None:
            self._generator.manual_seed(seed)
        everyone = torch.arange(self.num_envs, device=self._device)
        measurement = self._restart(everyone)
        if options is None or options.get("stagger", True):
            self.step_count = torch.randint(
                self._episode_steps, (self.num_envs,), generator=self._generator, device=self._device
            )
        self.observation, self.privileged = self._observe(measurement)
        return self.observation, {"privileged": self.privileged}

    def step(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, dict[str, Any]]:
        """Gymnasium's form of ``advance``: the reward is the weighted task reward, the ``Step`` is in the info."""
        result = self.advance(torch.as_tensor(actions, device=self._device, dtype=torch.float32))
        info = {"step": result, "privileged": result.privileged, "final_obs": result.final_observation}
        return result.observation, result.task_reward, result.terminated, result.truncated, info

    def advance(self, action: Tensor) -> Step:
        """One control step with the network's outputs (N, 12): target = default pose + k action."""
        self.last_action = action
        self._push()
        self.sim.step(self.default_pose + self.action_scale * action)
        self.step_count = self.step_count + 1

        measurement = measure(self.sim.state)
        diverged = self.sim.diverged()
        self.num_diverged += int(diverged.sum())
        # A robot whose simulation diverged has no successor state; a pair that stands still keeps it finite.
        successor = torch.where(diverged[:, None], self.amp_state, measurement.amp_state())
        transition = torch.stack([self.amp_state, successor], dim=1)
        self.amp_state = successor
        reward = self._task_reward(measurement)
        terminated = failed(measurement, diverged, self.config.termination)
        truncated = (self.step_count >= self._episode_steps) & ~terminated
        command, skill = self.command, self.skill

        self._draw_commands()
        final_observation, final_privileged = self._observe(measurement)
        self.observation, self.privileged = final_observation, final_privileged
        ended = (terminated | truncated).nonzero().squeeze(1)
        if len(ended) > 0:
            self.observation, self.privileged = final_observation.clone(), final_privileged.clone()
            self.observation[ended], self.privileged[ended] = self._observe(self._restart(ended), ended)
        weights = self.config.reward.weights()
        return Step(
            observation=self.observation,
            privileged=self.privileged,
            final_observation=final_observation,
            final_privileged=final_privileged,
            reward=reward,
            task_reward=mix_rewards(reward, weights),
            terminated=terminated,
            truncated=truncated,
            transition=transition,
            skill=skill,
            command=command,
            velocity=torch.cat(
                [measurement.linear_velocity[:, :2], measurement.angular_velocity[:, 2:]], dim=1
            ).nan_to_num(0.0),
            foot_contact=measurement.foot_contact,
        )

    def set_command(self, command: Tensor, skill: Tensor) -> Tensor:
        """Command every robot from now until the clock draws anew: (N, 3) and (N,); returns the observation."""
        self.command, self.skill = command.clone(), skill.clone()
        self.observation, self.privileged = self._observe(measure(self.sim.state))
        return self.observation

    def state_dict(self) -> dict[str, Any]:
        """Everything a bit-for-bit continuation needs, the simulator and the random state included."""
        state: dict[str, Any] = {name: getattr(self, name) for name in _STATE}
        state["dynamics"] = self.dynamics.tensors()
        state["generator"] = self._generator.get_state()
        state["num_diverged"] = self.num_diverged
        state["sim"] = self.sim.state_dict()
        return state

    def load_state_dict(self, state: dict[str, Any]) -> None:
        for name in _STATE:
            setattr(self, name, state[name].clone())
        self.dynamics = Dynamics(**state["dynamics"])
        self._generator.set_state(state["generator"])
        self.num_diverged = state["num_diverged"]
        self.sim.set_dynamics(torch.arange(self.num_envs, device=self._device), self.dynamics)
        self.sim.load_state_dict(state["sim"])

    def close(self, **kwargs: Any) -> None:
        self.sim.close()

    def _steps(self, seconds: float) -> int:
        return max(1, round(seconds / self.sim.control_period))

    def _restart(self, env_ids: Tensor) -> Measurement:
        """New dynamics, skill and initial state for the robots ``env_ids`` (n,); their measurement afterwards."""
        num, init = len(env_ids), self.config.initialization
        dynamics = sample_dynamics(num, self.config.randomization, self._generator)
        self.dynamics.assign(env_ids, dynamics)
        self.sim.set_dynamics(env_ids, dynamics)

        skill = sample_skills(num, self.num_skills, self._generator)
        reference = self.references.sample(skill, self._generator)
        at_reference = uniform((0.0, 1.0), (num,), self._generator) < init.reference_share
        start = initialization.merge(
            at_reference,
            initialization.from_reference(reference),
            initialization.standing(num, init, self._generator),
        )
        self.sim.reset(env_ids, start)

        command = sample_commands(num, self.config.command, self._generator)
        previous_action = (reference.joint_target_applied_previous - self.default_pose) / self.action_scale
        self.skill[env_ids] = skill
        # A robot set into a clip goes on with the clip's command, and remembers the clip's last action.
        self.command[env_ids] = torch.where(at_reference[:, None], reference.command, command)
        self.last_action = self.last_action.clone()
        self.last_action[env_ids] = previous_action * at_reference[:, None]
        self.step_count[env_ids] = 0
        self.amp_state = self.amp_state.clone()
        measurement = measure(self.sim.state.take(env_ids))
        self.amp_state[env_ids] = measurement.amp_state()
        return measurement

    def _draw_commands(self) -> None:
        """New commands and skills for the robots whose clock has come round."""
        config = self.config.command
        new_command = sample_commands(self.num_envs, config, self._generator)
        new_skill = sample_skills(self.num_envs, self.num_skills, self._generator)
        command_due = self.step_count % self._steps(config.period_s) == 0
        skill_due = self.step_count % self._steps(config.skill_period_s) == 0
        self.command = torch.where(command_due[:, None], new_command, self.command)
        self.skill = torch.where(skill_due, new_skill, self.skill)

    def _push(self) -> None:
        config = self.config.push
        if not config.enabled:
            return
        limit = config.max_velocity_m_s
        change = torch.zeros(self.num_envs, 3, device=self._device)
        change[:, :2] = uniform((-limit, limit), (self.num_envs, 2), self._generator)
        due = (self.step_count + 1) % self._steps(config.period_s) == 0
        self.sim.push(change * due[:, None])

    def _task_reward(self, measurement: Measurement) -> dict[str, Tensor]:
        """Table II's task terms, unweighted; 0 where the simulation diverged."""
        width = self.config.reward
        terms = {
            "linear_velocity": linear_velocity_reward(
                self.command, measurement.linear_velocity, width.linear_velocity_width
            ),
            "angular_velocity": angular_velocity_reward(
                self.command, measurement.angular_velocity, width.angular_velocity_width
            ),
        }
        return {name: term.nan_to_num(0.0) for name, term in terms.items()}

    def _observe(self, measurement: Measurement, env_ids: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """The policy's observation with sensor noise, and the critic's privileged part without.

        ``measurement`` is of the robots ``env_ids``, None for all.
        """
        rows = slice(None) if env_ids is None else env_ids
        skill = torch.nn.functional.one_hot(self.skill[rows], self.num_skills).float() * self.config.observe_skill
        situation = observations.Situation(
            measurement, self.command[rows], self.last_action[rows], skill, self.dynamics.take(rows)
        )
        observation = observations.observe(self.actor_entries, situation)
        if self.config.noise.enabled:
            observation += self._noise * uniform((-1.0, 1.0), tuple(observation.shape), self._generator)
        privileged = observations.observe(self.privileged_entries, situation)
        return _bounded(observation), _bounded(privileged)


# Tensors that, with the dynamics, the simulator and the generator, make up the environment's state.
_STATE = ("step_count", "command", "skill", "last_action", "amp_state", "observation", "privileged")


def _box(width: int) -> gym.spaces.Box:
    return gym.spaces.Box(-np.inf, np.inf, (width,), np.float32)


def _bounded(value: Tensor) -> Tensor:
    return value.nan_to_num(0.0).clamp_(-_OBSERVATION_LIMIT, _OBSERVATION_LIMIT)
