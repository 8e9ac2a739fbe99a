"""Walls, floors and things on unnamed layers: what a person sees is what the plan holds."""

import math
import random
from itertools import pairwise
from pathlib import Path

import ezdxf
import pytest
import shapely
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace
from ezdxf.math import ConstructionArc, Matrix44, Vec3
from shapely.geometry import LineString, Polygon, box

from satAOI_geo.errors import EmptyPlanError
from satAOI_geo.plan import Kind
from tests.drawings import MM, codes, drawing, plan_of, rectangle, standing


def lines(space: Modelspace, corners: list[tuple[float, float]], *, layer: str) -> None:
    """Single LINEs from corner to corner, and back to the first."""
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        space.add_line(start, end, dxfattribs={"layer": layer})


def house(*, opening_mm: float, at: float = 2000.0, layer: str = "WALL") -> Drawing:
    """A room of 6 × 4 m inside walls 200 mm thick, drawn as lines, open at the bottom."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = MM
    corners = [
        (at, 0),
        (-200, 0),
        (-200, 4400),
        (6200, 4400),
        (6200, 0),
        (at + opening_mm, 0),
        (at + opening_mm, 200),
        (6000, 200),
        (6000, 4200),
        (0, 4200),
        (0, 200),
        (at, 200),
    ]
    lines(document.modelspace(), [(float(x), float(y)) for x, y in corners], layer=layer)
    return document


OUTSIDE = box(-200, 0, 6200, 4400)
INSIDE = box(0, 200, 6000, 4200)


@pytest.mark.parametrize("opening_mm", [760.0, 1200.0, 2500.0])
def test_inferred_floor_runs_along_the_outer_faces_and_across_the_opening(
    opening_mm: float, tmp_path: Path
) -> None:
    plan = plan_of(house(opening_mm=opening_mm), tmp_path)
    in_drawing = shapely.affinity.translate(plan.floor, *plan.frame.origin_mm)
    assert in_drawing.equals(OUTSIDE)
    assert plan.floor_source == "inferred"
    assert "floor-inferred" in codes(plan)


def test_opening_wider_than_the_widest_door_lets_the_floor_leak(tmp_path: Path) -> None:
    with pytest.raises(EmptyPlanError, match="layer FLOOR"):
        plan_of(house(opening_mm=2600.0, layer="0"), tmp_path)


def test_floor_that_nothing_encloses_is_guessed_between_named_walls_and_said(
    tmp_path: Path,
) -> None:
    document = drawing(floor=False)
    # three sides of a yard whose fourth side, of 20 m, is open
    for x0, y0, x1, y1 in ((-200, 0, 0, 8000), (20_000, 0, 20_200, 8000), (0, 7800, 20_000, 8000)):
        rectangle(document.modelspace(), x0, y0, x1, y1, layer="WALL")
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 20_400 * 8000
    assert "floor-guessed" in codes(plan)


def test_space_between_wall_faces_is_wall_and_the_room_is_not(tmp_path: Path) -> None:
    plan = plan_of(house(opening_mm=900.0), tmp_path)
    walls_mm2 = OUTSIDE.area - INSIDE.area - 900 * 200
    assert plan.obstacle_region().area == walls_mm2
    assert "wall-filled" in codes(plan)


def test_wall_ends_left_open_at_a_door_are_closed(tmp_path: Path) -> None:
    document = house(opening_mm=900.0)
    for line in document.modelspace().query("LINE"):
        if line.dxf.start.x == line.dxf.end.x and line.dxf.start.x in {2000.0, 2900.0}:
            document.modelspace().delete_entity(line)
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == OUTSIDE.area - INSIDE.area - 900 * 200


def test_niche_in_the_outer_wall_is_not_floor(tmp_path: Path) -> None:
    document = drawing(floor=False)
    # the wall's outer face steps back by 500 mm over 2 m
    outer = [(0, 0), (8000, 0), (8000, 6000), (5000, 6000), (5000, 5500), (3000, 5500)]
    outer += [(3000, 6000), (0, 6000)]
    document.modelspace().add_lwpolyline(outer, close=True, dxfattribs={"layer": "WALL"})
    rectangle(document.modelspace(), 200, 200, 7800, 5300, layer="WALL")
    plan = plan_of(document, tmp_path)
    assert plan.floor.equals(Polygon(outer))


def test_notch_outside_a_door_in_a_corner_is_not_floor(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    # an L-shaped house whose door opens beside the inner corner of the L
    outer = [(0, 0), (8000, 0), (8000, 4000), (4000, 4000), (4000, 8000), (0, 8000)]
    layer = {"layer": "WALL"}
    space.add_lwpolyline(
        [
            (5100, 4000),
            *[(4000, 4000), (4000, 8000), (0, 8000), (0, 0)],
            (8000, 0),
            (8000, 4000),
            (6000, 4000),
        ],
        dxfattribs=layer,
    )
    plan = plan_of(document, tmp_path)
    assert plan.floor.equals(Polygon(outer))


def test_room_drawn_as_a_closed_outline_on_a_wall_layer_is_not_filled(tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), 0, 0, 6400, 4400, layer="WALL")
    rectangle(document.modelspace(), 200, 200, 6200, 4200, layer="WALL")
    plan = plan_of(document, tmp_path)
    assert plan.free_region().area == 6000 * 4000
    assert "wide-outline" in codes(plan)


def test_thin_closed_outline_on_a_wall_layer_is_solid(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 5000, 1240, layer="A-WALL")
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == 4000 * 240


def test_wall_filled_twice_counts_once(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 5000, 1240, layer="WALL")
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    hatch.paths.add_polyline_path([(1000, 1000), (5000, 1000), (5000, 1240), (1000, 1240)])
    assert plan_of(document, tmp_path).obstacle_region().area == 4000 * 240


@pytest.mark.parametrize("layer", ["COLUMN", "HOLE", "EMBEDDED", "EQUIPMENT"])
def test_loop_of_lines_is_solid(layer: str, tmp_path: Path) -> None:
    document = drawing()
    lines(document.modelspace(), [(0, 0), (300, 0), (300, 400), (0, 400)], layer=layer)
    (obstacle,) = standing(plan_of(document, tmp_path), layer)
    assert obstacle.shape.equals(box(0, 0, 300, 400))
    assert obstacle.kind is Kind(layer.lower())


def test_two_squares_and_a_stray_line_are_two_solids_and_a_line(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    lines(space, [(0, 0), (300, 0), (300, 300), (0, 300)], layer="COLUMN")
    lines(space, [(1000, 0), (1300, 0), (1300, 300), (1000, 300)], layer="COLUMN")
    space.add_line((5000, 5000), (6000, 5000), dxfattribs={"layer": "COLUMN"})
    shapes = [obstacle.shape for obstacle in standing(plan_of(document, tmp_path), "COLUMN")]
    assert sorted(type(shape).__name__ for shape in shapes) == ["LineString", "Polygon", "Polygon"]


def test_corner_open_by_less_than_a_millimetre_is_closed_and_counted(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    corners = [(0.0, 0.0), (300.0, 0.0), (300.0, 300.0), (0.0, 300.0)]
    for (x0, y0), (x1, y1) in zip(corners, [*corners[1:], corners[0]], strict=True):
        space.add_line((x0, y0), (x1 + 0.4, y1 - 0.3), dxfattribs={"layer": "COLUMN"})
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == pytest.approx(300 * 300, rel=0.01)
    assert "gap-closed" in codes(plan)


@pytest.mark.parametrize("seed", range(5))
def test_walls_drawn_twice_with_a_trembling_hand_are_the_same_walls(
    seed: int, tmp_path: Path
) -> None:
    rng = random.Random(seed)

    def near(spot: Vec3) -> Vec3:
        # two ends are at most a millimetre apart
        return spot + Vec3.from_deg_angle(rng.uniform(0, 360), rng.uniform(0, 0.5))

    document = house(opening_mm=900.0)
    space = document.modelspace()
    for line in list(space.query("LINE")):
        for _ in range(2):
            space.add_line(near(line.dxf.start), near(line.dxf.end), dxfattribs={"layer": "WALL"})
        space.delete_entity(line)
    plan = plan_of(document, tmp_path)
    assert {obstacle.kind for obstacle in plan.obstacles} == {Kind.WALL}
    walls = OUTSIDE.difference(INSIDE).difference(box(2000, 0, 2900, 200))
    blocked = shapely.affinity.translate(plan.obstacle_region(), *plan.frame.origin_mm)
    assert blocked.symmetric_difference(walls).area <= walls.length * 1.0
    floor = shapely.affinity.translate(plan.floor, *plan.frame.origin_mm)
    assert floor.symmetric_difference(OUTSIDE).area <= OUTSIDE.length * 1.0


def test_wider_gap_is_left_open_and_reported_with_both_ends(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_lwpolyline(
        [(50, 62), (50, 350), (350, 350), (350, 50), (50, 50)], dxfattribs={"layer": "COLUMN"}
    )
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == 0
    (gap,) = [finding for finding in plan.findings if finding.code == "gap-open"]
    assert "12.0 mm" in gap.message
    assert gap.at_mm is not None


def test_door_leaves_and_swings_never_stop_the_robot(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    space.add_arc((5000, 5000), 900, 0, 90, dxfattribs={"layer": "A-DOOR"})
    space.add_line((5000, 5000), (5000, 5900), dxfattribs={"layer": "A-DOOR"})
    leaf = document.blocks.new("Door_90")
    leaf.add_line((0, 0), (0, 900))
    space.add_blockref("Door_90", (2000, 2000), {"layer": "WALL"})
    rectangle(space, 7000, 7000, 7300, 7300, layer="COLUMN")
    assert {obstacle.layer for obstacle in plan_of(document, tmp_path).obstacles} == {"COLUMN"}


def test_window_stops_the_robot(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_line((1000, 0), (3000, 0), dxfattribs={"layer": "A-GLAZ"})
    (window,) = standing(plan_of(document, tmp_path), "A-GLAZ")
    assert window.kind is Kind.WALL


def with_opening(*across_mm: float) -> Drawing:
    """A wall 200 mm thick with an opening of 1200 mm, and lines across it on the door layer."""
    document = drawing()
    rectangle(document.modelspace(), 0, 5000, 4000, 5200, layer="WALL")
    rectangle(document.modelspace(), 5200, 5000, 10_000, 5200, layer="WALL")
    for y in across_mm:
        document.modelspace().add_line((4000, y), (5200, y), dxfattribs={"layer": "A-DOOR"})
    return document


def test_window_on_the_door_layer_stops_the_robot_and_is_said(tmp_path: Path) -> None:
    plan = plan_of(with_opening(5000, 5100, 5200), tmp_path)
    assert plan.obstacle_region().covers(box(4000, 5000, 5200, 5200))
    assert "window-on-door-layer" in codes(plan)


def test_window_drawn_as_an_outline_and_a_line_on_the_door_layer_stops_the_robot(
    tmp_path: Path,
) -> None:
    document = with_opening(5100)
    rectangle(document.modelspace(), 4000, 5000, 5200, 5200, layer="A-DOOR")
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().covers(box(4000, 5000, 5200, 5200))


def test_threshold_of_two_lines_is_no_window(tmp_path: Path) -> None:
    plan = plan_of(with_opening(5000, 5200, 5200), tmp_path)
    assert standing(plan, "A-DOOR") == []


@pytest.mark.parametrize("thresholds_mm", [(), (5000,), (5000, 5200)])
def test_leaf_of_a_door_that_is_shut_is_no_glass(
    thresholds_mm: tuple[float, ...], tmp_path: Path
) -> None:
    document = with_opening(*thresholds_mm)
    rectangle(document.modelspace(), 4000, 5080, 5200, 5120, layer="A-DOOR")
    plan = plan_of(document, tmp_path)
    assert standing(plan, "A-DOOR") == []
    assert "window-on-door-layer" not in codes(plan)


def test_frame_with_glass_in_it_between_two_faces_is_a_window_and_its_place_is_said(
    tmp_path: Path,
) -> None:
    document = with_opening(5000, 5100, 5200)
    rectangle(document.modelspace(), 4000, 5070, 5200, 5130, layer="A-DOOR")
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().covers(box(4000, 5000, 5200, 5200))
    (said,) = [finding for finding in plan.findings if finding.code == "window-on-door-layer"]
    assert "in 1 openings" in said.message
    assert said.at_mm in {(4000.0, 5000.0), (4000.0, 5070.0)}
    assert said.handle


def test_outlines_side_by_side_from_face_to_face_are_panes_and_no_leaves(tmp_path: Path) -> None:
    document = with_opening()
    for y in (5000, 5050, 5100, 5150):
        rectangle(document.modelspace(), 4000, y, 5200, y + 50, layer="A-DOOR")
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().covers(box(4000, 5000, 5200, 5200))


def test_leaf_drawn_twice_between_thresholds_is_a_leaf(tmp_path: Path) -> None:
    document = with_opening(5000, 5200)
    for _ in range(2):
        rectangle(document.modelspace(), 4000, 5080, 5200, 5120, layer="A-DOOR")
    assert standing(plan_of(document, tmp_path), "A-DOOR") == []


def test_dashed_lines_on_the_door_layer_are_no_glass(tmp_path: Path) -> None:
    document = with_opening(5000, 5200)
    document.linetypes.add("DASHED", [18.0, 12.0, -6.0])
    document.modelspace().add_line(
        (4000, 5100), (5200, 5100), dxfattribs={"layer": "A-DOOR", "linetype": "DASHED"}
    )
    assert standing(plan_of(document, tmp_path), "A-DOOR") == []


def test_where_windows_have_a_layer_what_is_drawn_alike_on_that_of_doors_is_a_door_and_said(
    tmp_path: Path,
) -> None:
    document = with_opening(5000, 5080, 5120, 5200)
    document.modelspace().add_line((7000, 5300), (8000, 5300), dxfattribs={"layer": "A-GLAZ"})
    plan = plan_of(document, tmp_path)
    assert standing(plan, "A-DOOR") == []
    (said,) = [finding for finding in plan.findings if finding.code == "window-on-door-layer"]
    assert "taken as a door" in said.message


def test_opening_with_a_swing_is_no_window(tmp_path: Path) -> None:
    document = with_opening(5000, 5100, 5200)
    on = {"layer": "A-DOOR"}
    document.modelspace().add_arc((4000, 5200), 1200, 0, 90, dxfattribs=on)
    assert standing(plan_of(document, tmp_path), "A-DOOR") == []


def test_opening_with_a_swing_of_straight_lines_is_no_window(tmp_path: Path) -> None:
    document = with_opening(5000, 5100, 5200)
    on = {"layer": "A-DOOR"}
    turns_rad = [math.radians(turn_deg) for turn_deg in (0, 30, 60, 90)]
    spots = [(4000 + 1200 * math.cos(t), 5200 + 1200 * math.sin(t)) for t in turns_rad]
    document.modelspace().add_lwpolyline(spots, dxfattribs=on)
    document.modelspace().add_line((4000, 5200), spots[-1], dxfattribs=on)
    assert standing(plan_of(document, tmp_path), "A-DOOR") == []


def test_column_is_no_inside_of_a_wall(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_line((0, 5000), (4000, 5000), dxfattribs={"layer": "WALL"})
    rectangle(document.modelspace(), 4000, 4900, 4300, 5200, layer="COLUMN")
    plan = plan_of(document, tmp_path)
    assert [o.kind for o in plan.obstacles if o.shape.area] == [Kind.COLUMN]


def test_partition_drawn_on_the_door_layer_is_a_wall(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "A-DOOR"}
    space.add_lwpolyline([(1000, 1000), (1000, 5000), (4000, 5000)], dxfattribs=on)
    space.add_line((6000, 1000), (6900, 1000), dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert [o.shape for o in standing(plan, "A-DOOR")] == [
        LineString([(1000, 1000), (1000, 5000)]),
        LineString([(1000, 5000), (4000, 5000)]),
    ]
    assert "wall-on-door-layer" in codes(plan)


def test_stub_between_a_door_and_a_corner_of_such_a_partition_is_wall_and_the_door_is_not(
    tmp_path: Path,
) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "A-DOOR"}
    # a corner of two walls 100 mm thick; on the one a door, 150 mm from the corner
    space.add_lwpolyline([(1000, 1000), (1000, 5000), (850, 5000)], dxfattribs=on)
    space.add_lwpolyline([(1100, 1000), (1100, 5100), (850, 5100)], dxfattribs=on)
    space.add_line((850, 5000), (850, 5100), dxfattribs=on)
    space.add_line((1000, 1000), (3000, 1000), dxfattribs=on)
    space.add_line((1000, 900), (3000, 900), dxfattribs=on)
    # its threshold joins the stub's face end to end
    space.add_line((850, 5000), (-50, 5000), dxfattribs=on)
    rectangle(space, 7000, 7000, 7300, 7300, layer="COLUMN")
    blocked = plan_of(document, tmp_path).obstacle_region()
    assert blocked.intersects(box(850, 5000, 1000, 5100))
    assert not blocked.intersects(box(0, 4990, 840, 5110))


def test_drawing_without_a_known_layer_is_all_walls(tmp_path: Path) -> None:
    plan = plan_of(house(opening_mm=900.0, layer="0"), tmp_path)
    assert {obstacle.kind for obstacle in plan.obstacles} == {Kind.WALL}
    assert "all-walls" in codes(plan)


def test_closed_shape_on_an_unknown_layer_is_an_obstacle_and_said(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 100, 100, 200, 200, layer="COLUMN")
    rectangle(document.modelspace(), 4000, 4000, 5000, 4500, layer="XYZ")
    document.modelspace().add_line((0, 8000), (9000, 8000), dxfattribs={"layer": "XYZ"})
    plan = plan_of(document, tmp_path)
    (thing,) = standing(plan, "XYZ")
    assert thing.kind is Kind.UNCLASSIFIED
    assert thing.shape.equals(box(4000, 4000, 5000, 4500))
    assert "unclassified" in codes(plan)


def test_pattern_hatch_on_an_unknown_layer_is_no_obstacle(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 100, 100, 200, 200, layer="COLUMN")
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "XYZ"})
    hatch.set_pattern_fill("ANSI31")
    hatch.paths.add_polyline_path([(1000, 1000), (5000, 1000), (5000, 3000), (1000, 3000)])
    assert standing(plan_of(document, tmp_path), "XYZ") == []


def test_sheet_frame_around_the_floor_is_no_obstacle(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 100, 100, 200, 200, layer="COLUMN")
    rectangle(document.modelspace(), -3000, -3000, 15_000, 12_000, layer="XYZ")
    assert standing(plan_of(document, tmp_path), "XYZ") == []


def test_outline_of_a_room_on_an_unknown_layer_is_no_obstacle(tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), 0, 0, 6400, 4400, layer="WALL")
    rectangle(document.modelspace(), 200, 200, 6200, 4200, layer="WALL")
    rectangle(document.modelspace(), 200, 200, 6200, 4200, layer="XYZ")
    plan = plan_of(document, tmp_path)
    assert standing(plan, "XYZ") == []
    assert "room-outline" in codes(plan)


def test_floor_of_tiles_leaves_out_the_pool(tmp_path: Path) -> None:
    document = drawing(floor=False)
    space = document.modelspace()
    on = {"layer": "FLOORING"}
    pool = box(3000, 3000, 7000, 7000)
    for k in range(11):
        for line in (
            LineString([(1000 * k, 0), (1000 * k, 10_000)]),
            LineString([(0, 1000 * k), (10_000, 1000 * k)]),
        ):
            dry = line.difference(pool) if not pool.touches(line) else line
            for part in getattr(dry, "geoms", [dry]):
                space.add_line(part.coords[0], part.coords[-1], dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 10_000**2 - 4000**2
    assert "floor-without-tiles" in codes(plan)


def test_courtyard_arc_wall_is_filled_between_its_faces(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "WALL"}
    for radius in (3000, 3200):
        space.add_arc((0, 0), radius, 0, 90, dxfattribs=on)
    space.add_line((3000, 0), (3200, 0), dxfattribs=on)
    space.add_line((0, 3000), (0, 3200), dxfattribs=on)
    ring_mm2 = math.pi * (3200**2 - 3000**2) / 4
    wall_mm2 = plan_of(document, tmp_path).obstacle_region().area
    assert 0 <= wall_mm2 - ring_mm2 < 0.02 * math.pi * 3200


@pytest.mark.parametrize(
    ("layer", "kind"), [("A-WALL-PATT", Kind.WALL), ("柱填充", Kind.COLUMN), ("PATTERN", None)]
)
def test_walls_and_columns_that_are_nothing_but_fills_are_read_from_pattern_layers(
    layer: str, kind: Kind | None, tmp_path: Path
) -> None:
    document = drawing()
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": layer})
    hatch.paths.add_polyline_path([(1000, 1000), (5000, 1000), (5000, 1240), (1000, 1240)])
    plan = plan_of(document, tmp_path)
    assert {o.kind for o in plan.obstacles} == ({kind} if kind else set())
    assert ("fills-only" in codes(plan)) == (kind is not None)


def test_floor_between_walls_that_are_nothing_but_fills_is_guessed_as_between_others(
    tmp_path: Path,
) -> None:
    document = drawing(floor=False)
    for bottom in (0, 4000):
        hatch = document.modelspace().add_hatch(dxfattribs={"layer": "A-WALL-PATT"})
        corners = [(0, bottom), (5000, bottom), (5000, bottom + 240), (0, bottom + 240)]
        hatch.paths.add_polyline_path(corners)
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == 5000 * 4240
    assert "floor-guessed" in codes(plan)


def test_fills_on_pattern_layers_count_for_nothing_beside_walls(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 3000, 5000, 3240, layer="A-WALL")
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "A-WALL-PATT"})
    hatch.paths.add_polyline_path([(1000, 1000), (5000, 1000), (5000, 1240), (1000, 1240)])
    plan = plan_of(document, tmp_path)
    assert {o.layer for o in plan.obstacles} == {"A-WALL"}


def tiled(columns: int, rows: int, *, joint_mm: float = 10.0) -> Drawing:
    """Tiles of 1 m with joints, as loose lines on layer 0 inside a wall of 200 mm."""
    document = drawing(floor=False)
    space = document.modelspace()
    for i in range(columns):
        for j in range(rows):
            left, bottom = 1000.0 * i + joint_mm / 2, 1000.0 * j + joint_mm / 2
            right, top = left + 1000 - joint_mm, bottom + 1000 - joint_mm
            corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
            lines(space, corners, layer="0")
    right, top = 1000.0 * columns, 1000.0 * rows
    lines(space, [(0, 0), (right, 0), (right, top), (0, top)], layer="0")
    outer = [(-200, -200), (right + 200, -200), (right + 200, top + 200), (-200, top + 200)]
    lines(space, outer, layer="0")
    return document


@pytest.mark.parametrize("joint_mm", [10.0, 0.0])
def test_joints_of_tiles_are_no_walls_and_what_is_around_them_is(
    joint_mm: float, tmp_path: Path
) -> None:
    document = tiled(6, 5, joint_mm=joint_mm)
    # a column that cuts a tile
    lines(
        document.modelspace(), [(2050, 2050), (2150, 2050), (2150, 2150), (2050, 2150)], layer="0"
    )
    plan = plan_of(document, tmp_path)
    assert "tile-joints" in codes(plan)
    inside = box(100, 100, 5900, 4900)
    blocked = shapely.affinity.translate(plan.obstacle_region(), *plan.frame.origin_mm)
    assert blocked.intersection(inside).equals(box(2050, 2050, 2150, 2150))
    lines_left = shapely.union_all([o.region() for o in plan.obstacles if o.handle])
    lines_left = shapely.affinity.translate(lines_left, *plan.frame.origin_mm)
    assert lines_left.intersection(inside).length == 4 * 100
    assert plan.floor.area == 6400 * 5400


@pytest.mark.parametrize(("columns", "rows"), [(2, 12), (4, 4)])
def test_equal_rooms_of_which_each_may_have_a_door_or_that_are_few_are_no_tiles(
    columns: int, rows: int, tmp_path: Path
) -> None:
    plan = plan_of(tiled(columns, rows, joint_mm=0.0), tmp_path)
    assert "tile-joints" not in codes(plan)


def test_nothing_is_a_tile_on_a_layer_of_walls(tmp_path: Path) -> None:
    document = tiled(6, 5)
    for entity in document.modelspace():
        entity.dxf.layer = "WALL"
    assert "tile-joints" not in codes(plan_of(document, tmp_path))


def test_walls_on_a_nameless_layer_beside_doors_are_told_by_their_look(tmp_path: Path) -> None:
    document = house(opening_mm=900.0, layer="A-B2321-E")
    space = document.modelspace()
    space.add_arc((2000, 200), 900, 0, 90, dxfattribs={"layer": "A-DOOR"})
    rectangle(space, 4000, 2000, 4300, 2300, layer="S-COLS")
    lines(space, [(4500, 500), (5500, 500), (5500, 1500), (4500, 1500)], layer="Layer3")
    plan = plan_of(document, tmp_path)
    walls = [obstacle for obstacle in plan.obstacles if obstacle.kind is Kind.WALL]
    assert {wall.layer for wall in walls} == {"A-B2321-E"}
    area_mm2 = OUTSIDE.area - INSIDE.area - 900 * 200
    assert shapely.union_all([wall.region() for wall in walls]).area == area_mm2
    assert "walls-by-look" in codes(plan)


def test_walls_on_a_nameless_layer_among_columns_are_told_by_their_look(tmp_path: Path) -> None:
    document = house(opening_mm=900.0, layer="100 Baukörper")
    rectangle(document.modelspace(), 4000, 2000, 4300, 2300, layer="Stützen")
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == OUTSIDE.area
    assert "walls-by-look" in codes(plan)


@pytest.mark.parametrize("sign", ["A-WALL", "FLOOR"])
def test_nothing_is_told_by_its_look_where_walls_or_floor_are_named(
    sign: str, tmp_path: Path
) -> None:
    document = house(opening_mm=900.0, layer="A-B2321-E")
    space = document.modelspace()
    space.add_arc((2000, 200), 900, 0, 90, dxfattribs={"layer": "A-DOOR"})
    rectangle(space, -500, -500, 7000, 5000, layer=sign)
    assert "walls-by-look" not in codes(plan_of(document, tmp_path))


def test_arrow_on_a_stair_misses_nothing(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    treads = [((x, 1000), (x, 2000)) for x in range(1000, 4000, 280)]
    sides = [((1000, y), (treads[-1][0][0], y)) for y in (1000, 2000)]
    arrow = [
        ((1100, 1500), (3500, 1500)),
        ((3400, 1450), (3500, 1500)),
        ((3400, 1550), (3500, 1500)),
    ]
    for start, end in [*treads, *sides, *arrow]:
        space.add_line(start, end, dxfattribs={"layer": "STAIR"})
    plan = plan_of(document, tmp_path)
    assert "gap-open" not in codes(plan)
    assert plan.obstacle_region().area == pytest.approx((treads[-1][0][0] - 1000) * 1000)


@pytest.mark.parametrize(("width", "solid_mm2"), [(3000, 0.0), (1200, 1200 * 4000.0)])
def test_pattern_wider_than_walls_on_their_layer_is_that_of_a_floor_and_said(
    width: int, solid_mm2: float, tmp_path: Path
) -> None:
    document = house(opening_mm=900.0)
    hatch = document.modelspace().add_hatch(dxfattribs={"layer": "WALL"})
    hatch.set_pattern_fill("NET", scale=100)
    hatch.paths.add_polyline_path([(0, 200), (width, 200), (width, 4200), (0, 4200)])
    plan = plan_of(document, tmp_path)
    assert plan.free_region().area == pytest.approx(INSIDE.area + 900 * 200 - solid_mm2)
    assert ("wide-pattern" in codes(plan)) == (not solid_mm2)


def test_pipes_among_foundations_are_no_walls_by_their_look(tmp_path: Path) -> None:
    document = house(opening_mm=900.0, layer="XYZ")
    rectangle(document.modelspace(), 20_000, 0, 24_000, 3000, layer="EQUIPMENT")
    plan = plan_of(document, tmp_path)
    assert {obstacle.kind for obstacle in plan.obstacles} == {Kind.EQUIPMENT}


@pytest.mark.parametrize("bow", [0, 1])
def test_outline_drawn_line_by_line_on_a_nameless_layer_is_an_obstacle(
    bow: int, tmp_path: Path
) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "XYZ"}
    for start, end in (((0, 0), (0, 600)), ((400, 600), (0, 600)), ((400, 0.5), (400, 600))):
        space.add_line((start[0] + 4000, start[1]), (end[0] + 4000, end[1]), dxfattribs=on)
    if bow:
        space.add_arc((4200, 0), 200, 180, 360, dxfattribs=on)
    else:
        space.add_line((4000, 0), (4400, 0), dxfattribs=on)
    rectangle(space, 7000, 7000, 7300, 7300, layer="COLUMN")
    (thing,) = standing(plan_of(document, tmp_path), "XYZ")
    assert thing.kind is Kind.UNCLASSIFIED
    area_mm2 = 400 * 600 + bow * math.pi * 200**2 / 2
    # a gap of half a millimetre is closed straight
    assert area_mm2 - 200 <= thing.region().area <= area_mm2 + bow * 0.02 * math.pi * 200


def test_grid_and_comb_of_lines_on_a_nameless_layer_are_no_outlines(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    on = {"layer": "XYZ"}
    for k in range(1, 5):
        space.add_line((1000 * k, 500), (1000 * k, 4500), dxfattribs=on)
        space.add_line((500, 1000 * k), (4500, 1000 * k), dxfattribs=on)
    lines(space, [(6000, 1000), (7000, 1000), (7000, 3000), (6000, 3000)], layer="XYZ")
    space.add_line((6000, 1000), (5800, 800), dxfattribs=on)
    rectangle(space, 7000, 7000, 7300, 7300, layer="COLUMN")
    assert not standing(plan_of(document, tmp_path), "XYZ")


def test_open_lines_on_a_nameless_layer_are_left_out_and_said(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    space.add_line((1000, 1000), (4000, 1000), dxfattribs={"layer": "XYZ"})
    space.add_line((50_000, 0), (51_000, 0), dxfattribs={"layer": "XYZ"})
    hatch = space.add_hatch(dxfattribs={"layer": "XYZ"})
    hatch.set_pattern_fill("ANSI31")
    hatch.paths.add_polyline_path([(5000, 5000), (6000, 5000), (6000, 6000)])
    rectangle(space, 7000, 7000, 7300, 7300, layer="COLUMN")
    plan = plan_of(document, tmp_path)
    assert {obstacle.layer for obstacle in plan.obstacles} == {"COLUMN"}
    (said,) = [f for f in plan.findings if f.code == "unclassified-left-out"]
    assert "1 open line and 1 pattern on layer 'XYZ'" in said.message


@pytest.mark.parametrize("leaf", ["line", "rectangle", "four lines"])
def test_door_drawn_among_walls_is_left_out_and_the_walls_stay(leaf: str, tmp_path: Path) -> None:
    document = house(opening_mm=900.0)
    space = document.modelspace()
    on = {"layer": "WALL"}
    bare = plan_of(document, tmp_path)
    space.add_arc((2000, 200), 900, 0, 90, dxfattribs=on)
    if leaf == "line":
        space.add_line((2000, 200), (2000, 1100), dxfattribs=on)
    elif leaf == "rectangle":
        rectangle(space, 2000, 200, 2040, 1100, layer="WALL")
    else:
        lines(space, [(2000, 200), (2040, 200), (2040, 1100), (2000, 1100)], layer="WALL")
    plan = plan_of(document, tmp_path)
    assert [o.shape for o in plan.obstacles] == [o.shape for o in bare.obstacles]
    assert "door-among-walls" in codes(plan)


@pytest.mark.parametrize(
    "arc", ["by hand", "polyline", "three sides", "lines", "lines twice", "spline"]
)
def test_door_whose_arc_is_not_about_its_hinge_is_a_door_all_the_same(
    arc: str, tmp_path: Path
) -> None:
    document = house(opening_mm=900.0)
    space = document.modelspace()
    on = {"layer": "WALL"}
    bare = plan_of(document, tmp_path)
    space.add_line((2000, 200), (2450, 200 + 900 * math.sin(math.radians(60))), dxfattribs=on)
    if arc == "by hand":
        # through a point 30 mm off the circle about the hinge
        bow = ConstructionArc.from_3p((2905, 210), (2430, 1000), (2805, 640))
        bow.add_to_layout(space, dxfattribs=on)
    else:
        step_deg = 20 if arc == "three sides" else 10
        turns_rad = [math.radians(turn_deg) for turn_deg in range(0, 61, step_deg)]
        spots = [(2000 + 900 * math.cos(t), 200 + 900 * math.sin(t)) for t in turns_rad]
        if arc.startswith("lines"):
            for start, end in pairwise(spots):
                space.add_line(start, end, dxfattribs=on)
                if arc == "lines twice":
                    space.add_line(end, start, dxfattribs=on)
        elif arc == "spline":
            space.add_spline(spots, dxfattribs=on)
        else:
            space.add_lwpolyline(spots, dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert [o.shape for o in plan.obstacles] == [o.shape for o in bare.obstacles]
    assert "door-among-walls" in codes(plan)


@pytest.mark.parametrize("side", ["spline", "spline of degree 3", "three in line"])
def test_straight_ends_of_walls_are_no_swings_however_they_are_drawn(
    side: str, tmp_path: Path
) -> None:
    # Rhino and Inkscape write straight lines as splines
    document = drawing()
    space = document.modelspace()
    on = {"layer": "WALL"}
    for y in (2200, 2400):
        space.add_line((2000, y), (2900, y), dxfattribs=on)
    for x in (2000, 2900):
        start, end = Vec3(x, 2200), Vec3(x, 2400)
        spots = [start.lerp(end, share) for share in (0, 1 / 3, 2 / 3, 1)]
        if side == "spline":
            space.add_open_spline([start, end], degree=1, dxfattribs=on)
        elif side == "spline of degree 3":
            space.add_open_spline(spots, dxfattribs=on)
        else:
            space.add_lwpolyline([spot.vec2 for spot in spots], dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().symmetric_difference(box(2000, 2200, 2900, 2400)).area < 100
    assert "door-among-walls" not in codes(plan)


def test_three_sides_of_a_square_about_the_end_of_a_line_are_no_swing(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    # its corners are 636 mm from the middle, and the middles of its sides 450 mm
    square = [(4000, 4000), (4900, 4000), (4900, 4900), (4000, 4900)]
    space.add_lwpolyline(square, dxfattribs={"layer": "WALL"})
    space.add_line((4000, 4000), (4450, 4450), dxfattribs={"layer": "WALL"})
    plan = plan_of(document, tmp_path)
    assert len(plan.obstacles) == 2
    assert "door-among-walls" not in codes(plan)


@pytest.mark.parametrize("thickness_mm", [100.0, 150.0, 200.0, 400.0])
def test_round_end_of_a_wall_is_no_swing(thickness_mm: float, tmp_path: Path) -> None:
    document = drawing()
    radius = thickness_mm / 2
    bulged = [(1000, 1000, 0), (1900, 1000, 1), (1900, 1000 + thickness_mm, 0)]
    bulged.append((1000, 1000 + thickness_mm, 0))
    document.modelspace().add_lwpolyline(
        bulged, format="xyb", close=True, dxfattribs={"layer": "WALL"}
    )
    plan = plan_of(document, tmp_path)
    area_mm2 = 900 * thickness_mm + math.pi * radius**2 / 2
    assert plan.obstacle_region().area == pytest.approx(area_mm2, rel=1e-3)


def test_leaf_on_a_nameless_layer_is_no_obstacle(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 8000, 9000, 8200, layer="WALL")
    rectangle(document.modelspace(), 4000, 5000, 4040, 5900, layer="XYZ")
    document.modelspace().add_arc((4000, 5000), 900, 0, 90, dxfattribs={"layer": "XYZ"})
    assert standing(plan_of(document, tmp_path), "XYZ") == []


def test_block_named_as_a_stair_says_nothing_about_the_lines_around_it(tmp_path: Path) -> None:
    document = house(opening_mm=900.0, layer="0")
    rectangle(document.blocks.new("Stair 1"), 1000, 1000, 2000, 3000, layer="0")
    document.modelspace().add_blockref("Stair 1", (0, 0))
    plan = plan_of(document, tmp_path)
    assert plan.floor.area == OUTSIDE.area
    assert plan.free_region().area == INSIDE.area + 900 * 200 - 1000 * 2000


def thick_wall(width_mm: float, *, layer: str = "WALL") -> Drawing:
    """Lines around a room of 6 × 4 m and a wall of some thickness at its right."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = MM
    lines(document.modelspace(), [(0, 0), (6000, 0), (6000, 4000), (0, 4000)], layer=layer)
    right = 6000 + width_mm
    lines(document.modelspace(), [(6000, 0), (right, 0), (right, 4000), (6000, 4000)], layer=layer)
    return document


@pytest.mark.parametrize("width_mm", [701.0, 900.0, 1500.0])
def test_thick_wall_between_two_lines_is_filled_and_said(width_mm: float, tmp_path: Path) -> None:
    plan = plan_of(thick_wall(width_mm), tmp_path)
    assert plan.free_region().area == 6000 * 4000
    assert "wall-thick" in codes(plan)


def test_strip_of_floor_beyond_a_wall_is_free(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 8600, 10_000, 8800, layer="WALL")
    assert plan_of(document, tmp_path).obstacle_region().area == 10_000 * 200


def test_space_wider_than_any_wall_is_free(tmp_path: Path) -> None:
    plan = plan_of(thick_wall(1600), tmp_path)
    assert plan.free_region().area == 7600 * 4000


def test_narrow_space_to_which_a_door_leads_is_free(tmp_path: Path) -> None:
    document = thick_wall(1200)
    on = {"layer": "A-DOOR"}
    document.modelspace().add_arc((6000, 1000), 900, 90, 180, dxfattribs=on)
    document.modelspace().add_line((6000, 1000), (5100, 1000), dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert plan.free_region().area == 7200 * 4000
    assert "wall-thick" not in codes(plan)


def test_narrow_space_between_lines_that_need_not_be_walls_is_free(tmp_path: Path) -> None:
    plan = plan_of(thick_wall(1200, layer="0"), tmp_path)
    assert plan.free_region().area == 7200 * 4000


def test_quarter_round_wall_without_a_leaf_stays(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_arc((2000, 2000), 900, 0, 90, dxfattribs={"layer": "WALL"})
    assert len(standing(plan_of(document, tmp_path), "WALL")) == 1


def test_gap_is_closed_on_request(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_lwpolyline(
        [(0, 12), (0, 300), (300, 300), (300, 0), (0, 0)], dxfattribs={"layer": "COLUMN"}
    )
    plan = plan_of(document, tmp_path, close_gaps_mm=15.0)
    assert plan.obstacle_region().area == 300 * 300


def test_outline_of_a_room_is_a_wall_face_where_no_layer_of_walls_exists(tmp_path: Path) -> None:
    document = drawing(floor=False)
    rectangle(document.modelspace(), 0, 0, 6400, 4400, layer="XYZ")
    rectangle(document.modelspace(), 200, 200, 6200, 4200, layer="ROOM")
    assert plan_of(document, tmp_path).free_region().area == 6000 * 4000


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
def test_ticks_across_a_single_line_wall_hold_no_floor_between_them(
    turn_deg: float, tmp_path: Path
) -> None:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = MM
    space = document.modelspace()
    lines(space, [(0, 0), (8000, 0), (8000, 5000), (0, 5000)], layer="WALL")
    for x in (1000, 1950, 2900, 4200, 5150):
        space.add_line((x, 4950), (x, 5050), dxfattribs={"layer": "WALL"})
    transform.inplace(space, Matrix44.z_rotate(math.radians(turn_deg)))
    # corners are kept to 1e-5 mm
    assert plan_of(document, tmp_path).floor.area == pytest.approx(8000 * 5000, rel=1e-8)
