"""What each type of entity draws, as paths in millimetres of the plan's frame.

One function a type, listed in `DRAWN`. Coordinates of an entity pass through `Placement` once:
its own axes (OCS), the blocks around it, the unit and the origin are one matrix.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Final, NamedTuple, TypeAlias, TypeVar

import numpy as np
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
)
from ezdxf.entities import (
    Line as LineEntity,
)
from ezdxf.entities import (
    Spline as SplineEntity,
)
from ezdxf.entities.boundary_paths import (
    AbstractBoundaryPath,
    AbstractEdge,
    ArcEdge,
    EdgePath,
    EllipseEdge,
    LineEdge,
    PolylinePath,
    SplineEdge,
)
from ezdxf.math import BSpline, Matrix44, Vec3, fit_points_to_cad_cv

from satAOI_adapters.dxf_read.curves import (
    Arc,
    Line,
    Path,
    Piece,
    Point,
    Spline,
    arc_about,
    arc_of_bulge,
    beziers_of,
)
from satAOI_adapters.dxf_read.expand import Placed
from satAOI_adapters.dxf_read.finite import not_finite
from satAOI_geo.errors import DrawingError

LOCAL_DIGITS: Final = 5
"""Decimals of a millimetre that are kept: doubles of georeferenced drawings carry 1e-6 mm noise."""

MAX_HATCH_GAP_MM: Final = 20.0
"""Edges of a hatch outline farther apart than this do not belong to one outline."""

EntityT = TypeVar("EntityT", bound=DXFGraphic)

SPLINE_FRAME: Final = 16
"""Flag of a vertex that only controls a fitted curve and is not on it."""


@dataclass(frozen=True, slots=True)
class Feature:
    """Something drawn.

    Attributes:
        placed: The entity it comes from.
        paths: Its lines; of an area, its outlines.
        is_area: Whether it is filled (even-odd) rather than drawn as lines.
        width_mm: Width of the lines; 0 for a line without width.
    """

    placed: Placed
    paths: tuple[Path, ...]
    is_area: bool = False
    width_mm: float = 0.0

    def box(self) -> tuple[float, float, float, float]:
        """Left, bottom, right, top of a box around its paths."""
        spots = [spot for path in self.paths for piece in path.pieces for spot in piece.spots()]
        x, y = zip(*spots, strict=True)
        return min(x), min(y), max(x), max(y)


@dataclass(frozen=True, slots=True)
class Placement:
    """The map from an entity's own axes to the plan's frame."""

    matrix: Matrix44

    @classmethod
    def of(cls, placed: Placed, mm_per_unit: float, origin_mm: Point) -> "Placement":
        """The map for an entity whose coordinates are in world or block axes."""
        return cls(placed.matrix * _to_local(mm_per_unit, origin_mm))

    def in_axes_of(self, entity: DXFGraphic) -> "Placement":
        """The map for coordinates in the entity's own axes (OCS)."""
        extrusion = entity.dxf.extrusion
        if extrusion == Vec3(0, 0, 1):
            return self
        ocs = entity.ocs()
        return Placement(Matrix44.ucs(ocs.ux, ocs.uy, ocs.uz) * self.matrix)

    def points(self, points: Iterable[Sequence[float]]) -> list[Point]:
        """Where points are; rounded, so that noise of far origins does not come along."""
        moved = self.matrix.transform_vertices([Vec3(point) for point in points])
        return [_rounded(point.x, point.y) for point in moved]

    def point(self, x: float, y: float, z: float = 0.0) -> Point:
        """Where one point is."""
        return self.points(((x, y, z),))[0]

    def vector(self, x: float, y: float, z: float = 0.0) -> Point:
        """Where a difference of points goes."""
        moved = self.matrix.transform_direction(Vec3(x, y, z))
        return moved.x, moved.y

    @property
    def scale(self) -> float:
        """The greatest stretch in the plane."""
        (a, b), (c, d) = self.vector(1, 0), self.vector(0, 1)
        return float(np.linalg.norm(((a, c), (b, d)), 2))


@lru_cache(maxsize=1)
def _to_local(mm_per_unit: float, origin_mm: Point) -> Matrix44:
    """The map from the drawing's axes to the plan's frame, one for all entities of a reading."""
    return Matrix44.scale(mm_per_unit) * Matrix44.translate(-origin_mm[0], -origin_mm[1], 0)


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


def _line(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, LineEntity)
    start, end = placement.points((entity.dxf.start, entity.dxf.end))
    yield Feature(placed, _paths((Line(start, end),)))


def _arc(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, ArcEntity)
    start_rad = math.radians(entity.dxf.start_angle)
    sweep_rad = _turn(entity.dxf.start_angle, entity.dxf.end_angle)
    yield Feature(placed, _paths((_round(entity, placement, start_rad, sweep_rad),)))


def _circle(placed: Placed, placement: Placement) -> Iterator[Feature]:
    yield Feature(placed, _paths((_round(_as(placed, Circle), placement, 0.0, math.tau),)))


def _round(entity: Circle, placement: Placement, start_rad: float, sweep_rad: float) -> Piece:
    own = placement.in_axes_of(entity)
    centre, radius = entity.dxf.center, abs(entity.dxf.radius)
    radii = (own.vector(radius, 0), own.vector(0, radius))
    return _arc_about(own.point(*centre), radii, start_rad, sweep_rad)


def _ellipse(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, Ellipse)
    start_rad, end_rad = entity.dxf.start_param, entity.dxf.end_param
    sweep_rad = (end_rad - start_rad) % math.tau or math.tau
    radii = (placement.vector(*entity.dxf.major_axis), placement.vector(*entity.minor_axis))
    # writers round 2π down or up
    if math.isclose(sweep_rad, math.tau, rel_tol=1e-9) or sweep_rad < 1e-9:
        sweep_rad = math.tau
    arc = _arc_about(placement.point(*entity.dxf.center), radii, start_rad, sweep_rad)
    yield Feature(placed, _paths((arc,)))


def _spline(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, SplineEntity)
    yield Feature(placed, _paths((_exact_spline(entity.construction_tool(), placement),)))


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
        yield Feature(placed, _straight(placement.points(points), is_closed=entity.is_closed))
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
    paths = [path for outline in entity.paths for path in _hatch_path(outline, own, elevation)]
    yield Feature(placed, tuple(paths), is_area=True)


def _solid(placed: Placed, placement: Placement) -> Iterator[Feature]:
    entity = _as(placed, Solid)
    own = placement.in_axes_of(entity)
    yield _area(placed, own.points(entity.vertices()))


def _face(placed: Placed, placement: Placement) -> Iterator[Feature]:
    corners = [placed.entity.dxf.get(name) for name in ("vtx0", "vtx1", "vtx2", "vtx3")]
    yield _area(placed, placement.points([corner for corner in corners if corner is not None]))


def _mline(placed: Placed, placement: Placement) -> Iterator[Feature]:
    """The body between the outermost lines, which carry the walls of a multiline."""
    entity = _as(placed, MLine)
    sides: list[tuple[Vec3, Vec3]] = []
    for vertex in entity.vertices:
        offsets = [params[0] for params in vertex.line_params if params]
        if offsets:
            sides.append(
                (
                    vertex.location + vertex.miter_direction * min(offsets),
                    vertex.location + vertex.miter_direction * max(offsets),
                )
            )
    if entity.is_closed and len(sides) > 2:
        sides.append(sides[0])
    for (right, left), (next_right, next_left) in pairwise(sides):
        yield _area(placed, placement.points((right, next_right, next_left, left)))


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
    pieces = _bulged(own, points, [corner.bulge for corner in corners], is_closed=is_closed)
    widths = {width for c in corners[: len(pieces)] for width in (c.start_width, c.end_width)}
    if widths <= {0.0}:
        yield Feature(placed, _paths(pieces, is_closed=is_closed))
    elif len(widths) == 1:
        width_mm = widths.pop() * own.scale
        yield Feature(placed, _paths(pieces, is_closed=is_closed), width_mm=width_mm)
    else:
        for corner, piece in zip(corners, pieces, strict=False):
            yield _tapered(
                placed, piece, corner.start_width * own.scale, corner.end_width * own.scale
            )


def _tapered(placed: Placed, piece: Piece, start_mm: float, end_mm: float) -> Feature:
    """A piece of a polyline whose width varies; a curved one at its greatest width."""
    length_mm = math.dist(piece.start, piece.end)
    if not isinstance(piece, Line) or not length_mm:
        return Feature(placed, _paths((piece,)), width_mm=max(start_mm, end_mm))
    (x0, y0), (x1, y1) = piece.start, piece.end
    across_x, across_y = (y0 - y1) / length_mm / 2, (x1 - x0) / length_mm / 2
    return _area(
        placed,
        [
            _rounded(x0 - across_x * start_mm, y0 - across_y * start_mm),
            _rounded(x1 - across_x * end_mm, y1 - across_y * end_mm),
            _rounded(x1 + across_x * end_mm, y1 + across_y * end_mm),
            _rounded(x0 + across_x * start_mm, y0 + across_y * start_mm),
        ],
    )


def _bulged(
    own: Placement, points: Sequence[Point], bulges: Sequence[float], *, is_closed: bool
) -> list[Piece]:
    """The pieces of a polyline; one for each corner, the last only if it is closed."""
    ends = [*points[1:], *points[:1]] if is_closed else points[1:]
    return [
        _bulge(own, start, end, bulge)
        for start, end, bulge in zip(points, ends, bulges, strict=False)
    ]


def _bulge(own: Placement, start: Point, end: Point, bulge: float) -> Piece:
    """A piece between two placed points that bulges in the polyline's own axes."""
    if not bulge or start == end:
        return Line(start, end)
    linear = np.array((own.vector(1, 0), own.vector(0, 1))).T
    if not np.linalg.det(linear):
        # a polyline seen from its edge
        return Line(start, end)
    chord = np.linalg.solve(linear, np.subtract(end, start))
    piece = arc_of_bulge((0.0, 0.0), (float(chord[0]), float(chord[1])), bulge)
    if not isinstance(piece, Arc):
        return Line(start, end)
    u, v = own.vector(*piece.u), own.vector(*piece.v)
    centre = (start[0] - u[0], start[1] - u[1])
    return Arc(start, end, centre, u, v, piece.sweep_rad)


def _hatch_path(
    outline: AbstractBoundaryPath, own: Placement, elevation: float
) -> tuple[Path, ...]:
    if isinstance(outline, PolylinePath):
        points = own.points([(x, y, elevation) for x, y, _ in outline.vertices])
        bulges = [bulge for _, _, bulge in outline.vertices]
        return _paths(_bulged(own, points, bulges, is_closed=True), is_closed=True)
    if isinstance(outline, EdgePath):
        pieces = [_edge(edge, own, elevation) for edge in outline.edges]
        return _paths(
            _joined([p for p in pieces if p.start != p.end or _is_loop(p)]), is_closed=True
        )
    return ()


def _edge(edge: AbstractEdge, own: Placement, elevation: float) -> Piece:
    """One edge of a hatch outline, travelled as it was written."""
    if isinstance(edge, LineEdge):
        return Line(*own.points([(*edge.start, elevation), (*edge.end, elevation)]))
    if isinstance(edge, ArcEdge):
        radii = (own.vector(edge.radius, 0), own.vector(0, edge.radius))
        start, end = math.radians(edge.start_angle), math.radians(edge.end_angle)
    elif isinstance(edge, EllipseEdge):
        x, y = edge.major_axis
        radii = (own.vector(x, y), own.vector(-y * edge.ratio, x * edge.ratio))
        start, end = edge.start_param, edge.end_param
    elif isinstance(edge, SplineEdge):
        return _exact_spline(_edge_spline(edge, elevation), own)
    else:
        raise TypeError("an outline edge of unknown type")
    sweep = _turn(math.degrees(start), math.degrees(end))
    first, turn = (start, sweep) if edge.ccw else (start + sweep, -sweep)
    return _arc_about(own.point(edge.center.x, edge.center.y, elevation), radii, first, turn)


def _edge_spline(edge: SplineEdge, elevation: float) -> BSpline:
    if not edge.control_points:
        tangents = None
        if edge.start_tangent is not None and edge.end_tangent is not None:
            tangents = [Vec3(edge.start_tangent), Vec3(edge.end_tangent)]
        return fit_points_to_cad_cv([Vec3(x, y, elevation) for x, y in edge.fit_points], tangents)
    return BSpline(
        [Vec3(x, y, elevation) for x, y in edge.control_points],
        order=edge.degree + 1,
        knots=edge.knot_values or None,
        weights=edge.weights or None,
    )


def _joined(pieces: Sequence[Piece]) -> list[Piece]:
    """Edges end to end: turned round where needed, small gaps bridged by lines."""
    if not pieces:
        return []
    first, *rest = pieces
    if rest:
        nearest = min(_gap(first.end, rest[0].start), _gap(first.end, rest[0].end))
        if nearest > min(_gap(first.start, rest[0].start), _gap(first.start, rest[0].end)):
            first = first.reversed()
    chain: list[Piece] = [first]
    for piece in rest:
        at = chain[-1].end
        ahead = piece.reversed() if _gap(at, piece.end) < _gap(at, piece.start) else piece
        gap_mm = _gap(at, ahead.start)
        if gap_mm > MAX_HATCH_GAP_MM:
            raise ValueError(f"its outline has a gap of {gap_mm:.0f} mm")
        if gap_mm:
            chain.append(Line(at, ahead.start))
        chain.append(ahead)
    return chain


def _exact_spline(tool: BSpline, placement: Placement) -> Spline:
    weights = list(tool.weights()) or [1.0] * tool.count
    if min(weights) <= 0:
        raise ValueError("a weight of the spline is not above 0")
    points = placement.points(tool.control_points)
    homogeneous = np.array([(x * w, y * w, w) for (x, y), w in zip(points, weights, strict=True)])
    beziers = beziers_of(tool.degree, list(tool.knots()), homogeneous)
    if not beziers:
        raise ValueError("the knots of the spline span nothing")
    start, end = beziers[0][0], beziers[-1][-1]
    return Spline(
        _rounded(start[0] / start[2], start[1] / start[2]),
        _rounded(end[0] / end[2], end[1] / end[2]),
        beziers,
    )


def _arc_about(
    centre: Point, radii: tuple[Point, Point], start_rad: float, sweep_rad: float
) -> Arc:
    """The arc with its ends rounded like all other points, so that they meet their neighbours."""
    arc = arc_about(centre, radii, start_rad, sweep_rad)
    return replace(arc, start=_rounded(*arc.start), end=_rounded(*arc.end))


def _area(placed: Placed, corners: Sequence[Point]) -> Feature:
    return Feature(placed, _straight(corners, is_closed=True), is_area=True)


def _straight(points: Sequence[Point], *, is_closed: bool) -> tuple[Path, ...]:
    ends = [*points[1:], *points[:1]] if is_closed else points[1:]
    return _paths([Line(a, b) for a, b in zip(points, ends, strict=False)], is_closed=is_closed)


def _paths(pieces: Sequence[Piece], *, is_closed: bool = False) -> tuple[Path, ...]:
    """One path, or none where nothing is left of it; ends that meet close it."""
    kept = [piece for piece in pieces if piece.start != piece.end or _is_loop(piece)]
    if not kept:
        return ()
    meets = kept[0].start == kept[-1].end
    if is_closed and not meets:
        kept.append(Line(kept[-1].end, kept[0].start))
    encloses = len(kept) > 2 or not all(isinstance(piece, Line) for piece in kept)
    return (Path(tuple(kept), closed=(is_closed or meets) and encloses),)


def _is_loop(piece: Piece) -> bool:
    """Whether a piece that ends where it starts is more than a point."""
    if isinstance(piece, Arc):
        return any((*piece.u, *piece.v))
    return isinstance(piece, Spline) and any(np.ptp(b[:, :2] / b[:, 2:]) for b in piece.beziers)


def _turn(start_deg: float, end_deg: float) -> float:
    """The turn from one angle on to another, counter-clockwise; a full one for equal angles."""
    turn_deg = (end_deg - start_deg) % 360
    # writers turn 360° into radians and back
    if turn_deg < 1e-9 or turn_deg > 360 - 1e-9:
        return math.tau
    return math.radians(turn_deg)


def _as(placed: Placed, kind: type[EntityT]) -> EntityT:
    """The entity as the type that its DXF name promises."""
    if not isinstance(placed.entity, kind):
        raise TypeError(placed.kind)
    return placed.entity


def _gap(one: Point, other: Point) -> float:
    return math.dist(one, other)


def _rounded(x_mm: float, y_mm: float) -> Point:
    """A point to `LOCAL_DIGITS`; -0 becomes 0.

    Raises:
        ValueError: If a coordinate is infinite or not a number.
    """
    if not (math.isfinite(x_mm) and math.isfinite(y_mm)):
        raise ValueError("a coordinate is not a finite number")
    return round(x_mm, LOCAL_DIGITS) + 0.0, round(y_mm, LOCAL_DIGITS) + 0.0


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
