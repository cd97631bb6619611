"""Every preset and ablation composes; wrong values end in one line with key, value and remedy."""

from __future__ import annotations

import pytest

from camp.compose import compose_config
from camp.config import learner_device, resolve
from camp.errors import ConfigError
from camp.paths import ablation_root, config_root

PRESETS = sorted(path.stem for path in (config_root() / "run").glob("*.yaml"))
ABLATIONS = sorted(path.stem for path in (ablation_root() / "ablation").glob("*.yaml"))


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_composes(preset):
    assert compose_config([f"run={preset}"]).run.iterations >= 1


def test_the_papers_other_gains_compose_without_imitation():
    assert compose_config(["robot=go2_soft", "run=scratch"]).robot.kp == [20.0, 20.0, 20.0]
    with pytest.raises(ConfigError, match=r"robot.kp.*run=scratch"):
        compose_config(["robot=go2_soft"])


@pytest.mark.parametrize("ablation", ABLATIONS)
def test_every_ablation_changes_the_variant_and_little_else(ablation):
    changed = compose_config([f"+ablation={ablation}"])
    assert changed.variant == ablation
    plain = compose_config([])
    differing = [
        name for name in ("sim", "robot", "motion", "run", "logger") if getattr(changed, name) != getattr(plain, name)
    ]
    assert differing == []
    assert (changed.env, changed.algo) != (plain.env, plain.algo)


def test_the_papers_ablations_are_there():
    assert {"no_skill_disc", "no_skill_obs", "no_conditioning", "amp_baseline"} <= set(ABLATIONS)


def test_switches_of_the_baseline():
    baseline = compose_config(["+ablation=amp_baseline"])
    assert not baseline.env.observe_skill
    assert not baseline.algo.style.conditional
    assert not baseline.algo.skill.enabled


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("sim.num_envs=0", ("sim.num_envs", "0", "1 or more")),
        ("sim.backend=quantum", ("sim.backend", "quantum", "cpu")),
        ("env.episode_s=0", ("env.episode_s", "0", "control period")),
        ("env.control_period_s=0.013", ("env.control_period_s", "0.013", "multiple")),
        ("env.command.vx_m_s=[1,-1]", ("env.command.vx_m_s", "[1.0, -1.0]", "low <= high")),
        ("env.randomization.friction=[-1,1]", ("env.randomization.friction", "[-1.0, 1.0]", "low > 0")),
        ("env.initialization.reference_share=1.5", ("reference_share", "1.5", "[0, 1]")),
        ("robot.kp=[30,30]", ("robot.kp", "[30.0, 30.0]", "three")),
        ("motion.skills=[trot,gallop]", ("motion.skills", "gallop", "pronk")),
        ("motion.skills=[trot,trot]", ("motion.skills", "trot", "once")),
        ("motion.labels=colour", ("motion.labels", "colour", "gait_frequency")),
        ("motion.frequencies_hz=[2,2]", ("motion.frequencies_hz", "2.0", "once")),
        ("algo.imitation.epochs=0", ("update_normalizer", "False", "true")),
        ("algo.precision=float16", ("algo.precision", "float16", "bfloat16")),
        ("algo.ppo.clip=0", ("algo.ppo.clip", "0", "above 0")),
        ("run.iterations=0", ("run.iterations", "0", "1 or more")),
        ("seed=-1", ("seed", "-1", "0 or more")),
        ("variant='a b'", ("variant", "a b", "letters")),
    ],
)
def test_out_of_range_values_name_key_value_and_remedy(override, words):
    with pytest.raises(ConfigError) as caught:
        compose_config([override])
    line = str(caught.value)
    assert "\n" not in line
    for word in words:
        assert word in line


def test_unknown_device_is_an_error():
    with pytest.raises(ConfigError, match="abacus"):
        learner_device("abacus")


def test_resolving_a_resolved_configuration_changes_nothing():
    from omegaconf import OmegaConf

    config = compose_config(["run=smoke"])
    assert resolve(OmegaConf.create(OmegaConf.to_yaml(OmegaConf.structured(config)))) == config
