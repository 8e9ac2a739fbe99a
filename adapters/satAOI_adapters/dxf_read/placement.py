"""Where what an entity draws lies in the plan's frame.

Coordinates of an entity pass through `Placement` once: its own axes (OCS), the blocks around it,
the unit and the origin are one matrix.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

import numpy as np
from ezdxf.entities import DXFGraphic
from ezdxf.math import BSpline, Matrix44, Vec3

from satAOI_adapters.dxf_read.curves import (
    Arc,
    Line,
    Piece,
    Point,
    Spline,
    arc_about,
    arc_of_bulge,
    beziers_of,
)
from satAOI_adapters.dxf_read.expand import Placed

LOCAL_DIGITS: Final = 5
"""Decimals of a millimetre that are kept: doubles of georeferenced drawings carry 1e-6 mm noise."""


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
        return [rounded_spot(point.x, point.y) for point in moved]

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


def placed_arc(
    centre: Point, radii: tuple[Point, Point], start_rad: float, sweep_rad: float
) -> Arc:
    """The arc with its ends rounded like all other points, so that they meet their neighbours."""
    arc = arc_about(centre, radii, start_rad, sweep_rad)
    return replace(arc, start=rounded_spot(*arc.start), end=rounded_spot(*arc.end))


def placed_spline(tool: BSpline, placement: Placement) -> Spline:
    """A B-spline as its Bézier pieces, which are placed with its control points.

    Raises:
        ValueError: If its weights or knots make no curve.
    """
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
        rounded_spot(start[0] / start[2], start[1] / start[2]),
        rounded_spot(end[0] / end[2], end[1] / end[2]),
        beziers,
    )


def bulged(
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


def turn_between(start_deg: float, end_deg: float) -> float:
    """The turn from one angle on to another, counter-clockwise; a full one for equal angles."""
    turn_deg = (end_deg - start_deg) % 360
    # writers turn 360° into radians and back
    if turn_deg < 1e-9 or turn_deg > 360 - 1e-9:
        return math.tau
    return math.radians(turn_deg)


def rounded_spot(x_mm: float, y_mm: float) -> Point:
    """A point to `LOCAL_DIGITS`; -0 becomes 0.

    Raises:
        ValueError: If a coordinate is infinite or not a number.
    """
    if not (math.isfinite(x_mm) and math.isfinite(y_mm)):
        raise ValueError("a coordinate is not a finite number")
    return round(x_mm, LOCAL_DIGITS) + 0.0, round(y_mm, LOCAL_DIGITS) + 0.0
