"""Thresholds of doors on the layer of doors and windows, which stops the robot."""

import math
from pathlib import Path

import pytest
from ezdxf import transform
from ezdxf.document import Drawing
from ezdxf.math import Matrix44
from shapely.geometry import Point

from satAOI_geo.plan import FloorPlan
from tests.drawings import codes, drawing, plan_of, rectangle

ON_WINDOWS = {"layer": "WINDOW"}


def opening(*, width_mm: float, threshold_y: float) -> Drawing:
    """A wall 200 mm thick, an opening in it, and a line across this on the layer of windows."""
    document = drawing()
    space = document.modelspace()
    rectangle(space, 0, 5000, 4000, 5200, layer="WALL")
    rectangle(space, 4000 + width_mm, 5000, 10_000, 5200, layer="WALL")
    space.add_line((4000, threshold_y), (4000 + width_mm, threshold_y), dxfattribs=ON_WINDOWS)
    return document


def door(document: Drawing, hinge_x: float, *, leaf_mm: float, to_left: bool = False) -> None:
    """A door that stands open at a right angle, its hinge in the middle of the wall."""
    space = document.modelspace()
    start_deg, end_deg = (90, 180) if to_left else (0, 90)
    space.add_arc((hinge_x, 5100), leaf_mm, start_deg, end_deg, dxfattribs=ON_WINDOWS)
    space.add_line((hinge_x, 5100), (hinge_x, 5100 + leaf_mm), dxfattribs=ON_WINDOWS)


def walls_mm2(width_mm: float) -> float:
    return (10_000 - width_mm) * 200


def lines_in(plan: FloorPlan) -> int:
    return sum(not obstacle.shape.area for obstacle in plan.obstacles)


@pytest.mark.parametrize("threshold_y", [5000, 5200])
def test_line_across_an_opening_in_which_a_door_swings_is_no_obstacle_and_is_said(
    threshold_y: float, tmp_path: Path
) -> None:
    document = opening(width_mm=900, threshold_y=threshold_y)
    door(document, 4000, leaf_mm=900)
    plan = plan_of(document, tmp_path)
    assert lines_in(plan) == 0
    assert plan.obstacle_region().area == pytest.approx(walls_mm2(900), rel=1e-9)
    assert "threshold" in codes(plan)


@pytest.mark.parametrize("turn_deg", [90.0, 37.0])
@pytest.mark.parametrize("x_scale", [1.0, -1.0])
def test_turned_and_mirrored_it_is_none_either(
    turn_deg: float, x_scale: float, tmp_path: Path
) -> None:
    document = opening(width_mm=950, threshold_y=5000)
    door(document, 4000, leaf_mm=900)
    matrix = Matrix44.scale(x_scale, 1, 1) @ Matrix44.z_rotate(math.radians(turn_deg))
    transform.inplace(document.modelspace(), matrix)
    plan = plan_of(document, tmp_path)
    assert lines_in(plan) == 0
    (said,) = [finding for finding in plan.findings if finding.code == "threshold"]
    assert said.layer == "WINDOW"
    assert said.handle
    assert said.at_mm is not None


def test_line_across_the_opening_of_a_door_of_two_leaves_is_no_obstacle(tmp_path: Path) -> None:
    document = opening(width_mm=1800, threshold_y=5000)
    door(document, 4000, leaf_mm=900)
    door(document, 5800, leaf_mm=900, to_left=True)
    plan = plan_of(document, tmp_path)
    assert lines_in(plan) == 0
    assert "threshold" in codes(plan)


def test_line_across_an_opening_beside_a_door_stays(tmp_path: Path) -> None:
    document = opening(width_mm=900, threshold_y=5000)
    # a door in a wall that goes off the first one 300 mm from the opening
    rectangle(document.modelspace(), 5200, 5200, 5400, 5300, layer="WALL")
    rectangle(document.modelspace(), 5200, 6200, 5400, 8000, layer="WALL")
    document.modelspace().add_arc((5300, 5300), 900, 90, 180, dxfattribs=ON_WINDOWS)
    document.modelspace().add_line((5300, 5300), (4400, 5300), dxfattribs=ON_WINDOWS)
    plan = plan_of(document, tmp_path)
    assert lines_in(plan) == 1
    assert "threshold" not in codes(plan)


def test_line_across_an_opening_without_a_door_stays(tmp_path: Path) -> None:
    plan = plan_of(opening(width_mm=900, threshold_y=5000), tmp_path)
    assert lines_in(plan) == 1
    assert "threshold" not in codes(plan)


def test_face_of_a_wall_that_goes_on_beyond_a_door_is_no_threshold(tmp_path: Path) -> None:
    document = opening(width_mm=900, threshold_y=8000)
    document.modelspace().add_line((4000, 5200), (9000, 5200), dxfattribs={"layer": "WALL"})
    door(document, 4000, leaf_mm=900)
    plan = plan_of(document, tmp_path)
    assert any(obstacle.region().intersects(Point(4450, 5200)) for obstacle in plan.obstacles)
