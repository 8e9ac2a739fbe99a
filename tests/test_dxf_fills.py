"""Solid fills on layers of hatches: columns and pieces of walls where nothing else draws them."""

import math
from collections.abc import Sequence
from pathlib import Path

import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.math import Matrix44

from satAOI_adapters.dxf_read.fills import HATCHES
from satAOI_adapters.layers import Meaning, layer_table
from satAOI_geo.plan import FloorPlan, Kind
from tests.drawings import codes, drawing, plan_of, rectangle, standing

Corners = Sequence[tuple[float, float]]


def box(x0: float, y0: float, x1: float, y1: float) -> Corners:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


COLUMN = box(4000, 6800, 4500, 7300)
"""A column half a metre wide that stands 200 mm out of the wall of `hall`."""


def hall(*fills: Corners, layer: str = "PUB_HATCH", pattern: bool = False) -> Drawing:
    """A floor of 10 × 10 m with a wall 240 mm thick at 7 m, open from 6 to 8 m, and fills."""
    document = drawing()
    rectangle(document.modelspace(), 0, 7000, 6000, 7240, layer="WALL")
    rectangle(document.modelspace(), 8000, 7000, 10_000, 7240, layer="WALL")
    for corners in fills:
        hatch = document.modelspace().add_hatch(dxfattribs={"layer": layer})
        hatch.paths.add_polyline_path(corners)
        if pattern:
            hatch.set_pattern_fill("ANSI31")
    return document


def kinds(plan: FloorPlan) -> list[Kind]:
    """The kinds of what comes from the layer of hatches."""
    return [obstacle.kind for obstacle in standing(plan, "PUB_HATCH")]


def test_column_that_is_nothing_but_a_fill_stands_at_its_wall_and_is_said(tmp_path: Path) -> None:
    plan = plan_of(hall(COLUMN), tmp_path)
    assert kinds(plan) == [Kind.COLUMN]
    assert plan.obstacle_region().area == 8000 * 240 + 500 * (500 - 240)
    (finding,) = [finding for finding in plan.findings if finding.code == "fills-alone"]
    assert (finding.layer, bool(finding.handle)) == ("PUB_HATCH", True)
    assert finding.at_mm == pytest.approx((4250, 7050), abs=250)


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
def test_piece_of_wall_that_is_nothing_but_a_fill_closes_the_wall(
    turn_deg: float, tmp_path: Path
) -> None:
    document = hall(box(6000, 7000, 8000, 7240))
    transform.inplace(document.modelspace(), Matrix44.z_rotate(math.radians(turn_deg)))
    plan = plan_of(document, tmp_path)
    assert kinds(plan) == [Kind.WALL]
    assert plan.obstacle_region().area == pytest.approx(10_000 * 240, rel=1e-6)


def test_square_fill_as_large_as_a_column_is_one_wherever_it_stands(tmp_path: Path) -> None:
    assert kinds(plan_of(hall(box(2000, 2000, 2400, 2400)), tmp_path)) == [Kind.COLUMN]


def test_round_fill_as_large_as_a_column_is_one(tmp_path: Path) -> None:
    document = hall()
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "PUB_HATCH"})
    hatch.paths.add_edge_path().add_arc((2000, 2000), 300)
    (column,) = standing(plan_of(document, tmp_path), "PUB_HATCH")
    assert column.kind is Kind.COLUMN
    assert column.region().area == pytest.approx(math.pi * 300**2, rel=1e-3)


@pytest.mark.parametrize(
    "corners",
    [
        [(2000.0, 2000.0), (2400.0, 2000.0), (2200.0, 2400.0)],
        box(2000, 2000, 2100, 2100),
        box(1000, 1000, 5000, 1240),
        box(0, 2000, 10_000, 7000),
        box(1000, 6960, 1040, 7000),
    ],
    ids=["an arrow", "a dot", "a strip by itself", "a room", "a speck at a wall"],
)
def test_other_fills_are_left_out(corners: Corners, tmp_path: Path) -> None:
    plan = plan_of(hall(corners), tmp_path)
    assert kinds(plan) == []
    assert "fills-alone" not in codes(plan)


def test_pattern_is_left_out(tmp_path: Path) -> None:
    assert kinds(plan_of(hall(COLUMN, pattern=True), tmp_path)) == []


def test_fill_of_furniture_is_left_out(tmp_path: Path) -> None:
    assert standing(plan_of(hall(COLUMN, layer="FURNITURE"), tmp_path), "FURNITURE") == []


def test_fill_of_an_outlined_column_adds_nothing(tmp_path: Path) -> None:
    document = hall(COLUMN)
    rectangle(document.modelspace(), 4000, 6800, 4500, 7300, layer="COLUMN")
    assert kinds(plan_of(document, tmp_path)) == []


def test_layer_that_the_user_leaves_out_stays_out(tmp_path: Path) -> None:
    layers = tmp_path / "layers.toml"
    layers.write_text('[layers]\nignore = ["PUB_HATCH"]\n', encoding="utf-8")
    assert kinds(plan_of(hall(COLUMN), tmp_path, layers=layers)) == []


@pytest.mark.parametrize("pattern", sorted(HATCHES))
def test_names_of_hatches_are_names_to_be_left_out(pattern: str) -> None:
    ignored = [r.patterns for r in layer_table().layers if r.meaning is Meaning.IGNORE]
    assert any(pattern in patterns for patterns in ignored)
