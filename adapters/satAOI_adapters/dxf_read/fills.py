"""Columns and pieces of walls drawn by nothing but a solid fill on a layer of hatches.

Such a layer is left out: most of what is on it fills what other layers outline, or is a pattern, a
mark or a colour. A fill that nothing else outlines is believed to stand where walls need it, as
they end at it or leave no more than its width between them, or where equal ones stand in a row or
a grid. Doorways are filled, too, so that in a wider opening, or at a door, no fill is believed.

    ═══▓═══    walls broken at a column       ▓   ▓   ▓    equal ones
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString
from shapely.geometry import Point as Spot
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.marks import places_of_texts
from satAOI_adapters.dxf_read.meaning import Seen, is_ignored_fill
from satAOI_adapters.dxf_read.obstacles import Standing, area_of
from satAOI_adapters.dxf_read.openings import shut
from satAOI_adapters.dxf_read.plans import Drawn, rough_lines
from satAOI_adapters.dxf_read.shapes import TIE_MM, GeometryArray, is_thin, middle_line
from satAOI_adapters.dxf_read.survey import Survey, drawn_by
from satAOI_adapters.dxf_read.swings import LEAF_SLACK_MM, swings
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.meanings import KINDS, Meaning
from satAOI_adapters.wording import are, counted
from satAOI_geo.plan import Finding, Frame, Kind, Obstacle

HATCHES: Final = frozenset(
    {
        *("HATCH", "HATCHES", "HATC", "PATT", "PATTERN", "HACHURE", "HACHURES", "TRAMA", "TRAMAS"),
        *("SCHRAFFUR", "SCHRAFFUREN", "RETINO", "RETINI", "ARCERING", "ШТРИХОВКА", "ЗАЛИВКА"),
        *("KRESKOWANIE", "SOMBREADO", "SOMBREADOS", "HACHURA", "HACHURAS"),
        *("*填充*", "*ハッチング*", "*해치*"),
    }
)
"""Those patterns of names to be left out that are names of hatches."""

COLUMN_MM: Final = (150.0, 1500.0)
"""The least width and the greatest length of a column."""

LEAST_WALL_MM: Final = 75.0
"""Thinner fills at walls are linings."""

NEARLY: Final = 0.95
"""A fill that covers this share of the rectangle, or of the circle, around it is one."""

UNCOVERED: Final = 0.05
"""A fill of which no more than this share lies beside other solids adds nothing to them."""

DOORWAY_MM: Final = 500.0
"""Openings between walls that are wider may be doorways."""

LOOSE_ENDS: Final = 2
"""Lines of walls that end at a fill and nowhere else, as the two faces of one wall do."""

EQUAL_MM: Final = 5.0
"""Columns of one size differ by no more."""

FEWEST_EQUAL: Final = 3
"""Fewer equal fills are no row."""

ALONG_MM: Final = 25.0
"""A line this close to the edge of a fill outlines it, be it drawn around it or within."""

OUTLINED: Final = 0.7
"""Share of its edge along which a fill has lines that outline it; some stand with a side at a
wall."""

SLACK_MM: Final = 20.0
"""A door's line as close to the edge of a fill only touches it."""


@dataclass(frozen=True, slots=True, eq=False)
class _Fill:
    """A fill that may stand: what it would be, and what it covers."""

    obstacle: Obstacle
    region: BaseGeometry

    @property
    def size_mm(self) -> tuple[float, float]:
        """The shorter and the longer side of the rectangle around it."""
        corner, one, other = self.region.minimum_rotated_rectangle.exterior.coords[:3]
        short_mm, long_mm = sorted((math.dist(corner, one), math.dist(one, other)))
        return short_mm, long_mm

    @property
    def is_circle(self) -> bool:
        """Whether it is a circle and no rectangle."""
        rectangle = self.region.minimum_rotated_rectangle
        return _is_regular(self.region) and bool(self.region.area < NEARLY * rectangle.area)

    def is_equal_to(self, other: "_Fill") -> bool:
        """Whether the other one is of the same shape and size."""
        off_mm = np.abs(np.subtract(self.size_mm, other.size_mm))
        return self.is_circle == other.is_circle and bool((off_mm <= EQUAL_MM).all())


def fills_alone(drawing: Survey, drawn: Drawn, known: Sequence[Obstacle], terms: Terms) -> Standing:
    """The fills that are columns or pieces of walls, and what is said of those that may be.

    Args:
        drawing: That is read.
        drawn: What is drawn of the plan that is read.
        known: What is known to stand there.
        terms: The terms of the reading.
    """
    fills = _solid_fills(drawing.seen, terms.frame)
    if not fills or not known:
        return Standing(())
    around = _Around(drawn, known, terms.gap_mm)
    looks = [fill for feature in fills for fill in around.standing(feature)]
    if not looks:
        return Standing(())
    unclear = _not_outlined(_at_no_door(looks, drawn), drawing, terms)
    unclear = _under_no_text(unclear, drawing, terms)
    coloured = _layers_of_rooms(fills)
    likely = [fill for fill in unclear if fill.obstacle.layer not in coloured]
    likely = [fill for fill in likely if not around.is_in_doorway(fill)]
    found = [fill for fill in likely if around.is_needed(fill) or _has_equals(fill, likely)]
    left_out = [fill for fill in unclear if fill not in found]
    return Standing(
        tuple(fill.obstacle for fill in found), (*_taken(found, terms), *_left_out(left_out, terms))
    )


def _solid_fills(seen: Sequence[Seen], frame: Frame) -> list[Feature]:
    """The solid fills on layers of hatches that are left out, in millimetres of a frame."""
    wanted = [entity for entity in seen if _is_on_hatches(entity) and _is_plain(entity)]
    return [feature for _, features in drawn_by(wanted, frame) for feature in features]


def _is_on_hatches(entity: Seen) -> bool:
    return is_ignored_fill(entity) and entity.verdict.pattern in HATCHES


def _is_plain(entity: Seen) -> bool:
    """Whether an entity fills, rather than drawing a pattern of lines."""
    return entity.placed.kind != "HATCH" or bool(entity.placed.entity.dxf.solid_fill)


class _Around:
    """What is known to stand around fills."""

    def __init__(self, drawn: Drawn, known: Sequence[Obstacle], gap_mm: float) -> None:
        """Take what is drawn of the plan, what of it stands there, and how near is at it."""
        regions = [obstacle.region() for obstacle in known]
        solid = [
            r for o, r in zip(known, regions, strict=True) if not isinstance(o.shape, LineString)
        ]
        self._solid = shapely.union_all(solid)
        lines = [line for m in (*KINDS, Meaning.FLOOR) for line in rough_lines(drawn[m])]
        self._plan = shapely.convex_hull(shapely.geometrycollections(lines))
        self._walls = shapely.STRtree(
            [r for o, r in zip(known, regions, strict=True) if o.kind in {Kind.WALL, Kind.COLUMN}]
        )
        self._loose_ends = shapely.STRtree(_loose_ends(drawn[Meaning.WALL], gap_mm))
        self._gap_mm = gap_mm

    def standing(self, feature: Feature) -> Iterator[_Fill]:
        """What a fill is by its look and where it lies; nothing where it adds nothing."""
        placed = feature.placed
        for shape in area_of(feature):
            region = Obstacle(shape, Kind.COLUMN).region()
            kind = self._kind_of(region)
            if kind is not None:
                yield _Fill(Obstacle(shape, kind, placed.layer, placed.handle), region)

    def is_in_doorway(self, fill: _Fill) -> bool:
        """Whether a fill lies in an opening that people may go through."""
        return any(width_mm > DOORWAY_MM + TIE_MM for width_mm in self._between_walls_mm(fill))

    def is_needed(self, fill: _Fill) -> bool:
        """Whether lines of walls end at a fill, or it is all that parts two walls."""
        ends = self._loose_ends.query(fill.region, predicate="dwithin", distance=self._gap_mm)
        return ends.size >= LOOSE_ENDS or bool(self._between_walls_mm(fill))

    def _between_walls_mm(self, fill: _Fill) -> list[float]:
        """How far the walls are apart that a fill runs between, open on both sides of it."""
        if fill.is_circle:
            return []
        corners = fill.region.minimum_rotated_rectangle.exterior.coords[:4]
        ring = [LineString((corners[i], corners[(i + 1) % 4])) for i in range(4)]
        return [
            ring[1 - k].length
            for k in (0, 1)
            if self._is_at_wall(ring[k])
            and self._is_at_wall(ring[k + 2])
            and not self._is_at_wall(ring[1 - k].centroid)
            and not self._is_at_wall(ring[3 - k].centroid)
        ]

    def _kind_of(self, region: BaseGeometry) -> Kind | None:
        is_new = region.difference(self._solid).area > UNCOVERED * region.area
        if not is_new or not self._plan.intersects(region):
            return None
        is_at_wall = self._is_at_wall(region)
        if _is_as_large_as_column(region) and (is_at_wall or _is_regular(region)):
            return Kind.COLUMN
        return Kind.WALL if is_at_wall and _is_as_thick_as_wall(region) else None

    def _is_at_wall(self, place: BaseGeometry) -> bool:
        near = self._walls.query(place, predicate="dwithin", distance=self._gap_mm)
        return bool(near.size)


def _loose_ends(walls: Sequence[Feature], gap_mm: float) -> list[Spot]:
    """The ends of lines of walls at which no other line is; a line drawn twice is one."""
    lines = [middle_line(path) for wall in walls if not wall.is_area for path in wall.paths]
    once = list({line.normalize().wkb: line for line in lines}.values())
    ends = [
        Spot(end)
        for line in once
        if not line.is_closed
        for end in line.coords[:: len(line.coords) - 1]
    ]
    if not ends:
        return []
    of_end, _ = shapely.STRtree(once).query(ends, predicate="dwithin", distance=gap_mm)
    n_near = np.bincount(of_end, minlength=len(ends))
    # the line itself is one
    return [end for end, n in zip(ends, n_near.tolist(), strict=True) if n == 1]


def _not_outlined(fills: Sequence[_Fill], drawing: Survey, terms: Terms) -> list[_Fill]:
    """Fills without lines of another layer, whatever it is, along their edges."""
    others = [entity for entity in drawing.seen if not _is_on_hatches(entity)]
    features = [feature for _, drawn in drawn_by(others, terms.frame) for feature in drawn]
    layers = np.array([feature.placed.layer for feature in features], dtype=object)
    tree = shapely.STRtree(rough_lines(features))
    return [fill for fill in fills if not _is_outlined(fill, tree, layers)]


def _is_outlined(fill: _Fill, lines: shapely.STRtree, layers: GeometryArray) -> bool:
    edge = fill.region.boundary
    near = lines.query(edge, predicate="dwithin", distance=ALONG_MM)
    near = near[layers[near] != fill.obstacle.layer]
    along = shapely.union_all(shapely.buffer(lines.geometries[near], ALONG_MM))
    return bool(edge.intersection(along).length >= OUTLINED * edge.length)


def _under_no_text(fills: Sequence[_Fill], drawing: Survey, terms: Terms) -> list[_Fill]:
    texts = places_of_texts(drawing.expansion.placed, terms.frame)
    tree = shapely.STRtree([Spot(place) for place in texts])
    return [fill for fill in fills if not tree.query(fill.region, predicate="intersects").size]


def _at_no_door(fills: Sequence[_Fill], drawn: Drawn) -> list[_Fill]:
    """Fills that no door, as it is drawn or shut, runs across."""
    doors = swings([f for m in (Meaning.DOOR, *KINDS) for f in drawn[m]])
    of_doors = [*rough_lines(drawn[Meaning.DOOR]), *(s.line for d in doors for s in shut(d))]
    tree = shapely.STRtree(of_doors)

    def is_crossed(fill: _Fill) -> bool:
        inside = fill.region.buffer(-SLACK_MM)
        near = tree.geometries[tree.query(inside, predicate="intersects")]
        return bool((shapely.length(shapely.intersection(near, inside)) > LEAF_SLACK_MM).any())

    return [fill for fill in fills if not is_crossed(fill)]


def _layers_of_rooms(fills: Sequence[Feature]) -> frozenset[str]:
    """The layers whose fills colour whole rooms: smaller ones colour something, too."""
    _, column_mm = COLUMN_MM
    return frozenset(
        fill.placed.layer
        for fill in fills
        for shape in area_of(fill)
        if _is_at_least(Obstacle(shape, Kind.COLUMN).region(), column_mm + 4 * TIE_MM)
    )


def _has_equals(fill: _Fill, others: Sequence[_Fill]) -> bool:
    """Whether a rectangle or a circle is one of several equal ones that stand apart."""
    if fill.obstacle.kind is not Kind.COLUMN or not _is_regular(fill.region):
        return False
    equal = [other.region for other in others if fill.is_equal_to(other)]
    return len(shapely.get_parts(shapely.union_all(equal))) >= FEWEST_EQUAL


def _is_as_large_as_column(region: BaseGeometry) -> bool:
    least_mm, most_mm = COLUMN_MM
    corner, one, other = region.minimum_rotated_rectangle.exterior.coords[:3]
    length_mm = max(math.dist(corner, one), math.dist(one, other))
    return length_mm <= most_mm + TIE_MM and _is_at_least(region, least_mm)


def _is_as_thick_as_wall(region: BaseGeometry) -> bool:
    return is_thin(region, WALL_MM) and _is_at_least(region, LEAST_WALL_MM)


def _is_at_least(region: BaseGeometry, width_mm: float) -> bool:
    """Whether a disc of this diameter fits into a region, touching its rim."""
    return not is_thin(region, width_mm - 2 * TIE_MM)


def _is_regular(region: BaseGeometry) -> bool:
    """Whether a region is a rectangle or a circle, as most columns are and few signs."""
    rectangle, circle = region.minimum_rotated_rectangle, shapely.minimum_bounding_circle(region)
    return bool(region.area >= NEARLY * min(rectangle.area, circle.area))


def _taken(found: Sequence[_Fill], terms: Terms) -> Iterator[Finding]:
    for layer, own in _by_layer(found).items():
        largest, (x_mm, y_mm) = _largest(own, terms)
        area_m2 = sum(fill.region.area for fill in own) / 1e6
        yield Finding(
            "fills-alone",
            f"{counted(len(own), 'solid fill')} on layer '{layer}', {area_m2:.2f} m² together, "
            f"that nothing else outlines {are(len(own))} taken for columns or pieces of walls, "
            "since lines of walls end there, or equal ones stand; the largest at "
            f"({x_mm:.1f}, {y_mm:.1f}) mm",
            "have the layer ignored in a file for --layers if they do not stop the robot",
            layer=layer,
            handle=largest.handle,
            at_mm=(x_mm, y_mm),
        )


def _left_out(fills: Sequence[_Fill], terms: Terms) -> Iterator[Finding]:
    for layer, own in _by_layer(fills).items():
        largest, (x_mm, y_mm) = _largest(own, terms)
        yield Finding(
            "fills-left-out",
            f"{counted(len(own), 'solid fill')} on layer '{layer}' that may be columns or pieces "
            f"of walls {are(len(own))} left out, as nothing tells so; the largest at ({x_mm:.1f}, "
            f"{y_mm:.1f}) mm",
            "draw those that stop the robot on a layer COLUMN",
            layer=layer,
            handle=largest.handle,
            at_mm=(x_mm, y_mm),
        )


def _by_layer(fills: Sequence[_Fill]) -> dict[str, list[_Fill]]:
    by_layer: defaultdict[str, list[_Fill]] = defaultdict(list)
    for fill in fills:
        by_layer[fill.obstacle.layer].append(fill)
    return dict(sorted(by_layer.items()))


def _largest(fills: Sequence[_Fill], terms: Terms) -> tuple[Obstacle, tuple[float, float]]:
    """The largest of some fills, and where it is in the drawing's axes."""
    largest = max(fills, key=lambda fill: fill.region.area)
    spot = largest.region.representative_point()
    return largest.obstacle, terms.place((spot.x, spot.y))
