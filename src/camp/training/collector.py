"""Collecting rollouts: the policy acts in the environment, everything the update needs is kept."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from camp.algo.ppo import PPO
from camp.common.averages import Averages
from camp.common.tensors import copied
from camp.data import Decision, Rollout, Step
from camp.envs.quadruped import QuadrupedEnv
from camp.metrics.tracking import FAST_COMMAND_M_S
from camp.training.gait_monitor import GaitMonitor
from camp.training.patience import Patience


class Collector:
    """Steps the environment with the policy; the environment lives on its simulator's device, the rollout on
    the learner's. patience: ends episodes in which the commanded skill is not shown."""

    def __init__(
        self,
        env: QuadrupedEnv,
        ppo: PPO,
        monitor: GaitMonitor,
        device: torch.device,
        patience: Patience | None = None,
    ):
        self.env, self.ppo, self.monitor, self.device = env, ppo, monitor, device
        self.patience = patience
        self._given_up: Tensor | None = None  # (N,) bool, by the last step

    def collect(self, steps: int, generator: torch.Generator) -> tuple[Rollout, dict[str, float]]:
        """``steps`` control steps of every robot; also metrics of what happened. Waits for the device at the end only.

        The successor's value is the critic's of the observation BEFORE a reset, so that a time-out is bootstrapped
        with the state it cut off.
        """
        observations, privileged = [], []
        decisions: list[Decision] = []
        results: list[Step] = []
        averages = Averages()
        for _ in range(steps):
            observation, hidden = self._here(self.env.observation), self._here(self.env.privileged)
            decision = self.ppo.act(observation, hidden, generator)
            result = self.env.advance(decision.action.to(self.env.sim.device), self._given_up)
            self.monitor.add(result)
            if self.patience is not None:
                self._given_up = self.patience.exhausted(result).to(self.env.sim.device)
                averages.add("env/given_up_per_1000_steps", 1000.0 * self._given_up)
            _record(result, averages)
            observations.append(observation)
            privileged.append(hidden)
            decisions.append(decision)
            results.append(result)
        value = torch.stack([decision.value for decision in decisions])

        def stacked(name: str) -> Tensor:
            return self._here(torch.stack([getattr(result, name) for result in results]))

        rollout = Rollout(
            observation=torch.stack(observations),
            privileged=torch.stack(privileged),
            action=torch.stack([decision.action for decision in decisions]),
            log_prob=torch.stack([decision.log_prob for decision in decisions]),
            action_mean=torch.stack([decision.mean for decision in decisions]),
            action_std=torch.stack([decision.std for decision in decisions]),
            value=value,
            next_value=self._next_value(value, results),
            task_reward=stacked("task_reward"),
            terminated=stacked("terminated"),
            truncated=stacked("truncated"),
            transition=stacked("transition"),
            skill=stacked("skill"),
        )
        self.env.sim.verify()
        return rollout, averages.result() | {"env/diverged": float(self.env.num_diverged)}

    def state_dict(self) -> dict[str, Any]:
        if self.patience is None:
            return {}
        return {"patience": self.patience.state_dict(), "given_up": self._given_up}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        if self.patience is None:
            return
        self.patience.load_state_dict(state["patience"])
        given_up = state["given_up"]
        self._given_up = None if given_up is None else copied(given_up, self.env.sim.device)

    def _next_value(self, value: Tensor, results: list[Step]) -> Tensor:
        """(T, N) value of each step's successor before any reset."""
        last = self.ppo.value(self._here(self.env.observation), self._here(self.env.privileged))
        next_value = torch.cat([value[1:], last[None]])
        truncated = torch.stack([result.truncated for result in results])
        if truncated.any():
            observation = torch.stack([result.final_observation for result in results])[truncated]
            hidden = torch.stack([result.final_privileged for result in results])[truncated]
            final = self.ppo.value(self._here(observation), self._here(hidden))
            next_value[self._here(truncated)] = final
        return next_value

    def _here(self, tensor: Tensor) -> Tensor:
        return tensor.to(self.device, non_blocking=True)


def _record(step: Step, averages: Averages) -> None:
    for name, term in step.reward.items():
        averages.add(f"reward/{name}/raw", term)
    error = step.command - step.velocity
    linear = error[:, :2].norm(dim=1)
    fast = step.command[:, :2].norm(dim=1) >= FAST_COMMAND_M_S
    averages.add("tracking/linear_error", linear)
    averages.add("tracking/linear_error_fast", linear, where=fast)
    averages.add("tracking/yaw_rate_error", error[:, 2].abs())
    averages.add("env/falls_per_1000_steps", 1000.0 * step.terminated)
    averages.add("env/diverged_per_1000_steps", 1000.0 * step.diverged)
    averages.add("env/feet_in_contact", step.foot_contact.float().sum(1))
