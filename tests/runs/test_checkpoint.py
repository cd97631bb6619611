"""Checkpoints come back exactly, survive being killed, and every bad file ends in one line with a remedy."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from camp.common.errors import CheckpointError
from camp.runs.checkpoint import (
    FORMAT,
    latest_checkpoint,
    list_checkpoints,
    load_checkpoint,
    save_checkpoint,
    save_run_checkpoint,
)


def state_of(iteration: int) -> dict:
    return {"iteration": iteration, "weight": torch.arange(1000.0) + iteration}


@pytest.fixture
def run(tmp_path) -> Path:
    """A run folder with the checkpoints of iterations 10, 20 and 30."""
    for iteration in (10, 20, 30):
        save_run_checkpoint(tmp_path / "run", iteration, state_of(iteration), keep=3)
    return tmp_path / "run"


def message_of(path: Path) -> str:
    with pytest.raises(CheckpointError) as caught:
        load_checkpoint(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    return message


def test_round_trip_of_a_model_and_its_optimizer(tmp_path):
    model = nn.Sequential(nn.Linear(3, 4), nn.ELU(), nn.Linear(4, 1))
    optimizer = torch.optim.Adam(model.parameters(), lr=1e-3)
    model(torch.ones(2, 3)).sum().backward()
    optimizer.step()
    state = {
        "model": model.state_dict(),
        "optimizer": optimizer.state_dict(),
        "skills": ["trot", "pace"],
        "large": 2**127 + 1,  # NumPy's generators keep numbers of 128 bits
        "nothing": None,
        "nested": ({"rate": 1e-5, "on": True},),
    }
    loaded = load_checkpoint(save_checkpoint(tmp_path / "a.pt", state))
    for key in ("skills", "large", "nothing", "nested"):
        assert loaded[key] == state[key]
    for key, value in model.state_dict().items():
        assert torch.equal(loaded["model"][key], value)
    torch.optim.Adam(model.parameters()).load_state_dict(loaded["optimizer"])
    assert torch.equal(loaded["optimizer"]["state"][0]["exp_avg"], optimizer.state_dict()["state"][0]["exp_avg"])


@pytest.mark.parametrize("value", [np.float64(1), np.zeros(2), Path("x"), object(), {1, 2}, torch.float32])
def test_what_could_not_be_loaded_is_refused_when_saving(tmp_path, value):
    with pytest.raises(TypeError, match=r"state\['a'\]\[1\] is a "):
        save_checkpoint(tmp_path / "a.pt", {"a": [0, value]})
    assert list(tmp_path.iterdir()) == []


def test_run_folder_gives_its_latest_and_keeps_the_last(tmp_path):
    for iteration in (1, 9, 99_999_999, 100_000_000):
        save_run_checkpoint(tmp_path, iteration, state_of(iteration), keep=2)
    assert [path.name for path in list_checkpoints(tmp_path)] == [
        "checkpoint_99999999.pt",
        "checkpoint_100000000.pt",  # one digit more must not sort it to the front
    ]
    assert load_checkpoint(tmp_path)["iteration"] == 100_000_000
    assert latest_checkpoint(tmp_path).name == "checkpoint_100000000.pt"


def test_leftovers_of_a_killed_writer_are_ignored_and_removed(run):
    leftover = run / "checkpoints" / "checkpoint_00000040.pt.123.partial"
    leftover.write_bytes(b"half")
    assert load_checkpoint(run)["iteration"] == 30
    save_run_checkpoint(run, 40, state_of(40), keep=3)
    assert not leftover.exists()


@pytest.mark.parametrize("fraction", [0.0, 0.3, 0.99])
def test_truncated_file_names_the_last_good_one(run, fraction):
    path = run / "checkpoints" / "checkpoint_00000030.pt"
    content = path.read_bytes()
    path.write_bytes(content[: int(fraction * len(content))])
    assert "checkpoint_00000020.pt" in message_of(path)
    with pytest.raises(CheckpointError, match=r"checkpoint_00000030\.pt: truncated"):
        load_checkpoint(run)  # no silent step back


def test_one_flipped_bit_is_noticed_and_a_bad_predecessor_passed_over(run):
    for iteration in (20, 30):
        path = run / "checkpoints" / f"checkpoint_{iteration:08d}.pt"
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1  # inside the weights, which torch itself would accept
        path.write_bytes(content)
    message = message_of(run / "checkpoints" / "checkpoint_00000030.pt")
    assert "check sum" in message and "checkpoint_00000010.pt" in message


def test_first_checkpoint_damaged_says_there_is_no_other(run):
    path = run / "checkpoints" / "checkpoint_00000010.pt"
    path.write_bytes(b"PK")
    assert "no good one" in message_of(path)


def test_foreign_files(tmp_path):
    torch.save({"model": torch.zeros(1)}, tmp_path / "other.pt")
    assert "not written by camp" in message_of(tmp_path / "other.pt")
    torch.save({"format": FORMAT, "version": 999, "state": {}}, tmp_path / "newer.pt")
    assert "format version 999" in message_of(tmp_path / "newer.pt")
    (tmp_path / "text.pt").write_text("hello")
    assert "not a checkpoint" in message_of(tmp_path / "text.pt")


def test_code_inside_a_checkpoint_is_not_run(tmp_path):
    class Bomb:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "bomb"),)

    torch.save({"format": FORMAT, "version": 1, "state": Bomb()}, tmp_path / "bomb.pt", pickle_module=pickle)
    assert "not a checkpoint" in message_of(tmp_path / "bomb.pt")
    assert not (tmp_path / "bomb").exists()


def test_missing_things_are_named(tmp_path):
    assert "not found" in message_of(tmp_path / "nowhere")
    assert "not found" in message_of(tmp_path / "checkpoint_00000001.pt")
    (tmp_path / "empty").mkdir()
    assert "holds no checkpoints" in message_of(tmp_path / "empty")


def test_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = save_checkpoint(tmp_path / "a.pt", state_of(1))

    def full_disk(*_):
        raise RuntimeError("[enforce fail at inline_container.cc] . PytorchStreamWriter failed writing file")

    monkeypatch.setattr(torch, "save", full_disk)
    with pytest.raises(CheckpointError, match=r"could not be written .*; free some space"):
        save_checkpoint(path, state_of(2))
    monkeypatch.undo()
    assert load_checkpoint(path)["iteration"] == 1
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.pt"]


def test_killed_while_saving_leaves_a_readable_checkpoint(tmp_path):
    """Kill -9 at some moments of an endless loop of saves: the run folder must always load."""
    code = (
        "import sys, torch; from pathlib import Path\n"
        "from camp.runs.checkpoint import save_run_checkpoint as save\n"
        "weight = torch.zeros(500_000)\n"
        "for i in range(10**6): save(Path(sys.argv[1]), i, {'iteration': i, 'weight': weight + i}, keep=2)\n"
    )
    for delay in (0.0, 0.02):
        folder = tmp_path / f"{delay}"
        writer = subprocess.Popen([sys.executable, "-c", code, str(folder)])
        try:
            while not list_checkpoints(folder):
                assert writer.poll() is None, "the writer ended before its first checkpoint"
                time.sleep(0.005)
            time.sleep(delay)
        finally:
            writer.send_signal(signal.SIGKILL)
            writer.wait()
        state = load_checkpoint(folder)
        assert torch.all(state["weight"] == state["iteration"])
