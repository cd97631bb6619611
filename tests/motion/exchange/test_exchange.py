"""Imported clips train like any other; the subcommands that read and write them."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import pytest
import torch

from camp.build import build_training
from camp.config.resolve import as_yaml
from camp.config.schema import Config
from camp.dataset import main
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import skill_set
from camp.motion.clips.sampler import Demonstrations, ReferenceStates
from camp.motion.clips.store import load_clip, load_clips
from camp.robots.go2 import GO2
from camp.runs.logger import RunLogger
from camp.runs.wandb_run import RunIdentity
from camp.training.progress import Progress
from camp.training.runner import Runner
from tests.motion.exchange.foreign import FOLDER, imported_folder, kine2go_table, shipped


def test_imported_clips_feed_the_samplers(tmp_path: Path) -> None:
    clips = load_clips(GO2, imported_folder(tmp_path), list(GAIT_PHASES))
    assert [clip.source for clip in clips] == ["amp"] * 4
    generator = torch.Generator().manual_seed(0)
    skills = skill_set(tuple(GAIT_PHASES), "gait", ())
    demonstrations = Demonstrations(clips, skills, 400, generator)
    batch = demonstrations.sample(64, generator)
    assert batch.state.shape == (64, 2, 43) and torch.isfinite(batch.state).all()
    states = ReferenceStates(clips, skills).sample(torch.arange(4), generator)
    assert states.base_height.shape == (4,)
    np.testing.assert_allclose(states.joint_target_applied_previous, states.joint_position, atol=1e-6)


def test_training_on_imported_clips(config: Config, tmp_path: Path) -> None:
    config.motion.folder = str(imported_folder(tmp_path))
    config.motion.num_preloaded = 400
    config.env.initialization.reference_fraction = 1.0
    config.run.iterations, config.run.rollout_steps = 2, 8
    training = build_training(config)
    runner = Runner(training, config, tmp_path)
    runner.start()
    with (
        RunLogger(RunIdentity(tmp_path, "test"), config.logger, as_yaml(config)) as logger,
        Progress(config.run.iterations, 1, stream=io.StringIO()) as progress,
    ):
        runner.train(logger, progress, lambda: False)
    training.env.close()
    rows = [json.loads(line) for line in (tmp_path / "metrics.jsonl").read_text().splitlines()]
    assert len(rows) == 2
    assert all(np.isfinite(rows[-1][f"prior/{prior}/loss"]) for prior in ("style", "skill"))


def test_command_line_there_and_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, text = FOLDER / "trot_2hz_forward_0.6.npz", tmp_path / "trot.txt"
    assert main(["export", str(source), "--format", "amp", str(text)]) == 0
    reading = ["import", str(text), "--format", "amp", "--gait", "trot", "--folder", str(tmp_path / "clips")]
    assert main(reading) == 0
    printed = capsys.readouterr().out
    assert "200 frames at 50 Hz, legs FR,FL,RR,RL" in printed
    assert "200 rows (4.00 s), trot at 2.0" in printed
    back = load_clip(tmp_path / "clips" / "trot_trot.npz")
    np.testing.assert_array_equal(back.joint_position, shipped().joint_position)
    assert main(reading) == 2
    assert "is there already; pass --overwrite or another --name" in capsys.readouterr().err
    assert main([*reading, "--overwrite", "--leg-order", "fl,fr,rl,rr"]) == 2
    assert "pass --leg-order FR,FL,RR,RL" in capsys.readouterr().err
    assert main([*reading, "--name", "other", "--steady", "0.6", "0", "0"]) == 0
    assert load_clip(tmp_path / "clips" / "other.npz").is_steady


def test_command_line_notes_another_gait(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "my_walk"
    folder.mkdir()
    np.save(folder / "motion.npy", kine2go_table(shipped(), joints_by_kind=True))
    arguments = ["import", str(folder / "motion.npy"), "--format", "kine2go", "--gait", "pace"]
    assert main([*arguments, "--folder", str(tmp_path)]) == 0
    assert "by its contacts it is 'trot', not pace" in capsys.readouterr().out
    assert load_clip(tmp_path / "pace_my_walk.npz").gait == "pace"
