"""A shipped policy is a small run folder: complete to look at, free of the machine that made it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import torch

from camp.build import Run, load_run
from camp.cli.key_values import run_command
from camp.common import paths
from camp.common.errors import CampError, ConfigError
from camp.common.paths import policies_root
from camp.deployment.package import ship_policy
from camp.deployment.provenance import condensed
from camp.evaluation.report import Finding, TableI, as_json
from camp.runs.checkpoint import load_checkpoint
from camp.runs.folder import results_folder
from camp.runs.metrics import read_metrics
from camp.ship import ship
from tests.errors import assert_one_line
from tests.evaluation.reports import gait_summary, policy_summary, report, switching_summary
from tests.small_run import small_run

ARGUMENTS = ["/somewhere/train.py", "run=smoke", "seed=3", "output_dir=/somewhere/runs", "logger.wandb_mode=disabled"]
TROT = "motion.skills=[trot]"  # a quarter of the clips to load
SHIPPED = sorted(policies_root().glob("*/config.yaml"))


WALKS = policy_summary({"trot": gait_summary(None, 80)})
EVALUATION = json.loads(
    as_json(
        report(
            iteration=7,
            policies={"trained": WALKS},
            table_i=TableI(WALKS, []),
            switching=switching_summary(None, 0, 3),
            verdict=[Finding("gait accuracy", 0.95, True, 0.96, 0.9, 0.99, 80, "not shown", "weakest skill: trot")],
        )
    )
)


def finish(run: Path, iterations: int = 7) -> Path:
    """Add what training and evaluation leave beside the checkpoints."""
    versions = {
        "camp": "0.1.0",
        "git": {"commit": "abc123", "dirty": False},
        "python": "3.11.7",
        "packages": {"torch": "2.13.0", "mujoco": "4.0.0", "something": "1.0"},
        "platform": "Linux-on-somebody's-machine",
        "cpu_count": 2,
        "command": ARGUMENTS,
        "started": "2026-01-01T00:00:00+00:00",
    }
    (run / "versions.json").write_text(json.dumps(versions))
    times = {f"time/{part}_s": 0.3 for part in ("collect", "score", "policy_update", "prior_update")}
    rows = [
        {"iteration": i, "reward/task/raw": i / 3, "steps": 96.0 * i, "time/steps_per_s": 80.0} | times
        for i in range(1, iterations + 1)
    ]
    (run / "metrics.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    (run / "imitation.jsonl").write_text("")
    (run / "eval.json").write_text(json.dumps(EVALUATION))
    np.savez(run / "eval.npz", period=np.array(0.02))
    return run


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    places = ["output_dir=/somewhere/runs", "motion.perturbed_folder=/somewhere"]
    return finish(small_run(folder, ["seed=3", TROT, *places]))


@pytest.fixture(scope="module")
def shipped(run, tmp_path_factory) -> Path:
    return ship_policy(run, tmp_path_factory.mktemp("policies") / "small", minutes=12.5)


@pytest.fixture(scope="module")
def loaded(shipped) -> Run:
    return load_run(shipped)


def test_the_shipped_policy_answers_as_the_run_does(run, loaded):
    original, observation = load_run(run), torch.randn(50, 46, generator=torch.Generator().manual_seed(0))
    with torch.no_grad():
        assert torch.equal(loaded.actor(observation), original.actor(observation))
    assert (loaded.iteration, loaded.skills) == (7, original.skills)
    assert loaded.skill_prior is not None and original.skill_prior is not None
    found, expected = loaded.skill_prior.state_dict(), original.skill_prior.state_dict()
    for part in ("network", "embedding", "normalizer"):
        assert all(torch.equal(found[part][name], value) for name, value in expected[part].items())


def test_only_what_is_needed_is_shipped(run, shipped):
    state = load_checkpoint(shipped)
    assert set(state) == {"iteration", "ppo", "priors"}
    assert set(state["ppo"]) == {"actor"} and set(state["priors"]) == {"skill"}
    assert state["priors"]["skill"]["optimizer"]["state"] == {}
    assert {path.name for path in shipped.iterdir()} == {
        *("README.md", "checkpoints", "config.yaml", "eval.json", "eval.npz", "imitation.jsonl"),
        *("metrics.jsonl", "policy.json", "versions.json"),
    }
    assert (shipped / "eval.json").read_bytes() == (run / "eval.json").read_bytes()


def test_an_ablation_without_skill_discriminator_is_shipped_without(tmp_path):
    run = finish(small_run(tmp_path / "run", ["algo.skill.enabled=false", TROT]))
    assert load_run(ship_policy(run, tmp_path / "shipped")).skill_prior is None


def test_nothing_tells_where_it_was_trained(shipped, loaded):
    for path in shipped.rglob("*"):
        if path.is_file():
            content = path.read_bytes()
            assert b"somewhere" not in content and b"somebody" not in content, path.name
    assert loaded.config.output_dir == "outputs" and loaded.config.motion.perturbed_folder is None


def test_the_card_tells_how_it_was_made(shipped):
    card = (shipped / "README.md").read_text()
    for fact in (
        "| command | `python -m camp.train run=smoke seed=3` |",
        "| seed | 3 |",
        "commit abc123 |",
        "| iterations | 7 |",
        "| environment steps | 672 |",  # 7 x 96
        "| wall-clock time | 12.5 min, everything included; 0.1 min in these iterations |",  # 7 x 4 x .3 s
        "torch 2.13.0, mujoco 4.0.0 |",
        "7 rows, one for each iteration |",
    ):
        assert fact in card


def test_a_resumed_run_says_so(run, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(run, copy)
    shutil.copy(copy / "versions.json", copy / "versions-00000004.json")
    assert "| iterations | 7, resumed at 4 |" in (ship_policy(copy, tmp_path / "shipped") / "README.md").read_text()


def test_a_long_learning_curve_becomes_means_of_blocks():
    rows = [{"iteration": i, "a": float(i), "steps": 1234567.0 * i} for i in range(1, 402)]
    rows[3]["b"] = 0.123456789
    curve = condensed(rows)
    assert len(curve) == 134  # 401 / 3, rounded up
    assert curve[0] == {"iteration": 3, "a": 2.0, "steps": 3703701.0}
    assert curve[1] == {"iteration": 6, "a": 5.0, "steps": 7407402.0, "b": 0.1235}
    assert curve[-1] == {"iteration": 401, "a": 400.5, "steps": 495061367.0}
    assert condensed([{"iteration": 1, "a": None}]) == [{"iteration": 1, "a": None}]


def test_a_shipped_curve_keeps_histograms():
    rows = [{"iteration": i} for i in range(1, 401)]
    rows[0] |= {"h": [1.0, 0.0, 0.0]}
    rows[1] |= {"h": [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0]}
    rows[2] |= {"h": [2.0 / 3.0, 1.0 / 3.0, 0.0]}
    assert [row.get("h") for row in condensed(rows)[:3]] == [[0.6667, 0.1667, 0.1667], [0.6667, 0.3333, 0.0], None]


def test_the_shipped_curve_is_one_that_can_be_read(shipped):
    rows = read_metrics(shipped / "metrics.jsonl")
    assert [row["iteration"] for row in rows] == [1, 2, 3, 4, 5, 6, 7]
    assert rows[1]["reward/task/raw"] == 0.6667


def test_what_cannot_be_shipped_is_told_before_anything_is_written(run, tmp_path):
    unjudged, stale, foreign = (tmp_path / name for name in ("unjudged", "stale", "foreign"))
    for copy in (unjudged, stale, foreign):
        shutil.copytree(run, copy)
    (unjudged / "eval.json").unlink()
    (stale / "eval.json").write_text(json.dumps(EVALUATION | {"iteration": 6}))
    config = (foreign / "config.yaml").read_text()
    shutil.copytree(paths.assets_root() / "motions" / "go2", tmp_path / "clips")
    (foreign / "config.yaml").write_text(config.replace("  folder: null", f"  folder: {tmp_path / 'clips'}"))
    target = tmp_path / "target"
    for folder, message in [
        (tmp_path / "none", "holds no config.yaml"),
        (unjudged, r"holds no eval.json; run `python -m camp.evaluate run=.*unjudged` first"),
        (stale, "eval.json is of iteration 6, its policy of 7"),
        (foreign, "motion.folder = .*clips': a shipped policy is judged against the shipped clips"),
    ]:
        with pytest.raises(CampError, match=message):
            ship_policy(folder, target)
    target.mkdir()
    with pytest.raises(ConfigError, match="is there already; delete it first"):
        ship_policy(run, target)
    assert list(target.iterdir()) == [] and not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        ("eval.json", "{", "eval.json: no evaluation's report (Invalid JSON"),
        ("eval.json", "[7]", "eval.json: no evaluation's report ("),
        (
            "eval.json",
            json.dumps(EVALUATION | {"policies": {}}),
            "eval.json is of a partial evaluation, without policies; run `python -m camp.",
        ),
        ("eval.json", '{"iteration": 7}', "of another format than 2, by an older or newer judge"),
        ("eval.json", json.dumps(EVALUATION | {"switching": None}), "of a partial evaluation, without switching"),
        ("eval.npz", "nothing", "eval.npz is damaged (File is not a zip file); run `python -m camp.evaluate run="),
        ("imitation.jsonl", '{"loss": 1}\n{"lo', "imitation.jsonl: no learning curve (Unterminated"),
        ("imitation.jsonl", "[1]\n", "imitation.jsonl: no learning curve ('list' object"),
        ("imitation.jsonl", '{"loss": "much"}\n', "imitation.jsonl: no learning curve (Unknown format"),
        ("metrics.jsonl", '{"iteration": 7}\n', "metrics.jsonl: hold no iteration"),
        ("versions.json", "[]", "versions.json: missing or incomplete"),
    ],
)
def test_a_damaged_record_is_one_line(run, tmp_path, capsys, file, content, message):
    damaged = tmp_path / "run"
    shutil.copytree(run, damaged)
    (damaged / file).write_text(content)
    assert run_command(ship, [f"run={damaged}", "name=mine", f"output={tmp_path / 'out'}"], "usage") == 2
    captured = capsys.readouterr()
    assert_one_line(captured.err, message)
    assert not (tmp_path / "out").exists()


def test_arrays_with_a_flipped_bit_are_damaged(run, tmp_path):
    damaged = tmp_path / "run"
    shutil.copytree(run, damaged)
    content = bytearray((damaged / "eval.npz").read_bytes())
    content[content.index(np.float64(0.02).tobytes())] ^= 1
    (damaged / "eval.npz").write_bytes(content)
    with pytest.raises(ConfigError, match=r"eval\.npz is damaged"):
        ship_policy(damaged, tmp_path / "mine")


def test_a_shipped_policy_is_not_shipped_again(shipped, tmp_path):
    """Its card could not tell resumptions and times, which its condensed record no longer holds."""
    with pytest.raises(ConfigError, match="small: is a shipped policy already; copy the folder"):
        ship_policy(shipped, tmp_path / "again")
    assert list(tmp_path.iterdir()) == []


def test_the_command(run, tmp_path, capsys):
    assert run_command(ship, [f"run={run}", "name=mine", f"output={tmp_path}"], "usage") == 0
    assert "checkpoints/checkpoint_00000007.pt" in capsys.readouterr().out
    assert load_run(tmp_path / "mine").iteration == 7
    assert run_command(ship, [f"run={run}", "name=../up", f"output={tmp_path}"], "usage") == 2
    assert "name = '../up': choose one of letters" in capsys.readouterr().err
    assert run_command(ship, [f"run={run}", "name=new", "minutes=long"], "usage") == 2
    assert capsys.readouterr().err == "error: minutes = 'long': give a number\n"
    for minutes in ("nan", "inf", "-5", "0"):
        assert run_command(ship, [f"run={run}", "name=new", f"minutes={minutes}"], "usage") == 2
        assert f"minutes = {float(minutes)}: choose a finite number above 0" in capsys.readouterr().err


def test_results_of_a_shipped_policy_go_elsewhere(tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "_PACKAGE", tmp_path / "camp")
    policy = tmp_path / "camp" / "assets" / "policies" / "go2_camp"
    assert results_folder(policy) == Path("outputs/go2_camp")
    assert results_folder(tmp_path / "outputs" / "latest") == tmp_path / "outputs" / "latest"
    policy.mkdir(parents=True)
    monkeypatch.chdir(policy.parent)
    assert results_folder(Path("go2_camp")) == Path("outputs/go2_camp")


def test_a_policy_is_shipped():
    assert (policies_root() / "go2_camp" / "config.yaml") in SHIPPED


@pytest.mark.parametrize("config", SHIPPED, ids=lambda path: path.parent.name)
def test_every_policy_in_the_package_can_be_loaded(config):
    shipped = load_run(config.parent)
    assert json.loads((config.parent / "eval.json").read_text())["iteration"] == shipped.iteration
