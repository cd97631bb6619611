"""The commands of the README as they are typed, and what goes wrong with them told in one line."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from camp.build import motion_folder
from camp.cli.hydra_main import run_hydra
from camp.config.compose import compose_config
from camp.config.resolve import load_run_config
from camp.runs.checkpoint import list_checkpoints
from camp.train import train

TINY = ["sim.num_envs=8", "sim.threads=1", "run.rollout_steps=8", "motion.num_preloaded=400"]
QUIET = "logger.wandb_mode=disabled"


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "camp.train", *arguments]


def environment() -> dict[str, str]:
    # Without a GPU: on the CPU a resumed run equals an uninterrupted one.
    return {**os.environ, "OMP_NUM_THREADS": "1", "WANDB_SILENT": "true", "CUDA_VISIBLE_DEVICES": ""}


def runs_in(folder: Path) -> list[Path]:
    return sorted(path.parent for path in (folder / "outputs").glob("2*/config.yaml"))


def metrics_of(run: Path) -> list[dict]:
    rows = [json.loads(line) for line in (run / "metrics.jsonl").read_text().splitlines()]
    return [{key: value for key, value in row.items() if not key.startswith("time/")} for row in rows]


def test_three_seeds_of_an_ablation_are_three_runs_in_one_group(tmp_path):
    arguments = ["+ablation=no_skill_disc", "-m", "seed=0,1,2", "run=smoke", "run.iterations=1", *TINY]
    done = subprocess.run(command(*arguments), cwd=tmp_path, env=environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    runs = runs_in(tmp_path)
    assert len(runs) == 3
    assert [run.name.rsplit("-", 1)[1] for run in sorted(runs, key=lambda run: run.name[-1])] == [
        "seed0",
        "seed1",
        "seed2",
    ]
    assert len({(run / "wandb_id.txt").read_text() for run in runs}) == 3
    assert all(list((run / "wandb").glob("offline-run-*")) for run in runs)
    assert "wandb leet" in done.stdout and "wandb sync" in done.stdout
    assert [f"job {n} of 3: " in done.stdout for n in range(1, 5)] == [True, True, True, False]
    evaluate, compare = done.stdout.splitlines()[-2:]
    folders = [str(run.relative_to(tmp_path)) for run in sorted(runs, key=lambda run: run.name[-1])]
    assert evaluate == f"evaluate these 3 runs: python -m camp.evaluate -m run={','.join(folders)}"
    assert compare == f"then compare them: python -m analysis.seeds {' '.join(folders)}"
    first, second, _ = (metrics_of(run) for run in runs)
    assert first != second and not any(key.startswith("prior/skill") for key in first[0])


@pytest.mark.parametrize("ablation", ["no_skill_obs", "no_conditioning", "amp_baseline"])
def test_every_ablation_trains(ablation, tmp_path, capsys):
    arguments = [
        f"+ablation={ablation}",
        "run=smoke",
        "run.iterations=1",
        *TINY,
        QUIET,
        f"output_dir={tmp_path}",
    ]
    assert run_hydra("train", train, arguments) == 0
    assert len(list(tmp_path.glob(f"*-{ablation}-seed0/metrics.jsonl"))) == 1


def error_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Run a command that must fail on its input; its one line."""
    capsys.readouterr()
    assert run_hydra("train", train, arguments) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


@pytest.mark.parametrize(
    ("argument", "words"),
    [
        ("+ablation=no_skil_disc", ("no_skil_disc", "no_skill_disc")),
        ("run=smok", ("smok", "smoke")),
        ("algo.stile.weight=1", ("algo.stile", "algo.style")),
        ("sim.num_envs=none", ("sim.num_envs", "none")),
        ("algo.ppo.clip_param=-1", ("algo.ppo.clip_param", "-1", "from 1e-06")),
        ("motion.skills=[trot,canter]", ("canter", "pronk")),
        ("motion.folder=/nowhere/clips", ("/nowhere/clips", "camp.dataset")),
        ("device=cuda:99", ("cuda:99", "cpu")),
    ],
)
def test_wrong_input_is_one_line_and_leaves_nothing(argument, words, tmp_path, capsys):
    line = error_line(["run=smoke", *TINY, QUIET, f"output_dir={tmp_path}", argument], capsys)
    for word in words:
        assert word in line
    assert list(tmp_path.iterdir()) == []


def test_resuming_nothing_names_the_folder(capsys):
    line = error_line(["resume=/nowhere/run"], capsys)
    assert "/nowhere/run" in line and "camp.train" in line


def test_a_run_continues_with_its_own_configuration(tmp_path, capsys):
    assert run_hydra("train", train, ["run=smoke", *TINY, QUIET, f"output_dir={tmp_path}"]) == 0
    run = (tmp_path / "latest").resolve()
    line = error_line([f"resume={run}", "seed=3"], capsys)
    assert "seed=3" in line and "run.iterations" in line
    assert run_hydra("train", train, [f"resume={run}", "run.iterations=7"]) == 0
    assert [row["iteration"] for row in metrics_of(run)] == list(range(1, 8))


@pytest.fixture
def few_clips(tmp_path) -> Path:
    """A folder with one clip of each gait."""
    shipped, folder = motion_folder(compose_config()), tmp_path / "clips"
    folder.mkdir()
    for gait in ("trot", "pace", "bound", "pronk"):
        source = shipped / f"{gait}_3hz_forward_0.6.npz"
        shutil.copy(source, folder / source.name)
    return folder


def with_clips(folder: Path, tmp_path: Path) -> list[str]:
    return ["run=smoke", *TINY, QUIET, f"motion.folder={folder}", f"output_dir={tmp_path / 'out'}"]


def test_a_skill_without_clips_names_the_skill(few_clips, tmp_path, capsys):
    next(few_clips.glob("bound_*")).unlink()
    line = error_line(with_clips(few_clips, tmp_path), capsys)
    assert "skill 'bound': no clip in" in line and "train with motion.skills=[trot,pace,pronk]" in line
    assert not (tmp_path / "out").exists()


def test_a_corrupt_clip_names_the_file(few_clips, tmp_path, capsys):
    clip = next(few_clips.glob("pace_*"))
    clip.write_bytes(clip.read_bytes()[:2000])
    line = error_line(with_clips(few_clips, tmp_path), capsys)
    assert clip.name in line
    assert not (tmp_path / "out").exists()


def test_a_truncated_checkpoint_names_the_last_good_one(few_clips, tmp_path, capsys):
    assert run_hydra("train", train, with_clips(few_clips, tmp_path)) == 0
    run = (tmp_path / "out" / "latest").resolve()
    before = (run / "metrics.jsonl").read_bytes()
    good, bad = sorted((run / "checkpoints").glob("*.pt"))[-2:]
    bad.write_bytes(bad.read_bytes()[:5000])
    line = error_line([f"resume={run}"], capsys)
    assert bad.name in line and good.name in line
    assert (run / "metrics.jsonl").read_bytes() == before


def wait_for_iteration(folder: Path, process: subprocess.Popen, iteration: int) -> Path:
    """The only run below ``folder``, once it has a checkpoint of this iteration or a later one."""
    while process.poll() is None:
        for run in runs_in(folder):
            if any(int(path.stem.rsplit("_", 1)[1]) >= iteration for path in list_checkpoints(run)):
                return run
        time.sleep(0.02)
    pytest.fail(f"the run ended with exit code {process.returncode} before iteration {iteration}")


ENDLESS = 1_000_000  # iterations: however late the test gets to see a checkpoint, there is still something to stop
LONG = ["run=smoke", *TINY, QUIET, "run.checkpoint_every=1", "run.checkpoints_kept=3"]


class Uninterrupted:
    """Metrics of a run that nobody stops, for as many iterations as are asked for."""

    def __init__(self, folder: Path, command: list[str]):
        self._folder, self._command = folder, command
        self.output = ""
        self.run = folder

    def rows(self, iterations: int) -> list[dict]:
        """The first ``iterations`` rows; trains anew where the run was shorter."""
        found = metrics_of(self.run) if self.output else []
        if len(found) < iterations:
            folder = self._folder / f"{iterations}"
            folder.mkdir()
            done = subprocess.run(
                [*self._command, f"run.iterations={iterations}"],
                cwd=folder,
                env=environment(),
                capture_output=True,
                text=True,
            )
            assert done.returncode == 0, done.stderr
            self.output = done.stdout
            (self.run,) = runs_in(folder)
            found = metrics_of(self.run)
        return found[:iterations]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory) -> Uninterrupted:
    reference = Uninterrupted(tmp_path_factory.mktemp("uninterrupted"), command(*LONG))
    reference.rows(10)
    return reference


def test_smoke_run_from_any_folder(uninterrupted):
    run = uninterrupted.run
    assert "sim=auto: cpu (torch finds no CUDA GPU)" in uninterrupted.output
    assert load_run_config(run).sim.backend == "cpu"
    assert [row["iteration"] for row in metrics_of(run)] == list(range(1, 11))
    assert (run / "versions.json").is_file()
    assert [int(path.stem[-8:]) for path in list_checkpoints(run)[-3:]] == [8, 9, 10]
    assert (run.parent / "latest").resolve() == run.resolve()
    named = run.relative_to(run.parents[1])
    assert uninterrupted.output.endswith(f"trained; evaluate it with: python -m camp.evaluate run={named}\n")


@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_stopped_run_continues_as_if_nothing_had_happened(stop, uninterrupted, tmp_path):
    begun = command(*LONG, f"run.iterations={ENDLESS}")
    process = subprocess.Popen(begun, cwd=tmp_path, env=environment(), stdout=subprocess.DEVNULL)
    run = wait_for_iteration(tmp_path, process, 3)
    process.send_signal(stop)
    assert process.wait() != 0
    iterations = len(metrics_of(run)) + 3
    resume = command(f"resume={run.relative_to(tmp_path)}", f"run.iterations={iterations}")
    subprocess.run(resume, cwd=tmp_path, env=environment(), check=True, capture_output=True)
    assert metrics_of(run) == uninterrupted.rows(iterations)
