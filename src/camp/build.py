"""From configuration to objects: the only place where a config value decides what is built."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import torch
from torch import nn

from camp.algo.mirror import Reflection, Symmetry
from camp.algo.models import Critic, GaussianActor, SkillEmbedding, set_precision
from camp.algo.ppo import PPO
from camp.algo.prior import Prior
from camp.algo.skill import SkillPrior
from camp.algo.style import StylePrior
from camp.common import distributed
from camp.common.errors import ConfigError
from camp.common.paths import shipped_motions
from camp.common.seeding import generator
from camp.common.threads import threads_of_process
from camp.config.devices import learner_device, simulator_device
from camp.config.memory import check_memory
from camp.config.resolve import load_run_config
from camp.config.schema import Config
from camp.envs.observations import entries_of, sizes
from camp.envs.quadruped import QuadrupedEnv
from camp.gaits.skills import names
from camp.motion.clips.clip import Clip
from camp.motion.clips.mirror import with_images
from camp.motion.clips.sampler import Demonstrations, ReferenceStates
from camp.motion.clips.stance import with_foot_stance
from camp.motion.clips.store import load_skill_clips
from camp.robots.config import RobotConfig
from camp.robots.mirror import JOINTS
from camp.robots.quadruped import NUM_JOINTS, NUM_LEGS
from camp.robots.registry import find_robot
from camp.robots.robot import Robot
from camp.runs.checkpoint import INCOMPATIBLE, incompatible
from camp.runs.state import load_state
from camp.sim.base import Simulator
from camp.sim.choice import warp_installed
from camp.sim.config import SimConfig
from camp.sim.cpu import CpuSimulator


@dataclass
class Training:
    """All that the training loop of one rank works on."""

    env: QuadrupedEnv
    ppo: PPO
    priors: list[Prior]
    demonstrations: Demonstrations
    clips: list[Clip]
    generators: dict[str, torch.Generator]  # on the learner's device, by stream
    device: torch.device  # of the learner

    def networks(self) -> list[nn.Module]:
        """All that is learned or measured."""
        return self.ppo.networks() + [network for prior in self.priors for network in prior.networks()]


@dataclass
class Run:
    """What a run folder holds for evaluation and analysis, on the CPU."""

    config: Config
    iteration: int
    actor: GaussianActor
    skills: tuple[str, ...]  # names in label order
    skill_prior: SkillPrior | None  # None where an ablation trained without

    @cached_property
    def clips(self) -> list[Clip]:
        """The expert clips of its skills, loaded when they are first asked for. Raises ClipError."""
        return expert_clips(self.config)


def build_robot(config: RobotConfig) -> Robot:
    """The robot of conf/robot, with the gains given there."""
    return replace(
        find_robot(config.name), pd_gain_p=tuple(config.kp) * NUM_LEGS, pd_gain_d=tuple(config.kd) * NUM_LEGS
    )


def motion_folder(config: Config) -> Path:
    """Where the expert clips lie: the configured folder, or the robot's shipped one."""
    return Path(config.motion.folder) if config.motion.folder else shipped_motions(config.robot.name)


def expert_clips(config: Config) -> list[Clip]:
    """The clips of the configured skills and stride frequencies. Raises ClipError where a skill has none."""
    robot, folder, motion = build_robot(config.robot), motion_folder(config), config.motion
    clips = load_skill_clips(robot, folder, motion.skill_set(), list(motion.frequencies_hz))
    clips = seen_by_discriminators(config, clips)
    return with_images(clips) if motion.mirrored else clips


def seen_by_discriminators(config: Config, clips: list[Clip]) -> list[Clip]:
    """The clips with all that ``env`` lets discriminators see of them. Raises ClipError where a clip cannot tell."""
    if not config.env.foot_stance:
        return clips
    return with_foot_stance(find_robot(config.robot.name), clips, config.sim.physics_timestep_s)


def build_simulator(config: Config, num_envs: int | None = None) -> Simulator:
    """The simulator of conf/sim, with ``num_envs`` robots instead of the configured number where given.

    Raises ConfigError where it cannot run.
    """
    sim: SimConfig = config.sim
    num = sim.num_envs if num_envs is None else num_envs
    period, timestep = config.env.control_period_s, sim.physics_timestep_s
    robot = build_robot(config.robot)
    if sim.backend == "cpu":
        return CpuSimulator(robot, num, period, timestep, sim.threads)
    if not warp_installed():
        raise ConfigError("sim.backend = 'gpu': mujoco_warp is not installed; pip install '.[gpu]', or choose sim=cpu")
    device = simulator_device(config)
    from camp.sim.gpu import GpuSimulator, WarpSettings  # takes seconds, and its packages need not be installed

    assert sim.contacts_per_robot is not None and sim.constraints_per_robot is not None
    settings = WarpSettings(device, sim.contacts_per_robot, sim.constraints_per_robot)
    return GpuSimulator(robot, num, period, timestep, settings)


def build_env(config: Config, clips: list[Clip], num_envs: int | None = None) -> QuadrupedEnv:
    """The batched environment with its simulator and reference states."""
    _check_period(config, clips)
    sim = build_simulator(config, num_envs)
    return QuadrupedEnv(
        sim,
        config.env,
        config.robot.action_scale,
        ReferenceStates(
            clips,
            config.motion.skill_set(),
            sim.device,
            config.env.transition_ages[0],
            config.env.observation.history,
        ),
        generator(config.seed, distributed.stream("environment"), sim.device),
    )


def build_training(config: Config) -> Training:
    """Everything that trains on this rank. Raises CampError where clips, devices or memory are missing, or where the
    ranks cannot share the configured totals."""
    config = share_of_rank(config)
    check_memory(config)
    device = learner_device(config.device)
    clips, skills = expert_clips(config), config.motion.skill_set()
    weights = generator(config.seed, "weights")
    embedding = SkillEmbedding(len(skills), config.algo.embedding_size, weights).to(device)
    training = Training(
        env=build_env(config, clips),
        ppo=PPO(
            build_actor(config, weights).to(device),
            _build_critic(config, weights).to(device),
            config.algo.ppo,
            build_symmetry(config, device) if config.algo.ppo.symmetry_weight else None,
        ),
        priors=build_priors(config, embedding, weights),
        demonstrations=Demonstrations(
            clips,
            skills,
            config.motion.num_preloaded,
            generator(config.seed, "preloading"),
            device,
            config.env.transition_ages,
        ),
        clips=clips,
        generators={name: generator(config.seed, distributed.stream(name), device) for name in _OWN_STREAMS},
        device=device,
    )
    set_precision(training.networks(), config.algo.precision)
    return training


# Of the learner's random streams those that differ between ranks.
_OWN_STREAMS = ("policy", "minibatches", "priors", "imitation", "readings")


def share_of_rank(config: Config) -> Config:
    """The configuration with this rank's part of what is configured for all: robots, batches, replay, processors.

    So the same configuration means the same training on any number of ranks.
    """
    own = copy.deepcopy(config)
    own.sim.num_envs = distributed.share("sim.num_envs", config.sim.num_envs)
    own.sim.threads = threads_of_process(config.sim.threads)
    for name, prior in (("style", own.algo.style), ("skill", own.algo.skill)):
        prior.batch_size = distributed.share(f"algo.{name}.batch_size", prior.batch_size)
    own.algo.style.replay_size = distributed.share("algo.style.replay_size", own.algo.style.replay_size)
    own.check()
    return own


def build_actor(config: Config, weights: torch.Generator) -> GaussianActor:
    """The policy network, on the CPU."""
    return GaussianActor(_observed(config)[0], NUM_JOINTS, config.algo.actor, weights)


def load_run(folder: Path) -> Run:
    """The latest checkpoint of a run folder, as networks.

    Raises CampError where it is missing, damaged or holds values that are not finite.
    """
    config = load_run_config(folder)
    state = load_state(folder)
    skills = names(config.motion.skill_set())
    weights = generator(config.seed, "weights")
    actor = build_actor(config, weights)
    skill_prior = None
    try:
        actor.load_state_dict(state.actor)
        if state.skill_prior is not None:
            embedding = SkillEmbedding(len(skills), config.algo.embedding_size, weights)
            skill_prior = SkillPrior(config.algo.skill, embedding, skills, config.env.transition_shape(), weights)
            skill_prior.load_state_dict(state.skill_prior)
    except INCOMPATIBLE as error:
        raise incompatible(folder, error) from error
    return Run(config, state.iteration, actor, skills, skill_prior)


def _check_period(config: Config, clips: list[Clip]) -> None:
    """Discriminators compare the policy's pairs of states with the clips': both must be equally far apart."""
    for clip in clips:
        if abs(clip.dt - config.env.control_period_s) > 1e-6:
            raise ConfigError(
                f"env.control_period_s = {config.env.control_period_s}: the expert clips have a period of "
                f"{clip.dt:g} s; use that, or clips of the other period"
            )


def build_symmetry(config: Config, device: torch.device) -> Symmetry:
    """How observations and actions look in a mirror. Raises ConfigError where that of an entry is not known."""
    observed = config.env.observation
    frame = [entry.known_mirror() for entry in entries_of(observed.policy, len(config.motion.skill_set()))]
    return Symmetry(Reflection(frame * observed.history, device), Reflection([JOINTS], device))


def _build_critic(config: Config, weights: torch.Generator) -> Critic:
    return Critic(sum(_observed(config)), config.algo.critic, weights)


def _observed(config: Config) -> tuple[int, int]:
    """How many numbers the policy observes, and how many the critic besides."""
    return sizes(config.env.observation, len(config.motion.skill_set()))


def build_priors(config: Config, embedding: SkillEmbedding, weights: torch.Generator) -> list[Prior]:
    """The style and the skill prior, as far as they are enabled, on the embedding's device."""
    algo, skills, shape = config.algo, names(config.motion.skill_set()), config.env.transition_shape()
    priors: list[Prior] = []
    if algo.style.enabled:
        priors.append(StylePrior(algo.style, embedding, skills, shape, weights))
    if algo.skill.enabled:
        priors.append(SkillPrior(algo.skill, embedding, skills, shape, weights))
    return priors
