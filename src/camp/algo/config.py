"""Schema of conf/algo: types, units, ranges.

Values live in the YAML; `check` says which key is wrong and what to do.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from omegaconf import MISSING

from camp.common import checks

PRECISIONS = ("float32", "bfloat16", "tf32")


@dataclass
class ActorConfig:
    """Policy network and exploration."""

    hidden: list[int] = MISSING  # units per hidden layer
    initial_std: float = MISSING  # action units, within [min_std, max_std]
    min_std: float = MISSING  # action units, floor of the exploration std
    max_std: float = MISSING  # action units, ceiling
    learn_std: bool = MISSING  # false: the std only moves by `set_std`

    def check(self) -> None:
        checks.layers("algo.actor.hidden", self.hidden)
        checks.positive("algo.actor.min_std", self.min_std)
        checks.positive("algo.actor.max_std", self.max_std)
        checks.require(
            self.min_std <= self.initial_std <= self.max_std,
            "algo.actor.initial_std",
            self.initial_std,
            f"choose a value within algo.actor.min_std .. max_std ({self.min_std} .. {self.max_std})",
        )


@dataclass
class CriticConfig:
    """Value network."""

    hidden: list[int] = MISSING  # units per hidden layer

    def check(self) -> None:
        checks.layers("algo.critic.hidden", self.hidden)


@dataclass
class PPOConfig:
    """Proximal policy optimization."""

    gamma: float = MISSING  # discount per control step, [0, 1]
    gae_lambda: float = MISSING  # lambda of GAE, [0, 1]
    clip_param: float = MISSING  # probability ratio kept within 1 +- clip, > 0
    value_clip_param: float = MISSING  # value moves per update, in standard deviations of the return; 0 = unclipped
    entropy_coef: float = MISSING  # weight of the entropy bonus, >= 0
    epochs: int = MISSING  # passes over the rollout per iteration
    minibatches: int = MISSING  # per epoch, permuted anew each epoch
    learning_rate: float = MISSING  # actor, start of the adaptive rule, within [min, max]
    min_learning_rate: float = MISSING  # actor, floor of the adaptive rule
    max_learning_rate: float = MISSING  # actor, ceiling of the adaptive rule
    adaptive: bool = MISSING  # steer the actor's rate so that the KL per iteration stays near desired_kl
    desired_kl: float = MISSING  # nats, > 0
    # Over the last `settle_fraction` of the iterations the desired KL falls geometrically from desired_kl to this, so
    # that the skills stop taking turns; null: it stays.
    final_desired_kl: float | None = None
    settle_fraction: float = 0.3
    critic_learning_rate: float = MISSING  # constant: the KL rule must not starve the critic
    max_grad_norm: float = MISSING  # per network, > 0
    update_normalizer: bool = MISSING  # false freezes the actor's input statistics (imitation's)

    def check(self) -> None:
        checks.fraction("algo.ppo.gamma", self.gamma)
        checks.fraction("algo.ppo.gae_lambda", self.gae_lambda)
        checks.positive("algo.ppo.clip_param", self.clip_param)
        checks.not_negative("algo.ppo.value_clip_param", self.value_clip_param)
        checks.not_negative("algo.ppo.entropy_coef", self.entropy_coef)
        checks.count("algo.ppo.epochs", self.epochs)
        checks.count("algo.ppo.minibatches", self.minibatches)
        checks.positive("algo.ppo.min_learning_rate", self.min_learning_rate)
        checks.positive("algo.ppo.max_learning_rate", self.max_learning_rate)
        checks.require(
            self.min_learning_rate <= self.learning_rate <= self.max_learning_rate,
            "algo.ppo.learning_rate",
            self.learning_rate,
            "choose a value within algo.ppo.min_learning_rate .. max_learning_rate "
            f"({self.min_learning_rate} .. {self.max_learning_rate})",
        )
        checks.positive("algo.ppo.desired_kl", self.desired_kl)
        checks.require(
            self.final_desired_kl is None or 0.0 < self.final_desired_kl <= self.desired_kl,
            "algo.ppo.final_desired_kl",
            self.final_desired_kl,
            f"choose null, or a value above 0 and at most algo.ppo.desired_kl ({self.desired_kl})",
        )
        checks.fraction("algo.ppo.settle_fraction", self.settle_fraction)
        checks.positive("algo.ppo.critic_learning_rate", self.critic_learning_rate)
        checks.positive("algo.ppo.max_grad_norm", self.max_grad_norm)


@dataclass
class StyleConfig:
    """Conditional discriminator, eq. (3), and style reward, eq. (4)."""

    enabled: bool = MISSING  # false: not built; weight 0: trained and logged, not rewarded
    weight: float = MISSING  # omega^style of eq. (2)
    conditional: bool = MISSING  # false: plain AMP discriminator, and the embedding stays as initialized
    hidden: list[int] = MISSING  # units per hidden layer
    learning_rate: float = MISSING  # Adam, > 0
    updates: int = MISSING  # discriminator steps per iteration
    batch_size: int = MISSING  # expert transitions per step, and as many fake ones
    gradient_penalty: float = MISSING  # omega_gp, per squared (1 / standardized unit)
    trunk_weight_decay: float = MISSING  # L2 inside Adam, hidden layers
    head_weight_decay: float = MISSING  # L2 inside Adam, logit layer; twice peers' "logit regularization"
    replay_size: int = MISSING  # past policy transitions kept; 0 = none
    input_noise: float = MISSING  # std added to expert and policy states, standardized units
    mismatch_fraction: float = MISSING  # of the fakes: expert motion with a wrong label; needs conditional

    def check(self) -> None:
        checks.not_negative("algo.style.weight", self.weight)
        checks.layers("algo.style.hidden", self.hidden)
        checks.positive("algo.style.learning_rate", self.learning_rate)
        checks.count("algo.style.updates", self.updates)
        checks.count("algo.style.batch_size", self.batch_size)
        checks.not_negative("algo.style.gradient_penalty", self.gradient_penalty)
        checks.not_negative("algo.style.trunk_weight_decay", self.trunk_weight_decay)
        checks.not_negative("algo.style.head_weight_decay", self.head_weight_decay)
        checks.not_negative("algo.style.replay_size", self.replay_size)
        checks.not_negative("algo.style.input_noise", self.input_noise)
        checks.fraction_below_one("algo.style.mismatch_fraction", self.mismatch_fraction)
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
    weight: float = MISSING  # omega^skill of eq. (2)
    hidden: list[int] = MISSING  # units per hidden layer
    learning_rate: float = MISSING  # Adam, > 0
    updates: int = MISSING  # steps per iteration
    batch_size: int = MISSING  # expert transitions per step
    gradient_penalty: float = MISSING  # lambda of eq. (8)
    patience_s: float | None = None  # s of another skill's motion after which an episode ends; null: no matter

    def check(self) -> None:
        checks.not_negative("algo.skill.weight", self.weight)
        checks.layers("algo.skill.hidden", self.hidden)
        checks.positive("algo.skill.learning_rate", self.learning_rate)
        checks.count("algo.skill.updates", self.updates)
        checks.count("algo.skill.batch_size", self.batch_size)
        checks.not_negative("algo.skill.gradient_penalty", self.gradient_penalty)
        if self.patience_s is not None:
            checks.positive("algo.skill.patience_s", self.patience_s)
            checks.require(
                self.enabled,
                "algo.skill.patience_s",
                self.patience_s,
                "set it to null without a skill discriminator (algo.skill.enabled=false), which tells skills apart",
            )


@dataclass
class ImitationConfig:
    """Supervised regression on the expert's answers, before PPO and beside it; 0 epochs: neither, as in the paper."""

    epochs: int = MISSING  # passes over the pairs; 0 = no warm start
    batch_size: int = MISSING  # pairs per step, and per minibatch of PPO with ppo_weight
    learning_rate: float = MISSING  # Adam, start of the cosine
    last_action_noise: float = MISSING  # std on the last-action input, action units
    ppo_weight: float = MISSING  # of the same loss beside PPO's; 0 = imitation before PPO alone

    def check(self) -> None:
        checks.not_negative("algo.imitation.epochs", self.epochs)
        checks.count("algo.imitation.batch_size", self.batch_size)
        checks.positive("algo.imitation.learning_rate", self.learning_rate)
        checks.not_negative("algo.imitation.last_action_noise", self.last_action_noise)
        checks.not_negative("algo.imitation.ppo_weight", self.ppo_weight)
        checks.require(
            self.epochs > 0 or self.ppo_weight == 0.0,
            "algo.imitation.ppo_weight",
            self.ppo_weight,
            "set it to 0 without imitation (algo.imitation.epochs=0), or choose run=scratch",
        )


@dataclass
class AlgoConfig:
    """The whole group conf/algo."""

    task_weight: float = MISSING  # omega^task of eq. (2)
    embedding_size: int = MISSING  # d_z, at least the number of skills
    precision: str = MISSING  # of the networks' layers while training; everything else is float32 or finer
    actor: ActorConfig = field(default_factory=ActorConfig)
    critic: CriticConfig = field(default_factory=CriticConfig)
    ppo: PPOConfig = field(default_factory=PPOConfig)
    style: StyleConfig = field(default_factory=StyleConfig)
    skill: SkillConfig = field(default_factory=SkillConfig)
    imitation: ImitationConfig = field(default_factory=ImitationConfig)

    def check(self) -> None:
        checks.not_negative("algo.task_weight", self.task_weight)
        checks.count("algo.embedding_size", self.embedding_size)
        choice = f"choose one of {', '.join(PRECISIONS)}"
        checks.require(self.precision in PRECISIONS, "algo.precision", self.precision, choice)
        for part in (self.actor, self.critic, self.ppo, self.style, self.skill, self.imitation):
            part.check()
