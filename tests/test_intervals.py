"""Row intervals against closed forms of the distance, node by node."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st
from shapely.affinity import rotate
from shapely.geometry import LineString, Point, Polygon, box

from satAOI_geo.collision import Collider, Reference
from satAOI_geo.intervals import Intervals, set_bits
from satAOI_geo.lattice import Lattice
from satAOI_geo.nodes import Nodes
from satAOI_geo.plan import CONTACT_MM, BoolArray, Circle, FloatArray, FloorPlan, Shape
from satAOI_geo.robot import ROBOTS, Part, unit
from tests import plans
from tests.drawn import plan_of

PROTOTYPE = ROBOTS["magicbim"]
WIDE_FLOOR = box(-20_000, -20_000, 20_000, 20_000)

WINDOW = Lattice((-1000.0, -800.0), 10.0, 160, 200, 4, (0,))
"""Nodes -995 .. 995 by -795 .. 795, far from the edge of the floor."""

POINT = Part(np.zeros((1, 2)), 0.0)


def blocked(
    part: Part, *shapes: Shape, lattice: Lattice = WINDOW, clearance_mm: float = 0.0
) -> BoolArray:
    plan = plan_of(WIDE_FLOOR, *shapes)
    return Nodes(
        Intervals.of(plan, PROTOTYPE, lattice, clearance_mm).blocked(part), lattice.n_columns
    ).as_array()


def nodes_mm(lattice: Lattice = WINDOW) -> tuple[FloatArray, FloatArray]:
    """x and y of all nodes, shape (n_rows, n_columns) each."""
    x_mm = np.array([lattice.x_mm(ix) for ix in range(lattice.n_columns)])
    y_mm = np.array([lattice.y_mm(iy) for iy in range(lattice.n_rows)])
    across_mm, up_mm = np.meshgrid(x_mm, y_mm)
    return across_mm, up_mm


def beyond_mm(values_mm: FloatArray, low_mm: float, high_mm: float) -> FloatArray:
    """How far values lie outside an interval."""
    return np.maximum(0.0, np.maximum(low_mm - values_mm, values_mm - high_mm))


lengths_mm = st.floats(0.01, 400)
places_mm = st.floats(-900, 900)


@given(places_mm, places_mm, lengths_mm, lengths_mm)
def test_disc_touches_a_circle_within_the_sum_of_their_radii(
    x_mm: float, y_mm: float, radius_mm: float, disc_mm: float
) -> None:
    across_mm, up_mm = nodes_mm()
    gaps_mm = np.hypot(across_mm - x_mm, up_mm - y_mm) - radius_mm - disc_mm
    found = blocked(replace(POINT, radius_mm=disc_mm), Circle(x_mm, y_mm, radius_mm))
    assert np.array_equal(found, gaps_mm <= CONTACT_MM)


@given(places_mm, places_mm, lengths_mm, lengths_mm, lengths_mm)
def test_disc_touches_a_box_within_its_radius(
    left_mm: float, bottom_mm: float, width_mm: float, height_mm: float, disc_mm: float
) -> None:
    across_mm, up_mm = nodes_mm()
    right_mm, top_mm = left_mm + width_mm, bottom_mm + height_mm
    gaps_mm = np.hypot(beyond_mm(across_mm, left_mm, right_mm), beyond_mm(up_mm, bottom_mm, top_mm))
    found = blocked(replace(POINT, radius_mm=disc_mm), box(left_mm, bottom_mm, right_mm, top_mm))
    assert np.array_equal(found, gaps_mm <= disc_mm + CONTACT_MM)


@given(places_mm, places_mm, lengths_mm, lengths_mm, st.sampled_from([0.0, 35.0]))
def test_straight_robot_touches_a_circle_where_its_parts_are_near(
    x_mm: float, y_mm: float, radius_mm: float, spine_mm: float, clearance_mm: float
) -> None:
    across_mm, up_mm = nodes_mm()
    post = Circle(x_mm, y_mm, radius_mm)
    keep_mm = radius_mm + clearance_mm + CONTACT_MM
    # seen from the node, the post lies at (x - across, y - up)
    spine = Part(np.array(((0.0, 0.0), (spine_mm, 0.0))), 120.0)
    gaps_mm = np.hypot(beyond_mm(x_mm - across_mm, 0.0, spine_mm), y_mm - up_mm)
    found = blocked(spine, post, clearance_mm=clearance_mm)
    assert np.array_equal(found, gaps_mm <= 120.0 + keep_mm)

    vehicle = PROTOTYPE.vehicle(unit(0), unit(0))
    gaps_mm = np.hypot(
        beyond_mm(x_mm - across_mm, 699.5, 1574.5), beyond_mm(y_mm - up_mm, -415.0, 415.0)
    )
    found = blocked(vehicle, post, clearance_mm=clearance_mm)
    assert np.array_equal(found, gaps_mm <= keep_mm)


@pytest.mark.parametrize(
    ("reach_mm", "columns"),
    [
        # nodes at x = ..., -15, -5, 5, 15, ...; the wall at x = 0; contact is collision
        (4.9, []),
        (4.9999, [-5, 5]),
        (4.99989, []),
        (5.0, [-5, 5]),
        (14.999, [-5, 5]),
        (15.0, [-15, -5, 5, 15]),
    ],
)
def test_distance_of_exactly_the_radius_is_contact(reach_mm: float, columns: list[float]) -> None:
    wall = LineString([(0, -2000), (0, 2000)])
    found = blocked(replace(POINT, radius_mm=reach_mm), wall)
    assert [WINDOW.x_mm(ix) for ix in np.flatnonzero(found.all(axis=0)).tolist()] == columns
    assert found.any(axis=0).sum() == len(columns)


@pytest.mark.parametrize("turns", range(4))
def test_right_triangle_is_met_at_its_exact_offset(turns: int) -> None:
    # sides 300, 400, 500: its long side lies on 4x + 3y = 1200, 5 mm off for every 25 in 4x + 3y
    corners_mm = [(0, 0), (300, 0), (0, 400)]
    for _ in range(turns):
        corners_mm = [(-y, x) for x, y in corners_mm]
    across_mm, up_mm = nodes_mm()
    for _ in range(turns):
        across_mm, up_mm = up_mm, -across_mm
    found = blocked(replace(POINT, radius_mm=5.0), Polygon(corners_mm))
    beside = (across_mm > 10) & (up_mm > 10)
    expected = 4 * across_mm + 3 * up_mm <= 1200 + 5 * (5 + CONTACT_MM)
    assert np.array_equal(found[beside], expected[beside])


@pytest.mark.parametrize(
    "shape",
    [
        Circle(0.0, 5000.0, 300.0),
        Circle(0.0, -5000.0, 300.0),
        Circle(5000.0, 0.0, 300.0),
        Circle(-5000.0, 0.0, 300.0),
        box(-3000, 1500, 3000, 1600),
        LineString([(1500, -3000), (1500, 3000)]),
    ],
    ids=repr,
)
def test_obstacle_away_from_the_lattice_blocks_nothing(shape: Shape) -> None:
    assert not blocked(replace(POINT, radius_mm=300.0), shape).any()


def test_obstacle_larger_than_the_lattice_blocks_it_all() -> None:
    assert blocked(POINT, box(-5000, -5000, 5000, 5000)).all()
    assert blocked(POINT, Circle(300.0, 0.0, 4000.0)).all()


def test_hole_of_an_obstacle_is_not_blocked() -> None:
    frame = box(-500, -500, 500, 500).difference(box(-300, -300, 300, 300))
    across_mm, up_mm = nodes_mm()
    in_hole = (np.abs(across_mm) < 300) & (np.abs(up_mm) < 300)
    in_frame = (np.abs(across_mm) <= 500) & (np.abs(up_mm) <= 500) & ~in_hole
    assert np.array_equal(blocked(POINT, frame), in_frame)


def test_point_of_touch_of_two_blocks_is_blocked() -> None:
    # the corner both share is the node (5, 5)
    found = blocked(POINT, box(-100, -100, 5, 5), box(5, 5, 100, 100))
    across_mm, up_mm = nodes_mm()
    lower = (np.abs(across_mm + 47.5) <= 52.5) & (np.abs(up_mm + 47.5) <= 52.5)
    upper = (np.abs(across_mm - 52.5) <= 47.5) & (np.abs(up_mm - 52.5) <= 47.5)
    assert np.array_equal(found, lower | upper)


def test_line_whose_ends_are_one_point_is_met_as_that_point() -> None:
    across_mm, up_mm = nodes_mm()
    found = blocked(replace(POINT, radius_mm=200.0), LineString([(33, 44), (33, 44)]))
    assert np.array_equal(found, np.hypot(across_mm - 33, up_mm - 44) <= 200 + CONTACT_MM)


def test_all_off_the_floor_is_blocked() -> None:
    floor = Polygon([(-900, -700), (900, -700), (900, 700), (0, 100), (-900, 700)])
    lattice = WINDOW
    plan = FloorPlan(floor)
    found = Nodes(
        Intervals.of(plan, PROTOTYPE, lattice).blocked(POINT), lattice.n_columns
    ).as_array()
    across_mm, up_mm = nodes_mm()
    # the notch runs from (0, 100) to (±900, 700), down to 2/3 of |x| above 100
    expected = (
        (np.abs(across_mm) >= 900) | (up_mm <= -700) | (up_mm >= 100 + np.abs(across_mm) / 1.5)
    )
    assert np.array_equal(found, expected)


@pytest.mark.parametrize("n_columns", [1, 2, 63, 64, 65, 128, 129, 200])
def test_bits_beyond_the_last_column_are_set_whatever_is_blocked(n_columns: int) -> None:
    lattice = replace(WINDOW, n_columns=n_columns)
    for shapes in ((), (box(-5000, -5000, 5000, 5000),), (Circle(-900.0, 0.0, 90.0),)):
        words = Intervals.of(plan_of(WIDE_FLOOR, *shapes), PROTOTYPE, lattice).blocked(POINT)
        n_blocked = Nodes(words, lattice.n_columns).as_array().sum()
        n_beyond = words.shape[1] * 64 - n_columns
        assert np.bitwise_count(words).sum() == n_blocked + n_beyond * lattice.n_rows


@given(st.integers(0, 255), st.integers(0, 255), st.integers(0, 2**64 - 1))
def test_set_bits_sets_these_bits_and_leaves_the_others(one: int, other: int, before: int) -> None:
    begin, end = sorted((one, other))
    row = np.full(4, before, dtype=np.uint64)
    set_bits(row, begin, end)
    value = sum(int(word) << 64 * k for k, word in enumerate(row))
    old = sum(before << 64 * k for k in range(4))
    assert value == old | ((1 << end + 1) - (1 << begin))


@given(
    st.integers(3, 9),
    st.floats(0, 2 * math.pi),
    st.floats(50, 500),
    st.sampled_from([0.0, 1.0, 17.0, 350.0]),
    places_mm,
)
def test_regular_polygon_is_met_within_its_offset(
    n_corners: int, first_rad: float, radius_mm: float, reach_mm: float, x_mm: float
) -> None:
    angles_rad = first_rad + 2 * np.pi * np.arange(n_corners) / n_corners
    corners_mm = np.column_stack(
        (x_mm + radius_mm * np.cos(angles_rad), radius_mm * np.sin(angles_rad))
    )
    across_mm, up_mm = nodes_mm()
    gaps_mm = polygon_gaps_mm(corners_mm, across_mm, up_mm)
    found = blocked(replace(POINT, radius_mm=reach_mm), Polygon(corners_mm))
    assert np.array_equal(found, gaps_mm <= reach_mm + CONTACT_MM)


def polygon_gaps_mm(corners_mm: FloatArray, x_mm: FloatArray, y_mm: FloatArray) -> FloatArray:
    """Distance of points from a convex polygon, counter-clockwise: 0 inside, else to a side."""
    inside = np.ones(x_mm.shape, dtype=bool)
    nearest_mm = np.full(x_mm.shape, np.inf)
    for (ax, ay), (bx, by) in zip(corners_mm, np.roll(corners_mm, -1, axis=0), strict=True):
        length_mm = math.hypot(bx - ax, by - ay)
        ux, uy = (bx - ax) / length_mm, (by - ay) / length_mm
        along_mm = (x_mm - ax) * ux + (y_mm - ay) * uy
        left_mm = (y_mm - ay) * ux - (x_mm - ax) * uy
        inside &= left_mm >= 0
        nearest_mm = np.minimum(nearest_mm, np.hypot(beyond_mm(along_mm, 0, length_mm), left_mm))
    return np.where(inside, 0.0, nearest_mm)


def stars() -> st.SearchStrategy[Polygon]:
    """Outlines that bend in and out, with level sides among theirs, about the origin."""

    def of(reaches_mm: list[float], grain_mm: float) -> Polygon:
        angles_rad = 2 * np.pi * np.arange(len(reaches_mm)) / len(reaches_mm)
        corners_mm = np.column_stack((np.cos(angles_rad), np.sin(angles_rad)))
        corners_mm *= np.array(reaches_mm)[:, np.newaxis]
        return Polygon(grain_mm * np.round(corners_mm / grain_mm))

    reaches_mm = st.lists(st.floats(60, 600), min_size=3, max_size=24)
    return st.builds(of, reaches_mm, st.sampled_from([0.125, 100.0]))


def crescents() -> st.SearchStrategy[Polygon]:
    """Thin and thick bands along arcs, turned."""

    def of(radius_mm: float, width_mm: float, turn_deg: float, x_mm: float) -> Polygon:
        ring = (
            Point(0, 0).buffer(radius_mm, 24).difference(Point(0, 0).buffer(radius_mm - width_mm))
        )
        part = ring.intersection(box(x_mm, -1000, 1000, 1000))
        return rotate(shapely.get_parts(part)[0], turn_deg, origin=(0, 0))

    return st.builds(
        of,
        st.floats(200, 600),
        st.sampled_from([0.01, 30.0, 150.0]),
        st.floats(0, 360),
        st.sampled_from([-100.0, 0.0, 90.0]),
    )


@given(
    stars() | crescents(),
    st.integers(1, 6),
    st.floats(0, 2 * math.pi),
    st.floats(10, 400),
    st.sampled_from([0.0, 3.0, 120.0]),
)
def test_part_touches_an_outline_where_the_distance_is_within_its_radius(
    outline: Polygon, n_corners: int, first_rad: float, size_mm: float, radius_mm: float
) -> None:
    assume(outline.is_valid and outline.area > 0)
    angles_rad = first_rad + 2 * np.pi * np.arange(n_corners) / n_corners
    corners_mm = size_mm * np.column_stack((np.cos(angles_rad), 0.4 * np.sin(angles_rad)))
    coarse = replace(WINDOW, step_mm=25.0, n_rows=64, n_columns=80)
    across_mm, up_mm = nodes_mm(coarse)
    nodes = np.stack((across_mm, up_mm), axis=-1)[..., np.newaxis, :]
    parts = shapely.convex_hull(shapely.multipoints(corners_mm + nodes))
    gaps_mm = shapely.distance(parts, outline)
    found = blocked(Part(ring_of(corners_mm), radius_mm), outline, lattice=coarse)
    expected = gaps_mm <= radius_mm + CONTACT_MM
    # shapely's own rounding may fall on either side of contact
    sure = np.abs(gaps_mm - radius_mm - CONTACT_MM) > 1e-9
    assert np.array_equal(found[sure], expected[sure])


@pytest.mark.parametrize("radius_mm", [0.0, 120.0])
@pytest.mark.parametrize("rise_mm", [4.9e-16, -4.9e-16, 1e-12])
@pytest.mark.parametrize("quarters", range(4))
def test_part_that_is_level_but_for_rounding_is_met_as_a_level_one(
    quarters: int, rise_mm: float, radius_mm: float
) -> None:
    corners_mm = np.array([(100.0, 0.0), (-100.0, rise_mm)])
    level_mm = np.array([(100.0, 0.0), (-100.0, 0.0)])
    for _ in range(quarters):
        corners_mm, level_mm = (
            np.stack((-c[:, 1], c[:, 0]), axis=1) for c in (corners_mm, level_mm)
        )
    outline = Polygon([(0, -300), (200, 0), (0, 300), (90, 0)])
    found, expected = (blocked(Part(c, radius_mm), outline) for c in (corners_mm, level_mm))
    assert np.array_equal(found, expected)


@pytest.mark.parametrize("rise_mm", [5e-14, 1e-13, -5e-14])
@pytest.mark.parametrize("shape", [LineString, Polygon])
def test_side_that_is_level_but_for_rounding_is_met_as_a_level_one(
    shape: type[LineString] | type[Polygon], rise_mm: float
) -> None:
    # 800 mm above the lattice's corner the first of these is none
    for rest in ([(300.0, 400.0)], [(100.0, 0.0), (150.0, 300.0)]):
        found, expected = (
            blocked(replace(POINT, radius_mm=50.0), shape([(500.0, 0.0), (300.0, y_mm), *rest]))
            for y_mm in (rise_mm, 0.0)
        )
        assert np.array_equal(found, expected)


def ring_of(corners_mm: FloatArray) -> FloatArray:
    """Corners of the convex hull, counter-clockwise, the first not repeated."""
    hull = shapely.convex_hull(shapely.multipoints(corners_mm))
    ends_mm = shapely.get_coordinates(shapely.orient_polygons(hull))
    return ends_mm[:-1] if isinstance(hull, Polygon) else ends_mm


@pytest.mark.parametrize("seed", range(4))
def test_rows_that_are_asked_for_are_those_of_the_whole(seed: int) -> None:
    plan = plans.random_plan(seed, n_obstacles=8)
    lattice = Lattice.over(plan.floor.bounds, PROTOTYPE, step_mm=50.0)
    part = PROTOTYPE.vehicle(unit(0.3), unit(1.1))
    engines = Intervals.of(plan, PROTOTYPE, lattice), Reference(Collider(plan, PROTOTYPE), lattice)
    whole = engines[0].blocked(part)
    draw = np.random.default_rng(seed)
    for share in (0.0, 0.05, 0.5):
        rows = draw.random(lattice.n_rows) < share
        for engine in engines:
            assert np.array_equal(engine.blocked(part, rows)[rows], whole[rows])
