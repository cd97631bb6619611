"""Sampling from expert clips: transitions for discriminators, states for reference-state initialization."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from camp.common.errors import ClipError
from camp.data import Transition
from camp.gaits.skills import Skill, label_of
from camp.motion.clips.clip import Clip, discriminator_state

CONSECUTIVE = (1, 0)  # ages in frames of the paper's (s_t, s_{t+1})


def _by_skill(clips: Sequence[Clip], skills: Sequence[Skill]) -> list[list[Clip]]:
    """Clips per skill, in label order. Raises ClipError where a skill has none or the frame rates differ."""
    labels = [label_of(clip.gait, clip.frequency_hz, skills) for clip in clips]
    groups = [
        [clip for clip, label in zip(clips, labels, strict=True) if label == index] for index in range(len(skills))
    ]
    for skill, group in zip(skills, groups, strict=True):
        if not group:
            found = ", ".join(sorted({f"{clip.gait} at {clip.frequency_hz:g} Hz" for clip in clips})) or "none"
            raise ClipError(
                f"skill {skill.name!r}: none of the {len(clips)} clips shows it (they show: {found}); "
                "take it out of motion.skills and motion.frequencies_hz, or add a clip of it"
            )
    periods = sorted({round(clip.dt, 6) for group in groups for clip in group})
    if len(periods) > 1:
        raise ClipError(f"clip dt = {periods} s: transitions must be equally spaced; resample to one period")
    return groups


def transitions(state: Tensor, ages: Sequence[int]) -> Tensor:
    """All transitions of one motion: states (T, S) and ages in frames, oldest first -> (T - ages[0], F, S)."""
    oldest, frames = ages[0], len(state)
    return torch.stack([state[oldest - age : frames - age] for age in ages], dim=1)


def _tensor(values: np.ndarray, device: torch.device | str) -> Tensor:
    return torch.as_tensor(np.ascontiguousarray(values, dtype=np.float32), device=device)


class Demonstrations:
    """Expert transitions, drawn before training and kept in memory (the paper's transition preloading)."""

    def __init__(
        self,
        clips: Sequence[Clip],
        skills: Sequence[Skill],
        num_preloaded: int,
        generator: torch.Generator,
        device: torch.device | str = "cpu",
        ages: Sequence[int] = CONSECUTIVE,
    ) -> None:
        """Draws num_preloaded / K transitions of each skill, uniformly and without repetition.

        Transitions never reach across a clip's end. A skill whose clips hold fewer transitions gives all of them;
        `sample` stays balanced. generator: on the CPU; ages: as in `transitions`. Raises ClipError for a skill
        without clips or unequal frame rates.
        """
        fraction = max(1, num_preloaded // len(skills))
        state, skill, counts = [], [], []
        for label, group in enumerate(_by_skill(clips, skills)):
            frames = [torch.from_numpy(discriminator_state(clip)) for clip in group]
            found = torch.cat([transitions(s, ages) for s in frames])  # (M_k, F, S)
            chosen = found[torch.randperm(len(found), generator=generator)[:fraction]]
            state.append(chosen)
            skill.append(torch.full((len(chosen),), label))
            counts.append(len(chosen))
        self.transition = Transition(torch.cat(state), torch.cat(skill)).to(device)
        self.counts = dict(zip((skill.name for skill in skills), counts, strict=True))  # transitions by skill
        self._count = torch.tensor(counts, device=device)  # (K,)
        self._start = self._count.cumsum(0) - self._count  # (K,) first row of each skill

    def __len__(self) -> int:
        return len(self.transition)

    @property
    def memory_bytes(self) -> int:
        """Bytes held by the preloaded transitions."""
        tensors = (self.transition.state, self.transition.skill)
        return sum(t.numel() * t.element_size() for t in tensors)

    def sample(self, n: int, generator: torch.Generator) -> Transition:
        """n transitions with replacement, the same number of each skill (+-1), skills interleaved.

        generator: on the demonstrations' device.
        """
        num_skills = self._count.shape[0]
        skill = torch.arange(n, device=self._count.device) % num_skills
        row = self._start[skill] + _uniform_index(self._count[skill], generator)
        return self.transition.take(row)


@dataclass
class ReferenceState:
    """States of expert motion to start episodes from, and what goes with them."""

    base_height: Tensor  # (n,) m
    base_quaternion: Tensor  # (n, 4) w first
    joint_position: Tensor  # (n, 12) rad
    joint_velocity: Tensor  # (n, 12) rad/s
    base_linear_velocity: Tensor  # (n, 3) m/s, base frame
    base_angular_velocity: Tensor  # (n, 3) rad/s, base frame
    command: Tensor  # (n, 3) vx, vy m/s, wz rad/s that the clip follows at this frame
    joint_target_applied_previous: Tensor  # (n, 12) rad, what the PD received in the step before
    amp_history: Tensor  # (n, A, S) the last A AMP states, its own the last


class ReferenceStates:
    """Draws states for reference-state initialization (Peng et al. 2018)."""

    def __init__(
        self,
        clips: Sequence[Clip],
        skills: Sequence[Skill],
        device: torch.device | str = "cpu",
        history: int = 1,
        observed: int = 1,
    ) -> None:
        """history: A, how many AMP states go with each state; observed: H, how many states `sample_path` gives. Raises
        ClipError for a skill without clips or unequal frame rates, or a clip that is shorter than these."""
        groups = _by_skill(clips, skills)
        self.skills, self.num_skills = tuple(skills), len(groups)
        ordered = [clip for group in groups for clip in group]
        # The first frame of a clip has no previous target, so no row has it; before the first one with a whole history
        # nothing is drawn.
        first = max(observed, history - 1)
        length = [len(clip) - first for clip in ordered]
        if min(length) < 1:
            shortest = min(ordered, key=len)
            raise ClipError(
                f"clip of {shortest.gait} with {len(shortest)} frames: too short for env.transition_ages "
                f"and env.observation.history, which look back {first} frames; choose smaller ones or longer clips"
            )

        def rows(name: str) -> Tensor:
            return _tensor(np.concatenate([getattr(clip, name)[1:] for clip in ordered]), device)

        commands = [np.broadcast_to(clip.command, (len(clip), 3))[1:] for clip in ordered]
        recent = range(history - 1, -1, -1)  # ages of the history's states
        self._frames = ReferenceState(
            base_height=rows("base_position")[:, 2],
            base_quaternion=rows("base_quaternion"),
            joint_position=rows("joint_position"),
            joint_velocity=rows("joint_velocity"),
            base_linear_velocity=rows("base_linear_velocity"),
            base_angular_velocity=rows("base_angular_velocity"),
            command=_tensor(np.concatenate(commands), device),
            joint_target_applied_previous=_tensor(
                np.concatenate([clip.joint_target_applied[:-1] for clip in ordered]), device
            ),
            amp_history=torch.cat(
                [transitions(_continued_back(discriminator_state(clip), recent[0]), recent)[1:] for clip in ordered]
            ).to(device),
        )
        self._observed = observed
        self._length = torch.tensor(length, device=device)  # (C,) frames per clip that are drawn
        kept = torch.tensor([len(clip) - 1 for clip in ordered], device=device)
        self._first_frame = kept.cumsum(0) - kept + first - 1  # (C,) row of the first of them
        self._clips = torch.tensor([len(group) for group in groups], device=device)  # (K,) clips per skill
        self._first_clip = self._clips.cumsum(0) - self._clips  # (K,)

    def sample(self, skill: Tensor, generator: torch.Generator) -> ReferenceState:
        """One state per label in skill (n,): uniformly a clip of that skill, then a frame t >= 1."""
        return self._at(self._draw(skill, generator))

    def sample_path(self, skill: Tensor, generator: torch.Generator) -> list[ReferenceState]:
        """The same with the H - 1 states before it, oldest first."""
        row = self._draw(skill, generator)
        return [self._at(row - age) for age in reversed(range(self._observed))]

    def _draw(self, skill: Tensor, generator: torch.Generator) -> Tensor:
        """(n,) rows."""
        clip = self._first_clip[skill] + _uniform_index(self._clips[skill], generator)
        return self._first_frame[clip] + _uniform_index(self._length[clip], generator)

    def _at(self, row: Tensor) -> ReferenceState:
        return ReferenceState(**{name: values.index_select(0, row) for name, values in vars(self._frames).items()})


def _continued_back(states: np.ndarray, frames: int) -> Tensor:
    """(T + frames, S) as if the first state had lasted so much longer: every row has a history, if not a drawn one."""
    return torch.from_numpy(np.concatenate([states[:1].repeat(frames, axis=0), states]))


def _uniform_index(count: Tensor, generator: torch.Generator) -> Tensor:
    """(n,) int64, each uniform in [0, count); float64, so that no draw rounds up to count."""
    draw = torch.rand(count.shape, generator=generator, device=count.device, dtype=torch.float64)
    return (draw * count).long()
