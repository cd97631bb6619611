"""Schema of conf/sim: which simulator, how many robots."""

from __future__ import annotations

from dataclasses import dataclass, replace

from omegaconf import MISSING

from camp.common import checks
from camp.sim.choice import AUTO, BACKENDS


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
        check_backend(self.backend)
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


def check_backend(backend: str) -> None:
    """Raise ConfigError unless ``backend`` is the name of a simulator."""
    remedy = f"choose one of {', '.join(BACKENDS)}, {AUTO}"
    checks.require(backend in BACKENDS, "sim.backend", backend, remedy)
