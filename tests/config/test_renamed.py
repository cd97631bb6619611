"""Keys that were renamed: old run folders, command lines and code that composes go on working."""

from __future__ import annotations

import pytest
from omegaconf import OmegaConf

from camp.build import load_run
from camp.cli.hydra_main import run_hydra
from camp.config.compose import compose_config
from camp.config.renamed import RENAMED, with_new_names
from camp.config.resolve import load_run_config
from camp.runs.folder import CONFIG
from tests.small_run import small_run


@pytest.fixture(scope="module")
def old_run(tmp_path_factory):
    """A run folder whose configuration has every old name in place of the new one."""
    run = small_run(tmp_path_factory.mktemp("old") / "run")
    config = OmegaConf.load(run / CONFIG)
    for old, new in RENAMED.items():
        value = OmegaConf.select(config, new)
        group, _, key = new.rpartition(".")
        del OmegaConf.select(config, group)[key]
        OmegaConf.update(config, old, value)
    OmegaConf.save(config, run / CONFIG)
    return run


def test_a_run_folder_with_old_names_loads(old_run):
    saved = OmegaConf.load(old_run / CONFIG)
    config = OmegaConf.structured(load_run(old_run).config)
    for old, new in RENAMED.items():
        assert OmegaConf.select(saved, old) == OmegaConf.select(config, new)


def test_a_continued_run_takes_changes_under_old_names(old_run):
    assert load_run_config(old_run, ["algo.ppo.discount=0.5"]).algo.ppo.gamma == 0.5


def test_overrides_may_have_old_names():
    config = compose_config(["algo.ppo.clip=0.1", "++algo.ppo.entropy=0.25", "env.command.zero_share=0.125"])
    assert config.algo.ppo.clip_param == 0.1 and config.algo.ppo.entropy_coef == 0.25
    assert config.env.command.zero_fraction == 0.125


def test_a_command_line_may_have_old_names():
    seen = []
    assert run_hydra("train", seen.append, ["algo.ppo.trace=0.75"]) == 0
    assert seen[0].algo.ppo.gae_lambda == 0.75 and "trace" not in seen[0].algo.ppo


def test_the_new_name_counts_where_both_are_given():
    both = OmegaConf.create({"algo": {"ppo": {"clip": 0.1, "clip_param": 0.2}}})
    assert with_new_names(both) == {"algo": {"ppo": {"clip_param": 0.2}}}


@pytest.mark.parametrize("odd", [{"algo": 3}, {"algo": {"ppo": None}}, {}])
def test_what_is_not_a_group_is_left_alone(odd):
    assert with_new_names(OmegaConf.create(odd)) == odd
