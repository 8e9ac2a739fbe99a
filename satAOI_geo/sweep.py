"""The floor that parts of the robot sweep in one move, as convex parts again.

A part turned by δ about o stays inside the convex hull of its corners at the start, at the end,
and half-way pushed out from o by 1 / cos(δ/2): a corner at distance ρ from o runs along an arc,
and the tangents at the arc's two ends meet at ρ / cos(δ/2). The hull is convex, contains the true
sweep, so that an allowed move really touches nothing. At δ = 15° the push is under 1 % of the
radius. What the hull adds lies on the side towards o, where the true sweep is hollow: up to 60 mm
with the prototype's vehicle.

Parts of as many corners and of one radius are swept together: each call of shapely takes its time.
"""

import math
from collections.abc import Sequence

import numpy as np
import shapely

from satAOI_geo.plan import FloatArray
from satAOI_geo.robot import Part


def stepped(parts: Sequence[Part], step_mm: FloatArray) -> list[Part]:
    """Parts moved straight by a step, shape (2,): exact."""
    corners_mm = _corners_mm(parts)
    return _hulls(parts[0].radius_mm, corners_mm, corners_mm + step_mm)


def turned(parts: Sequence[Part], pivots_mm: FloatArray, turn_rad: float) -> list[Part]:
    """Parts turned about a pivot, shape (2,), or about one each, shape (n_parts, 2)."""
    corners_mm, pivots_mm = _corners_mm(parts), pivots_mm.reshape(-1, 1, 2)
    arms_mm = corners_mm - pivots_mm
    half_way_mm = pivots_mm + _rotated(arms_mm, turn_rad / 2) / math.cos(turn_rad / 2)
    end_mm = pivots_mm + _rotated(arms_mm, turn_rad)
    return _hulls(parts[0].radius_mm, corners_mm, half_way_mm, end_mm)


def carried(parts: Sequence[Part], pivots_mm: FloatArray, turn_rad: float) -> list[Part]:
    """Parts moved, their heading kept, along the arc that a pivot makes about the disc.

    The pivots, shape (2,) or (n_parts, 2), are where they hang on at the start; the disc centre is
    the origin.
    """
    corners_mm, pivots_mm = _corners_mm(parts), pivots_mm.reshape(-1, 1, 2)
    half_way_mm = _rotated(pivots_mm, turn_rad / 2) / math.cos(turn_rad / 2) - pivots_mm
    end_mm = _rotated(pivots_mm, turn_rad) - pivots_mm
    return _hulls(parts[0].radius_mm, corners_mm, corners_mm + half_way_mm, corners_mm + end_mm)


def _corners_mm(parts: Sequence[Part]) -> FloatArray:
    """Corners of parts, shape (n_parts, n_corners, 2)."""
    return np.array([part.corners_mm for part in parts])


def _rotated(points_mm: FloatArray, turn_rad: float) -> FloatArray:
    """Points, shape (..., 2), turned about the origin."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    x_mm, y_mm = points_mm[..., 0], points_mm[..., 1]
    return np.stack((x_mm * cos - y_mm * sin, x_mm * sin + y_mm * cos), axis=-1)


def _hulls(radius_mm: float, *corners_mm: FloatArray) -> list[Part]:
    """For each part that of its radius about the convex hull of all its corners."""
    points_mm = np.concatenate(corners_mm, axis=1)
    clouds = shapely.multipoints(shapely.points(points_mm))
    hulls = shapely.orient_polygons(shapely.convex_hull(clouds))
    # an arm no longer than the disc's radius has no spine: a point that stays or moves straight
    n_repeated = np.where(shapely.get_dimensions(hulls) == 2, 1, 0)
    ends = np.cumsum(shapely.get_num_coordinates(hulls))
    begins, ends = np.concatenate(([0], ends[:-1])), ends - n_repeated
    rings_mm = shapely.get_coordinates(hulls)
    return [
        Part(rings_mm[begin:end], radius_mm)
        for begin, end in zip(begins.tolist(), ends.tolist(), strict=True)
    ]
