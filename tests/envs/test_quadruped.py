"""The batched environment: shapes, resets, the moment at which things are taken, clocks and continuation."""

from __future__ import annotations

import copy

import pytest
import torch

from camp.build import build_env
from camp.envs.commands import sample_commands
from camp.envs.config import EXTERNAL
from camp.robots.go2 import GO2
from camp.sim.base import Dynamics
from tests.envs.batched import ZERO, make


def test_shapes_and_spaces(config, clips):
    env = make(config, clips)
    assert env.observation.shape == env.observation_space.shape == (8, 45 + 4)
    step = env.advance(ZERO)
    assert step.transition.shape == (8, 2, 43)
    assert step.privileged.shape == (8, 65)
    observation, reward, terminated, truncated, info = env.step(ZERO)
    assert observation.shape == (8, 49) and reward.shape == terminated.shape == truncated.shape == (8,)
    assert info["final_obs"].shape == (8, 49)


def test_history_holds_the_last_control_steps_the_oldest_first(config, clips):
    config.env.initialization.reference_fraction, config.env.noise.enabled = 0.0, False
    single = make(copy.deepcopy(config), clips)
    config.env.observation.history = 3
    env = make(config, clips)
    assert env.observation.shape == env.observation_space.shape == (8, 3 * 49)
    frames = [single.observation] * 3  # who stands has stood
    for _ in range(4):
        torch.testing.assert_close(env.observation, torch.cat(frames[-3:], dim=1), rtol=0, atol=0)
        step = env.advance(ZERO)
        frames.append(single.advance(ZERO).final_observation)
        torch.testing.assert_close(step.final_observation, torch.cat(frames[-3:], dim=1), rtol=0, atol=0)
        assert not step.terminated.any()
    before = env.observation.clone()
    env.set_command(env.command + 0.1, env.skill)
    assert torch.equal(env.observation[:, :98], before[:, :98])
    torch.testing.assert_close(env.observation[:, 98 + 6 : 98 + 9], before[:, 98 + 6 : 98 + 9] + 0.1)


def test_skill_count_sets_the_observation(config, clips):
    config.motion.skills = ["trot", "bound"]
    assert make(config, clips).observation.shape == (8, 45 + 2)


def test_observation_holds_what_the_table_says(config, clips):
    env = make(config, clips)
    action = 0.1 * torch.randn(8, 12, generator=torch.Generator().manual_seed(0))
    env.advance(action)
    state, pose = env.sim.state, torch.tensor(GO2.default_joint_position)
    torch.testing.assert_close(env.observation[:, 0:3], state.base_angular_velocity)
    torch.testing.assert_close(env.observation[:, 6:9], env.command)
    torch.testing.assert_close(env.observation[:, 9:21], state.joint_position - pose)
    torch.testing.assert_close(env.observation[:, 21:33], state.joint_velocity)
    torch.testing.assert_close(env.observation[:, 33:45], action)
    assert env.observation[:, 45:].argmax(1).tolist() == env.skill.tolist()
    assert (env.observation[:, 45:].sum(1) == 1).all()


def test_hidden_skill_leaves_zeros(config, clips):
    config.env.observe_skill = False
    assert (make(config, clips).observation[:, 45:] == 0).all()


def test_transitions_and_final_observations_are_taken_before_the_reset(config, clips):
    config.env.episode_s = 0.1  # 5 steps
    env = make(config, clips)
    for _ in range(4):
        env.advance(ZERO)
    before = env.motion.newest.clone()
    step = env.advance(ZERO)
    torch.testing.assert_close(step.transition[:, 0], before)
    assert step.truncated.all() and not step.terminated.any()
    # The successor continues the old episode: a control step apart, joints cannot have moved far ...
    assert (step.transition[:, 1, :12] - step.transition[:, 0, :12]).abs().max() < 0.5
    # ... while the state after the reset is another one, and is what the next pair begins with.
    assert not torch.allclose(step.transition[:, 1], env.motion.newest)
    assert not torch.allclose(step.final_observation, step.observation)
    assert (env.step_count == 0).all()
    begin = env.motion.newest.clone()
    torch.testing.assert_close(env.advance(ZERO).transition[:, 0], begin)


def test_an_old_state_continues(config, clips):
    straight, resumed = make(config, clips), make(config, clips)
    state = straight.state_dict()
    state["amp_state"] = state.pop("amp_history")[:, -1]
    state["starts"] = {name: value for name, value in state["starts"].items() if name != "amp_history"}
    del state["num_steps"], state["difficulty"]
    state["starts_sight"] = state.pop("starts_observed") | {"amp_state": straight._pool.starts.amp_history[:, -1]}
    resumed.load_state_dict(state)
    for _ in range(25):
        assert torch.equal(straight.advance(ZERO).transition, resumed.advance(ZERO).transition)


def test_falling_over_terminates_without_truncating(config, clips):
    env = make(config, clips)
    ended = torch.zeros(8, dtype=torch.bool)
    for _ in range(100):
        step = env.advance(torch.full((8, 12), 6.0))
        assert not (step.terminated & step.truncated).any()
        ended |= step.terminated
    assert ended.any()


def test_commands_and_skills_change_on_their_clocks(config, clips):
    config.env.command.period_s, config.env.command.skill_period_s = 0.2, 0.1  # 10 and 5 steps
    env = make(config, clips)
    command, skill = env.command.clone(), env.skill.clone()
    changed_at: dict[str, set[int]] = {"command": set(), "skill": set()}
    for step in range(1, 31):
        env.advance(ZERO)
        if (env.step_count == 0).any():
            break
        if not torch.equal(command, env.command):
            changed_at["command"].add(step)
        if not torch.equal(skill, env.skill):
            changed_at["skill"].add(step)
        command, skill = env.command.clone(), env.skill.clone()
    assert changed_at["command"] and all(step % 10 == 0 for step in changed_at["command"])
    assert changed_at["skill"] and all(step % 5 == 0 for step in changed_at["skill"])


def test_commands_stay_in_range_and_some_are_zero(config):
    command = sample_commands(4000, config.env.command, torch.Generator().manual_seed(0))
    for i, (low, high) in enumerate([(-0.4, 0.9), (-0.25, 0.25), (-0.6, 0.6)]):
        assert command[:, i].min() >= low and command[:, i].max() <= high
        fraction = (command[:, i] == 0).float().mean()
        assert fraction == pytest.approx(1 - (1 - 0.4) * (1 - 0.05), abs=0.03)


def test_randomization_covers_table_one(config, clips):
    config.env.randomization.enabled = True
    config.env.randomization.delay_s = [0.0, 0.025]
    config.sim.num_envs = 64
    dynamics = build_env(config, clips)
    dynamics.reset(seed=1)
    for name, low, high in (
        ("link_mass_scale", 0.8, 1.2),
        ("payload_mass", 0.0, 3.0),
        ("payload_position", -0.1, 0.1),
        ("friction", 0.05, 1.75),
        ("motor_strength", 0.8, 1.2),
        ("kp_scale", 0.8, 1.2),
        ("kd_scale", 0.8, 1.2),
        ("delay", 0.0, 0.025),
    ):
        values = getattr(dynamics.dynamics, name)
        assert values.min() >= low and values.max() <= high
        assert values.max() - values.min() > 0.8 * (high - low), name


def test_a_reset_can_set_the_dynamics_of_every_robot(config, clips):
    config.env.initialization.reference_fraction = 0.0
    config.env.initialization.joint_position_scale = [1.0, 1.0]
    env = make(config, clips)
    dynamics = Dynamics.nominal(8, 0.8, env.sim.device)
    dynamics.payload_mass[3] = 3.0
    dynamics.friction[:] = torch.linspace(0.4, 1.75, 8)
    env.reset(seed=0, options={"stagger": False, "dynamics": dynamics})
    assert torch.equal(env.dynamics.friction, dynamics.friction)
    for _ in range(50):
        env.advance(ZERO)
    height = env.sim.state.base_position[:, 2]
    assert height[3] < height[[0, 1, 2, 4, 5, 6, 7]].min() - 0.005  # the loaded one sags
    assert torch.equal(env.dynamics.payload_mass, dynamics.payload_mass)  # no episode has ended


def test_sensor_noise_is_bounded_and_spares_the_critic(config, clips):
    config.env.noise.enabled = True
    noisy = make(config, clips)
    config.env.noise.enabled = False
    clean = make(config, clips)
    difference = (noisy.observation - clean.observation).abs()
    assert difference[:, 0:3].max() <= 0.2 and difference[:, 21:33].max() <= 1.5
    assert difference[:, 21:33].max() > 0.5
    assert (difference[:, 33:] == 0).all() and (difference[:, 6:9] == 0).all()
    torch.testing.assert_close(noisy.privileged, clean.privileged)


def test_pushes_change_the_velocity_on_their_clock(config, clips):
    config.env.push.enabled, config.env.push.period_s = True, 0.1
    config.env.push.max_velocity_m_s = 2.0
    pushed = make(config, clips)
    calm = copy.deepcopy(config)
    calm.env.push.max_velocity_m_s = 0.0
    still = make(calm, clips)
    for _ in range(4):
        pushed.advance(ZERO)
        still.advance(ZERO)
    torch.testing.assert_close(pushed.sim.state.base_linear_velocity, still.sim.state.base_linear_velocity)
    pushed.advance(ZERO)
    still.advance(ZERO)
    gap = (pushed.sim.state.base_linear_velocity - still.sim.state.base_linear_velocity)[:, :2].norm(dim=1)
    assert gap.max() > 0.5


@pytest.mark.parametrize(
    "action", [torch.zeros(8, 11), torch.zeros(12), torch.zeros(7, 12), torch.zeros(8, 12).int(), "forward", None]
)
def test_an_action_of_another_shape_or_type_changes_nothing(config, clips, action):
    env, other = make(config, clips), make(config, clips)
    with pytest.raises(ValueError, match=r"action of .*: give floating-point numbers of shape \(8, 12\)"):
        env.step(action)
    assert torch.equal(env.advance(ZERO).observation, other.advance(ZERO).observation) and env.num_steps == 1


def test_the_reward_is_of_the_average_velocity(config, clips):
    config.env.reward.velocity_average_s = 0.4  # a step of .02 s moves the average by a twentieth
    env = make(config, clips)
    torch.testing.assert_close(
        env.average_velocity, env.command * (env.motion.newest[:, 24:27].norm(dim=1) > 0)[:, None]
    )
    before = env.average_velocity
    step = env.advance(ZERO)
    expected = 0.95 * before + 0.05 * step.velocity
    alive = ~(step.terminated | step.truncated)
    torch.testing.assert_close(env.average_velocity[alive], expected[alive])
    error = (step.command - expected)[:, :2].norm(dim=1)
    torch.testing.assert_close(step.reward["linear_velocity"], (-error / 0.15).exp())


def test_same_seed_same_roll_out_and_state_continues_bit_for_bit(config, clips):
    config.env.noise.enabled = config.env.randomization.enabled = config.env.push.enabled = True
    config.env.randomization.delay_s = [0.0, 0.03]
    config.env.episode_s = 0.3
    one, other = make(config, clips), make(config, clips)
    actions = 0.5 * torch.randn(30, 8, 12, generator=torch.Generator().manual_seed(2))
    for action in actions[:15]:
        assert torch.equal(one.advance(action).observation, other.advance(action).observation)
    resumed = build_env(config, clips)
    resumed.load_state_dict(one.state_dict())
    for action in actions[15:]:
        a, b = one.advance(action), resumed.advance(action)
        for name in (
            "observation",
            "privileged",
            "transition",
            "task_reward",
            "terminated",
            "skill",
            "foot_contact",
        ):
            assert torch.equal(getattr(a, name), getattr(b, name)), name


def test_commands_from_outside_stay_until_others_are_given(config, clips):
    config.env.command.source = EXTERNAL
    config.env.command.period_s = config.env.command.skill_period_s = 0.04  # of a clock that does not count
    config.env.episode_s = 0.1  # 5 steps
    env = make(config, clips)
    command, skill = torch.tensor([[0.3, 0.0, 0.1]]).repeat(8, 1), torch.arange(8) % 4
    assert torch.equal(env.set_command(command, skill)[:, 6:9], command)
    for _ in range(12):  # over two ends of episodes
        step = env.advance(ZERO)
        assert torch.equal(step.command, command) and torch.equal(step.skill, skill)
        assert torch.equal(step.observation[:, 6:9], command)
        assert step.observation[:, 45:].argmax(1).tolist() == skill.tolist()
