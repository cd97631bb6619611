"""What a checkpoint holds, by name: the one place that knows its entries."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from torch import Tensor

from camp.common.errors import CheckpointError
from camp.runs.checkpoint import latest_checkpoint, list_checkpoints, load_checkpoint, readable_before, remedy


@dataclass(frozen=True)
class TrainingState:
    """The networks of a run after ``iteration`` iterations and, unless it was shipped, all that continues them.

    ppo: actor, critic and their optimizers; priors: by name; alarms: their counts; best: iteration and score of the
    best checkpoint so far; ranks: each process's episodes, memories and random streams.
    """

    iteration: int
    ppo: dict[str, Any]
    priors: dict[str, dict[str, Any]]
    alarms: dict[str, int] = field(default_factory=dict)
    best: dict[str, float] = field(default_factory=dict)
    ranks: list[dict[str, Any]] = field(default_factory=list)

    @property
    def actor(self) -> dict[str, Any]:
        """The policy network and its normalizer."""
        return self.ppo["actor"]

    @property
    def skill_prior(self) -> dict[str, Any] | None:
        """The skill discriminator; None where an ablation trained without."""
        return self.priors.get("skill")

    @property
    def is_shipped(self) -> bool:
        """Whether only what acts and what is analysed was kept."""
        return "critic" not in self.ppo

    def shipped(self) -> TrainingState:
        """Actor and skill discriminator alone, without Adam's moments."""
        skill = self.skill_prior
        priors = {} if skill is None else {"skill": skill | {"optimizer": skill["optimizer"] | {"state": {}}}}
        return TrainingState(self.iteration, {"actor": self.actor}, priors)

    def not_finite(self) -> str | None:
        """The first entry of the networks, such as ``ppo.actor.network.0.weight``, with a value that is not finite."""
        for name, tensor in _tensors({"ppo": self.ppo, "priors": self.priors}):
            if tensor.is_floating_point() and not tensor.isfinite().all():
                return name
        return None

    def as_dict(self) -> dict[str, Any]:
        """Plain values and tensors, as `camp.runs.checkpoint.save_checkpoint` takes them."""
        state = {"iteration": self.iteration, "ppo": self.ppo, "priors": self.priors}
        return state if self.is_shipped else state | {"alarms": self.alarms, "best": self.best, "ranks": self.ranks}

    @classmethod
    def from_dict(cls, state: Mapping[str, Any]) -> Self:
        """Raises ValueError, naming the entry, where one is missing or of another type."""
        ppo = _entry(state, "ppo", dict)
        _entry(ppo, "actor", dict, "ppo.")
        priors = _entry(state, "priors", dict)
        for name in priors:
            _entry(priors, name, dict, "priors.")
        iteration = _entry(state, "iteration", int)
        if iteration < 0:
            raise ValueError(f"entry iteration is {iteration}")
        parts: dict[str, Any] = {}
        if "critic" in ppo:
            # Checkpoints of earlier versions lack these: they can be evaluated, not continued.
            parts["alarms"] = _entry(state, "alarms", dict) if "alarms" in state else {}
            parts["best"] = _entry(state, "best", dict) if "best" in state else {}
            parts["ranks"] = _entry(state, "ranks", list) if "ranks" in state else []
            for number, rank in enumerate(parts["ranks"]):
                if not isinstance(rank, dict):
                    raise ValueError(f"entry ranks[{number}] is of type {type(rank).__name__}, not dict")
        return cls(iteration, ppo, priors, **parts)


def load_state(run: Path) -> TrainingState:
    """The state in the latest checkpoint of a run folder, on the CPU.

    Raises CheckpointError in one line where it is missing, damaged, not built as expected, or holds networks that are
    not finite; the line names the last good checkpoint before it, where there is one.
    """
    path = latest_checkpoint(run)
    content = load_checkpoint(path)
    try:
        state = TrainingState.from_dict(content)
    except ValueError as error:
        raise CheckpointError(f"checkpoint {path}: {error}; {remedy(_last_good(path))}") from error
    entry = state.not_finite()
    if entry is not None:
        raise CheckpointError(
            f"checkpoint {path}: training had diverged ({entry} is not finite); {remedy(_last_good(path))}"
        )
    return state


def diverged(run: Path, iteration: int, entry: str) -> CheckpointError:
    """What to raise instead of saving networks with an ``entry`` that is not finite."""
    found = list_checkpoints(run)
    last = f"the last good checkpoint is {found[-1]}" if found else "no checkpoint was saved before"
    return CheckpointError(
        f"iteration {iteration}: training has diverged ({entry} is not finite), so it stops and saves nothing more; "
        f"{last}; train anew with a lower algo.ppo.max_learning_rate, algo.style.learning_rate or "
        "algo.skill.learning_rate"
    )


def _last_good(path: Path) -> Path | None:
    """The newest checkpoint before ``path`` that can be used."""
    for candidate, content in readable_before(path):
        with contextlib.suppress(ValueError):
            if TrainingState.from_dict(content).not_finite() is None:
                return candidate
    return None


def _entry(values: Mapping[str, Any], name: str, kind: type, prefix: str = "") -> Any:
    if name not in values:
        raise ValueError(f"no entry {prefix}{name}")
    value = values[name]
    if not isinstance(value, kind) or isinstance(value, bool):
        raise ValueError(f"entry {prefix}{name} is of type {type(value).__name__}, not {kind.__name__}")
    return value


def _tensors(value: Any, name: str = "") -> Iterator[tuple[str, Tensor]]:
    if isinstance(value, Tensor):
        yield name, value
    elif isinstance(value, Mapping):
        for key, part in value.items():
            yield from _tensors(part, f"{name}.{key}" if name else str(key))
    elif isinstance(value, (list, tuple)):
        for index, part in enumerate(value):
            yield from _tensors(part, f"{name}[{index}]")
