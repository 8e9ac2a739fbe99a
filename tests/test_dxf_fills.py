"""Solid fills on layers of hatches: columns and pieces of walls where nothing else draws them."""

import math
from collections.abc import Sequence
from pathlib import Path

import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.math import Matrix44

from satAOI_adapters.dxf_read.fills import HATCHES
from satAOI_adapters.layers import layer_table
from satAOI_adapters.meanings import Meaning
from satAOI_geo.plan import FloorPlan, Kind
from tests.drawings import codes, drawing, plan_of, rectangle, standing

Corners = Sequence[tuple[float, float]]


def box(x0: float, y0: float, x1: float, y1: float) -> Corners:
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


COLUMN = box(3000, 6870, 3500, 7370)
"""A column half a metre wide between two lengths of the wall of `hall`, deeper than these."""


def hall(*fills: Corners, layer: str = "PUB_HATCH", pattern: bool = False) -> Drawing:
    """A floor of 10 × 10 m with a wall 240 mm thick at 7 m, and fills.

    It is open from 3 to 3.5 m, as wide as a column, and from 6 to 7 m, as wide as a door.
    """
    document = drawing()
    for x0, x1 in ((0, 3000), (3500, 6000), (7000, 10_000)):
        rectangle(document.modelspace(), x0, 7000, x1, 7240, layer="WALL")
    for corners in fills:
        hatch = document.modelspace().add_hatch(dxfattribs={"layer": layer})
        hatch.paths.add_polyline_path(corners)
        if pattern:
            hatch.set_pattern_fill("ANSI31")
    return document


def row(width_mm: float, depth_mm: float, *, y: float = 2000, count: int = 3) -> list[Corners]:
    """Equal rectangles, two metres apart."""
    return [box(x, y, x + width_mm, y + depth_mm) for x in range(1000, 1000 + 2000 * count, 2000)]


def kinds(plan: FloorPlan) -> list[Kind]:
    """The kinds of what comes from the layer of hatches."""
    return [obstacle.kind for obstacle in standing(plan, "PUB_HATCH")]


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
@pytest.mark.parametrize("x_scale", [1.0, -1.0])
def test_column_that_is_all_that_parts_two_walls_stands_and_is_said(
    turn_deg: float, x_scale: float, tmp_path: Path
) -> None:
    document = hall(COLUMN)
    matrix = Matrix44.scale(x_scale, 1, 1) @ Matrix44.z_rotate(math.radians(turn_deg))
    transform.inplace(document.modelspace(), matrix)
    plan = plan_of(document, tmp_path)
    assert kinds(plan) == [Kind.COLUMN]
    expected_mm2 = 8500 * 240 + 500 * 500
    assert plan.obstacle_region().area == pytest.approx(expected_mm2, rel=1e-6)
    (finding,) = [finding for finding in plan.findings if finding.code == "fills-alone"]
    assert (finding.layer, bool(finding.handle)) == ("PUB_HATCH", True)
    at = matrix.transform((3250, 7120))
    assert finding.at_mm == pytest.approx((at.x, at.y), abs=250)


def test_piece_of_wall_that_closes_a_gap_narrower_than_a_doorway_stands(tmp_path: Path) -> None:
    plan = plan_of(hall(box(3000, 7060, 3500, 7180)), tmp_path)
    assert kinds(plan) == [Kind.WALL]


@pytest.mark.parametrize("times", [1, 2])
def test_fill_at_which_lines_of_walls_end_stands(times: int, tmp_path: Path) -> None:
    document = hall(box(4000, 3000, 4600, 3600))
    for y in (3200, 3400) * times:
        document.modelspace().add_line((0, y), (4000, y), dxfattribs={"layer": "WALL"})
    assert kinds(plan_of(document, tmp_path)) == [Kind.COLUMN]


def test_fill_at_a_wall_that_goes_on_along_it_is_left_out_and_said(tmp_path: Path) -> None:
    plan = plan_of(hall(box(4000, 6500, 4500, 7000)), tmp_path)
    assert kinds(plan) == []
    (said,) = [finding for finding in plan.findings if finding.code == "fills-left-out"]
    assert (said.layer, bool(said.handle)) == ("PUB_HATCH", True)
    assert said.at_mm == pytest.approx((4250, 6750), abs=250)


@pytest.mark.parametrize("depth_mm", [240, 120])
@pytest.mark.parametrize("door", ["swings", ""])
def test_fill_of_a_doorway_leaves_it_open(door: str, depth_mm: float, tmp_path: Path) -> None:
    document = hall(box(6000, 7000, 7000, 7000 + depth_mm))
    if door:
        on = {"layer": "DOOR"}
        document.modelspace().add_arc((6000, 7060), 1000, 0, 90, dxfattribs=on)
        document.modelspace().add_line((6000, 7060), (6000, 8060), dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert kinds(plan) == []
    # a fill at a door needs no word
    assert ("fills-left-out" in codes(plan)) is not bool(door)


def test_fill_of_a_doorway_whose_jambs_are_loose_ends_leaves_it_open(tmp_path: Path) -> None:
    document = hall(box(6000, 3000, 7000, 3240))
    for y in (3000, 3240):
        for x0, x1 in ((0, 6000), (7000, 10_000)):
            document.modelspace().add_line((x0, y), (x1, y), dxfattribs={"layer": "WALL"})
    assert kinds(plan_of(document, tmp_path)) == []


def test_fills_of_three_doorways_are_no_columns(tmp_path: Path) -> None:
    document = hall(*row(800, 240, y=3000))
    for x0, x1 in ((0, 1000), (1800, 3000), (3800, 5000), (5800, 10_000)):
        rectangle(document.modelspace(), x0, 3000, x1, 3240, layer="WALL")
    assert kinds(plan_of(document, tmp_path)) == []


def test_where_fills_colour_rooms_none_is_a_column(tmp_path: Path) -> None:
    assert kinds(plan_of(hall(COLUMN, box(0, 0, 10_000, 6000)), tmp_path)) == []


@pytest.mark.parametrize("count", [2, 3])
def test_square_fills_are_columns_where_three_equal_ones_stand(count: int, tmp_path: Path) -> None:
    plan = plan_of(hall(*row(400, 400, count=count)), tmp_path)
    assert kinds(plan) == [Kind.COLUMN] * (3 if count == 3 else 0)
    assert ("fills-left-out" in codes(plan)) is (count == 2)


def test_squares_of_other_sizes_are_no_equals(tmp_path: Path) -> None:
    fills = [box(x, 2000, x + 400 + x / 100, 2400) for x in (1000, 3000, 5000)]
    assert kinds(plan_of(hall(*fills), tmp_path)) == []


def test_one_fill_drawn_three_times_is_one(tmp_path: Path) -> None:
    assert kinds(plan_of(hall(*[box(1000, 2000, 1400, 2400)] * 3), tmp_path)) == []


def test_round_fills_are_columns_where_three_equal_ones_stand(tmp_path: Path) -> None:
    document = hall()
    for x in (1000, 3000, 5000):
        hatch = document.modelspace().add_hatch(dxfattribs={"layer": "PUB_HATCH"})
        hatch.paths.add_edge_path().add_arc((x, 2000), 300)
    columns = standing(plan_of(document, tmp_path), "PUB_HATCH")
    assert len(columns) == 3
    for column in columns:
        assert column.kind is Kind.COLUMN
        assert column.region().area == pytest.approx(math.pi * 300**2, rel=1e-3)


@pytest.mark.parametrize("layer", ["FURNITURE", "SANITARY", "TEXT", "KITCHEN"])
def test_fills_that_another_layer_outlines_are_no_columns(layer: str, tmp_path: Path) -> None:
    document = hall(*row(1400, 700))
    for (x0, y0), _, (x1, y1), _ in row(1400, 700):
        rectangle(document.modelspace(), x0, y0, x1, y1, layer=layer)
    plan = plan_of(document, tmp_path)
    assert kinds(plan) == []
    assert "fills-left-out" not in codes(plan)


def test_fills_behind_texts_are_no_columns(tmp_path: Path) -> None:
    document = hall(*row(1250, 300))
    for (x, y), *_ in row(1250, 300):
        document.modelspace().add_text("OFFICE", height=200).set_placement((x + 50, y + 50))
    plan = plan_of(document, tmp_path)
    assert kinds(plan) == []
    assert "fills-left-out" not in codes(plan)


def test_equal_stripes_that_end_at_a_wall_are_markings(tmp_path: Path) -> None:
    plan = plan_of(hall(*row(120, 5000)), tmp_path)
    assert kinds(plan) == []


@pytest.mark.parametrize(
    "corners",
    [
        [(2000.0, 2000.0), (2400.0, 2000.0), (2200.0, 2400.0)],
        box(2000, 2000, 2100, 2100),
        box(1000, 1000, 5000, 1240),
        box(0, 2000, 10_000, 7000),
        box(3000, 7000, 3500, 7040),
    ],
    ids=["an arrow", "a dot", "a strip by itself", "a room", "a lining"],
)
def test_other_fills_are_left_out(corners: Corners, tmp_path: Path) -> None:
    plan = plan_of(hall(corners), tmp_path)
    assert kinds(plan) == []
    assert {"fills-alone", "fills-left-out"}.isdisjoint(codes(plan))


def test_pattern_is_left_out(tmp_path: Path) -> None:
    assert kinds(plan_of(hall(COLUMN, pattern=True), tmp_path)) == []


def test_fill_of_furniture_is_left_out(tmp_path: Path) -> None:
    assert standing(plan_of(hall(COLUMN, layer="FURNITURE"), tmp_path), "FURNITURE") == []


def test_fill_of_an_outlined_column_adds_nothing(tmp_path: Path) -> None:
    document = hall(COLUMN)
    rectangle(document.modelspace(), 3000, 6870, 3500, 7370, layer="COLUMN")
    assert kinds(plan_of(document, tmp_path)) == []


def test_layer_that_the_user_leaves_out_stays_out(tmp_path: Path) -> None:
    layers = tmp_path / "layers.toml"
    layers.write_text('[layers]\nignore = ["PUB_HATCH"]\n', encoding="utf-8")
    assert kinds(plan_of(hall(COLUMN), tmp_path, layers=layers)) == []


@pytest.mark.parametrize("pattern", sorted(HATCHES))
def test_names_of_hatches_are_names_to_be_left_out(pattern: str) -> None:
    ignored = [r.patterns.texts for r in layer_table().layers if r.meaning is Meaning.IGNORE]
    assert any(pattern in patterns for patterns in ignored)
