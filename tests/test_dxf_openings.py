"""Doors drawn over walls that go on under them, and lines across openings that a door swings in."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest
import shapely
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.layouts import BaseLayout, Modelspace
from ezdxf.math import Matrix44
from shapely.geometry import LineString, box

from satAOI_geo.plan import FloorPlan
from tests.drawings import codes, drawing, plan_of, rectangle, standing

WALL = box(0, 5000, 10_000, 5200)
OPENING = box(4000, 5000, 4900, 5200)
ON_WALL = {"layer": "WALL"}


def outline(space: Modelspace) -> None:
    rectangle(space, *WALL.bounds, layer="WALL")


def faces(space: Modelspace) -> None:
    for y in (5000, 5200):
        space.add_line((0, y), (10_000, y), dxfattribs=ON_WALL)


def fill(space: Modelspace) -> None:
    hatch = space.add_hatch(dxfattribs=ON_WALL)
    hatch.paths.add_polyline_path(list(WALL.exterior.coords[:-1]), is_closed=True)


def swing(space: BaseLayout, layer: str, *, shut_deg: float = 0.0, open_deg: float = 90.0) -> None:
    """A door of 900 mm with its hinge at (4000, 5200)."""
    space.add_arc(
        (4000, 5200),
        900,
        min(shut_deg, open_deg),
        max(shut_deg, open_deg),
        dxfattribs={"layer": layer},
    )
    turn_rad = math.radians(open_deg)
    tip = (4000 + 900 * math.cos(turn_rad), 5200 + 900 * math.sin(turn_rad))
    space.add_line((4000, 5200), tip, dxfattribs={"layer": layer})


def block_with_mask(document: Drawing) -> None:
    block = document.blocks.new("Door 90")
    swing(block, "0")
    block.add_wipeout([(3950, 4990), (4950, 4990), (4950, 5210), (3950, 5210)])
    document.modelspace().add_blockref("Door 90", (0, 0))


def in_drawing(plan: FloorPlan) -> shapely.Geometry:
    """The obstacles in the drawing's axes."""
    return shapely.affinity.translate(plan.obstacle_region(), *plan.frame.origin_mm)


@pytest.mark.parametrize("wall", [outline, faces, fill])
@pytest.mark.parametrize("layer", ["A-DOOR", "WALL", "XYZ"])
def test_door_over_a_wall_opens_it_as_wide_as_it_swings_and_is_said(
    wall: Callable[[Modelspace], None], layer: str, tmp_path: Path
) -> None:
    document = drawing()
    wall(document.modelspace())
    swing(document.modelspace(), layer)
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.difference(OPENING))
    (said,) = [finding for finding in plan.findings if finding.code == "door-over-wall"]
    assert "900 mm wide" in said.message
    assert said.at_mm == (4000.0, 5200.0)


def test_mask_in_the_block_of_a_door_that_swings_opens_no_more_than_the_swing(
    tmp_path: Path,
) -> None:
    document = drawing()
    outline(document.modelspace())
    block_with_mask(document)
    assert in_drawing(plan_of(document, tmp_path)).equals(WALL.difference(OPENING))


def test_door_that_slides_opens_the_wall_under_its_mask(tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    block = document.blocks.new("Door sliding")
    block.add_wipeout([(4000, 4950), (5000, 4950), (5000, 5250), (4000, 5250)])
    block.add_line((4000, 5100), (4500, 5100))
    document.modelspace().add_blockref("Door sliding", (0, 0))
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.difference(box(4000, 5000, 5000, 5200)))


@pytest.mark.parametrize("width_mm", [300, 5000])
def test_mask_on_a_door_layer_that_no_door_is_as_wide_as_opens_nothing_and_is_said(
    width_mm: int, tmp_path: Path
) -> None:
    document = drawing()
    outline(document.modelspace())
    right = 4000 + width_mm
    corners = [(4000, 4950), (right, 4950), (right, 5250), (4000, 5250)]
    # ezdxf puts it on layer 0 whatever it is told
    document.modelspace().add_wipeout(corners).dxf.layer = "A-DOOR"
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL)
    assert "door-in-wall" in codes(plan)


def test_mask_of_anything_but_a_door_opens_nothing(tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    corners = [(4000, 4950), (5000, 4950), (5000, 5250), (4000, 5250)]
    document.modelspace().add_wipeout(corners).dxf.layer = "WALL"
    assert in_drawing(plan_of(document, tmp_path)).equals(WALL)


def test_outline_of_a_door_from_face_to_face_of_a_wall_is_its_opening(tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    rectangle(document.modelspace(), *OPENING.bounds, layer="DRZWI_H210cm")
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.difference(OPENING))
    assert codes(plan).count("door-over-wall") == 1


def test_outline_with_glass_on_the_layer_of_openings_is_a_window_and_stays_closed(
    tmp_path: Path,
) -> None:
    document = drawing()
    outline(document.modelspace())
    rectangle(document.modelspace(), *OPENING.bounds, layer="OPENINGS")
    document.modelspace().add_line((4000, 5100), (4900, 5100), dxfattribs={"layer": "OPENINGS"})
    assert in_drawing(plan_of(document, tmp_path)).equals(WALL)


def test_leaf_that_slides_in_a_wall_drawn_whole_leaves_it_closed_and_is_said(
    tmp_path: Path,
) -> None:
    document = drawing()
    outline(document.modelspace())
    rectangle(document.modelspace(), 4000, 5080, 4900, 5120, layer="A-DOOR")
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL)
    (said,) = [finding for finding in plan.findings if finding.code == "door-in-wall"]
    assert said.at_mm == (4000.0, 5100.0)


@pytest.mark.parametrize("leaf", ["line", "rectangle", "lines"])
def test_leaf_without_a_swing_at_a_wall_drawn_whole_leaves_it_closed_and_is_said(
    leaf: str, tmp_path: Path
) -> None:
    document = drawing()
    space = document.modelspace()
    outline(space)
    if leaf == "rectangle":
        rectangle(space, 4000, 5200, 4040, 6100, layer="A-DOOR")
    else:
        for x in (4000, 4040) if leaf == "lines" else (4000,):
            space.add_line((x, 5200), (x, 6100), dxfattribs={"layer": "A-DOOR"})
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL)
    (said,) = [finding for finding in plan.findings if finding.code == "door-in-wall"]
    assert said.at_mm is not None
    assert math.dist(said.at_mm, (4000, 5200)) <= 40


@pytest.mark.parametrize("at_mm", [0, 50])
def test_leaf_without_a_swing_in_an_opening_needs_no_word(at_mm: int, tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    rectangle(space, 0, 5000, 4000, 5200, layer="WALL")
    rectangle(space, 5100, 5000, 10_000, 5200, layer="WALL")
    x = 4000 + at_mm
    space.add_line((x, 5200), (x, 6100), dxfattribs={"layer": "A-DOOR"})
    assert not {"door-over-wall", "door-in-wall"} & set(codes(plan_of(document, tmp_path)))


def test_leaf_that_slides_before_the_wall_beside_its_opening_needs_no_word(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 5000, 4000, 5200, layer="WALL")
    rectangle(document.modelspace(), 4900, 5000, 10_000, 5200, layer="WALL")
    rectangle(document.modelspace(), 4910, 5210, 5810, 5250, layer="A-DOOR")
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.difference(OPENING))
    assert not {"door-over-wall", "door-in-wall"} & set(codes(plan))


@pytest.mark.parametrize("turn_deg", [37.0, 180.0])
@pytest.mark.parametrize("x_scale", [1.0, -1.0])
def test_turned_and_mirrored_the_same_opening_is_cut(
    turn_deg: float, x_scale: float, tmp_path: Path
) -> None:
    document = drawing()
    outline(document.modelspace())
    swing(document.modelspace(), "A-DOOR", open_deg=45.0)
    matrix = Matrix44.scale(x_scale, 1, 1) @ Matrix44.z_rotate(math.radians(turn_deg))
    transform.inplace(document.modelspace(), matrix)
    plan = plan_of(document, tmp_path)
    # corners are kept to 1e-5 mm
    left_mm2 = WALL.area - OPENING.area
    assert plan.obstacle_region().area == pytest.approx(left_mm2, rel=1e-6)


def test_line_of_a_wall_without_thickness_is_cut_at_a_door(tmp_path: Path) -> None:
    document = drawing()
    document.modelspace().add_line((0, 5200), (10_000, 5200), dxfattribs=ON_WALL)
    swing(document.modelspace(), "A-DOOR")
    lines = [obstacle.shape for obstacle in standing(plan_of(document, tmp_path), "WALL")]
    assert lines == [
        LineString([(0, 5200), (4000, 5200)]),
        LineString([(4900, 5200), (10_000, 5200)]),
    ]


def test_threshold_on_the_layer_of_doors_and_windows_is_no_obstacle(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    rectangle(space, 0, 5000, 4000, 5200, layer="WALL")
    rectangle(space, 4900, 5000, 10_000, 5200, layer="WALL")
    rectangle(space, *OPENING.bounds, layer="MENUISERIES")
    swing(space, "MENUISERIES")
    assert in_drawing(plan_of(document, tmp_path)).equals(WALL.difference(OPENING))


@pytest.mark.parametrize("shut_deg", [0.0, 180.0])
def test_door_in_an_opening_that_is_drawn_cuts_nothing_whichever_way_its_symbol_lies(
    shut_deg: float, tmp_path: Path
) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 5000, 4000, 5200, layer="WALL")
    rectangle(document.modelspace(), 4900, 5000, 10_000, 5200, layer="WALL")
    swing(document.modelspace(), "A-DOOR", shut_deg=shut_deg)
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.difference(OPENING))
    assert not {"door-over-wall", "door-in-wall"} & set(codes(plan))


def test_door_over_a_wall_of_two_thicknesses_stays_closed_and_is_said(tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    rectangle(document.modelspace(), 4300, 4700, 10_000, 5000, layer="WALL")
    swing(document.modelspace(), "A-DOOR")
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.union(box(4300, 4700, 10_000, 5000)))
    assert "door-in-wall" in codes(plan)


def test_door_away_from_any_wall_cuts_nothing_and_nothing_is_said(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 8000, 10_000, 8200, layer="WALL")
    swing(document.modelspace(), "A-DOOR")
    plan = plan_of(document, tmp_path)
    assert plan.obstacle_region().area == 10_000 * 200
    assert plan.findings == ()


@pytest.mark.parametrize("shift_mm", [0.0, 4.0])
def test_door_drawn_twice_over_a_wall_is_said_once(shift_mm: float, tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    for layer in ("A-DOOR", "DOOR"):
        swing(document.modelspace(), layer)
    transform.translate(document.modelspace().query('*[layer=="DOOR"]'), (shift_mm, 0, 0))
    assert codes(plan_of(document, tmp_path)).count("door-over-wall") == 1


def test_two_leaves_over_a_wall_are_one_door(tmp_path: Path) -> None:
    document = drawing()
    space = document.modelspace()
    outline(space)
    swing(space, "DOOR")
    space.add_arc((5800, 5200), 900, 90, 180, dxfattribs={"layer": "DOOR"})
    space.add_line((5800, 5200), (5800, 6100), dxfattribs={"layer": "DOOR"})
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL.difference(box(4000, 5000, 5800, 5200)))
    (said,) = [finding for finding in plan.findings if finding.code == "door-over-wall"]
    assert "1800 mm wide" in said.message


def test_doors_on_a_layer_that_is_left_out_open_nothing_and_are_said_once(tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    swing(document.modelspace(), "Furniture")
    on = {"layer": "Furniture"}
    document.modelspace().add_arc((7000, 5000), 900, 270, 360, dxfattribs=on)
    document.modelspace().add_line((7000, 5000), (7000, 4100), dxfattribs=on)
    plan = plan_of(document, tmp_path)
    assert in_drawing(plan).equals(WALL)
    (said,) = [finding for finding in plan.findings if finding.code == "door-left-out"]
    assert said.layer == "Furniture"
    assert said.message.startswith("2 doors")
    assert said.at_mm == (4000.0, 5200.0)


def test_door_on_a_layer_that_is_left_out_in_an_opening_needs_no_word(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 0, 5000, 4000, 5200, layer="WALL")
    rectangle(document.modelspace(), 4900, 5000, 10_000, 5200, layer="WALL")
    swing(document.modelspace(), "Furniture")
    assert "door-left-out" not in codes(plan_of(document, tmp_path))


def test_doors_of_a_cabinet_at_a_wall_need_no_word(tmp_path: Path) -> None:
    document = drawing()
    outline(document.modelspace())
    rectangle(document.modelspace(), 4000, 5200, 4900, 5800, layer="Furniture")
    on = {"layer": "Furniture"}
    document.modelspace().add_arc((4000, 5800), 450, 0, 90, dxfattribs=on)
    document.modelspace().add_line((4000, 5800), (4000, 6250), dxfattribs=on)
    assert "door-left-out" not in codes(plan_of(document, tmp_path))


def test_doors_on_a_layer_that_the_user_leaves_out_need_no_word(tmp_path: Path) -> None:
    layers = tmp_path / "layers.toml"
    layers.write_text('[layers]\nignore = ["Furniture"]\n', encoding="utf-8")
    document = drawing()
    outline(document.modelspace())
    swing(document.modelspace(), "Furniture")
    assert "door-left-out" not in codes(plan_of(document, tmp_path, layers=layers))
