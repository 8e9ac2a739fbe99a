"""The lattice lies along the walls, so that a plan may be turned."""

import math
from dataclasses import replace

import pytest
from shapely import affinity
from shapely.geometry import LineString, box

from satAOI_geo.align import wall_direction_rad
from satAOI_geo.pipeline import area_of_interest
from satAOI_geo.plan import Circle, FloorPlan, Kind, Obstacle
from satAOI_geo.settings import Settings
from satAOI_geo.start import StartMark
from tests import plans

COARSE = Settings(step_mm=25.0, n_directions=12)


def turned_drawing(plan: FloorPlan, turn_deg: float) -> FloorPlan:
    """The plan as if it had been drawn turned: the frame knows nothing of it."""
    return replace(plan.turned(-math.radians(turn_deg)), frame=plan.frame)


def test_square_plan_stays_as_it_is() -> None:
    assert wall_direction_rad(plans.room().plan) == 0.0


def test_few_crooked_walls_do_not_shift_the_direction_of_the_many() -> None:
    straight = Obstacle(box(0, 0, 3000, 100), Kind.WALL)
    crooked = Obstacle(affinity.rotate(box(0, 500, 900, 600), 0.1), Kind.WALL)
    assert wall_direction_rad(FloorPlan(box(0, 0, 4000, 4000), (straight, crooked))) == 0.0


def test_walls_count_before_the_edge_of_the_floor() -> None:
    wall = Obstacle(LineString([(500, 500), (1500, 500 + 1000 * math.tan(0.3))]), Kind.WALL)
    assert wall_direction_rad(FloorPlan(box(0, 0, 9000, 9000), (wall,))) == pytest.approx(0.3)


def test_plan_without_a_straight_edge_is_not_turned() -> None:
    round_wall = Obstacle(Circle(2000.0, 2000.0, 300.0), Kind.WALL)
    assert wall_direction_rad(FloorPlan(box(0, 0, 4000, 4000), (round_wall,))) == 0.0


@pytest.mark.parametrize("turn_deg", [7.0, 17.0, 33.3, -44.0])
def test_direction_follows_the_plan_modulo_a_quarter_turn(turn_deg: float) -> None:
    turned = turned_drawing(plans.l_shaped_room().plan, turn_deg)
    assert math.degrees(wall_direction_rad(turned)) == pytest.approx(turn_deg, abs=1e-9)


def test_turning_there_and_back_gives_the_drawing_s_points() -> None:
    plan = replace(plans.room().plan, start_mm=(1000.0, 2000.0)).turned(0.7)
    assert plan.start_mm is not None
    assert plan.frame.to_drawing_mm(plan.start_mm).tolist() == pytest.approx([1000.0, 2000.0])


@pytest.mark.parametrize("turn_deg", [7.0, 17.0, 33.3])
@pytest.mark.parametrize("seed", [3, 8])
def test_turned_plan_has_the_same_areas(seed: int, turn_deg: float) -> None:
    plan = plans.random_plan(seed, n_obstacles=5)
    walls = (Obstacle(LineString([(0, 0), (9000, 0)]), Kind.WALL), *plan.obstacles)
    plan = replace(plan, obstacles=walls)
    straight = area_of_interest(plan, settings=COARSE)
    turned = area_of_interest(turned_drawing(plan, turn_deg), settings=COARSE)
    assert turned.report.lattice.turn_deg == pytest.approx(turn_deg, abs=1e-6)
    for rule in ("disc_connected", "pose_connected"):
        expected = getattr(straight.report, rule)
        found = getattr(turned.report, rule)
        assert found.n_nodes == expected.n_nodes
        assert found.area_m2 == pytest.approx(expected.area_m2, rel=1e-6)


def test_start_keeps_its_place_in_the_drawing_when_the_lattice_turns() -> None:
    plan = turned_drawing(plans.room().plan, 20.0)
    asked_mm = tuple(plan.floor.centroid.coords[0])
    result = area_of_interest(plan, settings=COARSE, start=StartMark(asked_mm))
    found_mm = result.report.start.xy_mm
    # the node is the centre of the cell that holds the point
    assert math.dist(found_mm, asked_mm) <= COARSE.step_mm / math.sqrt(2) + 1e-9


def test_lattice_can_be_laid_in_a_direction_of_one_s_own() -> None:
    settings = replace(COARSE, align_rad=math.radians(30.0))
    report = area_of_interest(plans.room().plan, settings=settings).report
    assert report.lattice.turn_deg == pytest.approx(30.0)
    assert report.lattice.turn_source == "option"
