"""The notebooks run from top to bottom and are kept without outputs."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def code_cells(notebook: nbformat.NotebookNode) -> list[nbformat.NotebookNode]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_is_kept_without_outputs(path):
    for cell in code_cells(nbformat.read(path, as_version=4)):
        assert cell.outputs == [] and cell.execution_count is None


def execute(name: str, changes: dict[str, str] | None = None) -> tuple[int, str]:
    """Run a notebook, with cells that begin as given replaced; the number of its figures and what it printed."""
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    for start, source in (changes or {}).items():
        next(cell for cell in code_cells(notebook) if cell.source.startswith(start)).source = source
    NotebookClient(
        notebook, timeout=None, startup_timeout=3600, resources={"metadata": {"path": str(FOLDER)}}
    ).execute()
    outputs = [output for cell in code_cells(notebook) for output in cell.outputs]
    figures = sum("image/png" in output.get("data", {}) for output in outputs)
    return figures, "".join(output.text for output in outputs if output.output_type == "stream")


@pytest.mark.slow
def test_tour_runs_and_draws_two_figures():
    figures, printed = execute("tour")
    assert figures == 2
    assert "measured: trot at 2.0" in printed


@pytest.mark.slow
def test_dataset_shows_that_every_clip_is_what_it_says():
    figures, printed = execute("dataset")
    assert figures == 3
    assert re.search(r"(\d+) of \1 steady clips show their gait", printed)


@pytest.mark.slow
def test_training_run_reads_the_shipped_run_and_makes_one(tmp_path):
    folder = 'folder = policies_root() / "go2_camp"'
    figures, printed = execute("training_run", {"OUTPUTS = ": f'OUTPUTS = "{tmp_path}"\n{folder}'})
    assert figures == 2
    assert "raised after 20 in a row" in printed
    assert "metrics.jsonl" in printed and "tracking/linear_error" in printed
    assert (tmp_path / "latest" / "metrics.jsonl").is_file()


@pytest.mark.slow
@pytest.mark.dtw
def test_latent_space_tells_gaits_apart_better_after_training():
    small = 'PRESET = (*PRESET, "motion.num_preloaded=4000", "algo.skill.hidden=[64,32]")'
    figures, printed = execute("latent_space", {"ROUNDS = ": f"ROUNDS, POINTS = 4, 25\n{small}"})
    assert figures == 2
    before, after = (float(one) for one in re.findall(r"K-means: accuracy ([\d.]+)%", printed))
    assert after > max(before, 70.0)
    assert len(re.findall(r"^(?:holds|does not hold): ", printed, re.MULTILINE)) == 2


@pytest.mark.slow
def test_from_scratch_trains_and_draws_what_it_learns():
    figures, printed = execute("from_scratch", {"ITERATIONS": "ITERATIONS, ROBOTS, LOOK_EVERY = 3, 16, 2"})
    assert figures == 2 + 2 * 2  # the expert's gaits; the policy's, twice
    assert "iteration 2, " in printed and "iteration 3, " in printed
    assert "commanded trot_3hz: " in printed and "commanded pronk_3hz: " in printed
