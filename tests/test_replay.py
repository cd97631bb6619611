"""A diverged robot's state is kept in the run folder, and the replay shows the step again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from camp.build import build_env
from camp.cli.key_values import run_command
from camp.common.errors import CampError
from camp.config.compose import compose_config
from camp.config.schema import Config
from camp.envs.quadruped import QuadrupedEnv
from camp.motion.clips.clip import Clip
from camp.replay import replay, report, simulate
from camp.training.dumps import MOST_DUMPS, load_dump, save_dump
from tests.errors import assert_one_line
from tests.training.test_runner import metrics_of, run_for


def dumped(folder: Path, config: Config, clips: list[Clip], speed: float = 0.0, action: float = 0.5) -> Path:
    """The file of robot 3, whose first thigh was set to a speed in rad/s before a step with that action."""
    env = build_env(config, clips)
    env.reset(seed=0, options={"stagger": False})
    env.advance(torch.full((8, 12), 0.1))
    env.sim._rows["qvel"][3, 7] += speed  # pyright: ignore[reportAttributeAccessIssue]
    actions = torch.zeros(8, 12)
    actions[3] = action
    assert env.advance(actions).diverged.nonzero().tolist() == [[3]]
    case = env.first_diverged.take()
    assert case is not None and env.first_diverged.take() is None
    (line,) = save_dump(folder, 12, case, config)
    assert line.startswith("robot 3 diverged; see what happened: python -m camp.replay ")
    (path,) = (folder / "diverged").iterdir()
    return path


@pytest.mark.parametrize("delay_s", [[0.0, 0.0], [0.01, 0.03]])
def test_a_replay_is_the_step_that_training_saw(tmp_path, config, clips, delay_s):
    config.env.randomization.enabled, config.env.randomization.delay_s = True, delay_s
    dump = load_dump(dumped(tmp_path, config, clips, speed=3000.0))
    assert dump.about.env == 3 and dump.about.iteration == 12 and dump.about.step == 2
    done = simulate(dump)
    assert len(done.states) == 5
    assert np.array_equal(done.states[-1].qpos()[0].numpy(), dump.arrays["reached.qpos"].astype(np.float32))
    lines = "\n".join(report(dump, done)).splitlines()
    assert all(len(line) <= 80 for line in lines) and lines[-1] == "training saw the same"
    assert "impossible from 0.0 ms on:" in lines and any("FL_thigh_joint speed = " in line for line in lines)


def test_a_replay_is_filmed(tmp_path, config, clips):
    path = dumped(tmp_path, config, clips, speed=3000.0)
    try:
        replay([str(path), f"video={tmp_path / 'step.mp4'}"])
    except CampError as error:
        pytest.skip(str(error))
    assert (tmp_path / "step.mp4").stat().st_size > 1000


def test_a_replay_tells_a_bad_action(tmp_path, config, clips, capsys):
    path = dumped(tmp_path, config, clips, action=float("nan"))
    replay([str(path)])
    shown = capsys.readouterr().out
    assert "largest nan" in shown and "counts as diverged" in shown and "training saw the same" in shown
    assert max(map(len, shown.splitlines())) <= 80


def test_dumps_are_few_and_training_does_without(tmp_path, config, clips):
    path = dumped(tmp_path, config, clips, action=1e30)
    case = dict(np.load(path, allow_pickle=False))
    case["robot"] = np.array([1.0])
    del case["about"]
    for iteration in range(20, 40):
        save_dump(tmp_path, iteration, case, config)
    assert len(list(path.parent.iterdir())) == MOST_DUMPS
    (tmp_path / "file").write_text("")
    (line,) = save_dump(tmp_path / "file", 1, case, config)
    assert line.startswith("robot 1 diverged; its state could not be kept (")


@pytest.fixture(scope="module")
def good(tmp_path_factory, clips) -> dict[str, np.ndarray]:
    """What a dump holds."""
    config = compose_config(["run=smoke", "sim=cpu", "sim.num_envs=8", "sim.threads=1", "env.push.enabled=false"])
    return dict(np.load(dumped(tmp_path_factory.mktemp("run"), config, clips, action=1e30), allow_pickle=False))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"action": np.zeros(11)}, "action has the shape (11,), not (12,)"),
        ({"before.qpos": np.full(19, np.nan)}, "before.qpos is not finite"),
        ({"about": np.array("[]")}, "unreadable"),
        ({"about": np.array("{}")}, "unreadable"),
        ({"before.ctrl": np.zeros(5)}, "ctrl does not fit this camp"),
        ({"dynamics.friction": np.zeros(3)}, "friction does not fit this camp"),
    ],
)
def test_a_file_that_is_no_dump_is_one_line(good, tmp_path, capsys, change, message):
    np.savez(tmp_path / "other.npz", **good | change)
    assert run_command(replay, [str(tmp_path / "other.npz")], None) == 2
    assert_one_line(capsys.readouterr().err, message)


@pytest.mark.parametrize("arguments", [[], ["none.npz"], ["a", "b"], ["a", "video="]])
def test_a_command_line_that_cannot_be_used_is_one_line(arguments, capsys):
    assert run_command(replay, arguments, None) == 2
    assert_one_line(capsys.readouterr().err)


def test_a_run_that_diverges_says_so_and_goes_on(tmp_path, config, monkeypatch):
    def kick(env: QuadrupedEnv) -> None:
        if env.num_steps % 20 == 0:
            env.sim.push(torch.full((8, 3), 1e4))

    monkeypatch.setattr(QuadrupedEnv, "_push", kick)
    config.run.iterations = 2
    run_for(config, tmp_path)
    rows = metrics_of(tmp_path)
    assert rows[-1]["env/diverged"] > 0 and rows[0]["alarm/diverged"] == 1.0 and rows[0]["alarm/not_finite"] == 0.0
    assert all(row["ppo/rows_left_out"] == 0.0 for row in rows)
    first = load_dump(min((tmp_path / "diverged").iterdir()))
    assert first.about.iteration == 1 and report(first, simulate(first))[-1] == "training saw the same"
