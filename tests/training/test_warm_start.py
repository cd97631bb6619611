"""The warm start makes the clips it needs once, and teaches the actor the expert's answers."""

from __future__ import annotations

import pytest
import torch

from camp.build import build_training
from camp.common.errors import ClipError
from camp.training.imitation_data import imitation_data
from camp.training.warm_start import perturbed_clips, warm_start


@pytest.fixture
def warm(config, tmp_path):
    config.motion.perturbed_folder = str(tmp_path)
    config.motion.perturbed_clips = 1
    config.algo.imitation.epochs, config.algo.imitation.batch_size = 10, 32
    return config


def test_clips_are_made_once_and_imitated(warm, tmp_path):
    training = build_training(warm)
    data = imitation_data(perturbed_clips(warm), warm, torch.device("cpu"))

    def error() -> float:
        with torch.no_grad():
            return float((training.ppo.actor(data.observation) - data.action).square().mean())

    before = error()
    (clip,) = tmp_path.glob("*.npz")
    written = clip.stat().st_mtime_ns
    metrics = warm_start(training, warm)
    assert error() < 0.3 * before
    assert len(metrics) == 10 and metrics[-1]["imitation/loss"] < before
    assert len(perturbed_clips(warm)) == 1
    assert clip.stat().st_mtime_ns == written

    warm.motion.mirrored = True
    both = imitation_data(perturbed_clips(warm), warm, torch.device("cpu"))
    own, image = both.action[: len(data.action)], both.action[len(data.action) :]
    assert torch.equal(own, data.action)
    assert torch.equal(image[:, 1], own[-len(image) :, 4]), "the left thigh of the image is the right one's"
    assert len(own) - len(image) == 25, "a standing robot is its own image: only one side's start is shown"

    clip.unlink()
    (tmp_path / "failed.txt").write_text(f"{clip.stem}\n")
    with pytest.raises(ClipError, match="0 of 1"):
        perturbed_clips(warm)


def test_without_epochs_nothing_happens(warm, tmp_path):
    warm.algo.imitation.epochs = 0
    training = build_training(warm)
    weights = [parameter.clone() for parameter in training.ppo.actor.parameters()]
    assert warm_start(training, warm) == []
    assert list(tmp_path.iterdir()) == []
    assert all(torch.equal(a, b) for a, b in zip(weights, training.ppo.actor.parameters(), strict=True))
