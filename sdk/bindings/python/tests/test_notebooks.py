"""Execute the notebooks from the first cell to the last. They assert their numbers themselves."""

from __future__ import annotations

import base64
import pathlib
from typing import Any

import pytest

NOTEBOOKS = pathlib.Path(__file__).resolve().parents[1] / "notebooks"


def read(name: str) -> Any:
    return pytest.importorskip("nbformat").read(NOTEBOOKS / name, as_version=4)


@pytest.mark.parametrize("file", sorted(path.name for path in NOTEBOOKS.glob("*.ipynb")))
def test_notebooks_are_stored_without_outputs(file: str) -> None:
    for cell in read(file).cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None


def test_the_figures_are_made(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("ipykernel")
    nbclient = pytest.importorskip("nbclient")
    notebook = read("figures.ipynb")
    nbclient.NotebookClient(notebook, timeout=900, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = [output.data["image/png"] for output in outputs if "image/png" in output.get("data", {})]
    for i, picture in enumerate(pictures):
        (tmp_path / f"figure-{i}.png").write_bytes(base64.b64decode(picture))
    assert len(pictures) == 4
    text = "".join(output.get("text", "") for output in outputs)
    assert "each of the 270 errors agrees with the command" in text
