"""The floor of a drawing: what its layers show of it, held against what the walls enclose."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest
import shapely
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace
from ezdxf.math import Matrix44
from shapely.geometry import Polygon, box

from satAOI_geo.errors import DrawingError
from satAOI_geo.plan import Finding, FloorPlan
from tests.drawings import codes, drawing, plan_of, rectangle, standing

Outline = Callable[..., None]

HALL = box(-200, -200, 20_200, 10_200)
OFFICE = box(0, 6000, 5100, 10_000)


def hall(*, gate_mm: float) -> Drawing:
    """A hall of 20 × 10 m with an opening in its right wall, and a closed office in a corner."""
    document = drawing(floor=False)
    space = document.modelspace()
    low, high = 5000 - gate_mm / 2, 5000 + gate_mm / 2
    for x0, y0, x1, y1 in (
        (-200, -200, 0, 10_200),
        (-200, -200, 20_200, 0),
        (-200, 10_000, 20_200, 10_200),
        (20_000, 0, 20_200, low),
        (20_000, high, 20_200, 10_000),
        (0, 6000, 5100, 6100),
        (5000, 6000, 5100, 10_000),
    ):
        rectangle(space, x0, y0, x1, y1, layer="WALL")
    return document


def rooms() -> Drawing:
    """Two rooms of 6 × 6 m with an opening of 950 mm in the wall of 120 mm between them."""
    document = drawing(floor=False)
    space = document.modelspace()
    rectangle(space, -200, -200, 12_320, 6200, layer="WALL")
    inner = [(0, 0), (6000, 0), (6000, 2000), (6120, 2000), (6120, 0), (12_120, 0)]
    inner += [(12_120, 6000), (6120, 6000), (6120, 2950), (6000, 2950), (6000, 6000), (0, 6000)]
    space.add_lwpolyline(inner, close=True, dxfattribs={"layer": "WALL"})
    return document


ALL_ROOMS = box(-200, -200, 12_320, 6200)
DOORWAY = box(6000, 2000, 6120, 2950)


def pattern(space: Modelspace, x0: float, y0: float, x1: float, y1: float, *, layer: str) -> None:
    """A rectangle of tiles."""
    hatch = space.add_hatch(dxfattribs={"layer": layer})
    hatch.set_pattern_fill("ANSI37", scale=300)
    hatch.paths.add_polyline_path([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], is_closed=True)


def floor_of(plan: FloorPlan) -> shapely.Geometry:
    """The floor in the drawing's axes."""
    return shapely.affinity.translate(plan.floor, *plan.frame.origin_mm)


def free_m2(plan: FloorPlan) -> float:
    """Floor on which nothing stands."""
    return float(plan.floor.difference(plan.obstacle_region()).area) / 1e6


def said(plan: FloorPlan, code: str) -> Finding:
    """The one finding of a code."""
    (finding,) = (finding for finding in plan.findings if finding.code == code)
    return finding


@pytest.mark.parametrize("gate_mm", [3000.0, 4000.0, 6000.0])
def test_gate_is_closed_where_most_walls_would_lie_beside_the_floor(
    gate_mm: float, tmp_path: Path
) -> None:
    plan = plan_of(hall(gate_mm=gate_mm), tmp_path)
    assert floor_of(plan).equals(HALL)
    finding = said(plan, "wide-opening-closed")
    assert f"{gate_mm / 1000:.2f} m" in finding.message
    assert f"openings of up to {gate_mm / 1000:g} m" in said(plan, "floor-inferred").message
    assert finding.at_mm is not None
    assert abs(finding.at_mm[1] - 5000) < 1


def reversed_order(document: Drawing) -> None:
    """What is drawn last comes first."""
    space = document.modelspace()
    for entity in [entity.copy() for entity in space][::-1]:
        space.add_entity(entity)
    for entity in list(space)[: len(space) // 2]:
        space.delete_entity(entity)


@pytest.mark.parametrize("turn_deg", [0.0, 30.0, 137.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_closed_gate_does_not_hang_on_how_the_drawing_lies(
    turn_deg: float, sign: int, tmp_path: Path
) -> None:
    document = hall(gate_mm=4000.0)
    reversed_order(document)
    space = document.modelspace()
    turn = Matrix44.z_rotate(math.radians(turn_deg))
    mirror = Matrix44.scale(sign, 1, 1)
    transform.inplace(space, mirror @ turn)
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == pytest.approx(HALL.area, rel=1e-6)
    at_mm = said(plan, "wide-opening-closed").at_mm
    place = (mirror @ turn).transform((20_100, 5000, 0))
    assert at_mm is not None
    assert math.dist(at_mm, (place.x, place.y)) < 150


def test_walls_beside_the_floor_are_said_where_no_gate_closes_it(tmp_path: Path) -> None:
    plan = plan_of(hall(gate_mm=9000.0), tmp_path)
    assert shapely.intersection(floor_of(plan), OFFICE.buffer(-200)).area > 0
    assert free_m2(plan) < 20
    assert "wide-opening-closed" not in codes(plan)
    assert "% of the walls" in said(plan, "walls-left-out").message


def test_wall_in_the_yard_widens_no_opening(tmp_path: Path) -> None:
    document = rooms()
    # it goes on from a corner of the rooms
    rectangle(document.modelspace(), -200, -5200, 0, -200, layer="WALL")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(ALL_ROOMS.union(box(-200, -5200, 0, -200)))
    assert "walls-left-out" in codes(plan)
    assert "wide-opening-closed" not in codes(plan)


@pytest.mark.parametrize("turn_deg", [90.0, 70.0])
def test_leaves_of_a_gate_close_it_from_hinge_to_hinge(turn_deg: float, tmp_path: Path) -> None:
    document = hall(gate_mm=7000.0)
    space = document.modelspace()
    for y, start, end in ((1500, 90 - turn_deg, 90), (8500, -90, turn_deg - 90)):
        space.add_arc((20_100, y), 3500, start, end, dxfattribs={"layer": "DOOR"})
        tip = start if y == 1500 else end
        way = math.cos(math.radians(tip)), math.sin(math.radians(tip))
        open_tip = (20_100 + 3500 * way[0], y + 3500 * way[1])
        space.add_line((20_100, y), open_tip, dxfattribs={"layer": "DOOR"})
    plan = plan_of(document, tmp_path)
    # the leaves are drawn in the middle of the wall, and nothing is guessed
    assert floor_of(plan).equals(HALL.difference(box(20_100, 1500, 20_200, 8500)))
    assert "wide-opening-closed" not in codes(plan)


def test_leaf_of_a_gate_closes_it_from_its_hinge_to_its_tip(tmp_path: Path) -> None:
    document = hall(gate_mm=3500.0)
    space = document.modelspace()
    space.add_arc((20_100, 3250), 3500, 0, 90, dxfattribs={"layer": "DOOR"})
    space.add_line((20_100, 3250), (23_600, 3250), dxfattribs={"layer": "DOOR"})
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(HALL.difference(box(20_100, 3250, 20_200, 6750)))
    assert "wide-opening-closed" not in codes(plan)


@pytest.mark.parametrize("layer", ["FLOORING", "FLOOR FINISH", "A-FLOR"])
def test_tiles_of_one_room_are_not_the_whole_floor(layer: str, tmp_path: Path) -> None:
    document = rooms()
    pattern(document.modelspace(), 6120, 0, 12_120, 6000, layer=layer)
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(ALL_ROOMS)
    assert free_m2(plan) == pytest.approx(72.114)
    finding = said(plan, "floor-not-shown")
    assert (finding.layer, bool(finding.handle)) == (layer, True)
    assert "36.00 of the 72.11 m²" in finding.message
    assert [other.code for other in plan.findings if other.layer == layer] == ["floor-not-shown"]


def test_outline_of_one_room_is_not_the_whole_floor(tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), 6120, 0, 12_120, 6000, layer="A-FLOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(ALL_ROOMS)
    assert free_m2(plan) == pytest.approx(72.114)
    assert "room-outline" not in codes(plan)


def test_balcony_on_a_floor_layer_is_not_the_floor_inside(tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), 2000, 6200, 5000, 7700, layer="A-FLOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(ALL_ROOMS)
    assert "0.00 of the 72.11 m²" in said(plan, "floor-not-shown").message


def test_step_drawn_on_a_floor_layer_that_is_not_believed_stops_the_robot(tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), 2000, 2000, 4000, 3200, layer="A-FLOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(ALL_ROOMS)
    assert standing(plan, "A-FLOR")
    assert said(plan, "unclassified").layer == "A-FLOR"
    assert free_m2(plan) == pytest.approx(72.114 - 2.4)


@pytest.mark.parametrize("layer", ["FLOOR", "A-FLOR", "S-SLAB"])
def test_edge_in_the_midst_of_the_floor_is_where_it_ends(layer: str, tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), 0, 0, 4000, 6000, layer=layer)
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(0, 0, 4000, 6000))
    finding = said(plan, "floor-in-part")
    assert "24.00 of the 72.11 m²" in finding.message
    assert plan.floor_source == "layer"


def test_room_on_the_layer_that_findings_ask_for_is_the_floor(tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), 6120, 0, 12_120, 6000, layer="Floor")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(6120, 0, 12_120, 6000))
    assert "floor-in-part" in codes(plan)


def test_room_on_a_layer_that_the_user_names_is_the_floor(tmp_path: Path) -> None:
    document = rooms()
    pattern(document.modelspace(), 6120, 0, 12_120, 6000, layer="FLOORING")
    own = tmp_path / "layers.toml"
    own.write_text('[layers]\nfloor = ["FLOORING"]\n', encoding="utf-8")
    plan = plan_of(document, tmp_path, layers=own)
    assert floor_of(plan).equals(box(6120, 0, 12_120, 6000))
    assert "floor-in-part" in codes(plan)


def test_floor_larger_than_what_walls_enclose_stays_as_it_is_drawn(tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), -3000, -3000, 20_000, 12_000, layer="SLAB")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(-3000, -3000, 20_000, 12_000))
    assert not {"floor-in-part", "floor-not-shown"} & set(codes(plan))


def test_rooms_tiled_one_by_one_are_joined_by_their_doorway(tmp_path: Path) -> None:
    document = rooms()
    pattern(document.modelspace(), 0, 0, 6000, 6000, layer="FLOORING")
    pattern(document.modelspace(), 6120, 0, 12_120, 6000, layer="FLOORING")
    plan = plan_of(document, tmp_path)
    whole = shapely.union_all([box(0, 0, 6000, 6000), DOORWAY, box(6120, 0, 12_120, 6000)])
    assert floor_of(plan).equals(whole)
    assert "1 doorway between" in said(plan, "doorways-joined").message


def test_room_that_a_layer_of_floors_leaves_out_is_said_with_its_place(tmp_path: Path) -> None:
    document = rooms()
    rectangle(document.modelspace(), 0, 4000, 2000, 4100, layer="WALL")
    rectangle(document.modelspace(), 1900, 4100, 2000, 6000, layer="WALL")
    corners = [(0, 0), (12_120, 0), (12_120, 6000), (2000, 6000), (2000, 4000), (0, 4000)]
    document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": "SLAB"})
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(Polygon(corners))
    at_mm = said(plan, "floor-in-part").at_mm
    assert at_mm is not None
    assert box(0, 4100, 1900, 6000).contains(shapely.Point(at_mm))


def test_court_that_an_outline_cuts_out_of_the_floor_is_no_floor(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    for low, high in ((-200, 30_200), (0, 30_000), (4000, 26_000), (4200, 25_800)):
        rectangle(space, low, low, high, high, layer="WALL")
    rectangle(space, -200, -200, 30_200, 30_200, layer="A-FLOR")
    rectangle(space, 4000, 4000, 26_000, 26_000, layer="A-FLOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(
        box(-200, -200, 30_200, 30_200).difference(box(4000, 4000, 26_000, 26_000))
    )


def test_outline_drawn_twice_is_the_floor(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 0, 10_000, 10_000, layer="FLOOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(0, 0, 10_000, 10_000))
    assert "floor-hole" not in codes(plan)


def test_threshold_on_a_floor_layer_does_not_hide_the_floor(tmp_path: Path) -> None:
    document = rooms()
    document.modelspace().add_line((6000, 2000), (6000, 2950), dxfattribs={"layer": "A-FLOR"})
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(ALL_ROOMS)
    finding = said(plan, "floor-not-shown")
    assert finding.at_mm == (6000.0, 2000.0)
    assert "--layers" in finding.remedy
    assert finding.message.startswith("nothing of the floor is shown on 'A-FLOR' but open lines")
    assert "unclassified-left-out" not in codes(plan)


def test_lines_of_a_plan_on_a_layer_of_floors_are_refused(tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), 0, 0, 10_000, 300, layer="SLAB")
    with pytest.raises(DrawingError, match="wider than 700 mm"):
        plan_of(document, tmp_path)


@pytest.mark.parametrize("layer", ["SLAB", "S-SLAB-STEP"])
def test_outline_within_that_of_the_floor_is_cut_out_and_said(layer: str, tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), 0, 0, 10_000, 8000, layer="SLAB")
    rectangle(document.modelspace(), 2000, 2000, 4000, 4000, layer=layer)
    plan = plan_of(document, tmp_path)
    shell, hole = [(0, 0), (10_000, 0), (10_000, 8000), (0, 8000)], box(2000, 2000, 4000, 4000)
    assert floor_of(plan).equals(Polygon(shell).difference(hole))
    finding = said(plan, "floor-hole")
    assert finding.layer == layer
    assert "4.00 m²" in finding.message
    assert finding.at_mm is not None
    assert hole.contains(shapely.Point(finding.at_mm))


SLAB, HOLE = (0, 0, 20_000, 10_000), (8000, 4000, 10_000, 6000)


def four_lines(
    space: Modelspace, x0: float, y0: float, x1: float, y1: float, *, layer: str
) -> None:
    """A rectangle of loose lines."""
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        space.add_line(start, end, dxfattribs={"layer": layer})


@pytest.mark.parametrize("outline", [rectangle, four_lines])
@pytest.mark.parametrize("layer", ["FLOOR", "S-SLAB-EDGE"])
def test_hole_of_loose_lines_is_cut_out_and_said(
    outline: Outline, layer: str, tmp_path: Path
) -> None:
    document = drawing(floor=False)
    outline(document.modelspace(), *SLAB, layer=layer)
    four_lines(document.modelspace(), *HOLE, layer=layer)
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*SLAB).difference(box(*HOLE)))
    assert "4.00 m²" in said(plan, "floor-hole").message


@pytest.mark.parametrize("outline", [rectangle, four_lines])
def test_hole_drawn_closed_and_by_lines_is_one_hole(outline: Outline, tmp_path: Path) -> None:
    document = drawing(floor=False)
    outline(document.modelspace(), *SLAB, layer="FLOOR")
    rectangle(document.modelspace(), *HOLE, layer="FLOOR")
    four_lines(document.modelspace(), *HOLE, layer="FLOOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*SLAB).difference(box(*HOLE)))
    assert said(plan, "floor-hole").message.startswith("1 outline within")


def test_level_in_a_pit_of_loose_lines_is_floor(tmp_path: Path) -> None:
    document = drawing(floor=False)
    four_lines(document.modelspace(), *SLAB, layer="FLOOR")
    four_lines(document.modelspace(), 4000, 2000, 14_000, 8000, layer="FLOOR")
    four_lines(document.modelspace(), *HOLE, layer="FLOOR")
    assert plan_of(document, tmp_path).floor.area == 200e6 - 60e6 + 4e6


def test_circle_of_two_loose_arcs_in_the_floor_is_a_hole(tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), *SLAB, layer="FLOOR")
    for start_deg in (0, 180):
        document.modelspace().add_arc(
            (9000, 5000), 1000, start_deg, start_deg + 180, dxfattribs={"layer": "FLOOR"}
        )
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == pytest.approx(200e6 - math.pi * 1e6, rel=1e-4)
    assert said(plan, "floor-hole").message.startswith("1 outline within")


def test_many_small_holes_of_loose_lines_are_no_tiles(tmp_path: Path) -> None:
    document = drawing(floor=False)
    four_lines(document.modelspace(), *SLAB, layer="FLOOR")
    for i in range(30):
        x, y = 1000 + 1800 * (i % 10), 2000 + 2000 * (i // 10)
        four_lines(document.modelspace(), x, y, x + 500, y + 500, layer="FLOOR")
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 200e6 - 30 * 0.25e6
    assert said(plan, "floor-hole").message.startswith("30 outlines within")


@pytest.mark.parametrize("outline", [rectangle, four_lines])
def test_panels_between_joints_that_reach_the_edge_of_the_slab_are_floor(
    outline: Outline, tmp_path: Path
) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    outline(space, *SLAB, layer="SLAB")
    for x in (5000, 10_000, 15_000):
        space.add_line((x, 0), (x, 10_000), dxfattribs={"layer": "SLAB"})
    for y in (3000, 6000):
        space.add_line((0, y), (20_000, y), dxfattribs={"layer": "SLAB"})
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*SLAB))
    assert "floor-hole" not in codes(plan)


def test_fill_over_all_the_floor_does_not_close_its_holes(tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), *SLAB, layer="FLOOR")
    rectangle(document.modelspace(), *HOLE, layer="FLOOR")
    pattern(document.modelspace(), *SLAB, layer="FLOOR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*SLAB).difference(box(*HOLE)))


def test_open_outline_around_a_lone_column_is_no_floor(tmp_path: Path) -> None:
    document = drawing(floor=False)
    document.modelspace().add_lwpolyline(
        [(0, 0), (9000, 0), (9000, 9000), (0, 9000)], dxfattribs={"layer": "FLOOR"}
    )
    rectangle(document.modelspace(), 1000, 1000, 1300, 1300, layer="COLUMN")
    with pytest.raises(DrawingError, match="is open"):
        plan_of(document, tmp_path)


YARD = (0, 0, 30_000, 18_000)


def foundations(*, n_outside: int = 0) -> Drawing:
    """Six foundations 5.4 m apart, too far for one plan by themselves, and some far outside."""
    document = drawing(floor=False)
    places = [(x, y) for x in (3000, 10_800, 18_600) for y in (3000, 10_400)]
    places += [(60_000 + 8000 * k, 0) for k in range(n_outside)]
    for x, y in places:
        rectangle(document.modelspace(), x, y, x + 2400, y + 2000, layer="EQUIPMENT")
    return document


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
@pytest.mark.parametrize("outline", [rectangle, four_lines])
@pytest.mark.parametrize("thickness_mm", [0, 400])
def test_outline_on_a_nameless_layer_around_what_is_known_bounds_the_floor(
    thickness_mm: int, outline: Outline, turn_deg: float, tmp_path: Path
) -> None:
    document = foundations()
    space = document.modelspace()
    outline(space, *YARD, layer="XYZ")
    if thickness_mm:
        outline(space, *box(*YARD).buffer(-thickness_mm, join_style="mitre").bounds, layer="XYZ")
    transform.inplace(space, Matrix44.z_rotate(math.radians(turn_deg)))
    plan = plan_of(document, tmp_path)
    wall_m2 = (30 * 18 - 29.2 * 17.2) if thickness_mm else 0.0
    assert free_m2(plan) == pytest.approx(30 * 18 - 6 * 2.4 * 2.0 - wall_m2)
    assert not {"several-plans", "floor-guessed"} & set(codes(plan))
    finding = said(plan, "outline-as-walls")
    assert "'XYZ' (540.00 m²) encloses 100%" in finding.message
    assert finding.layer == "XYZ"
    assert finding.handle
    assert finding.at_mm is not None


def test_gate_in_an_outline_on_a_nameless_layer_is_closed(tmp_path: Path) -> None:
    document = foundations()
    corners = [(0, 7000), (0, 0), (30_000, 0), (30_000, 18_000), (0, 18_000), (0, 11_000)]
    document.modelspace().add_lwpolyline(corners, dxfattribs={"layer": "XYZ"})
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*YARD))
    assert "wide-opening-closed" in codes(plan)


@pytest.mark.parametrize("layer", ["PQR", "XYZ"])
def test_innermost_outline_around_what_is_known_bounds_the_floor_and_the_others_are_said(
    layer: str, tmp_path: Path
) -> None:
    document = foundations()
    rectangle(document.modelspace(), *YARD, layer="XYZ")
    rectangle(document.modelspace(), 2000, 2000, 22_000, 14_000, layer=layer)
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(2000, 2000, 22_000, 14_000))
    assert said(plan, "outline-as-walls").message.endswith("so do 'XYZ' (540.00 m²)")


def test_axes_on_a_nameless_layer_bound_no_floor(tmp_path: Path) -> None:
    document = foundations()
    for x in range(0, 24_001, 6000):
        document.modelspace().add_line((x, -2000), (x, 20_000), dxfattribs={"layer": "XYZ"})
    for y in range(0, 18_001, 6000):
        document.modelspace().add_line((-2000, y), (26_000, y), dxfattribs={"layer": "XYZ"})
    assert "outline-as-walls" not in codes(plan_of(document, tmp_path))


def test_joints_between_the_sides_of_an_outline_are_no_walls(tmp_path: Path) -> None:
    document = foundations()
    rectangle(document.modelspace(), *YARD, layer="XYZ")
    document.modelspace().add_line((8000, 0), (8000, 18_000), dxfattribs={"layer": "PQR"})
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*YARD))
    assert standing(plan, "PQR") == []


def test_outline_drawn_by_faces_goes_before_a_smaller_single_line(tmp_path: Path) -> None:
    document = foundations()
    rectangle(document.modelspace(), 2000, 2000, 22_000, 14_000, layer="XYZ")
    rectangle(document.modelspace(), *YARD, layer="PQR")
    inner = box(*YARD).buffer(-300, join_style="mitre").bounds
    rectangle(document.modelspace(), *inner, layer="PQR")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*YARD))


def test_rectangle_with_a_title_block_does_not_bound_the_floor_but_is_said(tmp_path: Path) -> None:
    document = foundations()
    rectangle(document.modelspace(), *YARD, layer="XYZ")
    block = [(24_000, 0), (24_000, 2000), (30_000, 2000)]
    document.modelspace().add_lwpolyline(block, dxfattribs={"layer": "XYZ"})
    plan = plan_of(document, tmp_path)
    assert "floor-guessed" in codes(plan)
    assert "'XYZ' (540.00 m²)" in said(plan, "outline-not-used").message


def test_outline_that_most_of_what_is_known_lies_outside_bounds_no_floor(tmp_path: Path) -> None:
    document = foundations(n_outside=4)
    rectangle(document.modelspace(), *YARD, layer="XYZ")
    assert "outline-as-walls" not in codes(plan_of(document, tmp_path))


def test_foundation_outside_leaves_the_outline_around_the_others(tmp_path: Path) -> None:
    document = foundations(n_outside=1)
    rectangle(document.modelspace(), *YARD, layer="XYZ")
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(*YARD))
    assert "encloses 86%" in said(plan, "outline-as-walls").message
    assert "several-plans" in codes(plan)


@pytest.mark.parametrize("known", ["WALL", "FLOOR"])
def test_outline_on_a_nameless_layer_counts_for_nothing_where_walls_or_a_floor_are_drawn(
    known: str, tmp_path: Path
) -> None:
    document = foundations()
    rectangle(document.modelspace(), *YARD, layer="XYZ")
    rectangle(document.modelspace(), 2000, 2000, 22_000, 14_000, layer=known)
    plan = plan_of(document, tmp_path)
    assert floor_of(plan).equals(box(2000, 2000, 22_000, 14_000))
    assert "outline-as-walls" not in codes(plan)


@pytest.mark.parametrize("thick_mm", [300.0, 800.0, 1900.0])
def test_outer_faces_of_thick_walls_lie_beside_no_floor(thick_mm: float, tmp_path: Path) -> None:
    document = drawing(floor=False)
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    outer = box(0, 0, 20_000, 12_000).difference(box(7750, 6000, 12_250, 12_000))
    for face in (outer, outer.buffer(-thick_mm, join_style="mitre")):
        hatch.paths.add_polyline_path(list(face.exterior.coords)[:-1])
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == pytest.approx(outer.area)
    assert "walls-left-out" not in codes(plan)
