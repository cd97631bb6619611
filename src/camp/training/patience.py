"""Robots that no longer show their skill start anew, so that no skill is lost while episodes grow long."""

from __future__ import annotations

import math
from typing import Any

import torch
from torch import Tensor

from camp.algo.skill import SkillPrior
from camp.build import Training
from camp.common.tensors import copied
from camp.config.schema import Config
from camp.data import Step


class Patience:
    """Notices robots that the skill discriminator has long not taken for the commanded skill.

    A robot that pronks where it should trot never falls, so it would never see a trot again. Its episode ends as a
    time-out instead, and another one begins, most likely in the expert's states.

    Args:
        prior: the skill discriminator, as it is at each step.
        patience_s: s of motion of another skill after which a robot is given up.
        num_envs: N.
        period_s: control period in s.
    """

    def __init__(self, prior: SkillPrior, patience_s: float, num_envs: int, period_s: float):
        self._prior, self._rate = prior, min(1.0, period_s / patience_s)
        device = prior.embedding.weight.device
        self._least = math.exp(-1.0)  # what is left of a share of 1 after patience_s without success
        self._share = torch.ones(num_envs, device=device)  # of the last patience_s in which the skill was shown
        self._skill = torch.full((num_envs,), -1, dtype=torch.int64, device=device)

    def exhausted(self, step: Step) -> Tensor:
        """(N,) bool, on the prior's device: whose episode shall end with the next step. Takes in one control step."""
        motion = step.motion().to(self._share.device)
        shown = self._prior.classify(self._prior.predict(motion)) == motion.skill
        ended = (step.terminated | step.truncated).to(self._share.device)
        before = self._share.masked_fill(motion.skill != self._skill, 1.0)  # a new skill may take its time
        share = before + self._rate * (shown.to(before.dtype) - before)
        self._share, self._skill = share.masked_fill(ended, 1.0), motion.skill.masked_fill(ended, -1)
        return self._share < self._least

    def state_dict(self) -> dict[str, Any]:
        return {"share": self._share, "skill": self._skill}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._share, self._skill = (copied(state[name], self._share.device) for name in ("share", "skill"))


def build_patience(training: Training, config: Config) -> Patience | None:
    """What ends episodes in which the commanded skill is not shown; None where nothing shall."""
    seconds = config.algo.skill.patience_s
    prior = next((prior for prior in training.priors if isinstance(prior, SkillPrior)), None)
    if seconds is None or prior is None:
        return None
    return Patience(prior, seconds, training.env.num_envs, training.env.sim.control_period)
