"""Routes are driven again, finely, against the exact collision test."""

import itertools
import math

import pytest
import shapely

from benchmarks.driving import driven, points_in_the_area
from satAOI_geo.collision import Collider
from satAOI_geo.errors import NoRouteError
from satAOI_geo.progress import Stopwatch
from satAOI_geo.robot import PROTOTYPE
from satAOI_geo.route import RouteMap
from satAOI_geo.search import Search, search
from satAOI_geo.settings import Settings
from tests import plans

SETTINGS = Settings(step_mm=20.0)


def searched(seed: int) -> Search:
    plan = plans.random_plan(seed, n_obstacles=5, side_mm=(4000, 6000))
    return search(plan, PROTOTYPE, SETTINGS, start=None, watch=Stopwatch())


@pytest.mark.parametrize("seed", [1, 4, 6, 9, 12])
def test_every_point_of_the_area_has_a_route_without_contact(seed: int) -> None:
    found = searched(seed)
    ways = RouteMap(found)
    collider = Collider(found.plan, found.robot)
    for point_mm in points_in_the_area(found, seed, 10):
        route = ways.to(point_mm)
        assert route.states[0] == found.start.state
        last = route.poses()[-1]
        assert math.dist((last.x_mm, last.y_mm), point_mm) <= found.robot.disc_radius_mm + 1e-6
        touched = [pose for pose in driven(route) if not collider.is_free(pose)]
        assert not touched


def test_states_in_a_row_are_one_move_apart() -> None:
    found = searched(4)
    route = RouteMap(found).to(points_in_the_area(found, 4, 1)[0])
    for a, b in itertools.pairwise(route.states):
        steps = abs(a.iy - b.iy) + abs(a.ix - b.ix)
        turns = (a.a1, a.swing) != (b.a1, b.swing)
        assert steps + turns == 1


def test_same_question_gets_the_same_route() -> None:
    point_mm = points_in_the_area(searched(6), 6, 1)[0]
    assert RouteMap(searched(6)).to(point_mm) == RouteMap(searched(6)).to(point_mm)


def test_point_that_only_the_paper_s_rule_claims_has_no_route() -> None:
    case = plans.two_rooms(760.0)
    found = search(case.plan, PROTOTYPE, SETTINGS, start=None, watch=Stopwatch())
    assert case.beyond_mm is not None
    start_mm = (found.lattice.x_mm(found.start.state.ix), found.lattice.y_mm(found.start.state.iy))
    rooms = shapely.points([start_mm, case.beyond_mm, case.start_mm])
    far = max(rooms[1:], key=lambda room: room.distance(rooms[0]))
    with pytest.raises(NoRouteError, match="not in the area"):
        RouteMap(found).to((far.x, far.y))
