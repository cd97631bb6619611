"""Schema of conf/sim: which simulator, how many robots."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

from omegaconf import MISSING

from camp.common import checks
from camp.common.bounds import Threads, Within
from camp.sim.choice import AUTO, BACKENDS

Robots = Annotated[int, Within(1, 2**20, "a million robots fill any machine's memory")]
Timestep = Annotated[float, Within(1e-4, 0.1, "s; beyond it contacts are not solved, below nothing is gained")]
Contacts = Annotated[int, Within(1, 10_000, "every part of a robot on the ground makes 25")]
Rows = Annotated[int, Within(1, 100_000, "25 contacts and all joints make 124")]


@dataclass
class SimConfig:
    """conf/sim: the simulator, once ``auto`` has been resolved."""

    backend: str = MISSING  # cpu or gpu
    num_envs: Robots = MISSING  # on all ranks together
    threads: Threads = MISSING  # of the simulation and of torch, per process; 0 = its share of the processors
    physics_timestep_s: Timestep = MISSING
    device: str = "cpu"  # of the gpu backend: cuda, or cpu for tests
    contacts_per_robot: Contacts | None = None  # that the gpu backend sets aside, on average over the robots
    constraints_per_robot: Rows | None = None  # rows of the solver that the gpu backend sets aside for each robot

    def on_cpu(self) -> SimConfig:
        """The same physics by the cpu backend."""
        return replace(self, backend="cpu", device="cpu", contacts_per_robot=None, constraints_per_robot=None)

    def check(self) -> None:
        check_backend(self.backend)
        if self.backend == "gpu":
            checks.require(self.device in ("cuda", "cpu"), "sim.device", self.device, "choose cuda or cpu")
            for name in ("contacts_per_robot", "constraints_per_robot"):
                checks.require(getattr(self, name) is not None, f"sim.{name}", None, "give a number for sim=gpu")
        else:
            remedy = "the cpu backend runs on the CPU; choose sim=gpu, or device=cuda for the learner alone"
            checks.require(self.device == "cpu", "sim.device", self.device, remedy)


def check_backend(backend: str) -> None:
    """Raise ConfigError unless ``backend`` is the name of a simulator."""
    remedy = f"choose one of {', '.join(BACKENDS)}, {AUTO}"
    checks.require(backend in BACKENDS, "sim.backend", backend, remedy)
