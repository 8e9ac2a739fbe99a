"""The plan on the page: floor, lines, obstacles, parts, start, places of findings."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon, box
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.inspected import Bounds, Figures, Inspected, Sketch
from satAOI_adapters.plan_picture.page import Area, Disc, Mark, Strokes, Text, printable
from satAOI_adapters.plan_picture.style import (
    BADGE,
    BLACK,
    BLUE,
    COLOURS,
    DOT,
    FLOOR_EDGE,
    FLOOR_FILL,
    GREEN,
    NO_OBSTACLE,
    PALE,
    PLAN_WIDTH,
    RED,
    SMALL,
    THICK,
    THIN,
    WHITE,
)
from satAOI_geo.plan import FloatArray, FloorPlan, Frame, Obstacle, polygons_in

ROOM: Final = 0.03
"""Blank space around the plan, as a share of its larger side."""

SAME: Final = 0.1
"""Corners closer than this on the page are one."""

MM_PER_M: Final = 1000.0


@dataclass(frozen=True, slots=True)
class Sheet:
    """The part of the page that the plan is drawn on.

    Attributes:
        bounds_mm: What it shows, in the drawing's axes.
        x: Its left edge on the page.
        y: Its upper edge.
        per_mm: Page units in a millimetre.
    """

    bounds_mm: Bounds
    x: float
    y: float
    per_mm: float

    @classmethod
    def over(cls, bounds_mm: Bounds, *, x: float, y: float, height: float) -> "Sheet":
        """The sheet that shows a part of the drawing's axes and a little around it.

        Args:
            bounds_mm: The part.
            x: Left edge of the sheet on the page.
            y: Its upper edge.
            height: Its greatest height.
        """
        left_mm, bottom_mm, right_mm, top_mm = bounds_mm
        room_mm = ROOM * (max(right_mm - left_mm, top_mm - bottom_mm) or MM_PER_M)
        around_mm = (left_mm - room_mm, bottom_mm - room_mm, right_mm + room_mm, top_mm + room_mm)
        width_mm, height_mm = around_mm[2] - around_mm[0], around_mm[3] - around_mm[1]
        return cls(around_mm, x, y, min(PLAN_WIDTH / width_mm, height / height_mm))

    @property
    def width(self) -> float:
        """Width on the page."""
        return (self.bounds_mm[2] - self.bounds_mm[0]) * self.per_mm

    @property
    def height(self) -> float:
        """Height on the page."""
        return (self.bounds_mm[3] - self.bounds_mm[1]) * self.per_mm

    @property
    def rim(self) -> Polygon:
        """Its rectangle on the page."""
        return box(self.x, self.y, self.x + self.width, self.y + self.height)

    def spots(self, points_mm: FloatArray) -> FloatArray:
        """Points of the drawing, shape (..., 2), on the page; y turns over."""
        left_mm, _, _, top_mm = self.bounds_mm
        x = self.x + (points_mm[..., 0] - left_mm) * self.per_mm
        y = self.y + (top_mm - points_mm[..., 1]) * self.per_mm
        return np.stack((x, y), axis=-1)

    def polygons(self, region: BaseGeometry, frame: Frame) -> list[Polygon]:
        """The polygons of a region on the page, cut off at the rim."""
        placed = shapely.make_valid(self._placed(region, frame))
        return polygons_in([placed.intersection(self.rim)])

    def lines(self, lines: Sequence[LineString], frame: Frame) -> tuple[LineString, ...]:
        """Lines on the page, cut off at the rim."""
        placed = self._placed(shapely.multilinestrings(list(lines)), frame)
        parts = shapely.get_parts(shapely.clip_by_rect(placed, *self.rim.bounds))
        return tuple(part for part in parts if isinstance(part, LineString))

    def _placed(self, geometry: BaseGeometry, frame: Frame) -> BaseGeometry:
        moved = shapely.transform(geometry, lambda points: self.spots(frame.to_drawing_mm(points)))
        return shapely.simplify(moved, SAME)


def plan_marks(found: Inspected[Figures], sheet: Sheet) -> Iterator[Mark]:
    """The plan, from the floor up to the start."""
    plan, sketch = found.plan, found.sketch
    if plan is not None:
        for polygon in sheet.polygons(plan.floor, plan.frame):
            yield Area(polygon, FLOOR_FILL, FLOOR_EDGE, THICK, "floor")
    if sketch is not None:
        yield from _lines(sketch, sheet, faded=plan is not None)
    if plan is not None:
        for kind in COLOURS:
            for obstacle in plan.obstacles:
                if obstacle.kind is kind:
                    yield from _obstacle(obstacle, plan.frame, sheet)
    if plan is not None and plan.start_mm is not None:
        yield from start_sign(*sheet.spots(plan.frame.to_drawing_mm(plan.start_mm)).tolist())


def floor_bounds_mm(plan: FloorPlan) -> Bounds:
    """Where the floor lies in the drawing's axes."""
    return _bounds_mm(shapely.get_coordinates(plan.floor), plan.frame)


def sketch_bounds_mm(sketch: Sketch) -> Bounds:
    """Where the parts that may be plans lie in the drawing's axes, or all where there are none."""
    everything = [line for lines in sketch.lines.values() for line in lines]
    shown = [box(*part_mm) for part_mm in sketch.parts_mm] or everything
    if not shown:
        return 0.0, 0.0, 0.0, 0.0
    return _bounds_mm(shapely.get_coordinates(shown), sketch.frame)


def _bounds_mm(points_mm: FloatArray, frame: Frame) -> Bounds:
    seen_mm = frame.to_drawing_mm(points_mm)
    (left_mm, bottom_mm), (right_mm, top_mm) = seen_mm.min(axis=0), seen_mm.max(axis=0)
    return float(left_mm), float(bottom_mm), float(right_mm), float(top_mm)


def _lines(sketch: Sketch, sheet: Sheet, *, faded: bool) -> Iterator[Strokes]:
    """All that is drawn; faded where the obstacles among it come over it."""
    for kind, lines in sketch.lines.items():
        if lines and kind is None:
            yield Strokes(sheet.lines(lines, sketch.frame), NO_OBSTACLE, THIN)
        elif lines and kind is not None:
            colour, width = (PALE[kind], THIN) if faded else (COLOURS[kind], THICK)
            yield Strokes(sheet.lines(lines, sketch.frame), colour, width)


def _obstacle(obstacle: Obstacle, frame: Frame, sheet: Sheet) -> Iterator[Mark]:
    colour, title = COLOURS[obstacle.kind], printable(obstacle.label())
    region = obstacle.region()
    if isinstance(region, LineString):
        yield Strokes(sheet.lines([region], frame), colour, THICK, title)
    for polygon in sheet.polygons(region, frame):
        yield Area(polygon, colour, colour, THIN, title)


def part_marks(sketch: Sketch, sheet: Sheet) -> Iterator[Mark]:
    """A frame and a number for each part of the drawing that may be a plan."""
    taken: list[tuple[float, float]] = []
    for number, part_mm in enumerate(sketch.parts_mm, start=1):
        rim = box(*part_mm).exterior
        frame_lines = sheet.lines([rim], sketch.frame)
        left, top, _, _ = shapely.total_bounds(frame_lines)
        spot = _free_spot(left, top, taken)
        taken.append(spot)
        yield Strokes(frame_lines, BLUE, THICK, f"plan {number}")
        yield from badge(*spot, str(number), BLUE)


def start_sign(x: float, y: float) -> Iterator[Mark]:
    """A ring with a cross, where the robot is set down."""
    reach = 1.5 * BADGE
    yield Disc(x, y, BADGE, WHITE, GREEN, 2 * THICK)
    cross = (
        LineString([(x - reach, y), (x + reach, y)]),
        LineString([(x, y - reach), (x, y + reach)]),
    )
    yield Strokes(cross, GREEN, THICK, "start")


def badge(x: float, y: float, text: str, colour: str) -> Iterator[Mark]:
    """A marker with a number in it."""
    yield Disc(x, y, BADGE, colour, WHITE)
    yield Text(x, y, text, SMALL - 2, WHITE, centred=True)


def place_marks(
    places_mm: Iterable[tuple[tuple[float, float], str]], sheet: Sheet
) -> Iterator[Mark]:
    """A dot at each place, given in the drawing's axes, and its number, if any, beside it.

    The number of a place off the sheet stands at the rim where it is nearest.
    """
    left, top, right, bottom = sheet.rim.bounds
    taken: list[tuple[float, float]] = []
    for at_mm, label in places_mm:
        x, y = sheet.spots(np.array(at_mm)).tolist()
        spot = (min(max(x, left), right), min(max(y, top), bottom))
        if label:
            # the badge must not cover the place itself
            beside = _free_spot(*spot, [*taken, spot])
            taken.append(beside)
            yield Strokes((LineString([spot, beside]),), RED, THIN)
            yield from badge(*beside, label, RED)
        if spot == (x, y):
            yield Disc(x, y, DOT, RED, WHITE)


def _free_spot(x: float, y: float, taken: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """The nearest spot at or around a point at which a badge covers no other badge."""
    for ring in range(12):
        for step in range(12):
            turn_rad = math.pi / 6 * step - math.pi / 4
            spot = (
                x + ring * BADGE * math.cos(turn_rad),
                y + ring * BADGE * math.sin(turn_rad),
            )
            if all(math.dist(spot, other) > 2 * BADGE for other in taken):
                return spot
    return x, y


def scale_bar(sheet: Sheet, unit: str = "m", mm_per_unit: float = MM_PER_M) -> Iterator[Mark]:
    """A bar of a round length, about a fifth of the sheet's width."""
    wanted = sheet.width / sheet.per_mm / mm_per_unit / 5
    power = 10.0 ** math.floor(math.log10(wanted))
    length = max(step * power for step in (1, 2, 5) if step * power <= wanted)
    left, y = sheet.x, sheet.y + sheet.height + 2 * BADGE
    right = left + length * mm_per_unit * sheet.per_mm
    ends = [LineString([(x, y - 5), (x, y + 5)]) for x in (left, right)]
    yield Strokes((LineString([(left, y), (right, y)]), *ends), BLACK, THICK)
    yield Text(right + BADGE, y, f"{length:g} {unit}", SMALL, BLACK)
