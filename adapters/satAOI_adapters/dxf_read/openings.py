"""Openings that doors show in walls drawn without a break.

Many offices lay the symbol of a door over a wall whose lines go on under it, with a mask (WIPEOUT)
or without. The swing tells the opening: it reaches from the hinge to where the tip of the leaf is
when the door is shut. A door without a swing tells it by its mask, or by an outline from one face
of the wall to the other. Where one with none of these leads through, a sliding door, nobody can
tell; that much is said, and so it is of a leaf that stands open at a wall without any opening.

      ┌╮ leaf and swing
      │ ╲
    ══╪═══╪══      a wall, whole as it is drawn
      hinge tip
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias, TypeVar

import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry import Point as Spot
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Point
from satAOI_adapters.dxf_read.doors import ABREAST_MM
from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.groups import linked
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.obstacles import Standing
from satAOI_adapters.dxf_read.options import CLOSE_GAPS_MM
from satAOI_adapters.dxf_read.shapes import middle_line, rounded
from satAOI_adapters.dxf_read.swings import LEAF_MM, LEAF_SLACK_MM, LEAST_LEAF_MM, Swing
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_geo.plan import Circle, Finding, Obstacle, Shape, polygons_in

PLACES: Final = (0.25, 0.5, 0.75)
"""Where along a door it is asked what lies across, as shares of its width."""

BESIDE_MM: Final = 100.0
"""And how far beyond its ends, for the jambs of an opening."""

COPY_MM: Final = 10.0
"""Doors whose ends are no farther apart are one, drawn twice."""

OPEN_RAD: Final = tuple(math.radians(turn_deg) for turn_deg in (45, 90, 135, -45, -90, -135))
"""By how much doors are turned whose leaf stands open, away from the wall."""

GeometryT = TypeVar("GeometryT", bound=BaseGeometry)

Depth: TypeAlias = tuple[float, float]
"""From where to where a wall reaches across a door's line, to the right below 0."""


@dataclass(frozen=True, slots=True)
class Span:
    """Where a door is when it is shut: from its hinge to its tip."""

    start: Point
    end: Point

    @property
    def width_mm(self) -> float:
        """How wide the door is."""
        return math.dist(self.start, self.end)

    @property
    def is_door_wide(self) -> bool:
        """Whether a door of one leaf or two is as wide; masks of tags and of much else are not."""
        return LEAST_LEAF_MM <= self.width_mm <= 2 * LEAF_MM

    @property
    def line(self) -> LineString:
        """From start to end."""
        return LineString((self.start, self.end))

    def at(self, along_mm: float, left_mm: float) -> Point:
        """The point so far from the start along the door and to the left of it."""
        width_mm = self.width_mm
        (x, y), (end_x, end_y) = self.start, self.end
        way_x, way_y = (end_x - x) / width_mm, (end_y - y) / width_mm
        return x + along_mm * way_x - left_mm * way_y, y + along_mm * way_y + left_mm * way_x

    def is_copy(self, other: "Span") -> bool:
        """Whether another door is drawn at the same place, be it from the other end."""
        ends = (other.start, other.end), (other.end, other.start)
        return any(
            max(math.dist(self.start, start), math.dist(self.end, end)) <= COPY_MM
            for start, end in ends
        )

    def meets(self, other: "Span") -> bool:
        """Whether the tips of two leaves of one door meet."""
        apart_mm = math.dist(self.start, other.start)
        is_straight = apart_mm >= self.width_mm + other.width_mm - LEAF_SLACK_MM
        return is_straight and math.dist(self.end, other.end) <= LEAF_SLACK_MM

    def turned(self) -> "Span":
        """The same door on the other side of its hinge."""
        return Span(self.start, self.at(-self.width_mm, 0.0))

    def swung(self, turn_rad: float) -> "Span":
        """The same door turned about its hinge."""
        cos, sin = math.cos(turn_rad), math.sin(turn_rad)
        return Span(self.start, self.at(self.width_mm * cos, self.width_mm * sin))

    def across(self, along_mm: float) -> LineString:
        """A line across the door that is longer, to either side, than any wall is thick."""
        return LineString((self.at(along_mm, -WALL_MM), self.at(along_mm, WALL_MM)))

    def opening(self, depth: Depth) -> Polygon:
        """What the door opens in a wall of this depth."""
        right, left = depth[0] - CLOSE_GAPS_MM, depth[1] + CLOSE_GAPS_MM
        return Polygon(
            [
                self.at(0.0, right),
                self.at(self.width_mm, right),
                self.at(self.width_mm, left),
                self.at(0.0, left),
            ]
        )


@dataclass(frozen=True, slots=True)
class Crossing:
    """What walls do where a door is shut.

    Attributes:
        depths: Of the wall at each of `PLACES`, where there is one.
        has_jambs: Whether there are walls beyond both ends.
    """

    span: Span
    depths: tuple[Depth, ...]
    has_jambs: bool

    @property
    def is_free(self) -> bool:
        """Whether the door stands in an opening that is drawn as one."""
        return self.has_jambs and not self.depths

    @property
    def depth(self) -> Depth | None:
        """The depth of the one wall that the door lies over, or None."""
        if len(self.depths) < len(PLACES):
            return None
        right, left = zip(*self.depths, strict=True)
        is_even = max(max(right) - min(right), max(left) - min(left)) <= ABREAST_MM
        # a wall that runs along the lines across reaches as far as these
        is_wall = max(left) - min(right) <= WALL_MM
        return (min(right), max(left)) if is_even and is_wall else None


@dataclass(frozen=True, slots=True)
class Still:
    """Doors that neither swing nor have a mask.

    Attributes:
        outlines: Closed outlines; one from face to face of a wall is the opening itself.
        symbols: Rectangles around all that is drawn close together.
        leaves: The middle lines of what is as long and as thin as a leaf.
    """

    outlines: tuple[Polygon, ...] = ()
    symbols: tuple[Polygon, ...] = ()
    leaves: tuple[LineString, ...] = ()

    @classmethod
    def of(cls, drawn: Sequence[Feature]) -> "Still":
        """What features on door layers show, their swings aside."""
        paths = [path for feature in drawn for path in feature.paths]
        lines = [middle_line(path) for path in paths]
        if not lines:
            return cls()
        near = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=LEAF_SLACK_MM)
        together = defaultdict(list)
        for line, group in zip(lines, linked(near.T, len(lines)).tolist(), strict=True):
            together[group].append(line)
        closed = [line for path, line in zip(paths, lines, strict=True) if path.closed]
        return cls(
            _rectangles(closed),
            _rectangles([shapely.union_all(each) for each in together.values()]),
            tuple(leaf for leaf in map(_leaf, lines) if leaf is not None),
        )

    def apart_from(self, doors: Sequence[Swing]) -> "Still":
        """Those of them that are no part of a door that swings."""
        return Still(
            _alone(self.outlines, doors), _alone(self.symbols, doors), _alone(self.leaves, doors)
        )


def with_openings(
    walls: Standing,
    doors: Sequence[Swing],
    masks: Sequence[Polygon],
    still: Still,
    terms: Terms,
) -> Standing:
    """Walls with the openings that doors drawn over them show.

    Args:
        walls: As they are drawn.
        doors: With a swing.
        masks: Of doors; they count where no door swings.
        still: Doors without either.
        terms: The terms of the reading.
    """
    tree = shapely.STRtree([wall.region() for wall in walls.obstacles])
    openings: list[Polygon] = []
    opened: list[Span] = []
    closed: list[Span] = []
    for spans in (*map(shut, doors), *map(middles, _alone(masks, doors))):
        crossings = [_crossing(span, tree) for span in spans]
        over = _over(crossings)
        if any(_is_free(crossing, tree) for crossing in crossings):
            continue
        if len(over) == 1:
            ((span, depth),) = over
            openings.append(span.opening(depth))
            opened.append(span)
        elif any(crossing.depths for crossing in crossings):
            closed.append(spans[0])
    still = still.apart_from(doors)
    for outline in still.outlines:
        for span, depth in _over(_crossings(outline, tree)):
            if outline.buffer(ABREAST_MM).contains(span.opening(depth)):
                openings.append(span.opening(depth))
                opened.append(span)
    for symbol in still.symbols:
        crossings = _crossings(symbol, tree)
        is_shut = not any(_is_free(crossing, tree) for crossing in crossings)
        if is_shut and not any(map(symbol.intersects, openings)):
            closed.extend(span for span, _ in _over(crossings))
    ajar = [leaf for leaf in still.leaves if not any(map(leaf.intersects, openings))]
    closed.extend(_at_whole_walls(ajar, tree))
    findings = (
        *(_opened(span, terms) for span in _whole(_once(opened))),
        *(_left_closed(span, terms) for span in _once(closed)),
    )
    return Standing(_cut(walls.obstacles, openings), (*walls.findings, *findings))


def _once(spans: Sequence[Span]) -> list[Span]:
    """Doors without copies."""
    kept: list[Span] = []
    for span in spans:
        if not any(map(span.is_copy, kept)):
            kept.append(span)
    return kept


def _whole(leaves: Sequence[Span]) -> list[Span]:
    """Doors from hinge to hinge where two leaves meet."""
    doors: list[Span] = []
    for leaf in leaves:
        meeting = [i for i, door in enumerate(doors) if leaf.meets(door)]
        if meeting:
            doors[meeting[0]] = Span(doors[meeting[0]].start, leaf.start)
        else:
            doors.append(leaf)
    return doors


def shut(door: Swing) -> list[Span]:
    """Where a door may be when it is shut."""
    return [Span(door.hinge, tip) for tip in door.shut_at]


def over_whole_walls(doors: Sequence[Swing], walls: Sequence[BaseGeometry]) -> list[Span]:
    """Where doors are shut that lie over a wall without an opening, copies aside."""
    tree = shapely.STRtree(walls)
    found: list[Span] = []
    for door in doors:
        crossings = [_crossing(span, tree) for span in shut(door)]
        if not any(_is_free(crossing, tree) for crossing in crossings):
            found.extend(span for span, _ in _over(crossings)[:1])
    return _whole(_once(found))


def as_one(spans: Sequence[Span]) -> Iterator[Span]:
    """From hinge to hinge of two leaves whose tips meet."""
    tips = shapely.STRtree([Spot(span.end) for span in spans])
    near = tips.query(tips.geometries, predicate="dwithin", distance=LEAF_SLACK_MM)
    for i, k in near.T.tolist():
        if i < k and spans[i].meets(spans[k]):
            yield Span(spans[i].start, spans[k].start)


def _alone(places: Sequence[GeometryT], doors: Sequence[Swing]) -> tuple[GeometryT, ...]:
    """The places at which no door swings."""
    hinges = shapely.STRtree([Spot(door.hinge) for door in doors])
    return tuple(
        place
        for place in places
        if not hinges.query(place, predicate="dwithin", distance=LEAF_SLACK_MM).size
    )


def _rectangles(shapes: Sequence[BaseGeometry]) -> tuple[Polygon, ...]:
    """The rectangles around some shapes; none where a shape is straight."""
    around = [shape.minimum_rotated_rectangle for shape in shapes]
    return tuple(rectangle for rectangle in around if isinstance(rectangle, Polygon))


def _leaf(line: LineString) -> LineString | None:
    """The middle line of what is as long and as thin as a leaf."""
    around = line.minimum_rotated_rectangle
    if isinstance(around, Polygon):
        thickness, leaf = sorted(middles(around), key=lambda span: span.width_mm)
        is_thin = thickness.width_mm <= LEAF_SLACK_MM
    else:
        leaf, is_thin = Span(line.coords[0], line.coords[-1]), True
    return leaf.line if is_thin and LEAST_LEAF_MM <= leaf.width_mm <= LEAF_MM else None


def _at_whole_walls(leaves: Sequence[LineString], tree: shapely.STRtree) -> list[Span]:
    """Where doors lie over a wall when they are shut that stand open at it, and none is free."""
    found: list[Span] = []
    for leaf in leaves:
        for hinge, tip in (leaf.coords, leaf.coords[::-1]):
            if not _is_at(hinge, tree) or _is_at(tip, tree):
                continue
            crossings = [_crossing(Span(hinge, tip).swung(turn), tree) for turn in OPEN_RAD]
            over = [c.span for c in crossings if c.has_jambs and c.depth is not None]
            # the two sides of a leaf are one door
            is_new = all(math.dist(hinge, span.start) > LEAF_SLACK_MM for span in found)
            if is_new and not any(crossing.is_free for crossing in crossings):
                found.extend(over[:1])
    return found


def _is_at(spot: Point, tree: shapely.STRtree) -> bool:
    return bool(tree.query(Spot(spot), predicate="dwithin", distance=LEAF_SLACK_MM).size)


def _over(crossings: Sequence[Crossing]) -> list[tuple[Span, Depth]]:
    """Where a door may be that lies over one wall, and how deep that is."""
    return [
        (crossing.span, depth)
        for crossing in crossings
        if crossing.span.is_door_wide and (depth := crossing.depth) is not None
    ]


def _crossings(rectangle: Polygon, tree: shapely.STRtree) -> list[Crossing]:
    """What walls do where a door is drawn that does not swing."""
    return [_crossing(span, tree) for span in middles(rectangle)]


def middles(mask: Polygon) -> list[Span]:
    """The two middle lines of a rectangle around a mask."""
    corners = shapely.get_coordinates(mask.minimum_rotated_rectangle)
    halfway = [(float(x), float(y)) for x, y in (corners[:-1] + corners[1:]) / 2]
    return [Span(halfway[0], halfway[2]), Span(halfway[1], halfway[3])]


def _is_free(crossing: Crossing, tree: shapely.STRtree) -> bool:
    """Whether a door's opening is drawn, be it with the door's symbol turned about the hinge."""
    return crossing.is_free or _crossing(crossing.span.turned(), tree).is_free


def _crossing(span: Span, tree: shapely.STRtree) -> Crossing:
    walls = walls_at(span, tree)
    depths = [depth_at(span, share * span.width_mm, walls) for share in PLACES]
    beyond = [depth_at(span, at_mm, walls) for at_mm in (-BESIDE_MM, span.width_mm + BESIDE_MM)]
    return Crossing(span, tuple(d for d in depths if d is not None), None not in beyond)


def walls_at(span: Span, tree: shapely.STRtree) -> BaseGeometry:
    """The walls around a door and its jambs."""
    near = tree.query(
        LineString((span.at(-BESIDE_MM, 0), span.at(span.width_mm + BESIDE_MM, 0))),
        predicate="dwithin",
        distance=WALL_MM,
    )
    return shapely.union_all(tree.geometries[near])


def depth_at(span: Span, along_mm: float, walls: BaseGeometry) -> Depth | None:
    """How deep the wall is that the door lies over at one place."""
    middle = Spot(span.at(along_mm, 0.0))
    across = span.across(along_mm)
    hits = [
        part
        for part in shapely.get_parts(across.intersection(walls))
        if part.distance(middle) <= LEAF_SLACK_MM
    ]
    reach_mm = [
        across.project(Spot(corner)) - WALL_MM
        for hit in hits
        for corner in shapely.get_coordinates(hit)
    ]
    return (min(reach_mm), max(reach_mm)) if reach_mm else None


def _cut(walls: Sequence[Obstacle], openings: Sequence[Polygon]) -> tuple[Obstacle, ...]:
    if not openings:
        return tuple(walls)
    free = shapely.union_all(openings)
    shapely.prepare(free)
    kept: list[Obstacle] = []
    for wall in walls:
        if isinstance(wall.shape, Circle) or not free.intersects(wall.shape):
            kept.append(wall)
        else:
            kept.extend(replace(wall, shape=part) for part in _beside(wall.shape, free))
    return tuple(kept)


def _beside(shape: LineString | Polygon, free: BaseGeometry) -> list[Shape]:
    """The parts of a wall beside openings."""
    rest = shape.difference(free)
    if isinstance(shape, Polygon):
        return list(rounded(polygons_in([rest])))
    return [part for part in shapely.get_parts(rest) if part.length]


def _opened(span: Span, terms: Terms) -> Finding:
    x_mm, y_mm = terms.place(span.start)
    return Finding(
        "door-over-wall",
        f"a door at ({x_mm:.1f}, {y_mm:.1f}) mm lies over a wall that goes on under it: the wall "
        f"is taken as open there, {span.width_mm:.0f} mm wide",
        "break the wall in the drawing, or draw what is no door on another layer",
        at_mm=(x_mm, y_mm),
    )


def _left_closed(span: Span, terms: Terms) -> Finding:
    x_mm, y_mm = terms.place(span.start)
    return Finding(
        "door-in-wall",
        f"a door at ({x_mm:.1f}, {y_mm:.1f}) mm lies over walls, and where they are open is not "
        "clear: they stay closed",
        "break the wall in the drawing",
        at_mm=(x_mm, y_mm),
    )
