"""Schema of conf/algo: types, units, ranges.

Values live in the YAML; `check` says which key is wrong and what to do.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from omegaconf import MISSING

from camp.common import checks
from camp.common.bounds import Fraction, Seconds, Weight, Within

MINIBATCH, ITERATION = ADAPT_EACH = ("minibatch", "iteration")
PRECISIONS = ("float32", "bfloat16", "tf32")

Units = Annotated[int, Within(1, 16384, "units of a layer; two such layers take 4 GiB with Adam's moments")]
Std = Annotated[float, Within(1e-6, 100.0, "action units; from no exploration to 25 rad")]
Clip = Annotated[float, Within(1e-6, 10.0, "of order 0.01 to 1 in use")]
ValueClip = Annotated[float, Within(0.0, 1e6, "standard deviations of the return; so many clip nothing")]
Passes = Annotated[int, Within(1, 1000, "passes over one rollout")]
Parts = Annotated[int, Within(1, 100_000, "minibatches; each needs a sample")]
Rate = Annotated[float, Within(1e-10, 1.0, "Adam moves every weight by about this much in a step")]
GradientNorm = Annotated[float, Within(1e-6, 1e6, "of order 1 in use")]
Updates = Annotated[int, Within(1, 10_000, "gradient steps of one iteration")]
Batch = Annotated[int, Within(1, 2**22, "transitions or pairs; four million fill a GPU")]
Memory = Annotated[int, Within(0, 10**8, "transitions; the largest takes 34 GiB")]
Noise = Annotated[float, Within(0.0, 100.0, "standard deviations of what is noised")]
PartialFraction = Annotated[float, Within(0.0, 0.99, "a fraction that leaves some policy transitions")]
Epochs = Annotated[int, Within(0, 1_000_000, "passes over the pairs")]
Embedding = Annotated[int, Within(1, 4096, "dimensions; at least one for each skill")]


@dataclass
class ActorConfig:
    """Policy network and exploration."""

    hidden: list[Units] = MISSING  # units per hidden layer
    initial_std: Std = MISSING  # action units, within [min_std, max_std]
    min_std: Std = MISSING  # action units, floor of the exploration std
    max_std: Std = MISSING  # action units, ceiling
    learn_std: bool = MISSING  # false: the std stays at initial_std

    def check(self) -> None:
        checks.layers("algo.actor.hidden", self.hidden)
        checks.require(
            self.min_std <= self.initial_std <= self.max_std,
            "algo.actor.initial_std",
            self.initial_std,
            f"choose a value within algo.actor.min_std .. max_std ({self.min_std} .. {self.max_std})",
        )


@dataclass
class CriticConfig:
    """Value network."""

    hidden: list[Units] = MISSING  # units per hidden layer

    def check(self) -> None:
        checks.layers("algo.critic.hidden", self.hidden)


@dataclass
class PPOConfig:
    """Proximal policy optimization."""

    gamma: Fraction = MISSING  # discount per control step, [0, 1]
    gae_lambda: Fraction = MISSING  # lambda of GAE, [0, 1]
    clip_param: Clip = MISSING  # probability ratio kept within 1 +- clip, > 0
    value_clip_param: ValueClip = MISSING  # value moves per update, in standard deviations of the return; 0 = unclipped
    entropy_coef: Weight = MISSING  # weight of the entropy bonus, >= 0
    epochs: Passes = MISSING  # passes over the rollout per iteration
    minibatches: Parts = MISSING  # per epoch, permuted anew each epoch
    learning_rate: Rate = MISSING  # actor, start of the adaptive rule, within [min, max]
    min_learning_rate: Rate = MISSING  # actor, floor of the adaptive rule
    max_learning_rate: Rate = MISSING  # actor, ceiling of the adaptive rule
    adaptive: bool = MISSING  # steer the actor's rate so that the KL per iteration stays near desired_kl
    adapt_each: str = MINIBATCH  # of ADAPT_EACH: by each minibatch's KL, or once by the mean of the last epoch's
    desired_kl: Clip = MISSING  # nats, > 0
    # Over the last `settle_fraction` of the iterations the desired KL falls geometrically from desired_kl to this, so
    # that the skills stop taking turns; null: it stays.
    final_desired_kl: Clip | None = None
    settle_fraction: Fraction = 0.3
    critic_learning_rate: Rate = MISSING  # constant: the KL rule must not starve the critic
    max_grad_norm: GradientNorm = MISSING  # per network, > 0
    symmetry_weight: Weight = 0.0  # of the policy's divergence from its mirror image
    update_normalizer: bool = MISSING  # false freezes the actor's input statistics (imitation's)

    def check(self) -> None:
        checks.require(
            self.min_learning_rate <= self.learning_rate <= self.max_learning_rate,
            "algo.ppo.learning_rate",
            self.learning_rate,
            "choose a value within algo.ppo.min_learning_rate .. max_learning_rate "
            f"({self.min_learning_rate} .. {self.max_learning_rate})",
        )
        checks.require(
            self.adapt_each in ADAPT_EACH, "algo.ppo.adapt_each", self.adapt_each, f"choose {' or '.join(ADAPT_EACH)}"
        )
        checks.require(
            self.final_desired_kl is None or self.final_desired_kl <= self.desired_kl,
            "algo.ppo.final_desired_kl",
            self.final_desired_kl,
            f"choose null, or at most algo.ppo.desired_kl ({self.desired_kl})",
        )


@dataclass
class StyleConfig:
    """Conditional discriminator, eq. (3), and style reward, eq. (4)."""

    enabled: bool = MISSING  # false: not built; weight 0: trained and logged, not rewarded
    weight: Weight = MISSING  # omega^style of eq. (2)
    conditional: bool = MISSING  # false: plain AMP discriminator, and the embedding stays as initialized
    hidden: list[Units] = MISSING  # units per hidden layer
    learning_rate: Rate = MISSING  # Adam, > 0
    updates: Updates = MISSING  # discriminator steps per iteration
    batch_size: Batch = MISSING  # expert transitions per step, and as many fake ones
    gradient_penalty: Weight = MISSING  # omega_gp, per squared (1 / standardized unit)
    trunk_weight_decay: Weight = MISSING  # L2 inside Adam, hidden layers
    head_weight_decay: Weight = MISSING  # L2 inside Adam, logit layer; twice peers' "logit regularization"
    replay_size: Memory = MISSING  # past policy transitions kept; 0 = none
    input_noise: Noise = MISSING  # std added to expert and policy states, standardized units
    mismatch_fraction: PartialFraction = MISSING  # of the fakes: expert motion with a wrong label; needs conditional

    def check(self) -> None:
        checks.layers("algo.style.hidden", self.hidden)
        checks.require(
            self.conditional or self.mismatch_fraction == 0.0,
            "algo.style.mismatch_fraction",
            self.mismatch_fraction,
            "set it to 0 where algo.style.conditional is false: without z a wrong label is no difference",
        )


@dataclass
class SkillConfig:
    """Skill discriminator, eqs. (5), (7), (8), and skill reward, eq. (6)."""

    enabled: bool = MISSING  # false: not built; weight 0: trained and logged, not rewarded
    weight: Weight = MISSING  # omega^skill of eq. (2)
    hidden: list[Units] = MISSING  # units per hidden layer
    learning_rate: Rate = MISSING  # Adam, > 0
    updates: Updates = MISSING  # steps per iteration
    batch_size: Batch = MISSING  # expert transitions per step
    gradient_penalty: Weight = MISSING  # lambda of eq. (8)
    patience_s: Seconds | None = None  # s of another skill's motion after which an episode ends; null: no matter

    def check(self) -> None:
        checks.layers("algo.skill.hidden", self.hidden)
        if self.patience_s is not None:
            checks.require(
                self.enabled,
                "algo.skill.patience_s",
                self.patience_s,
                "set it to null without a skill discriminator (algo.skill.enabled=false), which tells skills apart",
            )


@dataclass
class ImitationConfig:
    """Supervised regression on the expert's answers, before PPO and beside it; 0 epochs: neither, as in the paper."""

    epochs: Epochs = MISSING  # passes over the pairs; 0 = no warm start
    batch_size: Batch = MISSING  # pairs per step, and per minibatch of PPO with ppo_weight
    learning_rate: Rate = MISSING  # Adam, start of the cosine
    last_action_noise: Noise = MISSING  # std on the last-action input, action units
    ppo_weight: Weight = MISSING  # of the same loss beside PPO's; 0 = imitation before PPO alone

    def check(self) -> None:
        checks.require(
            self.epochs > 0 or self.ppo_weight == 0.0,
            "algo.imitation.ppo_weight",
            self.ppo_weight,
            "set it to 0 without imitation (algo.imitation.epochs=0), or choose run=scratch",
        )


@dataclass
class AlgoConfig:
    """The whole group conf/algo."""

    task_weight: Weight = MISSING  # omega^task of eq. (2)
    embedding_size: Embedding = MISSING  # d_z, at least the number of skills
    precision: str = MISSING  # of the networks' layers while training; everything else is float32 or finer
    actor: ActorConfig = field(default_factory=ActorConfig)
    critic: CriticConfig = field(default_factory=CriticConfig)
    ppo: PPOConfig = field(default_factory=PPOConfig)
    style: StyleConfig = field(default_factory=StyleConfig)
    skill: SkillConfig = field(default_factory=SkillConfig)
    imitation: ImitationConfig = field(default_factory=ImitationConfig)

    def check(self) -> None:
        choice = f"choose one of {', '.join(PRECISIONS)}"
        checks.require(self.precision in PRECISIONS, "algo.precision", self.precision, choice)
        for part in (self.actor, self.critic, self.ppo, self.style, self.skill, self.imitation):
            part.check()
