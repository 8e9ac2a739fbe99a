"""Shapes on layers that nobody named: rooms, openings, broad lines, dashed outlines, clouds."""

import math
import random
from pathlib import Path

import numpy as np
import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.math import Matrix44
from shapely.geometry import box

from satAOI_geo.plan import FloorPlan, Kind
from tests.drawings import M, codes, drawing, plan_of, rectangle, standing

DASHES = [0.375, 0.25, -0.125]

SQUARE = [(4000, 4000), (6000, 4000), (6000, 6000), (4000, 6000)]
DIAGONALS = [((4000, 4000), (6000, 6000)), ((6000, 4000), (4000, 6000))]


def hall() -> Drawing:
    """A floor of 10 × 10 m inside walls of 0.2 m."""
    document = drawing()
    document.linetypes.add("HIDDEN", DASHES)
    rectangle(document.modelspace(), 0, 0, 10_000, 10_000, layer="WALL")
    rectangle(document.modelspace(), -200, -200, 10_200, 10_200, layer="WALL")
    return document


def shapes_in(document: Drawing, folder: Path, *boxes: tuple[float, ...]) -> FloorPlan:
    """The plan of a drawing with these rectangles on a layer that says nothing."""
    for x0, y0, x1, y1 in boxes:
        rectangle(document.modelspace(), x0, y0, x1, y1, layer="XYZ")
    return plan_of(document, folder)


def add_lines(document: Drawing, *ends: tuple[tuple[float, float], ...], layer: str) -> None:
    for start, end in ends:
        document.modelspace().add_line(start, end, dxfattribs={"layer": layer})


def said(plan: FloorPlan, code: str) -> list[str]:
    """The layers of findings of one code."""
    return [finding.layer for finding in plan.findings if finding.code == code]


@pytest.mark.parametrize(
    "pit",
    [
        (7000, 7500, 10_000, 10_000),  # in a corner
        (8200, 0, 10_000, 1600),
        (4000, 0, 6000, 1500),  # at one wall
        (50, 50, 3000, 3000),  # not quite at the walls
    ],
)
def test_pit_against_walls_is_an_obstacle_not_a_room(
    pit: tuple[float, ...], tmp_path: Path
) -> None:
    plan = shapes_in(hall(), tmp_path, pit)
    (thing,) = standing(plan, "XYZ")
    assert thing.shape.equals(box(*pit))
    assert "room-outline" not in codes(plan)


def test_pit_in_a_niche_as_deep_as_wide_is_an_obstacle(tmp_path: Path) -> None:
    document = hall()
    for x in (3800, 6000):
        rectangle(document.modelspace(), x, 0, x + 200, 2000, layer="WALL")
    assert len(standing(shapes_in(document, tmp_path, (4000, 0, 6000, 2000)), "XYZ")) == 1


def test_closet_with_a_door_in_it_is_a_room(tmp_path: Path) -> None:
    document = hall()
    rectangle(document.modelspace(), 1100, 0, 1300, 1700, layer="WALL")
    rectangle(document.modelspace(), 900, 1500, 1300, 1700, layer="WALL")
    plan = shapes_in(document, tmp_path, (0, 0, 1100, 1500))
    assert standing(plan, "XYZ") == []
    assert said(plan, "room-outline") == ["XYZ"]


def test_machine_of_lines_drawn_twice_is_one_machine(tmp_path: Path) -> None:
    document = hall()
    sides = list(zip(SQUARE, [*SQUARE[1:], SQUARE[0]], strict=True))
    add_lines(document, *sides, *((end, start) for start, end in sides), layer="XYZ")
    plan = plan_of(document, tmp_path)
    (thing,) = standing(plan, "XYZ")
    assert thing.shape.equals(box(4000, 4000, 6000, 6000))
    assert "unclassified-left-out" not in codes(plan)


@pytest.mark.parametrize("inner_mm", [0, 60])
def test_copy_or_frame_of_a_pit_makes_no_room_of_it(inner_mm: int, tmp_path: Path) -> None:
    left, right = 4000 + inner_mm, 6500 - inner_mm
    plan = shapes_in(hall(), tmp_path, (4000, 4000, 6500, 6500), (left, left, right, right))
    assert box(4000, 4000, 6500, 6500).within(plan.obstacle_region())
    assert "room-outline" not in codes(plan)


@pytest.mark.parametrize("n_closets", [0, 2, 3])
def test_niche_is_a_room_on_a_layer_of_rooms_only(n_closets: int, tmp_path: Path) -> None:
    document = hall()
    for k in range(4):
        rectangle(document.modelspace(), 2000 + 2200 * k, 0, 2200 + 2200 * k, 1500, layer="WALL")
    for k in range(n_closets):
        left = 2200 * (k + 1)
        rectangle(document.modelspace(), left, 1300, left + 1200, 1500, layer="WALL")
    # open to the hall with all of its 2 m, the closets with 0.8 m
    niches = [(2200 * k, 0, 2200 * k + 2000, 1300) for k in range(n_closets + 1)]
    plan = shapes_in(document, tmp_path, *niches)
    assert len(standing(plan, "XYZ")) == (0 if n_closets == 3 else 1)


def test_shapes_side_by_side_do_not_make_each_other_rooms(tmp_path: Path) -> None:
    pits = [(x, y, x + 1200, y + 1200) for x in (0, 1250, 2500) for y in (0, 1250, 2500)]
    assert len(standing(shapes_in(hall(), tmp_path, *pits), "XYZ")) == len(pits)


def test_two_zones_that_share_an_open_edge_fill_the_hall_as_rooms(tmp_path: Path) -> None:
    zones = [(0, 0, 4000, 10_000), (4000, 0, 10_000, 10_000)]
    plan = shapes_in(hall(), tmp_path, *zones)
    assert standing(plan, "XYZ") == []
    assert said(plan, "room-outline") == ["XYZ"]


@pytest.mark.parametrize("sides", ["outline", "lines", "walls"])
def test_rectangle_crossed_by_its_diagonals_is_an_opening(sides: str, tmp_path: Path) -> None:
    document = hall()
    if sides == "outline":
        rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="XYZ")
    elif sides == "lines":
        add_lines(document, *zip(SQUARE, [*SQUARE[1:], SQUARE[0]], strict=True), layer="XYZ")
    else:
        rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="WALL")
        rectangle(document.modelspace(), 3800, 3800, 6200, 6200, layer="WALL")
    add_lines(document, *DIAGONALS, layer="XYZ")
    plan = plan_of(document, tmp_path)
    (thing,) = standing(plan, "XYZ")
    assert thing.kind is Kind.UNCLASSIFIED
    assert thing.shape.equals(box(4000, 4000, 6000, 6000))
    (finding,) = [finding for finding in plan.findings if finding.layer == "XYZ"]
    assert finding.code == "crossed"
    assert finding.handle
    assert finding.at_mm is not None
    assert finding.remedy


def test_crossed_rectangle_is_an_opening_even_where_walls_are_all_around(tmp_path: Path) -> None:
    document = hall()
    rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="WALL")
    rectangle(document.modelspace(), 3800, 3800, 6200, 6200, layer="WALL")
    bare = shapes_in(document, tmp_path, (4000, 4000, 6000, 6000))
    assert said(bare, "room-outline") == ["XYZ"]
    add_lines(document, *DIAGONALS, layer="ABC")
    plan = plan_of(document, tmp_path)
    assert "room-outline" not in codes(plan)
    assert plan.obstacle_region().contains(box(4000, 4000, 6000, 6000))


def test_diagonals_drawn_twice_cross_a_rectangle_and_the_spokes_of_a_wheel_do_not(
    tmp_path: Path,
) -> None:
    document = hall()
    rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="XYZ")
    add_lines(document, *DIAGONALS, *[(end, start) for start, end in DIAGONALS], layer="ABC")
    assert said(plan_of(document, tmp_path), "crossed") == ["ABC"]
    spokes = [1000 * 2**0.5 * np.exp(1j * math.pi * k / 12) for k in range(12)]
    for spoke in spokes:
        ends = [(5000 + spoke.real, 5000 + spoke.imag), (5000 - spoke.real, 5000 - spoke.imag)]
        add_lines(document, tuple(ends), layer="ABC")
    assert said(plan_of(document, tmp_path), "crossed") == []


def test_cross_without_sides_is_left_out_and_said(tmp_path: Path) -> None:
    document = hall()
    add_lines(document, *DIAGONALS, layer="XYZ")
    plan = plan_of(document, tmp_path)
    assert standing(plan, "XYZ") == []
    assert said(plan, "unclassified-left-out") == ["XYZ"]


def test_dashed_cross_is_no_opening(tmp_path: Path) -> None:
    document = hall()
    document.layers.add("XYZ", linetype="HIDDEN")
    rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="XYZ")
    add_lines(document, *DIAGONALS, layer="XYZ")
    plan = plan_of(document, tmp_path)
    assert standing(plan, "XYZ") == []
    assert said(plan, "dashed") == ["XYZ"]


@pytest.mark.parametrize(("width_mm", "count"), [(20, 0), (100, 0), (150, 1)])
def test_open_line_of_a_broad_pen_is_a_line_and_one_broader_is_a_thing(
    width_mm: float, count: int, tmp_path: Path
) -> None:
    document = hall()
    document.modelspace().add_lwpolyline(
        [(5000, 0), (5000, 10_000)], dxfattribs={"layer": "XYZ", "const_width": width_mm}
    )
    plan = plan_of(document, tmp_path)
    assert len(standing(plan, "XYZ")) == count
    assert said(plan, "unclassified" if count else "unclassified-left-out") == ["XYZ"]


def test_outline_of_a_broad_pen_stops_the_robot(tmp_path: Path) -> None:
    document = hall()
    document.modelspace().add_lwpolyline(
        SQUARE, close=True, dxfattribs={"layer": "XYZ", "const_width": 20}
    )
    assert len(standing(plan_of(document, tmp_path), "XYZ")) == 1


def test_arrow_of_a_tapered_line_is_one_open_line(tmp_path: Path) -> None:
    document = hall()
    arrow = [(2000, 2000, 0, 0), (4000, 2000, 250, 0), (4500, 2000, 0, 0)]
    document.modelspace().add_lwpolyline(arrow, format="xyse", dxfattribs={"layer": "XYZ"})
    plan = plan_of(document, tmp_path)
    assert standing(plan, "XYZ") == []
    (finding,) = [f for f in plan.findings if f.code == "unclassified-left-out"]
    assert finding.handle
    assert finding.at_mm is not None
    assert finding.message.startswith("1 open line on layer 'XYZ'")


@pytest.mark.parametrize("drawn", ["outline", "layer", "lines", "block"])
def test_dashed_outline_is_left_out_and_said(drawn: str, tmp_path: Path) -> None:
    document = hall()
    space = document.modelspace()
    layer_linetype = "HIDDEN" if drawn in {"layer", "block"} else "Continuous"
    document.layers.add("XYZ", linetype=layer_linetype)
    if drawn == "block":
        rectangle(document.blocks.new("B1"), 4000, 4000, 6000, 6000, layer="0")
        space.add_blockref("B1", (0, 0), {"layer": "XYZ"})
    elif drawn == "lines":
        add_lines(document, *zip(SQUARE, [*SQUARE[1:], SQUARE[0]], strict=True), layer="XYZ")
    else:
        rectangle(space, 4000, 4000, 6000, 6000, layer="XYZ")
    for entity in space.query("*[layer=='XYZ']"):
        entity.dxf.linetype = "BYLAYER" if layer_linetype == "HIDDEN" else "HIDDEN"
    plan = plan_of(document, tmp_path)
    assert standing(plan, "XYZ") == []
    (finding,) = [finding for finding in plan.findings if finding.layer == "XYZ"]
    assert finding.code == "dashed"
    assert finding.message.startswith("1 dashed outline on layer 'XYZ', 4.00 m² together")
    assert finding.at_mm == (5000.0, 5000.0)
    assert finding.handle
    assert "--layers" in finding.remedy


def test_outline_with_one_side_that_is_not_dashed_is_an_obstacle(tmp_path: Path) -> None:
    document = hall()
    add_lines(document, *zip(SQUARE, [*SQUARE[1:], SQUARE[0]], strict=True), layer="XYZ")
    for line in document.modelspace().query("LINE")[1:]:
        line.dxf.linetype = "HIDDEN"
    assert len(standing(plan_of(document, tmp_path), "XYZ")) == 1


def test_dashed_outline_on_a_layer_with_a_meaning_is_an_obstacle(tmp_path: Path) -> None:
    document = hall()
    document.layers.add("EQUIPMENT", linetype="HIDDEN")
    rectangle(document.modelspace(), 4000, 4000, 6000, 6000, layer="EQUIPMENT")
    assert len(standing(plan_of(document, tmp_path), "EQUIPMENT")) == 1


def test_where_most_walls_are_dashed_a_dashed_outline_is_an_obstacle(tmp_path: Path) -> None:
    document = hall()
    for wall in document.modelspace():
        wall.dxf.linetype = "HIDDEN"
    document.layers.add("XYZ", linetype="HIDDEN")
    plan = shapes_in(document, tmp_path, (4000, 4000, 6000, 6000))
    assert len(standing(plan, "XYZ")) == 1


def test_fill_is_an_obstacle_whatever_its_linetype(tmp_path: Path) -> None:
    document = hall()
    on = {"layer": "XYZ", "linetype": "HIDDEN"}
    document.modelspace().add_solid([SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2]], on)
    assert len(standing(plan_of(document, tmp_path), "XYZ")) == 1


def with_bows(document: Drawing, n_bows: int, bulge: float) -> None:
    """A closed outline of equal bows around a square."""
    per_side = n_bows // 4
    corners = [
        (x0 + (x1 - x0) * k / per_side, y0 + (y1 - y0) * k / per_side, bulge)
        for (x0, y0), (x1, y1) in zip(SQUARE, [*SQUARE[1:], SQUARE[0]], strict=True)
        for k in range(per_side)
    ]
    on = {"layer": "XYZ"}
    document.modelspace().add_lwpolyline(corners, format="xyb", close=True, dxfattribs=on)


def test_revision_cloud_is_left_out_and_said(tmp_path: Path) -> None:
    document = hall()
    with_bows(document, 16, 0.5)
    plan = plan_of(document, tmp_path)
    assert standing(plan, "XYZ") == []
    assert said(plan, "revision-cloud") == ["XYZ"]


@pytest.mark.parametrize(("n_bows", "bulge"), [(16, -0.5), (4, 1.0), (16, 0.05)])
def test_flutes_piers_and_rounded_outlines_are_no_revision_clouds(
    n_bows: int, bulge: float, tmp_path: Path
) -> None:
    document = hall()
    with_bows(document, n_bows, bulge)
    assert len(standing(plan_of(document, tmp_path), "XYZ")) == 1


def test_outline_drawn_in_many_arcs_of_a_circle_is_an_obstacle(tmp_path: Path) -> None:
    document = hall()
    corners = [(1000 * math.cos(k), 1000 * math.sin(k)) for k in np.arange(16) * math.tau / 16]
    document.modelspace().add_lwpolyline(
        [(5000 + x, 5000 + y, math.tan(math.tau / 64)) for x, y in corners],
        format="xyb",
        close=True,
        dxfattribs={"layer": "XYZ"},
    )
    assert len(standing(plan_of(document, tmp_path), "XYZ")) == 1


def everything() -> Drawing:
    """Of each sort of shape one."""
    document = hall()
    with_bows(document, 16, 0.5)
    for x, y, layer in ((0, 0, "A"), (8000, 2000, "A"), (0, 8000, "B")):
        rectangle(document.modelspace(), x, y, x + 1900, y + 1800, layer=f"XYZ-{layer}")
    for outline in document.modelspace().query("*[layer=='XYZ-B']"):
        outline.dxf.linetype = "HIDDEN"
    shaft = [(8000, 8000), (10_000, 8000), (10_000, 10_000), (8000, 10_000)]
    add_lines(document, *zip(shaft, [*shaft[1:], shaft[0]], strict=True), layer="XYZ-C")
    add_lines(document, (shaft[0], shaft[2]), (shaft[1], shaft[3]), layer="XYZ-C")
    return document


@pytest.mark.parametrize("way", ["turned", "mirrored", "shuffled", "in metres"])
def test_drawing_changed_in_some_way_shows_the_same_shapes(way: str, tmp_path: Path) -> None:
    plan = plan_of(everything(), tmp_path)
    document = everything()
    space = document.modelspace()
    if way == "turned":
        transform.inplace(space, Matrix44.z_rotate(math.radians(30)))
    elif way == "mirrored":
        transform.inplace(space, Matrix44.scale(-1, 1, 1))
    elif way == "shuffled":
        random.Random(1).shuffle(space.entity_space.entities)
    else:
        transform.inplace(space, Matrix44.scale(0.001, 0.001, 0.001))
        document.header["$INSUNITS"] = M
    other = plan_of(document, tmp_path)
    sorts = {"crossed", "dashed", "revision-cloud", "unclassified"}
    assert {code for code in codes(plan) if code in sorts} == sorts
    assert sorted(codes(other)) == sorted(codes(plan))
    assert other.free_region().area == pytest.approx(plan.free_region().area, rel=1e-9)


def test_obstacle_without_a_name_is_said_with_handle_and_place(tmp_path: Path) -> None:
    plan = shapes_in(hall(), tmp_path, (4000, 4000, 6000, 6000))
    (finding,) = [finding for finding in plan.findings if finding.code == "unclassified"]
    (thing,) = standing(plan, "XYZ")
    assert finding.handle == thing.handle
    assert finding.at_mm == (5000.0, 5000.0)
