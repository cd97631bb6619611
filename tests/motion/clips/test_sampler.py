"""Sampling from clips whose every number tells which clip and frame it is from."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from camp.common.errors import ClipError
from camp.gaits.skills import Skill, skill_set
from camp.motion.clips.clip import Clip, amp_state
from camp.motion.clips.sampler import Demonstrations, ReferenceStates, transitions
from camp.robots.quadruped import FOOT_NAMES, JOINT_NAMES

SKILLS = skill_set(("trot", "pace", "bound"), "gait", ())


def rng(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def make_clip(number: int, gait: str, frames: int = 20, dt: float = 0.02, varying_command: bool = False) -> Clip:
    """Every quantity of frame t is 100 * number + t, and half a unit more for applied targets."""
    stamp = (100.0 * number + np.arange(frames)).astype(np.float32)

    def filled(*shape: int) -> np.ndarray:
        return np.broadcast_to(stamp.reshape(-1, *[1] * len(shape)), (frames, *shape)).copy()

    command = filled(3) if varying_command else np.full(3, number, dtype=np.float32)
    return Clip(
        dt=dt,
        gait=gait,
        frequency_hz=2.0,
        command=command,
        base_position=filled(3),
        base_quaternion=filled(4),
        joint_position=filled(12),
        joint_velocity=filled(12),
        base_linear_velocity=filled(3),
        base_angular_velocity=filled(3),
        foot_position=filled(4, 3),
        foot_velocity=filled(4, 3),
        foot_contact=np.ones((frames, 4), dtype=bool),
        joint_target=filled(12),
        joint_target_applied=filled(12) + np.float32(0.5),
        joint_torque=filled(12),
        joint_names=JOINT_NAMES,
        foot_names=FOOT_NAMES,
    )


def make_clips() -> list[Clip]:
    """Pace has one short clip, trot two, bound one; every clip has its own number."""
    return [
        make_clip(0, "trot"),
        make_clip(1, "pace", frames=5),
        make_clip(2, "trot", frames=30),
        make_clip(3, "bound", varying_command=True),
    ]


CLIP_SKILL = {0: 0, 1: 1, 2: 0, 3: 2}


def test_pairs_are_consecutive_and_never_cross_a_clip():
    demonstrations = Demonstrations(make_clips(), SKILLS, 1000, rng())
    sample = demonstrations.sample(6000, rng(1))
    assert sample.state.shape == (6000, 2, 43) and sample.state.dtype == torch.float32
    first, second = sample.state[:, 0, 0], sample.state[:, 1, 0]
    assert (second - first == 1.0).all()
    assert (first // 100 == second // 100).all()


def test_labels_belong_to_the_clip():
    sample = Demonstrations(make_clips(), SKILLS, 1000, rng()).sample(600, rng(1))
    number = (sample.state[:, 0, 0] // 100).long()
    expected = torch.tensor([CLIP_SKILL[n] for n in number.tolist()])
    assert torch.equal(sample.skill, expected)


@pytest.mark.parametrize("n", [300, 301])
def test_skills_are_balanced_however_few_clips_they_have(n: int):
    sample = Demonstrations(make_clips(), SKILLS, 1000, rng()).sample(n, rng(1))
    counts = sample.skill.bincount(minlength=3)
    assert counts.max() - counts.min() <= 1


def test_every_transition_can_come_up_and_within_a_skill_all_are_equally_likely():
    sample = Demonstrations(make_clips(), SKILLS, 1000, rng()).sample(30_000, rng(1))
    trot = sample.state[sample.skill == 0][:, 0, 0].long()
    counts = trot.bincount()
    counts = counts[counts > 0]
    assert len(counts) == 19 + 29
    expected = 10_000 / 48
    assert (counts - expected).abs().max() < 5 * math.sqrt(expected)


def test_preloading_takes_the_asked_share_of_each_skill_without_repetition():
    demonstrations = Demonstrations(make_clips(), SKILLS, 30, rng())
    counts = demonstrations.transition.skill.bincount(minlength=3)
    assert counts.tolist() == [10, 4, 10]  # pace has four transitions, all of them taken
    first = demonstrations.transition.state[:, 0, 0]
    assert len(first.unique()) == len(demonstrations) == 24
    assert demonstrations.memory_bytes == 24 * (2 * 43 * 4 + 8)


def test_preloading_and_sampling_follow_their_generators():
    left, right = (Demonstrations(make_clips(), SKILLS, 12, rng(3)) for _ in range(2))
    assert torch.equal(left.transition.state, right.transition.state)
    assert torch.equal(left.sample(10, rng(4)).state, right.sample(10, rng(4)).state)
    other = Demonstrations(make_clips(), SKILLS, 12, rng(5))
    assert not torch.equal(left.transition.state, other.transition.state)


def test_transitions_hold_the_states_of_their_ages():
    state = torch.arange(10.0)[:, None]
    found = transitions(state, (5, 2, 0))
    assert found.shape == (5, 3, 1)
    assert found[:, :, 0].tolist() == [[t - 5, t - 2, t] for t in range(5, 10)]
    assert torch.equal(transitions(state, (1, 0)), torch.stack([state[:-1], state[1:]], dim=1))


def test_demonstrations_look_back_within_one_clip():
    demonstrations = Demonstrations(make_clips(), SKILLS, 1000, rng(), ages=(4, 1, 0))
    assert len(demonstrations) == sum(len(clip) - 4 for clip in make_clips())
    stamp = demonstrations.transition.state[:, :, 0]
    assert (stamp[:, 2] - stamp[:, 1] == 1).all() and (stamp[:, 2] - stamp[:, 0] == 4).all()
    assert (stamp[:, 2] // 100 == stamp[:, 0] // 100).all()


def test_reference_states_know_their_past():
    state = ReferenceStates(make_clips(), SKILLS, history=4).sample(torch.tensor([0, 1, 2] * 200), rng())
    stamp = state.amp_history[:, :, 0]
    assert stamp.shape == (600, 4) and (stamp.diff(dim=1) == 1).all()
    assert torch.equal(stamp[:, -1], state.joint_position[:, 0])
    assert torch.equal(stamp[:, -1] - 0.5, state.joint_target_applied_previous[:, 0])
    assert set((stamp[:, -1] % 100).tolist()) <= set(range(3, 30))


def test_a_path_ends_with_the_drawn_state():
    references = ReferenceStates(make_clips(), SKILLS, history=2, observed=4)
    label = torch.tensor([0, 1, 2] * 200)
    path, drawn = references.sample_path(label, rng()), references.sample(label, rng())
    stamp = torch.stack([state.base_height for state in path], dim=1)
    assert stamp.shape == (600, 4) and (stamp.diff(dim=1) == 1).all()
    assert torch.equal(stamp[:, -1], drawn.base_height)
    assert set((stamp[:, 0] % 100).tolist()) <= set(range(1, 27))  # a first frame has no previous target
    assert torch.equal(path[0].joint_target_applied_previous[:, 0], stamp[:, 0] - 0.5)


def test_a_clip_shorter_than_the_history_is_refused():
    with pytest.raises(ClipError, match=r"pace with 5 frames: too short for env\.transition_ages"):
        ReferenceStates(make_clips(), SKILLS, history=6)


def test_states_are_the_amp_states_of_the_clip():
    clip = make_clip(0, "trot", frames=3)
    demonstrations = Demonstrations([clip], (Skill("trot"),), 100, rng())
    order = demonstrations.transition.state[:, 0, 0].argsort()
    state = torch.from_numpy(amp_state(clip))
    assert torch.equal(demonstrations.transition.state[order], torch.stack([state[:-1], state[1:]], dim=1))


def test_a_skill_without_clips_is_named_with_the_remedy():
    skills = (*SKILLS, Skill("pronk"))
    with pytest.raises(ClipError, match=r"'pronk'.*they show: bound at 2 Hz.*take it out of motion\.skills"):
        Demonstrations(make_clips(), skills, 10, rng())
    with pytest.raises(ClipError, match=r"'pronk'.*they show: bound at 2 Hz.*take it out of motion\.skills"):
        ReferenceStates(make_clips(), skills)


def test_unequal_frame_rates_are_refused():
    with pytest.raises(ClipError, match="dt"):
        Demonstrations([make_clip(0, "trot"), make_clip(1, "trot", dt=0.01)], (Skill("trot"),), 10, rng())


def test_reference_states_belong_together_and_never_are_a_first_frame():
    skill = torch.arange(3000) % 3
    state = ReferenceStates(make_clips(), SKILLS).sample(skill, rng())
    stamp = state.base_height
    assert all(CLIP_SKILL[int(s) // 100] == k for s, k in zip(stamp.tolist(), skill.tolist(), strict=True))
    assert (stamp % 100 >= 1).all()
    for values, width in (
        (state.base_quaternion, 4),
        (state.joint_position, 12),
        (state.joint_velocity, 12),
        (state.base_linear_velocity, 3),
        (state.base_angular_velocity, 3),
    ):
        assert values.shape == (3000, width)
        assert (values == stamp.unsqueeze(1)).all()
    # What the PD received in the step before: row t - 1, perturbation included.
    assert (state.joint_target_applied_previous == stamp.unsqueeze(1) - 1.0 + 0.5).all()


def test_reference_commands_are_those_of_the_frame():
    state = ReferenceStates(make_clips(), SKILLS).sample(torch.tensor([2] * 50 + [1] * 50), rng())
    assert (state.command[:50] == state.base_height[:50].unsqueeze(1)).all()  # one command per frame
    assert (state.command[50:] == 1.0).all()  # one command per clip


def test_reference_states_choose_the_clip_before_the_frame():
    state = ReferenceStates(make_clips(), SKILLS).sample(torch.zeros(4000, dtype=torch.int64), rng())
    in_first = (state.base_height < 100).float().mean()
    assert in_first.item() == pytest.approx(0.5, abs=0.04)  # 19 frames against 29 would give .4
    seen = state.base_height.unique()
    assert len(seen) == 19 + 29 and seen.max() == 229.0
