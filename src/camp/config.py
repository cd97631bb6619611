"""The typed configuration of training: one dataclass per group of conf/, checked before anything is built.

Values live in YAML (conf/); here are the types, the units and the ranges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import cast

import torch
from omegaconf import MISSING, DictConfig, OmegaConf
from yaml import YAMLError

from camp import checks, distributed
from camp.algo.config import AlgoConfig
from camp.envs.config import EnvConfig
from camp.errors import ConfigError
from camp.hydra_errors import INPUT_ERRORS, diagnosis
from camp.logger import LoggerConfig
from camp.motion.gaits import GAIT_PHASES
from camp.motion.skills import LABELS, Skill, skill_set
from camp.paths import config_root
from camp.robots import go2
from camp.sim.choice import AUTO, BACKENDS, why_no_gpu


@dataclass
class SimConfig:
    """conf/sim: the simulator, once ``auto`` has been resolved."""

    backend: str = MISSING  # cpu or gpu
    num_envs: int = MISSING  # on all ranks together
    threads: int = MISSING  # of the simulation and of torch, per process; 0 = its share of the processors
    physics_timestep_s: float = MISSING
    device: str = "cpu"  # of the gpu backend: cuda, or cpu for tests
    contacts_per_robot: int | None = None  # that the gpu backend sets aside, on average over the robots
    constraints_per_robot: int | None = None  # rows of the solver that the gpu backend sets aside for each robot

    def on_cpu(self) -> SimConfig:
        """The same physics by the cpu backend."""
        return replace(self, backend="cpu", device="cpu", contacts_per_robot=None, constraints_per_robot=None)

    def check(self) -> None:
        _check_backend(self.backend)
        if self.backend == "gpu":
            checks.require(self.device in ("cuda", "cpu"), "sim.device", self.device, "choose cuda or cpu")
            for name in ("contacts_per_robot", "constraints_per_robot"):
                checks.count(f"sim.{name}", getattr(self, name) or 0)
        else:
            remedy = "the cpu backend runs on the CPU; choose sim=gpu, or device=cuda for the learner alone"
            checks.require(self.device == "cpu", "sim.device", self.device, remedy)
        checks.count("sim.num_envs", self.num_envs)
        checks.not_negative("sim.threads", self.threads)
        checks.positive("sim.physics_timestep_s", self.physics_timestep_s)


@dataclass
class RobotConfig:
    """conf/robot: the PD law and the action's scale."""

    kp: list[float] = MISSING  # N m/rad: hip, thigh, calf
    kd: list[float] = MISSING  # N m s/rad: hip, thigh, calf
    action_scale: float = MISSING  # rad per unit of the network's output

    def check(self) -> None:
        for name in ("kp", "kd"):
            gains = list(getattr(self, name))
            holds = len(gains) == 3 and all(gain > 0 for gain in gains)
            checks.require(holds, f"robot.{name}", gains, "give three positive gains: hip, thigh, calf")
        checks.positive("robot.action_scale", self.action_scale)


@dataclass
class MotionConfig:
    """conf/motion: the expert clips and the skills they teach."""

    folder: str | None = MISSING  # None: the clips shipped with the package
    skills: list[str] = MISSING  # gaits
    labels: str = MISSING  # gait: a skill is a gait; gait_frequency: a gait at one stride frequency
    frequencies_hz: list[float] = MISSING  # stride frequencies of the clips that are used
    mirrored: bool = MISSING  # also the left-right mirror images, perturbed clips' without their start
    num_preloaded: int = MISSING  # transitions
    perturbed_folder: str | None = MISSING  # None: one below <output_dir>/motions
    perturbed_clips: int = MISSING  # for imitation

    def skill_set(self) -> tuple[Skill, ...]:
        """The skills in label order."""
        return skill_set(self.skills, self.labels, self.frequencies_hz)

    def check(self) -> None:
        skills = list(self.skills)
        unknown = [skill for skill in skills if skill not in GAIT_PHASES]
        remedy = f"choose from {', '.join(GAIT_PHASES)}"
        checks.require(len(skills) > 0, "motion.skills", skills, remedy)
        checks.require(not unknown, "motion.skills", skills, f"unknown gait {', '.join(unknown)}; {remedy}")
        checks.require(len(set(skills)) == len(skills), "motion.skills", skills, "name each gait once")
        checks.require(self.labels in LABELS, "motion.labels", self.labels, f"choose one of {', '.join(LABELS)}")
        frequencies = list(self.frequencies_hz)
        holds = len(frequencies) > 0 and all(f > 0 for f in frequencies) and len(set(frequencies)) == len(frequencies)
        checks.require(holds, "motion.frequencies_hz", frequencies, "list stride frequencies above 0, each once")
        checks.count("motion.num_preloaded", self.num_preloaded)
        checks.count("motion.perturbed_clips", self.perturbed_clips)


@dataclass
class RunConfig:
    """conf/run: how long and how often."""

    iterations: int = MISSING  # of collecting and updating
    rollout_steps: int = MISSING  # control steps per iteration and environment
    critic_warmup: int = MISSING  # first iterations that train the critic and the priors alone (after imitation)
    checkpoint_every: int = MISSING  # iterations
    checkpoints_kept: int = MISSING
    gait_window_s: float = MISSING  # of foot contacts that a live gait reading looks at
    gait_every: int = MISSING  # iterations between live readings of gaits and of the style discriminator's logits

    def check(self) -> None:
        for name in ("iterations", "rollout_steps", "checkpoint_every", "checkpoints_kept", "gait_every"):
            checks.count(f"run.{name}", getattr(self, name))
        checks.not_negative("run.critic_warmup", self.critic_warmup)
        checks.require(
            self.gait_window_s >= 1.0,
            "run.gait_window_s",
            self.gait_window_s,
            "choose 1 s or more: two slow strides",
        )


@dataclass
class Config:
    """All of conf/train.yaml."""

    seed: int = MISSING
    variant: str = MISSING  # names and groups the run
    device: str = MISSING  # of the learner: auto, cpu, cuda, cuda:1
    output_dir: str = MISSING
    resume: str | None = MISSING  # a run folder to continue
    env: EnvConfig = field(default_factory=EnvConfig)
    sim: SimConfig = field(default_factory=SimConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    motion: MotionConfig = field(default_factory=MotionConfig)
    algo: AlgoConfig = field(default_factory=AlgoConfig)
    run: RunConfig = field(default_factory=RunConfig)
    logger: LoggerConfig = field(default_factory=LoggerConfig)

    def check(self) -> None:
        """Raise ConfigError for the first value that cannot work, alone or beside another."""
        checks.seed("seed", self.seed)
        allowed = "letters, digits, '.', '_' and '-'"
        clean = bool(self.variant) and all(c.isalnum() or c in "._-" for c in self.variant)
        checks.require(clean, "variant", self.variant, f"name it with {allowed}")
        for part in (self.env, self.sim, self.robot, self.motion, self.algo, self.run, self.logger):
            part.check()
        substeps = self.env.control_period_s / self.sim.physics_timestep_s
        checks.require(
            abs(substeps - round(substeps)) < 1e-6 and round(substeps) >= 1,
            "env.control_period_s",
            self.env.control_period_s,
            f"choose a multiple of sim.physics_timestep_s ({self.sim.physics_timestep_s} s)",
        )
        checks.require(
            self.algo.ppo.update_normalizer or self.algo.imitation.epochs > 0,
            "algo.ppo.update_normalizer",
            self.algo.ppo.update_normalizer,
            "set it to true without imitation (algo.imitation.epochs=0), or observations are never scaled",
        )
        gains = (list(self.robot.kp) * go2.NUM_LEGS, list(self.robot.kd) * go2.NUM_LEGS)
        checks.require(
            self.algo.imitation.epochs == 0 or gains == (list(go2.PD_GAIN_P), list(go2.PD_GAIN_D)),
            "robot.kp",
            list(self.robot.kp),
            "the expert's targets are made for the gains of robot=go2; use those, or run=scratch",
        )
        samples = self.run.rollout_steps * self.sim.num_envs
        checks.require(
            samples >= self.algo.ppo.minibatches,
            "algo.ppo.minibatches",
            self.algo.ppo.minibatches,
            f"choose at most run.rollout_steps x sim.num_envs ({samples})",
        )


def resolve(config: DictConfig) -> Config:
    """The typed and checked configuration behind a composed one; ``sim=auto`` becomes what can run here.

    Raises an OmegaConf error for an unknown key or a wrong type, ConfigError for a value out of range; the command
    line prints either as one line.
    """
    composed = _with_simulator(without_hydra(config))
    typed = cast(Config, OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(Config), composed)))
    typed.check()
    return typed


def _with_simulator(config: DictConfig) -> DictConfig:
    """``config`` with the simulator chosen, where that is left to us, and the chosen one's values where none are
    given."""
    if not isinstance(config.get("sim"), DictConfig) or "backend" not in config.sim:
        return config
    backend = config.sim.backend
    if backend == AUTO:
        backend = "gpu" if why_no_gpu(config.device) is None else "cpu"
    _check_backend(backend)
    given = {key: value for key, value in config.sim.items() if value is not None}
    values = OmegaConf.merge(OmegaConf.load(config_root() / "sim" / f"{backend}.yaml"), given, {"backend": backend})
    return OmegaConf.create({key: values if key == "sim" else config._get_node(key) for key in config})


def _check_backend(backend: str) -> None:
    remedy = f"choose one of {', '.join(BACKENDS)}, {AUTO}"
    checks.require(backend in BACKENDS, "sim.backend", backend, remedy)


def as_yaml(config: Config) -> DictConfig:
    """The typed configuration as OmegaConf, for the run folder."""
    return OmegaConf.structured(config)


def load_run_config(run: Path, changes: Sequence[str] = ()) -> Config:
    """The configuration a run folder was trained with, with ``changes`` like ``run.iterations=300``.

    Raises ConfigError where there is none, or one that cannot be used; for ``changes`` as `resolve`.
    """
    path = run / "config.yaml"
    if not path.is_file():
        raise ConfigError(f"run folder {run}: holds no config.yaml; name one of the folders that camp.train wrote")
    saved = _load_yaml(path)
    try:
        config = resolve(saved)
    except (*INPUT_ERRORS, TypeError) as error:  # OmegaConf lets a list pass for a number of a list
        raise ConfigError(
            f"file {path}: not a configuration for this camp ({diagnosis(error)}); restore the original file, or use "
            "the camp that wrote it, see versions.json"
        ) from error
    if not changes:
        return config
    return resolve(cast(DictConfig, OmegaConf.merge(saved, OmegaConf.from_dotlist(list(changes)))))


def _load_yaml(path: Path) -> DictConfig:
    try:
        loaded = OmegaConf.load(path)
    except (OSError, ValueError, YAMLError, *INPUT_ERRORS) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(f"file {path}: cannot be read as YAML ({reason}); restore the original file") from error
    if not isinstance(loaded, DictConfig):
        raise ConfigError(f"file {path}: a list, not a configuration; restore the original file")
    return loaded


def learner_device(name: str) -> torch.device:
    """The torch device behind ``device``; auto takes a CUDA GPU where there is one, several ranks on one machine take
    one each. Raises ConfigError."""
    automatic = "cuda" if torch.cuda.is_available() else "cpu"
    try:
        device = torch.device(automatic if name == "auto" else name)
    except RuntimeError as error:
        raise ConfigError(f"device = {name!r}: choose auto, cpu, cuda or cuda:<number>") from error
    if device.type == "cuda" and distributed.local_size() > 1:
        checks.require(device.index is None, "device", name, "torchrun gives each process its own GPU; choose cuda")
        device = torch.device("cuda", distributed.local_rank())
    found = torch.cuda.device_count()
    if device.type == "cuda" and (device.index or 0) >= found:
        raise ConfigError(f"device = {name!r}: torch finds {found} CUDA GPUs here and not {device}; choose cpu or auto")
    return device


def simulator_device(config: Config) -> torch.device:
    """Where the simulator's tensors are: the CPU, or the learner's GPU. Raises ConfigError."""
    if config.sim.device == "cpu":
        return torch.device("cpu")
    if not torch.cuda.is_available():
        raise ConfigError("sim.device = 'cuda': torch finds no CUDA GPU here; choose sim=cpu")
    learner = learner_device(config.device)
    if learner.type != "cuda":
        raise ConfigError(
            f"device = {config.device!r} beside sim=gpu: the learner would wait for copies at every step; "
            "choose device=cuda, or sim=cpu"
        )
    return torch.device("cuda", torch.cuda.current_device() if learner.index is None else learner.index)


def without_hydra(config: DictConfig) -> DictConfig:
    """A composed configuration without Hydra's own part."""
    return OmegaConf.create({key: config._get_node(key) for key in config if key != "hydra"})
