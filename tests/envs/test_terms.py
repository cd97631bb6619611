"""Reward terms and observation entries by name: numbers worked by hand, and errors that name the remedy."""

from __future__ import annotations

import pytest
import torch
from omegaconf import OmegaConf

from camp.build import build_env
from camp.common.errors import CampError
from camp.config.compose import compose_config
from camp.config.hydra_errors import INPUT_ERRORS, diagnosis
from camp.envs.config import ObservationConfig
from camp.envs.measurement import Measurement, sliding_speed
from camp.envs.observations import entries_of, observe
from camp.envs.rewards import TERMS, active_terms, reward_term, task_rewards
from camp.envs.situation import Before, Setup, Situation
from camp.robots.go2 import GO2
from camp.robots.kinematics import foot_position
from camp.sim.base import Dynamics


@pytest.fixture
def situation() -> Situation:
    """Two robots in the default pose, at rest but for what a test changes."""
    joints = torch.tensor(GO2.default_joint_position).repeat(2, 1)
    measurement = Measurement(
        base_position=torch.tensor([[0.0, 0.0, 0.3]]).repeat(2, 1),
        linear_velocity=torch.zeros(2, 3),
        angular_velocity=torch.zeros(2, 3),
        gravity=torch.tensor([[0.0, 0.0, -1.0]]).repeat(2, 1),
        joint_position=joints,
        joint_velocity=torch.zeros(2, 12),
        foot_position=foot_position(GO2.leg, joints),
        foot_contact=torch.tensor([[True] * 4, [True, False, False, False]]),
        body_force=torch.zeros(2, 5),
    )
    return Situation(
        setup=Setup(GO2, 4, True, 0.25, 0.02),
        measurement=measurement,
        command=torch.zeros(2, 3),
        skill=torch.tensor([2, 0]),
        last_action=torch.zeros(2, 12),
        average_velocity=torch.zeros(2, 3),
        dynamics=Dynamics.nominal(2, 0.8, torch.device("cpu")),
        before=Before(torch.zeros(2, 12), torch.zeros(2, 12)),
    )


def test_terms_by_hand(situation):
    measured = situation.measurement
    situation.last_action[0, 0], situation.last_action[1, 2] = 0.4, -40.0  # .1 rad; beyond the calf's limit
    measured.joint_velocity[0, 0] = 0.5
    measured.linear_velocity[:] = torch.tensor([0.3, 0.4, -0.2])
    measured.angular_velocity[0] = torch.tensor([1.0, 2.0, 3.0])
    measured.gravity[1] = torch.tensor([0.6, 0.0, -0.8])
    torque = 30.0 * 0.1 - 1.0 * 0.5  # N m
    expected = {
        "torque": [torque**2, 45.43**2],
        "power": [torque * 0.5, 0.0],
        "action_rate": [0.16, 1600.0],
        "joint_acceleration": [25.0**2, 0.0],
        "vertical_velocity": [0.04, 0.04],
        "roll_pitch_rate": [5.0, 0.0],
        "tilt": [0.0, 0.36],
    }
    for name, values in expected.items():
        torch.testing.assert_close(TERMS[name](situation), torch.tensor(values), msg=name)


def test_a_foot_slips_while_it_is_in_contact(situation):
    situation.measurement.linear_velocity[:] = torch.tensor([0.3, 0.4, 0.0])
    torch.testing.assert_close(sliding_speed(GO2, situation.measurement), torch.full((2, 4), 0.5))
    torch.testing.assert_close(TERMS["foot_slip"](situation), torch.tensor([4 * 0.25, 0.25]))


def test_every_shipped_term_is_in_the_configuration_and_vanishes_at_rest(situation):
    terms = compose_config([]).env.reward.terms
    assert list(terms) == list(TERMS)
    assert list(active_terms(terms)) == ["linear_velocity", "angular_velocity"]
    for name in list(TERMS)[2:]:
        assert (TERMS[name](situation) == 0.0).all(), name


def test_a_term_without_a_number_counts_nothing(situation):
    situation.measurement.linear_velocity[0, 2], situation.measurement.linear_velocity[1, 2] = torch.nan, 1e30
    terms = active_terms({"vertical_velocity": {"weight": -1.0}})
    assert task_rewards(terms, situation)["vertical_velocity"].tolist() == [0.0, 0.0]


def test_the_environment_pays_a_term_by_its_weight(config, clips):
    plain = build_env(config, clips)
    config.env.reward.terms["action_rate"] = {"weight": -0.5}
    paid = build_env(config, clips)
    for env in (plain, paid):
        env.reset(seed=0, options={"stagger": False})
    action = 0.3 * torch.randn(8, 12, generator=torch.Generator().manual_seed(0))
    before = paid.last_action
    one, other = plain.advance(action), paid.advance(action)
    rate = (action - before).square().sum(dim=1)
    assert "action_rate" not in one.reward
    torch.testing.assert_close(other.reward["action_rate"], rate)
    torch.testing.assert_close(other.task_reward, one.task_reward - 0.5 * rate)


def test_no_term_at_all_is_no_reward(config, clips):
    config.env.reward.terms = {}
    env = build_env(config, clips)
    env.reset(seed=0)
    assert (env.advance(torch.zeros(8, 12)).task_reward == 0.0).all()


def test_a_name_is_taken_once():
    with pytest.raises(ValueError, match="'torque': this name is taken"):
        reward_term(TERMS["torque"])

    def style(s: Situation):
        return s.command[:, 0]

    with pytest.raises(ValueError, match="'style': this name is taken"):
        reward_term(style)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("env.reward.terms.torqe.weight=1", "env.reward.terms.torqe: unknown key"),
        (
            "+env.reward.terms.torqe.weight=1",
            "env.reward.terms.torqe: no such reward term; choose from linear_velocity",
        ),
        ("+env.reward.terms.torque.width=1", "env.reward.terms.torque.width: no such parameter; this term has weight"),
        ("~env.reward.terms.linear_velocity.width", "env.reward.terms.linear_velocity: lacks width"),
        ("env.reward.terms.linear_velocity.width=0", "choose a number from 1e-06 to 1e+06"),
        ("env.reward.terms.torque.weight=much", "env.reward.terms.torque.weight = 'much': choose a number"),
        ("env.reward.terms.torque.weight=true", "choose a number"),
        ("env.reward.terms.torque.weight=inf", "= inf: choose a number from -1e+06 to 1e+06"),
        ("env.reward.terms.torque=3", "env.reward.terms.torque"),
        ("env.reward.terms.torque=null", "env.reward.terms.torque"),
        ("env.observation.policy=[gyro]", "env.observation.policy: no such entry 'gyro'; choose from base_angular_vel"),
        ("env.observation.critic=[gyro]", "env.observation.critic: no such entry 'gyro'"),
        ("env.observation.policy=[]", "name one entry or more"),
        ("env.observation.policy=[gravity,gravity]", "each once"),
        ("env.command.source=joystick", "env.command.source = 'joystick': choose clock or external"),
    ],
)
def test_what_cannot_be_is_one_line(override, words):
    with pytest.raises((CampError, *INPUT_ERRORS)) as caught:
        compose_config([override])
    line = str(caught.value) if isinstance(caught.value, CampError) else diagnosis(caught.value)
    assert "\n" not in line and words in line


def test_old_names_of_the_weights_reach_the_terms():
    terms = compose_config(["env.reward.linear_velocity_weight=2", "env.reward.angular_velocity_width=0.3"]).env.reward
    assert terms.terms["linear_velocity"] == {"weight": 2, "width": 0.15}
    assert terms.terms["angular_velocity"] == {"weight": 0.75, "width": 0.3}


def test_what_old_run_folders_observed_is_what_is_configured():
    assert OmegaConf.structured(compose_config(["run=smoke"]).env.observation) == OmegaConf.structured(
        ObservationConfig()
    )


def test_entries_in_the_order_of_their_names(situation, config, clips):
    situation.last_action[0, 0] = 0.4
    seen = observe(entries_of(["skill", "base_height", "last_action"], 4), situation)
    assert seen.shape == (2, 17)
    assert seen[0, :6].tolist() == pytest.approx([0.0, 0.0, 1.0, 0.0, 0.3, 0.4])
    config.env.observation.policy = ["gravity", "joint_position", "foot_contact"]
    config.env.observation.critic = ["base_height"]
    env = build_env(config, clips)
    env.reset(seed=0)
    step = env.advance(torch.zeros(8, 12))
    assert step.observation.shape == (8, 3 + 12 + 4) and step.privileged.shape == (8, 1)
