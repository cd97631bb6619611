"""Which skills are practised how: short episodes and more of them where a skill is not shown yet."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from camp.algo.skill import SkillPrior
from camp.build import Training
from camp.common import distributed
from camp.common.tensors import copied
from camp.config.schema import Config
from camp.data import Rollout, Transition
from camp.envs.skill_schedule import SkillSchedule
from camp.gaits.skills import names

MEMORY = 0.9  # of one iteration's counts, what the next one keeps
SHRINKING = 4.0  # times as fast as growing: a skill that is lost goes back to short episodes soon
BALANCING = 0.2  # of the way, in logarithms, that a skill's weight goes in one iteration towards its share of time
LEAST_WEIGHT = 0.02  # of all draws, so that no skill is forgotten


class SkillCurriculum:
    """Sets the environment's `SkillSchedule` from what robots show when their time under a skill is up.

    A stretch ends by a time-out, a fall or a new skill; it has succeeded where its last motion is taken for the
    commanded skill's by the skill discriminator. All skills' episodes grow alike until they last
    ``env.episode_growth.by_skill_from_s``; from then on a skill's grow while its stretches succeed and shrink while
    they do not. Short episodes make a skill rare, so it is drawn the more often, until time is shared equally, or by
    failure as far as ``env.command.skill_focus`` says.
    """

    def __init__(self, prior: SkillPrior, training: Training, config: Config):
        self._prior, self._env = prior, training.env
        self._growth, self._focus = config.env.episode_growth, config.env.command.skill_focus
        self._names, self._longest_s = names(config.motion.skill_set()), config.env.episode_s
        self._doublings = config.run.rollout_steps * config.env.control_period_s / self._growth.doubling_s
        num, device = len(self._names), prior.embedding.weight.device
        self._ended = torch.zeros(num, device=device)  # stretches, the last iterations' mostly
        self._shown = torch.zeros(num, device=device)  # of them, those that succeeded
        self._apart = False  # whether each skill's success decides about its episodes
        begin = self._growth.initial_s or self._longest_s
        self._env.skill_schedule = SkillSchedule.uniform(num, begin, self._env.sim.device)

    def update(self, rollout: Rollout) -> dict[str, float]:
        """Take in an iteration's rollout; returns metrics."""
        schedule = self._env.skill_schedule
        assert schedule is not None
        ended, shown = self._count(rollout)
        self._ended = MEMORY * self._ended + distributed.total(ended)
        self._shown = MEMORY * self._shown + distributed.total(shown)
        success = self._shown / self._ended.clamp(min=1.0)
        columns = {"success": success}
        if self._growth.by_skill_from_s is not None:  # else the environment lets them grow by itself
            schedule.episode_s = self._grown(schedule.episode_s, success.to(schedule.episode_s.device))
            columns["episode_s"] = schedule.episode_s
        share = distributed.total(rollout.skill.flatten().bincount(minlength=len(success)).float())
        share = share / share.sum()
        if self._focus is not None:
            wanted = _shares(success, self._focus).to(schedule.weight.device)
            schedule.weight = _balanced(schedule.weight, wanted, share.to(schedule.weight.device))
        columns["time_fraction"] = share
        return {
            f"curriculum/{column}/{name}": value
            for column, values in columns.items()
            for name, value in zip(self._names, values.tolist(), strict=True)
        }

    def _count(self, rollout: Rollout) -> tuple[Tensor, Tensor]:
        """(K,) stretches that ended, and those among them that succeeded."""
        over = rollout.terminated | rollout.truncated
        over[:-1] |= rollout.skill[1:] != rollout.skill[:-1]
        skill = rollout.skill[over]
        shown = self._prior.classify(self._prior.predict(Transition(rollout.transition[over], skill))) == skill
        shown &= ~rollout.terminated[over]
        num = len(self._names)
        return skill.bincount(minlength=num).float(), skill[shown].bincount(minlength=num).float()

    def _grown(self, episode_s: Tensor, success: Tensor) -> Tensor:
        shortest, from_s = self._growth.initial_s, self._growth.by_skill_from_s
        assert shortest is not None and from_s is not None  # as the configuration's check has seen to
        self._apart = self._apart or bool(episode_s.max() >= from_s)
        up = (success >= self._growth.success_up).float() if self._apart else torch.ones_like(success)
        down = (success < self._growth.success_down).float() if self._apart else torch.zeros_like(success)
        factor = torch.exp2(self._doublings * (up - SHRINKING * down))
        return (episode_s * factor).clamp(shortest, self._longest_s)

    def state_dict(self) -> dict[str, Any]:
        return {"ended": self._ended, "shown": self._shown, "apart": self._apart}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._ended, self._shown = (copied(state[name], self._ended.device) for name in ("ended", "shown"))
        self._apart = state["apart"]


def build_skill_curriculum(training: Training, config: Config) -> SkillCurriculum | None:
    """None where all skills are practised alike."""
    if config.env.episode_growth.by_skill_from_s is None and config.env.command.skill_focus is None:
        return None
    prior = next(prior for prior in training.priors if isinstance(prior, SkillPrior))
    return SkillCurriculum(prior, training, config)


def _shares(success: Tensor, focus: float) -> Tensor:
    """(K,) shares of time: equal for focus 0, in proportion to failure for focus 1."""
    failure = (1.0 - success).clamp(min=0.01)
    return (1.0 - focus) / len(success) + focus * failure / failure.sum()


def _balanced(weight: Tensor, wanted: Tensor, share: Tensor) -> Tensor:
    """Weights (K,) of the next draws, a step nearer to those that give the wanted shares of time; their mean is 1."""
    ratio = (wanted / share.clamp(min=1e-3)).clamp(0.25, 4.0)
    moved = weight * ratio.pow(BALANCING)
    moved = moved / moved.sum()
    moved = moved.clamp(min=LEAST_WEIGHT / len(moved))
    return moved / moved.mean()
