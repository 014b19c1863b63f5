"""The notebook of the documentation runs from its first cell to its last."""

from pathlib import Path

import nbformat
from nbclient import NotebookClient

from tests.patience import PATIENT_S

NOTEBOOK = Path(__file__).parents[2] / "docs/examples/08_times_over_length.ipynb"


def test_the_notebook_runs_and_draws(tmp_path: Path) -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells)  # as it is kept
    NotebookClient(
        notebook, timeout=PATIENT_S, resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    kinds = {kind for output in outputs for kind in output.get("data", {})}
    assert {"text/html", "image/png"} <= kinds
    assert any("largest residual" in output.get("text", "") for output in outputs)
