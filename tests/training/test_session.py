"""What a training checks before it works, and what it does where a place fails it on the way."""

from __future__ import annotations

import pytest

from camp.common.errors import ConfigError
from camp.common.files import folder_lock
from camp.config.compose import compose_config
from camp.config.resolve import load_run_config
from camp.runs.folder import CONFIG, LATEST, check_root
from camp.training import session
from tests.small_run import OVERRIDES, small_run


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return small_run(tmp_path_factory.mktemp("runs") / "run")


def spoiled_roots(tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "taken" / LATEST).mkdir(parents=True)
    return {"file": tmp_path / "file" / "runs", "taken": tmp_path / "taken"}


@pytest.mark.parametrize(("name", "words"), [("file", "Not a directory"), ("taken", "latest is no link")])
def test_a_place_that_cannot_be_used_is_told_before_the_warm_start(name, words, tmp_path, monkeypatch):
    def work(*_):
        raise AssertionError("the warm start has begun")

    monkeypatch.setattr(session, "warm_start", work)
    monkeypatch.setattr(session, "build_training", work)
    root = spoiled_roots(tmp_path)[name]
    config = compose_config([*OVERRIDES, f"output_dir={root}"])
    with pytest.raises(ConfigError, match=words) as caught:
        session.start(config)
    assert str(root) in str(caught.value) and "\n" not in str(caught.value)


def test_checking_a_place_leaves_nothing_behind(tmp_path):
    check_root(tmp_path / "new" / "runs")
    assert list(tmp_path.iterdir()) == []


def test_two_trainings_do_not_share_a_run_folder(finished):
    with folder_lock(finished), pytest.raises(ConfigError, match="another process is writing to it"):
        session.resume(finished, ["run.iterations=9"])


def test_a_saved_configuration_does_not_read_the_environment(finished, monkeypatch):
    monkeypatch.setenv("SECRET", "s3cr3t")
    path = finished / CONFIG
    text = path.read_text()
    try:
        path.write_text(text.replace("variant: camp", "variant: ${oc.env:SECRET}"))
        with pytest.raises(ConfigError, match=r"variant = '\$\{oc\.env:SECRET\}' is an interpolation") as caught:
            load_run_config(finished)
        assert "s3cr3t" not in str(caught.value)
    finally:
        path.write_text(text)


def test_a_folder_never_chooses_to_go_online(finished):
    path = finished / CONFIG
    text = path.read_text()
    try:
        path.write_text(text.replace("wandb_mode: disabled", "wandb_mode: online"))
        assert load_run_config(finished).logger.wandb_mode == "offline"
        assert load_run_config(finished, ["logger.wandb_mode=online"]).logger.wandb_mode == "online"
    finally:
        path.write_text(text)


@pytest.mark.parametrize("key", ["resume", "output_dir", "motion.folder", "motion.perturbed_folder"])
@pytest.mark.parametrize("value", ["", "' '"])
def test_an_empty_place_is_an_error(key, value):
    with pytest.raises(ConfigError, match=rf"^{key} = '.*name a place"):
        compose_config([f"{key}={value}"])
