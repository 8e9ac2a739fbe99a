"""Notebooks run from the first cell to the last, and use public names only."""

import ast
import json
from pathlib import Path

import pytest

import satAOI_adapters
import satAOI_geo

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


def code_cells(notebook: Path) -> list[str]:
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_from_the_first_cell_to_the_last(notebook: Path) -> None:
    names: dict[str, object] = {}
    for number, source in enumerate(code_cells(notebook)):
        exec(compile(source, f"{notebook.name}, code cell {number}", "exec"), names)  # noqa: S102
    assert names


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_uses_public_names_only(notebook: Path) -> None:
    public = {"satAOI_geo": satAOI_geo.__all__, "satAOI_adapters": satAOI_adapters.__all__}
    for source in code_cells(notebook):
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("satAOI"):
                assert {alias.name for alias in node.names} <= set(public[node.module or ""])


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs(notebook: Path) -> None:
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


def test_there_are_notebooks() -> None:
    assert NOTEBOOKS


def test_the_areas_are_those_of_the_narrative() -> None:
    names: dict[str, dict[int, tuple[float, float]]] = {}
    for source in code_cells(Path(__file__).parents[1] / "notebooks" / "openings.ipynb")[:2]:
        exec(source, names)  # noqa: S102
    areas_m2 = names["areas_m2"]
    # narrower than the vehicle: one room by motions, both by the paper's rule once the disc fits
    assert all(pose_m2 < 17.2 for opening_mm, (pose_m2, _) in areas_m2.items() if opening_mm < 830)
    assert all(disc_m2 > 31 for opening_mm, (_, disc_m2) in areas_m2.items() if opening_mm > 720)
    assert areas_m2[900][0] > 31
