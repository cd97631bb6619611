"""Every preset and ablation composes; wrong values end in one line with key, value and remedy."""

from __future__ import annotations

import pytest
import torch
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from camp import build
from camp.common.errors import ConfigError
from camp.common.paths import ablation_root, config_root
from camp.config.compose import compose_config
from camp.config.devices import learner_device, simulator_device
from camp.config.resolve import as_yaml, resolve
from camp.config.schema import Config
from camp.sim import choice

PRESETS = sorted(path.stem for path in (config_root() / "run").glob("*.yaml"))
ABLATIONS = sorted(path.stem for path in (ablation_root() / "ablation").glob("*.yaml"))
STUDIES = sorted(path.stem for path in (ablation_root() / "study").glob("*.yaml"))


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_composes(preset):
    assert compose_config([f"run={preset}"]).run.iterations >= 1


def keys(values: dict, prefix: str = "") -> set[str]:
    """The names of all values, those of groups with dots."""
    found = set()
    for name, value in values.items():
        found |= keys(value, f"{prefix}{name}.") if isinstance(value, dict) else {f"{prefix}{name}"}
    return found


def test_every_key_of_the_schema_can_be_set_by_its_plain_name():
    """A key that conf/ does not hold can only be given with a +, which no page of the documentation does."""
    with initialize_config_dir(str(config_root()), version_base="1.3"):
        composed = OmegaConf.to_container(compose("train", overrides=["run=smoke"]))
    assert keys(OmegaConf.to_container(OmegaConf.structured(Config))) <= keys(composed)


def test_the_papers_other_gains_compose_without_imitation():
    assert compose_config(["robot=go2_soft", "run=scratch"]).robot.kp == [20.0, 20.0, 20.0]
    with pytest.raises(ConfigError, match=r"robot.kp.*run=scratch"):
        compose_config(["robot=go2_soft"])


@pytest.mark.parametrize("ablation", ABLATIONS)
def test_every_ablation_changes_the_variant_and_little_else(ablation):
    changed = compose_config(["run=scratch", f"+ablation={ablation}"])
    assert changed.variant == ablation
    plain = compose_config(["run=scratch"])
    differing = [
        name for name in ("sim", "robot", "motion", "run", "logger") if getattr(changed, name) != getattr(plain, name)
    ]
    assert differing == []
    assert ((changed.env, changed.algo) == (plain.env, plain.algo)) == (ablation == "full")


@pytest.mark.parametrize("ablation", ABLATIONS)
def test_every_ablation_goes_with_the_default_preset(ablation):
    assert compose_config([f"+ablation={ablation}"]).variant == ablation


@pytest.mark.parametrize("study", STUDIES)
def test_every_study_changes_the_recipe_from_scratch(study):
    plain, changed = compose_config(["run=scratch"]), compose_config(["run=scratch", f"+study={study}"])
    assert changed.variant == study
    assert (changed.env, changed.algo, changed.sim) != (plain.env, plain.algo, plain.sim)
    assert changed.run == plain.run
    plain.motion.mirrored = changed.motion.mirrored  # part of the symmetry
    assert changed.motion == plain.motion


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
        ("sim.num_envs=0", ("sim.num_envs", "0", "a whole number from 1 to 1048576")),
        ("sim.backend=quantum", ("sim.backend", "quantum", "cpu, gpu, auto")),
        ("env.episode_s=0", ("env.episode_s", "0", "from 0.001")),
        ("env.control_period_s=0.013", ("env.control_period_s", "0.013", "multiple")),
        ("env.command.vx_m_s=[1,-1]", ("env.command.vx_m_s", "[1.0, -1.0]", "low <= high")),
        (
            "env.randomization.friction=[-1,1]",
            ("env.randomization.friction", "[-1.0, 1.0]", "list numbers from 0.001 to 10"),
        ),
        ("env.initialization.reference_fraction=1.5", ("reference_fraction", "1.5", "from 0 to 1 (it is a fraction)")),
        ("robot.kp=[30,30]", ("robot.kp", "[30.0, 30.0]", "three")),
        ("motion.skills=[trot,gallop]", ("motion.skills", "gallop", "pronk")),
        ("motion.skills=[trot,trot]", ("motion.skills", "trot", "once")),
        ("motion.labels=colour", ("motion.labels", "colour", "gait_frequency")),
        ("motion.frequencies_hz=[2,2]", ("motion.frequencies_hz", "2.0", "once")),
        ("algo.imitation.epochs=0", ("algo.imitation.ppo_weight", "3.0", "run=scratch")),
        ("algo.imitation={epochs:0,ppo_weight:0}", ("update_normalizer", "False", "true")),
        ("algo.precision=float16", ("algo.precision", "float16", "bfloat16")),
        ("algo.ppo.clip_param=0", ("algo.ppo.clip_param", "0", "from 1e-06 to 10")),
        ("run.iterations=0", ("run.iterations", "0", "from 1 to")),
        ("seed=-1", ("seed", "-1", "from 0")),
        (f"seed={2**64}", ("seed", "18446744073709551616", "from 0 to 18446744073709551615")),
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


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["sim=gpu", "sim.device=tpu"], ("sim.device", "tpu", "cuda or cpu")),
        (["sim=gpu", "sim.contacts_per_robot=0"], ("sim.contacts_per_robot", "0", "from 1 to")),
        (["sim=gpu", "sim.constraints_per_robot=0"], ("sim.constraints_per_robot", "0", "from 1 to")),
        (["sim=cpu", "+sim.device=cuda"], ("sim.device", "cuda", "sim=gpu")),
    ],
)
def test_simulators_refuse_what_they_cannot_do(overrides, words):
    with pytest.raises(ConfigError) as caught:
        compose_config(overrides)
    for word in words:
        assert word in str(caught.value)


def test_auto_takes_the_gpu_where_it_can_run(monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(choice, "warp_installed", lambda: True)
    chosen = compose_config(["sim=auto", "run=gpu"]).sim
    assert chosen == compose_config(["sim=gpu", "run=gpu"]).sim
    assert (chosen.backend, chosen.device, chosen.num_envs) == ("gpu", "cuda", 4096)
    assert compose_config(["sim=auto", "sim.num_envs=7"]).sim.num_envs == 7
    assert compose_config(["sim=auto", "device=cpu"]).sim == compose_config(["sim=cpu"]).sim
    monkeypatch.setattr(choice, "warp_installed", lambda: False)
    assert compose_config(["sim=auto"]).sim == compose_config(["sim=cpu"]).sim
    assert "pip install" in str(choice.why_no_gpu("auto"))


def test_auto_falls_back_on_the_cpu(monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    assert compose_config([]).sim == compose_config(["sim=cpu"]).sim
    assert choice.why_no_gpu("auto") == "torch finds no CUDA GPU"


def test_what_auto_chose_stays_chosen(monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(choice, "warp_installed", lambda: True)
    saved = OmegaConf.to_yaml(as_yaml(compose_config(["sim=auto"])))
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    assert resolve(OmegaConf.create(saved)).sim.backend == "gpu"


def test_a_run_from_before_the_gpu_backend_still_loads():
    saved = as_yaml(compose_config(["sim=cpu"]))
    old = OmegaConf.to_container(saved)
    old["sim"] = {key: old["sim"][key] for key in ("backend", "num_envs", "threads", "physics_timestep_s")}
    assert resolve(OmegaConf.create(old)).sim == compose_config(["sim=cpu"]).sim


def test_where_the_simulator_runs(monkeypatch):
    gpu = compose_config(["sim=gpu"])
    assert simulator_device(compose_config(["sim=cpu"])) == torch.device("cpu")
    assert simulator_device(compose_config(["sim=gpu", "sim.device=cpu"])) == torch.device("cpu")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(ConfigError, match=r"no CUDA GPU.*sim=cpu"):
        simulator_device(gpu)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    monkeypatch.setattr(torch.cuda, "current_device", lambda: 0)
    assert simulator_device(gpu) == torch.device("cuda:0")
    gpu.device = "cuda:1"
    assert simulator_device(gpu) == torch.device("cuda:1")
    gpu.device = "cpu"
    with pytest.raises(ConfigError, match=r"device = 'cpu' beside sim=gpu.*device=cuda"):
        simulator_device(gpu)


def test_a_missing_package_is_named_with_its_remedy(monkeypatch):
    monkeypatch.setattr(build, "warp_installed", lambda: False)
    with pytest.raises(ConfigError, match=r"mujoco_warp is not installed; pip install '\.\[gpu\]'"):
        build.build_simulator(compose_config(["sim=gpu", "sim.device=cpu"]))


def test_unknown_device_is_an_error():
    with pytest.raises(ConfigError, match="abacus"):
        learner_device("abacus")


def test_resolving_a_resolved_configuration_changes_nothing():
    config = compose_config(["run=smoke"])
    assert resolve(OmegaConf.create(OmegaConf.to_yaml(OmegaConf.structured(config)))) == config


def test_the_gpu_preset_is_the_recipe_from_scratch_with_the_papers_number_of_robots():
    small, large = compose_config(["run=scratch", "sim=cpu"]), compose_config(["run=gpu", "sim=cpu"])
    assert (small.sim.num_envs, large.sim.num_envs) == (256, 4096)
    for name in ("style", "skill"):
        own, other = getattr(small.algo, name), getattr(large.algo, name)
        assert other.batch_size * other.updates == 8 * own.batch_size * own.updates
        own.batch_size, own.updates = other.batch_size, other.updates
    assert large.algo == small.algo and large.env == small.env and large.motion == small.motion


def test_the_papers_preset_takes_nothing_from_the_recipe():
    paper = compose_config(["run=paper", "sim=cpu"])
    assert paper.env.transition_ages == [1, 0] and paper.algo.skill.patience_s is None
    assert paper.env.episode_growth.initial_s is None and paper.env.hardening.initial is None
    assert paper.algo.style.hidden == [1024, 512] and paper.algo.actor.hidden == [512, 256, 128]
