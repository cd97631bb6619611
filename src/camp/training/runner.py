"""The training loop: collect, score, update, log, save."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from camp.algo.losses import gae
from camp.algo.ppo import desired_kl_at
from camp.algo.prior import WithHistograms
from camp.build import Training
from camp.common import distributed
from camp.common.averages import Averages
from camp.common.seeding import generator_state, global_state, restore_generator, restore_global_state
from camp.common.stopwatch import Stopwatch
from camp.config.schema import Config
from camp.data import Rollout
from camp.envs.rewards import mix_rewards
from camp.gaits.skills import names
from camp.runs.checkpoint import save_run_checkpoint
from camp.runs.logger import NoLogger, RunLogger
from camp.runs.metrics import Metric
from camp.runs.state import TrainingState, diverged
from camp.training.alarms import AlarmMonitor, alarms_of
from camp.training.best import BestCheckpoint
from camp.training.collector import Collector
from camp.training.dumps import save_dump
from camp.training.gait_monitor import GaitMonitor
from camp.training.hardening import next_difficulty
from camp.training.patience import build_patience
from camp.training.progress import Progress
from camp.training.skill_curriculum import build_skill_curriculum


class Runner:
    """CAMP: PPO on task, style and skill rewards, while the priors that judge style and skill learn beside it.

    Every rank runs its own, on its share of the robots; networks stay the same on all of them.
    """

    def __init__(self, training: Training, config: Config, folder: Path):
        self.training, self.config, self.folder = training, config, folder
        env = training.env
        self.monitor = GaitMonitor(
            config.motion.skill_set(),
            env.num_envs,
            config.run.gait_window_s,
            env.sim.control_period,
            env.sim.device,
        )
        self.alarms = AlarmMonitor(alarms_of(config))
        self.best = BestCheckpoint(env.num_skills)
        self.collector = Collector(env, training.ppo, self.monitor, training.device, build_patience(training, config))
        self.skill_curriculum = build_skill_curriculum(training, config)
        self.iteration = 0  # completed ones

    def start(self) -> None:
        """Begin the first episodes, with the first rank's networks everywhere."""
        distributed.copy_from_first(self.training.networks())
        self.training.env.reset()

    def train(
        self, logger: RunLogger | NoLogger, progress: Progress, stopping: Callable[[], bool] = lambda: False
    ) -> None:
        """Iterate to the end, or until ``stopping`` says so on any rank between two iterations.

        Always saves what was reached.
        """
        run = self.config.run
        saved = self.iteration
        while self.iteration < run.iterations and not distributed.anywhere(stopping()):
            metrics = self.iterate()
            self.best.read(metrics)
            logger.log(self.iteration, metrics)
            progress.update(self.iteration, metrics)
            for line in self.dump_diverged():
                progress.say(f"iteration {self.iteration}: {line}")
            for line in self.alarms.new():
                progress.say(f"iteration {self.iteration}: {line}")
            if self.iteration % run.checkpoint_every == 0:
                self.save()
                saved = self.iteration
        if saved < self.iteration:
            self.save()

    def iterate(self) -> dict[str, Metric]:
        """One iteration of the algorithm; returns its metrics."""
        training, run, watch = self.training, self.config.run, Stopwatch()
        rollout, metrics = self.collector.collect(run.rollout_steps, training.generators["policy"])
        watch.lap("collect")
        terms = self._score(rollout)
        advantage, return_ = self._advantage(terms, rollout)
        watch.lap("score")
        metrics |= self._update_policy(rollout, advantage, return_)
        watch.lap("policy_update")
        for prior in training.priors:
            metrics |= prior.update(rollout.transitions(), training.demonstrations, training.generators["priors"])
        watch.lap("prior_update")

        self.iteration += 1
        metrics |= self._reward_metrics(terms, rollout)
        metrics |= self._weighted(metrics)
        metrics["env/diverged"] = float(distributed.total(torch.tensor(metrics["env/diverged"])))
        metrics |= self.alarms.update(metrics)
        readings = self._readings(rollout) if self.iteration % run.gait_every == 0 else {}
        metrics |= self._move_curricula(rollout, metrics | readings)
        steps = distributed.size() * rollout.skill.numel()
        metrics |= {f"time/{part}_s": seconds for part, seconds in watch.parts.items()}
        metrics["time/steps_per_s"] = steps / watch.total
        metrics["steps"] = float(self.iteration * steps)
        return metrics | readings

    def dump_diverged(self) -> list[str]:
        """Keep what led to the first divergence of this rank's robots in this iteration, if any; says how to see it."""
        case = self.training.env.first_diverged.take()
        return [] if case is None else save_dump(self.folder, self.iteration, case, self.config)

    def save(self) -> None:
        """Write a checkpoint of everything a bit-for-bit continuation needs, all ranks' parts in one file.

        Raises CheckpointError, and writes and deletes nothing, where the networks are not finite.
        """
        state = self.state()
        entry = state.not_finite()
        if entry is not None:
            raise diverged(self.folder, self.iteration, entry)
        self.best.saved(self.iteration)
        if distributed.is_first():
            content = replace(state, best=self.best.state_dict()).as_dict()
            keep = self.config.run.checkpoints_kept
            save_run_checkpoint(self.folder, self.iteration, content, keep, self.best.iteration)

    def state(self) -> TrainingState:
        training = self.training
        return TrainingState(
            iteration=self.iteration,
            ppo=training.ppo.state_dict(),
            priors={prior.name: prior.state_dict() for prior in training.priors},
            alarms=self.alarms.state_dict(),
            best=self.best.state_dict(),
            ranks=distributed.gather(self._own_state()),
        )

    def _own_state(self) -> dict[str, Any]:
        training = self.training
        return {
            "memories": {prior.name: prior.memory() for prior in training.priors},
            "env": training.env.state_dict(),
            "monitor": self.monitor.state_dict(),
            "collector": self.collector.state_dict(),
            "skill_curriculum": None if self.skill_curriculum is None else self.skill_curriculum.state_dict(),
            "generators": {name: generator_state(g) for name, g in training.generators.items()},
            "global_random_state": global_state(),
        }

    def restore(self, state: TrainingState) -> None:
        """Continue from a saved state, on this rank with its own part."""
        training = self.training
        self.iteration = state.iteration
        training.ppo.load_state_dict(state.ppo)
        for prior in training.priors:
            prior.load_state_dict(state.priors[prior.name])
        self.alarms.load_state_dict(state.alarms)
        self.best.load_state_dict(state.best)
        own = state.ranks[distributed.rank()]
        for prior in training.priors:
            prior.load_memory(own["memories"][prior.name])
        training.env.load_state_dict(own["env"])
        self.monitor.load_state_dict(own["monitor"])
        if self.skill_curriculum is not None:
            self.skill_curriculum.load_state_dict(own["skill_curriculum"])
        self.collector.load_state_dict(own.get("collector", {}))  # before `algo.skill.patience_s` there was none
        for name, generator in training.generators.items():
            restore_generator(generator, own["generators"][name])
        restore_global_state(own["global_random_state"])

    def _score(self, rollout: Rollout) -> dict[str, Tensor]:
        """Every reward term of eq. (2), each (T, N), as judged before this iteration's updates."""
        terms = {"task": rollout.task_reward}
        for prior in self.training.priors:
            terms[prior.name] = prior.reward(rollout.transitions()).view_as(rollout.task_reward)
        return terms

    def _weights(self) -> dict[str, float]:
        """Of the terms in eq. (2)."""
        return {"task": self.config.algo.task_weight} | {prior.name: prior.weight for prior in self.training.priors}

    def _advantage(self, terms: dict[str, Tensor], rollout: Rollout) -> tuple[Tensor, Tensor]:
        """Advantages and returns, each (T, N), of the weighted terms."""
        ppo = self.config.algo.ppo
        return gae(
            mix_rewards(terms, self._weights()),
            rollout.value,
            rollout.next_value,
            rollout.terminated,
            rollout.truncated,
            ppo.gamma,
            ppo.gae_lambda,
        )

    def _update_policy(self, rollout: Rollout, advantage: Tensor, return_: Tensor) -> dict[str, float]:
        """Actor and critic, or the critic alone while it warms up; returns metrics."""
        ppo, run, minibatches = self.training.ppo, self.config.run, self.training.generators["minibatches"]
        ppo.desired_kl = desired_kl_at(self.iteration / run.iterations, self.config.algo.ppo)
        if self.iteration < run.critic_warmup:
            return ppo.update_critic(rollout, return_, minibatches)
        return ppo.update(rollout, advantage, return_, minibatches)

    def _move_curricula(self, rollout: Rollout, metrics: Mapping[str, Metric]) -> dict[str, float]:
        """Skills and conditions of the next iteration, by what this one showed; returns metrics of this one."""
        env = self.training.env
        moved = {"env/difficulty": env.difficulty}
        if self.skill_curriculum is not None:
            moved |= self.skill_curriculum.update(rollout)
        env.difficulty = next_difficulty(env.difficulty, metrics, self.config.env.hardening, env.num_skills)
        return moved

    def _readings(self, rollout: Rollout) -> dict[str, Metric]:
        """What is too dear for every iteration: gaits from foot contacts, and how the priors' answers are spread."""
        training = self.training
        readings: dict[str, Metric] = {**self.monitor.read()}
        for prior in training.priors:
            if isinstance(prior, WithHistograms):
                generator = training.generators["readings"]  # its own: looking must not change what is learned
                readings |= prior.histograms(rollout.transitions(), training.demonstrations, generator)
        return readings

    def _reward_metrics(self, terms: dict[str, Tensor], rollout: Rollout) -> dict[str, float]:
        """Mean raw reward of every term, over all and while each skill was commanded."""
        averages, skill = Averages(), rollout.skill.flatten()
        for name, term in terms.items():
            averages.add(f"reward/{name}/raw", term)
            averages.add_per_skill(f"reward/{name}/raw", term.flatten(), skill, names(self.config.motion.skill_set()))
        return averages.result()

    def _weighted(self, metrics: dict[str, float]) -> dict[str, float]:
        """What every term, those of the task among them, adds to the reward of eq. (2)."""
        weights = self._weights()
        weights |= {name: weights["task"] * weight for name, weight in self.config.env.reward.weights().items()}
        return {f"reward/{name}/weighted": weight * metrics[f"reward/{name}/raw"] for name, weight in weights.items()}
