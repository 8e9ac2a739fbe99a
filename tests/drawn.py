"""Robots drawn at random, and plans that are hard on the free space, named after what is hard."""

import math
from typing import Final

from hypothesis import strategies as st
from shapely.affinity import rotate, translate
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

from satAOI_geo.plan import Circle, FloorPlan, Kind, Obstacle, Region, Shape, polygons_in
from satAOI_geo.robot import Robot

SWING_RANGES_DEG: Final = [
    (-90, 90),
    (-45, 120),
    (0, 75),
    (-170, -10),
    (-180, 180),
    (-180, 175),
    (0, 0),
]
"""The prototype's, three that are not symmetric, the full turn, one that lacks 5° of it, and a
stiff arm."""


@st.composite
def robots(draw: st.DrawFn) -> Robot:
    """Robots of odd measures; the pivot may lie far outside the vehicle."""
    disc_mm = draw(st.floats(30, 450))
    length_mm = draw(st.floats(50, 1000))
    least_deg, most_deg = draw(st.sampled_from(SWING_RANGES_DEG))
    return Robot(
        name="drawn",
        vehicle_length_mm=length_mm,
        vehicle_width_mm=draw(st.floats(50, 1000)),
        pivot_offset_mm=length_mm * draw(st.floats(-1.5, 1.5)),
        arm_length_mm=disc_mm + draw(st.floats(0.01, 800)),
        disc_radius_mm=disc_mm,
        swing_min_rad=math.radians(least_deg),
        swing_max_rad=math.radians(most_deg),
    )


def plan_of(floor: Region, *shapes: Shape) -> FloorPlan:
    obstacles = (Obstacle(shape, Kind.WALL, handle=f"{k:X}") for k, shape in enumerate(shapes))
    return FloorPlan(floor, tuple(obstacles))


def ring(centre_mm: tuple[float, float], outer_mm: float, inner_mm: float) -> Polygon:
    """A square frame: a polygon with a hole."""
    x, y = centre_mm
    hole = box(x - inner_mm, y - inner_mm, x + inner_mm, y + inner_mm)
    return box(x - outer_mm, y - outer_mm, x + outer_mm, y + outer_mm).difference(hole)


ROOM: Final = box(0, 0, 4000, 3600)
CAMPUS_MM: Final = (400_000.0, -250_000.0)


def ring_part(
    centre_mm: tuple[float, float], outer_mm: float, inner_mm: float, window: Polygon
) -> Polygon:
    """What is in a window of a ring of many corners."""
    centre = Point(centre_mm)
    whole = centre.buffer(outer_mm, quad_segs=40).difference(centre.buffer(inner_mm, quad_segs=40))
    (part,) = polygons_in([whole.intersection(window)])
    return part


HARD: Final[dict[str, FloorPlan]] = {
    "nothing_on_the_floor": plan_of(ROOM),
    "specks_smaller_than_a_cell": plan_of(
        ROOM,
        box(2001, 1001, 2004, 1003),
        Circle(1004.0, 2504.0, 0.5),
        LineString([(3001, 2001), (3003, 2002)]),
        Polygon([(1500, 1500), (1500.01, 1500), (1500, 1500.01)]),
    ),
    "slivers": plan_of(
        ROOM,
        Polygon([(1000, 1200), (3000, 1200.001), (2000, 1200.002)]),
        Polygon([(500, 3000), (2500, 2400), (2500, 2400.000001)]),
        Polygon([(2000, 0), (2000.0001, 0), (2000.0001, 900), (2000, 900)]),
    ),
    "thin_bands_along_arcs": plan_of(
        ROOM,
        ring_part((2000, 1300), 700, 699.99, box(0, 0, 4000, 1500)),
        ring_part((3000, 3000), 300, 280, box(2900, 0, 4000, 4000)),
        Polygon(
            [(900, 2200), (1204, 2403), (1003, 2604), (1304, 2803), (1003.5, 2604), (1204.5, 2403)]
        ),
    ),
    "triangles_that_touch": plan_of(
        ROOM,
        Polygon([(1200, 1200), (2000, 1200), (1600, 1900)]),
        Polygon([(2000, 1200), (2800, 1200), (2400, 1900)]),
        Polygon([(1600, 1900), (2400, 1900), (2000, 1200)]),
        Polygon([(2000, 2600), (1600, 1900), (1500, 2600)]),
    ),
    "comb_with_holes": plan_of(
        ROOM,
        Polygon(
            [
                (800, 600),
                (3200, 600),
                (3200, 1700),
                (2900, 1700),
                (2900, 900),
                (2300, 900),
                (2300, 1300),
                (2000, 1300),
                (2000, 900),
                (1100, 900),
                (1100, 1700),
                (800, 1700),
            ],
            [[(2400, 700), (2800, 700), (2600, 800)], [(900, 1000), (1000, 1000), (950, 1500)]],
        ),
    ),
    "island_free_inside_a_frame": plan_of(
        box(0, 0, 6000, 6000),
        ring((3000, 3000), outer_mm=2300, inner_mm=2200),
        Circle(3500.0, 3900.0, 120.0),
    ),
    "frame_in_a_frame": plan_of(
        box(0, 0, 6000, 6000), ring((3000, 3000), 2900, 2850), ring((3000, 3000), 300, 100)
    ),
    "obstacles_across_the_edge_of_the_floor": plan_of(
        ROOM, box(-500, 1000, 400, 1400), Circle(2000.0, 3700.0, 300.0), Circle(4000.0, 0.0, 500.0)
    ),
    "obstacles_off_the_floor": plan_of(
        ROOM,
        box(4100, 1000, 5000, 2000),
        box(-3000, -3000, -2000, -2000),
        Circle(2000.0, 9000.0, 300.0),
        LineString([(-50, -50), (-50, 4000), (9000, 4000)]),
    ),
    "chains_with_corners_twice": plan_of(
        ROOM, LineString([(900, 900), (900, 900), (2500, 900), (2500, 900), (2500, 2500)])
    ),
    "corners_in_the_middle_of_sides": plan_of(
        ROOM,
        Polygon(
            [(1500, 1500), (2000, 1500), (2500, 1500), (2500, 2000), (2000, 2000), (1500, 2000)]
        ),
    ),
    "spiral": plan_of(
        box(0, 0, 5000, 5000),
        LineString(
            [(2500, 2600), (2400, 2600), (2400, 2400), (3800, 2400), (3800, 4000), (900, 4000)]
        ),
    ),
    "floor_with_holes": plan_of(
        Polygon(
            [(0, 0), (5000, 0), (5000, 4500), (0, 4500)],
            [
                [(2200, 2200), (2900, 2250), (2500, 2800)],
                [(400, 3600), (800, 3600), (800, 4000), (400, 4000)],
            ],
        ),
        Circle(3900.0, 1200.0, 90.0),
    ),
    "floor_in_two_parts": plan_of(
        MultiPolygon([box(0, 0, 2600, 2700), box(2800, 300, 5200, 3000)]), box(600, 700, 700, 800)
    ),
    "floor_narrower_than_the_robot": plan_of(box(0, 0, 5000, 690)),
    "floor_at_17_degrees": plan_of(
        rotate(ROOM, 17, origin=(0, 0)),
        rotate(box(1500, 1500, 1900, 1700), 17, origin=(0, 0)),
        Circle(900.0, 2500.0, 200.0),
    ),
    "floor_with_no_side_along_an_axis": plan_of(
        Polygon([(0, 300), (2100, -200), (4300, 1100), (3900, 3600), (1200, 4100), (-300, 2200)]),
        Polygon([(1900, 1800), (2300, 1850), (2250, 2200), (1950, 2100)]),
    ),
    "round_floor": plan_of(
        Point(2000, 2000).buffer(2000, quad_segs=24), Circle(2000.0, 2000.0, 60.0)
    ),
    "far_from_the_origin": plan_of(
        translate(ROOM, *CAMPUS_MM),
        translate(box(1000.3, 1000.7, 1400.1, 1300.9), *CAMPUS_MM),
        Circle(CAMPUS_MM[0] + 2800.1, CAMPUS_MM[1] + 2400.2, 150.3),
    ),
}
"""Each lies on a floor that holds the prototype, but for the one too narrow for it."""
