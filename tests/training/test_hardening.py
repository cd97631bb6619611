"""The curriculum of conditions: which way it goes, what it reaches, and that a resumed run has it."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from camp.build import build_env, build_training
from camp.common.bounds import check_numbers
from camp.common.errors import ConfigError
from camp.envs.config import HardeningConfig
from camp.envs.randomization import randomization_at
from camp.training.hardening import next_difficulty
from camp.training.runner import Runner

CONFIG = HardeningConfig(initial=0.0, step=0.1, accuracy_up=0.9, falls_per_1000_steps=1.0, accuracy_down=0.7)


def reading(*accuracy: float, falls: float = 0.5) -> dict[str, object]:
    gaits: dict[str, object] = {f"gait/skill{i}/accuracy": value for i, value in enumerate(accuracy)}
    return gaits | {"env/falls_per_1000_steps": falls, "gait/stepping": 0.0}


@pytest.mark.parametrize(
    ("metrics", "expected"),
    [
        (reading(0.95, 0.9), 0.6),  # the gaits hold
        (reading(0.95, 0.9, falls=1.5), 0.5),  # they do, but robots fall
        (reading(1.0, 0.6), 0.5),  # in between
        (reading(0.9, 0.4), 0.4),  # they are being lost
        (reading(1.0), 0.4),  # nobody follows the other skill for long
        ({"env/falls_per_1000_steps": 0.1, "gait/stepping": 1.0}, 0.5),  # nothing was read
    ],
)
def test_one_reading_moves_the_difficulty_by_a_step(metrics, expected):
    assert next_difficulty(0.5, metrics, CONFIG, num_skills=2) == pytest.approx(expected)


def test_no_skill_may_be_left_behind():
    careful = replace(CONFIG, weakest_up=0.6)
    assert next_difficulty(0.5, reading(1.0, 1.0, 0.8), careful, num_skills=3) == pytest.approx(0.6)
    assert next_difficulty(0.5, reading(1.0, 1.0, 1.0, 0.61), careful, num_skills=4) == pytest.approx(0.6)
    assert next_difficulty(0.5, reading(1.0, 1.0, 1.0, 1.0, 0.59), careful, num_skills=5) == 0.5


def test_difficulty_stays_within_bounds_and_without_a_curriculum_where_it_is():
    assert next_difficulty(0.97, reading(1.0), CONFIG, 1) == 1.0
    assert next_difficulty(0.03, reading(0.1), CONFIG, 1) == 0.0
    assert next_difficulty(1.0, reading(0.1), HardeningConfig(), 1) == 1.0


def test_ranges_close_on_the_nominal_robot(config):
    table = config.env.randomization
    nothing, half = randomization_at(0.0, table), randomization_at(0.5, table)
    assert (nothing.friction, nothing.kp_scale, nothing.payload_mass_kg) == ([0.8, 0.8], [1.0, 1.0], [0.0, 0.0])
    assert half.friction == pytest.approx([0.425, 1.275]) and half.payload_mass_kg == [0.0, 1.5]
    assert half.kd_scale == pytest.approx([0.9, 1.1]) and half.payload_position_m == pytest.approx([-0.05, 0.05])
    assert randomization_at(1.0, table) == table


def test_environment_scales_noise_pushes_and_randomization(config, clips):
    config.env.noise.enabled = config.env.push.enabled = config.env.randomization.enabled = True
    config.env.push.period_s = 0.02
    config.env.hardening.initial = 0.0
    env = build_env(config, clips)

    def noise() -> torch.Tensor:
        return env.observation[:, 21:33] - env.sim.state.joint_velocity

    env.reset(seed=0, options={"stagger": False})
    assert (env.dynamics.kp_scale == 1.0).all() and (env.dynamics.friction == 0.8).all()
    assert noise().abs().max() < 1e-5
    env.difficulty = 0.5
    env.reset(seed=0, options={"stagger": False})
    scale = env.dynamics.kp_scale
    assert 0.9 <= scale.min() < 0.95 and 1.05 < scale.max() <= 1.1
    assert 0.5 < noise().abs().max() <= 0.75 + 1e-5
    before = env.sim.state.base_linear_velocity.clone()
    env._push()
    change = (env.sim.state.base_linear_velocity - before)[:, :2].abs()
    assert 0.1 < change.max() <= 0.25


def test_a_resumed_run_goes_on_as_hard(config, tmp_path):
    config.env.hardening.initial = 0.25
    first, second = (Runner(build_training(config), config, tmp_path) for _ in range(2))
    first.start()
    first.training.env.difficulty = 0.4
    state = first.state()
    second.restore(state)
    assert second.training.env.difficulty == 0.4
    del state.ranks[0]["env"]["difficulty"]  # saved before there was any
    second.restore(state)
    assert second.training.env.difficulty == 1.0


@pytest.mark.parametrize("change", [{"initial": 1.5}, {"step": -0.1}, {"accuracy_down": 0.95}])
def test_values_that_cannot_work_are_refused(change):
    with pytest.raises(ConfigError, match=rf"env\.hardening\.{next(iter(change))}"):
        hardening = HardeningConfig(**({"initial": 0.0} | change))
        check_numbers("env.hardening", hardening)
        hardening.check()
