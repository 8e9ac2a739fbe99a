"""The floor a part of the robot sweeps in one move, as a convex part again.

A part turned by δ about o stays inside the convex hull of its corners at the start, at the end,
and half-way pushed out from o by 1 / cos(δ/2): a corner at distance ρ from o runs along an arc,
and the tangents at the arc's two ends meet at ρ / cos(δ/2). The hull is convex, contains the true
sweep, so that an allowed move really touches nothing. At δ = 15° the push is under 1 % of the
radius. What the hull adds lies on the side towards o, where the true sweep is hollow: up to 60 mm
with the prototype's vehicle.
"""

import math

import numpy as np
import shapely

from satAOI_geo.plan import FloatArray
from satAOI_geo.robot import Part


def stepped(part: Part, step_mm: FloatArray) -> Part:
    """The part moved straight by a step, shape (2,): exact."""
    return _hull(part, part.corners_mm, part.corners_mm + step_mm)


def turned(part: Part, pivot_mm: FloatArray, turn_rad: float) -> Part:
    """The part turned about a pivot, shape (2,)."""
    arms_mm = part.corners_mm - pivot_mm
    half_way = _rotated(arms_mm, turn_rad / 2) / math.cos(turn_rad / 2)
    return _hull(part, part.corners_mm, pivot_mm + half_way, pivot_mm + _rotated(arms_mm, turn_rad))


def carried(part: Part, pivot_mm: FloatArray, turn_rad: float) -> Part:
    """The part moved, its heading kept, along the arc that a pivot makes about the disc.

    The pivot, shape (2,), is where the part hangs on at the start; the disc centre is the origin.
    """
    half_way = _rotated(pivot_mm, turn_rad / 2) / math.cos(turn_rad / 2) - pivot_mm
    end = _rotated(pivot_mm, turn_rad) - pivot_mm
    return _hull(part, part.corners_mm, part.corners_mm + half_way, part.corners_mm + end)


def _rotated(points_mm: FloatArray, turn_rad: float) -> FloatArray:
    """Points, shape (..., 2), turned about the origin."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    x_mm, y_mm = points_mm[..., 0], points_mm[..., 1]
    return np.stack((x_mm * cos - y_mm * sin, x_mm * sin + y_mm * cos), axis=-1)


def _hull(part: Part, *corners_mm: FloatArray) -> Part:
    """The part of the same radius about the convex hull of several sets of corners."""
    hull = shapely.convex_hull(shapely.multipoints(np.concatenate(corners_mm)))
    if hull.geom_type == "Polygon":
        ring = shapely.orient_polygons(hull).exterior
        return Part(np.asarray(ring.coords)[:-1], part.radius_mm)
    # an arm no longer than the disc's radius has no spine: a point that stays or moves straight
    return Part(np.asarray(hull.coords), part.radius_mm)
