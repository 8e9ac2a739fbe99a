"""Contacts that can be checked by hand, and who is named for them."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point, Polygon, box

from satAOI_geo.collision import Collider, Reference
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import CONTACT_MM, Circle, FloorPlan, Kind, Obstacle, Shape
from satAOI_geo.robot import ROBOTS, Part, Pose, unit
from tests.drawn import plan_of, ring

PROTOTYPE = ROBOTS["magicbim"]
WIDE_FLOOR = box(-10_000, -10_000, 10_000, 10_000)

JUST_MM = 1e-5
"""A tenth of the contact band."""

QUARTERS_DEG = (0, 90, 180, 270)

EAST = Pose(0.0, 0.0, 0.0, 0.0)
"""Disc at the origin, arm and vehicle straight to the east."""


def touches(pose: Pose, *shapes: Shape, clearance_mm: float = 0.0) -> bool:
    return not Collider(plan_of(WIDE_FLOOR, *shapes), PROTOTYPE, clearance_mm).is_free(pose)


def wall_behind(distance_mm: float, a1_deg: int) -> LineString:
    """A wall across the arm's direction, behind the disc."""
    behind = -unit(math.radians(a1_deg))
    along = np.array((-behind[1], behind[0]))
    ends_mm = behind * distance_mm + np.outer((-500, 500), along)
    return LineString(ends_mm)


@pytest.mark.parametrize("a1_deg", QUARTERS_DEG)
@pytest.mark.parametrize(
    ("beyond_mm", "contact"),
    [(-1.0, True), (0.0, True), (CONTACT_MM - JUST_MM, True), (CONTACT_MM + JUST_MM, False)],
)
def test_disc_touches_a_wall_up_to_the_contact_band(
    a1_deg: int, beyond_mm: float, *, contact: bool
) -> None:
    pose = Pose(0.0, 0.0, math.radians(a1_deg), 0.0)
    assert touches(pose, wall_behind(350 + beyond_mm, a1_deg)) is contact


@pytest.mark.parametrize("clearance_mm", [0.0, 35.0, 0.125])
def test_clearance_moves_the_contact_of_disc_and_vehicle_alike(clearance_mm: float) -> None:
    for beyond_mm, contact in ((-JUST_MM, True), (JUST_MM, False)):
        away_mm = clearance_mm + CONTACT_MM + beyond_mm
        behind_mm, beside_mm, ahead_mm = 350 + away_mm, 415 + away_mm, 1574.5 + away_mm
        for wall in (
            LineString([(-behind_mm, -500), (-behind_mm, 500)]),
            LineString([(1000, beside_mm), (1200, beside_mm)]),
            box(ahead_mm, -100, ahead_mm + 10, 100),
        ):
            assert touches(EAST, wall, clearance_mm=clearance_mm) is contact


@pytest.mark.parametrize("bearing_deg", [90, 91, 117.3, 135, 180, 200.01, 269])
@pytest.mark.parametrize("radius_mm", [0.5, 350.0, 1234.5])
def test_circle_is_touched_as_a_circle_from_every_side(
    bearing_deg: float, radius_mm: float
) -> None:
    # behind the disc the distance to the spine is the distance to its centre; a polygon with 720
    # corners would lie up to 0.01 mm off
    at = unit(math.radians(bearing_deg))
    for beyond_mm, contact in ((-JUST_MM, True), (JUST_MM, False)):
        x_mm, y_mm = (350 + radius_mm + CONTACT_MM + beyond_mm) * at
        assert touches(EAST, Circle(x_mm, y_mm, radius_mm)) is contact


def test_circle_beside_the_arm_is_touched_where_the_arm_ends() -> None:
    # vehicle turned away by 90° about (995, 0): it covers x from 580 to 1410, y from -295.5
    away = replace(EAST, a2_rad=math.pi / 2)
    for beyond_mm, contact in ((-JUST_MM, True), (JUST_MM, False)):
        reach_mm = 350 + 100 + CONTACT_MM + beyond_mm
        assert touches(away, Circle(300.0, -reach_mm, 100.0)) is contact


def test_pole_in_the_way_of_a_vehicle_corner_is_touched_at_its_distance_to_the_corner() -> None:
    corner_x_mm, corner_y_mm = 1574.5, 415.0
    for beyond_mm, contact in ((-JUST_MM, True), (JUST_MM, False)):
        # 3, 4, 5: along (0.6, 0.8) from the corner
        away_mm = 20 + CONTACT_MM + beyond_mm
        pole = Circle(corner_x_mm + 0.6 * away_mm, corner_y_mm + 0.8 * away_mm, 20.0)
        assert touches(EAST, pole) is contact


def test_vehicle_touches_a_block_corner_to_corner() -> None:
    x_mm, y_mm = 1574.5, 415.0
    assert touches(EAST, box(x_mm, y_mm, x_mm + 100, y_mm + 100))
    away_mm = (CONTACT_MM + JUST_MM) / math.sqrt(2)
    x_mm, y_mm = x_mm + away_mm, y_mm + away_mm
    assert not touches(EAST, box(x_mm, y_mm, x_mm + 100, y_mm + 100))


def test_vehicle_reaches_beyond_the_arm_s_side_only_where_it_stands() -> None:
    # 400 mm off the axis: past the arm's 350, within the vehicle's 415
    assert not touches(EAST, Circle(300.0, 401.0, 1.0))
    assert touches(EAST, Circle(1100.0, 401.0, 1.0))


@pytest.mark.parametrize(
    "inside",
    [
        Circle(0.0, 0.0, 5000.0),
        Circle(0.0, 0.0, 0.001),
        box(-5000, -5000, 5000, 5000),
        LineString([(-100, 0), (100, 0)]),
        LineString([(200, -10), (200, 10)]),
        box(1100, -5, 1110, 5),
    ],
    ids=repr,
)
def test_robot_touches_what_it_stands_in_or_on(inside: Shape) -> None:
    assert touches(EAST, inside)


def test_robot_stands_free_in_the_hole_of_an_obstacle() -> None:
    frame = ring((600, 0), outer_mm=2000, inner_mm=1500)
    assert not touches(EAST, frame)
    assert touches(EAST, Polygon(frame.exterior))


def test_wall_the_spine_lies_on_is_touched() -> None:
    # a line on a line is what shapely issue 1887 misses
    on_the_spine = [
        LineString([(0, 0), (645, 0)]),
        LineString([(645, 0), (0, 0)]),
        LineString([(-100, 0), (2000, 0)]),
        LineString([(100, 0), (200, 0)]),
        LineString([(645, 0), (700, 0)]),
    ]
    for wall in on_the_spine:
        assert touches(EAST, wall)


def test_geos_finds_every_line_within_a_distance_of_a_line() -> None:
    # shapely issue 1887: `dwithin` of a tree against distances measured one by one
    draw = np.random.default_rng(1887)
    starts = draw.integers(0, 12, size=(300, 2)).astype(float)
    ends = starts + draw.integers(1, 6, size=(300, 2)) * draw.choice((-1, 1), size=(300, 1))
    lines = shapely.linestrings(np.stack((starts, ends), axis=1))
    for distance in (0.0, 1.0, math.sqrt(2), 2.5):
        queried, found = shapely.STRtree(lines).query(lines, "dwithin", distance=distance)
        gaps = shapely.distance(lines[:, np.newaxis], lines[np.newaxis])
        assert set(zip(queried, found, strict=True)) == set(
            zip(*np.nonzero(gaps <= distance), strict=True)
        )


def test_geos_that_misses_a_line_on_a_line_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Blind:
        """A tree that finds nothing."""

        def __init__(self, geometries: object) -> None: ...

        def query(self, *_: object, **__: object) -> np.ndarray:
            return np.array([])

    monkeypatch.setattr("satAOI_geo.collision.shapely.STRtree", Blind)
    with pytest.raises(ImportError, match="1887"):
        Collider(plan_of(WIDE_FLOOR), PROTOTYPE)


def test_line_whose_ends_are_one_point_is_touched() -> None:
    # drawings hold such lines, where a pen was set down and lifted
    assert touches(EAST, LineString([(300, 100), (300, 100)]))
    assert not touches(EAST, LineString([(300, 400), (300, 400)]))


def test_disc_of_an_arm_without_length_touches_a_wall() -> None:
    robot = replace(PROTOTYPE, arm_length_mm=350.0, pivot_offset_mm=800.0)
    wall = LineString([(-300, -500), (-300, 500)])
    assert not Collider(plan_of(WIDE_FLOOR, wall), robot).is_free(EAST)


def test_point_of_a_part_touches_as_far_as_its_radius() -> None:
    collider = Collider(plan_of(WIDE_FLOOR, Circle(100.0, 0.0, 10.0)), PROTOTYPE)
    origin_mm = np.zeros((1, 2))
    assert collider.touched(Part(origin_mm, 90.0)) != []
    assert collider.touched(Part(origin_mm, 89.99)) == []


def contact_of(pose: Pose, *obstacles: Obstacle, floor: Polygon = WIDE_FLOOR) -> tuple[str, str]:
    """Name of the part and handle of the obstacle, `floor` for its edge."""
    contact = Collider(FloorPlan(floor, obstacles), PROTOTYPE).contact(pose)
    assert contact is not None
    return contact.part, contact.obstacle.handle if contact.obstacle else "floor"


POST = Obstacle(Circle(0.0, 0.0, 10.0), Kind.COLUMN, handle="POST")
FAR = Obstacle(box(5000, 5000, 6000, 6000), Kind.WALL, handle="FAR")
STEP = Obstacle(box(1400, -50, 1500, 50), Kind.WALL, handle="STEP")


def test_contact_names_the_part_and_the_obstacle() -> None:
    assert contact_of(EAST, FAR, POST) == ("capsule", "POST")
    assert contact_of(EAST, STEP, FAR) == ("vehicle", "STEP")


def test_contact_of_arm_and_disc_is_named_before_the_vehicle_s() -> None:
    assert contact_of(EAST, STEP, POST) == ("capsule", "POST")


def test_contact_with_the_edge_of_the_floor_has_no_obstacle() -> None:
    assert contact_of(EAST, FAR, floor=box(-350, -5000, 5000, 5000)) == ("capsule", "floor")
    assert contact_of(EAST, FAR, floor=box(-400, -415, 5000, 415)) == ("vehicle", "floor")


def test_hole_in_the_floor_is_off_the_floor() -> None:
    floor = WIDE_FLOOR.difference(box(1200, -10, 1220, 10))
    assert contact_of(EAST, floor=floor) == ("vehicle", "floor")


def test_pose_wholly_off_the_floor_touches_its_edge() -> None:
    beyond = Pose(400.0, 0.0, 0.0, 0.0)
    assert contact_of(beyond, floor=box(-400, -500, 0, 500)) == ("capsule", "floor")


def test_nothing_touched_is_no_contact() -> None:
    assert Collider(FloorPlan(WIDE_FLOOR, (FAR,)), PROTOTYPE).contact(EAST) is None


def test_all_that_a_part_touches_is_named_in_the_plan_s_order() -> None:
    shapes: list[Shape] = [
        box(0, 0, 10, 10),
        Circle(0.0, 0.0, 10.0),
        LineString([(0, 0), (10, 0)]),
        Circle(5.0, 0.0, 10.0),
        box(500, 500, 510, 510),
        Point(3, 3).buffer(2),
    ]
    plan = plan_of(WIDE_FLOOR, *shapes)
    touched = Collider(plan, PROTOTYPE).touched(PROTOTYPE.capsule(unit(0)))
    assert [o.handle for o in touched if o is not None] == ["0", "1", "2", "3", "5"]


def test_reference_engine_blocks_the_nodes_that_touch() -> None:
    lattice = Lattice((-1000.0, -1000.0), 500.0, 4, 5, 4, (0,))
    post = Circle(250.0, -250.0, 100.0)
    reference = Reference(Collider(plan_of(WIDE_FLOOR, post), PROTOTYPE), lattice)
    blocked = Nodes(reference.blocked(PROTOTYPE.capsule(unit(0))), lattice.n_columns).as_array()
    # nodes at x = -750 .. 1250, y = -750 .. 750; the spine spans x .. x + 645, so those in the
    # post's row touch it when x ≤ 250 + 450 and x + 645 ≥ 250 - 450, and no other row is within 450
    expected = np.zeros((4, 5), dtype=bool)
    expected[1, :3] = True
    assert np.array_equal(blocked, expected)
