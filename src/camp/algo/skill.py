"""Skill prior: the skill discriminator z_hat = f(s_t, s_{t+1}), eqs. (5) to (8)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn import functional

from camp.algo.config import SkillConfig
from camp.algo.losses import gradient_penalty, skill_regression_loss, skill_reward
from camp.algo.models import SkillDiscriminator, SkillEmbedding
from camp.algo.normalizer import RunningNormalizer
from camp.algo.optimization import backward
from camp.algo.prior import DemonstrationSource, Discriminator, draw, in_chunks
from camp.common.averages import Averages
from camp.data import Transition


class SkillPrior(Discriminator):
    """Learns from expert motion alone which skill it shows; rewards motion that shows the commanded one.

    The target z = E(y) is read, never trained here: with a gradient on both sides eq. (7) would be least
    where all skills share one embedding.
    """

    name = "skill"

    def __init__(
        self,
        config: SkillConfig,
        embedding: SkillEmbedding,
        skills: Sequence[str],
        motion_shape: tuple[int, int],
        generator: torch.Generator,
    ) -> None:
        """embedding: shared with the style prior; its device is the prior's. motion_shape: F, S of
        `Transition`. generator (CPU): for weights."""
        self.config, self.weight, self.skills = config, config.weight, tuple(skills)
        self.embedding = embedding
        device = embedding.weight.device
        size = embedding.weight.shape[1]
        self.network = SkillDiscriminator(math.prod(motion_shape), size, config.hidden, generator).to(device)
        self.normalizer = RunningNormalizer(motion_shape[1]).to(device)
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=config.learning_rate, fused=True)

    def predict(self, transition: Transition) -> Tensor:
        """z_hat (B, Z) without gradient: the features that the analysis draws. Labels are not read."""
        return in_chunks(lambda part: self.network(self.normalizer(part.state)), transition)

    def classify(self, predicted: Tensor) -> Tensor:
        """(B, Z) -> label (B,) int64 of the embedding with the largest cosine."""
        with torch.no_grad():
            rows = functional.normalize(self.embedding.weight, dim=1)
            return (predicted.detach() @ rows.T).argmax(dim=1)

    def reward(self, transition: Transition) -> Tensor:
        """Skill reward (B,), eq. (6)."""
        with torch.no_grad():
            return skill_reward(self.predict(transition), self.embedding(transition.skill))

    def update(
        self, policy: Transition, demonstrations: DemonstrationSource, generator: torch.Generator
    ) -> dict[str, float]:
        """`updates` steps on eqs. (7) + (8); the policy's transitions are only classified, to be logged."""
        size = self.config.batch_size
        averages = Averages()
        # Once per iteration, however many steps follow.
        averages.add("prior/skill/rows_left_out", self.normalizer.update(demonstrations.sample(size, generator).state))
        for _ in range(self.config.updates):
            self._step(demonstrations.sample(size, generator), averages, generator)
        seen = draw(policy, size, generator)
        shown = self.classify(self.predict(seen)) == seen.skill
        averages.add("prior/skill/policy_accuracy", shown)
        averages.add_per_skill("prior/skill/policy_accuracy", shown, seen.skill, self.skills)
        return averages.result()

    def _step(self, expert: Transition, averages: Averages, generator: torch.Generator) -> None:
        x = self.normalizer(expert.state).requires_grad_()
        predicted = self.network(x)
        loss = skill_regression_loss(predicted, self.embedding(expert.skill))  # eq. (7), target detached
        penalty = gradient_penalty(predicted, x, generator)  # eq. (8)
        backward(loss + self.config.gradient_penalty * penalty, self.optimizer)
        self.optimizer.step()

        right = self.classify(predicted) == expert.skill
        averages.add("prior/skill/loss", loss)
        averages.add("prior/skill/gradient_penalty", penalty)
        averages.add("prior/skill/accuracy", right)
        averages.add_per_skill("prior/skill/accuracy", right, expert.skill, self.skills)
