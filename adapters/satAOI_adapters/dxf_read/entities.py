"""What each type of entity draws, as paths in millimetres of the plan's frame.

One function a type, listed in `DRAWN`.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Final, NamedTuple, TypeAlias, TypeVar

from ezdxf.entities import (
    Arc as ArcEntity,
)
from ezdxf.entities import (
    Circle,
    DXFGraphic,
    Ellipse,
    Hatch,
    LWPolyline,
    MLine,
    MPolygon,
    Polyline,
    Solid,
    Wipeout,
)
from ezdxf.entities import (
    Line as LineEntity,
)
from ezdxf.entities import (
    Spline as SplineEntity,
)
from shapely.geometry import MultiPoint
from shapely.geometry.base import BaseGeometry

from satAOI_adapters.dxf_read.curves import Line, Piece, Point
from satAOI_adapters.dxf_read.expand import Placed
from satAOI_adapters.dxf_read.features import Feature, area, paths_of, straight
from satAOI_adapters.dxf_read.finite import not_finite
from satAOI_adapters.dxf_read.hatches import hatch_outline
from satAOI_adapters.dxf_read.placement import (
    Placement,
    bulged,
    placed_arc,
    placed_spline,
    rounded_spot,
    turn_between,
)
from satAOI_geo.errors import DrawingError

EntityT = TypeVar("EntityT", bound=DXFGraphic)

SPLINE_FRAME: Final = 16
"""Flag of a vertex that only controls a fitted curve and is not on it."""


def features_of(placed: Placed, mm_per_unit: float, origin_mm: Point) -> list[Feature]:
    """What one entity draws; empty for one that draws no line.

    Args:
        placed: The entity.
        mm_per_unit: Millimetres in one drawing unit.
        origin_mm: Origin of the plan's frame in the drawing's axes.

    Raises:
        DrawingError: If a coordinate is not a number, or the entity contradicts itself.
    """
    draw = DRAWN.get(placed.kind)
    if draw is None:
        return []
    placement = Placement.of(placed, mm_per_unit, origin_mm)
    try:
        return [feature for feature in draw(placed, placement) if feature.paths]
    except (ValueError, ArithmeticError, IndexError, AttributeError) as error:
        raise DrawingError(
            f"{placed.label()} cannot be read: {not_finite(placed.entity) or error}; correct it in "
            "the drawing or delete it",
            layer=placed.layer,
            handle=placed.handle,
        ) from error


def mask_of(placed: Placed, mm_per_unit: float, origin_mm: Point) -> BaseGeometry:
    """The hull of what a mask (WIPEOUT) hides; arguments as for `features_of`."""
    placement = Placement.of(placed, mm_per_unit, origin_mm)
    return MultiPoint(placement.points(_as(placed, Wipeout).boundary_path_wcs())).convex_hull


def _line(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, LineEntity)
    start, end = placement.points((entity.dxf.start, entity.dxf.end))
    yield Feature(placed, paths_of((Line(start, end),)))


def _arc(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, ArcEntity)
    start_rad = math.radians(entity.dxf.start_angle)
    sweep_rad = turn_between(entity.dxf.start_angle, entity.dxf.end_angle)
    yield Feature(placed, paths_of((_round(entity, placement, start_rad, sweep_rad),)))


def _circle(placed: Placed, placement: Placement) -> Iterator[Feature]:
    yield Feature(placed, paths_of((_round(_as(placed, Circle), placement, 0.0, math.tau),)))


def _round(entity: Circle, placement: Placement, start_rad: float, sweep_rad: float) -> Piece:
    own = placement.in_axes_of(entity)
    centre, radius = entity.dxf.center, abs(entity.dxf.radius)
    radii = (own.vector(radius, 0), own.vector(0, radius))
    return placed_arc(own.point(*centre), radii, start_rad, sweep_rad)


def _ellipse(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, Ellipse)
    start_rad, end_rad = entity.dxf.start_param, entity.dxf.end_param
    sweep_rad = (end_rad - start_rad) % math.tau or math.tau
    radii = (placement.vector(*entity.dxf.major_axis), placement.vector(*entity.minor_axis))
    # writers round 2π down or up
    if math.isclose(sweep_rad, math.tau, rel_tol=1e-9) or sweep_rad < 1e-9:
        sweep_rad = math.tau
    arc = placed_arc(placement.point(*entity.dxf.center), radii, start_rad, sweep_rad)
    yield Feature(placed, paths_of((arc,)))


def _spline(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, SplineEntity)
    yield Feature(placed, paths_of((placed_spline(entity.construction_tool(), placement),)))


def _lwpolyline(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, LWPolyline)
    elevation = entity.dxf.elevation
    width = entity.dxf.const_width if entity.dxf.hasattr("const_width") else None
    corners = [
        Corner(x, y, bulge, *((width, width) if width is not None else (first, last)))
        for x, y, first, last, bulge in entity
    ]
    own = placement.in_axes_of(entity)
    yield from _polyline_features(placed, own, corners, elevation, is_closed=entity.closed)


def _polyline(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, Polyline)
    if entity.is_2d_polyline:
        corners = [
            Corner(
                vertex.dxf.location.x,
                vertex.dxf.location.y,
                vertex.dxf.bulge,
                vertex.dxf.get("start_width", entity.dxf.default_start_width),
                vertex.dxf.get("end_width", entity.dxf.default_end_width),
            )
            for vertex in entity.vertices
            if not vertex.dxf.flags & SPLINE_FRAME
        ]
        own, elevation = placement.in_axes_of(entity), entity.dxf.elevation.z
        yield from _polyline_features(placed, own, corners, elevation, is_closed=entity.is_closed)
    elif entity.is_3d_polyline:
        points = [v.dxf.location for v in entity.vertices if not v.dxf.flags & SPLINE_FRAME]
        yield Feature(placed, straight(placement.points(points), is_closed=entity.is_closed))
    else:
        for face in entity.virtual_entities():
            yield from _face(
                Placed(face, placed.matrix, placed.layer, (), placed.handle), placement
            )


def _hatch(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = placed.entity
    if not isinstance(entity, Hatch | MPolygon):
        raise TypeError(placed.kind)
    own, elevation = placement.in_axes_of(entity), entity.dxf.elevation.z
    paths = [path for outline in entity.paths for path in hatch_outline(outline, own, elevation)]
    yield Feature(placed, tuple(paths), is_area=True)


def _solid(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, Solid)
    own = placement.in_axes_of(entity)
    yield area(placed, own.points(entity.vertices()))


def _face(placed: Placed, placement: Placement) -> Iterator[Feature]:
    corners = [placed.entity.dxf.get(name) for name in ("vtx0", "vtx1", "vtx2", "vtx3")]
    yield area(placed, placement.points([corner for corner in corners if corner is not None]))


def _mline(placed: Placed, placement: Placement) -> Iterator[Feature]:
    """The body between the outermost lines, which carry the walls of a multiline."""
    entity = _as(placed, MLine)
    sides = [
        (
            vertex.location + vertex.miter_direction * min(offsets),
            vertex.location + vertex.miter_direction * max(offsets),
        )
        for vertex in entity.vertices
        if (offsets := [params[0] for params in vertex.line_params if params])
    ]
    if entity.is_closed and len(sides) > 2:
        sides.append(sides[0])
    for (right, left), (next_right, next_left) in pairwise(sides):
        yield area(placed, placement.points((right, next_right, next_left, left)))


class Corner(NamedTuple):
    """A vertex of a polyline in its own axes, with what belongs to the piece after it."""

    x: float
    y: float
    bulge: float
    start_width: float
    end_width: float


def _polyline_features(
    placed: Placed,
    own: Placement,
    corners: Sequence[Corner],
    elevation: float,
    *,
    is_closed: bool,
) -> Iterator[Feature]:
    """A polyline as a line, as a band of one width, or piece by piece where its width varies."""
    points = own.points([(corner.x, corner.y, elevation) for corner in corners])
    pieces = bulged(own, points, [corner.bulge for corner in corners], is_closed=is_closed)
    widths = {width for c in corners[: len(pieces)] for width in (c.start_width, c.end_width)}
    if widths <= {0.0}:
        yield Feature(placed, paths_of(pieces, is_closed=is_closed))
    elif len(widths) == 1:
        width_mm = widths.pop() * own.scale
        yield Feature(placed, paths_of(pieces, is_closed=is_closed), width_mm=width_mm)
    else:
        for corner, piece in zip(corners, pieces, strict=False):
            yield _tapered(
                placed, piece, corner.start_width * own.scale, corner.end_width * own.scale
            )


def _tapered(placed: Placed, piece: Piece, start_mm: float, end_mm: float) -> Feature:
    """A piece of a polyline whose width varies; a curved one at its greatest width."""
    length_mm = math.dist(piece.start, piece.end)
    if not isinstance(piece, Line) or not length_mm:
        return Feature(placed, paths_of((piece,)), width_mm=max(start_mm, end_mm))
    (x0, y0), (x1, y1) = piece.start, piece.end
    across_x, across_y = (y0 - y1) / length_mm / 2, (x1 - x0) / length_mm / 2
    return area(
        placed,
        [
            rounded_spot(x0 - across_x * start_mm, y0 - across_y * start_mm),
            rounded_spot(x1 - across_x * end_mm, y1 - across_y * end_mm),
            rounded_spot(x1 + across_x * end_mm, y1 + across_y * end_mm),
            rounded_spot(x0 + across_x * start_mm, y0 + across_y * start_mm),
        ],
    )


def _as(placed: Placed, kind: type[EntityT]) -> EntityT:
    """The entity as the type that its DXF name promises."""
    if not isinstance(placed.entity, kind):
        raise TypeError(placed.kind)
    return placed.entity


Draw: TypeAlias = Callable[[Placed, Placement], Iterator[Feature]]

DRAWN: Final[dict[str, Draw]] = {
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _circle,
    "ELLIPSE": _ellipse,
    "SPLINE": _spline,
    "LWPOLYLINE": _lwpolyline,
    "POLYLINE": _polyline,
    "HATCH": _hatch,
    "MPOLYGON": _hatch,
    "SOLID": _solid,
    "TRACE": _solid,
    "3DFACE": _face,
    "MLINE": _mline,
}
"""The types of entity that are read, each with the function that reads it."""

NO_LINEWORK: Final = frozenset(
    {
        "TEXT", "MTEXT", "ATTRIB", "ATTDEF", "ARCALIGNEDTEXT", "RTEXT", "SHAPE", "ACAD_TABLE",
        "DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION", "LEADER", "MULTILEADER", "MLEADER",
        "TOLERANCE", "POINT", "XLINE", "RAY", "WIPEOUT", "IMAGE", "PDFUNDERLAY", "DWFUNDERLAY",
        "DGNUNDERLAY", "OLEFRAME", "OLE2FRAME", "VIEWPORT", "LIGHT", "SUN", "SEQEND", "SECTION",
        "GEOPOSITIONMARKER",
    }
)  # fmt: skip
"""Types of entity that explain a drawing and show nothing that stands on the floor."""
