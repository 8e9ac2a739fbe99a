"""Closed curves of straight lines and circular arcs, flattened to one side.

A chain is an array of shape (n, 3): x_mm, y_mm and the bulge of the piece that starts there,
tan(angle / 4), positive for an arc that runs counter-clockwise. The last piece ends at the first
vertex. A polygon that stands for a chain either contains it or is contained in it, never a bit of
both: an obstacle must not shrink, and a floor must not grow.
"""

import math
from typing import Final, TypeAlias

import numpy as np
from shapely.geometry import LinearRing, Polygon

from satAOI_geo.plan import Circle, FloatArray

Point: TypeAlias = tuple[float, float]

SAGITTA_MM: Final = 0.01
"""Farthest a polygon may be from the curve it stands for."""

LARGEST_STEP_RAD: Final = math.pi / 8
"""A full turn has at least 16 pieces, however small it is."""


def circle_chain(circle: Circle) -> FloatArray:
    """A circle as two half circles."""
    right_mm, left_mm = circle.x_mm + circle.radius_mm, circle.x_mm - circle.radius_mm
    return np.array(((right_mm, circle.y_mm, 1.0), (left_mm, circle.y_mm, 1.0)))


def bulge_through(start: FloatArray, middle: FloatArray, end: FloatArray) -> float:
    """Bulge of the arc from start to end that passes through a third point; 0 on a line."""
    first, second = middle - start, end - middle
    # two chords of an arc turn against each other by half of the arc's angle
    turn_rad = math.atan2(first[0] * second[1] - first[1] * second[0], float(first @ second))
    return math.tan(turn_rad / 2)


def transformed(chain: FloatArray, matrix: FloatArray) -> FloatArray:
    """The chain under a similarity, shape (2, 3); a mirror turns the arcs' sense round."""
    mirrored = matrix[0, 0] * matrix[1, 1] < matrix[0, 1] * matrix[1, 0]
    points_mm = chain[:, :2] @ matrix[:, :2].T + matrix[:, 2]
    bulges = -chain[:, 2] if mirrored else chain[:, 2]
    return np.column_stack((points_mm, bulges))


def polygon(exterior: FloatArray, holes: tuple[FloatArray, ...], *, outward: bool) -> Polygon:
    """The region between chains as a polygon that contains it (outward) or lies within it."""
    return Polygon(
        flattened(exterior, outward=outward),
        [flattened(hole, outward=not outward) for hole in holes],
    )


def flattened(chain: FloatArray, *, outward: bool) -> list[Point]:
    """Corners of a polygon that contains the region inside the chain, or lies within it.

    Arcs that swell the region become tangents outward and chords inward, arcs that dent it the
    other way round.
    """
    if not chain[:, 2].any():
        return _points(chain)
    anticlockwise = LinearRing(_corners(chain, tangent_bulges=0)).is_ccw
    return _corners(chain, tangent_bulges=1 if anticlockwise == outward else -1)


def _corners(chain: FloatArray, *, tangent_bulges: int) -> list[Point]:
    """Corners with arcs of one sign of bulge by tangents, all others by chords."""
    points = _points(chain)
    corners: list[Point] = []
    for start, end, bulge in zip(points, points[1:] + points[:1], chain[:, 2], strict=True):
        corners.append(start)
        if bulge:
            corners.extend(_arc_corners(start, end, bulge, tangents=bulge * tangent_bulges > 0))
    return corners


def _arc_corners(start: Point, end: Point, bulge: float, *, tangents: bool) -> list[Point]:
    """Corners strictly between the ends of an arc: of its tangents, or of its chords."""
    chord = (end[0] - start[0], end[1] - start[1])
    # the centre lies on the chord's bisector, (1 - b²) / 4b chords to the left of its middle
    left = (1 - bulge * bulge) / (4 * bulge)
    centre_x_mm = (start[0] + end[0]) / 2 - left * chord[1]
    centre_y_mm = (start[1] + end[1]) / 2 + left * chord[0]
    u_x_mm, u_y_mm = start[0] - centre_x_mm, start[1] - centre_y_mm
    radius_mm, sweep_rad = math.hypot(u_x_mm, u_y_mm), 4 * math.atan(bulge)
    # a tangent's corner is the farther of the two: r · (1 / cos(step / 2) - 1)
    widest_rad = min(2 * math.acos(radius_mm / (radius_mm + SAGITTA_MM)), LARGEST_STEP_RAD)
    n_steps = math.ceil(abs(sweep_rad) / widest_rad)
    step_rad = sweep_rad / n_steps
    reach = 1 / math.cos(step_rad / 2) if tangents else 1.0
    turns_rad = (np.arange(n_steps) + 0.5 if tangents else np.arange(1, n_steps)) * step_rad
    cos, sin = np.cos(turns_rad) * reach, np.sin(turns_rad) * reach
    x_mm = centre_x_mm + u_x_mm * cos - u_y_mm * sin
    y_mm = centre_y_mm + u_y_mm * cos + u_x_mm * sin
    return list(zip(x_mm.tolist(), y_mm.tolist(), strict=True))


def _points(chain: FloatArray) -> list[Point]:
    return [(float(x_mm), float(y_mm)) for x_mm, y_mm in chain[:, :2]]
