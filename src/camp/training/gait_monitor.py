"""Gait accuracy during training, measured from foot contacts, never by a discriminator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from camp.common.averages import Averages
from camp.common.tensors import copied
from camp.data import Step
from camp.gaits.skills import Skill, performed
from camp.metrics.gait import measure_gait

MAX_READ = 256  # robots per reading; the metric costs some 0.1 ms each


def accuracies(metrics: Mapping[str, object], num_skills: int) -> list[float]:
    """Of a reading: each skill's, 0 for one that no robot followed long enough; empty where there is no reading."""
    names = [name for name in metrics if name.startswith("gait/") and name.endswith("/accuracy")]
    values = [value for name in names if isinstance(value := metrics[name], float)]
    return values + [0.0] * (num_skills - len(values)) if values else []


def mean_accuracy(metrics: Mapping[str, object], num_skills: int) -> float | None:
    """The mean of a reading's `accuracies`; None where there is no reading."""
    read = accuracies(metrics, num_skills)
    return sum(read) / len(read) if read else None


class GaitMonitor:
    """Keeps the last foot contacts of every robot and compares the gait they show with the commanded one.

    Args:
        skills: in label order.
        num_envs: N.
        window_s: s of contacts that a reading looks at; a robot counts once it has followed one skill for that long.
        period_s: control period in s.
        device: where the environment's tensors live.
    """

    def __init__(self, skills: Sequence[Skill], num_envs: int, window_s: float, period_s: float, device: torch.device):
        self.skills = tuple(skills)
        self._period = period_s
        steps = round(window_s / period_s)
        self._contact = torch.zeros(steps, num_envs, 4, dtype=torch.bool, device=device)  # ring buffer
        self._skill = torch.full((num_envs,), -1, dtype=torch.int64, device=device)
        self._steady = torch.zeros(num_envs, dtype=torch.int64, device=device)  # steps under one skill
        self._next = 0

    def add(self, step: Step) -> None:
        """Take in one control step."""
        self._contact[self._next] = step.foot_contact
        self._next = (self._next + 1) % len(self._contact)
        same = step.skill == self._skill
        steady = torch.where(same, self._steady + 1, torch.ones_like(self._steady))
        self._steady = steady.masked_fill(step.terminated | step.truncated, 0)
        self._skill = step.skill

    def read(self) -> dict[str, float]:
        """Fraction of steady robots that show the commanded gait, per skill; fraction of them that step at all.

        Of all ranks' robots; a skill that none of them follows is left out.
        """
        steady = (self._steady >= len(self._contact)).nonzero().squeeze(1)[:MAX_READ]
        contact = torch.roll(self._contact, -self._next, dims=0)[:, steady].transpose(0, 1)
        measured = measure_gait(contact.cpu().numpy(), self._period)
        shown = performed(measured.label, measured.frequency_hz, self.skills)
        commanded = self._skill[steady].cpu().numpy()
        averages = Averages()
        averages.add("gait/stepping", torch.from_numpy(measured.stepping.all(axis=1)))
        for label, skill in enumerate(self.skills):
            right = shown[commanded == label] == skill.name
            averages.add(f"gait/{skill.name}/accuracy", torch.from_numpy(right))
        return averages.result()

    def state_dict(self) -> dict[str, Any]:
        return {"contact": self._contact, "skill": self._skill, "steady": self._steady, "next": self._next}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        self._contact.copy_(state["contact"])
        self._skill, self._steady = (copied(state[name], self._contact.device) for name in ("skill", "steady"))
        self._next = state["next"]
