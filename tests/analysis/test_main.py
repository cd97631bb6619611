"""The command line: four figures, or one line that says why not."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import analysis.__main__ as command
from analysis.load import NoLatentSpaceError
from camp.deployment.provenance import condensed
from camp.gaits.schedule import GAIT_PHASES
from camp.gaits.skills import skill_set
from camp.runs import folder as run_folders
from tests.analysis.synthetic import clip_features, metrics, write_evaluation, write_metrics
from tests.errors import assert_one_line

FIGURES = ("training.png", "contacts.png", "clusters.png", "dtw.png")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An evaluated run whose networks give the synthetic features."""
    config = SimpleNamespace(motion=SimpleNamespace(skill_set=lambda: skill_set(GAIT_PHASES, "gait", [])))
    monkeypatch.setattr(command, "load_run", lambda folder: SimpleNamespace(folder=folder, config=config))
    monkeypatch.setattr(command.load, "clip_features", lambda run: clip_features(np.random.default_rng(0))[::2])
    monkeypatch.setattr(command, "POINTS_PER_SKILL", 20)
    return write_metrics(write_evaluation(tmp_path / "outputs" / "one"), metrics(10))


@pytest.mark.slow
@pytest.mark.dtw
def test_draws_four_figures_and_prints_their_paths(folder, capsys):
    assert command.main([f"run={folder}"]) == 0
    printed = capsys.readouterr().out.split()
    assert printed == [str(folder / "figures" / name) for name in FIGURES]
    assert all((folder / "figures" / name).stat().st_size > 10_000 for name in FIGURES)


def test_draws_one_kind_of_figures(folder, capsys):
    assert command.main([f"run={folder}", "only=contacts"]) == 0
    assert capsys.readouterr().out.split() == [str(folder / "figures" / "contacts.png")]


def test_without_arguments_takes_the_newest_run(folder, monkeypatch):
    monkeypatch.chdir(folder.parents[1])
    assert command.run_folder([]).resolve() == folder.resolve()


def test_figures_that_cannot_be_written_are_one_line(folder, capsys):
    (folder / "figures").write_text("")
    assert command.main([f"run={folder}"]) == 2
    error = capsys.readouterr().err
    assert str(folder / "figures") in error and error.count("\n") == 1


def test_a_run_without_a_skill_discriminator_keeps_its_other_figures(folder, monkeypatch, capsys):
    def absent(run):
        raise NoLatentSpaceError("the run has no skill discriminator")

    monkeypatch.setattr(command.load, "clip_features", absent)
    assert command.main([f"run={folder}"]) == 0
    output = capsys.readouterr()
    assert output.out.split() == [str(folder / "figures" / name) for name in FIGURES[:2]]
    assert "left out: the run has no skill discriminator" in output.err


def test_a_run_that_was_not_evaluated_has_its_learning_curves(folder, capsys):
    (folder / "eval.npz").unlink()
    assert command.main([f"run={folder}"]) == 2
    output = capsys.readouterr()
    assert output.out.split() == [str(folder / "figures" / "training.png")]
    assert "run `python -m camp.evaluate" in output.err and output.err.count("\n") == 1


def test_a_shipped_policy_stays_as_it_is(folder, tmp_path, monkeypatch, capsys):
    policies = tmp_path / "policies"
    shipped = write_metrics(write_evaluation(policies / "go2_camp"), condensed(metrics(600)))
    monkeypatch.setattr(run_folders, "policies_root", lambda: policies)
    monkeypatch.setattr(command, "policies_root", lambda: policies)
    monkeypatch.setattr(command, "draw_latent_space", lambda folder: [])
    monkeypatch.chdir(tmp_path)
    assert command.load.evaluation_folder(shipped) == shipped
    assert command.main([f"run={shipped}"]) == 0
    assert capsys.readouterr().out.split() == [f"outputs/go2_camp/figures/{name}" for name in FIGURES[:2]]
    assert {path.name for path in shipped.iterdir()} == {"eval.npz", "metrics.jsonl"}

    write_evaluation(tmp_path / "outputs" / "go2_camp")  # the user's own, which counts more, and is the newest
    assert command.load.evaluation_folder(shipped) == command.results_folder(shipped)
    assert command.run_folder([]) == shipped


@pytest.mark.parametrize(
    "arguments", [["folder"], ["run="], ["run=a", "run=b"], ["run=/no/such/folder"], ["only=pies"], []]
)
def test_errors_are_one_line_and_code_two(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert command.main(arguments) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert_one_line(output.err)
