"""Columns and pieces of walls drawn by nothing but a solid fill on a layer of hatches.

Such a layer is left out: most of what is on it fills what other layers outline, or is a pattern.
What no other layer outlines is told by its look.
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Final

import shapely
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.features import Feature
from satAOI_adapters.dxf_read.linework import WALL_MM
from satAOI_adapters.dxf_read.meaning import Seen, is_ignored_fill
from satAOI_adapters.dxf_read.obstacles import Standing, area_of
from satAOI_adapters.dxf_read.plans import Drawn, rough_lines
from satAOI_adapters.dxf_read.shapes import TIE_MM, is_thin
from satAOI_adapters.dxf_read.survey import drawn_by
from satAOI_adapters.dxf_read.terms import Terms
from satAOI_adapters.layers import KINDS, Meaning
from satAOI_geo.plan import Finding, Frame, Kind, Obstacle, Shape

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


def solid_fills(seen: Sequence[Seen], frame: Frame) -> list[Feature]:
    """The solid fills on layers of hatches that are left out, in millimetres of a frame."""
    wanted = [
        entity
        for entity in seen
        if is_ignored_fill(entity) and entity.verdict.pattern in HATCHES and _is_plain(entity)
    ]
    return [feature for _, features in drawn_by(wanted, frame) for feature in features]


def fills_alone(
    fills: Sequence[Feature], drawn: Drawn, known: Sequence[Obstacle], terms: Terms
) -> Standing:
    """The fills that are columns or pieces of walls.

    A rectangle or a circle as large as a column is one wherever it stands; what has another shape,
    or is long and as narrow as a wall, is one if it stands at a wall or a column. Larger fills are
    floors or fields of colour.

    Args:
        fills: Solid fills on layers of hatches.
        drawn: What else is drawn of the plan that is read.
        known: What is known to stand there.
        terms: The terms of the reading.
    """
    if not fills or not known:
        return Standing(())
    around = Around(drawn, known, terms.gap_mm)
    found = [
        Obstacle(shape, kind, fill.placed.layer, fill.placed.handle)
        for fill in fills
        for shape in area_of(fill)
        if (kind := around.kind_of(shape))
    ]
    return Standing(tuple(found), tuple(_said(found, terms)))


def _is_plain(entity: Seen) -> bool:
    """Whether an entity fills, rather than drawing a pattern of lines."""
    return entity.placed.kind != "HATCH" or bool(entity.placed.entity.dxf.solid_fill)


class Around:
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
        self._gap_mm = gap_mm

    def kind_of(self, shape: Shape) -> Kind | None:
        """What a fill is: a column, a piece of wall, or None where it adds nothing."""
        region = Obstacle(shape, Kind.COLUMN).region()
        is_new = region.difference(self._solid).area > UNCOVERED * region.area
        if not is_new or not self._plan.intersects(region):
            return None
        is_at_wall = bool(
            self._walls.query(region, predicate="dwithin", distance=self._gap_mm).size
        )
        if _is_as_large_as_column(region) and (is_at_wall or _is_regular(region)):
            return Kind.COLUMN
        return Kind.WALL if is_at_wall and _is_as_thick_as_wall(region) else None


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


def _said(found: Sequence[Obstacle], terms: Terms) -> Iterator[Finding]:
    by_layer: defaultdict[str, list[Obstacle]] = defaultdict(list)
    for obstacle in found:
        by_layer[obstacle.layer].append(obstacle)
    for layer, own in by_layer.items():
        largest = max(own, key=lambda obstacle: obstacle.region().area)
        spot = largest.region().representative_point()
        ((x_mm, y_mm),) = terms.frame.to_drawing_mm([(spot.x, spot.y)])
        area_m2 = sum(obstacle.region().area for obstacle in own) / 1e6
        yield Finding(
            "fills-alone",
            f"{len(own)} solid fills on layer '{layer}', {area_m2:.2f} m² together, that no other "
            "layer outlines look like columns or pieces of walls and are taken as such, the "
            f"largest at ({x_mm:.1f}, {y_mm:.1f}) mm",
            "have the layer ignored in a file for --layers if they do not stop the robot",
            layer=layer,
            handle=largest.handle,
            at_mm=(float(x_mm), float(y_mm)),
        )
