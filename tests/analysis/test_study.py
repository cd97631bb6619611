"""A study's YAML, its jobs, and how it goes on where it was cut off."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

import analysis.ablations as command
from analysis import study_runs
from analysis.study import job_of, jobs_of, read_study
from analysis.study_results import collect, condensed_curve, kept_runs, read_result, write_result
from analysis.study_runs import StudyError, carry_out, runs_folder, seconds_of, state_of
from camp.common.errors import CampError, ConfigError
from camp.common.paths import repository_root
from tests.analysis.studies import study_result
from tests.errors import assert_one_line

TINY = """
name: tiny
question: Does a study go on where it was cut off?
preset: [run=smoke, sim.num_envs=8, sim.threads=1, run.rollout_steps=8, run.checkpoint_every=1,
  motion.num_preloaded=400, motion.labels=gait, logger.wandb_mode=disabled]
arms: {arms}
seeds: [0]
iterations: 2
evaluation: [suite=short, "parts=[gait,switching]", duration_s=3.0, discard_s=1.0, walks.per_skill=1, threads=1]
thresholds: {{shown_fraction: 0.05, distinct_gaits: 4, information_bits: 1.0}}
"""


@pytest.fixture
def tiny(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "tiny.yaml"
    path.write_text(TINY.format(arms="[full, no_skill_obs]"))
    return path


def write_run(folder: Path, iteration: int, evaluated: bool = False) -> None:
    (folder / "checkpoints").mkdir(parents=True, exist_ok=True)
    torch.save({}, folder / "checkpoints" / f"checkpoint_{iteration:08d}.pt")
    if evaluated:
        (folder / "eval.json").write_text("{}")


def test_arms_by_name_are_the_files_of_ablations(tiny):
    study = read_study(tiny)
    assert study.arms == {"full": ["+ablation=full"], "no_skill_obs": ["+ablation=no_skill_obs"]}
    assert [(job.arm, job.seed) for job in jobs_of(study)] == [("full", 0), ("no_skill_obs", 0)]
    job = job_of(study, "full", 0)
    assert job.overrides[-4:] == ("variant=full", "seed=0", "run.iterations=2", "logger.wandb_tags=[tiny]")


def test_a_changed_study_has_other_runs(tiny):
    first = runs_folder(read_study(tiny), Path("outputs"))
    tiny.write_text(tiny.read_text().replace("iterations: 2", "iterations: 3"))
    assert runs_folder(read_study(tiny), Path("outputs")) != first


def test_a_further_seed_leaves_the_runs_that_are_there(tiny):
    first = read_study(tiny)
    tiny.write_text(tiny.read_text().replace("seeds: [0]", "seeds: [0, 1]"))
    further = read_study(tiny)
    assert len(jobs_of(further)) == 4 and further.digest == first.digest


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("seeds: [0]", "seeds: [zero]", ("seeds.0", "zero.yaml")),
        ("seeds: [0]", "seeds: [0, 0]", ("each once",)),
        ("iterations: 2", "iteration: 2", ("iterations",)),
        ("name: tiny", "name: Tiny-1", ("'Tiny-1'", "small letters")),
        ("no_skill_obs", "no_skil_obs", ("arm no_skil_obs",)),
        ("[full", "[[full", ("no YAML",)),
    ],
)
def test_a_wrong_study_is_one_line(old, new, words, tiny):
    path = tiny.rename(tiny.with_name("zero.yaml"))
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(ConfigError) as error:
        read_study(path)
    assert str(path) in str(error.value) and "\n" not in str(error.value)
    assert all(word in str(error.value) for word in words)


def test_an_arm_that_the_preset_undoes_is_refused(tiny):
    tiny.write_text(
        TINY.format(arms="[full, with_mismatch]").replace("preset: [", "preset: [algo.style.mismatch_fraction=0.0, ")
    )
    with pytest.raises(ConfigError, match="arms full and with_mismatch train the same"):
        read_study(tiny)
    tiny.write_text(
        tiny.read_text().replace(
            "arms: [full, with_mismatch]",
            """arms:
  full: [+ablation=full]
  with_mismatch: [+ablation=with_mismatch, algo.style.mismatch_fraction=0.5]""",
        )
    )
    assert list(read_study(tiny).arms) == ["full", "with_mismatch"]


def test_the_shipped_studies_are_whole():
    root = repository_root()
    assert root is not None
    paths = sorted((root / "ablations" / "studies").glob("*.yaml"))
    assert {"reduced", "full", "retention", "two_skills", "eight_skills", "recipe", "refinements"} == {
        read_study(path).name for path in paths
    }
    for path in paths:
        study = read_study(path)
        assert study.name == path.stem and len(study.seeds) >= (2 if study.name in ("recipe", "refinements") else 3)
        assert "algo.style.mismatch_fraction=0.0" in study.preset


def test_states_of_a_job(tiny, tmp_path):
    study = read_study(tiny)
    job, runs = job_of(study, "full", 0), tmp_path / "runs"
    assert state_of(job, runs).folder is None
    for name in ("20260101-000000-not_full-seed0", "20260101-000000-full-seed01"):
        write_run(runs / name, 2, evaluated=True)
    (runs / "20260101-000001-full-seed0").mkdir()  # ended before its first checkpoint
    assert state_of(job, runs).folder is None
    folder = runs / "20260101-000000-full-seed0"
    write_run(folder, 1)
    assert state_of(job, runs).iteration == 1 and not state_of(job, runs).done(study)
    write_run(folder, 2)
    assert not state_of(job, runs).done(study)
    write_run(folder, 2, evaluated=True)
    assert state_of(job, runs).done(study)


def test_what_was_cut_off_goes_on_and_what_is_done_is_left(tiny, tmp_path, monkeypatch):
    study, runs, given = read_study(tiny), tmp_path / "runs", []
    folder = runs / "20260101-000000-full-seed0"
    write_run(folder, 1)

    def pretend(module, arguments, job, place):
        given.append((module, arguments[0]))
        write_run(folder, 2, evaluated=module == "camp.evaluate")

    monkeypatch.setattr(study_runs, "_command", pretend)
    job = job_of(study, "full", 0)
    carry_out(job, study, runs)
    assert given == [("camp.train", f"resume={folder}"), ("camp.evaluate", f"run={folder}")]
    assert seconds_of(folder) >= 0.0 and len((folder / study_runs.SECONDS).read_text().split()) == 2
    carry_out(job, study, runs)
    assert len(given) == 2


def test_a_failed_run_names_its_log(tiny, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.executable", "false")
    study = read_study(tiny)
    with pytest.raises(StudyError, match=r"full seed 0: camp.train ended with code 1 .*full-seed0.log"):
        carry_out(job_of(study, "full", 0), study, tmp_path / "runs")


@pytest.mark.parametrize("arguments", [[], ["reduced"], ["missing.yaml"], ["tiny.yaml", "seed=3"]])
def test_a_wrong_command_line_is_one_line(arguments, tiny, capsys):
    assert command.run_command(command.run, arguments, command.__doc__) == 2
    assert_one_line(capsys.readouterr().err)


def test_results_are_read_as_they_were_written(tmp_path):
    path, result = tmp_path / "made_up.json", study_result()
    write_result(path, result)
    assert read_result(path) == result
    path.write_text(json.dumps({"study": "made_up"}))
    with pytest.raises(CampError, match=r"made_up.json: .*make ablations STUDY=ablations/studies/made_up.yaml"):
        read_result(path)


def test_runs_of_a_result_on_file_count_as_done(tiny, tmp_path):
    study, path = read_study(tiny), tmp_path / "made_up.json"
    assert kept_runs(study, path) == {}
    result = replace(study_result(), digest=study.digest)
    write_result(path, result)
    kept = kept_runs(study, path)
    assert len(kept) == 6 and kept["full", 0] in result.runs
    collected = collect(study, tmp_path / "runs", {("full", 0): kept["full", 0]})
    assert collected.runs == [kept["full", 0]] and collected.missing == ["no_skill_obs seed 0"]
    path.write_text("{}")
    with pytest.raises(CampError, match=r"made_up.json: .*delete it to begin anew"):
        kept_runs(study, path)


def test_curves_are_condensed():
    rows = [{"iteration": n, "steps": 1e4 * n, "gait/trot/accuracy": n / 100} for n in range(1, 101)]
    steps, accuracy = condensed_curve([*rows, {"iteration": 101, "steps": 2e6}])
    assert len(steps) == len(accuracy) == 40
    np.testing.assert_allclose([steps[0], steps[-1], accuracy[0], accuracy[-1]], [0.01, 1.0, 0.01, 1.0])
    assert condensed_curve([]) == ([], [])


@pytest.mark.slow
def test_a_tiny_study_is_cut_off_and_goes_on(tiny, tmp_path, monkeypatch, capsys):
    """One arm in processes of its own, by Hydra's launcher: the training is cut off, then the evaluation."""
    tiny.write_text(TINY.format(arms="[full]"))
    whole = study_runs._command

    def cut_off(module, arguments, job, runs):
        if module == "camp.evaluate":
            raise StudyError("cut off")
        if arguments[0].startswith("resume="):
            return whole(module, arguments, job, runs)
        whole(module, [*arguments, "run.iterations=1"], job, runs)
        raise StudyError("cut off")

    monkeypatch.setattr(study_runs, "_command", cut_off)
    for begun in ("run=smoke", "resume="):
        assert command.run_command(command.run, [str(tiny)], None) == 2
        printed = capsys.readouterr()
        assert "job 0: cut off" in printed.err and begun in printed.out
    monkeypatch.setattr(study_runs, "_command", whole)
    assert command.run_command(command.run, [str(tiny)], None) == 0
    printed = capsys.readouterr().out
    assert "camp.evaluate" in printed and "camp.train" not in printed and "done: 1 of 1 runs" in printed
    result = read_result(tmp_path / "ablations" / "results" / "tiny.json")
    (run,) = result.runs
    assert (run.arm, run.iterations, run.walks) == ("full", 2, 4) and run.seconds > 0.0
    assert sum(sum(row.values()) for row in run.labelled.values()) == 4
    assert result.missing == [] and result.origin["versions"]["torch"]
    assert run.origin["torch"] and run.origin["started"]
    assert command.run_command(command.run, [str(tiny)], None) == 0
    assert "1 of 1 runs are done" in capsys.readouterr().out
    (folder,) = tmp_path.glob("outputs/studies/tiny-*/2*")
    report = json.loads((folder / "eval.json").read_text())
    del report["policies"]["trained"]["labelled"]
    (folder / "eval.json").write_text(json.dumps(report))
    assert command.run_command(command.run, [str(tiny)], None) == 2
    assert_one_line(capsys.readouterr().err, "older camp")
    shutil.rmtree(folder.parent)  # as on another machine, where the result alone is
    assert command.run_command(command.run, [str(tiny)], None) == 0
    assert "1 of 1 runs are done" in capsys.readouterr().out
    assert read_result(tmp_path / "ablations" / "results" / "tiny.json").runs == [run]
    tiny.write_text(tiny.read_text().replace("iterations: 2", "iterations: 1"))  # another study of the same name
    kept = (tmp_path / "ablations" / "results" / "tiny.json").read_bytes()
    assert command.run_command(command.run, [str(tiny), "collect=only"], None) == 2
    assert_one_line(capsys.readouterr().err, "another version")
    assert (tmp_path / "ablations" / "results" / "tiny.json").read_bytes() == kept
