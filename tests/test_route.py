"""Routes are driven again, finely, against the exact collision test."""

import itertools
import math
import random

import numpy as np
import pytest
import shapely

from satAOI_geo.collision import Collider
from satAOI_geo.errors import NoRouteError
from satAOI_geo.progress import Stopwatch
from satAOI_geo.robot import PROTOTYPE, Pose
from satAOI_geo.route import Route, RouteMap
from satAOI_geo.search import Search, Settings, search
from tests import plans

STEP_MM = 2.0
TURN_RAD = math.radians(0.5)

SETTINGS = Settings(step_mm=20.0)


def searched(seed: int) -> Search:
    plan = plans.random_plan(seed, n_obstacles=5, side_mm=(4000, 6000))
    return search(plan, PROTOTYPE, SETTINGS, start=None, watch=Stopwatch())


def between(a: Pose, b: Pose) -> list[Pose]:
    """Poses from a to b, at most STEP_MM and TURN_RAD apart, both ends included."""
    ends = np.array([(p.x_mm, p.y_mm, p.a1_rad, p.a2_rad) for p in (a, b)])
    way = np.abs(ends[1] - ends[0])
    n = max(1, math.ceil(math.hypot(*way[:2]) / STEP_MM), math.ceil(max(way[2:]) / TURN_RAD))
    return [Pose(*ends[0] + (ends[1] - ends[0]) * k / n) for k in range(n + 1)]


def driven(route: Route) -> list[Pose]:
    """All poses of a route, finely."""
    poses = route.poses()
    steps = [pose for pair in itertools.pairwise(poses) for pose in between(*pair)]
    return steps or poses


def points_in_the_area(found: Search, seed: int, n: int) -> list[tuple[float, float]]:
    """Points that a disc at a reached node covers, at random."""
    draw = random.Random(seed)
    nodes = np.argwhere(found.pose.nodes(found.start.pose_label)).tolist()
    points = []
    for _ in range(n):
        iy, ix = draw.choice(nodes)
        angle_rad, off_mm = draw.uniform(0, 2 * math.pi), draw.uniform(0, 349.9)
        points.append(
            (
                found.lattice.x_mm(ix) + off_mm * math.cos(angle_rad),
                found.lattice.y_mm(iy) + off_mm * math.sin(angle_rad),
            )
        )
    return points


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
