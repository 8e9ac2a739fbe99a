"""Outlines of hatches: polylines, or edges that meet end to end more or less."""

import math
from collections.abc import Sequence
from typing import Final

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
from ezdxf.math import BSpline, Vec3, fit_points_to_cad_cv

from satAOI_adapters.dxf_read.curves import Line, Path, Piece, Point
from satAOI_adapters.dxf_read.features import is_loop, paths_of
from satAOI_adapters.dxf_read.placement import (
    Placement,
    bulged,
    placed_arc,
    placed_spline,
    turn_between,
)

MAX_HATCH_GAP_MM: Final = 20.0
"""Edges of a hatch outline farther apart than this do not belong to one outline."""


def hatch_outline(
    outline: AbstractBoundaryPath, own: Placement, elevation: float
) -> tuple[Path, ...]:
    """One outline of a hatch, closed; none where nothing is left of it."""
    if isinstance(outline, PolylinePath):
        points = own.points([(x, y, elevation) for x, y, _ in outline.vertices])
        bulges = [bulge for _, _, bulge in outline.vertices]
        return paths_of(bulged(own, points, bulges, is_closed=True), is_closed=True)
    if isinstance(outline, EdgePath):
        pieces = [_edge(edge, own, elevation) for edge in outline.edges]
        return paths_of(
            _joined([p for p in pieces if p.start != p.end or is_loop(p)]), is_closed=True
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
        return placed_spline(_edge_spline(edge, elevation), own)
    else:
        raise TypeError("an outline edge of unknown type")
    sweep = turn_between(math.degrees(start), math.degrees(end))
    first, turn = (start, sweep) if edge.ccw else (start + sweep, -sweep)
    return placed_arc(own.point(edge.center.x, edge.center.y, elevation), radii, first, turn)


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


def _gap(one: Point, other: Point) -> float:
    return math.dist(one, other)
