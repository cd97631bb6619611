"""Style prior: the conditional adversarial motion prior D(s_t, s_{t+1} | z), eqs. (3) and (4)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor
from torch.nn import functional

from camp.algo.config import StyleConfig
from camp.algo.losses import gradient_penalty, lsgan_loss, style_reward
from camp.algo.models import ConditionalDiscriminator, SkillEmbedding
from camp.algo.normalizer import RunningNormalizer
from camp.algo.optimization import backward
from camp.algo.prior import DemonstrationSource, Discriminator, draw, in_chunks
from camp.algo.replay import ReplayBuffer
from camp.common.averages import Averages
from camp.common.errors import ConfigError
from camp.common.histogram import fractions
from camp.data import Transition, concatenate


class StylePrior(Discriminator):
    """Trains D and the skill embedding; rewards motion that D takes for the expert's of the commanded skill.

    Expert samples are balanced over skills, so that no gait is rare. Policy samples follow the rollout: the
    environment draws skills uniformly, and where one skill falls early its fakes are fewer only as its reward
    is.
    """

    name = "style"

    def __init__(
        self,
        config: StyleConfig,
        embedding: SkillEmbedding,
        skills: Sequence[str],
        motion_shape: tuple[int, int],
        generator: torch.Generator,
    ) -> None:
        """embedding: shared with the skill prior; its device is the prior's. motion_shape: F, S of
        `Transition`. generator (CPU): for weights."""
        if config.mismatch_fraction > 0.0 and len(skills) < 2:
            raise ConfigError(
                f"algo.style.mismatch_fraction = {config.mismatch_fraction}: set it to 0 with a single skill, "
                "which leaves no wrong label"
            )
        self.config, self.weight, self.skills = config, config.weight, tuple(skills)
        self.embedding = embedding
        device = embedding.weight.device
        condition_size = embedding.weight.shape[1] if config.conditional else 0
        network = ConditionalDiscriminator(math.prod(motion_shape), condition_size, config.hidden, generator)
        self.network = network.to(device)
        self.normalizer = RunningNormalizer(motion_shape[1]).to(device)
        # Decay on the embedding would shrink the very vectors that tell skills apart.
        groups: list[dict[str, Any]] = [
            {"params": list(self.network.trunk.parameters()), "weight_decay": config.trunk_weight_decay},
            {"params": list(self.network.head.parameters()), "weight_decay": config.head_weight_decay},
        ]
        if config.conditional:
            groups.append({"params": list(embedding.parameters()), "weight_decay": 0.0})
        self.optimizer = torch.optim.Adam(groups, lr=config.learning_rate, fused=True)
        self.replay = ReplayBuffer(config.replay_size, motion_shape, device) if config.replay_size else None

    def logit(self, transition: Transition) -> Tensor:
        """D's answer (B,) without gradient: +1 expert, -1 policy; for rewards and histograms."""
        return in_chunks(lambda part: self._logit(self.normalizer(part.state), part.skill), transition)

    def reward(self, transition: Transition) -> Tensor:
        """Style reward (B,), eq. (4)."""
        return style_reward(self.logit(transition))

    def update(
        self, policy: Transition, demonstrations: DemonstrationSource, generator: torch.Generator
    ) -> dict[str, float]:
        """`updates` steps on eq. (3); policy: all transitions of this iteration's rollout."""
        size = self.config.batch_size
        # Fed once per iteration with equal parts, however many steps follow: the statistics must not lean
        # towards either side, or the scale of the input alone would tell them apart.
        both = concatenate([demonstrations.sample(size, generator), draw(policy, size, generator)])
        averages = Averages()
        averages.add("prior/style/rows_left_out", self.normalizer.update(both.state))
        for _ in range(self.config.updates):
            expert = demonstrations.sample(size, generator)
            self._step(expert, self._fakes(policy, demonstrations, generator), averages, generator)
        if self.replay is not None:
            # As many as one iteration shows to D, so that the buffer spans many iterations.
            self.replay.add(draw(policy, size * self.config.updates, generator))
        averages.add("prior/style/embedding_similarity", self._embedding_similarity())
        return averages.result()

    def histograms(
        self, policy: Transition, demonstrations: DemonstrationSource, generator: torch.Generator
    ) -> dict[str, list[float]]:
        """How D's logits of a fresh expert batch and of all policy transitions are spread (`camp.common.histogram`)."""
        expert = demonstrations.sample(self.config.batch_size, generator)
        return {
            "prior/style/logit_histogram/expert": fractions(self.logit(expert)),
            "prior/style/logit_histogram/policy": fractions(self.logit(policy)),
        }

    def _step(self, expert: Transition, fake: Transition, averages: Averages, generator: torch.Generator) -> None:
        expert_input = self._noisy_input(expert, generator).requires_grad_()
        expert_logit = self._logit(expert_input, expert.skill)
        fake_logit = self._logit(self._noisy_input(fake, generator), fake.skill)
        loss = lsgan_loss(expert_logit, fake_logit)  # eq. (3)
        # In standardized units: raw ones (rad/s, m) differ by orders of magnitude.
        penalty = gradient_penalty(expert_logit, expert_input)
        backward(loss + self.config.gradient_penalty * penalty, self.optimizer)
        self.optimizer.step()

        right = torch.cat([expert_logit > 0.0, fake_logit < 0.0])
        averages.add("prior/style/loss", loss)
        averages.add("prior/style/gradient_penalty", penalty)
        averages.add("prior/style/expert_logit", expert_logit)
        averages.add("prior/style/policy_logit", fake_logit)
        averages.add("prior/style/accuracy", right)
        labels = torch.cat([expert.skill, fake.skill])
        averages.add_per_skill("prior/style/accuracy", right, labels, self.skills)

    def _fakes(self, policy: Transition, demonstrations: DemonstrationSource, generator: torch.Generator) -> Transition:
        """What D shall reject: the policy's motion, and a fraction of expert motion with a wrong label.

        Half of the policy's motion is from the past once there is any. The wrong labels (matching-aware
        negatives, Reed et al. 2016) are betrayed by nothing but z, so D has to listen to it.
        """
        size = self.config.batch_size
        wrong = round(size * self.config.mismatch_fraction)
        past = (size - wrong) // 2 if self.replay is not None and len(self.replay) > 0 else 0
        parts = [draw(policy, size - wrong - past, generator)]
        if self.replay is not None and past:
            parts.append(self.replay.sample(past, generator))
        if wrong:
            parts.append(self._mislabelled(demonstrations.sample(wrong, generator), generator))
        return concatenate(parts)

    def _mislabelled(self, expert: Transition, generator: torch.Generator) -> Transition:
        shape, num_skills = expert.skill.shape, len(self.skills)
        offset = torch.randint(1, num_skills, shape, generator=generator, device=generator.device)
        return Transition(expert.state, (expert.skill + offset) % num_skills)

    def _noisy_input(self, transition: Transition, generator: torch.Generator) -> Tensor:
        x = self.normalizer(transition.state)
        if self.config.input_noise == 0.0:
            return x
        return x + self.config.input_noise * torch.randn(x.shape, generator=generator, device=x.device)

    def _logit(self, x: Tensor, skill: Tensor) -> Tensor:
        return self.network(x, self.embedding(skill) if self.config.conditional else None)

    @torch.no_grad()
    def _embedding_similarity(self) -> Tensor:
        """Largest cosine between two skills' embeddings: 0 at the start, towards 1 where skills merge."""
        rows = functional.normalize(self.embedding.weight, dim=1)
        cosine = rows @ rows.T
        others = cosine[~torch.eye(len(rows), dtype=torch.bool, device=cosine.device)]
        return others.max() if len(others) else cosine.new_zeros(())

    def memory(self) -> dict[str, Any]:
        return {} if self.replay is None else {"replay": self.replay.state_dict()}

    def load_memory(self, state: dict[str, Any]) -> None:
        if self.replay is not None:
            self.replay.load_state_dict(state["replay"])
