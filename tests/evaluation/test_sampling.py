"""Random commands and starts from the suite's seed; every switch once."""

from __future__ import annotations

from itertools import pairwise

import pytest
import torch

from camp.common.seeding import generator
from camp.evaluation.contract import CommandRange
from camp.evaluation.plan import Planner
from camp.evaluation.sampling import clipped, random_commands, switch_sequences, walk_starts
from camp.gaits.skills import skill_set
from camp.motion.clips.sampler import ReferenceStates
from camp.robots.go2 import GO2
from tests.evaluation.suites import evaluation

SKILLS = skill_set(("trot", "bound"), "gait_frequency", (2.0, 3.0))


@pytest.fixture(scope="module")
def references(clips):
    return ReferenceStates([clip for clip in clips if clip.frequency_hz in (2.0, 3.0)], SKILLS)


def planner(references, *overrides: str, allowed: CommandRange | None = None) -> Planner:
    return Planner(evaluation(*overrides), GO2, SKILLS, 0.02, allowed, references)


@pytest.mark.parametrize(("skills", "length"), [(2, 4), (4, 4), (8, 4), (12, 5)])
def test_every_switch_happens_exactly_once(skills, length):
    sequences = switch_sequences(skills, length)
    switches = [pair for sequence in sequences for pair in pairwise(sequence) if pair[0] != pair[1]]
    assert len(switches) == len(set(switches)) == skills * (skills - 1)
    assert {len(sequence) for sequence in sequences} == {length}


def test_one_skill_has_nothing_to_switch_to():
    assert switch_sequences(1, 4) == [[0, 0, 0, 0]]


def test_commands_are_as_distributed_and_the_policy_is_asked_for_nothing_beyond_its_range():
    config = evaluation().random_commands
    command = random_commands(4000, config, None, generator(0, "test"))
    assert command[:, 0].min() >= -0.4 and command[:, 0].max() <= 0.9 and command[:, 0].max() > 0.85
    assert (command == 0).all(dim=1).float().mean() == pytest.approx(0.05 + 0.95 * 0.4**3, abs=0.02)
    assert (command[:, 1] == 0).float().mean() == pytest.approx(0.05 + 0.95 * 0.4, abs=0.03)
    allowed = CommandRange((0.0, 0.5), (0.0, 0.0), (-0.1, 0.1))
    own = clipped(command, allowed)
    assert own[:, 0].min() == 0.0 and own[:, 0].max() == 0.5 and not own[:, 1].any()
    assert (random_commands(4000, config, None, generator(0, "test")) == command).all()


def test_half_the_walks_start_in_the_stride_of_another_gait(references):
    label = torch.arange(4).repeat_interleave(200)
    starts = walk_starts(GO2, label, evaluation().walks, references, generator(0, "test"))
    pose = torch.tensor(GO2.default_joint_position)
    still = starts.initial.base_linear_velocity.norm(dim=1) == 0
    assert still.float().mean() == pytest.approx(0.5, abs=0.06)
    assert ((starts.initial.joint_position[still] / pose)[:, 1].sub(1).abs() <= 0.2 + 1e-6).all()
    assert starts.initial.base_linear_velocity[~still].norm(dim=1).mean() > 0.1
    # A trot's frames have the diagonal legs in phase, a bound's the front pair; asked to bound, robots start trotting.
    trotting = starts.initial.joint_position[~still & (label >= 2)]
    diagonal = (trotting[:, 1] - trotting[:, 10]).abs().mean()
    assert diagonal < (trotting[:, 1] - trotting[:, 4]).abs().mean()


def test_plans_repeat_and_do_not_depend_on_each_other(references):
    first, second = planner(references), planner(references, "robustness.per_skill=1", "table_i.per_skill=3")
    assert (first.walks(5, "walks").command == second.walks(5, "walks").command).all()
    assert (first.walks(5, "walks").command != first.walks(5, "table_i").command).any()
    assert len(second.table_i()) == 12 and second.table_i().disturbances.noise.tolist() == [1.0] * 12
    friction = second.table_i().dynamics.friction
    assert friction.unique().numel() == 12 and friction.min() >= 0.05 and friction.max() <= 1.75


def test_the_same_walks_under_every_condition(references):
    plan = planner(
        references, "robustness.per_skill=2", "robustness.conditions=[{name: a},{name: b,delay_s: 0.01,loss: 0.2}]"
    ).robustness()
    assert len(plan) == 16 and (plan.command[:8] == plan.command[8:]).all()
    assert plan.dynamics.delay.tolist() == pytest.approx([0.0] * 8 + [0.01] * 8)
    assert plan.disturbances.loss.tolist() == pytest.approx([0.0] * 8 + [0.2] * 8)


def test_switches_are_distinct(references):
    plan = planner(references).switching()
    rows = set()
    for skill, command in zip(plan.skill.tolist(), plan.command.tolist(), strict=True):
        segments = skill[:: plan.steps // 4]
        rows |= {(a, b, *command) for a, b in pairwise(segments) if a != b}
    assert len(rows) == 4 * 12 and plan.steps == 500


def test_a_narrow_policy_is_told(references):
    assert not planner(references, allowed=CommandRange((-1, 1), (-1, 1), (-1, 1))).clips_commands
    assert planner(references, allowed=CommandRange((0, 1), (-1, 1), (-1, 1))).clips_commands
