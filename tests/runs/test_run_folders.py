"""A run folder that is damaged is refused in one line that names it, what is wrong and the remedy."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch

from camp.build import load_run
from camp.common.errors import CampError, CheckpointError, ClipError, ConfigError
from camp.config.resolve import load_run_config
from camp.runs.checkpoint import latest_checkpoint, load_checkpoint, save_run_checkpoint
from tests.small_run import small_run


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    return small_run(tmp_path_factory.mktemp("run") / "whole")


@pytest.fixture
def run(whole, tmp_path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "run"))


def refusal(run: Path, kind: type[CampError]) -> str:
    with pytest.raises(kind) as caught:
        load_run(run)
    line = str(caught.value)
    assert "\n" not in line and str(run) in line
    return line


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"seed: [0,", "cannot be read as YAML"),
        (b"\xff\x00\x80", "cannot be read as YAML"),
        (b"seed: ${", "cannot be read as YAML"),
        (b"- 1\n", "a list"),
        (b"", "(seed: has no value)"),
        (b"sim: 3\n", "SimConfig"),
        (b"seed: abc\n", "(seed 'abc': wrong type"),
        (b"sead: 1\n", "(sead: unknown key)"),
    ],
)
def test_a_damaged_configuration_names_the_file(run, content, words):
    (run / "config.yaml").write_bytes(content)
    line = refusal(run, ConfigError)
    assert str(run / "config.yaml") in line and words in line and "restore the original file" in line
    assert "--cfg" not in line and "=<value>" not in line


def test_a_folder_from_before_robots_had_names_is_of_the_go2(run):
    config = run / "config.yaml"
    text = config.read_text()
    config.write_text(text.replace("robot:\n  name: go2\n", "robot:\n"))
    assert config.read_text() != text
    assert load_run_config(run).robot.name == "go2"


def test_a_value_out_of_range_is_told_with_the_file(run):
    config = run / "config.yaml"
    config.write_text(config.read_text().replace("seed: 0\n", f"seed: {2**64}\n"))
    assert f"(seed = {2**64}: choose a whole number from 0 to 18446744073709551615 (torch takes" in refusal(
        run, ConfigError
    )


def test_a_list_in_the_place_of_a_number_names_the_file(run):
    config = run / "config.yaml"
    config.write_text(config.read_text().replace("- trot\n", "- [trot]\n"))
    assert "not a configuration" in refusal(run, ConfigError)


def test_an_unreadable_configuration_names_the_file(run, monkeypatch):
    def refuse(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("camp.config.resolve.OmegaConf.load", refuse)
    assert "Permission denied" in refusal(run, ConfigError)


def test_changes_are_not_blamed_on_the_file(run):
    assert load_run_config(run, ["run.iterations=9"]).run.iterations == 9
    with pytest.raises(ConfigError, match=r"^run\.iterations = 0: choose"):
        load_run_config(run, ["run.iterations=0"])


def change_checkpoint(run: Path, change: Callable[[dict[str, Any]], Any]) -> str:
    """The name of the run's checkpoint, once `change` has been at its state."""
    state = load_checkpoint(run)
    save_run_checkpoint(run, 7, change(state) or state, keep=1)
    return latest_checkpoint(run).name


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda state: {"nothing": 1}, "no entry ppo"),
        (lambda state: {key: value for key, value in state.items() if key != "iteration"}, "no entry iteration"),
        (lambda state: state.update(iteration="seven"), "entry iteration is of type str, not int"),
        (lambda state: state.update(iteration=None), "entry iteration is of type NoneType"),
        (lambda state: state.update(iteration=torch.zeros(2)), "entry iteration is of type Tensor"),
        (lambda state: state.update(iteration=-1), "entry iteration is -1"),
        (lambda state: state.update(ranks="two"), "entry ranks is of type str, not list"),
        (lambda state: state.update(ranks=[1]), "entry ranks[0] is of type int, not dict"),
        (lambda state: state.update(alarms=3), "entry alarms is of type int, not dict"),
        (lambda state: state.update(ppo=3), "entry ppo is of type int, not dict"),
        (lambda state: state.update(priors=None), "entry priors is of type NoneType, not dict"),
        (lambda state: state["ppo"].update(actor=[1]), "entry ppo.actor is of type list, not dict"),
        (lambda state: state["priors"].update(skill=1), "entry priors.skill is of type int, not dict"),
    ],
)
def test_a_checkpoint_with_entries_of_other_types_names_them(run, change, words):
    def changed(state):
        result = change(state)
        return result if isinstance(result, dict) else None

    name = change_checkpoint(run, changed)
    line = refusal(run, CheckpointError)
    assert f"{name}: {words}" in line and "train anew" in line


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda state: state["ppo"]["actor"].update({"network.0.weight": "a"}), "network.0.weight"),
        (lambda state: state["ppo"]["actor"].pop("network.0.weight"), "network.0.weight"),
        (lambda state: state["ppo"]["actor"].update({"network.0.weight": torch.zeros(2)}), "size mismatch"),
        (lambda state: state["priors"]["skill"].update(optimizer={"state": 1}), "param_groups"),
    ],
)
def test_a_checkpoint_of_another_structure_tells_what_differs(run, change, words):
    def changed(state):
        result = change(state)
        return result if isinstance(result, dict) else None

    name = change_checkpoint(run, changed)
    line = refusal(run, CheckpointError)
    assert f"its {name} does not fit its config.yaml" in line and words in line and "train anew" in line
    assert len(line) < 500


@pytest.mark.parametrize("content", [[1], {"format": "camp-checkpoint"}, {"format": "camp-checkpoint", "version": 1}])
def test_a_checkpoint_without_a_state_is_refused(run, content):
    torch.save(content, latest_checkpoint(run))
    refusal(run, CheckpointError)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
@pytest.mark.parametrize(
    ("entry", "find"),
    [
        ("ppo.actor.network.0.bias", lambda state: state["ppo"]["actor"]["network.0.bias"]),
        ("priors.skill.normalizer.mean", lambda state: state["priors"]["skill"]["normalizer"]["mean"]),
    ],
)
def test_networks_with_values_that_are_not_finite_are_refused(run, value, entry, find):
    def spoil(state):
        find(state)[0] = value

    name = change_checkpoint(run, spoil)
    line = refusal(run, CheckpointError)
    assert f"{name}: training had diverged ({entry} is not finite)" in line and "train anew" in line


def test_clips_are_loaded_when_they_are_asked_for(run):
    config = run / "config.yaml"
    assert "  folder: null\n" in config.read_text()
    config.write_text(config.read_text().replace("  folder: null\n", "  folder: /gone\n"))
    loaded = load_run(run)
    assert torch.isfinite(loaded.actor(torch.zeros(1, 49))).all()
    with pytest.raises(ClipError, match="/gone"):
        _ = loaded.clips
