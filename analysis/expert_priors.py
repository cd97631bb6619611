"""Priors that learn from the expert's clips without a policy: what can the rewards teach at all?

A discriminator needs something to reject. Two kinds of fakes stand for a policy that is kept where it is:

- "blind": the expert's motion under labels drawn at random. It shows all gaits and ignores the command.
- "untrained": what a fresh policy does after it was started in the expert's states.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from camp.algo.models import SkillEmbedding
from camp.algo.prior import Prior
from camp.algo.skill import SkillPrior
from camp.build import build_actor, build_env, build_priors
from camp.common.seeding import generator
from camp.config.schema import Config
from camp.data import Transition
from camp.gaits.skills import Skill, label_of
from camp.motion.clips.clip import Clip, discriminator_state
from camp.motion.clips.sampler import Demonstrations, transitions

EVERY = 4  # every fourth command of each skill is kept for the question
FAKES = ("blind", "untrained")
UNTRAINED_STEPS = 60  # of a fresh policy, by robot
BLOCK, MOST_BLOCKS = 50, 60  # iterations between two looks at the held-out loss, and looks at most
PATIENCE = 3  # looks without a gain, after which the loss has converged
Fakes = Callable[[int, torch.Generator], Transition]  # so many of them


@dataclass(frozen=True)
class Shown:
    """Expert motion that no prior has learned from. transition: labelled by the skill that it shows."""

    learned: Demonstrations
    asked: Transition


def split_commands(clips: Sequence[Clip]) -> tuple[list[Clip], list[Clip]]:
    """Clips to learn from, and steady ones to be asked about: the same commands are held out of every gait."""
    steady = [clip for clip in clips if clip.is_steady]
    commands = sorted({_key(clip.command) for clip in steady})
    held_out = set(commands[::EVERY])
    asked = [clip for clip in steady if _key(clip.command) in held_out]
    learned = [clip for clip in clips if not (clip.is_steady and _key(clip.command) in held_out)]
    return learned, asked


def _key(command: np.ndarray) -> tuple[float, ...]:
    return tuple(np.round(np.asarray(command, dtype=float), 3).tolist())


def show(config: Config, clips: Sequence[Clip]) -> Shown:
    """The clips as priors see them, with some commands held out."""
    skills, ages = config.motion.skill_set(), config.env.transition_ages
    learned, asked = split_commands(clips)
    source = Demonstrations(
        learned, skills, config.motion.num_preloaded, generator(config.seed, "preloading"), ages=ages
    )
    return Shown(source, labelled(asked, skills, ages))


def labelled(clips: Sequence[Clip], skills: Sequence[Skill], ages: Sequence[int]) -> Transition:
    """All transitions of the clips, each under the label of the skill that it shows."""
    motion = [transitions(torch.from_numpy(discriminator_state(clip)), ages) for clip in clips]
    labels = [label_of(clip.gait, clip.frequency_hz, skills) for clip in clips]
    counts = torch.tensor([len(rows) for rows in motion])
    return Transition(torch.cat(motion), torch.tensor(labels).repeat_interleave(counts))


def fresh_priors(config: Config) -> list[Prior]:
    """The priors that training would begin with."""
    weights = generator(config.seed, "weights")
    embedding = SkillEmbedding(len(config.motion.skill_set()), config.algo.embedding_size, weights)
    return build_priors(config, embedding, weights)


def make_fakes(kind: str, shown: Shown, pool: Transition) -> Fakes:
    """One of FAKES. pool: what the untrained policy did."""
    num_skills = len(shown.learned.counts)

    def blind(n: int, source: torch.Generator) -> Transition:
        return Transition(shown.learned.sample(n, source).state, _labels(n, num_skills, source))

    def untrained(n: int, source: torch.Generator) -> Transition:
        return pool.take(torch.randint(len(pool), (n,), generator=source))

    return {"blind": blind, "untrained": untrained}[kind]


def _labels(n: int, num_skills: int, source: torch.Generator) -> Tensor:
    return torch.randint(num_skills, (n,), generator=source)


def untrained_motion(config: Config, clips: list[Clip]) -> Transition:
    """What a fresh policy does in the environment under random commands and skills: UNTRAINED_STEPS of each robot."""
    actor, source = build_actor(config, generator(config.seed, "weights")), generator(config.seed, "policy")
    env = build_env(config, clips)
    observation, seen = env.reset(seed=config.seed)[0], []
    for _ in range(UNTRAINED_STEPS):
        with torch.no_grad():
            mean = actor(observation)
        step = env.advance(mean + actor.std.detach() * torch.randn(mean.shape, generator=source))
        observation = step.observation
        seen.append(step.motion())
    return Transition(torch.cat([one.state for one in seen]), torch.cat([one.skill for one in seen]))


def train(priors: Sequence[Prior], shown: Shown, fakes: Fakes, iterations: int, seed: int) -> None:
    """Let the priors learn for so many iterations, each with its configured updates, as beside a policy."""
    source = generator(seed, "priors")
    for _ in range(iterations):
        for prior in priors:
            batch = prior.config.batch_size  # type: ignore[attr-defined]
            prior.update(fakes(batch, source), shown.learned, source)


def converge(
    prior: SkillPrior, shown: Shown, seed: int, least_gain: float = 0.02, most_blocks: int = MOST_BLOCKS
) -> list[float]:
    """Let a skill prior learn until its loss on held-out motion has not fallen below the least one by ``least_gain`` of
    it for PATIENCE blocks of BLOCK iterations; returns the losses, one for each block."""
    source, losses, best, since = generator(seed, "priors"), [], np.inf, 0
    for _ in range(most_blocks):
        for _ in range(BLOCK):
            prior.update(shown.learned.sample(1, source), shown.learned, source)
        with torch.no_grad():
            error = (prior.predict(shown.asked) - prior.embedding(shown.asked.skill)).square().sum(dim=1)
        losses.append(float(error.mean()))
        gained = losses[-1] < (1.0 - least_gain) * best
        best, since = (losses[-1], 0) if gained else (best, since + 1)
        if since == PATIENCE:
            break
    return losses
