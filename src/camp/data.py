"""The batches that environment, algorithm and demonstrations exchange, with the shape of every tensor.

Letters: N environments, T time steps, B batch, F states judged together (2 in the paper), S AMP state (43, or 47 with
env.foot_stance), O observation (45 + K, times env.observation.history), X privileged observation, A actions (12), K
skills. Units are SI unless a field says otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor

# Bound on every number that a network observes, far beyond anything physical.
OBSERVATION_LIMIT = 1e3


@dataclass
class Transition:
    """AMP states of one motion, oldest first, and the skill they belong to: what priors judge.

    In the paper two consecutive ones (s_t, s_{t+1}); in general those that are ``env.transition_ages`` old.
    """

    state: Tensor  # (B, F, S) raw SI units
    skill: Tensor  # (B,) int64 label

    def __len__(self) -> int:
        return self.skill.shape[0]

    def take(self, index: Tensor | slice) -> Transition:
        """The transitions at `index` (int64 or bool (M,), or a slice)."""
        return Transition(self.state[index], self.skill[index])

    def to(self, device: torch.device | str) -> Transition:
        return Transition(self.state.to(device), self.skill.to(device))


def concatenate(parts: list[Transition]) -> Transition:
    """All transitions of `parts` in order."""
    return Transition(torch.cat([p.state for p in parts]), torch.cat([p.skill for p in parts]))


@dataclass
class Step:
    """One control step of N environments; `final_*` and `transition` are taken BEFORE any reset."""

    observation: Tensor  # (N, O) after reset where an episode ended
    privileged: Tensor  # (N, X) same moment as `observation`
    final_observation: Tensor  # (N, O) before reset; equals `observation` where nothing ended
    final_privileged: Tensor  # (N, X) before reset
    reward: dict[str, Tensor]  # task terms, unweighted, each (N,)
    task_reward: Tensor  # (N,) weighted sum of the task terms (Table II)
    terminated: Tensor  # (N,) bool: the task failed, no future to bootstrap from
    truncated: Tensor  # (N,) bool: a time-out, the future exists but is not simulated
    diverged: Tensor  # (N,) bool: terminated because the simulation or the action was physically impossible
    transition: Tensor  # (N, F, S) the last one at the step's end
    skill: Tensor  # (N,) int64 skill commanded during this step
    command: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s, commanded during this step
    velocity: Tensor  # (N, 3) vx, vy in m/s, yaw rate in rad/s, base frame, reached at its end
    foot_contact: Tensor  # (N, 4) bool at its end

    def motion(self) -> Transition:
        """What the robots did and should have done, as the priors judge it."""
        return Transition(self.transition, self.skill)


class Decision(NamedTuple):
    """What the policy and the critic say about N observations (unpacks as a tuple)."""

    action: Tensor  # (N, A) sampled
    log_prob: Tensor  # (N,)
    mean: Tensor  # (N, A)
    std: Tensor  # (N, A)
    value: Tensor  # (N,)


@dataclass
class Rollout:
    """T steps of N environments, time first."""

    observation: Tensor  # (T, N, O) what the action was chosen on
    privileged: Tensor  # (T, N, X)
    action: Tensor  # (T, N, A)
    log_prob: Tensor  # (T, N) under the collecting policy
    action_mean: Tensor  # (T, N, A) of the collecting policy
    action_std: Tensor  # (T, N, A) of the collecting policy
    value: Tensor  # (T, N) critic on `observation`, `privileged`
    next_value: Tensor  # (T, N) critic on the successor before reset (the final observation at an end)
    task_reward: Tensor  # (T, N)
    terminated: Tensor  # (T, N) bool
    truncated: Tensor  # (T, N) bool
    transition: Tensor  # (T, N, F, S)
    skill: Tensor  # (T, N) int64

    def transitions(self) -> Transition:
        """All T * N transitions as one batch (views, no copy for contiguous storage)."""
        return Transition(self.transition.flatten(0, 1), self.skill.flatten())
