"""What is made from a run, or before it, killed: a file that has its name is whole, and belongs to its neighbours."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from camp.build import load_run
from camp.evaluation.report import read_report
from camp.motion.clips.clip import Clip
from camp.motion.clips.store import load_clip
from tests.faults.nursery import Job, Nursery
from tests.faults.test_training import finished
from tests.faults.victims import Count, chance_of, kill_when

MOST = 4  # kills of a phase: each takes seconds before there is anything to kill
SHORT = (
    *("suite=short", "parts=[gait]", "walks.per_skill=2", "baselines=false", "video=false", "threads=1"),
    *("duration_s=4.0", "discard_s=1.0"),
)


@pytest.fixture(scope="module")
def run(nursery: Nursery, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of one iteration."""
    return finished(nursery, tmp_path_factory.mktemp("run"), 1)


def killed(job: Job, count: Count, seen: Callable[[], bool], delay_s: float) -> None:
    """Kill it then; it may have ended before, as it should."""
    alive = kill_when(job, seen, delay_s)
    assert alive or job.code == 0, job.output
    count.add(alive)


def finish(nursery: Nursery, command: list[str], folder: Path) -> Job:
    """The same command, undisturbed."""
    job = nursery.start(command, folder, "finished")
    assert job.wait() == 0, job.output
    return job


def arrays_of(clip: Clip) -> dict[str, np.ndarray]:
    return {name: value for name, value in vars(clip).items() if isinstance(value, np.ndarray)}


def test_generation(nursery: Nursery, tmp_path: Path, kills: int, count: Count, campaign: None):
    """Every clip that is there can be loaded; the next run makes the rest, equal to an uninterrupted one's."""
    command = ["camp.dataset", "perturbed", "--count", "4", "--workers", "2", "--folder"]
    reference = tmp_path / "undisturbed"
    finish(nursery, [*command, str(reference)], tmp_path)
    chance = chance_of("generation")
    for number in range(min(kills, MOST) // 2):
        folder, wanted = tmp_path / f"{number}", chance.randint(0, 3)
        job = nursery.start([*command, str(folder)], tmp_path, f"generation{number}")
        killed(job, count, lambda f=folder, n=wanted: len(list(f.glob("*.npz"))) >= n, chance.uniform(0.0, 3.0))
        for path in folder.glob("*.npz"):
            load_clip(path)
        finish(nursery, [*command, str(folder)], tmp_path)
        assert sorted(p.name for p in folder.iterdir()) == sorted(p.name for p in reference.iterdir())
        for path in folder.glob("*.npz"):
            ours, theirs = (arrays_of(load_clip(one)) for one in (path, reference / path.name))
            assert all(np.array_equal(ours[name], theirs[name]) for name in theirs)


def test_evaluation(nursery: Nursery, tmp_path: Path, run: Path, kills: int, count: Count, campaign: None):
    """eval.json is whole and stands beside its own eval.npz, or is not there; the next evaluation is undisturbed."""
    command = ["camp.evaluate", f"run={run}", *SHORT]
    finish(nursery, [*command, "seed=1"], tmp_path)
    before = (run / "eval.json").read_bytes(), (run / "eval.npz").read_bytes()
    finish(nursery, command, tmp_path)
    after = (run / "eval.json").read_bytes(), (run / "eval.npz").read_bytes()
    assert before != after
    chance = chance_of("evaluation")
    for number in range(min(kills, MOST)):
        for path, content in zip((run / "eval.json", run / "eval.npz"), before, strict=True):
            path.write_bytes(content)
        job = nursery.start(command, tmp_path, f"evaluation{number}")
        writing = number % 2  # or any moment of the walks

        def seen(job: Job = job, writing: int = writing) -> bool:
            return any(run.glob("eval.*.partial")) if writing else "walking" in job.output

        killed(job, count, seen, chance.uniform(0.0, 0.01 if writing else 2.0))
        if (run / "eval.json").is_file():
            read_report(run / "eval.json", "")
            assert ((run / "eval.json").read_bytes(), (run / "eval.npz").read_bytes()) in (before, after)
    finish(nursery, command, tmp_path)
    assert ((run / "eval.json").read_bytes(), (run / "eval.npz").read_bytes()) == after
    assert not list(run.glob("*.partial"))


def test_export(nursery: Nursery, tmp_path: Path, run: Path, kills: int, count: Count, campaign: None):
    """policy.onnx is whole or not there, policy.json only beside its own model; the next export is undisturbed."""
    command = ["camp.export", f"run={run}", f"output={tmp_path / 'reference'}"]
    finish(nursery, command, tmp_path)
    reference = tmp_path / "reference"
    model, described = (reference / "policy.onnx").read_bytes(), (reference / "policy.json").read_bytes()
    chance = chance_of("export")
    for number in range(min(kills, MOST)):
        output = tmp_path / f"{number}"
        output.mkdir()
        (output / "policy.json").write_text("{}")  # of an older export
        job = nursery.start(["camp.export", f"run={run}", f"output={output}"], tmp_path, f"export{number}")

        def seen(output: Path = output) -> bool:
            return any(output.glob("*.partial")) or not (output / "policy.json").exists()

        killed(job, count, seen if number % 2 else lambda: True, chance.uniform(0.0, 0.01 if number % 2 else 3.0))
        if (output / "policy.onnx").exists():
            assert (output / "policy.onnx").read_bytes() == model
            assert not (output / "policy.json").exists() or (output / "policy.json").read_bytes() == described
        finish(nursery, ["camp.export", f"run={run}", f"output={output}"], tmp_path)
        assert sorted(path.name for path in output.iterdir()) == ["policy.json", "policy.onnx"]
        assert (output / "policy.onnx").read_bytes() == model


def test_figures(nursery: Nursery, tmp_path: Path, run: Path, kills: int, count: Count, campaign: None):
    """A picture that is there is whole."""
    command = ["analysis", f"run={run}", "only=training"]
    finish(nursery, command, tmp_path)
    picture = run / "figures" / "training.png"
    chance = chance_of("figures")
    for number in range(min(kills, 3)):
        picture.unlink(missing_ok=True)
        job = nursery.start(command, tmp_path, f"figures{number}")
        killed(job, count, lambda: any(picture.parent.glob("*.partial")) or picture.exists(), chance.uniform(0.0, 0.01))
        if picture.exists():
            Image.open(picture).verify()
    finish(nursery, command, tmp_path)
    assert sorted(path.name for path in picture.parent.iterdir()) == ["training.pdf", "training.png"]


def test_shipping(nursery: Nursery, tmp_path: Path, kills: int, count: Count, campaign: None):
    """The shipped folder is complete or not there; the next one of that name succeeds."""
    run = finished(nursery, tmp_path / "run", 1)
    finish(nursery, ["camp.evaluate", f"run={run}", *SHORT], tmp_path)
    report = json.loads((run / "eval.json").read_text())
    whole = json.loads((Path(__file__).parents[2] / "src/camp/assets/policies/go2_camp/eval.json").read_text())
    (run / "eval.json").write_text(json.dumps(whole | {"iteration": report["iteration"]}))
    chance = chance_of("shipping")
    for number in range(min(kills, MOST)):
        command = ["camp.ship", f"run={run}", f"name=p{number}", f"output={tmp_path / 'shipped'}"]
        folder = tmp_path / "shipped" / f"p{number}"
        job = nursery.start(command, tmp_path, f"ship{number}")
        killed(job, count, lambda n=number: any(tmp_path.glob(f"shipped/*p{n}*")), chance.uniform(0.0, 0.5))
        if folder.exists():
            load_run(folder)
        else:
            finish(nursery, command, tmp_path)
        assert not list(folder.parent.glob(f".p{number}*"))
