"""One robot with Gymnasium's single-environment interface: ``gymnasium.make("camp/Go2-v0")``."""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium as gym
import numpy as np

from camp.build import build_env, expert_clips
from camp.config.compose import compose_config
from camp.envs.actions import as_action
from camp.envs.spaces import useful_actions
from camp.robots.quadruped import NUM_JOINTS
from camp.sim.rendering import RobotRenderer


class Go2Env(gym.Env):
    """The batched environment with N = 1, in numpy; an ended episode waits for ``reset``.

    The reward is the weighted task reward of Table II; ``info`` holds the critic's ``privileged`` observation, the
    ``skill`` label, the ``command``, the AMP ``transition`` (F, S) of the step and whether the robot ``diverged``.

    Args:
        render_mode: None or "rgb_array".
        overrides: of conf/train.yaml, such as ``["env.episode_s=5", "motion.skills=[trot]"]``.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 50}

    def __init__(self, render_mode: str | None = None, overrides: tuple[str, ...] | list[str] = ()):
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode {render_mode!r}: choose None or 'rgb_array'")
        self.render_mode = render_mode
        config = compose_config(["sim=cpu", "sim.threads=1", *overrides])
        self.batched = build_env(config, expert_clips(config), num_envs=1)
        self.observation_space = self.batched.single_observation_space
        self.action_space = useful_actions(self.batched.robot, config.robot.action_scale)
        self._renderer: RobotRenderer | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        super().reset(seed=seed)
        observation, info = self.batched.reset(seed=seed, options={"stagger": False})
        return observation[0].numpy(force=True), {"privileged": info["privileged"][0].numpy(force=True)}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Gymnasium's step with the network's outputs (12,).

        An absurd action, and a state that is physically impossible, terminate the episode without reward, and
        ``info["diverged"]`` says so. Raises ValueError, before anything changes, for an action of another type or
        shape, or one that is not finite.
        """
        wanted = as_action(action, (NUM_JOINTS,), self.batched.sim.device)
        if not wanted.isfinite().all():
            raise ValueError(f"action {action!r}: give finite numbers")
        result = self.batched.advance(wanted[None])
        info = {
            "diverged": bool(result.diverged[0]),
            "privileged": result.final_privileged[0].numpy(force=True),
            "transition": result.transition[0].numpy(force=True),
            "command": result.command[0].numpy(force=True),
            "skill": int(result.skill[0]),
        }
        observation = result.final_observation[0].numpy(force=True)
        return (
            observation,
            float(result.task_reward[0]),
            bool(result.terminated[0]),
            bool(result.truncated[0]),
            info,
        )

    def render(self) -> np.ndarray | None:
        if self.render_mode is None:
            return None
        if self._renderer is None:
            self._renderer = RobotRenderer(self.batched.robot.load_model())
        return self._renderer.frame(self.batched.sim.state.qpos()[0].numpy(force=True))

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
        self.batched.close()
