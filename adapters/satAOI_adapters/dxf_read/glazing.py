"""What is drawn on the layers of windows, window by window: some are doors, some part rooms.

Offices with one layer for doors and windows draw shutters and sliding doors on it, too, which show
no swing. A text beside them that says so makes them doors. Of other windows between floor and floor
nobody can tell; that much is said.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, MultiLineString, Polygon
from shapely.geometry import Point as Spot

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.doors import (
    FACES_MM,
    abreast,
    as_lines,
    loose_pieces,
    spanning,
)
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.marks import Mark, are_believed
from satAOI_adapters.dxf_read.meaning import LISTED
from satAOI_adapters.dxf_read.openings import Span, as_one, middles, shut
from satAOI_adapters.dxf_read.plans import Drawn
from satAOI_adapters.dxf_read.shapes import middle_line
from satAOI_adapters.dxf_read.swings import LEAF_SLACK_MM, LEAST_LEAF_MM, parted, swings
from satAOI_adapters.meanings import Meaning
from satAOI_adapters.wording import counted
from satAOI_geo.plan import Finding, Frame, Obstacle, Region

BESIDE_MM: Final = 1000.0
"""A mark is no farther from the opening that it belongs to."""


@dataclass(frozen=True, slots=True)
class Glazing:
    """What is drawn in one opening on a layer of windows.

    Attributes:
        pieces: Its lines.
        lines: These as a shape.
        span: From jamb to jamb, half-way between its faces.
        depth_mm: How far its faces are apart.
    """

    pieces: tuple[Feature, ...]
    lines: MultiLineString
    span: Span
    depth_mm: float

    @classmethod
    def of(cls, pieces: Sequence[Feature]) -> "Glazing":
        """The lines of one opening together."""
        lines = MultiLineString(as_lines(pieces))
        around = lines.minimum_rotated_rectangle
        if not isinstance(around, Polygon):
            start, *_, end = around.coords
            return cls(tuple(pieces), lines, Span(start, end), 0.0)
        depth, span = sorted(middles(around), key=lambda middle: middle.width_mm)
        return cls(tuple(pieces), lines, span, depth.width_mm)

    def sides(self) -> tuple[Spot, Spot]:
        """A place on either side of it and of the wall that it stands in."""
        beside_mm, along_mm = self.depth_mm / 2 + FACES_MM, self.span.width_mm / 2
        return Spot(self.span.at(along_mm, beside_mm)), Spot(self.span.at(along_mm, -beside_mm))


def with_marked_doors(
    drawn: Drawn, marks: Sequence[Mark], frame: Frame
) -> tuple[Drawn, tuple[Finding, ...]]:
    """What is drawn, with what marks say to be doors among the doors, and what is to be said."""
    if not are_believed(marks):
        return drawn, ()
    marked = _marked(drawn, marks)
    are_doors = {id(piece.placed) for glazing, _ in marked for piece in glazing.pieces}
    windows = [feature for feature in drawn[Meaning.WINDOW] if id(feature.placed) not in are_doors]
    doors = [feature for feature in drawn[Meaning.WINDOW] if id(feature.placed) in are_doors]
    return (
        {**drawn, Meaning.WINDOW: windows, Meaning.DOOR: [*drawn[Meaning.DOOR], *doors]},
        tuple(_by_mark(glazing, mark, frame) for glazing, mark in marked),
    )


def between_rooms(
    drawn: Drawn, floor: Region, obstacles: Sequence[Obstacle], frame: Frame
) -> tuple[Finding, ...]:
    """What is to be said about windows that are in the way from floor to floor."""
    shapely.prepare(floor)
    tree = shapely.STRtree([obstacle.region() for obstacle in obstacles])

    def is_inner(glazing: Glazing) -> bool:
        sides = glazing.sides()
        are_free = not tree.query(sides, predicate="intersects").size
        is_shut = tree.query(LineString(sides), predicate="intersects").size > 0
        return are_free and is_shut and all(map(floor.contains, sides))

    inner = [glazing for glazing in _glazings(drawn) if is_inner(glazing)]
    return (_inner(inner, frame),) if inner else ()


def _glazings(drawn: Drawn) -> list[Glazing]:
    """What stands from jamb to jamb in openings, doors that swing aside."""
    features, _ = parted(drawn[Meaning.WINDOW], swings(drawn[Meaning.WINDOW]))
    pieces = loose_pieces(features, frozenset(), with_outlines=True)
    if not pieces:
        return []
    lines = as_lines(pieces)
    touching = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=LEAF_SLACK_MM)
    of_group: defaultdict[int, list[Feature]] = defaultdict(list)
    group = linked(np.concatenate((touching.T, abreast(lines))), len(lines))
    for piece, number in zip(pieces, group.tolist(), strict=True):
        of_group[number].append(piece)
    found = [Glazing.of(each) for each in of_group.values()]
    wide = [g for g in found if g.span.width_mm >= LEAST_LEAF_MM and g.depth_mm <= WALL_MM]
    walls = [
        middle_line(path)
        for meaning in (Meaning.WALL, Meaning.COLUMN)
        for feature in drawn[meaning]
        for path in feature.paths
    ]
    at_jambs = spanning([g.span.line for g in wide], walls, FACES_MM / 2)
    return [glazing for glazing, does in zip(wide, at_jambs, strict=True) if does]


def _marked(drawn: Drawn, marks: Sequence[Mark]) -> list[tuple[Glazing, Mark]]:
    """What marks say to be doors: no other opening is nearer to these, and it is as wide.

    A door that swings has its mark first, also where a window is nearer to it.
    """
    found = _glazings(drawn)
    if not found:
        return []
    doors = swings([*drawn[Meaning.WINDOW], *drawn[Meaning.DOOR]])
    swung = [span for door in doors for span in shut(door)]
    leaves = [*swung, *as_one(swung)]
    openings = shapely.STRtree([*(g.lines for g in found), *(span.line for span in leaves)])
    of_swings = {own for span in leaves if (own := _own_mark(span, marks)) is not None}
    marks = [mark for i, mark in enumerate(marks) if i not in of_swings]
    spots = [Spot(mark.at) for mark in marks]
    of_mark, nearest = openings.query_nearest(spots, max_distance=BESIDE_MM)
    beside: defaultdict[int, list[Mark]] = defaultdict(list)
    for m, i in zip(of_mark.tolist(), nearest.tolist(), strict=True):
        beside[i].append(marks[m])
    return [
        (glazing, beside[i][0])
        for i, glazing in enumerate(found)
        if beside[i]
        and all(mark.is_door and mark.fits(glazing.span.width_mm) for mark in beside[i])
    ]


def _own_mark(span: Span, marks: Sequence[Mark]) -> int | None:
    """The number of the nearest mark that says of a door that swings how wide it is."""
    line = span.line
    beside = [
        (away_mm, mark.at, i)
        for i, mark in enumerate(marks)
        if mark.is_door
        and mark.fits(span.width_mm)
        and (away_mm := line.distance(Spot(mark.at))) <= BESIDE_MM
    ]
    return min(beside)[-1] if beside else None


def _by_mark(glazing: Glazing, mark: Mark, frame: Frame) -> Finding:
    x_mm, y_mm = _middle(glazing, frame)
    placed = glazing.pieces[0].placed
    return Finding(
        "door-by-mark",
        f"what is drawn on layer '{placed.layer}' at ({x_mm:.1f}, {y_mm:.1f}) mm is taken as a "
        f"door, which lets the robot pass: the text '{mark.text}' beside it says so",
        "draw windows and doors on layers of their own, or correct the text if it is a window",
        layer=placed.layer,
        handle=placed.handle,
        at_mm=(x_mm, y_mm),
    )


def _inner(found: Sequence[Glazing], frame: Frame) -> Finding:
    """What is to be said about windows between floor and floor."""
    places = [_middle(glazing, frame) for glazing in found]
    named = ", ".join(f"({x_mm:.1f}, {y_mm:.1f})" for x_mm, y_mm in places[:LISTED])
    more = f" and {len(places) - LISTED} more" if len(places) > LISTED else ""
    placed = found[0].pieces[0].placed
    return Finding(
        "window-between-rooms",
        f"the robot does not pass {counted(len(found), 'window')} between floor and floor, at "
        f"{named}{more} mm",
        "draw doors that show no swing, such as shutters, on a layer of doors",
        layer=placed.layer,
        handle=placed.handle,
        at_mm=places[0],
    )


def _middle(glazing: Glazing, frame: Frame) -> Point:
    """The middle of an opening, in the drawing's axes."""
    x_mm, y_mm = frame.to_drawing_mm([glazing.span.at(glazing.span.width_mm / 2, 0.0)])[0]
    return float(x_mm), float(y_mm)
