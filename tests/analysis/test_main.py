"""The command line: all figures, each as PDF and PNG, or a line for each that lacks its input."""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure

import analysis.__main__ as command
from analysis import gallery
from analysis.load import AnalysisError
from analysis.style import new_figure
from camp.deployment.provenance import condensed
from camp.runs import folder as run_folders
from tests.analysis.synthetic import metrics, write_evaluation, write_metrics
from tests.errors import assert_one_line
from tests.small_run import small_run


def _a_line(sources) -> Figure:
    figure = new_figure((1.0, 1.0))
    figure.subplots().plot([0, 1], [0, 1])
    return figure


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A run with metrics and an evaluation, of which only some figures can be drawn."""

    def missing(sources):
        raise AnalysisError("no clips: generate them with `python -m camp.dataset`")

    figures = {"training": _a_line, "clusters": missing, "empty": lambda sources: Figure()}
    monkeypatch.setattr(command, "FIGURES", figures)
    monkeypatch.chdir(tmp_path)
    return write_metrics(write_evaluation(tmp_path / "outputs" / "one"), metrics(10))


def test_what_lacks_its_input_is_left_out_and_the_others_are_drawn(folder, capsys):
    assert command.main([f"run={folder}"]) == 0
    output = capsys.readouterr()
    assert {path.name for path in (folder / "figures").iterdir()} == {
        *("training.png", "training.pdf", "empty.png", "empty.pdf")
    }
    assert [line.split("figures/")[1].split()[0] for line in output.out.splitlines()] == ["training.png", "empty.png"]
    left_out = [line for line in output.err.splitlines() if not line.startswith("drawing ")]
    assert left_out[0] == "clusters is left out: no clips: generate them with `python -m camp.dataset`"
    assert left_out[1].startswith("ablations is left out") and "make ablations" in left_out[1]


def test_draws_what_is_asked_for(folder, capsys):
    assert command.main([f"run={folder}", "only=empty,training"]) == 0
    output = capsys.readouterr()
    assert len(output.out.splitlines()) == 2 and output.err == "drawing empty\ndrawing training\n"


def test_a_figure_twice_is_the_same_file(folder):
    assert command.main([f"run={folder}", "only=training"]) == 0
    files = [folder / "figures" / f"training.{kind}" for kind in ("png", "pdf")]
    first = [file.read_bytes() for file in files]
    assert first[0][:4] == b"\x89PNG" and first[1][:4] == b"%PDF"
    assert command.main([f"run={folder}", "only=training"]) == 0
    assert [file.read_bytes() for file in files] == first


def test_figures_go_into_the_runs_own_wandb_run(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "FIGURES", {"training": _a_line})
    run = small_run(tmp_path / "run", [])
    assert command.main([f"run={run}", "only=training", "wandb=true"]) == 2  # trained with wandb_mode=disabled
    assert "trained without a W&B run" in capsys.readouterr().err
    assert command.main([f"run={run}", "only=training", "wandb=auto"]) == 0
    assert "W&B" not in capsys.readouterr().out
    config = run / "config.yaml"
    config.write_text(config.read_text().replace("wandb_mode: disabled", "wandb_mode: offline"))
    assert command.main([f"run={run}", "only=training", "wandb=auto"]) == 0
    assert "1 figures are in the W&B run" in capsys.readouterr().out
    (picture,) = (run / "wandb").glob("offline-run-*/files/media/images/figures/training_*.png")
    assert picture.read_bytes() == (run / "figures" / "training.png").read_bytes()
    assert command.main([f"run={run}", "wandb=yes"]) == 2
    assert "give true, false or auto" in capsys.readouterr().err


def test_nothing_drawn_is_an_error(folder, capsys):
    assert command.main([f"run={folder}", "only=clusters"]) == 2
    assert "error: nothing was drawn: no clips" in capsys.readouterr().err


def test_without_arguments_takes_the_newest_run(folder):
    assert command.run_folder([]).resolve() == folder.resolve()


def test_figures_that_cannot_be_written_are_one_line(folder, capsys):
    (folder / "figures").write_text("")
    assert command.main([f"run={folder}"]) == 2
    error = capsys.readouterr().err
    assert str(folder / "figures") in error and error.count("\n") == 1


def test_a_shipped_policy_stays_as_it_is(folder, tmp_path, monkeypatch, capsys):
    policies = tmp_path / "policies"
    shipped = write_metrics(write_evaluation(policies / "go2_camp"), condensed(metrics(600)))
    monkeypatch.setattr(run_folders, "policies_root", lambda: policies)
    monkeypatch.setattr(command, "policies_root", lambda: policies)
    assert command.load.evaluation_folder(shipped) == shipped
    assert command.main([f"run={shipped}", "only=training"]) == 0
    assert capsys.readouterr().out.startswith("outputs/go2_camp/figures/training.png")
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


def test_the_usage_names_every_figure():
    assert command.__doc__ is not None
    usage = " ".join(command.__doc__.split())
    assert f"{', '.join(gallery.FIGURES)}, or ablations" in usage.replace("some: ", "")
