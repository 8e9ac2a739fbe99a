"""Named plans in memory: what is hard about each, drawn, with the area a person can compute.

All areas are those of the prototype robot (R = 350 mm) as the lattice step goes to 0. A disc that
rolls around a plan leaves (1 - π/4) R² in each corner that opens by a quarter turn, and nothing
at a corner that sticks out into the floor. On a lattice of step h less is covered: the outermost
nodes lie up to h farther from the walls, so the difference is below h times the outline's length.
"""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from shapely.geometry import LineString, MultiPolygon, Polygon, box

from satAOI_geo.plan import Circle, FloorPlan, Kind, Obstacle, Region, Shape
from satAOI_geo.robot import ROBOTS

PROTOTYPE: Final = ROBOTS["magicbim"]
DISC_MM: Final = PROTOTYPE.disc_radius_mm
CORNER_MM2: Final = (1 - math.pi / 4) * DISC_MM**2
"""What a round disc leaves in a square corner."""

Point: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Case:
    """A plan with what is known about it.

    Attributes:
        plan: The plan, in millimetres.
        start_mm: Disc centre to start from.
        disc_area_mm2: Area of the disc-connected set, or None where it has no closed form.
        pose_area_mm2: Area of the pose-connected set, likewise.
        outline_mm: Length of that area's boundary, rounded up; times the lattice step it bounds
            what a lattice may miss.
        beyond_mm: A free place that no motion from the start lets the disc cover, or None.
    """

    plan: FloorPlan
    start_mm: Point
    disc_area_mm2: float | None
    pose_area_mm2: float | None
    outline_mm: float
    beyond_mm: Point | None = None


def room_mm2(width_mm: float, height_mm: float) -> float:
    """What the disc covers of an empty rectangular room: ab - (4 - π) R²."""
    return width_mm * height_mm - 4 * CORNER_MM2


def room_on_lattice_mm2(width_mm: float, height_mm: float, step_mm: float = 10.0) -> float:
    """The same for discs on a lattice only, exact, for sides and R in whole steps.

    Nodes are cell centres and contact is collision, so the outermost discs stay half a step off
    the walls; between two neighbours a scallop is missing under the common tangent.
    """
    half_mm = step_mm / 2
    across_mm, up_mm = width_mm - step_mm, height_mm - step_mm
    arc_mm2 = half_mm * math.sqrt(DISC_MM**2 - half_mm**2) + DISC_MM**2 * math.asin(
        half_mm / DISC_MM
    )
    scallop_mm2 = DISC_MM * step_mm - arc_mm2
    n_scallops = 2 * round((across_mm + up_mm - 4 * DISC_MM) / step_mm)
    return room_mm2(across_mm, up_mm) - n_scallops * scallop_mm2


def room(width_mm: float = 4000.0, height_mm: float = 3000.0) -> Case:
    """
    ╭──────────────╮
    │              │   empty; the four corners stay rough
    │      ×       │
    ╰──────────────╯
    """
    area_mm2 = room_mm2(width_mm, height_mm)
    return Case(
        FloorPlan(box(0, 0, width_mm, height_mm)),
        (width_mm / 2, height_mm / 2),
        area_mm2,
        area_mm2,
        2 * (width_mm + height_mm),
    )


def l_shaped_room() -> Case:
    """
    ╭───────╮ 5000
    │       │
    │       └───────╮ 2500    five corners stay rough, the one that sticks out does not
    │   ×           │
    ╰───────────────╯
    0      2500    6000
    """
    floor = Polygon([(0, 0), (6000, 0), (6000, 2500), (2500, 2500), (2500, 5000), (0, 5000)])
    area_mm2 = 6000 * 2500 + 2500 * 2500 - 5 * CORNER_MM2
    return Case(FloorPlan(floor), (1500.0, 1500.0), area_mm2, area_mm2, 22_000.0)


def room_with_round_column() -> Case:
    """
    ╭──────────────╮ 6000
    │              │
    │      ●       │   the disc rolls all the way around the column, r = 300
    │  ×           │
    ╰──────────────╯
    """
    plan = _room_with(6000, 6000, Circle(3000.0, 3000.0, 300.0), kind=Kind.COLUMN)
    area_mm2 = room_mm2(6000, 6000) - math.pi * 300**2
    return Case(plan, (1000.0, 1000.0), area_mm2, area_mm2, 24_000.0 + 2 * math.pi * 300)


def arc_tangent_to_wall() -> Case:
    """
    ╭──────────────╮ 4000
    │              │
    │  ×    ▁      │   the column, r = 400, touches the wall: the disc fits into neither cusp
    │      ███     │
    ╰────── ▀ ─────╯
          3000    6000

    A cusp lies between the wall and two circles that touch it and each other: a trapezoid with
    sides r and R, 2√(rR) apart, less a sector of each circle.
    """
    radius_mm = 400.0
    plan = _room_with(6000, 4000, Circle(3000.0, radius_mm, radius_mm), kind=Kind.COLUMN)
    column_rad = math.acos((radius_mm - DISC_MM) / (radius_mm + DISC_MM))
    cusp_mm2 = (
        (radius_mm + DISC_MM) * math.sqrt(radius_mm * DISC_MM)
        - radius_mm**2 * column_rad / 2
        - DISC_MM**2 * (math.pi - column_rad) / 2
    )
    area_mm2 = room_mm2(6000, 4000) - math.pi * radius_mm**2 - 2 * cusp_mm2
    return Case(plan, (1000.0, 2500.0), area_mm2, area_mm2, 20_000.0 + 2 * math.pi * radius_mm)


def touching_corner() -> Case:
    """
    ╭──────────────╮ 6000
    │              │
    │      ┌───────┤ 3500
    ├──────◆───────┤ 3000   the two blocks touch in one point: nothing gets through,
    ├──────┘       │ 2500   and the lower part is an L
    │  ×           │
    ╰──────────────╯
    """
    plan = _room_with(6000, 6000, box(0, 2500, 3000, 3000), box(3000, 3000, 6000, 3500))
    area_mm2 = 6000 * 2500 + 3000 * 500 - 5 * CORNER_MM2
    return Case(plan, (1500.0, 1200.0), area_mm2, area_mm2, 18_000.0, beyond_mm=(3000.0, 5000.0))


def corridor_exactly_as_wide_as_disc() -> Case:
    """
    ╭──────────╮          ╭──────────╮
    │          └──────────┘ 2355     │   700 mm wide, its middle on a row of nodes: at every one
    │    ×                           │   of them the disc touches both sides, so it stays out
    │          ┌──────────┐ 1655     │
    ╰──────────╯          ╰──────────╯
    0        4000       7000       11000

    From the mouth the disc still covers a half disc of the corridor.
    """
    plan = FloorPlan(_two_rooms_floor(1655, 2355, between_mm=3000))
    area_mm2 = room_mm2(4000, 4000) + math.pi * DISC_MM**2 / 2
    return Case(plan, (2000.0, 2000.0), area_mm2, area_mm2, 18_000.0, beyond_mm=(5500.0, 2005.0))


def corridor_exactly_as_wide_as_vehicle() -> Case:
    """
    ╭──────────╮          ╭──────────╮
    │          └──────────┘ 2420     │   830 mm wide: the vehicle, straight on, would touch both
    │    ×          ?                │   sides, so it stays out of it but for a corner
    │          ┌──────────┐ 1590     │
    ╰──────────╯          ╰──────────╯
    0        4000       7000       11000

    The pivot S lies in the vehicle, at least 295 mm from its rim, and stays in the room; so the
    disc reaches less than 995 + 350 mm into the corridor, and not to its middle. How deep it
    gets depends on how far a turned vehicle's corner fits into the mouth: no closed form.
    """
    plan = FloorPlan(_two_rooms_floor(1590, 2420, between_mm=3000))
    return Case(plan, (2000.0, 2000.0), None, None, 20_000.0, beyond_mm=(5500.0, 2005.0))


def two_rooms(opening_mm: float) -> Case:
    """
    ╭──────────╮╭──────────╮
    │          └┘          │   a wall of 200 mm with an opening in the middle; 760 mm lets the
    │    ×                 │   disc through and stops the vehicle (830), 900 mm lets both through
    │          ┌┐          │
    ╰──────────╯╰──────────╯
    0        4000 4200    8200

    By the paper's rule the search leaks through an opening as narrow as the disc.
    """
    plan = FloorPlan(_two_rooms_floor(2000 - opening_mm / 2, 2000 + opening_mm / 2, between_mm=200))
    area_mm2 = 2 * room_mm2(4000, 4000) + 200 * opening_mm
    passable = opening_mm > PROTOTYPE.vehicle_width_mm
    return Case(
        plan,
        (2000.0, 2000.0),
        area_mm2,
        area_mm2 if passable else None,
        32_000.0,
        beyond_mm=None if passable else (6200.0, 2000.0),
    )


CASES: Final[dict[str, Callable[[], Case]]] = {
    "room": room,
    "l_shaped_room": l_shaped_room,
    "room_with_round_column": room_with_round_column,
    "arc_tangent_to_wall": arc_tangent_to_wall,
    "touching_corner": touching_corner,
    "corridor_exactly_as_wide_as_disc": corridor_exactly_as_wide_as_disc,
    "corridor_exactly_as_wide_as_vehicle": corridor_exactly_as_wide_as_vehicle,
    "two_rooms_760": lambda: two_rooms(760.0),
    "two_rooms_900": lambda: two_rooms(900.0),
}
"""The named plans, for `pytest.mark.parametrize`."""


def _room_with(
    width_mm: float, height_mm: float, *shapes: Shape, kind: Kind = Kind.EQUIPMENT
) -> FloorPlan:
    obstacles = tuple(Obstacle(shape, kind, layer=kind.name) for shape in shapes)
    return FloorPlan(box(0, 0, width_mm, height_mm), obstacles)


def _two_rooms_floor(low_mm: float, high_mm: float, *, between_mm: float) -> Polygon:
    """Two 4 × 4 m rooms side by side, joined by a passage from y = low to y = high."""
    right_mm = 4000 + between_mm
    left_half = [(4000, high_mm), (4000, 4000), (0, 4000), (0, 0), (4000, 0), (4000, low_mm)]
    right_half = [
        (right_mm, low_mm),
        (right_mm, 0),
        (right_mm + 4000, 0),
        (right_mm + 4000, 4000),
        (right_mm, 4000),
        (right_mm, high_mm),
    ]
    return Polygon(left_half + right_half)


# Plans drawn at random. Every coordinate is a whole eighth of a millimetre, so that turning by
# quarters, mirroring and shifting by whole cells are exact in double precision.

GRAIN_MM: Final = 0.125


def random_plan(
    seed: int, *, n_obstacles: int = 8, side_mm: tuple[int, int] = (3000, 6000)
) -> FloorPlan:
    """A room with obstacles of all sorts; the same seed gives the same plan.

    Sides are whole cells of 10 mm. Every third obstacle lies on whole centimetres, where ties
    with the lattice are the rule. Obstacles may overlap and may reach beyond the floor.
    """
    draw = random.Random(seed)
    low, high = (side // 10 for side in side_mm)
    width_mm, height_mm = 10.0 * draw.randint(low, high), 10.0 * draw.randint(low, high)
    makers = (_rectangle, _turned_rectangle, _circle, _star, _thin_wall)
    obstacles = []
    for index in range(n_obstacles):
        grain_mm = 10.0 if index % 3 == 0 else GRAIN_MM
        at_mm = _on_grain((draw.uniform(0, width_mm), draw.uniform(0, height_mm)), grain_mm)
        shape = draw.choice(makers)(draw, at_mm, grain_mm)
        obstacles.append(Obstacle(shape, draw.choice(list(Kind)), handle=f"{index:X}"))
    return FloorPlan(_random_floor(draw, width_mm, height_mm), tuple(obstacles))


def _random_floor(draw: random.Random, width_mm: float, height_mm: float) -> Polygon:
    """A rectangle; every third one with a corner cut out."""
    whole = box(0, 0, width_mm, height_mm)
    if draw.randrange(3):
        return whole
    cut_x_mm, cut_y_mm = (
        width_mm - 10 * draw.randint(20, 100),
        height_mm - 10 * draw.randint(20, 100),
    )
    ring = [(0, 0), (width_mm, 0), (width_mm, cut_y_mm), (cut_x_mm, cut_y_mm)]
    return Polygon([*ring, (cut_x_mm, height_mm), (0, height_mm)])


def _on_grain(point_mm: Point, grain_mm: float) -> Point:
    return grain_mm * round(point_mm[0] / grain_mm), grain_mm * round(point_mm[1] / grain_mm)


def _rectangle(draw: random.Random, at_mm: Point, grain_mm: float) -> Polygon:
    width_mm, height_mm = _on_grain((draw.uniform(60, 900), draw.uniform(60, 900)), grain_mm)
    return box(at_mm[0], at_mm[1], at_mm[0] + width_mm, at_mm[1] + height_mm)


def _turned_rectangle(draw: random.Random, at_mm: Point, grain_mm: float) -> Polygon:
    """A rectangle at any angle, from two perpendicular vectors on the grain: exactly square."""
    along_x, along_y = _on_grain((draw.uniform(80, 600), draw.uniform(80, 600)), grain_mm)
    # a quarter, a half or the whole of the vector, turned, keeps the corners on dyadic numbers
    share = draw.choice((0.25, 0.5, 1.0))
    up_x, up_y = -along_y * share, along_x * share
    x, y = at_mm
    return Polygon(
        [
            (x, y),
            (x + along_x, y + along_y),
            (x + along_x + up_x, y + along_y + up_y),
            (x + up_x, y + up_y),
        ]
    )


def _circle(draw: random.Random, at_mm: Point, grain_mm: float) -> Circle:
    radius_mm, _ = _on_grain((draw.uniform(40, 500), 0.0), grain_mm)
    return Circle(at_mm[0], at_mm[1], radius_mm)


def _star(draw: random.Random, at_mm: Point, grain_mm: float) -> Polygon:
    """A polygon with five to nine corners, every other one pulled in: not convex."""
    n_corners = draw.randint(5, 9)
    first_rad = draw.uniform(0, 2 * math.pi)
    corners = []
    for k in range(n_corners):
        angle_rad = first_rad + 2 * math.pi * k / n_corners
        reach_mm = draw.uniform(250, 600) if k % 2 else draw.uniform(80, 160)
        corner = (
            at_mm[0] + reach_mm * math.cos(angle_rad),
            at_mm[1] + reach_mm * math.sin(angle_rad),
        )
        corners.append(_on_grain(corner, grain_mm))
    return Polygon(corners)


def _thin_wall(draw: random.Random, at_mm: Point, grain_mm: float) -> LineString:
    """An open chain of two or three points, without width."""
    chain = [at_mm]
    for _ in range(draw.randint(1, 2)):
        x_mm, y_mm = chain[-1]
        chain.append(
            _on_grain((x_mm + draw.uniform(-900, 900), y_mm + draw.uniform(100, 900)), grain_mm)
        )
    return LineString(chain)


# The same plan in another place: exact for coordinates on the grain.


def quarter_turned(plan: FloorPlan) -> FloorPlan:
    """Turned counter-clockwise about the origin: (x, y) becomes (-y, x)."""
    return _mapped(plan, lambda x, y: (-y, x))


def mirrored(plan: FloorPlan) -> FloorPlan:
    """Mirrored in the y axis: (x, y) becomes (-x, y)."""
    return _mapped(plan, lambda x, y: (-x, y))


def shifted(plan: FloorPlan, x_mm: float, y_mm: float) -> FloorPlan:
    """Moved by (x, y)."""
    return _mapped(plan, lambda x, y: (x + x_mm, y + y_mm))


Motion: TypeAlias = Callable[[float, float], Point]


def _mapped(plan: FloorPlan, motion: Motion) -> FloorPlan:
    obstacles = tuple(replace(o, shape=_moved_shape(o.shape, motion)) for o in plan.obstacles)
    start_mm = motion(*plan.start_mm) if plan.start_mm else None
    return replace(
        plan, floor=_moved_region(plan.floor, motion), obstacles=obstacles, start_mm=start_mm
    )


def _moved_region(region: Region, motion: Motion) -> Region:
    if isinstance(region, MultiPolygon):
        return MultiPolygon([_moved_polygon(part, motion) for part in region.geoms])
    return _moved_polygon(region, motion)


def _moved_polygon(polygon: Polygon, motion: Motion) -> Polygon:
    holes = [[motion(x, y) for x, y in ring.coords] for ring in polygon.interiors]
    return Polygon([motion(x, y) for x, y in polygon.exterior.coords], holes)


def _moved_shape(shape: Shape, motion: Motion) -> Shape:
    if isinstance(shape, Circle):
        return Circle(*motion(shape.x_mm, shape.y_mm), shape.radius_mm)
    if isinstance(shape, LineString):
        return LineString([motion(x, y) for x, y in shape.coords])
    return _moved_polygon(shape, motion)
