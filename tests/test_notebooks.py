"""The notebooks run from top to bottom and are kept without outputs."""

from __future__ import annotations

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


@pytest.mark.slow
def test_tour_runs_and_draws_two_figures():
    notebook = nbformat.read(FOLDER / "tour.ipynb", as_version=4)
    NotebookClient(
        notebook, timeout=None, startup_timeout=3600, resources={"metadata": {"path": str(FOLDER)}}
    ).execute()
    images = [o for cell in code_cells(notebook) for o in cell.outputs if "image/png" in o.get("data", {})]
    assert len(images) == 2
    printed = "".join(o.text for cell in code_cells(notebook) for o in cell.outputs if o.output_type == "stream")
    assert "measured: trot at 2.0" in printed


@pytest.mark.slow
def test_from_scratch_trains_and_draws_what_it_learns():
    notebook = nbformat.read(FOLDER / "from_scratch.ipynb", as_version=4)
    parameters = next(cell for cell in code_cells(notebook) if cell.source.startswith("ITERATIONS"))
    parameters.source = "ITERATIONS, ROBOTS, LOOK_EVERY = 3, 16, 2"
    NotebookClient(
        notebook, timeout=None, startup_timeout=3600, resources={"metadata": {"path": str(FOLDER)}}
    ).execute()
    images = [o for cell in code_cells(notebook) for o in cell.outputs if "image/png" in o.get("data", {})]
    assert len(images) == 2 + 2 * 2  # the expert's gaits; the policy's, twice
    printed = "".join(o.text for cell in code_cells(notebook) for o in cell.outputs if o.output_type == "stream")
    assert "iteration 2, " in printed and "iteration 3, " in printed
    assert "commanded pace_3hz: " in printed and "commanded pronk_3hz: " in printed
